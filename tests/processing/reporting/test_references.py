"""Ellipse and tape distances against drawn samples and closed forms."""

from dataclasses import replace

import numpy as np
import pytest

from processing.coordinates import frame_of
from processing.reporting.references import (
    LAUNCH,
    Reference,
    covariance,
    ellipse,
    nearest_tapes,
    references,
    tape,
)
from processing.survey import Finding, Severity, TiePoint

SIGMA_M = 0.5  # of the path in the fixture, along and across


@pytest.mark.parametrize("seed", range(4))
def test_nineteen_of_twenty_places_lie_within_the_ellipse(seed):
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(2, 2)) * [3.0, 0.7]
    cov = root @ root.T
    found = ellipse(cov)
    drawn = rng.multivariate_normal([0.0, 0.0], cov, 40_000)
    bearing = np.radians(found.bearing_deg)
    along = drawn @ [np.sin(bearing), np.cos(bearing)]
    aside = drawn @ [np.cos(bearing), -np.sin(bearing)]
    within = (along / found.major_m) ** 2 + (aside / found.minor_m) ** 2 <= 1.0
    assert np.mean(within) == pytest.approx(0.95, abs=0.005)
    assert np.std(along) > np.std(aside)


def test_an_ellipse_along_a_road_to_the_north_east_points_there():
    way = np.array([1.0, 1.0]) / np.sqrt(2.0)
    found = ellipse(4.0 * np.outer(way, way) + 0.01 * np.eye(2))
    assert found.bearing_deg == pytest.approx(45.0)
    assert found.major_m == pytest.approx(2.4477 * np.sqrt(4.01), rel=1e-4)


def test_the_ellipse_holds_what_clock_and_sound_add_along_the_pipe(results):
    wide = replace(results.candidates[0], chainage_low95_m=42.0 - 1.96, chainage_high95_m=42.0 + 1.96)
    cov = covariance(wide, results)
    way = np.array([1.0, 1.0]) / np.sqrt(2.0)
    aside = np.array([1.0, -1.0]) / np.sqrt(2.0)
    assert way @ cov @ way == pytest.approx(1.0, rel=1e-3)  # 1.96 m is one sigma of a metre
    assert aside @ cov @ aside == pytest.approx(SIGMA_M**2)


def test_the_fits_own_covariance_is_used_where_there_is_one(results):
    count = results.track.time_s.size
    track = replace(results.track, cov_level_m2=np.tile([9.0, 1.0, 4.0], (count, 1)))
    thin = replace(results.candidates[0], chainage_low95_m=42.0, chainage_high95_m=42.0)
    assert covariance(thin, replace(results, track=track)) == pytest.approx(np.array([[9.0, 1.0], [1.0, 4.0]]))


def test_references_are_the_launch_and_the_tie_points_that_are_on(results):
    off = TiePoint("off", 100.0, chainage_m=50.0, enabled=False)
    survey = replace(results.survey, tie_points=(*results.survey.tie_points, off))
    known = references(replace(results, survey=survey))
    assert [(r.name, r.chainage_m) for r in known] == [(LAUNCH, 0.0), ("valve 12", 30.0), ("hydrant", 80.0)]
    assert known[1].place_m == pytest.approx((30 / np.sqrt(2), 30 / np.sqrt(2)), abs=0.01)


def test_a_tie_point_with_coordinates_is_where_it_was_surveyed(results):
    frame = frame_of(results.survey)
    (latitude, longitude, _), *_ = frame.to_geographic([[20.0, 25.0, 0.0]])
    tie = TiePoint("manhole", 60.0, latitude=float(latitude), longitude=float(longitude), sigma_m=0.3)
    (_, manhole) = references(replace(results, survey=replace(results.survey, tie_points=(tie,))))
    assert manhole.place_m == pytest.approx((20.0, 25.0), abs=0.01)
    assert manhole.cov_m2 == pytest.approx((0.09, 0.0, 0.09))
    assert manhole.sigma_m == pytest.approx(SIGMA_M)  # its chainage is only what the path says


def test_one_reference_either_side_is_chosen_and_the_way_is_told(results):
    back, on = nearest_tapes(results.candidates[0], results, references(results))
    assert (back.name, back.onward, back.along_m) == ("valve 12", True, pytest.approx(12.0))
    assert (on.name, on.onward, on.along_m) == ("hydrant", False, pytest.approx(38.0))
    assert back.bearing_deg == pytest.approx(45.0, abs=0.1)
    assert on.bearing_deg == pytest.approx(225.0, abs=0.1)


def test_beyond_the_last_reference_the_two_nearest_stand(results):
    far = replace(results.candidates[0], chainage_m=95.0)
    assert [t.name for t in nearest_tapes(far, results, references(results))] == ["hydrant", "valve 12"]


def test_the_surface_distance_and_its_interval_agree_with_drawn_places(results):
    rng = np.random.default_rng(7)
    count = results.track.time_s.size
    track = replace(results.track, cov_level_m2=np.tile([2.0, 0.8, 1.0], (count, 1)))
    told = replace(results, track=track)
    reference = Reference("valve", 20.0, 0.5, (3.0, -14.0), (0.25, 0.1, 0.16))
    found = tape(told.candidates[0], told, reference)
    cov = covariance(told.candidates[0], told)
    leaks = rng.multivariate_normal(told.candidates[0].position_w_m[:2], cov, 60_000)
    places = rng.multivariate_normal(reference.place_m, [[0.25, 0.1], [0.1, 0.16]], 60_000)
    apart = np.hypot(*(leaks - places).T)
    assert found.surface_m == pytest.approx(np.mean(apart), abs=0.05)
    assert found.surface_95_m == pytest.approx(1.96 * np.std(apart), rel=0.03)
    assert found.along_95_m == pytest.approx(np.hypot(1.0, 1.96 * 0.5), rel=1e-4)


def test_a_map_that_may_be_turned_gives_no_direction_and_only_the_way_from_its_origin(results):
    turned = replace(results, findings=(Finding("heading_unknown", Severity.WARNING),))
    known = references(turned)
    tapes = [tape(turned.candidates[0], turned, reference) for reference in known]
    assert [t.bearing_deg for t in tapes] == [None, None, None]
    assert [t.surface_m is not None for t in tapes] == [True, False, False]
    assert [t.along_m for t in tapes] == pytest.approx([42.0, 12.0, 38.0])


def test_too_vague_a_direction_is_not_told(results):
    count = results.track.time_s.size
    track = replace(results.track, cov_level_m2=np.tile([400.0, 0.0, 400.0], (count, 1)))
    vague = replace(results, track=track)
    assert tape(vague.candidates[0], vague, references(vague)[1]).bearing_deg is None


def test_without_a_path_there_is_nothing_to_tape(results):
    bare = replace(results, track=None)
    nan = replace(results.candidates[0], chainage_m=float("nan"))
    assert references(bare) == ()
    assert nearest_tapes(nan, bare, ()) == ()
