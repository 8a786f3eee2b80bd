"""Every key that survey.toml may hold: its kind, its range and where it goes in :class:`~processing.survey.Survey`."""

import datetime as dt
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.survey import Motion

Value = str | int | float | bool | None


@dataclass(frozen=True)
class Text:
    """Free text, at most ``longest`` characters."""

    longest: int = 10_000

    @property
    def allowed(self) -> str:
        """What the sentence of an error says."""
        return f"text, at most {self.longest} characters"

    def read(self, raw: object) -> Value:
        """Return the value of what TOML gave; raises TypeError or ValueError."""
        if not isinstance(raw, str) or len(raw) > self.longest:
            raise ValueError
        return raw


@dataclass(frozen=True)
class Number:
    """A finite number in ``low``..``high``; ``above`` excludes ``low`` itself."""

    low: float
    high: float
    unit: str = ""
    above: bool = False

    @property
    def allowed(self) -> str:
        """What the sentence of an error says."""
        return f"{'> ' if self.above else ''}{self.low:g} … {self.high:g} {self.unit}".rstrip()

    def read(self, raw: object) -> Value:
        """Return the value of what TOML or a command line gave; raises TypeError or ValueError."""
        if isinstance(raw, bool) or not isinstance(raw, int | float | str):
            raise TypeError
        value = float(raw)
        if not math.isfinite(value) or not self.low <= value <= self.high or (self.above and value == self.low):
            raise ValueError
        return value


@dataclass(frozen=True)
class Integer:
    """A whole number in ``low``..``high``."""

    low: int
    high: int

    @property
    def allowed(self) -> str:
        """What the sentence of an error says."""
        return f"{self.low} … {self.high}"

    def read(self, raw: object) -> Value:
        """Return the value of what TOML or a command line gave; raises TypeError or ValueError."""
        if isinstance(raw, bool) or not isinstance(raw, int | str):
            raise TypeError
        value = int(raw)
        if not self.low <= value <= self.high:
            raise ValueError
        return value


@dataclass(frozen=True)
class OneOf:
    """One of ``options``."""

    options: tuple[str, ...]

    @property
    def allowed(self) -> str:
        """What the sentence of an error says."""
        return ", ".join(self.options)

    def read(self, raw: object) -> Value:
        """Return the value of what TOML gave; raises TypeError or ValueError."""
        if raw not in self.options:
            raise ValueError
        return str(raw)


@dataclass(frozen=True)
class Date:
    """A day, as a TOML date or an ISO string; kept as ``2026-05-04``."""

    allowed: str = "a date such as 2026-05-04"

    def read(self, raw: object) -> Value:
        """Return the ISO date; raises TypeError or ValueError."""
        if isinstance(raw, dt.datetime):
            return raw.date().isoformat()
        if isinstance(raw, dt.date):
            return raw.isoformat()
        if isinstance(raw, str):
            return dt.date.fromisoformat(raw.strip()).isoformat() if raw.strip() else ""
        raise ValueError


@dataclass(frozen=True)
class Flag:
    """True or false."""

    allowed: str = "true, false"

    def read(self, raw: object) -> Value:
        """Return the value of what TOML or a command line gave; raises TypeError or ValueError."""
        if isinstance(raw, bool):
            return raw
        if raw in ("true", "false"):
            return raw == "true"
        raise ValueError


Kind = Text | Number | Integer | OneOf | Date | Flag

_ANY_TIME = Number(-1e10, 1e10, "s")
_METRES = Number(-1e8, 1e8, "m")
_SIGMA = Number(0.0, 1e6, "m", above=True)
_LATITUDE = Number(-90.0, 90.0, "°")
_LONGITUDE = Number(-180.0, 180.0, "°")

