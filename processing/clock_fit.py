"""What relates the audio clock to the IMU's: pairs of moments that both felt, the line through them, its doubt."""

from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from processing.survey import ClockMap, Finding, FloatArray

_WANDER_BLOCKS = 8
_MIN_IN_BLOCK = 4
_WANDER_CHANCE = 1e-3
_EMPTY = np.zeros(0)


class PairKind(StrEnum):
    """Where a pair of moments comes from."""

    START = "start"  # knocks before the launch
    END = "end"  # knocks after the retrieval
    BUMPS = "bumps"  # joints along the way


@dataclass(frozen=True)
class Pairs:
    """Moments (n,) that both sensors felt: survey time by the IMU, and audio − survey time, in seconds."""

    survey_s: FloatArray
    shift_s: FloatArray


@dataclass(frozen=True)
class ClockFit:
    """The map with all that it rests on; ``felt_s`` and ``heard_s`` are each sensor's events, on its own clock."""

    clock: ClockMap
    findings: tuple[Finding, ...] = ()
    pairs: dict[str, Pairs] = field(default_factory=dict)  # by PairKind
    felt_s: FloatArray = field(default_factory=lambda: _EMPTY)
    heard_s: FloatArray = field(default_factory=lambda: _EMPTY)

    def residual_s(self, pairs: Pairs) -> FloatArray:
        """Return by how much (n,) each pair's sound came later than the map says, in seconds."""
        expected = self.clock.to_audio(pairs.survey_s) - pairs.survey_s
        return np.asarray(pairs.shift_s - expected, np.float64)


@dataclass(frozen=True)
class Line:
    """``audio − survey = offset_s + drift · (survey − middle_s)`` and the pairs that lie on it."""

    offset_s: float
    drift: float
    middle_s: float
    survey_s: FloatArray  # (n,) moments of the pairs
    shift_s: FloatArray  # (n,) audio − survey of the pairs

    @property
    def count(self) -> int:
        """How many pairs lie on it."""
        return len(self.survey_s)

    @property
    def residual_s(self) -> FloatArray:
        """How far (n,) each pair lies from it."""
        return np.asarray(self.shift_s - self.offset_s - self.drift * (self.survey_s - self.middle_s), np.float64)


@dataclass(frozen=True)
class Doubt:
    """One sigma of a line: at ``settled_s`` where it is least, and of its drift; ``wander_s`` is part of the former."""

    settled_s: float
    settled_sigma_s: float
    drift_sigma: float
    wander_s: float

    def at(self, survey_s: float) -> float:
        """Return one sigma in seconds at a moment of the survey."""
        return float(np.hypot(self.settled_sigma_s, self.drift_sigma * (survey_s - self.settled_s)))


def doubt_of(line: Line, delay_sigma_s: float, prior_sigma: float, least_scatter_s: float) -> Doubt:
    """Return the doubt of a least-squares line.

    The pairs' own scatter gives the sigma of their mean and of the slope; a slope that a short stretch hardly tells is
    held by ``prior_sigma``, what crystals do. The IMU's unknown delay (``delay_sigma_s``) is common to all pairs. A
    clock that wanders with its temperature leaves a course in the residuals: its size is added.
    """
    residual = line.residual_s
    scatter = float(np.sqrt(np.sum(residual**2) / max(line.count - 2, 1)))
    scatter = max(scatter, least_scatter_s)
    settled = float(line.survey_s.mean())
    spread = float(np.sum((line.survey_s - settled) ** 2))
    drift_sigma = scatter / float(np.sqrt(spread + (scatter / prior_sigma) ** 2))
    wander = wander_s(line.survey_s, residual, scatter)
    sigma = float(np.sqrt(scatter**2 / line.count + delay_sigma_s**2 + wander**2))
    return Doubt(settled, sigma, drift_sigma, wander)


def wander_s(survey_s: FloatArray, residual_s: FloatArray, scatter_s: float) -> float:
    """Return the rms course (s) that the means of eight blocks of time show beyond what scatter gives; 0 for none."""
    from scipy import special  # not scipy.stats: to load it takes a second, in the midst of a live recording

    edges = np.linspace(survey_s.min(), survey_s.max(), _WANDER_BLOCKS + 1)
    block = np.clip(np.searchsorted(edges, survey_s, side="right") - 1, 0, _WANDER_BLOCKS - 1)
    number = np.bincount(block, minlength=_WANDER_BLOCKS)
    full = number >= _MIN_IN_BLOCK
    if np.count_nonzero(full) < 4:
        return 0.0
    means = np.bincount(block, residual_s, _WANDER_BLOCKS)[full] / number[full]
    # scatter that contains the course hides it: what is left from pair to pair in time does not
    order = np.argsort(survey_s, kind="stable")
    step = np.diff(residual_s[order])
    fine = min(scatter_s, float(np.sqrt(np.mean(step**2) / 2.0)))
    expected = fine**2 / number[full]
    chi2, freedom = float(np.sum(means**2 / np.maximum(expected, 1e-12))), len(means) - 2
    if special.chdtrc(freedom, chi2) > _WANDER_CHANCE:
        return 0.0
    return float(np.sqrt(max(float(np.mean(means**2) - np.mean(expected)), 0.0)))
