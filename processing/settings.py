"""Every tunable of the pipeline, with unit, range, default and why; one frozen dataclass a step.

A field is made by :func:`tunable`; its metadata feeds the settings page, the check of ``--set`` and the manual.
The hash of a step's dataclass is part of the cache key of its result.
"""

import dataclasses
import hashlib
import json
from dataclasses import dataclass, field, fields, replace
from typing import Any

from processing.errors import ErrorCode, LeaklineError


def tunable(default: float, unit: str, low: float, high: float, why: str) -> Any:  # noqa: ANN401  # as dataclasses.field
    """Return a dataclass field for a number ``default`` in ``unit`` that may lie in ``low``..``high``."""
    return field(default=default, metadata={"unit": unit, "low": low, "high": high, "why": why})


def choice(default: str, options: tuple[str, ...], why: str) -> Any:  # noqa: ANN401  # as dataclasses.field
    """Return a dataclass field for one of ``options``."""
    return field(default=default, metadata={"options": options, "why": why})


@dataclass(frozen=True)
class ImportSettings:
    """How far the import doctor mends before it masks."""

    gap_factor: float = tunable(5.0, "sample periods", 2.0, 1000.0, "a longer silence in the time stamps is a gap")


@dataclass(frozen=True)
class OrientationSettings:
    """Calibration at rest and the attitude estimators."""

    rest_min_s: float = tunable(2.0, "s", 0.5, 60.0, "a shorter rest gives too noisy a gyro offset (navigation §6.2)")
    rest_acc_std_mps2: float = tunable(0.15, "m/s²", 0.01, 2.0, "held for rest on all BROAD trials (navigation §6.2)")
    rest_gyr_std_dps: float = tunable(1.5, "°/s", 0.1, 20.0, "held for rest on all BROAD trials (navigation §6.2)")


@dataclass(frozen=True)
class PositionSettings:
    """Odometry, standstills and the fit to what is known."""

    track_rate_hz: float = tunable(20.0, "Hz", 10.0, 200.0, "formats.md promises 10 rows a second or more")


@dataclass(frozen=True)
class ClockSettings:
    """Mapping of the audio clock onto the IMU clock."""

    search_s: float = tunable(25.0, "s", 1.0, 120.0, "how far the two recorders may have been started apart")


@dataclass(frozen=True)
class SoundSettings:
    """The streamed pass over the audio."""

    band_low_hz: float = tunable(500.0, "Hz", 10.0, 90000.0, "below it flow, traffic and bends dominate")
    band_high_hz: float = tunable(4000.0, "Hz", 20.0, 96000.0, "above it little leak energy is left at a metre")


@dataclass(frozen=True)
class DetectorSettings:
    """From levels in metres to candidates."""

    background_m: float = tunable(24.0, "m", 3.0, 200.0, "half window of the running background (acoustics §5.1)")


@dataclass(frozen=True)
class ReportSettings:
    """What the report says and how."""

    language: str = choice("en", ("en", "tr"), "the language of the PDF")


@dataclass(frozen=True)
class Settings:
    """All steps' settings; ``Settings()`` holds the defaults."""

    importing: ImportSettings = field(default_factory=ImportSettings)
    orientation: OrientationSettings = field(default_factory=OrientationSettings)
    position: PositionSettings = field(default_factory=PositionSettings)
    clock: ClockSettings = field(default_factory=ClockSettings)
    sound: SoundSettings = field(default_factory=SoundSettings)
    detector: DetectorSettings = field(default_factory=DetectorSettings)
    report: ReportSettings = field(default_factory=ReportSettings)


def with_value(settings: Settings, table: str, key: str, text: str) -> Settings:
    """Return ``settings`` with ``table.key`` set from ``text``.

    Raises:
        LeaklineError: SETTING_UNKNOWN for a name that does not exist, SETTING_INVALID for a value out of range.
    """
    step: Any = getattr(settings, table) if table in {f.name for f in fields(settings)} else None
    known = {f.name: f for f in fields(step)} if step is not None else {}
    if key not in known:
        raise LeaklineError(ErrorCode.SETTING_UNKNOWN, name=f"{table}.{key}")
    changes: dict[str, Any] = {table: replace(step, **{key: _parsed(f"{table}.{key}", known[key], text)})}
    return replace(settings, **changes)


def _parsed(name: str, spec: "dataclasses.Field[Any]", text: str) -> str | float:
    meta = spec.metadata
    if "options" in meta:
        if text not in meta["options"]:
            allowed = ", ".join(meta["options"])
            raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed)
        return text
    allowed = f"{meta['low']:g} … {meta['high']:g} {meta['unit']}"
    try:
        value = float(text)
    except ValueError:
        raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed) from None
    if not meta["low"] <= value <= meta["high"]:
        raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed)
    return value


def digest(*parts: object) -> str:
    """Return a short stable hash of dataclasses, strings and numbers: the key of a cached result."""
    text = json.dumps(parts, default=_plain, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _plain(thing: object) -> object:
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        return {f.name: getattr(thing, f.name) for f in fields(thing)}
    return str(thing)
