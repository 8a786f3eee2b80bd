"""The local frame against PROJ, and round trips."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.coordinates import LocalFrame, crs_code, frame_of, local_frame, route_local, tie_place
from processing.errors import ErrorCode, LeaklineError
from processing.survey import Launch, Route, Survey, TiePoint

ISTANBUL = Launch(latitude=40.9012, longitude=29.1, elevation_m=31.0)

metres = st.floats(-20_000.0, 20_000.0)


@given(metres, metres, st.floats(-200.0, 200.0), st.floats(-89.0, 89.0), st.floats(-180.0, 180.0))
def test_local_places_survive_the_way_to_wgs84_and_back(east, north, up, latitude, longitude):
    frame = LocalFrame(latitude, longitude, 31.0)
    there = frame.to_geographic([[east, north, up]])
    assert np.allclose(frame.from_geographic(there), [[east, north, up]], atol=1e-6)


def test_east_and_north_agree_with_proj_topocentric_within_a_millimetre_over_20_km():
    from pyproj import Transformer

    frame = local_frame(ISTANBUL)
    topocentric = Transformer.from_pipeline(
        "+proj=pipeline +step +proj=unitconvert +xy_in=deg +xy_out=rad +step +proj=cart +ellps=WGS84 "
        "+step +proj=topocentric +ellps=WGS84 +lon_0=29.1 +lat_0=40.9012 +h_0=31.0"
    )
    bearings = np.radians(np.arange(0.0, 360.0, 30.0))
    points = np.column_stack([20_000 * np.sin(bearings), 20_000 * np.cos(bearings), 0.0 * bearings])
    geographic = frame.to_geographic(points)
    east, north, _ = topocentric.transform(geographic[:, 1], geographic[:, 0], np.full(12, 31.0))
    assert np.allclose(np.column_stack([east, north]), points[:, :2], atol=1e-3)


def test_a_metre_north_is_a_metre_of_geodesic():
    from pyproj import Geod

    frame = local_frame(Launch(latitude=40.9012, longitude=29.1))
    latitude, longitude, _ = frame.to_geographic([[3000.0, -4000.0, 0.0]])[0]
    _, _, distance = Geod(ellps="WGS84").inv(29.1, 40.9012, longitude, latitude)
    assert distance == pytest.approx(5000.0, abs=0.002)


def test_a_level_main_stays_level_over_20_km():
    frame = local_frame(ISTANBUL)
    assert frame.to_geographic([[20_000.0, 0.0, 0.0]])[0, 2] == pytest.approx(31.0)


def test_a_launch_in_a_turkish_grid_has_its_latitude_and_gives_the_grid_back():
    frame = local_frame(Launch(east_m=500_000.0, north_m=4_530_000.0, crs="EPSG:5254", elevation_m=10.0))
    # EPSG:5254 is TUREF / TM30: on the central meridian east is 500 km exactly
    assert frame.longitude == pytest.approx(30.0, abs=1e-7)
    assert frame.latitude is not None
    assert 40.8 < frame.latitude < 41.0
    points = np.array([[100.0, 250.0, -3.0], [-2000.0, 10.0, 4.0]])
    grid = frame.to_grid(points, "EPSG:5254")
    assert np.allclose(frame.from_grid(grid, "EPSG:5254"), points, atol=1e-5)
    # on the meridian grid north is true north; the scale there is 1
    assert np.allclose(grid[0], [500_100.0, 4_530_250.0, 7.0], atol=0.01)


def test_grid_convergence_is_taken_into_account():
    # a degree and a half east of the meridian the grid is turned by about a degree
    frame = local_frame(Launch(latitude=41.0, longitude=31.5, crs="EPSG:5254"))
    start, north = frame.to_grid([[0.0, 0.0, 0.0], [0.0, 1000.0, 0.0]], "EPSG:5254")
    convergence = np.degrees(np.arctan2(start[0] - north[0], north[1] - start[1]))
    assert convergence == pytest.approx(
        np.degrees(np.arctan(np.tan(np.radians(1.5)) * np.sin(np.radians(41.0)))), abs=0.01
    )


def test_a_local_launch_with_its_own_east_and_north_shifts_the_tie_points():
    frame = local_frame(Launch(east_m=100.0, north_m=200.0))
    tie = TiePoint("hydrant", 10.0, east_m=130.0, north_m=240.0, up_m=-1.5)
    assert tie_place(frame, tie) == (30.0, 40.0, -1.5)
    assert not frame.is_geographic


def test_a_tie_point_by_latitude_needs_a_launch_in_the_world():
    tie = TiePoint("hydrant", 10.0, latitude=40.9, longitude=29.1)
    assert tie_place(LocalFrame(), tie) is None
    place = tie_place(local_frame(ISTANBUL), tie)
    assert place is not None
    assert place[1] == pytest.approx(-0.0012 * 111_060, abs=0.2)
    assert place[2] is None


def test_up_in_a_crs_is_an_elevation_and_local_up_is_above_the_launch():
    grid = Launch(east_m=500_000.0, north_m=4_530_000.0, crs="EPSG:5254", elevation_m=10.0)
    tie = TiePoint("end", 1.0, east_m=500_010.0, north_m=4_530_000.0, up_m=8.0)
    place = tie_place(local_frame(grid), tie)
    assert place is not None
    assert place[2] == pytest.approx(-2.0)


def test_a_route_in_a_crs_places_a_launch_that_has_no_coordinates():
    route = Route(((500_000.0, 4_530_000.0, 12.0), (500_100.0, 4_530_000.0, 11.0)), crs="EPSG:5254")
    frame = frame_of(Survey(route=route))
    assert np.allclose(route_local(frame, route), [[0, 0, 0], [100.0, 0.0, -1.0]], atol=0.001)


@pytest.mark.parametrize("text", ["EPSG:999999", "Istanbul", "EPSG:", "+proj=utm", "../x", "EPSG:5254; x"])
def test_an_unknown_crs_is_refused_by_name(text):
    with pytest.raises(LeaklineError) as error:
        crs_code(text)
    assert error.value.code is ErrorCode.CRS_UNKNOWN
    assert error.value.params["crs"] == text


@pytest.mark.parametrize(
    "launch", [Launch(latitude=40.0), Launch(east_m=1.0), Launch(crs="EPSG:5254"), Launch(north_m=1.0, crs="EPSG:5254")]
)
def test_half_a_launch_is_refused(launch):
    with pytest.raises(LeaklineError) as error:
        local_frame(launch)
    assert error.value.code is ErrorCode.LAUNCH_INCOMPLETE


@pytest.mark.parametrize("latitude", [91.0, float("nan")])
def test_an_impossible_latitude_is_refused(latitude):
    with pytest.raises(LeaklineError) as error:
        local_frame(Launch(latitude=latitude, longitude=29.0))
    assert error.value.code is ErrorCode.LAUNCH_INVALID


def test_grid_coordinates_far_off_the_grid_are_refused():
    with pytest.raises(LeaklineError) as error:
        local_frame(Launch(east_m=1e12, north_m=1e12, crs="EPSG:5254"))
    assert error.value.code is ErrorCode.LAUNCH_INVALID


@pytest.mark.parametrize("crs", ["EPSG:4326", "EPSG:4978", "EPSG:5773"])
def test_a_system_without_east_and_north_in_metres_is_refused(crs):
    with pytest.raises(LeaklineError) as caught:
        local_frame(Launch(east_m=29.1, north_m=40.9, crs=crs))
    assert caught.value.code is ErrorCode.CRS_UNKNOWN


def test_in_a_system_of_feet_our_numbers_are_metres():
    """New York's EPSG:2263 counts US survey feet of 1200/3937 m; its false easting is 300 000 m."""
    frame = local_frame(Launch(east_m=300_000.0, north_m=60_000.0, crs="EPSG:2263"))
    assert frame.longitude == pytest.approx(-74.0, abs=1e-6)  # the central meridian
    hundred_metres = frame.to_grid([[100.0, 0.0, 0.0]], "EPSG:2263")[0]
    assert hundred_metres[0] == pytest.approx(300_100.0, abs=0.05)


def test_a_place_that_the_projection_cannot_hold_is_refused():
    with pytest.raises(LeaklineError):
        local_frame(Launch(east_m=500_000.0, north_m=9.99e7, crs="EPSG:32635"))
