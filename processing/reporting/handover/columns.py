"""The columns of the handed-over tables: what each is called in which scheme, of which kind, in which unit.

A name tells its unit (``chainage_m``, ``chainage_ftus``); asset systems load fixed names, whose unit a column tells.
dBase allows ten characters, so each column has a short name too.
"""

from dataclasses import dataclass
from enum import StrEnum

from processing.quantities import METRES_PER_US_FOOT, Units
from processing.reporting.options import ColumnScheme, HandoverOptions

SHORTEST = 10  # characters of a dBase field name


class ColumnKind(StrEnum):
    """What a cell holds; any may be empty."""

    INTEGER = "integer"
    REAL = "real"
    TEXT = "text"


class Measure(StrEnum):
    """Which unit a number is in: none that the name must tell, the chosen one of lengths, that of the target system."""

    PLAIN = "plain"
    LENGTH = "length"
    GRID = "grid"


@dataclass(frozen=True)
class Spec:
    """One column: ``key`` is its word in ``[columns]``; ``asset`` names stand for the other scheme, empty for as ours.

    ``name`` and ``short`` lack the unit, which follows them where there is one.
    """

    key: str
    name: str
    short: str
    kind: ColumnKind = ColumnKind.TEXT
    measure: Measure = Measure.PLAIN
    digits: int = 3
    asset: str = ""
    asset_short: str = ""


@dataclass(frozen=True)
class Column:
    """A column as it is written; ``unit`` is empty, ``m``, ``ft``, ``ftus``, ``deg`` or what else the grid has."""

    key: str
    kind: ColumnKind
    name: str
    short: str
    unit: str
    digits: int


INTEGER, REAL, TEXT = ColumnKind
LENGTH, GRID = Measure.LENGTH, Measure.GRID


def _length(key: str, name: str, short: str, asset: str = "", asset_short: str = "") -> Spec:
    return Spec(key, name, short, REAL, LENGTH, 3, asset, asset_short)


LEAKS = (
    Spec("id", "id", "id", INTEGER, asset="leak_id", asset_short="leak_id"),
    Spec("pipe_id", "pipe_id", "pipe_id"),
    Spec("status", "status", "status"),
    Spec("verdict", "verdict", "verdict"),
    Spec("result", "result", "result"),
    Spec("class", "class", "class", asset="leak_class", asset_short="leak_class"),
    _length("chainage", "chainage", "chain", "leak_distance", "leak_dist"),
    _length("low95", "chainage_low95", "low95", "distance_low", "dist_low"),
    _length("high95", "chainage_high95", "hi95", "distance_high", "dist_high"),
    _length("half95", "half95", "half", "accuracy", "accuracy"),
    _length("across95", "across95", "acrs", "accuracy_across", "accur_acrs"),
    Spec("x", "east", "east", REAL, GRID, 4, "x", "x"),
    Spec("y", "north", "north", REAL, GRID, 4, "y", "y"),
    _length("elevation", "elevation", "elev", "z", "z"),
    _length("up", "up", "up", "z", "z"),
    Spec("latitude", "latitude", "latitude", REAL, digits=8),
    Spec("longitude", "longitude", "longitude", REAL, digits=8),
    Spec("time", "time_s", "time_s", REAL),
    Spec("score", "score", "score", REAL, digits=4),
    Spec("level", "level_dB", "level_dB", REAL, digits=2),
    Spec("size", "size", "size"),
    Spec("size_basis", "size_basis", "size_basis"),
    Spec("before", "before", "before", asset="reference_before", asset_short="ref_before"),
    _length("before_away", "before_distance", "bef", "reference_before_distance", "ref_bef_d"),
    Spec("after", "after", "after", asset="reference_after", asset_short="ref_after"),
    _length("after_away", "after_distance", "aft", "reference_after_distance", "ref_aft_d"),
    Spec("note", "note", "note"),
    Spec("photos", "photos", "photos"),
    Spec("dig", "dig", "dig"),
    Spec("dig_date", "dig_date", "dig_date"),
    _length("dig_off", "dig_off_along", "dig", "dig_off_along", "dig_off"),
    Spec("simulated", "simulated", "simulated", INTEGER),
    Spec("crs", "crs", "crs"),
    Spec("units", "units", "units"),
)
TRACK = (
    Spec("segment", "id", "id", INTEGER, asset="segment_id", asset_short="segment_id"),
    Spec("pipe_id", "pipe_id", "pipe_id"),
    _length("start", "start", "start", "start_distance", "start_dist"),
    _length("end", "end", "end", "end_distance", "end_dist"),
    _length("half95", "half95", "half", "accuracy", "accuracy"),
    _length("across95", "across95", "acrs", "accuracy_across", "accur_acrs"),
    _length("up95", "up95", "up", "accuracy_up", "accuracyup"),
    Spec("simulated", "simulated", "simulated", INTEGER),
    Spec("units", "units", "units"),
)
STRETCHES = (
    Spec("stretch", "id", "id", INTEGER, asset="stretch_id", asset_short="stretch_id"),
    Spec("pipe_id", "pipe_id", "pipe_id"),
    Spec("stretch_status", "status", "status"),
    _length("start", "start", "start", "start_distance", "start_dist"),
    _length("end", "end", "end", "end_distance", "end_dist"),
    _length("length", "length", "len", "length", "length"),
    _length("border95", "border95", "bord", "accuracy", "accuracy"),
    Spec("leaks", "leaks", "leaks"),
    Spec("reasons", "reasons", "reasons"),
    Spec("simulated", "simulated", "simulated", INTEGER),
    Spec("units", "units", "units"),
)
REFERENCES = (
    Spec("reference_name", "name", "name"),
    Spec("pipe_id", "pipe_id", "pipe_id"),
    Spec("reference_kind", "kind", "kind"),
    _length("chainage", "chainage", "chain", "distance", "distance"),
    _length("sigma95", "given95", "given", "accuracy", "accuracy"),
    _length("residual", "residual", "resid", "residual", "residual"),
    Spec("used", "used", "used", INTEGER),
    Spec("time", "time_s", "time_s", REAL),
    Spec("x", "east", "east", REAL, GRID, 4, "x", "x"),
    Spec("y", "north", "north", REAL, GRID, 4, "y", "y"),
    Spec("units", "units", "units"),
)


def columns(specs: tuple[Spec, ...], options: HandoverOptions, grid_unit: str) -> tuple[Column, ...]:
    """Return the columns of a table as they are written in a system whose unit is ``grid_unit``."""
    return tuple(_column(spec, options, grid_unit) for spec in specs)


def length_unit(options: HandoverOptions) -> str:
    """Return ``m`` or ``ftus``, of lengths in tables."""
    return "ftus" if options.units is Units.US else "m"


def metres_per_unit(options: HandoverOptions) -> float:
    """Return how many metres the unit of lengths in tables has."""
    return METRES_PER_US_FOOT if options.units is Units.US else 1.0


def _column(spec: Spec, options: HandoverOptions, grid_unit: str) -> Column:
    unit = {Measure.PLAIN: "", LENGTH: length_unit(options), GRID: grid_unit}[spec.measure]
    digits = 8 if spec.measure is GRID and grid_unit == "deg" else spec.digits
    if options.columns is ColumnScheme.ASSET:
        return Column(spec.key, spec.kind, spec.asset or spec.name, spec.asset_short or spec.short, unit, digits)
    end = f"_{unit}" if unit else ""
    return Column(spec.key, spec.kind, spec.name + end, (spec.short + end)[:SHORTEST], unit, digits)
