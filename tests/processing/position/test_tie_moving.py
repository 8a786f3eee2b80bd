"""Tie points moved by hand keep the terms they were told in."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.coordinates import frame_of, tie_place
from processing.position.tie_moving import moved_in_time, moved_on_plan
from processing.survey import Launch, Survey, TiePoint

PATH = np.array([[0.0, 0.0], [100.0, 0.0], [100.0, 50.0], [0.0, 50.0], [0.0, 1.0]])  # nearly a loop
CHAINAGE = np.array([0.0, 100.0, 150.0, 250.0, 299.0])
LOCAL = frame_of(Survey())
places = st.floats(-500.0, 500.0)


def test_a_chainage_slides_along_the_path_to_where_it_passes_nearest():
    moved = moved_on_plan(TiePoint("valve", 5.0, chainage_m=20.0), (60.0, 3.0), LOCAL, PATH, CHAINAGE)
    assert moved.chainage_m == pytest.approx(60.0)
    assert (moved.east_m, moved.latitude) == (None, None)


def test_where_the_path_passes_twice_the_pass_near_the_old_chainage_counts():
    at_start = moved_on_plan(TiePoint("a", 5.0, chainage_m=30.0), (0.0, 0.4), LOCAL, PATH, CHAINAGE)
    at_end = moved_on_plan(TiePoint("a", 5.0, chainage_m=280.0), (0.0, 0.4), LOCAL, PATH, CHAINAGE)
    assert at_start.chainage_m == pytest.approx(0.0, abs=0.5)
    assert at_end.chainage_m == pytest.approx(299.0, abs=0.5)


@given(places, places)
def test_coordinates_of_any_kind_are_found_again_where_they_were_put(east, north):
    cases = (
        (Launch(), TiePoint("a", 1.0, east_m=1.0, north_m=2.0)),
        (Launch(latitude=40.9, longitude=29.1), TiePoint("a", 1.0, latitude=40.9, longitude=29.1)),
        (Launch(east_m=4e5, north_m=4.5e6, crs="EPSG:5254"), TiePoint("a", 1.0, east_m=4e5, north_m=4.5e6)),
    )
    for launch, tie in cases:
        frame = frame_of(Survey(launch=launch))
        moved = moved_on_plan(tie, (east, north), frame, PATH, CHAINAGE)
        assert tie_place(frame, moved)[:2] == pytest.approx((east, north), abs=2e-3)
        assert (moved.latitude is None) == (tie.latitude is None)


def test_a_tie_point_that_says_nothing_becomes_a_place():
    moved = moved_on_plan(TiePoint("new", 1.0), (7.0, 8.0), LOCAL, PATH, CHAINAGE)
    assert (moved.east_m, moved.north_m, moved.chainage_m) == (7.0, 8.0, None)


def test_its_moment_stays_within_the_run():
    tie = TiePoint("a", 5.0)
    assert [moved_in_time(tie, t, 0.0, 60.0).time_s for t in (-5.0, 12.3456, 99.0)] == [0.0, 12.346, 60.0]
