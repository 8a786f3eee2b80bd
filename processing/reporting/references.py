"""Where a leak lies as a crew can tape it: its 95 % ellipse, and its distances to the nearest visible references.

References are the launch and the tie points: places that somebody saw on the surface. Errors of leak and reference are
taken as independent; in truth the fit shares the tie points between them, so the stated ± is too wide rather than too
narrow.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from processing.coordinates import LocalFrame, frame_of, tie_place
from processing.position import distance
from processing.results import Results
from processing.survey import Candidate, FloatArray, TiePoint, Track

CHI_95 = math.sqrt(5.991465)  # two degrees of freedom: half axes of the 95 % ellipse in sigmas
LAUNCH = "launch"
_SAME_PLACE_M = 0.5
_TANGENT_M = 0.5
_VAGUE_BEARING_DEG = 45.0  # a direction that is no better than a quarter of the compass is none


@dataclass(frozen=True)
class Ellipse:
    """A 95 % ellipse: half axes in metres, ``bearing_deg`` of the longer one clockwise from north, 0 to 180."""

    major_m: float
    minor_m: float
    bearing_deg: float


@dataclass(frozen=True)
class Reference:
    """A place on the surface that a crew finds: its chainage, ± 1 sigma, and its place where the map knows it."""

    name: str  # LAUNCH for the launch itself
    chainage_m: float
    sigma_m: float
    place_m: tuple[float, float] | None = None  # local east, north
    cov_m2: tuple[float, float, float] = (0.0, 0.0, 0.0)  # east-east, east-north, north-north


@dataclass(frozen=True)
class Tape:
    """Distances from a reference to a leak, ± 95 %; ``bearing_deg`` looks from the reference, None where unknown."""

    name: str
    onward: bool  # the leak lies further from the launch than the reference
    along_m: float
    along_95_m: float
    surface_m: float | None = None
    surface_95_m: float = math.nan
    bearing_deg: float | None = None
    place_m: tuple[float, float] | None = None  # of the reference, where the surface distance is known
    reference_95_m: float = 0.0  # how well the reference itself is known along the pipe; ``along_95_m`` holds it


def is_heading_known(results: Results) -> bool:
    """Return whether the path's direction on the map is known: else no bearing and no ellipse means anything."""
    return all(finding.code != "heading_unknown" for finding in results.findings)


def covariance(candidate: Candidate, results: Results) -> FloatArray | None:
    """Return the covariance (2, 2) of a candidate's local east and north in m²; None without a place.

    It is the path's, with what clock and sound add along the pipe: the stated interval holds all three.
    """
    track = results.track
    if track is None or not np.all(np.isfinite(candidate.position_w_m)):
        return None
    cov = _path_covariance(track, candidate.time_s)
    half = max(
        candidate.chainage_high95_m - candidate.chainage_m, candidate.chainage_m - candidate.chainage_low95_m, 0.0
    )
    way = _direction(track, candidate.chainage_m)
    # an interval that digs have widened is wider than the path's own: whichever of both is less is what cov has of it
    path = min(float(np.interp(candidate.time_s, track.time_s, track.sigma_along_m)) ** 2, float(way @ cov @ way))
    more = (half / distance.NORMAL_95) ** 2 - path
    return cov + max(more, 0.0) * np.outer(way, way) if math.isfinite(more) else cov


def ellipse(cov_m2: FloatArray) -> Ellipse:
    """Return the 95 % ellipse of a covariance (2, 2) of east and north."""
    values, vectors = np.linalg.eigh(cov_m2)
    minor, major = np.sqrt(np.maximum(values, 0.0))
    east, north = vectors[:, 1]
    bearing = math.degrees(math.atan2(east, north)) % 180.0
    return Ellipse(CHI_95 * float(major), CHI_95 * float(minor), bearing)


def references(results: Results) -> tuple[Reference, ...]:
    """Return launch and tie points by their chainage; a tie point at the launch stands for both."""
    track = results.track
    if track is None:
        return ()
    frame = frame_of(results.survey)
    found = [_of_tie(tie, track, frame) for tie in results.survey.tie_points if tie.enabled]
    known = [reference for reference in found if reference is not None]
    start = float(track.position_w_m[0, 0]), float(track.position_w_m[0, 1])
    if all(abs(reference.chainage_m) > _SAME_PLACE_M for reference in known):
        known.append(Reference(LAUNCH, 0.0, 0.0, start))
    return tuple(sorted(known, key=lambda reference: reference.chainage_m))


