"""What happened is told once, added up where it comes again, and kept in bounds."""

from datetime import UTC, datetime

from app.devices.recorder_events import MOST, Happenings
from processing.errors import ErrorCode, LeaklineError
from processing.survey import Severity


class Clock:
    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


class Lines:
    def __init__(self, fault=None):
        self.lines, self._fault = [], fault

    def note(self, event, **values):
        if self._fault is not None:
            raise self._fault
        self.lines.append((event, values))


def happenings(clock=None):
    return Happenings(clock or Clock(), lambda: datetime(2026, 5, 4, 13, 14, 15, tzinfo=UTC))


def test_a_finding_says_at_what_time_of_day_it_was():
    told = happenings()
    told.tell("recorder_imu_back", Severity.MASKED, gap_s=2.5)
    assert told.findings[0].params == {"at": "13:14:15", "gap_s": 2.5}


def test_what_comes_again_within_half_a_minute_grows_and_later_is_told_anew():
    clock = Clock()
    told = happenings(clock)
    for moment in (0.0, 10.0, 29.0, 31.0):
        clock.now = moment
        told.add_up("recorder_imu_gap", Severity.MASKED, lost=2.0, gaps=1.0)
    assert [finding.params["lost"] for finding in told.findings] == [6.0, 2.0]
    assert [finding.params["gaps"] for finding in told.findings] == [3.0, 1.0]


def test_what_has_another_reason_is_not_added_to_it():
    told = happenings()
    told.add_up("recorder_sound_gap", Severity.MASKED, "sound_overflow", lost_s=1.0)
    told.add_up("recorder_sound_gap", Severity.MASKED, "sound_behind", lost_s=2.0)
    told.add_up("recorder_sound_gap", Severity.MASKED, "sound_overflow", lost_s=4.0)
    assert [finding.params["lost_s"] for finding in told.findings] == [5.0, 2.0]


def test_a_night_of_trouble_does_not_fill_the_memory_and_still_adds_up_rightly():
    clock = Clock()
    told = happenings(clock)
    for number in range(3 * MOST):
        clock.now += 0.001
        told.tell("recorder_imu_restarted", Severity.REPAIRED, number=number)
        told.add_up("recorder_imu_gap", Severity.MASKED, lost=1.0)
    assert len(told.findings) == MOST
    assert told.findings[-1].params.get("number", told.findings[-2].params.get("number")) == 3 * MOST - 1
    # the sum was pushed out of sight several times and began anew: what is in sight is a sum of its own
    sums = [finding.params["lost"] for finding in told.findings if finding.code == "recorder_imu_gap"]
    assert sum(sums) <= 3 * MOST


def test_lines_go_to_the_journal_only_while_there_is_one():
    told, journal = happenings(), Lines()
    told.note("before")
    told.attach(journal)
    told.note("within", value=1)
    told.attach(None)
    told.note("after")
    assert journal.lines == [("within", {"value": 1})]


def test_a_journal_that_cannot_be_written_stops_no_stream():
    told = happenings()
    told.attach(Lines(LeaklineError(ErrorCode.DISC_FULL)))
    told.note("anything")


def test_another_recording_begins_without_the_findings_of_the_last():
    told = happenings()
    told.add_up("recorder_imu_gap", Severity.MASKED, lost=2.0)
    told.clear()
    assert told.findings == ()
    told.add_up("recorder_imu_gap", Severity.MASKED, lost=3.0)
    assert [finding.params["lost"] for finding in told.findings] == [3.0]
