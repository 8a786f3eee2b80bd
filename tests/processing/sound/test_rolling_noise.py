"""The modulation of rolling noise by the turning ball, recovered from levels with a known modulation."""

from dataclasses import replace

import numpy as np
import pytest
from sound_runs import Leak, drift

from processing.settings import DetectorSettings
from processing.sound.candidates import find_candidates
from processing.sound.cells import band_log_power
from processing.sound.rolling_noise import listened_bands, rolling_noise, turned_angle
from processing.survey import DeviceInfo, ImuSamples, Motion, ProcessingChoice, Survey

RADIUS_M = 0.08  # of the ball in the helper's runs


def level_of(scan):
    return np.mean([band_log_power(scan, int(b)) for b in listened_bands(scan.bands_hz[:-1])], axis=0)


@pytest.mark.parametrize("scale", [1.0, 1.02, 0.96])
def test_the_modulation_is_learnt_although_the_gyro_s_scale_is_off(scale):
    run = drift(seed=1, rolling_db=5.0)
    counts = run.speed_mps > 0.12
    angle = scale * run.chainage_m / RADIUS_M
    rolling = rolling_noise(level_of(run.scan), angle, counts, run.scan.frame_s)
    assert rolling.heard_share > 0.9
    turn = run.chainage_m / RADIUS_M
    drawn = np.clip(1 + 0.6 * np.cos(turn) + 0.25 * np.cos(2 * turn), 0.05, None)
    band = int(np.argmin(abs(run.scan.bands_hz[:-1, 0] - 1000)))
    learnt = rolling.modulation(band_log_power(run.scan, band), counts)
    assert np.corrcoef(np.log(learnt), np.log(drawn))[0, 1] > 0.8
    assert learnt.mean() == pytest.approx(1, abs=0.1)
    above = int(np.argmin(abs(run.scan.bands_hz[:-1, 0] - 5000)))  # where nothing rolls
    assert np.std(np.log(rolling.modulation(band_log_power(run.scan, above), counts))) < 0.1


def test_where_nothing_turns_audibly_nothing_is_learnt():
    run = drift(seed=2, rolling_db=-40.0, bumps=False)
    counts = np.ones(len(run.time_s), bool)
    rolling = rolling_noise(level_of(run.scan), run.chainage_m / RADIUS_M, counts, run.scan.frame_s)
    assert rolling is None or rolling.heard_share < 0.1


def test_the_angle_is_the_integral_of_the_turn_rate_and_bad_rows_add_nothing():
    time = np.arange(0, 20, 0.01)
    gyro = np.column_stack([np.full(len(time), 3.0), np.full(len(time), 4.0), np.zeros(len(time))])
    valid = np.ones(len(time), bool)
    gyro[500:600], valid[500:600] = 1e6, False
    imu = ImuSamples(time, np.zeros_like(gyro), gyro, valid)
    assert np.diff(turned_angle(imu, np.array([1.0, 3.0])))[0] == pytest.approx(10.0)
    assert np.diff(turned_angle(imu, np.array([4.0, 7.0])))[0] == pytest.approx(10.0, abs=0.1)


def test_with_the_gyro_a_leak_is_still_found_and_the_rolling_is_told():
    run = drift((Leak(60), Leak(120, 1.0, 4)), seed=3, rolling_db=6.0)
    time = np.arange(0, 400, 0.02)
    rate = np.interp(time, run.time_s, run.speed_mps) / RADIUS_M
    imu = ImuSamples(time, np.zeros((len(time), 3)), np.column_stack([0 * rate, rate, 0 * rate]), rate >= 0)
    survey = Survey(processing=ProcessingChoice(detector="metres"))

    def found(survey, settings):
        return find_candidates(run.scan, run.clock, run.track, survey, settings, imu=imu)

    heard = found(survey, DetectorSettings())
    assert [f.code for f in heard.findings] == ["rolling_heard"]
    for place in (60, 120):
        assert any(abs(c.chainage_m - place) < 0.6 and c.score > 0.5 for c in heard.candidates)
    carried = replace(survey, device=DeviceInfo(motion=Motion.CARRIED))
    assert found(carried, DetectorSettings()).findings == ()
    assert found(survey, DetectorSettings(rolling_phase="off")).findings == ()
