"""Rests, offset, noise and gravity from made and from real recordings."""

from dataclasses import replace

import broad
import numpy as np
import pytest
from made_imu import GRAVITY_MPS2, rolling, samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.calibration import calibrate, calibration_findings, local_gravity_mps2
from processing.orientation.rests import find_rests
from processing.settings import OrientationSettings
from processing.survey import ImuSamples, Launch, Severity

SETTINGS = OrientationSettings()
BIAS = np.radians([0.4, -0.7, 0.2])


def resting(seconds, rate_hz=100.0, noise=1.0, bias=BIAS, seed=0):
    time_s = np.arange(0.0, seconds, 1.0 / rate_hz)
    quat_ws = np.broadcast_to(qt.from_euler_zyx(0.3, -0.2, 1.0), (len(time_s), 4))
    return samples_of(time_s, quat_ws, bias_radps=bias, noise=noise, seed=seed)


def test_the_offset_is_found_within_its_sigma_and_the_noise_as_a_density():
    calibration = calibrate(resting(60.0), SETTINGS)
    assert calibration.basis == "rest"
    assert np.all(np.abs(calibration.bias_radps[0] - BIAS) < 4.0 * calibration.bias_sigma_radps[0])
    assert calibration.gyr_noise_radps_rthz == pytest.approx(np.radians(0.1) * np.sqrt(2 / 100.0), rel=0.05)
    assert calibration.acc_noise_mps2_rthz == pytest.approx(0.03 * np.sqrt(2 / 100.0), rel=0.05)
    assert calibration.gravity_mps2 == pytest.approx(GRAVITY_MPS2, abs=0.002)


def test_rests_before_and_after_a_movement_are_both_found_and_the_movement_is_not():
    time_s, quat_ws = turning([0, 0, 1.0], 2.0, 10.0, rest_s=5.0)
    rests = find_rests(samples_of(time_s, quat_ws, bias_radps=BIAS, noise=1.0), SETTINGS)
    assert [round(r.start_s) for r in rests] == [0, 15]
    assert [round(r.end_s) for r in rests] == [5, 20]
    assert all(r.end_s <= 5.25 or r.start_s >= 14.75 for r in rests)


def test_an_offset_that_drifts_is_interpolated_between_rests_and_held_outside():
    time_s, quat_ws = turning([1.0, 1.0, 0], 3.0, 100.0, rest_s=20.0)
    drift = np.radians(0.2) * (time_s / 140.0)[:, None]
    calibration = calibrate(samples_of(time_s, quat_ws, bias_radps=drift, noise=1.0), SETTINGS)
    assert len(calibration.rests) == 2
    np.testing.assert_allclose(calibration.bias_at(np.array([70.0]))[0], np.radians(0.1), atol=np.radians(0.02))
    np.testing.assert_array_equal(calibration.bias_at(np.array([-5.0, 999.0])), calibration.bias_radps)


def test_sigma_grows_away_from_the_rests():
    calibration = calibrate(resting(10.0), SETTINGS)
    near, far = calibration.sigma_at(np.array([5.0, 3605.0]))
    assert np.all(far > 10 * near)


def test_corrected_rates_are_scale_times_rate_less_offset():
    calibration = replace(calibrate(resting(10.0, noise=0.0), SETTINGS), gyr_matrix=np.diag([1.0, 1.01, 0.99]))
    corrected = calibration.corrected(np.array([1.0]), np.array([[1.0, 1.0, 1.0]]))
    np.testing.assert_allclose(corrected[0], (1.0 - BIAS) * [1.0, 1.01, 0.99], atol=1e-9)


def test_a_slow_steady_turn_between_rests_is_not_taken_for_a_rest():
    time_s, quat_ws = turning([0, 0, 1.0], np.radians(3.0), 15.0, rest_s=10.0)
    rests = find_rests(samples_of(time_s, quat_ws, noise=1.0), SETTINGS)
    # the turn about the vertical shakes nothing, yet its rate is not that of the two rests
    assert len(rests) == 2
    assert max(np.degrees(np.linalg.norm(r.gyr_mean_radps)) for r in rests) < 0.1


def test_untrusted_rows_do_not_spoil_a_rest():
    imu = resting(20.0)
    broken = np.arange(0, len(imu.time_s), 7)
    gyr, valid = imu.gyr_s_radps.copy(), imu.valid.copy()
    gyr[broken], valid[broken] = 1e5, False
    calibration = calibrate(replace(imu, gyr_s_radps=gyr, valid=valid), SETTINGS)
    np.testing.assert_allclose(calibration.bias_radps[0], BIAS, atol=np.radians(0.02))


def test_no_rest_is_a_warning_and_a_wide_sigma():
    imu, _, _ = rolling(30.0)
    calibration = calibrate(replace_rows(imu, imu.time_s > 12.0), SETTINGS)
    assert calibration.basis == "none"
    assert np.degrees(calibration.bias_sigma_radps.min()) == pytest.approx(1.0)
    (finding,) = calibration_findings(calibration, Launch(), SETTINGS)
    assert (finding.code, finding.severity) == ("no_rest_no_bias", Severity.WARNING)


