"""How large a leak is: small, medium or large, never litres without a leak of known flow to compare with.

**Without a known leak** the class says only how loud the leak is where the ball passes: the level by which it stands
over the background in a named band, brought to a reference speed (rolling noise grows with the cube of the speed) and
pressure. The levels of detected leaks are right within 2 to 5 dB (acoustics §5.2), and flow and loudness of different
holes differ by more (a leak with a third less flow was heard three times as far): so the classes are wide, and a leak
within 6 dB of a border is called by both names.

**With a known leak** (an opened tap of measured flow) levels are compared in dBFS, so that the noise at either place
drops out: q₂ = q₁ · 10^((L₂ − L₁)/10) · (p₁/p₂)^x. A turbulent jet near a wall radiates as the sixth power of its
velocity and the area of the hole (M. J. Lighthill 1952; N. Curle 1955), the velocity is as √p, the flow as area · √p;
so power/flow is as p^2.5, x = 2.5 ± 0.7: theory, 3.5 for a free jet (eighth power). Turbulence, not cavitation, makes
leak noise, and hole size and jet velocity shape it (A. S. Papastefanou, P. F. Joseph, M. J. Brennan, Acta Acustica 98
(2012) 847). What holes of other shapes add is taken as 4 dB (1 sigma), an estimate. The answer is a class and a range.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from processing.settings import SizeSettings
from processing.survey import CalibrationLeak, Candidate, Motion, Survey

_ROLLING_EXPONENT = 3.0  # of the power of rolling noise on speed
_REFERENCE_MPS, _REFERENCE_BAR = 0.5, 3.0
_LEVEL_SIGMA_DB = 3.0  # acoustics §5.2: 1.6 dB for loud leaks, 5.3 dB for the weakest
_FAINT_DB, _FAINT_SIGMA_DB = 3.0, 5.0
_SHAPE_SIGMA_DB = 4.0
_PRESSURE_SIGMA = 0.7  # of the exponent
_BORDER_DB = 6.0
_NORMAL_95 = 1.96
_NEAR_M = 5.0


class SizeClass(StrEnum):
    """How large; ``unknown`` where it cannot be said."""

    SMALL = "small"
    MEDIUM = "medium"
    LARGE = "large"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class LeakSize:
    """``size``, the other class that it may as well be (None: none), and what that rests on.

    ``basis`` is ``excess`` (loudness only), ``known_leak`` (compared with one), ``itself`` (it is the known leak) or
    ``none``. ``level_db`` is the excess at reference speed and pressure, or the level relative to the known leak;
    ± ``sigma_db``. ``flow_lpm`` is a 95 % range, only with a known leak.
    """

    size: SizeClass
    basis: str
    band_hz: tuple[float, float]
    also: SizeClass | None = None
    level_db: float = float("nan")
    sigma_db: float = float("nan")
    speed_mps: float = float("nan")
    pressure_bar: float | None = None
    flow_lpm: tuple[float, float] | None = None

    @property
    def name(self) -> str:
        """``medium``, or ``small-medium`` where it may be either; as files have it."""
        if self.also is None:
            return self.size.value
        order = list(SizeClass)
        first, second = sorted((self.size, self.also), key=order.index)
        return f"{first.value}-{second.value}"

    @property
    def basis_text(self) -> str:
        """The basis in one line of plain ASCII, as files have it; empty where there is none."""
        if self.basis == "none":
            return ""
        low, high = self.band_hz
        band = f"{low:.0f}-{high:.0f} Hz"
        stated = f"{self.pressure_bar:.1f} bar" if self.pressure_bar is not None else "pressure not stated"
        if self.basis == "excess":
            speed = f"{self.speed_mps:.2f} m/s" if np.isfinite(self.speed_mps) else "speed not known"
            level = f"loudness {self.level_db:+.1f} dB +-{self.sigma_db:.0f} dB in {band}"
            return f"{level}; {speed}; {stated}; not calibrated"
        assert self.flow_lpm is not None  # both other bases have it
        flow = f"{self.flow_lpm[0]:.2g}-{self.flow_lpm[1]:.2g} L/min"
        if self.basis == "itself":
            return f"known leak: {self.flow_lpm[0]:.3g} L/min; {stated}"
        return f"{self.level_db:+.1f} dB +-{self.sigma_db:.0f} dB to the known leak in {band}; {stated}; {flow} (95 %)"


def size_of(
    candidate: Candidate, survey: Survey, settings: SizeSettings, candidates: Sequence[Candidate] = ()
) -> LeakSize:
    """Return how large a leak at ``candidate`` would be; ``candidates`` are those of the run, the known one among them.

    The candidate's evidence must hold ``size_over_db`` and ``size_background_db`` (:mod:`processing.sound.judging`);
    without them, or where nothing stands out in the band, the size is unknown.
    """
    band = (_figure(candidate, "size_low_hz"), _figure(candidate, "size_high_hz"))
    over = _figure(candidate, "size_over_db")
    if not np.isfinite(over):
        return LeakSize(SizeClass.UNKNOWN, "none", band)
    known = survey.calibration_leak
    reference = known_candidate(known, candidates) if known is not None else None
    if known is not None and reference is not None and np.isfinite(_figure(reference, "size_over_db")):
        return _compared(candidate, known, reference, survey, settings, band)
    return _by_excess(candidate, survey, settings, band)


def known_candidate(known: CalibrationLeak, candidates: Sequence[Candidate]) -> Candidate | None:
    """Return the candidate that is the known leak: the nearest within 5 m or its own interval; None if none is."""
    best, away = None, np.inf
    for c in candidates:
        reach = max(_NEAR_M, (c.chainage_high95_m - c.chainage_low95_m) / 2)
        distance = abs(c.chainage_m - known.chainage_m)
        if distance <= reach and distance < away:
            best, away = c, distance
    return best


def _by_excess(candidate: Candidate, survey: Survey, settings: SizeSettings, band: tuple[float, float]) -> LeakSize:
    over, speed = _figure(candidate, "size_over_db"), _figure(candidate, "speed_mps")
    level, variance = over, _level_sigma(over) ** 2
    if survey.device.motion is Motion.ROLLING and speed > 0:
        level += 10 * _ROLLING_EXPONENT * np.log10(speed / _REFERENCE_MPS)
    pressure = survey.pipe.pressure_bar
    if pressure is not None:
        octaves = 10 * np.log10(pressure / _REFERENCE_BAR)
        level -= settings.pressure_exponent * octaves
        variance += (_PRESSURE_SIGMA * octaves) ** 2
    sigma = float(np.sqrt(variance + _SHAPE_SIGMA_DB**2))
    borders = (settings.small_below_db, settings.large_above_db)
    size, also = _class_between(float(level), borders, _BORDER_DB)
    return LeakSize(size, "excess", band, also, float(level), sigma, speed, pressure)


def _compared(
    candidate: Candidate,
    known: CalibrationLeak,
    reference: Candidate,
    survey: Survey,
    settings: SizeSettings,
    band: tuple[float, float],
) -> LeakSize:
    pressure = survey.pipe.pressure_bar if survey.pipe.pressure_bar is not None else known.pressure_bar
    if candidate is reference or candidate.id == reference.id:
        size, _ = _class_between(known.flow_lpm, (settings.small_below_lpm, settings.large_above_lpm), 0.0)
        told = (known.flow_lpm, known.flow_lpm)
        return LeakSize(size, "itself", band, None, 0.0, 0.0, _figure(candidate, "speed_mps"), known.pressure_bar, told)
    own, its = _level(candidate), _level(reference)
    variance = _level_sigma(_figure(candidate, "size_over_db")) ** 2
    variance += _level_sigma(_figure(reference, "size_over_db")) ** 2 + _SHAPE_SIGMA_DB**2
    ratio_db = own - its
    if pressure is not None and known.pressure_bar is not None:
        octaves = 10 * np.log10(known.pressure_bar / pressure)
        ratio_db += settings.pressure_exponent * octaves
        variance += (_PRESSURE_SIGMA * octaves) ** 2
    sigma = float(np.sqrt(variance))
    flow = known.flow_lpm * 10 ** (ratio_db / 10)
    spread = 10 ** (_NORMAL_95 * sigma / 10)
    borders = tuple(10 * np.log10(x) for x in (settings.small_below_lpm, settings.large_above_lpm))
    size, also = _class_between(float(10 * np.log10(flow)), (float(borders[0]), float(borders[1])), _BORDER_DB)
    return LeakSize(
        size, "known_leak", band, also, float(ratio_db), sigma, _figure(candidate, "speed_mps"), pressure,
        (float(flow / spread), float(flow * spread)),
    )  # fmt: skip


def _class_between(value: float, borders: tuple[float, float], doubt: float) -> tuple[SizeClass, SizeClass | None]:
    """Return the class of ``value`` and the one beyond the nearest border, where that is within ``doubt``."""
    order = (SizeClass.SMALL, SizeClass.MEDIUM, SizeClass.LARGE)
    own = int(value >= borders[0]) + int(value >= borders[1])
    nearest = int(abs(value - borders[1]) < abs(value - borders[0]))
    if doubt == 0.0 or abs(value - borders[nearest]) > doubt:
        return order[own], None
    return order[own], order[nearest] if own == nearest + 1 else order[nearest + 1]


def _level(candidate: Candidate) -> float:
    """The level of the leak itself in dBFS."""
    return _figure(candidate, "size_over_db") + _figure(candidate, "size_background_db")


def _level_sigma(over_db: float) -> float:
    return _FAINT_SIGMA_DB if over_db < _FAINT_DB else _LEVEL_SIGMA_DB


def _figure(candidate: Candidate, name: str) -> float:
    value = candidate.evidence.get(name, float("nan"))
    return float(value) if isinstance(value, float | int) else float("nan")
