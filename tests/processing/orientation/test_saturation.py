"""What becomes of attitude and path where the gyro was at its limit: nothing is invented, and the doubt grows."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import attitude_error_deg, rolling, samples_of, turning

from processing.importing.doctor import examine
from processing.importing.raw import RawImu
from processing.orientation import quaternions as qt
from processing.orientation.calibration import calibrate
from processing.orientation.registry import estimate_attitude
from processing.orientation.samples import trusted_samples
from processing.position.registry import reckon
from processing.progress import silent
from processing.settings import ImportSettings, OrientationSettings, PositionSettings
from processing.survey import DeviceInfo, ProcessingChoice, Survey

SETTINGS = OrientationSettings()
SURVEY = Survey(device=DeviceInfo(radius_m=0.05), processing=ProcessingChoice(orientation="offline_vqf"))


@pytest.fixture(scope="module")
def clipped():
    """A ball that rolls faster than its gyro reads for some seconds of each half minute; as imported; and its truth."""
    imu, truth, axis_s = rolling(120.0)
    limit = 0.8 * np.abs(imu.gyr_s_radps).max()
    gyr = np.clip(imu.gyr_s_radps, -limit, limit)
    raw = RawImu(imu.time_s.copy(), imu.acc_s_mps2.copy(), gyr, time_unit="s", acc_unit="mps2", gyr_unit="radps")
    raw.keep_origin = True
    return examine(raw, ImportSettings()), truth, axis_s


def test_rows_at_the_limit_are_not_trusted_and_the_stretches_are_not_assessed(clipped):
    examined, _, _ = clipped
    imu = examined.imu
    limit = np.abs(imu.gyr_s_radps).max()
    at_limit = np.any(np.abs(imu.gyr_s_radps) == limit, axis=1)
    assert at_limit.mean() > 0.1
    assert not np.any(imu.valid[at_limit])
    masked = sum(s.end_s - s.start_s for s in examined.not_assessed if s.reason == "imu_gyr_saturated")
    assert masked == pytest.approx(at_limit.sum() * np.median(np.diff(imu.time_s)), rel=0.1)


def test_after_a_saturated_stretch_the_tilt_is_right_again_and_the_way_continues(clipped):
    examined, truth, axis_s = clipped
    imu = examined.imu
    attitude, _, _ = estimate_attitude(imu, SURVEY, SETTINGS, silent())
    _, inclination = attitude_error_deg(attitude.quat_ws, truth)
    assert np.percentile(inclination[imu.valid & (imu.time_s > 12.0)], 95.0) < 3.0
    # the direction in which the ball rolls, which no turn about its own axis changes
    axis_w = qt.rotate(attitude.quat_ws[imu.valid & (imu.time_s > 12.0)], axis_s)
    heading = np.degrees(np.unwrap(np.arctan2(axis_w[:, 1], axis_w[:, 0])))
    assert np.ptp(heading) < 5.0


def test_the_variance_of_heading_and_way_grows_across_it(clipped):
    imu = clipped[0].imu
    attitude, _, _ = estimate_attitude(imu, SURVEY, SETTINGS, silent())
    path = reckon(imu, attitude, SURVEY, PositionSettings(), silent())
    edges = np.flatnonzero(np.diff(imu.valid.astype(np.int8)))
    edges = edges[imu.time_s[edges] > 12.0]
    lengths = np.diff(imu.time_s[edges])
    lost = imu.valid[edges[:-1]] & ~imu.valid[edges[:-1] + 1]
    start = float(imu.time_s[edges[:-1]][lost][np.argmax(lengths[lost])])
    end = start + float(lengths[lost].max())
    good = float(imu.time_s[edges[:-1]][~lost][np.argmax(lengths[~lost])]) + 0.2
    calm = float(lengths[~lost].max()) - 0.4

    def rate(values, a, duration):
        return np.diff(np.interp([a, a + duration], path.time_s, values))[0] / duration

    heading = path.heading_var_rad2 + path.lost_heading_rad2
    assert end - start > 1.0 < calm
    assert rate(heading, start, end - start) > 10.0 * rate(heading, good, calm)
    way = path.along_var_m2 + path.lost_var_m2
    assert rate(way, start, end - start) > 10.0 * rate(way, good, calm)
    assert any(s.start_s <= start + 0.2 and s.end_s >= end - 0.2 for s in path.not_assessed)


def test_over_a_short_hole_the_turn_is_that_of_the_rates_on_both_sides():
    time_s, quat_ws = turning([0.2, 0.1, 1.0], 4.0, 20.0)
    # the rate swings, so that one side alone would be wrong
    angle = 3.0 * np.sin(1.5 * np.maximum(time_s - 3.0, 0.0))
    axis = np.array([0.2, 0.1, 1.0]) / np.linalg.norm([0.2, 0.1, 1.0])
    quat_ws = qt.exp_map(angle[:, None] * axis)
    imu = samples_of(time_s, quat_ws)
    valid = np.ones(len(time_s), dtype=bool)
    for start in range(400, 2200, 37):
        valid[start : start + 3] = False  # 40 ms from row to row
    holed = replace(imu, valid=valid)
    samples = trusted_samples(holed, calibrate(holed, SETTINGS), SETTINGS, None)
    assert len(samples.segments) == 1
    block = samples.block(0, samples.count, first=True)
    found = np.cumsum(block.turn @ axis)
    error = found - (angle[valid] - angle[0])
    # each hole misses by the curvature of the rate; one side alone would miss by its slope, a hundred times more
    assert np.abs(error).max() < np.radians(0.05)
