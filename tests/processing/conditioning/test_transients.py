"""Pressure transients made after textbook formulas are found with time, size and ringing; slow courses are none.

The simulator's pressure holds neither valves nor leaks, so everything here is synthetic.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.conditioning.transients import find_transients, pressure_rows
from processing.survey import ImuSamples, Track


def log(course, seconds=300.0, rate=100.0, noise=0.05, seed=0):
    """An IMU log whose pressure is 420 kPa, a surge of 0.4 kPa that lasts for 20 s, ``course(time_s)``, and noise."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(seconds * rate)) / rate
    knots = rng.standard_normal(int(seconds / 20) + 3)
    surge = 0.4 * np.interp(time_s / 20, np.arange(len(knots)), knots)
    three = np.zeros((len(time_s), 3))
    pressure = 420.0 + surge + course(time_s) + noise * rng.standard_normal(len(time_s))
    return ImuSamples(time_s, three, three, np.ones(len(time_s), bool), pressure_kpa=pressure)


def step(at, size, rise_s=0.05):
    return lambda t: size * np.clip((t - at) / rise_s, 0.0, 1.0)


def hammer(at, size, hz, fading_s):
    return lambda t: np.where(t >= at, size * np.exp(-(t - at) / fading_s) * np.cos(2 * np.pi * hz * (t - at)), 0.0)


def found(course, **kwargs):
    return find_transients(pressure_rows(log(course, **kwargs)))


@settings(deadline=None, max_examples=20)
@given(st.floats(20.0, 270.0), st.sampled_from([-12.0, -4.0, 4.0, 12.0]), st.integers(0, 20))
def test_a_pump_that_switches_is_a_step_of_its_size_at_its_time(at, size, seed):
    (event,) = found(step(at, size), seed=seed)
    assert event.kind == "step"
    assert event.time_s == pytest.approx(at, abs=0.1)
    assert event.size_kpa == pytest.approx(size, abs=0.2 * abs(size) + 0.6)
    assert event.lasting_kpa == pytest.approx(size, abs=0.8)


@pytest.mark.parametrize(("hz", "fading_s"), [(0.5, 6.0), (1.0, 4.0), (2.5, 3.0)])
def test_a_water_hammer_rings_at_its_frequency_and_fades_in_its_time(hz, fading_s):
    (event,) = found(hammer(100.0, 30.0, hz, fading_s))
    assert event.kind == "hammer"
    assert event.time_s == pytest.approx(100.0, abs=0.15)
    assert event.size_kpa == pytest.approx(30.0, rel=0.2)
    assert event.ringing_hz == pytest.approx(hz, rel=0.05)
    assert event.ringing_kpa == pytest.approx(30.0, rel=0.3)
    assert event.fading_s == pytest.approx(fading_s, rel=0.35)
    assert abs(event.lasting_kpa) < 3.0


def test_a_valve_that_closes_leaves_a_step_and_a_hammer():
    (event,) = found(lambda t: step(80.0, 15.0)(t) + hammer(80.0, 20.0, 1.2, 3.0)(t))
    assert event.kind == "hammer"
    assert event.lasting_kpa == pytest.approx(15.0, abs=1.5)
    assert event.ringing_hz == pytest.approx(1.2, rel=0.06)


def test_a_knock_that_passes_is_a_pulse():
    (event,) = found(lambda t: 8.0 * np.exp(-0.5 * ((t - 60.0) / 0.4) ** 2))
    assert event.kind == "pulse"
    assert event.time_s == pytest.approx(60.0, abs=1.0)
    assert event.size_kpa == pytest.approx(8.0, rel=0.2)


def test_several_come_in_order_and_apart():
    events = found(lambda t: step(50.0, 6.0)(t) + step(120.0, -6.0)(t) + hammer(200.0, 20.0, 1.0, 3.0)(t))
    assert [event.kind for event in events] == ["step", "step", "hammer"]
    assert [event.time_s for event in events] == pytest.approx([50.0, 120.0, 200.0], abs=0.15)


@pytest.mark.parametrize("seed", range(10))
def test_noise_surges_and_slow_courses_are_no_transients(seed):
    assert found(lambda t: 20.0 * np.sin(2 * np.pi * t / 90.0), seed=seed, seconds=600.0) == ()


def test_a_ball_that_rolls_down_a_shaft_makes_no_transient_where_the_path_is_known():
    samples = log(lambda t: 9.81 * 0.45 * np.clip(1.5 * (t - 100.0), 0.0, 6.0))
    flat = np.zeros(len(samples.time_s))
    way = 1.5 * samples.time_s
    track = Track(
        samples.time_s, way, np.column_stack([way, flat, flat]), flat, flat, flat,
        np.tile([1.0, 0, 0, 0], (len(flat), 1)), flat + 1.5, "truth",
    )  # fmt: skip
    rows = pressure_rows(samples)
    assert len(find_transients(rows)) >= 1
    assert find_transients(rows, track) == ()


def test_nothing_is_found_across_a_hole_or_in_what_is_not_valid():
    samples = log(step(100.0, 10.0))
    valid = samples.valid.copy()
    valid[(samples.time_s > 98.0) & (samples.time_s < 102.0)] = False
    wild = samples.pressure_kpa.copy()
    wild[~valid] = 1e6
    masked = ImuSamples(samples.time_s, samples.acc_s_mps2, samples.gyr_s_radps, valid, pressure_kpa=wild)
    assert find_transients(pressure_rows(masked)) == ()


def test_a_log_without_pressure_or_with_a_clock_that_jumps_by_years_has_no_rows():
    samples = log(step(100.0, 10.0), seconds=30.0)
    bare = ImuSamples(samples.time_s, samples.acc_s_mps2, samples.gyr_s_radps, samples.valid)
    assert pressure_rows(bare) is None
    time_s = samples.time_s.copy()
    time_s[-1] = 1e9
    jumped = ImuSamples(
        time_s, samples.acc_s_mps2, samples.gyr_s_radps, samples.valid, None, None, samples.pressure_kpa
    )
    assert pressure_rows(jumped) is None
