"""Motion on one axis: what a device's clock, its bus and its cable may do, against when the samples were made."""

import numpy as np
import pytest
from arrivals import Sent, frames_at, sent, told_by
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.live.device_timeline import DeviceTimeline
from processing.live.frame_rows import no_frames, rows_of

T0_US = 7_000_000


def micro(seconds, start_us=T0_US):
    return np.round(1e6 * np.asarray(seconds)).astype(np.int64) + start_us


def chained(*streams):
    """Several lives of a device, one after the other on the host's clock."""
    return Sent(*(np.concatenate([getattr(s, name) for s in streams]) for name in ("true_s", "device_s", "host_s")))


@pytest.mark.parametrize("rate", [10, 100, 400, 1000])
def test_what_goes_on_keeps_the_devices_times_to_the_microsecond(rate):
    stream = sent(10, rate, 80.0, 0.005, 0.016, stall=(5.0, 2.0), seed=rate)
    told = told_by(DeviceTimeline(), frames_at(micro(stream.device_s)), stream.host_s)
    assert np.array_equal(np.diff(told.frames.time_us.astype(np.int64)), np.diff(micro(stream.device_s)))
    assert np.array_equal(told.frames.counter, np.arange(len(stream.device_s)))
    assert [told.total(name) for name in ("lost", "repeated", "absurd", "restarted", "gap_s")] == [0, 0, 0, 0, 0]


def test_a_counter_of_microseconds_that_turns_over_is_no_restart():
    stream = sent(10, 100, jitter_s=0.003, bundle_s=0.032, seed=1)
    time_us = micro(stream.device_s, 2**32 - 5_000_000)
    told = told_by(DeviceTimeline(), frames_at(time_us % 2**32), stream.host_s)
    assert np.array_equal(np.diff(told.frames.time_us.astype(np.int64)), np.diff(time_us))
    assert (told.total("restarted"), told.total("lost")) == (0, 0)


def test_the_frame_counter_turns_over_without_a_loss():
    stream = sent(10, 100, jitter_s=0.003, seed=1)
    counter = 2**32 - 500 + np.arange(1000)
    told = told_by(DeviceTimeline(), frames_at(micro(stream.device_s), counter), stream.host_s)
    assert (told.total("lost"), len(told.frames)) == (0, 1000)


@pytest.mark.parametrize("away_s", [0.5, 8.0, 300.0])
@pytest.mark.parametrize("rate", [10, 400])
def test_a_device_plugged_in_again_goes_on_where_the_hosts_clock_says(away_s, rate):
    first = sent(10, rate, 40.0, 0.004, 0.016, seed=1)
    second = sent(10, rate, 40.0, 0.004, 0.016, seed=2, host_origin_s=1010.0 + away_s)
    stream = chained(first, second)
    time_us = np.concatenate([micro(first.device_s), micro(second.device_s, 1234)])
    counter = np.concatenate([np.arange(10 * rate), np.arange(10 * rate)])
    told = told_by(DeviceTimeline(), frames_at(time_us, counter), stream.host_s)
    assert told.total("restarted") == 1
    assert len(told.frames) == 20 * rate
    true_s = stream.true_s - stream.true_s[0]
    allowed_s = 0.03 + 3e-4 * away_s  # ten seconds of arrivals tell the drift no better
    assert np.abs(told.axis_s - true_s * (1 + 40e-6)).max() < allowed_s
    (hole,) = told.holes
    assert hole.reason == "live_restart"
    assert hole.end_s - hole.start_s == pytest.approx(away_s + 1 / rate, abs=allowed_s)
    assert np.diff(told.frames.counter.astype(np.int64))[10 * rate - 1] == pytest.approx(
        away_s * rate + 1, abs=allowed_s * rate + 1
    )


