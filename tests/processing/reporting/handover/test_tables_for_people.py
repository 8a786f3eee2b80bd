"""Tables for Excel, the log of decisions, and Raven's selection tables."""

import csv
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from processing.quantities import METRES_PER_US_FOOT, Units
from processing.reporting.options import FileKind
from processing.survey import AudioPart, AudioSource, ClockMap, Decision, Verdict


def excel(path, delimiter):
    data = path.read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")  # without it Excel takes Turkish letters for Latin ones
    return list(csv.DictReader(data.decode("utf-8-sig").splitlines(keepends=True), delimiter=delimiter))


def test_a_turkish_excel_splits_the_table_and_reads_its_numbers(hand_over, decisions):
    folder, _ = hand_over(FileKind.EXCEL_CSV, language="tr")
    rows = excel(folder / "leaks-excel.csv", ";")
    assert [row["No"] for row in rows] == ["2", "1", "3", "17"]
    one = rows[1]
    assert one["Bırakmadan boru boyunca mesafe (m)"] == "42,000"
    assert one["Karar"] == "onaylandı"
    assert one["Sınıf"] == "vana"
    assert one["Not"] == decisions[1].note
    assert rows[3]["Yalnızca sese göre kaçak olasılığı"] == ""
    assert rows[2]["Gerideki en yakın bilinen yer"] == "bırakma"
    east = [row["Doğu (sağa) (m)"] for row in rows]
    assert all("." not in number and number.count(",") == 1 for number in east)
    stretches = excel(folder / "stretches-excel.csv", ";")
    assert [row["Durum"] for row in stretches].count("değerlendirilemedi") == 1
    (poor,) = [row for row in stretches if row["Durum"] == "değerlendirilemedi"]
    assert poor["Neden değerlendirilemedi"] == "kırpılmış ses"


def test_an_english_excel_gets_commas_and_points_and_feet_if_asked(hand_over):
    folder, _ = hand_over(FileKind.EXCEL_CSV, units=Units.US)
    rows = excel(folder / "leaks-excel.csv", ",")
    told = float(rows[1]["Distance along the pipe from the launch (ftUS)"])
    assert told * METRES_PER_US_FOOT == pytest.approx(42.0, abs=0.001)


@pytest.mark.parametrize("note", ["=1+1", "+90 216", "-3 m", "@SUM(A1)", "\t=1"])
def test_no_note_becomes_a_formula(hand_over, note):
    folder, _ = hand_over(FileKind.EXCEL_CSV, decided={2: Decision(Verdict.UNSURE, None, note)})
    row = next(row for row in excel(folder / "leaks-excel.csv", ",") if row["No."] == "2")
    assert row["Note"] == f"'{note}"


def test_leaks_without_a_place_stand_in_the_table_all_the_same(hand_over, surveyed):
    nowhere = tuple(
        replace(c, chainage_m=np.nan, chainage_low95_m=np.nan, chainage_high95_m=np.nan, position_w_m=(np.nan,) * 3)
        for c in surveyed.candidates
    )
    changed = replace(surveyed, track=None, candidates=nowhere)
    folder, written = hand_over(changed=changed)
    rows = excel(folder / "leaks-excel.csv", ",")
    assert [row["No."] for row in rows] == ["2", "1", "3", "17"]
    assert {row["Distance along the pipe from the launch (m)"] for row in rows} == {""}
    assert [finding.code for finding in written.findings] == ["handover_no_path"]  # five map files, one reason
    assert not (folder / "survey.gpkg").exists()


def test_the_log_tells_who_decided_what_when_and_took_it_back(hand_over, record):
    folder, _ = hand_over(FileKind.DECISIONS_CSV)
    with (folder / "decisions.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(r["at_utc"], r["operator"], r["reason"], r["leak"]) for r in rows] == [
        (entry.at_utc, entry.operator, entry.reason, str(entry.number)) for entry in record.log
    ]
    assert (rows[0]["verdict_after"], rows[0]["class_after"], rows[0]["note_after"]) == (
        "confirmed", "leak", "vana yanında; ıslak",
    )  # fmt: skip
    assert (rows[1]["verdict_before"], rows[1]["verdict_after"], rows[1]["class_after"]) == ("confirmed", "none", "")


def raven(path):
    lines = path.read_text(encoding="utf-8").splitlines()
    cells = [line.split("\t") for line in lines]
    assert {len(row) for row in cells} == {len(cells[0])}
    return [dict(zip(cells[0], row, strict=True)) for row in cells[1:]]


def test_raven_finds_each_place_at_its_time_in_the_sound_file(hand_over, surveyed):
    clock = ClockMap(start_s=-3.0, drift_ppm=40.0)
    folder, _ = hand_over(FileKind.RAVEN, changed=replace(surveyed, clock=clock))
    rows = raven(folder / "raven" / "audio.selections.txt")
    assert list(rows[0])[:7] == [
        "Selection", "View", "Channel", "Begin Time (s)", "End Time (s)", "Low Freq (Hz)", "High Freq (Hz)",
    ]  # fmt: skip
    assert [row["Selection"] for row in rows] == ["1", "2", "3", "4"]
    by_leak = {int(row["Leak"]): row for row in rows}
    for candidate in surveyed.candidates:
        row = by_leak[candidate.label]
        begin, end = float(row["Begin Time (s)"]), float(row["End Time (s)"])
        assert (begin + end) / 2 == pytest.approx((candidate.time_s + 3.0) * (1 + 40e-6), abs=1e-3)
        assert end - begin == pytest.approx(candidate.width_m / 0.5 * (1 + 40e-6), abs=1e-3)  # at 0.5 m/s
        assert (float(row["Low Freq (Hz)"]), float(row["High Freq (Hz)"])) == candidate.band_hz
    assert by_leak[1]["Note"] == 'ıslak zemin; "İŞĞÜÖÇ", =2+2'
    assert by_leak[17]["Score"] == ""


def test_each_sound_file_has_a_table_of_its_own_in_its_own_seconds(hand_over, surveyed):
    rate = 8000
    parts = tuple(AudioPart(Path(f"{folder}/audio.wav"), 60 * rate) for folder in ("a", "b"))
    sound = AudioSource(parts, rate, 2, channel=1)
    changed = replace(surveyed, recording=replace(surveyed.recording, audio=sound))
    folder, written = hand_over(FileKind.RAVEN, changed=changed)
    first, second = raven(folder / "raven" / "audio.selections.txt"), raven(folder / "raven" / "audio-2.selections.txt")
    assert [row["Leak"] for row in first] == ["3", "17"]  # at 20 and 50 s
    assert [row["Leak"] for row in second] == ["1"]  # at 84 s, in the second minute
    middle = (float(second[0]["Begin Time (s)"]) + float(second[0]["End Time (s)"])) / 2
    assert middle == pytest.approx(24.0, abs=1e-3)
    assert second[0]["Channel"] == "2"
    (finding,) = written.findings  # at 140 s there is no sound any more
    assert (finding.code, finding.params["count"]) == ("handover_outside_sound", 1)


def test_without_sound_there_is_no_selection_table(hand_over, surveyed):
    changed = replace(surveyed, recording=replace(surveyed.recording, audio=None))
    folder, written = hand_over(FileKind.RAVEN, changed=changed)
    assert not (folder / "raven").exists()
    assert [finding.code for finding in written.findings] == ["handover_no_sound"]
