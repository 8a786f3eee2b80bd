"""When the magnetometer may tell the heading."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import samples_of, turning

from processing.orientation.calibration import calibrate
from processing.orientation.magnetometer import is_ferrous, judge_magnetometer
from processing.settings import OrientationSettings

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


def test_a_hard_iron_offset_is_not_trusted(imu):
    assert verdict(replace(imu, mag_s_ut=imu.mag_s_ut + np.array([25.0, 0.0, 0.0]))).reason == "field_unsteady"


def test_a_field_of_steady_strength_that_swings_against_gravity_is_not_trusted(imu):
    swing = np.sin(imu.time_s)[:, None] * np.array([0.0, 0.6, 0.0])
    from processing.orientation import quaternions as qt

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
