"""The heading that leans on a disturbed field without following it."""

import broad
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from made_imu import attitude_error_deg, samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.registry import estimate_attitude
from processing.orientation.smoothed_heading import smoothed
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Motion, ProcessingChoice, Survey

SETTINGS = OrientationSettings(magnetometer="use")


def estimate(imu, method):
    survey = Survey(device=DeviceInfo(motion=Motion.CARRIED), processing=ProcessingChoice(orientation=method))
    return estimate_attitude(imu, survey, SETTINGS, silent())[0]


@given(st.floats(-1.5, 1.5), st.floats(-5e-4, 5e-4), st.integers(30, 400))
def test_a_steady_drift_is_kept_exactly(level, slope, n):
    drift = slope * (np.arange(n) - n / 2)
    found = smoothed(level + drift, np.ones(n), np.zeros(n - 1, dtype=bool))
    # the prior on the drift rate pulls a little on short runs
    np.testing.assert_allclose(found, level + drift, atol=0.5 * np.ptp(drift) + 1e-6)


def test_noise_is_averaged_over_minutes_and_outliers_are_bounded():
    rng = np.random.default_rng(0)
    n = 1200
    truth = 0.3 + np.radians(0.005) * np.arange(n)
    seen = truth + np.radians(8.0) * rng.standard_normal(n)
    seen[500:560] += np.radians(60.0)  # a minute beside a car
    off = np.degrees(smoothed(seen, np.ones(n), np.zeros(n - 1, dtype=bool)) - truth)
    assert np.sqrt(np.mean(off**2)) < 2.5
    assert np.abs(off).max() < 8.0  # of sixty


def test_readings_without_weight_do_not_count():
    n = 300
    seen, weight = np.zeros(n), np.ones(n)
    seen[100:200], weight[100:200] = 2.0, 0.0
    assert np.abs(smoothed(seen, weight, np.zeros(n - 1, dtype=bool))).max() < 1e-6


def test_the_offset_may_jump_where_the_turn_was_lost():
    n = 400
    seen, breaks = np.where(np.arange(n) < 200, 0.0, 1.0), np.zeros(n - 1, dtype=bool)
    breaks[199] = True
    off = smoothed(seen, np.ones(n), breaks) - seen
    assert np.degrees(np.abs(off).max()) < 2.0


@pytest.mark.parametrize("n", [1, 2, 3])
def test_runs_of_a_few_seconds_have_a_heading(n):
    found = smoothed(np.full(n, 0.4), np.ones(n), np.zeros(n - 1, dtype=bool))
    np.testing.assert_allclose(found, 0.4, atol=1e-6)


def test_a_field_that_wanders_bends_the_path_less_than_one_that_is_followed():
    time_s, truth = turning([0.1, 0.2, 1.0], 0.3, 300.0)
    imu = samples_of(time_s, truth, noise=1.0)
    wander = np.radians(12.0) * np.sin(2 * np.pi * time_s / 40.0)
    field_w = qt.rotate(qt.turn_about_up(wander), np.array([0.0, 25.0, -40.0]))
    imu = type(imu)(imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, imu.valid, qt.rotate_inverse(truth, field_w))
    rms = {}
    for method in ("smoothed_vqf", "offline_vqf"):
        heading, _ = attitude_error_deg(estimate(imu, method).quat_ws, truth)
        rms[method] = np.sqrt(np.mean(heading**2))
    assert rms["smoothed_vqf"] < 2.0
    assert rms["smoothed_vqf"] < 0.4 * rms["offline_vqf"]


@pytest.mark.data
def test_on_broad_it_is_better_than_offline_vqf_with_nine_axes(shared_data):
    totals = {"smoothed_vqf": [], "offline_vqf": []}
    for number in (2, 16, 21, 36):
        trial = broad.read_trial(shared_data / "broad", number)
        for method, found in totals.items():
            found.append(broad.rmse_deg(estimate(trial.imu, method).quat_ws, trial.truth_ws, trial.movement)[0])
    assert np.mean(totals["smoothed_vqf"]) < 0.95 * np.mean(totals["offline_vqf"])
