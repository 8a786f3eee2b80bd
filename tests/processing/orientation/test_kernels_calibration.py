"""The sums over a ball's rows: compiled as uncompiled, and what the algebra on arrays makes of the same rows."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.orientation import kernels_calibration
from processing.orientation import quaternions as qt
from processing.orientation.binning import BinSums

ROWS = 120


def uncompiled():
    path = Path(qt.__file__).with_name("kernels_calibration.py")
    spec = importlib.util.spec_from_file_location("uncompiled", path)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    assert not loaded.COMPILED
    return loaded


def readings(seed):
    """Turns, durations, forces and times; one row has no duration, one does not turn."""
    rng = np.random.default_rng(seed)
    turn, acc = 0.3 * rng.standard_normal((ROWS, 3)), rng.standard_normal((ROWS, 3))
    dt_s = rng.uniform(0.005, 0.02, ROWS)
    dt_s[0], turn[7] = 0.0, 0.0
    return turn, dt_s, acc, np.cumsum(dt_s)


def row_terms(turn, dt_s, acc):
    """What each row adds to its bin (m, 52), by the algebra on arrays."""
    quat = [np.array(qt.IDENTITY)]
    for step in qt.exp_map(turn):
        quat.append(qt.multiply(quat[-1], step))
    matrix = qt.to_matrix(np.array(quat[1:]))
    jacobian = np.concatenate(
        [np.einsum("kab,kc->kabc", matrix, turn).reshape(-1, 3, 9), matrix * dt_s[:, None, None]], axis=2
    )
    angle = np.linalg.norm(turn, axis=1)
    spin = np.einsum("ka,kb->kab", turn, turn) / np.where(angle > 0.0, angle, 1.0)[:, None, None]
    rate = np.einsum("kab,kb->ka", matrix, turn) / np.where(dt_s > 0.0, dt_s, np.inf)[:, None]
    force = np.einsum("kab,kb->ka", matrix, acc)
    return np.hstack([np.ones((len(turn), 1)), force, jacobian.reshape(-1, 36), spin.reshape(-1, 9), rate])


def added(module, seed, blocks):
    turn, dt_s, acc, time_s = readings(seed)
    sums, q = BinSums(0.0, 0.05, module.ROW_SIZE, most_empty=10), np.array(qt.IDENTITY)
    for a, b in zip([0, *blocks], [*blocks, ROWS], strict=True):
        place, found = sums.places(time_s[a:b])
        module.add_rolling(turn[a:b], dt_s[a:b], acc[a:b], place, q, found)
    return sums.result().sums


@given(st.integers(0, 10_000), st.lists(st.integers(0, ROWS), max_size=6).map(sorted))
def test_the_sums_are_those_of_the_rows_terms_whatever_the_blocks(seed, blocks):
    turn, dt_s, acc, time_s = readings(seed)
    expected = BinSums(0.0, 0.05, 52, most_empty=10)
    expected.add(time_s, row_terms(turn, dt_s, acc))
    np.testing.assert_allclose(added(kernels_calibration, seed, blocks), expected.result().sums, atol=1e-11)


@pytest.mark.skipif(not kernels_calibration.COMPILED, reason="the kernels are not compiled here")
def test_the_uncompiled_source_gives_the_same():
    np.testing.assert_allclose(added(uncompiled(), 1, [50]), added(kernels_calibration, 1, [50]), atol=1e-12)
