"""When the magnetometer may tell the heading."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.calibration import calibrate
from processing.orientation.magnetometer import is_ferrous, judge_magnetometer, magnetometer_findings, measure_field
from processing.orientation.registry import estimate_attitude
from processing.progress import silent
from processing.settings import OrientationSettings
from processing.survey import DeviceInfo, Motion, Survey

SETTINGS = OrientationSettings()


def verdict(imu, material="PVC", settings=SETTINGS):
    return judge_magnetometer(imu, calibrate(imu, settings), material, settings)


@pytest.fixture
def imu():
    time_s, quat_ws = turning([0.3, 0.2, 1.0], 1.0, 30.0)
    return samples_of(time_s, quat_ws, noise=1.0)


def test_a_steady_field_of_earths_strength_is_trusted_and_measured(imu):
    found = verdict(imu)
    assert (found.trusted, found.reason) == (True, "field_steady")
    assert found.field.norm_ut == pytest.approx(np.hypot(25, 40), abs=0.3)
    assert np.degrees(found.field.dip_rad) == pytest.approx(np.degrees(np.arctan2(40, 25)), abs=1.0)


@pytest.mark.parametrize(
    "material",
    ["ductile iron", "Cast Iron", "steel", "DI", "duktil font", "çelik", "ÇELİK", "Dökme demir", "PİK döküm"],
)
def test_iron_and_steel_are_never_trusted(imu, material):
    assert verdict(imu, material).reason == "pipe_ferrous"


@pytest.mark.parametrize("material", ["PVC", "PE100", "asbestos cement", "concrete", "HDPE", "", "beton", "CTP"])
def test_other_pipes_are_not_taken_for_iron(material):
    assert not is_ferrous(material)


def test_a_field_that_another_source_disturbs_half_the_time_is_not_trusted(imu):
    mag = imu.mag_s_ut.copy()
    mag[: len(mag) // 2] += 15.0 * np.sin(np.arange(len(mag) // 2) / 50.0)[:, None]
    assert verdict(replace(imu, mag_s_ut=mag)).reason == "field_unsteady"


def test_iron_of_the_device_that_a_turn_about_one_axis_half_shows_is_not_trusted(imu):
    found = verdict(replace(imu, mag_s_ut=imu.mag_s_ut + np.array([25.0, 0.0, 0.0])))
    assert (found.trusted, found.reason) == (False, "field_ring")


@pytest.fixture
def tumbling():
    """A device that is turned to all sides, slowly, for two minutes."""
    time_s = np.arange(0.0, 120.0, 0.01)
    rate = np.column_stack([np.sin(0.11 * time_s), np.cos(0.17 * time_s), 0.7 * np.sin(0.23 * time_s + 1.0)])
    quat_ws = np.empty((len(time_s), 4))
    from processing.orientation import kernels

    kernels.integrate(np.ascontiguousarray(0.01 * rate), np.array(qt.IDENTITY), quat_ws)
    return samples_of(time_s, quat_ws, noise=1.0)


def test_iron_of_the_device_is_taken_off_where_it_was_turned_to_all_sides(tumbling):
    iron = np.array([25.0, -10.0, 8.0])
    spoilt = replace(tumbling, mag_s_ut=tumbling.mag_s_ut + iron)
    found = verdict(spoilt)
    assert (found.trusted, found.reason) == (True, "field_steady")
    np.testing.assert_allclose(found.field.ellipsoid.centre_ut, iron, atol=0.5)
    assert found.field.norm_ut == pytest.approx(np.hypot(25, 40), abs=0.5)
    assert np.degrees(found.field.dip_rad) == pytest.approx(np.degrees(np.arctan2(40, 25)), abs=1.0)
    (told,) = magnetometer_findings(found)
    assert told.code == "magnetometer_iron_sphere"
    assert told.params["shift_ut"] == pytest.approx(np.linalg.norm(iron), abs=0.5)


def test_the_heading_comes_out_right_in_spite_of_the_devices_iron(tumbling):
    spoilt = replace(tumbling, mag_s_ut=tumbling.mag_s_ut + np.array([25.0, -10.0, 8.0]))
    attitude, _, _ = estimate_attitude(spoilt, Survey(device=DeviceInfo(Motion.CARRIED)), SETTINGS, silent())
    assert attitude.heading_from == "magnetometer"
    north = qt.rotate(attitude.quat_ws, tumbling.mag_s_ut)  # the field itself, which points north and down
    heading = np.degrees(np.arctan2(north[:, 0], north[:, 1]))
    assert np.sqrt(np.mean(heading**2)) < 1.0


def test_in_a_ferrous_pipe_no_iron_of_the_device_is_looked_for(tumbling):
    spoilt = replace(tumbling, mag_s_ut=tumbling.mag_s_ut + np.array([25.0, -10.0, 8.0]))
    measured = measure_field(spoilt, calibrate(spoilt, SETTINGS), SETTINGS, iron_of_its_own=False)
    assert measured[0].ellipsoid is None
    assert verdict(spoilt, "steel").field is None
    (told,) = magnetometer_findings(verdict(spoilt, "steel"))
    assert told.code == "magnetometer_pipe_ferrous"


def test_a_field_that_turns_with_the_place_though_its_strength_and_dip_stay_is_not_trusted():
    # as along a steel pipe: the field swings about up, joint by joint
    time_s = np.arange(0.0, 120.0, 0.01)
    imu = samples_of(time_s, np.tile(qt.IDENTITY, (len(time_s), 1)), noise=1.0)
    swing = np.radians(60.0) * np.sin(2.0 * np.pi * time_s / 12.0)
    mag = qt.rotate(qt.turn_about_up(swing), imu.mag_s_ut)
    found = verdict(replace(imu, mag_s_ut=mag))
    assert found.reason == "field_unsteady"
    assert found.clean_share < 0.5
    (told,) = magnetometer_findings(found)
    assert told.params["accepted_pct"] == pytest.approx(100.0 * found.clean_share)


def test_a_field_of_steady_strength_that_swings_against_gravity_is_not_trusted(imu):
    swing = np.sin(imu.time_s)[:, None] * np.array([0.0, 0.6, 0.0])
    mag = qt.rotate(qt.exp_map(swing), imu.mag_s_ut)
    assert verdict(replace(imu, mag_s_ut=mag)).reason == "field_unsteady"


def test_a_field_ten_times_earths_is_not_trusted(imu):
    assert verdict(replace(imu, mag_s_ut=10.0 * imu.mag_s_ut)).reason == "field_not_earths"


def test_dead_and_absent_sensors_are_told_apart(imu):
    assert verdict(replace(imu, mag_s_ut=None)).reason == "no_magnetometer"
    assert verdict(replace(imu, mag_s_ut=np.zeros_like(imu.mag_s_ut))).reason == "magnetometer_dead"
    assert verdict(replace(imu, mag_s_ut=np.full_like(imu.mag_s_ut, 30.0))).reason == "magnetometer_dead"


def test_the_operators_word_overrules(imu):
    assert verdict(imu, "steel", replace(SETTINGS, magnetometer="use")).trusted
    assert not verdict(imu, "PVC", replace(SETTINGS, magnetometer="ignore")).trusted
