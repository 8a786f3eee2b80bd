"""Attitudes that come out while the recording runs are those of the whole run at once."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from made_imu import rolling, samples_of, turning

from processing.errors import ErrorCode, LeaklineError
from processing.orientation.calibration import calibrate
from processing.orientation.live import LIVE_NAMES, LiveAttitude
from processing.orientation.magnetometer import FieldReference
from processing.orientation.registry import estimator
from processing.orientation.samples import trusted_samples
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import ImuSamples

SETTINGS = OrientationSettings()
FIELD = FieldReference(float(np.hypot(25.0, 40.0)), float(np.arctan2(40.0, 25.0)))


def rows_of(imu, rows):
    mag = None if imu.mag_s_ut is None else imu.mag_s_ut[rows]
    return ImuSamples(imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows], mag)


def live(imu, name, field, cuts):
    attitude = LiveAttitude(name, calibrate(imu, SETTINGS), SETTINGS, 0.01, field=field, yaw_rad=0.3)
    edges = [0, *cuts, len(imu.time_s)]
    told = [attitude.add(rows_of(imu, slice(a, b))) for a, b in pairwise(edges)]
    told.append(attitude.finish())
    return np.concatenate([t for t, _ in told]), np.concatenate([q for _, q in told])


def at_once(imu, name, field):
    row = estimator(name)
    samples = trusted_samples(imu, calibrate(imu, SETTINGS), SETTINGS, field if row.uses_field else None)
    return row.function(samples, 0.3, silent()).quat_ws


def broken_run():
    """Return a run with untrusted rows, a short hole and one that loses the attitude."""
    time_s, truth = turning([0.3, 0.2, 1.0], 1.5, 20.0, rest_s=5.0)
    imu = samples_of(time_s, truth, noise=1.0)
    bad = np.random.default_rng(3).random(len(time_s)) < 0.02
    keep = ~((time_s > 10.0) & (time_s < 10.2)) & ~((time_s > 16.0) & (time_s < 18.5))
    return rows_of(replace(imu, valid=~bad), np.flatnonzero(keep))


@pytest.mark.parametrize("field", [None, FIELD], ids=["six", "nine"])
@pytest.mark.parametrize("name", LIVE_NAMES)
def test_row_by_row_or_at_once_is_the_same(name, field):
    imu = broken_run()
    whole = at_once(imu, name, field)[imu.valid]
    rng = np.random.default_rng(5)
    for cuts in ([], sorted(rng.integers(0, len(imu.time_s), 40).tolist()), range(7, len(imu.time_s), 13)):
        times, quats = live(imu, name, field, cuts)
        np.testing.assert_array_equal(times, imu.time_s[imu.valid])
        np.testing.assert_allclose(quats, whole, atol=1e-12)


def test_a_ball_that_rolls_through_a_hole_continues_live_as_it_does_afterwards():
    imu, _, _ = rolling(40.0, rate_hz=100.0)
    imu = rows_of(imu, np.flatnonzero((imu.time_s < 20.0) | (imu.time_s > 20.7)))
    _, quats = live(imu, "eskf", None, range(31, len(imu.time_s), 31))
    np.testing.assert_allclose(quats, at_once(imu, "eskf", None), atol=1e-12)


def test_the_first_attitudes_come_once_the_tilt_is_known_and_then_without_delay():
    time_s, truth = turning([0, 0, 1.0], 1.0, 5.0)
    imu = samples_of(time_s, truth)
    attitude = LiveAttitude("eskf", calibrate(imu, SETTINGS), SETTINGS, 0.01)
    waited = int(SETTINGS.start_s / 0.01)
    assert len(attitude.add(rows_of(imu, slice(0, waited)))[0]) == 0
    assert len(attitude.add(rows_of(imu, slice(waited, waited + 1)))[0]) == waited + 1
    assert len(attitude.add(rows_of(imu, slice(waited + 1, waited + 2)))[0]) == 1
    assert len(attitude.add(rows_of(imu, slice(0, 0)))[0]) == 0


def test_an_estimator_that_needs_the_whole_run_is_refused():
    with pytest.raises(LeaklineError) as error:
        LiveAttitude("offline_vqf", calibrate(broken_run(), SETTINGS), SETTINGS, 0.01)
    assert error.value.code is ErrorCode.SETTING_INVALID
