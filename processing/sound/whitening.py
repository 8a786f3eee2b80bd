"""Scores each metre of pipe by how much it sounds like a passed leak, in bands made independent of each other.

What varies together over the bands (flow, rolling, speed) is far stronger than what few frames leave uncertain, but has
few patterns: the covariance of the shape filters' output is a few strong factors over even noise. Eigenvalues beyond
what chance gives (Marchenko and Pastur 1967) are factors, the rest is noise: the spiked model (Johnstone 2001).
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import optimize

from processing.sound.background import robust_sigma
from processing.sound.cells import CELL_M
from processing.sound.sound_field import WIDTHS_M, SoundField, amplitudes
from processing.survey import BoolArray, FloatArray

_MOST_FACTORS = 8
_CELLS_A_WIDTH = 2.5  # half-widths of pipe that make one independent look
_LEAST_LOOKS = 15.0
_LEAST_NOISE = 0.03  # of the cells' own variance
_LEAST_SCALE = 0.8
_MOST_ALIKE = 0.95
_TRIED = 6  # spectra that fit best are tried beside the rivals


@dataclass(frozen=True)
class Whitened:
    """One width: ``matrix`` (b, b) makes heights over their noise independent; all spectra in those coordinates."""

    width_m: float
    matrix: FloatArray
    values: FloatArray  # (n, b)
    leaks: FloatArray  # (b, k) unit
    rivals: FloatArray  # (b, m) unit
    scale: float  # of a leak's score where there is nothing, 1 if the model were all


@dataclass(frozen=True)
class ScoreMap:
    """The quick score of each cell (n,), −inf where not heard, and which width gave it."""

    score: FloatArray
    width: npt.NDArray[np.int64]  # index of WIDTHS_M
    whitened: tuple[Whitened, ...]


def score_map(
    field: SoundField, excess: FloatArray, weight: FloatArray, usual: BoolArray, leaks: FloatArray, rivals: FloatArray
) -> ScoreMap:
    """Return the scores of ``excess`` (n, b); ``usual`` (n,) are the cells that teach the covariance."""
    best = np.full(len(excess), -np.inf)
    which = np.zeros(len(excess), np.int64)
    layers = []
    for index, width_m in enumerate(WIDTHS_M):
        layer, score = _layer(field, excess, weight, usual, leaks, rivals, width_m)
        score[~field.heard] = -np.inf
        better = score > best
        best[better], which[better] = score[better], index
        layers.append(layer)
    return ScoreMap(best, which, tuple(layers))


def whiten(layer: Whitened, height: FloatArray, information: float, field: SoundField) -> FloatArray:
    """Return a height (b,) in the layer's independent coordinates."""
    return np.asarray(layer.matrix @ (height * np.sqrt(information / field.variance)), np.float64)


def likelihood_ratio(layer: Whitened, value: FloatArray) -> tuple[float, int]:
    """Return the root of the drop in χ² that one leak spectrum brings beside any rivals, and which; (0, −1) for none.

    Rivals and leak have strengths of at least nothing (non-negative least squares), with and without the leak.
    """
    strengths, without = optimize.nnls(layer.rivals, value)
    left = value - layer.rivals @ strengths
    likeness = layer.leaks.T @ left
    best, which = 0.0, -1
    for k in np.argsort(-likeness)[:_TRIED]:
        if likeness[k] <= 0:
            break
        _, with_it = optimize.nnls(np.column_stack([layer.rivals, layer.leaks[:, k]]), value)
        if without**2 - with_it**2 > best:
            best, which = without**2 - with_it**2, int(k)
    return float(np.sqrt(best)) / layer.scale, which


def spiked(values: FloatArray, looks: float) -> tuple[FloatArray, float]:
    """Return the inverse (b, b) of the covariance of ``values`` (n, b) as factors over even noise, and that noise."""
    eigenvalues, vectors = np.linalg.eigh(np.cov(values.T))
    noise = max(float(np.median(eigenvalues)), _LEAST_NOISE)
    edge = noise * (1 + np.sqrt(values.shape[1] / looks)) ** 2
    factor = (eigenvalues > edge) & (np.arange(len(eigenvalues)) >= len(eigenvalues) - _MOST_FACTORS)
    inverse = 1.0 / np.where(factor, eigenvalues, noise)
    return np.asarray((vectors * inverse) @ vectors.T, np.float64), noise


def _layer(
    field: SoundField,
    excess: FloatArray,
    weight: FloatArray,
    usual: BoolArray,
    leaks: FloatArray,
    rivals: FloatArray,
    width_m: float,
) -> tuple[Whitened, FloatArray]:
    sigma = np.sqrt(field.variance)
    height, information = amplitudes(excess, weight, width_m)
    over_noise = height * np.sqrt(information)[:, None] / sigma
    looks = max(_LEAST_LOOKS, float(np.count_nonzero(usual)) * CELL_M / (_CELLS_A_WIDTH * width_m))
    precision, _ = spiked(over_noise[usual], looks)
    matrix = np.asarray(np.linalg.cholesky(precision).T, np.float64)
    values = over_noise @ matrix.T
    leak, rival = _unit(matrix @ (leaks / sigma[:, None])), _unit(matrix @ (rivals / sigma[:, None]))
    leak_score, leak_scale = _scaled(values @ leak, usual)
    rival_score, _ = _scaled(values @ rival, usual)
    layer = Whitened(width_m, matrix, values, leak, rival, float(np.median(leak_scale)))
    return layer, _conditional(leak_score, rival_score, np.clip(leak.T @ rival, -_MOST_ALIKE, _MOST_ALIKE))


def _scaled(score: FloatArray, usual: BoolArray) -> tuple[FloatArray, FloatArray]:
    """Return the scores over their own robust sigma where it is usual, and that sigma: no model is complete."""
    scale = np.maximum(np.array([robust_sigma(column) for column in score[usual].T]), _LEAST_SCALE)
    return np.asarray(score / scale), scale


def _conditional(leak: FloatArray, rival: FloatArray, alike: FloatArray) -> FloatArray:
    """Return (n,) the best leak's score once the rival that explains most of it is taken out."""
    lowest = leak.copy()
    for m in range(rival.shape[1]):
        present = np.maximum(rival[:, m : m + 1], 0.0)
        rho = alike[:, m]
        np.minimum(lowest, np.where(present > 0, (leak - present * rho) / np.sqrt(1 - rho**2), leak), out=lowest)
    return np.asarray(lowest.max(axis=1), np.float64)


def _unit(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.linalg.norm(columns, axis=0), np.float64)
