"""The channels of a run on even grids, and the table of names that a form offers without loading the filters."""

from dataclasses import fields, replace

import numpy as np
import pytest
from sound_runs import drift

from processing.conditioning import registry
from processing.conditioning.channels import CHANNELS, channel_series
from processing.conditioning.names import CONDITIONER_FIELDS
from processing.conditioning.settings import ConditioningSettings
from processing.survey import ClockMap, ImuSamples


def imu(pressure, rate=200.0):
    count = len(pressure)
    three = np.zeros((count, 3))
    return ImuSamples(np.arange(count) / rate, three, three, np.ones(count, bool), pressure_kpa=pressure)


def test_the_pressure_is_the_mean_of_fiftieths_of_a_second_without_what_is_not_valid():
    time_s = np.arange(4000) / 200.0
    samples = imu(400.0 + time_s)
    valid = np.ones(4000, bool)
    valid[100:110] = False
    valid[1000:1400] = False
    wild = samples.pressure_kpa.copy()
    wild[~valid] = 1e9
    series = channel_series("pressure", replace(samples, pressure_kpa=wild, valid=valid), None, None, ClockMap())
    assert series.sample_rate_hz == pytest.approx(50.0)
    assert not series.valid[252:348].any()
    np.testing.assert_allclose(series.values[series.valid], 400.0 + series.time_s[series.valid], atol=0.006)
    assert np.count_nonzero(series.valid) == 898


def test_without_the_paths_height_the_pressure_of_a_hill_is_level():
    track = drift(seed=1, seconds=60.0).track
    up = 5.0 + 3.0 * np.sin(track.time_s / 9.0)
    track = replace(track, position_w_m=np.column_stack([track.chainage_m, 0 * up, up]))
    samples = imu(420.0 - 9.81 * np.interp(np.arange(12_000) / 200.0, track.time_s, up))
    series = channel_series("pressure_level", samples, track, None, ClockMap())
    np.testing.assert_allclose(series.values[series.valid], 420.0 - 9.81 * 5.0, atol=0.05)
    assert channel_series("pressure_level", samples, None, None, ClockMap()) is None


def test_level_and_speed_come_on_survey_time():
    run = drift(seed=1, seconds=60.0)
    clock = ClockMap(start_s=5.0)
    level = channel_series("level", None, run.track, run.scan, clock)
    assert level.time_s[0] == pytest.approx(5.0 + 0.5 * run.scan.frame_s)
    np.testing.assert_allclose(level.values, run.scan.level_db[:, -1])
    speed = channel_series("speed", None, run.track, run.scan, clock)
    assert speed.sample_rate_hz == pytest.approx(20.0)
    np.testing.assert_allclose(speed.values, run.track.speed_mps)


@pytest.mark.parametrize("name", CHANNELS)
def test_a_run_without_the_channel_has_none(name):
    assert channel_series(name, replace(imu(np.ones(10)), pressure_kpa=None), None, None, ClockMap()) is None


def test_a_coarser_channel_keeps_its_mean_and_its_holes():
    series = channel_series("speed", None, drift(seed=2, seconds=60.0).track, None, ClockMap())
    valid = series.valid.copy()
    valid[300:420] = False
    coarse = replace(series, valid=valid).coarser(100)
    assert len(coarse.values) == 100
    assert coarse.sample_rate_hz == pytest.approx(20.0 / 12)
    assert np.flatnonzero(~coarse.valid).tolist() == list(range(25, 35))
    assert coarse.values[0] == pytest.approx(series.values[:12].mean())
    assert series.coarser(10_000) is series


def test_the_names_are_those_of_the_table_and_the_fields_exist():
    assert list(CONDITIONER_FIELDS) == [row.name for row in registry.CONDITIONERS]
    known = {field.name for field in fields(ConditioningSettings)}
    assert all(set(used) <= known for used in CONDITIONER_FIELDS.values())