def test_a_device_that_went_on_while_the_cable_was_off_keeps_its_own_time_and_its_counter_tells_the_loss():
    stream = sent(60, 100, -30.0, 0.004, 0.05, seed=3)
    here = (stream.true_s < 1020) | (stream.true_s >= 1045)
    told = told_by(DeviceTimeline(), rows_of(frames_at(micro(stream.device_s)), here), stream.host_s[here])
    assert np.array_equal(told.frames.time_us.astype(np.int64), micro(stream.device_s, 0)[here])
    assert (told.total("lost"), told.total("restarted")) == (2500, 0)
    (hole,) = told.holes
    assert (hole.reason, hole.end_s - hole.start_s) == ("live_lost", pytest.approx(25.01, abs=0.01))


@given(
    st.lists(st.integers(3, 350), max_size=12, unique=True),
    st.lists(st.integers(3, 350), max_size=12, unique=True),
    st.integers(0, 3),
)
@settings(max_examples=15, deadline=None)
def test_lost_and_repeated_frames_are_counted_each_and_move_nothing(lost, repeated, seed):
    stream = sent(4, 100, 20.0, 0.003, 0.032, seed=seed)
    keep = np.ones(400, np.bool_)
    keep[lost] = False
    rows = np.sort(np.concatenate([np.flatnonzero(keep), [r for r in repeated if keep[r]]]).astype(np.int64))
    frames = rows_of(frames_at(micro(stream.device_s)), rows)
    told = told_by(DeviceTimeline(), frames, stream.host_s[rows])
    assert np.array_equal(told.frames.time_us.astype(np.int64), micro(stream.device_s, 0)[keep])
    assert np.array_equal(told.frames.counter, np.flatnonzero(keep))
    assert told.total("lost") == len(set(lost))
    assert told.total("repeated") == sum(keep[r] for r in repeated)


def test_a_second_of_samples_sent_twice_is_no_restart():
    stream = sent(20, 100, jitter_s=0.002, seed=1)
    rows = np.concatenate([np.arange(1000), np.arange(850, 1000), np.arange(1000, 2000)])
    host_s = np.maximum.accumulate(stream.host_s[rows])
    told = told_by(DeviceTimeline(), rows_of(frames_at(micro(stream.device_s)), rows), host_s)
    assert (told.total("repeated"), told.total("restarted"), len(told.frames)) == (150, 0, 2000)


def test_datagrams_that_overtake_each_other_cost_the_late_one():
    stream = sent(10, 100, jitter_s=0.001, seed=1)
    rows = np.arange(1000)
    rows[500:510], rows[510:520] = np.arange(510, 520), np.arange(500, 510)
    told = told_by(DeviceTimeline(), rows_of(frames_at(micro(stream.device_s)), rows), stream.host_s)
    assert (told.total("repeated"), told.total("lost"), told.total("restarted")) == (10, 10, 0)
    assert len(told.frames) == 990


@given(st.integers(5, 490), st.one_of(st.integers(0, 2**63 - 1), st.integers(0, 2**32)))
@settings(max_examples=25, deadline=None)
def test_one_absurd_time_costs_its_sample_and_nothing_else(at, absurd_us):
    stream = sent(5, 100, jitter_s=0.003, bundle_s=0.032, seed=1)
    time_us = micro(stream.device_s)
    time_us[at] = absurd_us
    told = told_by(DeviceTimeline(), frames_at(time_us), stream.host_s)
    assert told.total("restarted") == 0
    assert len(told.frames) >= 498  # a time that is only a little wrong may push the next one aside
    others = np.delete(micro(stream.device_s, 0), at)
    placed = told.frames.time_us.astype(np.int64)
    assert np.isin(placed, others).sum() >= len(placed) - 1


def test_a_line_of_absurd_times_does_not_end_the_axis():
    stream = sent(20, 100, jitter_s=0.003, seed=1)
    time_us = micro(stream.device_s)
    time_us[700:720] = np.random.default_rng(1).integers(0, 2**50, 20)
    told = told_by(DeviceTimeline(), frames_at(time_us), stream.host_s)
    assert (told.total("restarted"), told.total("absurd")) == (0, 20)
    assert told.total("lost") == 20


