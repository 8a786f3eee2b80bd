"""The computer's memory of digs: corrected, taken back, put together, and never lost to a damaged line."""

import io
import json
from dataclasses import replace

import pytest

from processing.dig_history import DigKind, HistoryFile, kind_of
from processing.errors import ErrorCode, LeaklineError
from processing.review_facts import DigFinding, DigResult
from processing.storage.digs import DigEntry
from processing.survey import DeviceInfo, Motion, PipeInfo, Survey, SurveyInfo, TiePoint

SURVEY = Survey(SurveyInfo("İstasyon Caddesi", "Ayşe Ğül", "2026-05-04", "Şişli Su"), PipeInfo("Düktil demir", 0.3))
FOUND = DigResult(
    3, DigFinding.LEAK, "2026-05-12", 0.6, note="geheim", dug_by="Ali", operator="Ayşe", stated_chainage_m=100.0,
    stated_low95_m=99.0, stated_high95_m=101.0,
)  # fmt: skip


def log(*results, number=3):
    return tuple(DigEntry(i, f"2026-05-{20 - i:02d}", "Ayşe", number, result) for i, result in enumerate(results, 1))


@pytest.fixture
def history(tmp_path):
    return HistoryFile(tmp_path / "Ölçüm" / "dig-history.jsonl")


def offs(history):
    return [entry.dig.off_along_m for entry in history.read().digs]


def test_a_history_that_is_not_there_yet_is_empty(history):
    assert history.read().digs == ()
    assert history.take("a", SURVEY, ()) == 0
    assert not history.path.exists()


def test_a_correction_replaces_and_what_was_taken_back_disappears_whatever_the_clocks_said(history):
    assert history.take("a", SURVEY, log(FOUND)) == 1
    assert history.take("a", SURVEY, log(FOUND)) == 0  # known: nothing is written twice
    assert history.take("a", SURVEY, log(FOUND, replace(FOUND, off_along_m=-0.2))) == 1
    assert offs(history) == [-0.2]
    history.take("a", SURVEY, log(FOUND, FOUND, None))
    assert offs(history) == []
    assert len(history.path.read_text(encoding="utf-8").splitlines()) == 3  # appended, never rewritten


def test_an_older_copy_of_a_survey_changes_nothing(history):
    history.take("a", SURVEY, log(FOUND, replace(FOUND, off_along_m=-0.2)))
    assert history.take("a", SURVEY, log(FOUND)) == 0
    assert offs(history) == [-0.2]


def test_what_is_entered_in_a_survey_restored_from_its_backup_counts_though_its_log_is_shorter(history):
    mistyped = replace(FOUND, off_along_m=40.0)
    history.take("a", SURVEY, log(FOUND, None, mistyped))
    again = log(replace(FOUND, off_along_m=0.4))
    assert history.take("a", SURVEY, again) == 0  # a copy that is merely looked at
    assert history.take("a", SURVEY, again, {3}) == 1
    assert offs(history) == [0.4]
    assert history.take("a", SURVEY, again, {3}) == 0
    history.take("a", SURVEY, (*again, DigEntry(2, "", "", 3, None)), {3})
    assert offs(history) == []


def test_a_disc_that_fills_up_is_told_and_costs_one_line_only(history, monkeypatch):
    history.take("a", SURVEY, log(FOUND))

    class Full(io.FileIO):
        def write(self, data):
            return super().write(bytes(data)[:50])

    opened = type(history.path).open
    with monkeypatch.context() as patch:
        patch.setattr(type(history.path), "open", lambda self, mode="r", *args, **more: (
            Full(self, "ab") if mode == "ab" else opened(self, mode, *args, **more)))  # fmt: skip
        with pytest.raises(LeaklineError) as caught:
            history.take("b", SURVEY, log(FOUND))
    assert caught.value.code is ErrorCode.DISC_FULL
    assert history.take("b", SURVEY, log(FOUND)) == 1
    read = history.read()
    assert ([entry.survey for entry in read.digs], read.damaged) == (["a", "b"], 1)


def test_surveys_and_numbers_do_not_mix(history):
    history.take("a", SURVEY, log(FOUND) + log(replace(FOUND, number=4, off_along_m=1.0), number=4))
    history.take("b", SURVEY, log(replace(FOUND, off_along_m=2.0)))
    assert offs(history) == [0.6, 1.0, 2.0]


