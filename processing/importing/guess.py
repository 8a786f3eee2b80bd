"""Guesses what the columns of an unknown table hold, by their names, and where there are none by their values."""

import re
from dataclasses import dataclass

import numpy as np

from processing.importing.column_mapping import ACC, GYR, MAG, QUAT, ColumnMapping, MappedColumn, Quantity
from processing.importing.text_blocks import drop_absurd
from processing.importing.text_layout import TextLayout
from processing.importing.time_stamps import unit_of_steps
from processing.importing.units import AUTO, unit_named
from processing.survey import FloatArray

_WORDS = {
    "acc": "acc accel accelerometer acceleration accelerometeracceleration a ivme ivmeölçer ivmeolcer specificforce",
    "gyr": "gyr gyro gyroscope gyrorotation rotation rotationrate angularvelocity angular angvel omega w g rate"
    " jiroskop dönüölçer",
    "mag": "mag magn magneto magnetometer magnetic magneticfield m magfield manyetometre manyetik",
    "quat": "quat quaternion q ori orientation",
}


def _set(words: str) -> frozenset[str]:
    return frozenset(words.split())


_NOT = _set(
    "linear lin free freeacc user earth gravity grav highg abs absolute norm magnitude total raw bias offset std"
    " variance inc increment delta dv dq euler roll pitch yaw"
)
_TIME = _set(
    "time timestamp timestamps t ts seconds elapsed secondselapsed zaman sampletimefine sampletime epoch datetime saat"
    " zeit loggingtime"
)
_COUNTER = _set("packetcounter counter count sample samples index idx timeindex frame no nr n sampleno row")
_PRESSURE = _set("pressure press baro barometer basınç basinc p")
_TEMPERATURE = _set("temperature temp sıcaklık sicaklik")
_ENDING = re.compile(
    r"_(mps2|radps|dps|deg_?s|ut|mg|g|rads|m_s2|rad_s|ms2|s|ms|us|ns|kpa|hpa|pa|mbar|c)$", re.IGNORECASE
)
_QUAT_AXES = {"0": "w", "1": "x", "2": "y", "3": "z"}


@dataclass(frozen=True)
class _Named:
    """A column whose name says a kind and an axis, and what else the name says: which of several sensors."""

    column: int
    kind: str
    axis: str
    rest: str
    penalty: int


def _tokens(name: str) -> list[str]:
    """The words of a column's name: ``accelerometerAccelerationX(G)`` → accelerometer acceleration x."""
    bare = re.sub(r"\([^)]*\)\s*$|\[(?!\d+\])[^\]]*\]\s*$", "", name)
    bare = re.sub(r"(?<=[a-zğüşöçı])(?=[A-Z])", " ", bare)
    bare = re.sub(r"_(mps2|radps|dps|deg_?s|ut|g|mg|rads|m_s2|rad_s|ms2|si)$", "", bare.strip(), flags=re.IGNORECASE)
    return [t for t in re.split(r"[^\w]+|_", bare.casefold()) if t]


def _axis_of(tokens: list[str]) -> tuple[str, list[str]]:
    """The axis letter at the end (or the beginning) of a name, and the words without it."""
    for at in (-1, 0):
        if len(tokens) > 1 and tokens[at] in ("w", "x", "y", "z"):
            return tokens[at], tokens[:-1] if at == -1 else tokens[1:]
    last = tokens[-1] if tokens else ""
    if len(tokens) > 1 and last.isdecimal():
        return last, tokens[:-1]
    found = re.fullmatch(r"(.+?)(?:[wxyz]|\d)", last)
    if found and (last[-1] in "wxyz" or found[1] in ("q", "quat")):
        return last[-1], [*tokens[:-1], found[1]]
    return "", tokens