TABLES: Mapping[str, Mapping[str, Kind]] = {
    "survey": {"name": Text(), "operator": Text(), "date": Date(), "client": Text(), "simulated": Flag()},
    "pipe": {
        "material": Text(),
        "diameter_m": Number(0.0, 20.0, "m", above=True),
        "length_m": Number(0.0, 1e6, "m", above=True),
        "joint_spacing_m": Number(0.5, 100.0, "m"),
        "pressure_bar": Number(0.0, 100.0, "bar", above=True),
    },
    "device": {
        "motion": OneOf(tuple(m.value for m in Motion)),
        "radius_m": Number(0.0, 5.0, "m", above=True),
    },
    "audio": {
        "file": Text(1000),
        "channel": Integer(0, 255),
        "start_time_s": _ANY_TIME,
        "drift_ppm": Number(-10_000.0, 10_000.0, "ppm"),
        "start_sigma_s": Number(0.0, 1e6, "s", above=True),
        "drift_sigma_ppm": Number(0.0, 10_000.0, "ppm", above=True),
        "raw_sample_rate_hz": Number(100.0, 1e6, "Hz"),
        "raw_bits": Integer(8, 64),
        "raw_channels": Integer(1, 256),
        "raw_encoding": OneOf(("signed", "unsigned", "float", "ulaw", "alaw")),
        "raw_endian": OneOf(("little", "big")),
    },
    "launch": {
        "latitude": _LATITUDE,
        "longitude": _LONGITUDE,
        "east_m": _METRES,
        "north_m": _METRES,
        "crs": Text(1000),
        "elevation_m": Number(-12_000.0, 12_000.0, "m"),
        "heading_deg": Number(-360.0, 360.0, "°"),
    },
    "processing": {"orientation": Text(100), "position": Text(100), "detector": Text(100), "preset": Text(100)},
}

TIE_POINT: Mapping[str, Kind] = {
    "name": Text(1000),
    "time_s": _ANY_TIME,
    "chainage_m": Number(0.0, 1e7, "m"),
    "latitude": _LATITUDE,
    "longitude": _LONGITUDE,
    "east_m": _METRES,
    "north_m": _METRES,
    "up_m": Number(-12_000.0, 12_000.0, "m"),
    "sigma_m": _SIGMA,
    "enabled": Flag(),
}

CALIBRATION_LEAK: Mapping[str, Kind] = {
    "chainage_m": Number(0.0, 1e7, "m"),
    "flow_lpm": Number(0.0, 1e6, "L/min", above=True),
    "pressure_bar": Number(0.0, 100.0, "bar", above=True),
    "name": Text(1000),
}

ROUTE: Mapping[str, Kind] = {"crs": Text(1000), "sigma_m": _SIGMA, "file": Text(1000)}
COORDINATE = _METRES


def checked(kind: Kind, name: str, raw: object, place: Place | None = None) -> Value:
    """Return ``raw`` as a value of ``kind``.

    Raises:
        LeaklineError: SETTING_INVALID with the name, the value and what is allowed.
    """
    try:
        return kind.read(raw)
    except (TypeError, ValueError, OverflowError):
        shown = str(raw) if not isinstance(raw, int) or abs(raw) < 10**18 else f"{str(raw)[:12]}…"
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, place, name=name, value=shown[:80], allowed=kind.allowed
        ) from None


def line_of(text: str, table: str, key: str = "", nth: int = 0) -> int | None:
    """Return the line (from 1) of ``key`` in the ``nth`` ``[table]`` or ``[[table]]`` of a TOML ``text``, if plain."""
    seen, here = -1, False
    for number, line in enumerate(text.splitlines(), start=1):
        bare = line.strip()
        if bare.startswith("["):
            here = bare.strip("[] \t").split("]")[0].strip() == table
            seen += here
            if here and not key and seen == nth:
                return number
        elif here and seen == nth and bare.split("=")[0].strip().strip("\"'") == key:
            return number
    return None


def place_of(path: Path, text: str, table: str, key: str = "", nth: int = 0) -> Place:
    """Return where ``key`` stands, for an error that the user has to mend."""
    return Place(path, line=line_of(text, table, key, nth))
