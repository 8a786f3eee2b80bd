"""A journal is a file like any other: whatever stands in it, the recording beside it can be imported."""

import json

import pytest

from processing.importing.check_sheets import check_sheets
from processing.importing.live_journal import MOST_BYTES, journal_in
from processing.storage.journal import JOURNAL_NAME

TOO_LARGE = 10**400  # a whole number for JSON, for no float


def _journal(folder, event, **values):
    line = {"event": event, "utc": "2026-11-22T10:00:00.000+00:00", "host_s": 1.0, "values": values}
    (folder / JOURNAL_NAME).write_text(json.dumps(line) + "\n")
    return folder


@pytest.mark.parametrize("value", [TOO_LARGE, -TOO_LARGE, float("nan"), float("inf"), True, "3", None, [1]])
@pytest.mark.parametrize("name", ["start_s", "end_s"])
def test_a_gap_whose_times_are_none_is_passed_over(tmp_path, name, value):
    folder = _journal(tmp_path, "motion_gap", **{"start_s": 1.0, "end_s": 2.0, "lost": 3, name: value})
    journal, findings = journal_in(folder)
    assert journal.motion_gaps == ()
    assert findings == ()


@pytest.mark.parametrize("name", ["frame", "frames"])
def test_a_gap_of_the_sound_beyond_all_sound_is_passed_over(tmp_path, name):
    folder = _journal(tmp_path, "sound_gap", **{"frame": 10, "frames": 20, name: TOO_LARGE})
    journal, _ = journal_in(folder)
    assert journal.sound_gaps == ()
    assert journal.findings(48_000.0) == ()


@pytest.mark.parametrize("end_s", [-2.0, 0.0])
def test_what_was_missed_before_the_recording_is_no_stretch_of_it(tmp_path, end_s):
    folder = _journal(tmp_path, "motion_gap", start_s=-5.0, end_s=end_s, lost=0, reason="live_restart")
    assert journal_in(folder)[0].motion_gaps == ()


def test_a_gap_that_reaches_into_the_recording_begins_with_it(tmp_path):
    folder = _journal(tmp_path, "motion_gap", start_s=-5.0, end_s=2.0, lost=0, reason="live_restart")
    (gap,) = journal_in(folder)[0].motion_gaps
    assert (gap.start_s, gap.end_s) == (0.0, 2.0)


@pytest.mark.parametrize("value", [TOO_LARGE, float("nan"), float("-inf")])
def test_a_sheet_keeps_only_numbers_that_can_be_printed(tmp_path, value):
    item = {"key": "disc", "light": "green", "verdict": "disc_enough", "params": {"gb": 3, "bad": value}}
    folder = _journal(tmp_path, "check", kind="launch", utc="", items=[item])
    (sheet,) = check_sheets(folder)
    assert sheet.items[0].params == {"gb": 3.0}


def test_a_journal_larger_than_any_of_ours_is_not_read(tmp_path):
    item = {"key": "disc", "light": "green", "verdict": "disc_enough", "params": {}}
    folder = _journal(tmp_path, "check", kind="launch", utc="", items=[item])
    with (folder / JOURNAL_NAME).open("r+b") as file:
        file.truncate(MOST_BYTES + 1)  # a hole: takes no room
    journal, (finding,) = journal_in(folder)
    assert journal is None
    assert finding.code == "live_journal_unreadable"
    assert check_sheets(folder) == ()
