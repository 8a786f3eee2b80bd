"""Every estimator against attitudes that are known in closed form, and against its own symmetries."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import attitude_error_deg, rolling, samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.registry import ESTIMATORS, estimate_attitude
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Launch, Motion, ProcessingChoice, Survey

FUSING = ("offline_vqf", "batch", "vqf", "eskf", "ukf", "ekf7", "ekf_gd", "madgwick", "mahony")
ALL = tuple(e.name for e in ESTIMATORS if e.name != "device")
SIX_AXES = OrientationSettings(magnetometer="ignore")
NINE_AXES = OrientationSettings(magnetometer="use")


def estimate(imu, method, settings=SIX_AXES, launch=Launch(), motion=Motion.CARRIED):  # noqa: B008  # frozen
    survey = Survey(device=DeviceInfo(motion=motion), launch=launch, processing=ProcessingChoice(orientation=method))
    return estimate_attitude(imu, survey, settings, silent())[0]


@pytest.mark.parametrize("axis", [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0], [1.0, 1.0, 0], [0.2, -0.7, 0.5]])
@pytest.mark.parametrize("method", [*FUSING, "gyro"])
def test_a_steady_turn_about_any_axis_is_followed(method, axis):
    time_s, truth = turning(axis, 12.0, 20.0)
    attitude = estimate(samples_of(time_s, truth), method)
    heading, inclination = attitude_error_deg(attitude.quat_ws, truth)
    # VQF looks for an offset in the turn itself
    assert np.abs(heading).max() < (0.2 if "vqf" in method else 0.05)
    assert inclination.max() < 0.05


@pytest.mark.parametrize("method", [*FUSING, "accmag"])
def test_heading_and_tilt_are_absolute_where_the_field_is_trusted(method):
    start = qt.from_euler_zyx(0.4, -0.9, 2.5)
    time_s, truth = turning([0.1, 0.3, 0.9], 1.0, 20.0, start=start)
    attitude = estimate(samples_of(time_s, truth), method, NINE_AXES)
    assert attitude.heading_from == "magnetometer"
    assert np.degrees(qt.angle_between(attitude.quat_ws, truth)).max() < 0.3


def cone(seconds=60.0, rate_hz=200.0, half_angle=0.1745, rate=18.85):
    """Return times, attitudes and closed-form body rates: at rest for 5 s, then the z axis draws a cone at 3 Hz."""
    time_s = np.arange(0.0, seconds, 1.0 / rate_hz)
    phase = rate * np.maximum(time_s - 5.0, 0.0)
    moving = (time_s > 5.0).astype(float)
    truth = qt.exp_map(half_angle * np.column_stack([np.cos(phase), np.sin(phase), 0.0 * phase]))
    s, c = np.sin(half_angle), np.cos(half_angle)
    gyr = rate * moving[:, None] * np.column_stack([-s * np.sin(phase), s * np.cos(phase), (c - 1.0) + 0.0 * phase])
    return time_s, truth, gyr


def test_the_closed_form_rates_of_the_cone_are_its_derivative():
    _, truth, gyr = cone(rate_hz=4000.0, seconds=7.0)
    turn = qt.log_map(qt.multiply(qt.conjugate(truth[:-1]), truth[1:])) * 4000.0
    np.testing.assert_allclose(turn[24000:], 0.5 * (gyr[24000:-1] + gyr[24001:]), atol=1e-3)


@pytest.mark.parametrize("method", ["gyro", "madgwick", "mahony", "ekf7", "ekf_gd", "ukf", "eskf"])
def test_coning_is_integrated_without_drift(method):
    time_s, truth, _ = cone()
    heading, inclination = attitude_error_deg(estimate(samples_of(time_s, truth), method).quat_ws, truth)
    assert np.abs(heading).max() < 0.01
    assert inclination.max() < 0.01


def test_rates_of_the_moment_have_their_own_setting():
    time_s = np.arange(0.0, 30.0, 0.01)
    rate = 20.0 * np.clip((time_s - 5.0) / 2.0, 0.0, 1.0)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(time_s))])
    truth = qt.exp_map(angle[:, None] * np.array([1.0, 0.0, 0.0]))
    imu = replace(samples_of(time_s, truth), gyr_s_radps=rate[:, None] * np.array([1.0, 0.0, 0.0]))
    off = {}
    for choice in ("instant", "interval"):
        _, inclination = attitude_error_deg(
            estimate(imu, "gyro", replace(SIX_AXES, rate_stands_for=choice)).quat_ws, truth
        )
        off[choice] = inclination[-1]
    assert off["instant"] < 0.01
    assert off["interval"] == pytest.approx(np.degrees(20.0 * 0.005), rel=0.01)  # half a sample


@pytest.mark.parametrize("method", FUSING)
def test_an_hour_at_rest_with_an_offset_leaves_tilt_and_heading_where_they_were(method):
    time_s = np.arange(0.0, 3600.0, 0.05)
    truth = np.broadcast_to(qt.from_euler_zyx(0.2, 0.5, 0.0), (len(time_s), 4))
    imu = samples_of(time_s, truth, bias_radps=np.radians([0.5, -0.3, 0.8]), noise=1.0)
    heading, inclination = attitude_error_deg(estimate(imu, method).quat_ws, truth)
    assert np.abs(heading).max() < 6.0  # the offset alone would turn it by 2880°, the noise alone walks by 1.3°
    assert np.sqrt(np.mean(inclination**2)) < 0.3


@pytest.mark.parametrize("method", FUSING)
def test_after_a_hole_in_which_it_was_turned_over_the_tilt_is_found_again(method):
    time_s, truth = turning([1.0, 0.2, 0], 2.0, 10.0, rest_s=5.0)
    imu = samples_of(time_s, truth, noise=1.0)
    keep = (time_s < 8.0) | (time_s > 12.0)
    kept = type(imu)(imu.time_s[keep], imu.acc_s_mps2[keep], imu.gyr_s_radps[keep], imu.valid[keep])
    _, inclination = attitude_error_deg(estimate(kept, method).quat_ws, truth[keep])
    after = time_s[keep] > 13.5
    assert inclination[after].max() < 2.0


@pytest.mark.parametrize("method", [*FUSING, "gyro"])
def test_a_ball_that_rolls_on_through_a_hole_keeps_its_tilt_and_the_direction_of_its_axis(method):
    imu, truth, _ = rolling(60.0)
    keep = (imu.time_s < 30.0) | (imu.time_s > 30.7)  # 1.3 revolutions lost
    kept = type(imu)(imu.time_s[keep], imu.acc_s_mps2[keep], imu.gyr_s_radps[keep], imu.valid[keep])
    heading, inclination = attitude_error_deg(estimate(kept, method, motion=Motion.ROLLING).quat_ws, truth[keep])
    after = imu.time_s[keep] > 33.0
    assert inclination[after].max() < 4.0
    # heading errors are those of the axis: whole turns and the wrap of the error at half a turn do not matter
    off = (heading[after] - heading[1000] + 180.0) % 360.0 - 180.0
    assert np.abs(off).max() < 4.0


@pytest.mark.parametrize("method", ALL)
def test_untrusted_rows_get_a_finite_attitude_and_do_not_hurt_their_neighbours(method):
    time_s, truth = turning([0.5, 0.5, 0.7], 1.0, 20.0)
    imu = samples_of(time_s, truth, noise=1.0)
    rng = np.random.default_rng(1)
    bad = rng.random(len(time_s)) < 0.1  # scattered: bridged
    bad[:20] = True  # before the first trusted row
    bad[700:730] = True  # 0.3 s while turning: held
    acc, gyr, mag = (np.where(bad[:, None], 1e4, v) for v in (imu.acc_s_mps2, imu.gyr_s_radps, imu.mag_s_ut))
    broken = replace(imu, acc_s_mps2=acc, gyr_s_radps=gyr, mag_s_ut=mag, valid=~bad)
    quat_ws = estimate(broken, method, NINE_AXES if method == "accmag" else SIX_AXES).quat_ws
    assert np.all(np.isfinite(quat_ws))
    np.testing.assert_allclose(np.linalg.norm(quat_ws, axis=1), 1.0, atol=1e-9)
    error = np.degrees(qt.angle_between(quat_ws[:690], truth[:690]))
    assert error[~bad[:690]].max() < (5.0 if method == "accmag" else 3.0)
    if method != "accmag":  # each row alone: its error is no memory
        assert np.degrees(qt.angle_between(quat_ws[-1], truth[-1])) < 25.0  # 0.3 s at 57 °/s are lost, not invented


@pytest.mark.parametrize("method", [*FUSING, "gyro"])
def test_the_launch_heading_is_the_first_yaw_where_nothing_else_tells_it(method):
    time_s, truth = turning([0, 0, 1.0], 0.5, 5.0, start=qt.from_euler_zyx(0.1, 0.2, -1.0))
    for heading_deg, yaw_deg in ((None, 0.0), (90.0, 0.0), (0.0, 90.0), (225.0, -135.0)):
        attitude = estimate(samples_of(time_s, truth), method, launch=Launch(heading_deg=heading_deg))
        assert attitude.heading_from == "launch"
        yaw = np.degrees(qt.to_roll_pitch_yaw(attitude.quat_ws[0])[2])
        assert yaw == pytest.approx(yaw_deg, abs=0.1)


def shaking(time_s):
    moving = ((time_s > 3.0) & (time_s < 13.0))[:, None]
    return moving * np.column_stack([np.sin(time_s), np.cos(2 * time_s), 0.3 * np.sin(3 * time_s)])


@pytest.mark.parametrize("method", FUSING)
def test_another_world_heading_turns_the_result_and_nothing_else(method):
    time_s, truth = turning([0.4, 0.3, 0.8], 1.5, 10.0)
    acceleration = shaking(time_s)
    turn = qt.turn_about_up(1.1)
    first = estimate(samples_of(time_s, truth, acceleration), method).quat_ws
    turned = samples_of(time_s, qt.multiply(turn, truth), qt.rotate(turn, acceleration))
    assert np.degrees(qt.angle_between(estimate(turned, method).quat_ws, first)).max() < 1e-3


@pytest.mark.parametrize("method", FUSING)
def test_another_mounting_of_the_sensor_changes_only_the_mounting(method):
    time_s, truth = turning([0.4, 0.3, 0.8], 1.5, 10.0)
    acceleration = shaking(time_s)
    mounting = qt.from_euler_zyx(0.7, -0.4, 1.9)
    first = estimate(samples_of(time_s, truth, acceleration), method, NINE_AXES).quat_ws
    other = samples_of(time_s, qt.multiply(truth, mounting), acceleration)
    again = qt.multiply(estimate(other, method, NINE_AXES).quat_ws, qt.conjugate(mounting))
    # VQF's rest detection looks at the sensor's axes one by one, so it is not exactly the same
    assert np.degrees(qt.angle_between(again, first)).max() < (1.0 if "vqf" in method else 0.02)


@pytest.mark.parametrize(
    ("method", "limit_deg"),
    [("offline_vqf", 0.5), ("eskf", 0.5), ("mahony", 2.0), ("ekf7", 2.0), ("ukf", 2.0), ("madgwick", 2.0)],
)
def test_a_rolling_ball_with_an_off_centre_sensor_keeps_its_tilt(method, limit_deg):
    imu, truth, _ = rolling(120.0)
    attitude = estimate(imu, method, motion=Motion.ROLLING)
    _, inclination = attitude_error_deg(attitude.quat_ws, truth)
    assert np.sqrt(np.mean(inclination**2)) < limit_deg


@pytest.mark.parametrize("method", [*FUSING, "gyro", "accmag"])
def test_a_run_of_many_blocks_is_that_of_one(method, monkeypatch):
    time_s, truth = turning([0.4, 0.3, 0.8], 1.5, 10.0)
    imu = samples_of(time_s, truth, noise=1.0)
    whole = estimate(imu, method, NINE_AXES).quat_ws
    for module in ("samples", "vqf_filters"):
        monkeypatch.setattr(f"processing.orientation.{module}.BLOCK_ROWS", 401)
    np.testing.assert_allclose(estimate(imu, method, NINE_AXES).quat_ws, whole, atol=1e-9)


def test_offline_vqf_in_chunks_is_that_of_the_whole_within_a_tenth_of_a_degree(monkeypatch):
    imu, _, _ = rolling(600.0, rate_hz=50.0, spin_radps=6.0)
    whole = estimate(imu, "offline_vqf").quat_ws
    monkeypatch.setattr("processing.orientation.vqf_filters.CHUNK_ROWS", 12_000)
    chunks = estimate(imu, "offline_vqf").quat_ws
    assert not np.array_equal(chunks, whole)
    heading, inclination = attitude_error_deg(chunks, whole)
    assert np.abs(heading).max() < 0.1
    assert inclination.max() < 0.1
