"""Leaks, track, stretches and reference points as tables with places: what every map format writes.

Places stay in the local frame here; each format moves them into the system it is written in.
"""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent, tie_chainage
from processing.reporting.handover.columns import (
    LEAKS,
    REFERENCES,
    STRETCHES,
    TRACK,
    Column,
    ColumnKind,
    Measure,
    Spec,
    columns,
    length_unit,
    metres_per_unit,
)
from processing.reporting.handover.photos import photo_names
from processing.reporting.handover.system import TargetSystem
from processing.reporting.options import ColumnScheme, HandoverOptions
from processing.reporting.stretches import pipe_stretches, status_of
from processing.review_facts import DigResult
from processing.survey import FloatArray, TiePoint, Track

SEGMENT_M = 5.0  # of the track: its interval hardly changes in between
VERTEX_M = 0.5  # finer than any interval we state

Cell = int | float | str | None


class Shape(StrEnum):
    """What a feature is on the map."""

    POINT = "point"
    LINE = "line"


@dataclass(frozen=True)
class Feature:
    """One row: its cells in the order of the layer's columns, and its place, ``points_w_m`` (n, 3)."""

    cells: tuple[Cell, ...]
    points_w_m: FloatArray


@dataclass(frozen=True)
class Layer:
    """One table with places; ``name`` is the file's or the layer's."""

    name: str
    shape: Shape
    columns: tuple[Column, ...]
    features: tuple[Feature, ...]

    def coordinates(self, system: TargetSystem) -> list[FloatArray]:
        """Return each feature's x, y and z (n, 3) in a system, all moved in one go."""
        if not self.features:
            return []
        sizes = np.cumsum([len(feature.points_w_m) for feature in self.features])[:-1]
        moved = system.coordinates(np.concatenate([feature.points_w_m for feature in self.features]))
        return list(np.split(moved, sizes))

    def cell(self, feature: Feature, key: str) -> Cell:
        """Return the cell of the column ``key``; None where the layer has no such column."""
        at = next((i for i, column in enumerate(self.columns) if column.key == key), None)
        return None if at is None else feature.cells[at]


@dataclass(frozen=True)
class Layers:
    """All tables of a hand-over, in one system."""

    system: TargetSystem
    options: HandoverOptions
    leaks: Layer
    all_leaks: Layer  # with those that have no place in space: for tables only
    track: Layer
    stretches: Layer
    references: Layer

    @property
    def all(self) -> tuple[Layer, ...]:
        """The tables, leaks first."""
        return self.leaks, self.stretches, self.track, self.references


def make_layers(content: ReportContent, options: HandoverOptions, system: TargetSystem) -> Layers:
    """Return the tables of a hand-over; those of the path are empty where there is none.

    Leaks without a place in space are no features of ``leaks``, and have no points in ``all_leaks``.
    """
    make = _Maker(content, options, system)
    leaks = make.leaks()
    placed = replace(leaks, features=tuple(f for f in leaks.features if np.all(np.isfinite(f.points_w_m))))
    return Layers(system, options, placed, leaks, make.track(), make.stretches(), make.references())


def line_points(track: Track, starts_m: FloatArray, ends_m: FloatArray, step_m: float = VERTEX_M) -> list[FloatArray]:
    """Return the path between pairs of chainages as points (n ≥ 2, 3), ends exact; neighbours share their end."""
    counts = np.maximum(2, np.ceil((ends_m - starts_m) / step_m).astype(int) + 1)
    along = np.concatenate([np.linspace(a, b, n) for a, b, n in zip(starts_m, ends_m, counts, strict=True)])
    places = distance.places_at(track, distance.times_at(track, along)[0]).position_w_m
    return list(np.split(places, np.cumsum(counts)[:-1]))


