"""Which column of a text table holds what, in which unit: told by the operator, remembered, or guessed."""

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from enum import StrEnum
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.text_layout import TextLayout
from processing.importing.units import AUTO, FACTORS


class Quantity(StrEnum):
    """What a column can hold."""

    TIME = "time"
    COUNTER = "counter"
    ACC_X = "acc_x"
    ACC_Y = "acc_y"
    ACC_Z = "acc_z"
    GYR_X = "gyr_x"
    GYR_Y = "gyr_y"
    GYR_Z = "gyr_z"
    MAG_X = "mag_x"
    MAG_Y = "mag_y"
    MAG_Z = "mag_z"
    QUAT_W = "quat_w"
    QUAT_X = "quat_x"
    QUAT_Y = "quat_y"
    QUAT_Z = "quat_z"
    PRESSURE = "pressure"
    TEMPERATURE = "temperature"

    @property
    def kind(self) -> str:
        """The row of :data:`processing.importing.units.FACTORS` that lists its units."""
        return self.value.split("_")[0]


ACC = (Quantity.ACC_X, Quantity.ACC_Y, Quantity.ACC_Z)
GYR = (Quantity.GYR_X, Quantity.GYR_Y, Quantity.GYR_Z)
MAG = (Quantity.MAG_X, Quantity.MAG_Y, Quantity.MAG_Z)
QUAT = (Quantity.QUAT_W, Quantity.QUAT_X, Quantity.QUAT_Y, Quantity.QUAT_Z)


@dataclass(frozen=True)
class MappedColumn:
    """Column ``column`` (from 0), called ``name`` in the file, holds ``quantity`` in ``unit`` (``auto``: find out)."""

    column: int
    quantity: Quantity
    unit: str = AUTO
    name: str = ""


@dataclass(frozen=True)
class ColumnMapping:
    """What the columns of one kind of file hold; ``sample_rate_hz`` serves files that have no times."""

    columns: tuple[MappedColumn, ...]
    sample_rate_hz: float | None = None

    def column_of(self, quantity: Quantity) -> MappedColumn | None:
        """Return the column that holds ``quantity``."""
        return next((c for c in self.columns if c.quantity is quantity), None)

    def complete(self, quantities: tuple[Quantity, ...]) -> bool:
        """True where every one of ``quantities`` has a column."""
        return all(self.column_of(q) is not None for q in quantities)

    @property
    def missing(self) -> tuple[Quantity, ...]:
        """What an IMU log needs and this mapping lacks."""
        wanted = [q for q in (*ACC, *GYR) if self.column_of(q) is None]
        timed = self.column_of(Quantity.TIME) or self.column_of(Quantity.COUNTER) or self.sample_rate_hz
        return tuple(wanted) if timed else (Quantity.TIME, *wanted)

    def to_json(self) -> dict[str, object]:
        """Return plain JSON data."""
        return {"columns": [asdict(c) for c in self.columns], "sample_rate_hz": self.sample_rate_hz}

    @classmethod
    def from_json(cls, data: object) -> "ColumnMapping":
        """Return the mapping that :meth:`to_json` wrote; raises ValueError for anything else."""
        if not isinstance(data, Mapping) or not isinstance(data.get("columns"), list):
            raise ValueError("no column mapping")  # noqa: TRY004  # damaged data, not a wrong call
        columns = []
        for entry in data["columns"]:
            if not isinstance(entry, Mapping) or not isinstance(entry.get("column"), int):
                raise ValueError("no column")  # noqa: TRY004
            quantity, unit = Quantity(str(entry.get("quantity"))), str(entry.get("unit", AUTO))
            if entry["column"] < 0 or (unit != AUTO and unit not in FACTORS[quantity.kind]):
                raise ValueError("no such column or unit")
            columns.append(MappedColumn(entry["column"], quantity, unit, str(entry.get("name", ""))))
        rate = data.get("sample_rate_hz")
        if rate is not None and (not isinstance(rate, int | float) or not 0.0 < rate < 1e6):
            raise ValueError("no sample rate")
        return cls(tuple(columns), None if rate is None else float(rate))


def fingerprint(layout: TextLayout) -> str:
    """Return what is the same for all files of one kind: a short hash of header, separator and width."""
    names = [c.casefold() for c in layout.columns] if layout.has_header else [str(layout.width)]
    text = "\n".join([layout.separator, str(layout.decimal_comma), *names])
    return hashlib.sha256(text.encode()).hexdigest()[:24]


class MappingStore:
    """Column mappings remembered by the fingerprint of the file's header, in one JSON file."""

    _LIMIT = 500
    _MAX_BYTES = 4_000_000

    def __init__(self, path: Path) -> None:
        self._path = path

    def recall(self, layout: TextLayout) -> ColumnMapping | None:
        """Return what was remembered for files like this one; None where nothing (readable) was."""
        try:
            mapping = ColumnMapping.from_json(self._load().get(fingerprint(layout)))
        except ValueError:
            return None
        return mapping if all(c.column < layout.width for c in mapping.columns) else None

    def remember(self, layout: TextLayout, mapping: ColumnMapping) -> None:
        """Keep ``mapping`` for the next file of this kind.

        Raises:
            LeaklineError: CANNOT_WRITE.
        """
        known = self._load()
        known.pop(fingerprint(layout), None)
        known[fingerprint(layout)] = mapping.to_json()
        kept = dict(list(known.items())[-self._LIMIT :])
        aside = self._path.with_name(self._path.name + ".new")
        try:
            self._path.parent.mkdir(parents=True, exist_ok=True)
            with aside.open("w", encoding="utf-8") as file:
                json.dump(kept, file, indent=1)
                file.flush()
                os.fsync(file.fileno())
            aside.replace(self._path)
        except OSError as fault:
            reason = fault.strerror or str(fault)
            raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(self._path), reason=reason) from None

    def _load(self) -> dict[str, object]:
        """What the file holds; a missing or damaged one holds nothing, since it only saves the operator some clicks."""
        try:
            if self._path.stat().st_size > self._MAX_BYTES:
                return {}
            data = json.loads(self._path.read_text(encoding="utf-8"))
        except (OSError, ValueError, RecursionError):
            return {}
        return data if isinstance(data, dict) else {}
