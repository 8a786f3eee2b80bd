"""The loops over rows of calibration and samples: compiled as uncompiled, and as the algebra on arrays says."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.orientation import kernels_calibration, kernels_samples
from processing.orientation import quaternions as qt
from processing.orientation.binning import BinSums

ROWS = 120


def uncompiled(name="kernels_calibration"):
    path = Path(qt.__file__).with_name(f"{name}.py")
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


def design(module, seed):
    turn, _, acc, _ = readings(seed)
    slope, up = np.roll(acc, 1, axis=1), np.array([0.6, 0.0, 0.8])
    quat, out = qt.exp_map(turn), np.empty((ROWS, 3, 17))
    module.accelerometer_design(acc, turn, slope, quat, up, 9.8, out)
    return quat, acc, turn, slope, up, out


@given(st.integers(0, 10_000))
def test_the_accelerometers_design_is_the_change_of_the_force_with_each_error(seed):
    quat, acc, rate, slope, up_w, found = design(kernels_calibration, seed)
    matrix, up = qt.to_matrix(quat), qt.rotate_inverse(quat, up_w)

    def felt(x):
        """Force in the carried frame by the model, less gravity: scale and misalignment, offset, arm, radius."""
        scale, offset, arm = x[:9].reshape(3, 3), x[9:12], x[12:15]
        centripetal = np.cross(slope, arm) + np.cross(rate, np.cross(rate, arm))
        force = 9.8 * up @ scale.T + offset + centripetal + x[15] * np.cross(slope, up)
        return np.einsum("kab,kb->ka", matrix, force)

    for column, error in enumerate(np.eye(16)):
        np.testing.assert_allclose(found[:, :, column], felt(error), atol=1e-11)
    np.testing.assert_allclose(found[:, :, 16], qt.rotate(quat, acc) - 9.8 * up_w, atol=1e-11)


def corrected(module, seed, of_interval=True, holes=()):
    """Rates, turns, slopes, forces and weights of random readings, side by side."""
    rng = np.random.default_rng(seed)
    rate, _, acc, time_s = readings(seed)
    time_s = time_s + np.sum([np.where(np.arange(ROWS) > k, s, 0.0) for k, s in holes], axis=0)
    bias, matrix = rng.standard_normal((3, 3)), rng.standard_normal((3, 3))
    out = {k: np.zeros((ROWS, 3)) for k in ("rates", "turns", "slopes", "forces")} | {"weights": np.zeros(ROWS)}
    frozen = [rate, time_s, acc]
    for array in frozen:
        array.flags.writeable = False  # pages of a file are
    module.correct_rates(time_s, rate, np.array([0.2, 0.4, 0.9]), bias, matrix, out["rates"])
    module.turns(rate, time_s, of_interval, 0.01, 0.1, out["turns"])
    module.slopes(rate, time_s, out["slopes"])
    module.correct_force(acc, rate, out["slopes"], bias[0], bias[1], matrix, out["forces"])
    module.gravity_weights(out["forces"], 0.1, out["weights"])
    return rate, time_s, acc, bias, matrix, out


@given(st.integers(0, 10_000))
def test_rates_slopes_forces_and_weights_are_those_of_the_algebra_on_arrays(seed):
    rate, time_s, acc, bias, matrix, out = corrected(kernels_samples, seed)
    offset = np.column_stack([np.interp(time_s, [0.2, 0.4, 0.9], bias[:, k]) for k in range(3)])
    np.testing.assert_allclose(out["rates"], (rate - offset) @ matrix.T, atol=1e-12)
    np.testing.assert_allclose(out["slopes"], np.gradient(rate, time_s, axis=0), rtol=1e-9, atol=1e-9)
    centripetal = np.cross(out["slopes"], bias[1]) + np.cross(rate, np.cross(rate, bias[1]))
    np.testing.assert_allclose(out["forces"], (acc - bias[0] - centripetal) @ matrix.T, rtol=1e-9, atol=1e-9)
    off = (np.linalg.norm(out["forces"], axis=1) - 1.0) / 0.1
    np.testing.assert_allclose(out["weights"], 1.0 / (1.0 + off**2), rtol=1e-9)


@given(st.integers(0, 10_000), st.booleans())
def test_turns_are_rates_times_their_time_and_nothing_over_long_holes(seed, of_interval):
    holes = ((30, 0.05), (60, 0.5))
    rate, time_s, _, _, _, out = corrected(kernels_samples, seed, of_interval, holes)
    gap = np.diff(time_s)[:, None]
    own = np.where(gap > 0.015, 0.01, gap)
    expected = rate[1:] * own + 0.5 * (rate[:-1] + rate[1:]) * (gap - own)
    if not of_interval:
        expected = 0.5 * (rate[:-1] + rate[1:]) * gap + np.cross(rate[:-1], rate[1:]) * gap**2 / 12.0
    expected[60] = 0.0
    np.testing.assert_allclose(out["turns"][1:], expected, atol=1e-14)
    np.testing.assert_array_equal(out["turns"][0], 0.0)


@pytest.mark.skipif(not kernels_samples.COMPILED, reason="the kernels are not compiled here")
@pytest.mark.parametrize("of_interval", [True, False])
def test_the_uncompiled_readings_and_design_are_the_same(of_interval):
    *_, slow = corrected(uncompiled("kernels_samples"), 1, of_interval, ((60, 0.5),))
    *_, fast = corrected(kernels_samples, 1, of_interval, ((60, 0.5),))
    for name, values in slow.items():
        np.testing.assert_allclose(values, fast[name], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(design(uncompiled(), 1)[-1], design(kernels_calibration, 1)[-1], atol=1e-12)


@pytest.mark.parametrize("module", [kernels_calibration, None], ids=["compiled", "source"])
def test_the_moments_are_sums_and_sums_of_squares(module):
    rate, _, acc, time_s = readings(3)
    sums, expected = (BinSums(0.0, 0.05, 13, most_empty=10) for _ in range(2))
    for part in (slice(0, 50), slice(50, ROWS)):
        (module or uncompiled()).add_moments(acc[part], rate[part], *sums.places(time_s[part]))
    expected.add(time_s, np.hstack([np.ones((ROWS, 1)), acc, rate, acc**2, rate**2]))
    np.testing.assert_allclose(sums.result().sums, expected.result().sums, atol=1e-13)