def test_a_clock_that_was_set_forward_is_bridged_by_the_hosts():
    stream = sent(40, 100, jitter_s=0.003, bundle_s=0.05, seed=1)
    time_us = micro(stream.device_s)
    time_us[2000:] += 3_600_000_000_000
    told = told_by(DeviceTimeline(), frames_at(time_us), stream.host_s)
    assert (told.total("restarted"), len(told.frames)) == (1, 4000)
    assert np.abs(told.axis_s - stream.device_s).max() < 0.03


def test_a_clock_of_ten_milliseconds_at_four_hundred_hertz_loses_nothing():
    stream = sent(5, 400, jitter_s=0.002, bundle_s=0.016, seed=1)
    coarse_us = micro(stream.device_s) // 10_000 * 10_000
    told = told_by(DeviceTimeline(), frames_at(coarse_us), stream.host_s)
    assert (told.total("lost"), told.total("repeated"), len(told.frames)) == (0, 0, 2000)
    assert np.abs(told.axis_s - stream.device_s).max() < 0.0101


@pytest.mark.parametrize("rate", [10, 100, 1000])
def test_samples_without_times_are_even_though_the_bus_bundles_them(rate):
    stream = sent(60, rate, 0.0, 0.004, 0.032, stall=(25.0, 2.0), seed=2)
    timeline = DeviceTimeline()
    told = told_by(timeline, frames_at(np.zeros(60 * rate)), stream.host_s, has_time=False)
    assert len(told.frames) == 60 * rate
    assert (told.total("lost"), told.holes) == (0, [])
    late = slice(20 * rate, None)
    steps_s = np.diff(told.axis_s[late])
    assert np.sqrt(np.mean((steps_s * rate - 1) ** 2)) < 0.002  # arrivals: 1.6 at 100 Hz
    error_s = told.axis_s[late] - (stream.true_s - stream.true_s[0])[late]
    assert np.ptp(error_s) < 0.006
    assert timeline.rate_hz == pytest.approx(rate, rel=2e-4)
    assert timeline.clock_ppm is None


@pytest.mark.parametrize("missing", [40, 700])
def test_lost_lines_without_times_show_as_a_pause_where_they_were(missing):
    stream = sent(60, 100, 0.0, 0.003, 0.048, seed=2)
    keep = np.ones(6000, np.bool_)
    keep[3000 : 3000 + missing] = False
    frames = frames_at(np.zeros(6000 - missing))
    told = told_by(DeviceTimeline(), frames, stream.host_s[keep], has_time=False)
    assert len(told.frames) == 6000 - missing
    (hole,) = told.holes
    assert hole.start_s == pytest.approx(30.0, abs=0.05)
    assert told.total("lost") == pytest.approx(missing, abs=2)
    assert np.abs(told.axis_s - (stream.true_s - 1000.0)[keep])[1000:].max() < 0.03


def test_another_rate_without_times_is_found_within_seconds():
    slow = sent(30, 50, jitter_s=0.003, bundle_s=0.05, seed=1)
    fast = sent(30, 100, jitter_s=0.003, bundle_s=0.05, seed=2, host_origin_s=1030.0)
    stream = chained(slow, fast)
    timeline = DeviceTimeline()
    told = told_by(timeline, frames_at(np.zeros(4500)), stream.host_s, has_time=False)
    assert timeline.rate_hz == pytest.approx(100.0, rel=0.01)
    assert told.axis_s[-1] == pytest.approx(59.99, abs=0.5)


def test_survey_time_of_a_moment_is_what_the_import_will_give():
    stream = sent(120, 100, 80.0, 0.005, 0.064, seed=4)
    timeline, frames = DeviceTimeline(), frames_at(micro(stream.device_s))
    told_by(timeline, rows_of(frames, slice(0, 3000)), stream.host_s[:3000])
    timeline.begin()
    assert timeline.survey_s(1030.0) is None
    told = told_by(timeline, rows_of(frames, slice(3000, None)), stream.host_s[3000:])
    survey_s, sigma_s = timeline.survey_s(1100.0)
    truth_s = (1100.0 - stream.true_s[3000]) * (1 + 80e-6)
    assert abs(survey_s - truth_s) < 3 * sigma_s < 0.012
    samples = timeline.to_samples(told.frames)
    assert samples.time_s[0] == 0.0
    assert samples.time_s == pytest.approx(stream.device_s[3000:] - stream.device_s[3000], abs=2e-6)
    assert samples.valid.all()
    assert samples.mag_s_ut is None


