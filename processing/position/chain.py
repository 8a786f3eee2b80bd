"""A chain of unknowns with linear measurements, and its exact smoother: cost linear in the number of nodes."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.position import kernels_smoother
from processing.survey import BoolArray, FloatArray

Nodes = npt.NDArray[np.intp]


@dataclass(frozen=True)
class Chain:
    """k nodes of d unknowns: ``x[i+1] = step[i] x[i] + shift[i] + noise`` of covariance ``noise[i]``; x[0] by prior."""

    step: FloatArray  # (k − 1, d, d)
    shift: FloatArray  # (k − 1, d)
    noise: FloatArray  # (k − 1, d, d)
    prior_mean: FloatArray  # (d,)
    prior_cov: FloatArray  # (d, d)


@dataclass(frozen=True)
class Readings:
    """n scalar measurements ``value = row · x[node] ± sqrt(variance)``, nodes not decreasing."""

    node: Nodes  # (n,)
    row: FloatArray  # (n, d)
    value: FloatArray  # (n,)
    variance: FloatArray  # (n,)


@dataclass(frozen=True)
class Smoothed:
    """Means (k, d) given all readings, covariances (k, d, d) where wanted (else 0), and the log-likelihood of all."""

    mean: FloatArray
    cov: FloatArray
    log_likelihood: float
    innovation: FloatArray  # (n,) of each reading against all before it
    spread: FloatArray  # (n,) its variance
    pull: FloatArray  # (n,) S⁻¹ z, with S the covariance of all readings and z what they miss the prior by
    weight: FloatArray  # (n,) the diagonal of S⁻¹
    links: FloatArray  # (n, d) see :meth:`inverse`
    readings: Readings
    gain: FloatArray  # (n, d)

    def inverse(self, start: int, stop: int) -> FloatArray:
        """Return the block of S⁻¹ for readings ``start`` … ``stop`` − 1, all at one node."""
        block = np.diag(self.weight[start:stop])
        for later in range(start + 1, stop):
            link = self.links[later].copy()
            for earlier in range(later - 1, start - 1, -1):
                value = float(self.gain[earlier] @ link)
                block[earlier - start, later - start] = block[later - start, earlier - start] = value
                link -= self.readings.row[earlier] * value
        return block


def smooth(chain: Chain, readings: Readings, wanted: BoolArray | None = None) -> Smoothed:
    """Return the unknowns of all nodes given all readings; covariances at all nodes, or at the ``wanted`` (k,)."""
    count, size = len(chain.step) + 1, len(chain.prior_mean)
    first = np.searchsorted(readings.node, np.arange(count + 1)).astype(np.intp)
    mean, cov = np.empty((count, size)), np.empty((count, size, size))
    mean[0], cov[0] = chain.prior_mean, chain.prior_cov
    room = len(readings.node)
    gain, links = np.empty((room, size)), np.empty((room, size))
    innovation, spread, pull, weight = (np.empty(room) for _ in range(4))
    work = np.empty((5, size, size))
    total = kernels_smoother.forward(
        chain.step, chain.shift, chain.noise, first, readings.row, readings.value, readings.variance,
        mean, cov, gain, innovation, spread, work,
    )  # fmt: skip
    asked = np.ones(count, dtype=np.uint8) if wanted is None else wanted.astype(np.uint8)
    smooth_mean, smooth_cov = np.empty_like(mean), np.zeros_like(cov)
    kernels_smoother.backward(
        chain.step, first, readings.row, mean, cov, gain, innovation, spread, asked, smooth_mean, smooth_cov,
        pull, weight, links, work,
    )  # fmt: skip
    return Smoothed(smooth_mean, smooth_cov, float(total), innovation, spread, pull, weight, links, readings, gain)


def log_likelihood(chain: Chain, readings: Readings) -> float:
    """Return the log-likelihood of all readings, without its constant: the way forward only."""
    count, size = len(chain.step) + 1, len(chain.prior_mean)
    first = np.searchsorted(readings.node, np.arange(count + 1)).astype(np.intp)
    mean, cov = np.empty((count, size)), np.empty((count, size, size))
    mean[0], cov[0] = chain.prior_mean, chain.prior_cov
    room = len(readings.node)
    return float(
        kernels_smoother.forward(
            chain.step, chain.shift, chain.noise, first, readings.row, readings.value, readings.variance,
            mean, cov, np.empty((room, size)), np.empty(room), np.empty(room), np.empty((5, size, size)),
        )
    )  # fmt: skip
