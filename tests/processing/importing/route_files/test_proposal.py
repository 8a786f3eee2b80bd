"""What the window offers of a route file, before and after the operator has answered."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from route_files import GRID, in_degrees, main_pipe

from processing.errors import ErrorCode
from processing.importing.route_files.crs import all_systems
from processing.importing.route_files.lines import CrsSource, RouteFile, RouteLineString
from processing.importing.route_files.proposal import first_answer, fitting_systems, pieces_of, propose
from processing.progress import silent
from processing.survey import Launch, Survey

PIPE = main_pipe()
SIDE = PIPE[15] + np.array([[0.0, 0.0, 0.0], [5.0, 300.0, 0.0]])


def file_of(*lines, crs=GRID, kind="GeoPackage"):
    named = tuple(RouteLineString(f"{k}", "su", points, has_z=True) for k, points in enumerate(lines))
    return RouteFile(Path("main.gpkg"), kind, named, crs, CrsSource.FILE if crs else CrsSource.ASK)


def launched(point):
    longitude, latitude = in_degrees(point[None, :])[0, :2]
    return Survey(launch=Launch(latitude=latitude, longitude=longitude))


NETWORK = file_of(PIPE[:16], PIPE[15:], SIDE)


def test_the_section_at_the_launch_is_offered_and_the_launch_lies_on_its_end():
    survey = launched(PIPE[-1])
    proposal = propose(NETWORK, first_answer(NETWORK, survey), survey, silent())
    (chosen,) = proposal.chosen
    assert proposal.sections[chosen].pieces == (1,)
    assert proposal.built.reversed
    np.testing.assert_allclose(proposal.way[0], proposal.launch, atol=0.01)


def test_what_was_chosen_stays_chosen_when_the_gap_changes():
    survey = launched(PIPE[0])
    answer = replace(first_answer(NETWORK, survey), pieces=frozenset([0, 1]))
    proposal = propose(NETWORK, answer, survey, silent())
    assert proposal.built.length_m == pytest.approx(np.linalg.norm(np.diff(PIPE, axis=0), axis=1).sum(), rel=1e-3)
    wider = propose(NETWORK, replace(answer, tolerance_m=2.0), survey, silent())
    assert pieces_of(wider, wider.chosen) == {0, 1}


def test_the_missing_middle_is_found_by_the_shortest_way():
    file = file_of(PIPE[:11], PIPE[10:21], PIPE[20:], SIDE, PIPE[10] + np.array([[0.0, 0, 0], [0, -50.0, 0]]),
                   PIPE[20] + np.array([[0.0, 0, 0], [0, -50.0, 0]]))  # fmt: skip
    answer = replace(first_answer(file, Survey()), pieces=frozenset([0, 2]))
    apart = propose(file, answer, Survey(), silent())
    assert (apart.built, apart.error.code) == (None, ErrorCode.ROUTE_NOT_ONE_LINE)
    joined = propose(file, replace(answer, connect=True), Survey(), silent())
    assert pieces_of(joined, joined.chosen) == {0, 1, 2}
    assert joined.built is not None


def test_without_a_system_the_map_is_drawn_and_the_system_asked():
    file = file_of(PIPE, crs=None)
    proposal = propose(file, first_answer(file, Survey()), Survey(), silent())
    assert proposal.error.code is ErrorCode.ROUTE_NEEDS_CRS
    assert proposal.lengths_m[0] == pytest.approx(np.hypot(*np.diff(PIPE[:, :2], axis=0).T).sum())
    in_launch_grid = first_answer(file, Survey(launch=Launch(east_m=PIPE[0, 0], north_m=PIPE[0, 1], crs=GRID)))
    assert in_launch_grid.crs == GRID


def test_the_map_shows_only_what_was_kept():
    launch = 0.5 * (PIPE[10] + PIPE[11])
    file, survey = file_of(PIPE), launched(launch)
    proposal = propose(file, first_answer(file, survey), survey, silent())
    np.testing.assert_allclose(proposal.way[0], proposal.launch, atol=0.5)
    assert np.hypot(*np.diff(proposal.way, axis=0).T).sum() == pytest.approx(proposal.built.length_m, rel=0.02)


def test_degrees_and_swapped_columns_are_drawn_in_metres_north_up():
    degrees = in_degrees(PIPE)
    straight = file_of(degrees, crs="EPSG:4326")
    answer = first_answer(straight, Survey())
    shown = propose(straight, answer, Survey(), silent()).planes[0]
    np.testing.assert_allclose(
        shown[-1] - shown[0], (PIPE[-1] - PIPE[0])[:2], atol=8.0
    )  # the grid's north is not quite north
    swapped = file_of(PIPE[:, [1, 0, 2]])
    survey = launched(PIPE[0])
    turned = propose(swapped, replace(first_answer(swapped, survey), swap=True), survey, silent())
    np.testing.assert_allclose(turned.planes[0][-1] - turned.planes[0][0], (PIPE[-1] - PIPE[0])[:2])
    np.testing.assert_allclose(turned.launch, turned.planes[0][0], atol=0.01)


def test_handheld_tracks_are_trusted_less():
    assert first_answer(file_of(PIPE, kind="GPX"), Survey()).sigma_m > first_answer(NETWORK, Survey()).sigma_m


def test_a_drawing_without_a_system_is_tried_in_those_of_the_place():
    file = file_of(PIPE * [1000.0, 1000.0, 1.0], crs=None, kind="DXF")
    longitude, latitude = in_degrees(PIPE[:1])[0, :2]
    entries = all_systems()
    found = fitting_systems(replace(file, unit_m=0.001), entries, (longitude, latitude))
    assert found[0] == (GRID, pytest.approx(0.0, abs=0.01))
    others = dict(found)
    assert 50.0 < others["EPSG:2320"] < 400.0  # the same grid on the old datum
    assert fitting_systems(file, entries, None) == ()