def test_samples_that_are_no_numbers_are_not_valid_and_slow_channels_hold_their_last_value():
    frames = frames_at(micro(np.arange(10) / 100))
    frames.acc_s_mps2[3, 1] = np.nan
    frames.pressure_kpa[2], frames.pressure_kpa[6] = 300.0, 301.0
    timeline = DeviceTimeline()
    samples = timeline.to_samples(timeline.place(frames, 1000.0, True).frames)
    assert samples.valid.tolist() == [row != 3 for row in range(10)]
    assert np.isfinite(samples.acc_s_mps2).all()
    assert samples.pressure_kpa.tolist() == [300.0] * 6 + [301.0] * 4


def test_nothing_and_single_samples_are_taken_too():
    timeline = DeviceTimeline()
    assert len(timeline.place(no_frames(), 1.0, True).frames) == 0
    frames = frames_at(micro(np.arange(5) / 10))
    given = [timeline.place(rows_of(frames, slice(k, k + 1)), 1.0 + k / 10, True) for k in range(5)]
    assert [len(one.frames) for one in given] == [0, 0, 3, 1, 1]  # the first three confirm each other


def test_a_device_that_begins_to_send_times_goes_on_on_the_same_axis():
    first, second = sent(20, 100, jitter_s=0.002, seed=1), sent(20, 100, jitter_s=0.002, seed=2, host_origin_s=1020.0)
    timeline = DeviceTimeline()
    before = told_by(timeline, frames_at(np.zeros(2000)), first.host_s, has_time=False)
    after = told_by(timeline, frames_at(micro(second.device_s)), second.host_s)
    assert after.axis_s[0] > before.axis_s[-1]
    assert np.abs(after.axis_s - (second.true_s - 1000.0)).max() < 0.03


@pytest.mark.parametrize("has_time", [True, False])
@pytest.mark.parametrize("is_new_clock", [True, False])
def test_a_pause_before_the_first_sample_of_a_recording_is_none_of_the_recordings(is_new_clock, has_time):
    first = sent(10, 100, seed=1)
    second = sent(10, 100, seed=2, host_origin_s=1070.0)
    timeline = DeviceTimeline()
    told_by(timeline, frames_at(micro(first.device_s)), first.host_s, has_time=has_time)
    timeline.begin()  # the device is away
    begun_us = 1234 if is_new_clock else T0_US + 70_000_000
    counter = np.arange(1000) + (0 if is_new_clock else 6000)
    told = told_by(timeline, frames_at(micro(second.device_s, begun_us), counter), second.host_s, has_time=has_time)
    assert [told.total(name) for name in ("lost", "restarted", "gap_s")] == [0, 0, 0]
    assert told.holes == []
    assert len(told.frames) == 1000


def test_a_pause_after_the_first_sample_of_a_recording_is_told_though_it_came_with_it():
    stream = sent(10, 100, seed=1)
    timeline = DeviceTimeline()
    told_by(timeline, frames_at(micro(stream.device_s)), stream.host_s)
    timeline.begin()
    later_us = T0_US + 20_000_000 + 10_000 * np.array([0, 1, 2, 10, 11])  # seven are missing
    frames = frames_at(later_us, 2000 + np.array([0, 1, 2, 10, 11]))
    placed = timeline.place(frames, float(stream.host_s[-1]) + 10.11, True)
    assert placed.lost == 7
    assert [(hole.start_s, hole.end_s) for hole in placed.holes] == [pytest.approx((0.02, 0.1), abs=1e-4)]
