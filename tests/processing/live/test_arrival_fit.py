"""The line through arrivals against clocks of known offset and drift."""

import numpy as np
import pytest
from arrivals import sent
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.live.arrival_fit import ArrivalFit


def fitted(stream, chunk=400, **options):
    fit = ArrivalFit(**options)
    for start in range(0, len(stream.device_s), chunk):
        fit.add(stream.device_s[start : start + chunk], stream.host_s[start : start + chunk])
    return fit


@pytest.mark.parametrize("seed", range(6))
def test_an_hour_of_a_bad_bus_gives_the_clock_within_what_it_says(seed):
    ppm, jitter = (80.0, -80.0)[seed % 2], (0.001, 0.005, 0.020)[seed % 3]
    stream = sent(3600, 100, ppm, jitter, 0.016, stall=(700.0 + 300 * seed, 2.0), seed=seed)
    fit = fitted(stream)
    assert abs(fit.drift_ppm - ppm) < 4 * fit.drift_sigma_ppm < 0.6
    at = stream.device_s[[0, 180_000, -1]]
    error_s = np.abs(fit.host_of(at) - stream.true_s[[0, 180_000, -1]])
    assert (error_s < 3 * fit.sigma_s_at(at)).all()
    assert (fit.sigma_s_at(at) < 0.004).all()


@pytest.mark.parametrize("seconds", [20, 120])
def test_the_interval_holds_from_the_first_minute_on(seconds):
    off = []
    for seed in range(20):
        ppm = (80.0, -80.0)[seed % 2]
        fit = fitted(sent(seconds, 100, ppm, 0.005, 0.016, stall=(7.0, 2.0), seed=seed))
        off.append((fit.drift_ppm - ppm) / fit.drift_sigma_ppm)
    assert 0.5 < np.sqrt(np.mean(np.square(off))) < 1.6  # 20 draws of a standard normal: 0.68 to 1.32 in 95 of 100
    assert np.abs(off).max() < 4


@given(st.floats(-1e6, 1e6), st.floats(-1e6, 1e6))
@settings(max_examples=20, deadline=None)
def test_where_the_clocks_begin_makes_no_difference(device_origin_s, host_origin_s):
    stream = sent(30, 50, 40.0, 0.003, seed=3)
    plain = fitted(stream)
    moved = ArrivalFit()
    moved.add(stream.device_s + device_origin_s, stream.host_s + host_origin_s)
    at = np.array([0.0, 12.0, 31.0])
    assert moved.drift_ppm == pytest.approx(plain.drift_ppm, abs=0.2)
    assert moved.host_of(at + device_origin_s) - host_origin_s == pytest.approx(plain.host_of(at), abs=2e-5)
    assert moved.device_of(moved.host_of(at + device_origin_s)) - device_origin_s == pytest.approx(at, abs=1e-6)


@given(st.lists(st.integers(1, 300), max_size=30))
@settings(max_examples=20, deadline=None)
def test_however_the_arrivals_are_cut_the_line_is_the_same(cuts):
    stream = sent(20, 100, -30.0, 0.004, 0.016, seed=5)
    whole, cut, at = fitted(stream, 10**6), ArrivalFit(), 0
    for size in [*cuts, len(stream.device_s)]:
        cut.add(stream.device_s[at : at + size], stream.host_s[at : at + size])
        at += size
    assert float(cut.host_of(10.0)) == pytest.approx(float(whole.host_of(10.0)), abs=1e-4)


def test_twelve_hours_take_no_more_room_than_one_and_tell_the_drift_to_a_hundredth():
    fit = ArrivalFit(most_windows=256)
    rng = np.random.default_rng(1)
    for start in range(0, 43200, 10):
        device_s = np.arange(start, start + 10, 0.1)
        fit.add(device_s, device_s / (1 + 55e-6) + rng.exponential(0.004, 100))
    assert fit._count <= 256
    assert fit.drift_ppm == pytest.approx(55.0, abs=4 * fit.drift_sigma_ppm)
    assert fit.drift_sigma_ppm < 0.01


def test_times_that_err_either_way_are_taken_in_the_middle():
    rng = np.random.default_rng(2)
    device_s = np.arange(0, 600, 0.02)
    fit = ArrivalFit(one_sided=False, delay_sigma_s=0.0)
    fit.add(device_s, device_s * (1 + 20e-6) + rng.uniform(-0.01, 0.01, len(device_s)))
    assert fit.drift_ppm == pytest.approx(-20.0, abs=4 * fit.drift_sigma_ppm)
    assert float(fit.host_of(300.0)) == pytest.approx(300.006, abs=0.001)


def test_a_clock_that_wanders_widens_what_is_said():
    rng = np.random.default_rng(4)
    device_s = np.arange(0, 7200, 0.05)
    wander_s = 0.010 * np.sin(2 * np.pi * device_s / 7200.0)
    fit = ArrivalFit(delay_sigma_s=0.0)
    fit.add(device_s, device_s + wander_s + rng.exponential(0.001, len(device_s)))
    at = np.linspace(0, 7200, 50)
    error_s = fit.host_of(at) - at - 0.010 * np.sin(2 * np.pi * at / 7200.0)
    assert (np.abs(error_s) < 3 * fit.sigma_s_at(at)).all()


def test_a_clock_that_was_set_begins_beside_the_line_and_keeps_its_slope():
    first, second = sent(300, 50, 60.0, 0.002, seed=1), sent(300, 50, 60.0, 0.002, seed=2, host_origin_s=1400.0)
    fit = fitted(first)
    fit.begin_block()
    fit.add(second.device_s + 400.0 + 0.3, second.host_s)  # 0.3 s beside where it should go on
    assert fit.drift_ppm == pytest.approx(60.0, abs=4 * fit.drift_sigma_ppm)
    assert float(fit.host_of(100.0)) == pytest.approx(1000.0 + 100.0 / (1 + 60e-6), abs=0.005)
    assert float(fit.host_of(500.3)) == pytest.approx(1400.0 + 100.0 / (1 + 60e-6), abs=0.005)
    assert float(fit.device_of(1500.0)) == pytest.approx(500.3 + 0.006, abs=0.005)


def test_a_stall_at_the_very_beginning_moves_nothing():
    fit = fitted(sent(360, 100, 20.0, 0.0003, 0.001, stall=(-0.001, 2.0), seed=0))
    assert fit.drift_ppm == pytest.approx(20.0, abs=4 * fit.drift_sigma_ppm)
    assert fit.drift_sigma_ppm < 0.03


def test_before_the_first_arrival_nothing_is_told():
    fit = ArrivalFit()
    assert fit.is_empty
    with pytest.raises(ValueError, match="nothing has arrived"):
        fit.host_of(0.0)
    fit.add(np.array([5.0]), np.array([100.0]))
    assert float(fit.host_of(5.0)) == pytest.approx(100.0)
    assert fit.drift_sigma_ppm >= 100
