"""Each effect alone against its formula: flicker, Earth's rotation, scale, g-sensitivity, slip, slides, iron."""

from dataclasses import replace

import numpy as np
import pytest

from processing.orientation import quaternions as qt
from processing.simulation.drive import DrivePlan
from processing.simulation.flicker import flicker, flicker_variance
from processing.simulation.rolling import rolling_of
from processing.simulation.route import SmoothRoute
from processing.simulation.run import simulate
from processing.simulation.scenario import (
    Ball,
    Drive,
    Imu,
    Joints,
    Knocks,
    Magnetics,
    PipeRoute,
    Scenario,
    Slide,
    Sound,
    Stop,
)
from processing.simulation.surveys import small_rolling

SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))
STEADY = Drive(speed_mps=0.5, variation=0.0, ramp_s=1.0, rest_start_s=2.0, rest_end_s=2.0)
CROOKED = Scenario(
    "crooked",
    route=PipeRoute(((0.0, 0, 0), (20.0, 0, 0), (20.0, 20.0, 0.5))),
    drive=STEADY,
    ball=Ball(spin_sigma_radps=3.0, spin_tau_s=1.0),
    imu=Imu.perfect(100.0),
    sound=SILENT,
)


def with_imu(scenario, **changes):
    return replace(scenario, imu=replace(scenario.imu, **changes))


def measured_allan_variance(series, rate_hz, tau_s):
    """Overlapping, from the definition: half the mean square of the change between neighbouring means."""
    m = round(tau_s * rate_hz)
    sums = np.vstack([np.zeros((1, series.shape[1])), np.cumsum(series, axis=0)])
    change = (sums[2 * m :] - 2 * sums[m:-m] + sums[: -2 * m]) / m
    return 0.5 * np.mean(change**2, axis=0)


def test_the_allan_deviation_of_flicker_is_level_at_the_stated_floor():
    rng = np.random.default_rng(1)
    runs = np.hstack([flicker(20_000, 10.0, 5e-5, rng) for _ in range(16)])
    for tau in (10.0, 30.0, 100.0):
        measured = np.sqrt(np.mean(measured_allan_variance(runs, 10.0, tau)))
        assert measured == pytest.approx(5e-5, rel=0.05)
        assert measured == pytest.approx(np.sqrt(flicker_variance(np.array([tau]), 5e-5)[0]), rel=0.05)


def test_white_noise_and_flicker_in_a_run_have_the_allan_deviation_of_their_data_sheet():
    """0.01 °/s/√Hz and 10 °/h: σ² = N²/τ + B²."""
    still = Scenario("rest", route=PipeRoute(((0.0, 0, 0), (1.0, 0, 0))), drive=replace(STEADY, rest_start_s=600.0),
                     imu=Imu.perfect(20.0), sound=SILENT)  # fmt: skip
    density, floor = np.radians(0.01), np.radians(10 / 3600)
    runs = [
        simulate(with_imu(still, gyro_noise=density, gyro_instability_radps=floor), k, quick=True) for k in range(5)
    ]
    gyr = np.hstack([run.imu.gyr_s_radps[: 600 * 20] for run in runs])
    for tau in (1.0, 5.0, 20.0):
        expected = density**2 / tau + flicker_variance(np.array([tau]), floor)[0]
        assert np.sqrt(np.mean(measured_allan_variance(gyr, 20.0, tau))) == pytest.approx(np.sqrt(expected), rel=0.07)


def test_a_resting_gyro_feels_the_earth_turn_once_in_a_sidereal_day():
    scenario = with_imu(CROOKED, latitude_deg=40.8)
    run, without = simulate(scenario, 1), simulate(CROOKED, 1)
    felt_w = qt.rotate(run.motion.quat_ws, run.imu.gyr_s_radps - without.imu.gyr_s_radps)
    day = 2 * np.pi / 86164.1
    expected = day * np.array([0.0, np.cos(np.radians(40.8)), np.sin(np.radians(40.8))])
    np.testing.assert_allclose(felt_w, np.tile(expected, (len(felt_w), 1)), rtol=1e-5, atol=1e-11)


def test_scale_and_misalignment_lie_within_their_stated_sizes_with_either_sign():
    scenario = with_imu(CROOKED, gyro_scale_range=(1e-3, 4e-3), gyro_misalignment_range_rad=(0.0017, 0.007))
    found = []
    for seed in range(12):
        run = simulate(scenario, seed)
        matrix, _, rank, _ = np.linalg.lstsq(run.motion.gyr_s_radps, run.imu.gyr_s_radps, rcond=None)
        assert rank == 3
        found.append(matrix.T - np.eye(3))
    found = np.array(found)
    diagonal = np.diagonal(found, axis1=1, axis2=2)
    across = found[:, ~np.eye(3, dtype=bool)]
    assert np.all((np.abs(diagonal) > 0.99e-3) & (np.abs(diagonal) < 4.01e-3))
    assert np.all((np.abs(across) > 0.00169) & (np.abs(across) < 0.00701))
    assert -0.5 < np.mean(np.sign(across)) < 0.5


