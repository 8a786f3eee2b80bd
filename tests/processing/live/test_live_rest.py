"""Rests as they happen against the rests found after the run."""

import numpy as np
import pytest

from processing.live.live_rest import RestWatch
from processing.orientation.calibration import calibrate
from processing.settings import OrientationSettings
from processing.survey import ImuSamples

SETTINGS = OrientationSettings()
RATE_HZ = 100.0


def run(pieces, bias_dps=(0.3, -0.5, 0.2), noise_dps=0.05, seed=0):
    """Pieces (seconds, rate in °/s about y) of a device that turns or lies."""
    rng = np.random.default_rng(seed)
    rate = np.concatenate([np.full(int(s * RATE_HZ), dps) for s, dps in pieces])
    n = len(rate)
    gyr = np.radians(np.column_stack([np.zeros(n), rate, np.zeros(n)]) + bias_dps)
    gyr += np.radians(rng.normal(0.0, noise_dps, (n, 3)))
    moving = (rate != 0.0)[:, None]
    acc = np.array([0.0, 0.0, 9.79]) + rng.normal(0.0, 1.0, (n, 3)) * np.where(moving, 0.6, 0.01)
    return ImuSamples(np.arange(n) / RATE_HZ, acc, gyr, np.ones(n, bool))


def watch(imu, block=7):
    rest, better = RestWatch(SETTINGS), []
    for a in range(0, len(imu.time_s), block):
        rows = slice(a, a + block)
        part = ImuSamples(imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows])
        if rest.add(part):
            better.append(float(imu.time_s[min(a + block, len(imu.time_s)) - 1]))
    return rest, better


def test_the_first_rest_tells_the_offset_while_it_lasts():
    rest, better = watch(run([(10.0, 0.0)]))
    assert better[0] < 3.5
    assert rest.is_resting
    np.testing.assert_allclose(np.degrees(rest.calibration().bias_radps[0]), [0.3, -0.5, 0.2], atol=0.01)
    assert rest.calibration().gravity_mps2 == pytest.approx(9.79, abs=0.002)


def test_it_finds_what_is_found_after_the_run():
    imu = run([(8.0, 0.0), (20.0, 300.0), (6.0, 0.0), (10.0, -200.0), (3.0, 0.0)])
    rest, _ = watch(imu)
    whole = calibrate(imu, SETTINGS)
    assert rest.rests == len(whole.rests) == 3
    np.testing.assert_allclose(rest.calibration().bias_radps[0], whole.bias_radps[-1], atol=np.radians(0.02))
    assert rest.calibration().gravity_mps2 == pytest.approx(whole.gravity_mps2, abs=0.005)


def test_an_offset_that_has_wandered_is_found_anew_at_a_later_rest():
    first, later = run([(8.0, 0.0), (5.0, 300.0)]), run([(8.0, 0.0)], bias_dps=(0.5, -0.5, 0.0), seed=1)
    imu = ImuSamples(
        np.concatenate([first.time_s, later.time_s + 600.0]),
        np.vstack([first.acc_s_mps2, later.acc_s_mps2]),
        np.vstack([first.gyr_s_radps, later.gyr_s_radps]),
        np.ones(len(first.time_s) + len(later.time_s), bool),
    )
    rest, _ = watch(imu)
    np.testing.assert_allclose(np.degrees(rest.calibration().bias_radps[0]), [0.5, -0.5, 0.0], atol=0.02)


def test_a_slow_steady_turn_after_a_rest_is_no_rest():
    imu = run([(6.0, 0.0), (2.0, 100.0), (20.0, 5.0)])
    imu.acc_s_mps2[800:] = [0.0, 0.0, 9.79]  # as smooth as a rest
    rest, _ = watch(imu)
    np.testing.assert_allclose(np.degrees(rest.calibration().bias_radps[0]), [0.3, -0.5, 0.2], atol=0.02)


def test_a_device_that_never_rests_has_no_calibration():
    rest, better = watch(run([(30.0, 300.0)]))
    assert not better
    assert rest.calibration().basis == "none"
    assert np.all(rest.calibration().bias_radps == 0.0)


def test_a_hole_in_the_samples_ends_a_rest():
    imu = run([(1.7, 0.0)])
    again = ImuSamples(imu.time_s + 60.0, imu.acc_s_mps2, imu.gyr_s_radps, imu.valid)
    rest = RestWatch(SETTINGS)
    rest.add(imu)
    rest.add(again)
    assert rest.rests == 0  # two short moments are no rest of two seconds
