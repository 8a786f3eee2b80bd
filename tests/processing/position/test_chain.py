"""The smoother of a chain: the same as solving the whole thing at once."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from processing.position.chain import Chain, Readings, log_likelihood, smooth


def drawn(seed, count, size, readings):
    """A chain whose noise has rank 1 only, with a constant and a copy among its unknowns."""
    rng = np.random.default_rng(seed)
    step = np.eye(size) + 0.3 * rng.standard_normal((count - 1, size, size)) * (rng.random((size, size)) < 0.3)
    step[:, 0] = 0.0
    step[:, 0, 0] = 1.0  # a constant
    way = rng.standard_normal((count - 1, size))
    way[:, 0] = 0.0
    noise = way[:, :, None] * way[:, None, :]
    chain = Chain(step, rng.standard_normal((count - 1, size)), noise, rng.standard_normal(size), np.eye(size))
    node = np.sort(rng.integers(0, count, readings))
    row = rng.standard_normal((readings, size)) * (rng.random((readings, size)) < 0.6)
    return chain, Readings(node, row, 3.0 * rng.standard_normal(readings), rng.uniform(0.1, 2.0, readings))


def all_at_once(chain, readings):
    """Mean and covariance of all unknowns and the log-likelihood, by the covariance of everything with everything."""
    count, size = len(chain.step) + 1, len(chain.prior_mean)
    mean, cov = np.zeros((count, size)), np.zeros((count, size, count, size))
    mean[0], cov[0, :, 0] = chain.prior_mean, chain.prior_cov
    for k in range(count - 1):
        mean[k + 1] = chain.step[k] @ mean[k] + chain.shift[k]
        for j in range(k + 1):
            cov[k + 1, :, j] = chain.step[k] @ cov[k, :, j]
            cov[j, :, k + 1] = cov[k + 1, :, j].T
        cov[k + 1, :, k + 1] = chain.step[k] @ cov[k, :, k] @ chain.step[k].T + chain.noise[k]
    full = cov.reshape(count * size, count * size)
    h = np.zeros((len(readings.node), count, size))
    h[np.arange(len(readings.node)), readings.node] = readings.row
    h = h.reshape(len(readings.node), count * size)
    spread = h @ full @ h.T + np.diag(readings.variance)
    miss = readings.value - h @ mean.ravel()
    gain = np.linalg.solve(spread, h @ full).T
    likelihood = -0.5 * (np.linalg.slogdet(spread)[1] + miss @ np.linalg.solve(spread, miss))
    after = (full - gain @ h @ full).reshape(count, size, count, size)
    return (
        mean + (gain @ miss).reshape(count, size),
        np.stack([after[k, :, k] for k in range(count)]),
        likelihood,
        np.linalg.inv(spread),
        np.linalg.solve(spread, miss),
    )


@examples(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 9), st.integers(1, 6), st.integers(0, 12))
def test_the_smoother_of_a_chain_gives_what_one_large_solution_gives(seed, count, size, readings):
    chain, read = drawn(seed, count, size, readings)
    found = smooth(chain, read)
    mean, cov, likelihood, inverse, pull = all_at_once(chain, read)
    scale = max(1.0, float(np.abs(cov).max()), float(np.abs(mean).max()))
    assert np.allclose(found.mean, mean, atol=1e-7 * scale)
    assert np.allclose(found.cov, cov, atol=1e-7 * scale)
    assert found.log_likelihood == pytest.approx(likelihood, rel=1e-7, abs=1e-6)
    assert np.allclose(found.pull, pull, atol=1e-7 * np.abs(pull).max(initial=1.0))
    for node in np.unique(read.node):
        start, stop = np.searchsorted(read.node, [node, node + 1])
        assert np.allclose(found.inverse(start, stop), inverse[start:stop, start:stop], atol=1e-6)
    assert log_likelihood(chain, read) == pytest.approx(found.log_likelihood, rel=1e-12, abs=1e-12)


def test_covariances_are_given_only_where_they_are_wanted():
    chain, read = drawn(3, 6, 4, 5)
    wanted = np.array([True, False, False, True, False, False])
    some, whole = smooth(chain, read, wanted), smooth(chain, read)
    assert np.array_equal(some.cov[wanted], whole.cov[wanted])
    assert np.array_equal(some.mean, whole.mean)
    assert not np.any(some.cov[~wanted])