def test_acceleration_leaks_into_the_gyro_by_one_matrix():
    sizes = []
    for seed in range(15):
        run = simulate(with_imu(CROOKED, gyro_g_sensitivity=2e-4), seed, quick=True)
        felt = run.imu.gyr_s_radps - run.motion.gyr_s_radps
        matrix, _, _, _ = np.linalg.lstsq(run.imu.acc_s_mps2, felt, rcond=None)
        np.testing.assert_allclose(run.imu.acc_s_mps2 @ matrix, felt, atol=1e-12)
        sizes.append(matrix)
    assert np.std(sizes) == pytest.approx(2e-4, rel=0.2)


def test_gauss_markov_slip_spoils_the_distance_as_its_double_integral_says():
    """σ_s² = 2 (σ v τ)² (T/τ − 1 + e^(−T/τ)) after T seconds at speed v."""
    route = SmoothRoute(np.array([[0.0, 0, 0], [80.0, 0, 0]]), 1.0)
    ball = Ball(slip_sigma=0.006, slip_tau_s=15.0)
    t = np.arange(5.0, 155.0, 0.1)
    errors = []
    for seed in range(400):
        rng = np.random.default_rng(seed)
        plan = DrivePlan(STEADY, route.length_m, rng)
        _, rolled_mps = rolling_of(ball, route, plan, rng).turning(t)
        errors.append(0.1 * np.sum(rolled_mps - plan.at(t).speed_mps))
    expected = np.sqrt(2) * 0.006 * 0.5 * 15.0 * np.sqrt(150 / 15 - 1 + np.exp(-150 / 15))
    assert np.std(errors) == pytest.approx(expected, rel=0.1)


def test_in_a_slide_the_ball_moves_without_turning_and_when_stuck_it_turns_without_moving():
    scenario = replace(
        CROOKED,
        route=PipeRoute(((0.0, 0, 0), (30.0, 0, 0))),
        ball=Ball(slides=(Slide(10.0, 14.0),)),
        drive=replace(STEADY, stops=(Stop(20.0, 6.0, spin_radps=8.0),)),
    )
    motion = simulate(scenario, 1).motion
    rate = np.linalg.norm(motion.gyr_s_radps, axis=1)
    sliding = (motion.chainage_m > 10.4) & (motion.chainage_m < 13.6)
    assert motion.speed_mps[sliding].min() > 0.49
    assert rate[sliding].max() < 1e-9
    stuck = motion.speed_mps == 0
    assert rate[stuck & (motion.chainage_m > 19.0)].max() == pytest.approx(8.0)
    # what it turned is its way without the slide, and what it turned on the spot
    unslid = 30.0 - (4.0 - 0.3)
    assert motion.rotation_rad[-1] == pytest.approx(unslid / 0.0475 + 8.0 * (6.0 - 1.0), rel=1e-6)


def test_the_iron_of_joints_shows_in_the_field_where_they_are_and_nowhere_else():
    joints = Joints(spacing_m=5.0, magnetic_ut=20.0)
    imu = replace(Imu.perfect(100.0), magnetics=Magnetics(enabled=True, noise_ut=0.0))
    scenario = replace(CROOKED, imu=imu, sound=replace(SILENT, joints=joints))
    run = simulate(scenario, 1)
    plain = simulate(replace(scenario, sound=replace(SILENT, joints=replace(joints, magnetic_ut=0.0))), 1)
    extra = np.linalg.norm(run.imu.mag_s_ut - plain.imu.mag_s_ut, axis=1)
    places = np.array([b.chainage_m for b in run.blows if b.kind == "joint"])
    away = np.min(np.abs(run.motion.chainage_m[:, None] - places), axis=1)
    assert np.all(extra[away > 6 * 0.25] == 0.0)
    at = [extra[np.argmin(np.abs(run.motion.chainage_m - place))] for place in places]
    assert np.median(at) == pytest.approx(20.0, rel=0.4)


def test_a_quick_run_is_the_same_run_without_sound():
    scenario = small_rolling()
    full, quick = simulate(scenario, 3), simulate(scenario, 3, quick=True)
    assert quick.sound is None
    assert full.sound is not None
    assert np.max(qt.angle_between(full.motion.quat_ws, quick.motion.quat_ws)) < 1e-6
    np.testing.assert_allclose(quick.imu.gyr_s_radps, full.imu.gyr_s_radps, atol=2.1e-5)  # two quantisation steps
    np.testing.assert_array_equal(quick.motion.position_w_m, full.motion.position_w_m)
    assert quick.survey == full.survey
