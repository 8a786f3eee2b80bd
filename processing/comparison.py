"""Several methods on the same recording: each one's free path, and how far it ends from what is known.

A free path knows the launch and its heading, and nothing else: no tie point, no length, no route. Its end is then held
against the tie points, so that the figures tell which method would have found the way by itself.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from processing.coordinates import frame_of, tie_place
from processing.errors import LeaklineError
from processing.orientation.registry import estimate_attitude
from processing.position.distance import places_at
from processing.position.registry import find_track
from processing.progress import Progress
from processing.settings import Settings
from processing.survey import FloatArray, ImuSamples, Survey, TiePoint, Track

_SHOWN_ROWS = 4000  # of a path that is only drawn


@dataclass(frozen=True)
class Compared:
    """One method's free path, thinned to (k, 3), and its errors at the enabled tie points; None where none tells.

    ``end_error_m`` is the horizontal distance at the last tie point with coordinates; where the first heading is not
    known the path is first turned to fit those tie points best (``turned``), since its direction means nothing.
    ``end_chainage_error_m`` is found minus told at the last tie point with a chainage (or the pipe's length).
    ``rms_m`` is over the tie points with coordinates. ``trouble`` says why there is no path.
    """

    orientation: str
    position: str
    time_s: FloatArray
    position_w_m: FloatArray
    length_m: float = 0.0
    end_error_m: float | None = None
    end_chainage_error_m: float | None = None
    rms_m: float | None = None
    turned: bool = False
    trouble: LeaklineError | None = None

    @property
    def end_error_pct(self) -> float | None:
        """The end error in per cent of the way."""
        return None if self.end_error_m is None or self.length_m <= 0.0 else 100.0 * self.end_error_m / self.length_m


def compare(
    imu: ImuSamples,
    survey: Survey,
    settings: Settings,
    methods: Sequence[tuple[str, str]],
    progress: Progress,
    told: Callable[[Compared], None] | None = None,
) -> tuple[Compared, ...]:
    """Return the free path of each (orientation, position) method; ``told`` hears of each as soon as it is there.

    A method that cannot work on this recording (``device`` without quaternions) is listed with its trouble.

    Raises:
        Cancelled: when the operator stops it.
    """
    out = []
    for number, (orientation, position) in enumerate(methods):
        part = progress.part(number / len(methods), (number + 1) / len(methods), "comparison")
        compared = _one(imu, survey, settings, orientation, position, part)
        if told is not None:
            told(compared)
        out.append(compared)
    return tuple(out)


def _one(
    imu: ImuSamples, survey: Survey, settings: Settings, orientation: str, position: str, progress: Progress
) -> Compared:
    choice = replace(survey.processing, orientation=orientation, position=position)
    free = replace(survey, tie_points=(), route=None, pipe=replace(survey.pipe, length_m=None), processing=choice)
    try:
        attitude, _, _ = estimate_attitude(imu, free, settings.orientation, progress.part(0.0, 0.7))
        track = find_track(imu, attitude, free, settings.position, progress.part(0.7, 1.0))
    except LeaklineError as error:
        return Compared(orientation, position, np.empty(0), np.empty((0, 3)), trouble=error)
    return held_against(track, survey, orientation, attitude.heading_from)


def held_against(track: Track, survey: Survey, orientation: str, heading_from: str = "launch") -> Compared:
    """Return the errors of a free path at the survey's enabled tie points."""
    places = _known_places(survey, track)
    turned = heading_from == "launch" and survey.launch.heading_deg is None and bool(places)
    path = track.position_w_m
    if turned:
        path = _turned(path, places, track)
    end_error = rms = None
    if places:
        times = np.array([tie.time_s for tie, _ in places])
        found = np.column_stack([np.interp(times, track.time_s, path[:, k]) for k in range(2)])
        away = np.hypot(*(found - np.array([place for _, place in places])).T)
        end_error, rms = float(away[-1]), float(np.sqrt(np.mean(away**2)))
    rows = np.unique(np.linspace(0, len(track.time_s) - 1, _SHOWN_ROWS).astype(np.intp))
    return Compared(
        orientation,
        track.method,
        track.time_s[rows],
        path[rows],
        float(track.chainage_m[-1]),
        end_error,
        _end_chainage_error(track, survey),
        rms,
        turned,
    )


def _known_places(survey: Survey, track: Track) -> list[tuple[TiePoint, tuple[float, float]]]:
    """Tie points with coordinates within the run, in the order of time, with their local places."""
    frame = frame_of(survey)
    out = []
    for tie in sorted(survey.tie_points, key=lambda t: t.time_s):
        place = tie_place(frame, tie) if tie.enabled else None
        if place is not None and track.time_s[0] - 1.0 <= tie.time_s <= track.time_s[-1] + 1.0:
            out.append((tie, place[:2]))
    return out


def _turned(path: FloatArray, places: list[tuple[TiePoint, tuple[float, float]]], track: Track) -> FloatArray:
    """Turn a path about its start so that it fits places best (least squares; the angle is in closed form)."""
    times = np.array([tie.time_s for tie, _ in places])
    start = path[0, :2]
    found = np.column_stack([np.interp(times, track.time_s, path[:, k]) for k in range(2)]) - start
    told = np.array([place for _, place in places]) - start
    angle = np.arctan2(np.sum(found[:, 0] * told[:, 1] - found[:, 1] * told[:, 0]), np.sum(found * told))
    cos, sin = np.cos(angle), np.sin(angle)
    out = path.copy()
    away = path[:, :2] - start
    out[:, 0] = start[0] + cos * away[:, 0] - sin * away[:, 1]
    out[:, 1] = start[1] + sin * away[:, 0] + cos * away[:, 1]
    return out


def _end_chainage_error(track: Track, survey: Survey) -> float | None:
    """Found minus told at the last enabled tie point with a chainage, else at the end of the pipe."""
    told = [t for t in survey.tie_points if t.enabled and t.chainage_m is not None]
    inside = [t for t in told if track.time_s[0] - 1.0 <= t.time_s <= track.time_s[-1] + 1.0]
    if inside:
        last = max(inside, key=lambda t: t.time_s)
        assert last.chainage_m is not None
        return float(places_at(track, last.time_s).chainage_m[0]) - last.chainage_m
    if survey.pipe.length_m is not None:
        return float(track.chainage_m[-1]) - survey.pipe.length_m
    return None
