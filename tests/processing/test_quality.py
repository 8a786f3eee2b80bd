"""What the quality plots show is what the results say, in the units that they name."""

from dataclasses import replace

import numpy as np
import pytest
from small_survey import make_folder, make_results, make_track

from processing.orientation.calibration import Calibration, calibrate
from processing.orientation.quaternions import from_euler_zyx
from processing.position.fit_results import FitSeries, Innovation
from processing.quality import GROUPS, quality_strips
from processing.settings import OrientationSettings
from processing.survey import Attitude, ImuSamples


@pytest.fixture
def results(tmp_path):
    with make_folder(tmp_path) as folder:
        yield make_results(folder)


SERIES = FitSeries(
    time_s=np.array([0.0, 25.0, 50.0]),
    chainage_m=np.array([0.0, 50.0, 100.0]),
    slip_share=np.array([0.0, 0.01, 0.02]),
    slip_sigma=np.full(3, 0.005),
    heading_correction_rad=np.radians([0.0, 1.0, 2.0]),
    heading_sigma_rad=np.radians([0.5, 0.5, 0.5]),
    heading_drift_radps=np.radians([10.0, 10.0, 10.0]) / 3600.0,
    heading_drift_sigma_radps=np.radians([5.0, 5.0, 5.0]) / 3600.0,
    scale=1.0,
    scale_sigma=0.01,
    slip_level=1.0,
    heading_level=1.0,
    innovations=(
        Innovation(30.0, "tie", "valve", -4.0, held_down=True),
        Innovation(10.0, "tie", "hydrant", 1.0, held_down=False),
        Innovation(20.0, "fix", "bend", 0.5, held_down=False),
    ),
)


def test_attitude_is_a_compass_heading_and_degrees(results):
    count = len(make_track().time_s)
    quat = from_euler_zyx(*(np.full(count, np.radians(angle)) for angle in (10.0, -20.0, 30.0)))
    heading, roll, pitch = quality_strips(replace(results, track=replace(make_track(), quat_ws=quat)), "attitude")
    assert heading.curves[0].values == pytest.approx(60.0)  # 30° counter-clockwise from east
    assert roll.curves[0].values == pytest.approx(10.0)
    assert pitch.curves[0].values == pytest.approx(-20.0)


def test_the_interval_is_half_of_95_per_cent(results):
    along, cross, up = quality_strips(results, "interval")
    assert [strip.curves[0].values[7] for strip in (along, cross, up)] == pytest.approx([0.784, 0.392, 0.196], rel=1e-3)
    assert along.from_zero


def test_slip_and_heading_come_with_their_bands(results):
    results = replace(results, series=SERIES)
    _, slip = quality_strips(results, "speed")
    assert slip.interval
    assert [curve.values[1] for curve in slip.curves] == pytest.approx([1.0, 1.0 - 0.98, 1.0 + 0.98], abs=1e-3)
    turned, drift = quality_strips(results, "heading")
    assert turned.curves[0].values == pytest.approx([0.0, 1.0, 2.0])
    assert drift.curves[0].values == pytest.approx(10.0)


def test_each_surprise_is_a_spike_at_its_moment(results):
    fix, tie = quality_strips(replace(results, series=SERIES), "innovations")
    assert (fix.key, tie.key) == ("innovation_fix", "innovation_tie")
    curve = tie.curves[0]
    assert np.all(np.diff(curve.time_s) > 0.0)
    assert curve.time_s[np.argmin(curve.values)] == 30.0
    assert (curve.values.min(), curve.values.max()) == (-4.0, 1.0)
    assert np.interp(29.9, curve.time_s, curve.values) == pytest.approx(0.0)


def test_the_gyro_offset_is_that_of_the_calibration_between_its_rests(results):
    calibration = Calibration(
        np.array([0.0, 50.0]), np.radians([[0.1, 0.0, 0.0], [0.3, 0.0, 0.0]]), np.radians(np.full((2, 3), 0.01)), "rest"
    )
    x, *_ = quality_strips(replace(results, calibration=calibration), "offset")
    value, low, high = (curve.values for curve in x.curves)
    assert np.interp(25.0, x.curves[0].time_s, value) == pytest.approx(0.2, abs=1e-3)
    assert np.all((low < value) & (value < high))


def test_a_run_without_a_path_or_a_fit_shows_nothing_instead_of_failing(results):
    bare = replace(results, track=None, calibration=None, series=None)
    assert [quality_strips(bare, group) for group in GROUPS] == [()] * len(GROUPS)


def test_the_magnetic_field_is_shown_between_the_limits_of_what_is_believed(results):
    count = 3000
    time_s = np.arange(count) * 0.02
    dip = np.radians(60.0)
    field_w = 50.0 * np.array([0.0, np.cos(dip), -np.sin(dip)])  # north and down
    mag = np.tile(field_w, (count, 1))
    mag[1500:1700] *= 1.5  # iron near by
    noise = np.random.default_rng(3).normal(0.0, 0.01, (count, 3))
    acc = np.tile([0.0, 0.0, 9.81], (count, 1)) + noise
    imu = ImuSamples(time_s, acc, 0.1 * noise, np.ones(count, dtype=bool), mag_s_ut=mag + noise)
    attitude = Attitude(np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)), np.zeros(3), "test")
    calibration = calibrate(imu, OrientationSettings())
    recording = replace(results.recording, imu=imu)
    changed = replace(results, recording=recording, attitude=attitude, calibration=calibration)
    norm, inclination, _ = quality_strips(changed, "field")
    value, low, high = norm.curves
    assert np.interp(10.0, value.time_s, value.values) == pytest.approx(50.0, abs=0.5)
    assert np.interp(32.0, value.time_s, value.values) > high.values[0] > 50.0 > low.values[0]
    assert np.interp(10.0, value.time_s, inclination.curves[0].values) == pytest.approx(60.0, abs=1.0)
