"""Markers of a running recording: on the disc when they are set, amended, taken back, on the clock that there is."""

from dataclasses import replace

import pytest
from fake_devices import RATE_HZ, noise
from recorder_bench import ties_of

from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import RecordingState
from processing.survey import TiePoint


def test_a_marker_is_on_the_disc_when_it_is_set_and_the_recording_goes_on(bench):
    one = bench()
    folder = one.recorder.start()
    one.move(400)
    point = one.recorder.mark("vana 12", 104.5, host_s=one.begun_s + 1.0)
    assert point == TiePoint("vana 12", point.time_s, chainage_m=104.5)
    assert point.time_s == pytest.approx(1.0, abs=0.01)
    assert ties_of(folder) == (point,)
    assert one.recorder.status().markers == 1
    assert one.recorder.status().state is RecordingState.RECORDING


def test_a_marker_may_have_coordinates_or_nothing_but_its_name(bench):
    one = bench()
    folder = one.recorder.start()
    one.move()
    placed = one.recorder.mark("bend", latitude=40.9, longitude=29.1, sigma_m=2.0)
    bare = one.recorder.mark("here")
    assert ties_of(folder) == (placed, bare)
    assert (placed.latitude, placed.sigma_m, bare.chainage_m) == (40.9, 2.0, None)


def test_the_last_marker_can_be_taken_back_and_any_can_be_amended(bench):
    one = bench()
    folder = one.recorder.start()
    one.move()
    first, second = one.recorder.mark("one"), one.recorder.mark("two")
    assert one.recorder.unmark() == second
    named = replace(first, name="valve", chainage_m=12.0)
    one.recorder.amend(first, named)
    assert ties_of(folder) == one.recorder.marks == (named,)
    one.recorder.amend(named, None)
    assert one.recorder.unmark() is None
    assert ties_of(folder) == ()


def test_without_a_recording_nothing_can_be_marked(bench):
    one = bench()
    with pytest.raises(LeaklineError) as refused:
        one.recorder.mark("early")
    assert refused.value.code is ErrorCode.RECORDING_NOT_RUNNING
    one.recorder.start()
    one.recorder.stop()
    with pytest.raises(LeaklineError):
        one.recorder.mark("late")


def test_markers_of_a_recording_without_motion_count_on_the_sound(bench):
    one = bench(imu="none")
    one.mic.give(noise(3 * RATE_HZ), host_s=one.begun_s - 1.0)
    one.recorder.start()
    one.mic.give(noise(2 * RATE_HZ), host_s=one.begun_s + 10.0)
    assert one.recorder.mark("here", host_s=one.begun_s + 9.5).time_s == pytest.approx(1.5, abs=1e-3)


def test_markers_set_before_the_first_sample_of_the_imu_get_its_time_later(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(800), host_s=one.begun_s + 0.1)
    early = one.recorder.mark("launch", host_s=one.begun_s + 0.1)
    one.begun_s += 5.0
    one.move(400)
    one.recorder.stop()
    (tie,) = ties_of(folder)
    assert early.time_s == pytest.approx(0.1, abs=1e-3)
    assert tie.time_s == pytest.approx(0.1 - 5.0, abs=0.01)


def test_a_marker_that_is_named_later_keeps_the_time_that_is_known_better_by_then(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(800), host_s=one.begun_s + 0.1)
    early = one.recorder.mark("marker 1", host_s=one.begun_s + 0.1)
    one.begun_s += 5.0
    one.move(400)
    one.recorder._take.settle()
    named = one.recorder.amend(early, replace(early, name="launch", chainage_m=0.0))
    assert named.time_s == pytest.approx(0.1 - 5.0, abs=0.01)
    again = one.recorder.amend(named, replace(named, name="launch pit"))
    one.recorder.stop()
    assert ties_of(folder) == (again,)
