"""Typed coordinates become a place along the path."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_survey import make_track

from processing.coordinates import LocalFrame, local_frame
from processing.dig_place import local_place, on_path
from processing.errors import ErrorCode, LeaklineError
from processing.survey import Launch

ANKARA = local_frame(Launch(latitude=39.92, longitude=32.85, crs="EPSG:32636", east_m=487_180.0, north_m=4_418_800.0))


def test_a_place_beside_a_straight_path_is_projected_onto_it():
    found = on_path(make_track(), 43.2, -1.5)  # the path runs east: south of it is to the right
    assert (found.chainage_m, found.across_m) == (pytest.approx(43.2), pytest.approx(1.5))
    assert on_path(make_track(), 43.2, 2.0).across_m == pytest.approx(-2.0)
    assert on_path(make_track(), -5.0, 0.0).chainage_m == pytest.approx(0.0)


@given(st.floats(0.5, 99.5), st.floats(-3.0, 3.0), st.floats(-3.1, 3.1))
def test_the_projection_does_not_depend_on_where_the_path_heads(at, beside, heading):
    straight = make_track()
    turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    turned = replace(
        straight, position_w_m=np.column_stack([straight.position_w_m[:, :2] @ turn, straight.position_w_m[:, 2]])
    )
    east, north = np.array([at, -beside]) @ turn
    found = on_path(turned, east, north)
    assert found.chainage_m == pytest.approx(at, abs=1e-6)
    assert found.across_m == pytest.approx(beside, abs=1e-6)


def test_where_the_pipe_passes_twice_the_pass_near_the_stated_place_is_meant():
    track = make_track()
    there_and_back = track.position_w_m.copy()
    there_and_back[:, 0] = 50.0 - np.abs(track.chainage_m - 50.0)
    looped = replace(track, position_w_m=there_and_back)
    assert on_path(looped, 30.0, 0.1, near_m=28.0).chainage_m == pytest.approx(30.0)
    assert on_path(looped, 30.0, 0.1, near_m=75.0).chainage_m == pytest.approx(70.0)


@pytest.mark.parametrize(
    "text", ["39.9209, 32.8512", "39.9209 32.8512", "39.9209,32.8512", "39,9209 32,8512", "39.9209° N 32.8512° E"]
)
def test_degrees_are_read_however_people_write_them(text):
    east, north = local_place(text, ANKARA)
    expected = ANKARA.from_geographic([[39.9209, 32.8512, 0.0]])[0]
    assert (east, north) == (pytest.approx(expected[0]), pytest.approx(expected[1]))
    assert north == pytest.approx(99.9, abs=0.2)  # 0.0009° of latitude


@pytest.mark.parametrize(
    ("text", "latitude", "longitude"),
    [
        ("40.1234 N 75.4321 W", 40.1234, -75.4321),
        ("N40.1234, W75.4321", 40.1234, -75.4321),
        ("W 75.4321 N 40.1234", 40.1234, -75.4321),
        ("33,8765° S; 151,2012° E", -33.8765, 151.2012),
        ("-33.8765 S 151.2012 E", -33.8765, 151.2012),
        ("39,9209 K 32,8512 D", 39.9209, 32.8512),  # kuzey, doğu
        ("32,8512 d 39,9209 k", 39.9209, 32.8512),
        ("33,8765 G 70,6543 B", -33.8765, -70.6543),  # güney, batı
    ],
)
def test_the_letters_of_the_compass_give_sign_and_order(text, latitude, longitude):
    frame = local_frame(Launch(latitude=latitude, longitude=longitude))
    assert local_place(text, frame) == (pytest.approx(0.0, abs=1e-6), pytest.approx(0.0, abs=1e-6))


def test_east_and_north_are_those_of_the_surveys_grid():
    grid = ANKARA.to_grid([[12.0, 34.0, 0.0]], "EPSG:32636")[0]
    assert local_place(f"{grid[0]:.3f} {grid[1]:.3f}", ANKARA) == (
        pytest.approx(12.0, abs=0.01), pytest.approx(34.0, abs=0.01)
    )  # fmt: skip
    assert local_place("12,5; 34", LocalFrame()) == (12.5, 34.0)


@pytest.mark.parametrize(
    "text", ["", "12.5", "abc def", "1 2 3", "nan 4", "39,92,32,85", "39.9 N 32.8 N", "N39.9E 32.8"]
)
def test_what_is_no_pair_of_numbers_is_refused(text):
    with pytest.raises(LeaklineError) as caught:
        local_place(text, ANKARA)
    assert caught.value.code is ErrorCode.PLACE_UNREADABLE