def test_nothing_personal_is_kept_but_the_name_of_the_survey(history):
    history.take("a", SURVEY, log(replace(FOUND, cause="Ali'nin kazması")))
    text = history.path.read_text(encoding="utf-8")
    assert "İstasyon Caddesi" in text
    for word in ("Ali", "Ayşe", "geheim", "Şişli"):
        assert word not in text


def test_nobody_digs_for_simulated_leaks(history):
    simulated = replace(SURVEY, info=replace(SURVEY.info, simulated=True))
    assert history.take("a", simulated, log(FOUND)) == 0
    assert not history.path.exists()


def test_a_damaged_line_costs_itself_only_and_a_torn_end_does_not_spoil_the_next(history):
    history.take("a", SURVEY, log(FOUND))
    with history.path.open("ab") as file:
        file.write(b'{"survey": 7}\n\xff\xfe rubbish\n{"survey":"x","name":"y","number":1,"revi')
    history.take("b", SURVEY, log(replace(FOUND, off_along_m=2.0)))
    read = history.read()
    assert [entry.dig.off_along_m for entry in read.digs] == [0.6, 2.0]
    assert read.damaged == 3


@pytest.mark.parametrize("value", ["NaN", "Infinity", "1e300"])
def test_a_number_that_no_dig_can_have_is_damage(history, value):
    history.take("a", SURVEY, log(FOUND))
    line = history.path.read_text(encoding="utf-8")
    history.path.write_text(line.replace('"off_along_m":0.6', f'"off_along_m":{value}'), encoding="utf-8")
    assert history.read().digs == ()
    assert history.read().damaged == 1


def test_the_form_can_be_put_right_later_but_whether_tie_points_held_the_path_stays(history):
    history.take("a", SURVEY, log(FOUND))
    told = replace(SURVEY, pipe=PipeInfo("PVC", 0.1), tie_points=(TiePoint("end", 10.0, chainage_m=5.0),))
    assert history.take("a", told, log(FOUND)) == 1
    (entry,) = history.read().digs
    assert entry.kind == DigKind("rolling", "pvc", 110, tied=False)
    assert history.take("a", told, log(FOUND)) == 0


def test_the_histories_of_two_computers_become_one_and_coming_twice_changes_nothing(history, tmp_path):
    other = HistoryFile(tmp_path / "other.jsonl")
    history.take("a", SURVEY, log(FOUND))
    other.take("a", SURVEY, log(FOUND, None))  # taken back there
    other.take("b", SURVEY, log(replace(FOUND, off_along_m=2.0)))
    assert other.write_out(tmp_path / "from other.jsonl") == 1
    taken = history.take_in(tmp_path / "from other.jsonl")
    assert (len(taken.digs), taken.damaged) == (2, 0)
    assert offs(history) == [2.0]
    assert history.take_in(tmp_path / "from other.jsonl").digs == ()


def test_a_file_that_holds_no_history_is_refused_with_what_is_wrong(history, tmp_path):
    wrong = tmp_path / "leaks.csv"
    wrong.write_text("id,chainage_m\n1,3.4\n")
    with pytest.raises(LeaklineError) as caught:
        history.take_in(wrong)
    assert caught.value.code is ErrorCode.FILE_UNREADABLE
    with pytest.raises(LeaklineError) as caught:
        history.take_in(tmp_path / "none.jsonl")
    assert caught.value.code is ErrorCode.FILE_MISSING


def test_a_line_of_the_history_is_json_that_any_program_reads(history):
    history.take("a", SURVEY, log(FOUND))
    line = json.loads(history.path.read_text(encoding="utf-8"))
    assert (line["survey"], line["number"], line["dig"]["finding"], line["dig"]["off_along_m"]) == ("a", 3, "leak", 0.6)


@pytest.mark.parametrize(
    ("pipe", "material", "diameter_mm"),
    [
        (PipeInfo("ductile iron", 0.3), "ductile_iron", 300),
        (PipeInfo("DÜKTİL", 0.4), "ductile_iron", 600),
        (PipeInfo("HDPE", 0.09), "pe", 110),
        (PipeInfo("HDPE", 0.5), "pe", 600),
        (PipeInfo("wood", 1.2), "other", 9999),
        (PipeInfo(), "", 0),
    ],
)
def test_the_kind_of_a_pipe_is_read_from_its_form(pipe, material, diameter_mm):
    foot = DeviceInfo(Motion.FOOT)
    told = Survey(pipe=pipe, device=foot, tie_points=(TiePoint("a", 1.0, enabled=False),))
    assert kind_of(told) == DigKind("foot", material, diameter_mm, tied=False)
    assert kind_of(replace(told, tie_points=(TiePoint("a", 1.0),))).tied