class _Maker:
    """Fills the tables; lengths become those of the options here, in one place."""

    def __init__(self, content: ReportContent, options: HandoverOptions, system: TargetSystem) -> None:
        self._content, self._options, self._system = content, options, system
        self._common: dict[str, Cell] = {
            "pipe_id": options.pipe_id or None,
            "simulated": int(content.results.survey.info.simulated),
            "crs": system.crs,
            "units": length_unit(options),
        }

    def leaks(self) -> Layer:
        rows = self._content.rows
        points = np.array([row.candidate.position_w_m for row in rows]).reshape(-1, 3)
        across = self._across95([row.candidate.time_s for row in rows])
        placed = self._system.coordinates(points)
        photos = photo_names(self._content.record.photos)
        cells = []
        for row, place, cross in zip(rows, placed, across, strict=True):
            number = row.candidate.label
            dig = self._content.record.digs.get(number)
            values = leak_values(row, dig) | {"result": status_of(row, dig).value}
            values |= {"x": place[0], "y": place[1], "across95": cross}
            up = row.candidate.position_w_m[2]
            values |= {"up": up, "elevation": self._content.frame.height_m + up}
            values["photos"] = "; ".join(photos.get(number, ())) or None
            cells.append(values)
        return self._layer("leaks", Shape.POINT, LEAKS, cells, points[:, None, :])

    def track(self) -> Layer:
        track = self._content.results.track
        if track is None or not track.chainage_m[-1] > track.chainage_m[0]:
            return self._layer("track", Shape.LINE, TRACK, [], [])
        first, last = float(track.chainage_m[0]), float(track.chainage_m[-1])
        borders = np.linspace(first, last, max(2, int(np.ceil((last - first) / SEGMENT_M)) + 1))
        widest = [
            distance.NORMAL_95 * _largest(track, sigma, borders)
            for sigma in (track.sigma_along_m, track.sigma_cross_m, track.sigma_up_m)
        ]
        cells: list[dict[str, Cell]] = [
            {"segment": i, "start": start, "end": end, "half95": half, "across95": across, "up95": up}
            for i, (start, end, half, across, up) in enumerate(
                zip(borders[:-1], borders[1:], *widest, strict=True), start=1
            )
        ]
        return self._layer("track", Shape.LINE, TRACK, cells, line_points(track, borders[:-1], borders[1:]))

    def stretches(self) -> Layer:
        track, found = self._content.results.track, pipe_stretches(self._content)
        if track is None or not found:
            return self._layer("stretches", Shape.LINE, STRETCHES, [], [])
        cells: list[dict[str, Cell]] = [
            {
                "stretch": i,
                "stretch_status": stretch.status.value,
                "start": stretch.start_m,
                "end": stretch.end_m,
                "length": stretch.end_m - stretch.start_m,
                "border95": stretch.half95_m,
                "leaks": "; ".join(str(number) for number in stretch.leaks) or None,
                "reasons": "; ".join(stretch.reasons) or None,
            }
            for i, stretch in enumerate(found, start=1)
        ]
        lines = line_points(track, np.array([s.start_m for s in found]), np.array([s.end_m for s in found]))
        return self._layer("stretches", Shape.LINE, STRETCHES, cells, lines)

    def references(self) -> Layer:
        results, track = self._content.results, self._content.results.track
        if track is None:
            return self._layer("reference_points", Shape.POINT, REFERENCES, [], [])
        launch: dict[str, Cell] = {"reference_name": "launch", "reference_kind": "launch", "chainage": 0.0, "used": 1}
        cells: list[dict[str, Cell]] = [{**launch, "time": float(track.time_s[0])}]
        points = [track.position_w_m[:1]]
        residuals = {(check.name, check.time_s): check.residual_m for check in results.tie_checks}
        for tie in results.survey.tie_points:
            if not track.time_s[0] <= tie.time_s <= track.time_s[-1]:
                continue
            points.append(distance.places_at(track, tie.time_s).position_w_m)
            cells.append(
                {
                    "reference_name": tie.name,
                    "reference_kind": _known_by(tie),
                    "chainage": tie_chainage(tie, results),
                    "sigma95": distance.NORMAL_95 * tie.sigma_m,
                    "residual": residuals.get((tie.name, tie.time_s)),
                    "used": int(tie.enabled),
                    "time": tie.time_s,
                }
            )
        placed = self._system.coordinates(np.concatenate(points))
        for values, place in zip(cells, placed, strict=True):
            values |= {"x": place[0], "y": place[1]}
        return self._layer("reference_points", Shape.POINT, REFERENCES, cells, points)

    def _layer(
        self,
        name: str,
        shape: Shape,
        specs: tuple[Spec, ...],
        rows: Iterable[Mapping[str, Cell]],
        points: Iterable[FloatArray],
    ) -> Layer:
        made = columns(self._specs(specs), self._options, self._system.unit)
        scales = {spec.key: metres_per_unit(self._options) for spec in specs if spec.measure is Measure.LENGTH}
        features = tuple(
            Feature(tuple(_cell({**self._common, **row}.get(c.key), c, scales.get(c.key, 1.0)) for c in made), place)
            for row, place in zip(rows, points, strict=True)
        )
        return Layer(name, shape, made, features)

    def _specs(self, specs: tuple[Spec, ...]) -> tuple[Spec, ...]:
        """Leave out what this survey cannot fill: east and north beside degrees, degrees without a launch."""
        left_out = set() if has_elevation(self._content) else {"elevation"}
        if has_elevation(self._content):
            left_out |= {"up"}
        if self._system.is_degrees and self._options.columns is ColumnScheme.LEAKLINE:
            left_out |= {"x", "y"}
        if not self._content.frame.is_geographic:
            left_out |= {"latitude", "longitude"}
        return tuple(spec for spec in specs if spec.key not in left_out)

    def _across95(self, times_s: list[float]) -> FloatArray:
        track = self._content.results.track
        if track is None or not times_s:
            return np.full(len(times_s), np.nan)
        return np.asarray(distance.NORMAL_95 * distance.places_at(track, times_s).sigma_cross_m)


