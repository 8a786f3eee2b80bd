"""The magnetic series of the quality plots, against fields that were made."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.calibration import calibrate
from processing.orientation.magnetic_series import magnetic_series
from processing.settings import OrientationSettings
from processing.survey import Attitude

SETTINGS = OrientationSettings()


@pytest.fixture
def run():
    time_s, quat_ws = turning([0.3, 0.2, 1.0], 1.0, 60.0)
    return samples_of(time_s, quat_ws, noise=1.0), quat_ws


def series(imu, quat_ws, heading_from="magnetometer", material="PVC"):
    attitude = Attitude(quat_ws, np.zeros(3), "made", heading_from=heading_from)
    return magnetic_series(imu, attitude, calibrate(imu, SETTINGS), material, SETTINGS)


def test_a_steady_field_shows_its_strength_and_dip_and_is_accepted(run):
    found = series(*run)
    np.testing.assert_allclose(found.norm_ut, np.hypot(25.0, 40.0), atol=0.5)
    np.testing.assert_allclose(found.dip_deg, np.degrees(np.arctan2(40.0, 25.0)), atol=1.0)
    np.testing.assert_allclose(found.innovation_deg, 0.0, atol=1.0)
    assert found.accepted_share == 1.0
    assert found.used
    assert len(found.time_s) == pytest.approx(2 * 66, abs=1)


def test_a_magnet_beside_the_way_is_refused_where_it_is(run):
    imu, quat_ws = run
    beside = (imu.time_s > 20.0) & (imu.time_s < 30.0)
    magnet_s = qt.rotate_inverse(quat_ws, np.array([30.0, 0.0, 0.0]))
    found = series(replace(imu, mag_s_ut=imu.mag_s_ut + magnet_s * beside[:, None]), quat_ws)
    inside = (found.time_s > 20.5) & (found.time_s < 29.5)
    outside = (found.time_s < 19.5) | (found.time_s > 30.5)
    assert not np.any(found.accepted[inside])
    assert np.all(found.accepted[outside])
    np.testing.assert_allclose(found.innovation_deg[inside], np.degrees(np.arctan2(30.0, 25.0)), atol=2.0)


def test_an_attitude_of_any_heading_is_judged_by_its_changes_only(run):
    imu, quat_ws = run
    turned = qt.multiply(qt.turn_about_up(2.0), quat_ws)
    found = series(imu, turned, heading_from="launch", material="steel")
    assert found.accepted_share == 1.0
    assert not found.used
    assert np.abs(series(imu, turned).innovation_deg).min() > 100.0


def test_untrusted_rows_leave_holes(run):
    imu, quat_ws = run
    valid = (imu.time_s < 10.0) | (imu.time_s > 12.0)
    found = series(replace(imu, valid=valid), quat_ws)
    hole = (found.time_s > 10.5) & (found.time_s < 11.5)
    assert np.all(np.isnan(found.norm_ut[hole]))
    assert not np.any(found.accepted[hole])
    assert found.accepted_share == 1.0


def test_there_is_none_without_a_living_magnetometer(run):
    imu, quat_ws = run
    assert series(replace(imu, mag_s_ut=None), quat_ws) is None
    assert series(replace(imu, mag_s_ut=np.zeros_like(imu.mag_s_ut)), quat_ws) is None