def _named_column(number: int, name: str) -> _Named | None:
    axis, words = _axis_of(_tokens(name))
    if not axis:
        return None
    joined = "".join(words)
    for kind, known in _WORDS.items():
        hits = [w for w in (*words, joined) if w in known.split()]
        if not hits:
            continue
        letter = _QUAT_AXES.get(axis, axis) if kind == "quat" else {"1": "x", "2": "y", "3": "z"}.get(axis, axis)
        if letter not in ("wxyz" if kind == "quat" else "xyz"):
            continue
        rest = " ".join(w for w in words if w not in hits)
        return _Named(number, kind, letter, rest, sum(w in _NOT for w in words))
    return None


def _pick(named: list[_Named], kind: str, prefer: str | None) -> dict[str, _Named]:
    """The first complete set of axes of a kind; of several sensors the one whose other words equal ``prefer``."""
    axes = "wxyz" if kind == "quat" else "xyz"
    groups: dict[str, dict[str, _Named]] = {}
    for entry in named:
        if entry.kind == kind:
            groups.setdefault(entry.rest, {}).setdefault(entry.axis, entry)
    complete = [g for g in groups.values() if all(a in g for a in axes)]
    complete.sort(key=lambda g: (g["x"].penalty, prefer is not None and g["x"].rest != prefer, g["x"].column))
    return complete[0] if complete and (complete[0]["x"].penalty == 0 or kind == "quat") else {}


def guess_by_names(layout: TextLayout) -> ColumnMapping:
    """Return what the names of the columns say; units from brackets, rows of units and endings, else ``auto``."""
    names = list(layout.columns[: layout.width])
    units = [*layout.units, *[""] * len(names)]
    named = [entry for i, name in enumerate(names) if (entry := _named_column(i, name)) is not None]
    acc = _pick(named, "acc", None)
    prefer = acc["x"].rest if acc else None
    columns: list[MappedColumn] = []
    for kind, quantities in (("acc", ACC), ("gyr", GYR), ("mag", MAG), ("quat", QUAT)):
        group = acc if kind == "acc" else _pick(named, kind, prefer)
        for quantity in quantities if group else ():
            entry = group[quantity.value[-1]]
            unit = "1" if kind == "quat" else _unit(kind, names[entry.column], units[entry.column])
            columns.append(MappedColumn(entry.column, quantity, unit, names[entry.column]))
    used = {c.column for c in columns}
    for quantity, words in (
        (Quantity.TIME, _TIME),
        (Quantity.COUNTER, _COUNTER),
        (Quantity.PRESSURE, _PRESSURE),
        (Quantity.TEMPERATURE, _TEMPERATURE),
    ):
        at = _single(names, words, used)
        if at is not None:
            used.add(at)
            unit = "1" if quantity is Quantity.COUNTER else _unit(quantity.kind, names[at], units[at])
            columns.append(MappedColumn(at, quantity, unit, names[at]))
    return ColumnMapping(tuple(columns))


def _single(names: list[str], words: frozenset[str], used: set[int]) -> int | None:
    """The column whose name is one of ``words``, the plainest name first."""
    found = []
    for i, name in enumerate(names):
        tokens = _tokens(name)
        if words is _TIME and "".join(tokens) in _COUNTER:
            continue
        if i not in used and tokens and ("".join(tokens) in words or any(t in words for t in tokens)):
            exact = "".join(tokens) in words
            found.append((not exact, sum(t not in words for t in tokens), i))
    return min(found)[2] if found else None


def _unit(kind: str, name: str, unit: str) -> str:
    known = unit_named(kind, unit)
    if known != AUTO:
        return known
    ending = re.search(
        r"_(mps2|radps|dps|deg_?s|ut|mg|g|rads|m_s2|rad_s|ms2|s|ms|us|ns|kpa|hpa|pa|mbar|c)$", name, re.IGNORECASE
    )
    aliases = {"deg_s": "deg/s", "degs": "deg/s", "m_s2": "m/s2", "ms2": "m/s2", "rad_s": "rad/s"}
    text = ending[1].casefold() if ending else ""
    return unit_named(kind, aliases.get(text, text))


