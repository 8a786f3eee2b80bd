import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from widgets.time_axis import AxisMode, DistanceMap, time_text, x_ticks
from widgets.time_cursor import TimeCursor


@pytest.fixture
def heard(cursor):
    """What the cursor has emitted, in order."""
    calls = []
    cursor.moved.connect(lambda t: calls.append(("moved", t)))
    cursor.range_changed.connect(lambda a, b: calls.append(("range", a, b)))
    cursor.axis_changed.connect(lambda: calls.append(("axis",)))
    cursor.selection_changed.connect(lambda: calls.append(("selection",)))
    return calls


def stop_and_go(steps):
    """A map from pairs (seconds, metres), with standstills where the metres are 0."""
    seconds, metres = np.array(steps, float).T
    return DistanceMap(np.concatenate(([0.0], np.cumsum(seconds))), np.concatenate(([0.0], np.cumsum(metres))))


maps = st.lists(
    st.tuples(st.floats(0.1, 50.0), st.one_of(st.just(0.0), st.floats(0.05, 80.0))), min_size=2, max_size=30
).filter(lambda steps: sum(m for _, m in steps) > 1.0)


@given(maps, st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
def test_metres_become_moments_and_the_same_metres_again(steps, parts):
    mapping = stop_and_go(steps)
    metres = np.array(parts) * mapping.chainage_m[-1]
    for back in (mapping.first_time_at(metres), mapping.last_time_at(metres)):
        np.testing.assert_allclose(mapping.chainage_at(back), metres, atol=1e-9 * mapping.chainage_m[-1])
    assert np.all(mapping.first_time_at(metres) <= mapping.last_time_at(metres) + 1e-9)


def test_a_standstill_begins_at_arrival_and_ends_at_departure():
    mapping = stop_and_go([(10.0, 5.0), (60.0, 0.0), (10.0, 5.0)])
    assert mapping.first_time_at(5.0) == 10.0
    assert mapping.last_time_at(5.0) == 70.0
    assert mapping.first_time_at(7.5) == mapping.last_time_at(7.5) == 75.0


def test_beyond_its_ends_the_track_rests():
    mapping = stop_and_go([(10.0, 0.0), (10.0, 5.0), (10.0, 0.0)])
    assert mapping.first_time_at(0.0) == mapping.first_time_at(-3.0) == 0.0
    assert mapping.last_time_at(0.0) == 10.0
    assert mapping.first_time_at(5.0) == 20.0
    assert mapping.last_time_at(5.0) == mapping.last_time_at(9.0) == 30.0


def test_a_backward_slip_of_the_estimate_leaves_the_map_monotone(make_track):
    mapping = DistanceMap.from_track(make_track([0, 1, 2, 3], [0, 5, 4, 8]))
    assert np.all(np.diff(mapping.chainage_m) >= 0)


@pytest.mark.parametrize("count", [0, 1, 2])
def test_a_track_without_way_has_no_metres(qapp, make_track, count):
    cursor = TimeCursor()
    cursor.set_track(make_track(np.arange(count), np.zeros(count)))
    assert not cursor.has_distance
    assert not cursor.set_axis_mode("distance")
    assert cursor.axis_mode is AxisMode.TIME
    assert cursor.chainage_at(0.5) is None


steps = st.one_of(
    st.tuples(st.just("set_range"), st.floats(-50, 700), st.floats(-50, 700)),
    st.tuples(st.just("set_x_range"), st.floats(-50, 700), st.floats(-50, 700)),
    st.tuples(st.just("set_time"), st.floats(-50, 700)),
    st.tuples(st.just("move_by"), st.floats(-20, 20)),
    st.tuples(st.just("zoom"), st.floats(0.05, 20)),
    st.tuples(st.just("pan"), st.floats(-300, 300)),
    st.tuples(st.just("set_axis_mode"), st.sampled_from(["time", "distance"])),
    st.tuples(st.just("fit")),
    st.tuples(st.just("set_range"), st.just(math.nan), st.just(3.0)),
    st.tuples(st.just("set_time"), st.just(math.inf)),
)


@settings(max_examples=60)
@given(st.lists(steps, max_size=15))
def test_whatever_one_does_the_view_stays_on_the_data_and_switching_units_does_not_drift(actions):
    cursor = TimeCursor()
    cursor.set_extent(-10.0, 620.0)
    cursor.set_track(a_track())
    for name, *arguments in actions:
        getattr(cursor, name)(*arguments)
        low, high = cursor.x_range
        first, last = cursor.x_extent
        tolerance = 1e-9 * (last - first)
        assert first - tolerance <= low < high <= last + tolerance
        assert cursor.extent_s[0] <= cursor.time_s <= cursor.extent_s[1]
        assert cursor.range_s[0] < cursor.range_s[1]
    start = cursor.axis_mode
    for _ in range(2):  # the first switch may need to widen a standstill to something visible
        cursor.set_axis_mode("distance")
        cursor.set_axis_mode("time")
    settled = (cursor.range_s, cursor.range_m, cursor.time_s)
    for _ in range(10):
        cursor.set_axis_mode("distance")
        cursor.set_axis_mode("time")
    cursor.set_axis_mode(start)
    assert (cursor.range_s, cursor.range_m, cursor.time_s) == settled


def a_track():
    from processing.survey import Track

    time_s = np.arange(0.0, 600.0, 0.5)
    chainage = np.cumsum(np.where((time_s > 100) & (time_s < 200), 0.0, 0.4))
    zeros = np.zeros(len(time_s))
    position = np.stack((chainage, zeros, zeros), axis=1)
    quat = np.tile([1.0, 0, 0, 0], (len(time_s), 1))
    return Track(time_s, chainage, position, zeros, zeros, zeros, quat, zeros, "x")


def test_the_visible_seconds_are_the_visible_metres(cursor):
    cursor.set_range(100.0, 400.0)
    assert cursor.range_m == pytest.approx((50.0, 200.0))
    cursor.set_axis_mode("distance")
    assert cursor.range_s == (100.0, 400.0)
    cursor.set_x_range(60.0, 150.0)
    assert cursor.range_s == pytest.approx((120.0, 350.0))
    assert cursor.range_m == (60.0, 150.0)


def test_setting_what_is_set_says_nothing(cursor, heard):
    cursor.set_range(100.0, 200.0)
    cursor.set_time(150.0)
    cursor.set_selection(1.0, 2.0)
    heard.clear()
    cursor.set_range(100.0, 200.0)
    cursor.set_time(150.0)
    cursor.set_axis_mode("time")
    cursor.set_selection(2.0, 1.0)
    assert heard == []


def test_two_cursors_that_follow_each_other_come_to_rest(cursor, track, qapp):
    other = TimeCursor()
    other.set_extent(-10.0, 620.0)
    other.set_track(track)
    for a, b in ((cursor, other), (other, cursor)):
        a.moved.connect(b.set_time)
        a.range_changed.connect(b.set_range)
    cursor.set_range(33.3, 77.7)
    other.set_time(50.123456789)
    cursor.zoom(0.3)
    assert other.range_s == cursor.range_s
    assert other.time_s == cursor.time_s == 50.123456789


def test_zooming_keeps_the_place_it_is_about(cursor):
    for mode in ("time", "distance"):
        cursor.set_axis_mode(mode)
        cursor.fit()
        low, high = cursor.x_range
        about = low + 0.3 * (high - low)
        cursor.zoom(0.1, about)
        new_low, new_high = cursor.x_range
        assert (about - new_low) / (new_high - new_low) == pytest.approx(0.3)
        assert new_high - new_low == pytest.approx(0.1 * (high - low))


def test_a_moment_out_of_view_scrolls_into_view_without_zooming(cursor):
    cursor.set_range(100.0, 150.0)
    cursor.set_time(400.0)
    start, end = cursor.range_s
    assert start <= 400.0 <= end
    assert end - start == pytest.approx(50.0)
    cursor.set_time(10.0, reveal=False)
    assert cursor.range_s == (start, end)


def test_a_standstill_is_one_column_in_metres(cursor):
    cursor.set_axis_mode("distance")
    edges = cursor.column_edges_s(100)
    assert edges[0] == -10.0
    assert edges[-1] == 620.0
    assert np.all(np.diff(edges) >= 0)
    widths = np.diff(edges)
    assert np.count_nonzero(widths >= 100.0) == 1
    assert widths[0] == pytest.approx(18.0, abs=0.2)  # ten seconds before the launch, and 4 m at 0.5 m/s


def test_ticks_are_round_and_few():
    for mode in AxisMode:
        for span in (0.01, 0.7, 9.0, 59.0, 400.0, 3601.0, 50_000.0):
            ticks, step = x_ticks(17.3, 17.3 + span, mode, 8)
            assert 1 <= len(ticks) <= 9
            assert all(17.3 - 1e-6 <= t <= 17.3 + span + 1e-6 for t in ticks)
            assert all(math.isclose(t / step, round(t / step), abs_tol=1e-6) for t in ticks)


@pytest.mark.parametrize(
    ("time_s", "step_s", "text"),
    [
        (0, 1, "0:00"),
        (59.96, 0.1, "1:00.0"),
        (3599.7, 1, "1:00:00"),
        (3661, 60, "1:01:01"),
        (-5, 1, "−0:05"),
        (7.25, 0.05, "0:07.25"),
    ],
)
def test_times_are_written_as_people_write_them(time_s, step_s, text):
    assert time_text(time_s, step_s) == text
