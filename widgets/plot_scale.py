"""One axis of a plot: where a value lies between the ends, which round values get a tick, and how they are written."""

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from PySide6.QtCore import QLocale

from processing.survey import FloatArray


class ScaleKind(StrEnum):
    """How values spread over an axis."""

    LINEAR = "linear"
    LOG = "log"
    MEL = "mel"


@dataclass(frozen=True)
class Scale:
    """An axis from ``low`` to ``high`` (low < high; both > 0 for LOG)."""

    low: float
    high: float
    kind: ScaleKind = ScaleKind.LINEAR

    def fraction(self, value: FloatArray | float) -> FloatArray:
        """Return 0 at ``low`` and 1 at ``high``; values outside give fractions outside."""
        low, high = _warped(self.low, self.kind), _warped(self.high, self.kind)
        return np.asarray((_warped(value, self.kind) - low) / (high - low), dtype=np.float64)

    def spread(self, value: float) -> float:
        """Return the value in the unit in which the axis is even: itself, its logarithm, or its place in mel."""
        return float(_warped(value, self.kind))

    def value(self, fraction: FloatArray | float) -> FloatArray:
        """Return the value at ``fraction``: the inverse of :meth:`fraction`."""
        low, high = _warped(self.low, self.kind), _warped(self.high, self.kind)
        return _unwarped(low + np.asarray(fraction, dtype=np.float64) * (high - low), self.kind)

    def zoomed(self, factor: float, fraction: float, limits: tuple[float, float], least: float) -> "Scale":
        """Return this axis with its span times ``factor``, what lies at ``fraction`` staying there.

        It never leaves ``limits``, and never shrinks below ``least`` (in the axis' own unit).
        """
        low = float(self.value(fraction * (1.0 - factor)))
        high = float(self.value(fraction + (1.0 - fraction) * factor))
        low, high = max(low, limits[0]), min(high, limits[1])
        return self if high - low < least else replace(self, low=low, high=high)

    def ticks(self, most: int) -> list[float]:
        """Return at most about ``most`` round values between the ends, both included."""
        if self.kind is ScaleKind.LINEAR:
            return linear_ticks(self.low, self.high, most)
        return _decade_ticks(self, most)


def _warped(value: FloatArray | float, kind: ScaleKind) -> FloatArray:
    values = np.asarray(value, dtype=np.float64)
    if kind is ScaleKind.LOG:
        return np.asarray(np.log(np.maximum(values, 1e-12)))
    if kind is ScaleKind.MEL:  # O'Shaughnessy 1987
        return np.asarray(np.log1p(np.maximum(values, 0.0) / 700.0))
    return values


def _unwarped(warped: FloatArray, kind: ScaleKind) -> FloatArray:
    if kind is ScaleKind.LOG:
        return np.asarray(np.exp(warped))
    if kind is ScaleKind.MEL:
        return np.asarray(700.0 * np.expm1(warped))
    return warped


def nice_step(span: float, most: int) -> float:
    """Return the smallest of 1, 2, 5 × 10ⁿ that divides ``span`` into at most ``most`` steps."""
    if not (math.isfinite(span) and span > 0.0):
        return 1.0
    rough = span / max(most, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    return next(power * m for m in (1.0, 2.0, 5.0, 10.0) if power * m >= rough * (1.0 - 1e-9))


def multiples(low: float, high: float, step: float) -> list[float]:
    """Return the multiples of ``step`` from ``low`` to ``high``, free of accumulated rounding."""
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [k * step for k in range(first, min(last, first + 1000) + 1)]


def linear_ticks(low: float, high: float, most: int) -> list[float]:
    """Return round values from ``low`` to ``high``."""
    return multiples(low, high, nice_step(high - low, most))


def _decade_ticks(scale: Scale, most: int) -> list[float]:
    if scale.high <= 4.0 * max(scale.low, 1e-12):
        return linear_ticks(scale.low, scale.high, most)
    first = math.floor(math.log10(max(scale.low, 1.0)))
    last = math.ceil(math.log10(scale.high))
    for steps in ((1, 2, 5), (1, 3), (1,)):
        values = [m * 10.0**k for k in range(first, last + 1) for m in steps]
        inside = [v for v in values if scale.low * (1 - 1e-9) <= v <= scale.high * (1 + 1e-9)]
        apart = np.diff(scale.fraction(np.array(inside))) if len(inside) > 1 else np.ones(1)
        if len(inside) <= most and apart.min() >= 0.5 / most:
            return inside
    return inside


def tick_digits(step: float) -> int:
    """Return how many decimals show every multiple of ``step``."""
    return max(0, -math.floor(math.log10(step) + 1e-9)) if step > 0.0 else 0


def number_text(value: float, digits: int, locale: QLocale | None = None) -> str:
    """Return ``value`` with ``digits`` decimals in the reader's way of writing, without separators of thousands."""
    reader = QLocale(locale) if locale is not None else QLocale()
    reader.setNumberOptions(QLocale.NumberOption.OmitGroupSeparator)
    text = reader.toString(float(value), "f", digits)
    return text.replace("-", "−")


def hertz_text(value: float, locale: QLocale | None = None) -> str:
    """Return a frequency for a tick: ``500``, ``2k``, ``2.5k``."""
    if value < 1000.0:
        return number_text(value, 0 if abs(value - round(value)) < 1e-6 else 1, locale)
    thousands = value / 1000.0
    digits = next(d for d in (0, 1, 2, 3) if d == 3 or abs(round(thousands, d) - thousands) < 1e-6)
    return number_text(thousands, digits, locale) + "k"


def hertz_name(value: float, locale: QLocale | None = None) -> str:
    """Return a frequency with its unit: ``500 Hz``, ``2.5 kHz``."""
    text = hertz_text(value, locale)
    return f"{text[:-1]} kHz" if text.endswith("k") else f"{text} Hz"


def hertz_span(low_hz: float, high_hz: float, locale: QLocale | None = None) -> str:
    """Return a band with its unit, whole hertz: ``500 Hz – 4 kHz``."""
    return f"{hertz_name(round(low_hz), locale)} – {hertz_name(round(high_hz), locale)}"
