"""Turns the results of a run into what each view asks for; plain functions, no state."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from processing.errors import LeaklineError
from widgets.level_view import LevelCurves
from widgets.tile_source import Levels

if TYPE_CHECKING:
    from processing.results import Results
    from processing.sound.scan import SoundScan
    from processing.survey import AudioSource, Candidate, ClockMap, FloatArray, TiePoint, Track

DETAIL_SPAN_S = 60.0  # a shorter view than this is computed afresh where the stored picture is too coarse
OVERVIEW_POINTS = 4000


@dataclass(frozen=True)
class ScanTiles:
    """The stored picture of the sound in survey time, and finer than stored when one looks closely."""

    scan: "SoundScan"
    clock: "ClockMap"
    audio: "AudioSource | None"

    @property
    def frequencies_hz(self) -> "FloatArray":
        """Centres of the bins."""
        return self.scan.tiles.frequency_hz

    @property
    def low_db(self) -> float:
        """Level that 0 stands for."""
        from processing.sound.tile_values import TILE_FLOOR_DB

        return float(TILE_FLOOR_DB)

    @property
    def step_db(self) -> float:
        """Decibels from one number to the next."""
        from processing.sound.tile_values import TILE_STEP_DB

        return float(TILE_STEP_DB)

    @property
    def start_s(self) -> float:
        """First moment."""
        return float(self.clock.to_survey(0.0))

    @property
    def end_s(self) -> float:
        """Last moment."""
        return float(self.clock.to_survey(self.scan.duration_s))

    def columns(self, start_s: float, end_s: float, columns: int, plane: str = "max") -> Levels:
        """Return uint8 (bins, columns) between survey seconds; called in a worker thread."""
        first, last = float(self.clock.to_audio(start_s)), float(self.clock.to_audio(end_s))
        close = (last - first) / columns < 0.5 * self.scan.tiles.finest_column_s and last - first <= DETAIL_SPAN_S
        if close and self.audio is not None:
            from processing.sound.tiles import spectrogram_detail

            return spectrogram_detail(self.audio, first, last, columns, plane)
        return self.scan.tiles.columns(first, last, columns, plane)


def tiles(results: "Results | None") -> ScanTiles | None:
    """Return the source of the spectrogram view."""
    if results is None or results.scan is None:
        return None
    return ScanTiles(results.scan, results.clock, results.recording.audio)


def overview(results: "Results | None") -> tuple["FloatArray", "FloatArray"]:
    """Return moments and levels of the chosen band over the whole run; empty without sound."""
    if results is None or results.scan is None:
        return np.zeros(0), np.zeros(0)
    level_db = results.scan.level_db[:, -1]
    time_s = results.clock.to_survey(results.scan.frame_times_s())
    every = max(1, len(level_db) // OVERVIEW_POINTS)
    count = len(level_db) // every
    block = np.asarray(level_db[: count * every], dtype=np.float64).reshape(count, every)
    return time_s[: count * every : every], block.max(axis=1)


def level_curves(results: "Results | None") -> LevelCurves | None:
    """Return level, background and threshold along the pipe."""
    if results is None or results.level_along is None:
        return None
    along = results.level_along
    return LevelCurves(
        along.time_s, along.level_db, along.chainage_m, along.background_db, along.threshold_db, along.band_hz
    )


def route_points(results: "Results") -> "FloatArray | None":
    """Return the mapped pipe in the local frame; None where there is none, or its system is not known."""
    from processing.coordinates import frame_of, route_local

    route = results.survey.route
    if route is None:
        return None
    try:
        return route_local(frame_of(results.survey), route)
    except LeaklineError:
        return None


def extent_s(results: "Results") -> tuple[float, float]:
    """Return from when to when there is anything, survey seconds."""
    starts, ends = [], []
    imu = results.recording.imu
    if imu is not None and len(imu.time_s):
        starts.append(float(imu.time_s[0]))
        ends.append(float(imu.time_s[-1]))
    if results.scan is not None:
        starts.append(float(results.clock.to_survey(0.0)))
        ends.append(float(results.clock.to_survey(results.scan.duration_s)))
    return (min(starts), max(ends)) if starts else (0.0, 1.0)


def plus_minus_m(track: "Track | None", time_s: float) -> float | None:
    """Return half of the 95 % interval of the chainage at a moment; None without a path."""
    from processing.position.distance import places_at

    if track is None:
        return None
    place = places_at(track, time_s)
    return float(1.959964 * place.sigma_along_m[0])


def to_local(results: "Results", tie: "TiePoint") -> tuple[float, float] | None:
    """Return east and north of a tie point in the local frame: as told, else where the path was at its moment."""
    from processing.coordinates import frame_of, tie_place

    try:
        place = tie_place(frame_of(results.survey), tie)
    except LeaklineError:  # a coordinate system that is not known: told when the survey is processed
        return None
    return None if place is None else (place[0], place[1])


def moved(candidates: "Sequence[Candidate]", track: "Track") -> "list[Candidate]":
    """Return candidates where their sound is on another track; the intervals keep their widths."""
    from processing.position.distance import places_at

    if not candidates:
        return []
    known = [math.isfinite(candidate.time_s) for candidate in candidates]
    times = np.array([c.time_s if ok else track.time_s[0] for c, ok in zip(candidates, known, strict=True)])
    places = places_at(track, times)
    out = []
    for row, (candidate, ok) in enumerate(zip(candidates, known, strict=True)):
        chainage = float(places.chainage_m[row])
        by = chainage - candidate.chainage_m
        east, north, up = (float(v) for v in places.position_w_m[row])
        there = replace(
            candidate,
            chainage_m=chainage,
            chainage_low95_m=candidate.chainage_low95_m + by,
            chainage_high95_m=candidate.chainage_high95_m + by,
            position_w_m=(east, north, up),
        )
        out.append(there if ok else candidate)
    return out