def replace_rows(imu, keep):
    return ImuSamples(imu.time_s[keep], imu.acc_s_mps2[keep], imu.gyr_s_radps[keep], imu.valid[keep])


def test_a_wrong_gravity_at_rest_is_told():
    imu = resting(10.0)
    calibration = calibrate(replace(imu, acc_s_mps2=1.05 * imu.acc_s_mps2), SETTINGS)
    codes = {f.code: f for f in calibration_findings(calibration, Launch(latitude=41.0), SETTINGS)}
    assert codes["gravity_off"].params["off_percent"] == pytest.approx(5.0, abs=0.1)
    right = calibration_findings(calibrate(imu, SETTINGS), Launch(latitude=41.0), SETTINGS)
    assert [f.code for f in right] == ["rests_found"]


@pytest.mark.parametrize(("latitude", "gravity"), [(0.0, 9.780325), (45.0, 9.806199), (90.0, 9.832185)])
def test_local_gravity_is_that_of_the_ellipsoid(latitude, gravity):
    assert local_gravity_mps2(Launch(latitude=latitude)) == pytest.approx(gravity, abs=2e-6)
    assert local_gravity_mps2(Launch(latitude=latitude, elevation_m=1000.0)) == pytest.approx(
        gravity - 0.003086, abs=2e-6
    )


def test_long_runs_are_read_in_blocks_with_the_same_result(monkeypatch):
    time_s, quat_ws = turning([1.0, 0, 1.0], 3.0, 20.0, rest_s=10.0)
    imu = samples_of(time_s, quat_ws, bias_radps=BIAS, noise=1.0)
    whole = calibrate(imu, SETTINGS)
    monkeypatch.setattr("processing.orientation.rests._BLOCK_ROWS", 333)
    blocks = calibrate(imu, SETTINGS)
    np.testing.assert_allclose(blocks.bias_radps, whole.bias_radps, atol=1e-14)
    np.testing.assert_allclose(blocks.bias_time_s, whole.bias_time_s)


@pytest.mark.data
def test_broads_rests_are_found_and_agree(shared_data):
    trial = broad.read_trial(shared_data / "broad", 9)  # fast rotation with breaks
    calibration = calibrate(trial.imu, SETTINGS)
    assert len(calibration.rests) == 5
    assert np.degrees(np.ptp(calibration.bias_radps, axis=0)).max() < 0.05
    for rest in calibration.rests:
        inside = (trial.imu.time_s > rest.start_s) & (trial.imu.time_s < rest.end_s)
        truth = trial.truth_ws[inside]
        truth = truth[np.isfinite(truth[:, 0])]
        assert np.degrees(qt.angle_between(truth[0], truth[-1])) < 1.0


def shaken(imu, hertz=11.0, seed=1):
    """Shake the device as an engine does: many times what a quiet rest may scatter."""
    rng = np.random.default_rng(seed)
    wave = np.sin(2.0 * np.pi * hertz * imu.time_s[:, None] + rng.uniform(0.0, 6.0, (1, 6)))
    wave = wave + 0.3 * rng.standard_normal(wave.shape)
    return replace(
        imu,
        acc_s_mps2=imu.acc_s_mps2 + 1.2 * wave[:, :3],
        gyr_s_radps=imu.gyr_s_radps + np.radians(1.5) * wave[:, 3:],
    )


def test_a_device_that_lies_still_and_is_shaken_tells_its_offset_but_not_its_noise():
    calibration = calibrate(shaken(resting(20.0)), SETTINGS)
    assert calibration.basis == "rest"
    assert all(r.shaken for r in calibration.rests)
    np.testing.assert_allclose(calibration.bias_radps[0], BIAS, atol=np.radians(0.03))
    assert calibration.gyr_noise_radps_rthz is None


def test_a_shaken_rest_beside_a_quiet_one_is_found_too():
    time_s, quat_ws = turning([1.0, 1.0, 0], 3.0, 20.0, rest_s=10.0)
    imu = samples_of(time_s, quat_ws, bias_radps=BIAS, noise=1.0)
    late = (time_s > 30.0)[:, None]
    trembling = shaken(imu)
    mixed = replace(
        imu,
        acc_s_mps2=np.where(late, trembling.acc_s_mps2, imu.acc_s_mps2),
        gyr_s_radps=np.where(late, trembling.gyr_s_radps, imu.gyr_s_radps),
    )
    rests = calibrate(mixed, SETTINGS).rests
    assert [r.shaken for r in rests] == [False, True]
    np.testing.assert_allclose(rests[1].gyr_mean_radps, BIAS, atol=np.radians(0.05))


def test_walking_is_no_shaken_rest():
    time_s = np.arange(0.0, 60.0, 0.01)
    swing = 0.15 * np.sin(2.0 * np.pi * 0.9 * time_s)[:, None] * np.array([1.0, 0.4, 0.2])
    turn = 0.4 * np.sin(2.0 * np.pi * time_s / 9.0)[:, None] * np.array([0.0, 0.0, 1.0])
    imu = samples_of(time_s, qt.multiply(qt.exp_map(turn), qt.exp_map(swing)), noise=1.0)
    assert find_rests(imu, SETTINGS) == ()