def guess_by_values(layout: TextLayout, head: FloatArray) -> ColumnMapping:
    """Return what the values (k, width) of a table without names say: a rising column, gravity, and a turn."""
    if len(head) < 8:
        return ColumnMapping(())
    columns: list[MappedColumn] = []
    free = list(range(min(layout.width, head.shape[1])))
    rising = next((i for i in free if _rises(head[:, i])), None)
    if rising is not None:
        columns.append(_time_or_counter(layout, rising, head[:, rising]))
        free = [i for i in free if i > rising]
    triples = [free[i : i + 3] for i in range(len(free) - 2) if free[i + 2] - free[i] == 2]
    acc = next((t for t in triples if _is_gravity(head[:, t])), None)
    if acc is None:
        return ColumnMapping(tuple(columns))
    others = [t for t in triples if not set(t) & set(acc) and (t[0] - acc[0]) % 3 == 0]
    gyr = min(others, key=lambda t: (t[0] < acc[0], abs(t[0] - acc[0])), default=None)
    for triple, quantities in ((acc, ACC), (gyr, GYR)):
        columns += [MappedColumn(i, q, AUTO, layout.columns[i]) for i, q in zip(triple or [], quantities)]
    return ColumnMapping(tuple(columns))


def _rises(values: FloatArray) -> bool:
    steps = np.diff(values)
    return bool(np.isfinite(values).all() and np.all(steps >= 0) and np.mean(steps > 0) > 0.5)


def _is_gravity(values: FloatArray) -> bool:
    norms = np.linalg.norm(values, axis=1)
    norms = norms[np.isfinite(norms)]
    if not len(norms):
        return False
    size = float(np.median(norms))
    return any(abs(size / g - 1.0) < 0.15 for g in (1.0, 9.80665, 1000.0)) and float(np.std(norms)) < 0.5 * size


def guess_mapping(layout: TextLayout) -> ColumnMapping:
    """Return the likeliest mapping of a table: by its names first, then by the values of its first rows.

    What neither gives is missing from the mapping: :attr:`ColumnMapping.missing` lists it.
    """
    mapping = guess_by_names(layout)
    head = _numbers(layout)
    if not mapping.complete((*ACC, *GYR)) and not layout.has_header:
        mapping = guess_by_values(layout, head)
    elif mapping.missing == (Quantity.TIME,) and len(head) > 2 and layout.clock_column is None:
        used = {c.column for c in mapping.columns}
        first = next((i for i in range(head.shape[1]) if i not in used and _rises(head[:, i])), None)
        if first is not None:
            mapping = ColumnMapping((*mapping.columns, _time_or_counter(layout, first, head[:, first])))
    return _with_clock(mapping, layout)


def _numbers(layout: TextLayout) -> FloatArray:
    """The first rows as numbers (k, width), NaN where a cell is none."""
    head = np.full((len(layout.sample), layout.width), np.nan)
    for i, cells in enumerate(layout.sample):
        for k, cell in enumerate(cells[: layout.width]):
            try:
                head[i, k] = float(cell.replace(",", ".") if layout.decimal_comma else cell)
            except ValueError:
                continue
    drop_absurd(head)
    return head


def _time_or_counter(layout: TextLayout, column: int, values: FloatArray) -> MappedColumn:
    counted = bool(np.all(np.diff(values) == 1.0)) or unit_of_steps(values) is None
    quantity = Quantity.COUNTER if counted else Quantity.TIME
    return MappedColumn(column, quantity, "1" if counted else AUTO, layout.columns[column])


def _with_clock(mapping: ColumnMapping, layout: TextLayout) -> ColumnMapping:
    """A counter that is the only axis of time stays one; a time that is written as a clock is read as one."""
    columns = list(mapping.columns)
    if layout.clock_column is not None:
        time = mapping.column_of(Quantity.TIME)
        if time is None or time.column == layout.clock_column:
            columns = [c for c in columns if c.quantity is not Quantity.TIME and c.column != layout.clock_column]
            name = layout.columns[layout.clock_column]
            columns.append(MappedColumn(layout.clock_column, Quantity.TIME, "clock", name))
    return ColumnMapping(tuple(columns), mapping.sample_rate_hz)
