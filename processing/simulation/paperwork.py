"""What the technician of a simulated run knows and writes down: the survey without the truth."""

import numpy as np

from processing.simulation.events import time_at_chainage
from processing.simulation.motion import TrueMotion
from processing.simulation.route import SmoothRoute
from processing.simulation.scenario import Marker, Scenario
from processing.survey import (
    AudioInfo,
    DeviceInfo,
    Launch,
    Motion,
    PipeInfo,
    Route,
    Survey,
    SurveyInfo,
    TiePoint,
)

_ROUTE_POINT_EVERY_M = 0.5  # inside bends; a utility's map is coarser, ours is only shifted


def survey_of(scenario: Scenario, route: SmoothRoute, motion: TrueMotion, rng: np.random.Generator) -> Survey:
    """Return the survey as told, with tie points and map drawn with the errors that they confess to."""
    papers, rolling = scenario.paperwork, scenario.motion is Motion.ROLLING
    told = scenario.clock if scenario.clock.told else None
    ball = scenario.ball
    return Survey(
        info=SurveyInfo(papers.title, papers.operator, papers.date, papers.client, simulated=True),
        pipe=PipeInfo(papers.material, papers.diameter_m, round(route.length_m, 3) if papers.tell_length else None),
        device=DeviceInfo(scenario.motion, (ball.told_radius_m or ball.radius_m) if rolling else None),
        audio=AudioInfo(
            file=scenario.sound.file if scenario.sound.enabled else None,
            start_time_s=told.start_s if told else None,
            drift_ppm=told.drift_ppm if told else None,
        ),
        launch=_launch(scenario, route),
        tie_points=tuple(_tie_point(marker, route, motion, rng) for marker in scenario.markers),
        route=_map(scenario, route, rng) if papers.tell_route else None,
    )


def _launch(scenario: Scenario, route: SmoothRoute) -> Launch:
    papers = scenario.paperwork
    east, north, _ = route.points(np.zeros(1)).tangent_w[0]
    heading = float(np.degrees(np.arctan2(east, north)) % 360)
    return Launch(
        latitude=papers.latitude,
        longitude=papers.longitude,
        elevation_m=papers.elevation_m,
        heading_deg=round(heading, 2) if papers.tell_heading else None,
    )


def _tie_point(marker: Marker, route: SmoothRoute, motion: TrueMotion, rng: np.random.Generator) -> TiePoint:
    end = route.length_m - 1e-6  # within rounding of the last sample
    chainage = end if marker.chainage_m is None else min(marker.chainage_m, end)
    error = rng.normal(0, marker.sigma_m, 4)
    place = route.points(np.array([chainage])).position_w_m[0] + error[1:] * [1, 1, 0.5]
    along, placed = marker.by in ("chainage", "both"), marker.by in ("coordinates", "both")
    return TiePoint(
        name=marker.name,
        time_s=round(time_at_chainage(motion, chainage), 2),
        chainage_m=round(chainage + float(error[0]), 3) if along else None,
        east_m=round(float(place[0]), 3) if placed else None,
        north_m=round(float(place[1]), 3) if placed else None,
        up_m=round(float(place[2]), 3) if placed else None,
        sigma_m=max(marker.sigma_m, 0.01),
    )


def _map(scenario: Scenario, route: SmoothRoute, rng: np.random.Generator) -> Route:
    """The pipe as drawn: all of it shifted by one error, since a map is off as a whole."""
    sigma = scenario.paperwork.route_sigma_m
    shift = rng.normal(0, sigma, 3) * [1, 1, 0.5]
    chainages = [0.0, route.length_m]
    for middle, angle in route.bends_m:
        half = angle * scenario.route.bend_radius_m
        chainages += list(np.arange(middle - half, middle + half + 1e-9, min(_ROUTE_POINT_EVERY_M, half / 3)))
    points = route.points(np.unique(np.clip(chainages, 0, route.length_m))).position_w_m + shift
    return Route(
        tuple((round(float(e), 3), round(float(n), 3), round(float(u), 3)) for e, n, u in points), "local", sigma
    )