def nearest_tapes(candidate: Candidate, results: Results, known: tuple[Reference, ...]) -> tuple[Tape, ...]:
    """Return the tapes from the nearest reference either side, or from two of one side; fewer where there are none."""
    at = candidate.chainage_m
    if not math.isfinite(at):
        return ()
    by_distance = sorted(known, key=lambda reference: abs(reference.chainage_m - at))
    before = [reference for reference in by_distance if reference.chainage_m <= at]
    after = [reference for reference in by_distance if reference.chainage_m > at]
    chosen = [*before[:1], *after[:1]] if before and after else by_distance[:2]
    return tuple(tape(candidate, results, reference) for reference in chosen)


def tape(candidate: Candidate, results: Results, reference: Reference) -> Tape:
    """Return the distances from one reference along the pipe and, where the map knows both, straight over ground."""
    apart = candidate.chainage_m - reference.chainage_m
    half = (candidate.chainage_high95_m - candidate.chainage_low95_m) / 2.0
    own_95 = distance.NORMAL_95 * reference.sigma_m
    along = Tape(reference.name, apart >= 0.0, abs(apart), math.hypot(half, own_95), reference_95_m=own_95)
    cov = covariance(candidate, results)
    # of a path whose direction is arbitrary, only the distance from its own origin is known
    heading_known = is_heading_known(results)
    if cov is None or reference.place_m is None or not (heading_known or reference.name == LAUNCH):
        return along
    way = np.array(candidate.position_w_m[:2]) - reference.place_m
    ee, en, nn = reference.cov_m2
    both = cov + np.array([[ee, en], [en, nn]])
    length = float(np.hypot(*way))
    unit = way / length if length > 1e-6 else np.array([1.0, 0.0])
    aside = np.array([-unit[1], unit[0]])
    surface_95 = distance.NORMAL_95 * math.sqrt(max(float(unit @ both @ unit), 0.0))
    swing = math.degrees(distance.NORMAL_95 * math.sqrt(max(float(aside @ both @ aside), 0.0)) / max(length, 1e-6))
    bearing = None
    if heading_known and swing <= _VAGUE_BEARING_DEG:
        bearing = math.degrees(math.atan2(unit[0], unit[1])) % 360.0
    return replace(along, surface_m=length, surface_95_m=surface_95, bearing_deg=bearing, place_m=reference.place_m)


def _of_tie(tie: TiePoint, track: Track, frame: LocalFrame) -> Reference | None:
    """Return a tie point as a reference: as surveyed where it was, else where the path was at its time."""
    inside = track.time_s[0] <= tie.time_s <= track.time_s[-1]
    if tie.chainage_m is None and not inside:
        return None
    sigma = tie.sigma_m
    if tie.chainage_m is None:
        chainage = float(distance.chainage_at(track, tie.time_s)[0])
        sigma = float(np.interp(tie.time_s, track.time_s, track.sigma_along_m))
    else:
        chainage = tie.chainage_m
    surveyed = tie_place(frame, tie)
    if surveyed is not None:
        return Reference(tie.name, chainage, sigma, surveyed[:2], (tie.sigma_m**2, 0.0, tie.sigma_m**2))
    if not inside:
        return Reference(tie.name, chainage, sigma)
    east, north, _ = distance.places_at(track, tie.time_s).position_w_m[0]
    cov = _path_covariance(track, tie.time_s)
    return Reference(
        tie.name, chainage, sigma, (float(east), float(north)), (float(cov[0, 0]), float(cov[0, 1]), float(cov[1, 1]))
    )


def _path_covariance(track: Track, time_s: float) -> FloatArray:
    """Return the covariance (2, 2) of the path's east and north at a moment."""
    if track.cov_level_m2 is not None:
        ee, en, nn = (float(np.interp(time_s, track.time_s, column)) for column in track.cov_level_m2.T)
        return np.array([[ee, en], [en, nn]])
    at = distance.places_at(track, time_s)
    way = _direction(track, float(at.chainage_m[0]))
    aside = np.array([-way[1], way[0]])
    along, cross = float(at.sigma_along_m[0]), float(at.sigma_cross_m[0])
    return np.asarray(along**2 * np.outer(way, way) + cross**2 * np.outer(aside, aside))


def _direction(track: Track, chainage_m: float) -> FloatArray:
    """Return the path's level direction (2,), unit, at a chainage; east where it stands still or climbs straight up."""
    ends = distance.times_at(track, [chainage_m - _TANGENT_M, chainage_m + _TANGENT_M])[0]
    first, last = distance.places_at(track, ends).position_w_m[:, :2]
    length = float(np.hypot(*(last - first)))
    return (last - first) / length if length > 1e-9 else np.array([1.0, 0.0])
