"""From pieces of a map to the route of a survey: joined, turned, cut at the launch, in metres where pyproj says."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pyproj
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from route_files import GRID, in_degrees, main_pipe, write

from processing.coordinates import frame_of, route_local
from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files import crs as systems
from processing.importing.route_files.building import FROM_LAUNCH, RouteChoice, route_from
from processing.importing.route_files.joining import one_line, sections_of, with_connections
from processing.importing.route_files.lines import RouteLineString
from processing.importing.route_files.registry import read_route_file
from processing.survey import Launch, PipeInfo, Survey

METRES = (1.0, 1.0)
PIPE = main_pipe()


def line(*points, name="", layer="su"):
    rows = np.array(points, dtype=np.float64)
    return RouteLineString(
        name, layer, np.column_stack([rows, np.zeros((len(rows), 3 - rows.shape[1]))]), rows.shape[1] > 2
    )


def whole(points, *, has_z=True):
    return one_line(sections_of([replace(line((0, 0), (1, 1)), points=points, has_z=has_z)], METRES), METRES)


def survey_at(point, crs=GRID, length_m=None, elevation_m=None):
    longitude, latitude = in_degrees(np.array([[*point[:2], 0.0]]), crs)[0, :2]
    return Survey(
        launch=Launch(latitude=latitude, longitude=longitude, elevation_m=elevation_m), pipe=PipeInfo(length_m=length_m)
    )


def ground_length(points, crs=GRID):
    degrees = in_degrees(points, crs)
    geod = pyproj.Geod(ellps="WGS84")
    flat = [geod.inv(*a[:2], *b[:2])[2] for a, b in pairwise(degrees)]
    return float(np.hypot(flat, np.diff(points[:, 2])).sum())


# --- joining ---


@settings(max_examples=40, deadline=None)
@given(st.lists(st.integers(2, 60), max_size=6, unique=True), st.randoms(use_true_random=False))
def test_a_cut_up_line_is_one_again_whatever_the_order_and_directions_of_its_pieces(cuts, chance):
    points = main_pipe(3, 64)
    edges = sorted({0, 63, *cuts})
    pieces = [points[a : b + 1] for a, b in pairwise(edges)]
    shuffled = [piece[::-1] if chance.random() < 0.5 else piece for piece in pieces]
    chance.shuffle(shuffled)
    sections = sections_of([replace(line((0, 0), (1, 1)), points=p, has_z=True) for p in shuffled], METRES)
    assert len(sections) == 1
    found = sections[0].points if np.allclose(sections[0].points[0], points[0]) else sections[0].points[::-1]
    np.testing.assert_array_equal(found, points)


def test_where_lines_branch_sections_end_and_the_shortest_way_connects_the_chosen():
    network = [
        line((0, 0), (10, 0), name="a"), line((10, 0), (20, 0), name="b"), line((10, 0), (10, 5), name="service"),
        line((20, 0), (30, 0), name="c"), line((20, 0), (20, 50), (30, 0.0), name="detour"),
        line((30, 0), (40, 0), name="d"),
    ]  # fmt: skip
    sections = sections_of(network, METRES)
    at = {section.name: k for k, section in enumerate(sections)}
    assert len(sections) == 6
    ends = [sections[at["a"]], sections[at["d"]]]
    with pytest.raises(LeaklineError) as caught:
        one_line(ends, METRES)
    assert caught.value.code is ErrorCode.ROUTE_NOT_ONE_LINE
    assert caught.value.params["gap_m"] == pytest.approx(20.0)
    connected = with_connections(sections, [at["a"], at["d"]], METRES)
    assert {sections[k].name for k in connected} == {"a", "b", "c", "d"}
    joined = one_line([sections[k] for k in sorted(connected)], METRES)
    assert sorted(joined.points[:, 0]) == [0, 10, 20, 30, 40]


def test_pieces_of_other_layers_are_not_joined_by_themselves():
    assert len(sections_of([line((0, 0), (9, 0)), line((9, 0), (20, 0), layer="sewer")], METRES)) == 2


def test_ends_that_nearly_meet_leave_no_hook():
    near = [line((0, 0), (10.3, 0)), line((10, 0.1), (20, 0))]
    (joined,) = sections_of(near, METRES)
    assert joined.length_m(METRES) == pytest.approx(20.0, abs=0.01)
    assert len(sections_of([line((0, 0), (9, 0)), line((10, 0), (20, 0))], METRES)) == 2
    assert len(sections_of([line((0, 0), (9, 0)), line((10, 0), (20, 0))], METRES, 1.5)) == 1


def test_degrees_are_joined_by_metres():
    here = in_degrees(
        np.array([[424_000.0, 4_528_000.0, 0.0], [424_000.4, 4_528_000.0, 0.0], [424_001.2, 4_528_000.0, 0.0]])
    )
    scale = systems.metres_scale("EPSG:4326", here)
    step = np.hypot(*((here[2] - here[0])[:2] * scale))
    assert step == pytest.approx(1.2, rel=0.005)
    far, other = here[0] - [0.01, 0, 0], here[2] + [0.01, 0, 0]
    assert len(sections_of([line(far, here[0]), line(here[1], other)], scale)) == 1
    assert len(sections_of([line(far, here[0]), line(here[2], other)], scale)) == 2


def test_a_ring_stays_a_ring():
    ring = [line((0, 0), (10, 0), (10, 10)), line((10, 10), (0, 10), (0, 0))]
    (joined,) = sections_of(ring, METRES)
    assert joined.length_m(METRES) == pytest.approx(40.0)


# --- the route ---


@pytest.mark.parametrize("crs", ["EPSG:5254", "EPSG:32635", "EPSG:23035", "EPSG:4326", "EPSG:4230", "EPSG:2320"])
def test_the_route_lies_where_pyproj_puts_it_to_a_millimetre(crs):
    here = pyproj.Transformer.from_crs(GRID, crs, always_xy=True).transform(PIPE[:, 0], PIPE[:, 1])
    given = np.column_stack([*here, PIPE[:, 2]])
    longitude, latitude = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True).transform(*here)
    built = route_from(whole(given), RouteChoice(crs), Survey())
    assert built.route.crs == (crs if crs not in ("EPSG:4326", "EPSG:4230") else "EPSG:32635")
    found = pyproj.Transformer.from_crs(built.route.crs, "EPSG:4326", always_xy=True)
    lon, lat = found.transform(*np.array(built.route.points)[:, :2].T)
    away = np.array(pyproj.Geod(ellps="WGS84").inv(lon, lat, longitude, latitude)[2])
    assert away.max() < 0.001
    np.testing.assert_allclose(np.array(built.route.points)[:, 2], PIPE[:, 2], atol=1e-3)


def test_the_length_is_the_one_on_the_ground_not_in_the_projection():
    built = route_from(whole(PIPE), RouteChoice(GRID), Survey())
    assert built.length_m == pytest.approx(ground_length(PIPE), rel=2e-5)  # 50 m above the ellipsoid: 8e-6
    utm = pyproj.Transformer.from_crs(GRID, "EPSG:32635", always_xy=True).transform(PIPE[:, 0], PIPE[:, 1])
    in_utm = route_from(whole(np.column_stack([*utm, PIPE[:, 2]])), RouteChoice("EPSG:32635"), Survey())
    assert in_utm.length_m == pytest.approx(built.length_m, rel=1e-6)


def test_feet_become_metres():
    feet = np.array([[985_000.0, 197_000.0, 100.0], [985_328.0833333, 197_000.0, 100.0]])  # New York, 100 m
    built = route_from(whole(feet), RouteChoice("EPSG:2263"), Survey())
    assert built.length_m == pytest.approx(100.0, abs=0.02)
    assert built.route.points[0][2] == pytest.approx(100.0 * 1200.0 / 3937.0, abs=1e-3)
    lon, lat = pyproj.Transformer.from_crs("EPSG:2263", "EPSG:4326", always_xy=True).transform(985_000.0, 197_000.0)
    frame = frame_of(Survey(route=built.route))
    assert (frame.longitude, frame.latitude) == (pytest.approx(lon, abs=1e-9), pytest.approx(lat, abs=1e-9))


@pytest.mark.parametrize("drawn_back", [False, True])
def test_the_route_begins_at_the_launch_whichever_way_it_was_drawn(drawn_back):
    points = PIPE[::-1] if drawn_back else PIPE
    built = route_from(whole(points), RouteChoice(GRID), survey_at(PIPE[0]))
    assert built.reversed is drawn_back
    np.testing.assert_allclose(built.route.points[0][:2], PIPE[0, :2], atol=0.01)
    assert built.launch_off_m == pytest.approx(0.0, abs=0.01)


def test_what_lies_before_the_launch_is_cut_off_and_the_length_decides_the_direction():
    launch = 0.5 * (PIPE[10] + PIPE[11])
    after, before = ground_length(np.vstack([launch, PIPE[11:]])), ground_length(np.vstack([PIPE[:11], launch]))
    for wanted, backwards in ((after, False), (before, True)):
        built = route_from(whole(PIPE), RouteChoice(GRID), survey_at(launch, length_m=wanted, elevation_m=launch[2]))
        assert built.reversed is backwards
        assert built.length_m == pytest.approx(wanted, rel=1e-4)
        assert [f.code for f in built.findings] == ["route_clipped"]
        np.testing.assert_allclose(built.route.points[0], launch, atol=0.01)
    kept = route_from(whole(PIPE), RouteChoice(GRID, clip=False), survey_at(launch))
    assert len(kept.route.points) == len(PIPE)


def test_a_map_that_goes_on_after_the_retrieval_is_no_reason_to_turn_round():
    launch = 0.5 * (PIPE[8] + PIPE[9])
    after, before = ground_length(np.vstack([launch, PIPE[9:]])), ground_length(np.vstack([PIPE[:9], launch]))
    wanted = before + 0.3 * (after - before)  # nearer to the length of the wrong side, which is too short
    built = route_from(whole(PIPE), RouteChoice(GRID), survey_at(launch, length_m=wanted))
    assert not built.reversed
    assert built.length_m == pytest.approx(after, rel=1e-4)


@pytest.mark.parametrize(("heading_deg", "backwards"), [(80.0, False), (275.0, True)])
def test_a_stated_heading_decides_the_direction(heading_deg, backwards):
    survey = survey_at(0.5 * (PIPE[20] + PIPE[21]))
    survey = replace(survey, launch=replace(survey.launch, heading_deg=heading_deg))
    assert route_from(whole(PIPE), RouteChoice(GRID), survey).reversed is backwards


def test_the_operator_has_the_last_word_on_the_direction():
    built = route_from(whole(PIPE), RouteChoice(GRID, reverse=True, clip=False), survey_at(PIPE[0]))
    np.testing.assert_allclose(built.route.points[0], PIPE[-1], atol=1e-3)


def test_a_length_that_does_not_fit_and_a_launch_far_away_are_told():
    codes = [f.code for f in route_from(whole(PIPE), RouteChoice(GRID), survey_at(PIPE[0], length_m=900.0)).findings]
    assert codes == ["route_length_differs"]
    away = survey_at(PIPE[0] + [0.0, 300.0, 0.0])
    assert "route_far_from_launch" in [f.code for f in route_from(whole(PIPE), RouteChoice(GRID), away).findings]


def test_a_map_without_heights_is_level_with_the_launch():
    survey = survey_at(PIPE[0], elevation_m=31.0)
    built = route_from(whole(PIPE, has_z=False), RouteChoice(GRID), survey)
    np.testing.assert_allclose(route_local(frame_of(survey), built.route)[:, 2], 0.0, atol=1e-9)


def test_a_drawing_of_its_own_begins_at_the_launch_in_its_unit():
    drawing = whole(np.array([[7000.0, 5000.0, 0.0], [7000.0, 25_000.0, 0.0]]), has_z=False)
    built = route_from(drawing, RouteChoice(FROM_LAUNCH, unit_m=0.001), Survey())
    assert built.route.points == ((0.0, 0.0, 0.0), (0.0, 20.0, 0.0))
    back = route_from(drawing, RouteChoice(FROM_LAUNCH, unit_m=0.001, reverse=True), Survey())
    assert back.route.points == ((0.0, 0.0, 0.0), (0.0, -20.0, 0.0))


def test_swapped_columns_are_found_out_and_swapped():
    swapped = whole(PIPE[:, [1, 0, 2]])
    with pytest.raises(LeaklineError) as caught:
        route_from(swapped, RouteChoice("EPSG:4326"), Survey())
    assert caught.value.code is ErrorCode.ROUTE_OUTSIDE_CRS
    built = route_from(swapped, RouteChoice(GRID, swap=True), Survey())
    np.testing.assert_allclose(built.route.points, PIPE, atol=1e-3)


def test_the_wrong_zone_is_told():
    built = route_from(whole(PIPE), RouteChoice("EPSG:25830"), Survey())  # Spain's; TM30 has the same numbers
    assert built.findings == ()
    far = route_from(whole(PIPE + np.array([4e6, 0, 0])), RouteChoice(GRID), Survey())
    assert [f.code for f in far.findings] == ["route_outside_area"]


# --- coordinate systems ---


@pytest.mark.parametrize(
    "text", ["EPSG:5254", "5254", "urn:ogc:def:crs:EPSG::5254", "http://www.opengis.net/def/crs/EPSG/0/5254"]
)
def test_a_system_is_known_by_all_its_names(text):
    assert systems.known_crs(text) == "EPSG:5254"


@pytest.mark.parametrize("text", ["EPSG:999999", "EPSG:4978", "EPSG:5703", "+proj=utm +zone=35", "Atlantis"])
def test_what_is_no_system_of_a_map_is_refused(text):
    with pytest.raises(LeaklineError):
        systems.known_crs(text)


@pytest.mark.parametrize("code", [5254, 32635, 27700, 2263, 4326, 25832, 23035, 2320])
@pytest.mark.parametrize("form", ["WKT1_ESRI", "WKT1_GDAL", "WKT2_2019"])
def test_a_prj_is_known_again(code, form):
    assert systems.crs_of_wkt(pyproj.CRS.from_epsg(code).to_wkt(form)) == f"EPSG:{code}"


def test_a_grid_without_a_code_is_kept_and_its_route_goes_into_utm(tmp_path):
    own = pyproj.CRS.from_wkt(pyproj.CRS.from_epsg(5254).to_wkt("WKT1_ESRI").replace("500000.0", "777000.0"))
    shifted = PIPE + np.array([277_000.0, 0.0, 0.0])
    file = read_route_file(write(tmp_path / "own.shp", "ESRI Shapefile", [shifted], own.to_wkt("WKT1_ESRI")))
    assert not file.crs.startswith("EPSG")
    built = route_from(whole(file.lines[0].points), RouteChoice(file.crs), Survey())
    assert built.route.crs == "EPSG:32635"
    lon, lat = pyproj.Transformer.from_crs("EPSG:32635", "EPSG:4326", always_xy=True).transform(
        *built.route.points[5][:2]
    )
    np.testing.assert_allclose([lon, lat], in_degrees(PIPE)[5, :2], atol=2e-8)


def test_the_systems_of_the_place_come_first():
    entries = systems.all_systems()
    first = [entry.code for entry in systems.search(entries, "", near=(29.1, 40.9), limit=4)]
    assert "EPSG:5254" in first
    assert systems.search(entries, "turef tm30")[0].code == "EPSG:5254"
    assert systems.search(entries, "27700")[0].name.startswith("OSGB36")
