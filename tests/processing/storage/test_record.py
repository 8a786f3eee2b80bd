"""What people added to a run, gathered for the report: by the leaks' numbers, oldest first."""

import pytest
import small_survey
from PIL import Image

from processing.review_facts import DigFinding, DigHistory, DigResult
from processing.storage.record import review_record
from processing.survey import Decision, Run, Verdict

CONFIRMED, REJECTED = Decision(Verdict.CONFIRMED), Decision(Verdict.REJECTED, note="pump")


@pytest.fixture(scope="module")
def gathered(tmp_path_factory):
    """Two runs of one survey, with a decision on each, a photo, a dig and a second opinion that was changed."""
    place = tmp_path_factory.mktemp("record")
    Image.new("RGB", (40, 30)).save(place / "wet.png")
    found = [small_survey.candidate(i, 20.0 * i, 0.9) for i in (1, 2, 3)]
    moved = [small_survey.candidate(1, 20.2, 0.9), small_survey.candidate(2, 95.0, 0.5)]
    with small_survey.make_folder(place) as folder:
        first = folder.review.add_run(Run(0, "", "first"), found)
        folder.review.decide(first.candidates[1].id, CONFIRMED, "Ayşe")
        folder.photos.add(2, place / "wet.png", "kerb", "Ayşe")
        folder.digs.record(DigResult(2, DigFinding.LEAK, "2026-05-09", 0.4), "Can")
        folder.opinions.give(2, "Mehmet", CONFIRMED)
        folder.opinions.give(2, "Mehmet", REJECTED)
        second = folder.review.add_run(Run(0, "", "second"), moved)
        folder.review.decide(second.candidates[1].id, REJECTED, "Ayşe")
        history = DigHistory("rolling/*/*/*", 3, 3, 0.5, 0.9, 0)
        yield folder, review_record(folder, first.run), review_record(folder, second.run, history)


def said(record, reason):
    return [(e.operator, e.number, e.before.verdict, e.after.verdict) for e in record.log if e.reason == reason]


def test_decisions_are_told_by_the_number_of_the_leak(gathered):
    _, _, record = gathered
    assert said(record, "decide") == [
        ("Ayşe", 2, Verdict.NONE, Verdict.CONFIRMED),
        ("Ayşe", 4, Verdict.NONE, Verdict.REJECTED),  # new in the second run, so it has a new number
    ]


def test_a_runs_record_leaves_out_what_was_decided_on_later_runs(gathered):
    _, record, _ = gathered
    assert [number for _, number, *_ in said(record, "decide")] == [2]


def test_a_second_opinion_is_told_with_what_the_same_reviewer_had_said_before(gathered):
    _, _, record = gathered
    assert said(record, "opinion") == [
        ("Mehmet", 2, Verdict.NONE, Verdict.CONFIRMED),
        ("Mehmet", 2, Verdict.CONFIRMED, Verdict.REJECTED),
    ]
    (now,) = record.opinions
    assert (now.number, now.reviewer, now.decision) == (2, "Mehmet", REJECTED)


def test_digs_and_photos_come_with_their_figures_and_files(gathered):
    folder, _, record = gathered
    assert record.digs[2].off_along_m == 0.4
    (dig,) = [entry for entry in record.log if entry.reason == "dig"]
    assert (dig.operator, dig.number, dig.after.note) == ("Can", 2, "leak +0.40 m")
    ((photo, path),) = record.photos
    assert photo.caption == "kerb"
    assert path == str(folder.path / "attachments" / photo.file)


def test_the_log_is_in_the_order_in_which_it_was_said(gathered):
    _, _, record = gathered
    moments = [entry.at_utc for entry in record.log]
    assert moments == sorted(moments)
    assert record.history is not None
    assert record.history.count == 3