def has_elevation(content: ReportContent) -> bool:
    """Return whether heights are elevations; else they are above the launch."""
    return content.results.survey.launch.elevation_m is not None or content.frame.height_m != 0.0


def leak_values(row: LeakRow, dig: DigResult | None) -> dict[str, Cell]:
    """Return what is known of a candidate by the keys of ``[columns]``, lengths in metres; places are not among it."""
    c = row.candidate
    names: dict[str, Cell] = {
        "id": c.label,
        "status": row.status,
        "verdict": row.decision.verdict.value,
        "class": row.leak_class.value,
        "size": row.size.name if row.size is not None else None,
        "size_basis": row.size.basis_text if row.size is not None else None,
        "note": row.decision.note or None,
        "before": row.before.name if row.before is not None else None,
        "after": row.after.name if row.after is not None else None,
        "dig": dig.finding.value if dig is not None else None,
        "dig_date": (dig.date or None) if dig is not None else None,
    }
    numbers: dict[str, Cell] = {
        "chainage": c.chainage_m,
        "low95": c.chainage_low95_m,
        "high95": c.chainage_high95_m,
        "half95": row.interval_m,
        "latitude": row.latitude,
        "longitude": row.longitude,
        "time": c.time_s,
        "score": c.score,
        "level": c.level_db,
        "before_away": row.before.distance_m if row.before is not None else None,
        "after_away": row.after.distance_m if row.after is not None else None,
        "dig_off": dig.off_along_m if dig is not None else None,
    }
    return names | numbers


def _cell(value: Cell, column: Column, metres: float) -> Cell:
    """A cell as files have it: lengths in their unit, numbers as Python's, nothing for what is not finite."""
    if isinstance(value, str):
        # an old file name can hold half letters, which no format of ours can write
        return value.encode("utf-8", "backslashreplace").decode("utf-8")
    if value is None:
        return value
    if not np.isfinite(value):
        return None
    return int(value) if column.kind is ColumnKind.INTEGER else round(float(value) / metres, column.digits)


def _known_by(tie: TiePoint) -> str:
    return "chainage" if tie.chainage_m is not None else "coordinates"


def _largest(track: Track, sigma_m: FloatArray, borders: FloatArray) -> FloatArray:
    """The largest sigma in each segment between neighbouring borders, those at its ends among it."""
    at_borders = np.interp(distance.times_at(track, borders)[1], track.time_s, sigma_m)
    largest = np.maximum(at_borders[:-1], at_borders[1:])
    begins = np.searchsorted(track.chainage_m, borders[:-1], side="left")
    ends = np.searchsorted(track.chainage_m, borders[1:], side="right")
    inside: Callable[[int, int], float] = lambda a, b: float(np.max(sigma_m[a:b])) if b > a else 0.0  # noqa: E731
    return np.maximum(largest, [inside(a, b) for a, b in zip(begins, ends, strict=True)])
