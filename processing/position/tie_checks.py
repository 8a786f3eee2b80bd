"""How the ties agree with each other: leave-one-out residuals, and holding down what all others contradict."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from processing.position.solving import Solution
from processing.position.ties import LENGTH, Observation
from processing.settings import PositionSettings
from processing.survey import FloatArray


@dataclass(frozen=True)
class TieCheck:
    """How a tie agrees: its residual in the fit, and how far the path would miss it were it unknown (leave-one-out)."""

    name: str  # empty for the pipe's length
    time_s: float
    kind: str  # chainage | place
    residual_m: float
    left_out_m: float
    left_out_sigma_m: float
    held_down: bool


def hold_down(
    ties: tuple[Observation, ...], solve: Callable[[tuple[Observation, ...]], Solution], settings: PositionSettings
) -> tuple[Observation, ...]:
    """Raise the sigma of ties that all the others contradict until they fit, the worst first (data snooping, Baarda).

    Two equally bad ties are both held down: nothing tells which one is wrong. One tie alone is believed.
    """
    held = list(ties)
    if len(ties) < 2:
        return ties
    limits = {size: _limit(size, settings) for size in {len(tie.value) for tie in ties}}
    for _ in range(2 * len(ties)):
        solution = solve(tuple(held))
        misses = [left_out(solution, k) for k in range(len(held))]
        excess = np.array([m.squared / limits[len(held[k].value)] for k, m in enumerate(misses)])
        if excess.max() <= 1.0 + 1e-6:
            break
        for k in np.flatnonzero(excess >= 0.9 * excess.max()):
            if excess[k] > 1.0:
                grown = held[k].covariance_m2 + misses[k].covariance_m2 * (excess[k] - 1.0)
                held[k] = replace(held[k], covariance_m2=grown)
    return tuple(held)


def _limit(size: int, settings: PositionSettings) -> float:
    """The chi-square value that is as rare for ``size`` coordinates as ``outlier_sigmas`` is for one."""
    from scipy.stats import chi2, norm

    return float(chi2.isf(2.0 * norm.sf(settings.outlier_sigmas), size))


@dataclass(frozen=True)
class Miss:
    """How far the path misses a tie that it does not know: vector, covariance (with its own), squared size."""

    vector_m: FloatArray
    covariance_m2: FloatArray
    squared: float


def left_out(solution: Solution, k: int) -> Miss:
    """Leave-one-out in closed form: with S⁻¹ the inverse and α = S⁻¹ r, the miss is (S⁻¹_kk)⁻¹ α_k."""
    at = sum(len(t.value) for t in solution.ties[:k])
    part = slice(at, at + len(solution.ties[k].value))
    covariance: FloatArray = np.asarray(np.linalg.inv(solution.inverse[part, part]), dtype=np.float64)
    alpha = solution.alpha[part]
    return Miss(covariance @ alpha, covariance, float(alpha @ covariance @ alpha))


def checks_of(solution: Solution, ties: tuple[Observation, ...], held: tuple[Observation, ...]) -> tuple[TieCheck, ...]:
    """Return the table of ties as given, for a solution that knows them as ``held``."""
    out = []
    at = 0
    for k, (tie, kept) in enumerate(zip(ties, held)):
        miss = left_out(solution, k)
        left = kept.covariance_m2 @ solution.alpha[at : at + len(tie.value)]  # observed minus fitted
        at += len(tie.value)
        variance = miss.covariance_m2 - kept.covariance_m2 + tie.covariance_m2
        level = slice(0, 2) if tie.is_place else slice(0, 1)
        # along the direction of the miss for a place: comparable to its length
        way = miss.vector_m[level] / max(float(np.linalg.norm(miss.vector_m[level])), 1e-12)
        out.append(
            TieCheck(
                name="" if tie.name == LENGTH else tie.name,
                time_s=tie.time_s,
                kind="place" if tie.is_place else "chainage",
                residual_m=float(np.linalg.norm(left[level]) if tie.is_place else left[0]),
                left_out_m=float(np.linalg.norm(miss.vector_m[level]) if tie.is_place else miss.vector_m[0]),
                left_out_sigma_m=float(np.sqrt(max(float(way @ variance[level, level] @ way), 0.0)))
                if np.any(way)
                else float(np.sqrt(variance[0, 0])),
                held_down=kept is not tie,
            )
        )
    return tuple(out)


def inflation_of(checks: tuple[TieCheck, ...]) -> float:
    """Variance factor of the model, from how far it misses ties it is not told; at least 1 (navigation §6.5)."""
    misses = [(c.left_out_m / c.left_out_sigma_m) ** 2 for c in checks if not c.held_down and c.left_out_sigma_m > 0.0]
    return float(np.clip(np.mean(misses), 1.0, 25.0)) if len(misses) >= 3 else 1.0
