"""The strips' envelopes against plain minima and maxima of the same samples."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from processing.live.picture import STRIP_CHANNELS
from processing.live.strips import Strips
from processing.survey import ImuSamples


def samples(time_s, seed=0, *, pressure=True):
    rng = np.random.default_rng(seed)
    n = len(time_s)
    return ImuSamples(
        np.asarray(time_s, float),
        rng.normal((0.0, 0.0, 9.8), 1.0, (n, 3)),
        rng.normal(0.0, 0.1, (n, 3)),
        np.ones(n, bool),
        pressure_kpa=rng.normal(400.0, 1.0, n) if pressure else None,
    )


def cut(imu, cuts):
    edges = [0, *sorted(cuts), len(imu.time_s)]
    for a, b in pairwise(edges):
        rows = slice(a, b)
        pressure = None if imu.pressure_kpa is None else imu.pressure_kpa[rows]
        yield ImuSamples(imu.time_s[rows], imu.acc_s_mps2[rows], imu.gyr_s_radps[rows], imu.valid[rows],
                         pressure_kpa=pressure)  # fmt: skip


def envelope(imu, values, bin_s, first, count):
    place = np.floor(imu.time_s / bin_s).astype(int) - first
    low, high = np.full(count, np.nan), np.full(count, np.nan)
    for k in range(count):
        inside = values[(place == k) & imu.valid]
        if len(inside):
            low[k], high[k] = inside.min(), inside.max()
    return low, high


@hypothesis_settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(1, 599), max_size=20, unique=True), st.integers(0, 1000))
def test_however_the_samples_are_cut_each_bin_holds_their_lowest_and_highest(cuts, seed):
    rng = np.random.default_rng(seed)
    time_s = np.cumsum(rng.uniform(0.001, 0.02, 600))
    imu = samples(time_s, seed)
    strips = Strips(bin_s=0.05, span_s=60.0)
    for part in cut(imu, cuts):
        strips.add(part)
    bins = strips.bins()
    columns = {"acc_z_mps2": imu.acc_s_mps2[:, 2], "gyr_norm_radps": np.linalg.norm(imu.gyr_s_radps, axis=1),
               "pressure_kpa": imu.pressure_kpa}  # fmt: skip
    for name, values in columns.items():
        low, high = envelope(imu, values, 0.05, bins.first, len(bins.low))
        k = STRIP_CHANNELS.index(name)
        np.testing.assert_allclose(bins.low[:, k], low, rtol=1e-6)
        np.testing.assert_allclose(bins.high[:, k], high, rtol=1e-6)


def test_a_gap_stays_empty_and_what_follows_keeps_its_time():
    time_s = np.concatenate([np.arange(0.0, 5.0, 0.01), np.arange(12.0, 15.0, 0.01)])
    strips = Strips()
    strips.add(samples(time_s))
    bins = strips.bins()
    middle = (bins.first + np.arange(len(bins.low)) + 0.5) * bins.bin_s
    np.testing.assert_array_equal(np.isnan(bins.low[:, 0]), (middle > 5.0) & (middle < 12.0))


def test_rows_that_cannot_be_trusted_leave_nothing():
    imu = samples(np.arange(0.0, 2.0, 0.01))
    imu.acc_s_mps2[50:150] = 1e9
    imu.valid[50:150] = False
    strips = Strips()
    strips.add(imu)
    bins = strips.bins()
    assert np.nanmax(bins.high[:, 0]) < 100.0
    assert np.isnan(bins.low[12:28]).all()


def test_a_device_without_pressure_has_an_empty_strip_and_no_warning():
    strips = Strips()
    strips.add(samples(np.arange(0.0, 2.0, 0.01), pressure=False))
    assert np.isnan(strips.bins().high[:, STRIP_CHANNELS.index("pressure_kpa")]).all()


def test_only_the_last_minute_is_kept_even_after_hours_without_samples():
    strips = Strips(span_s=60.0)
    strips.add(samples(np.arange(0.0, 100.0, 0.01)))
    assert len(strips.bins().low) == strips.capacity == 1200
    strips.add(samples(np.arange(40_000.0, 40_001.0, 0.01)))
    bins = strips.bins()
    assert len(bins.low) == 1200
    assert bins.first + len(bins.low) == pytest.approx(40_001.0 / 0.05, abs=1)
    assert np.isnan(bins.low[:-20]).all()


def test_a_growing_bin_is_handed_out_again():
    strips = Strips(bin_s=0.05)
    imu = samples(np.arange(0.0, 1.02, 0.01))
    strips.add(imu)
    seen = strips.bins()
    again = strips.bins(seen.first + len(seen.low) - 1)
    assert len(again.low) == 1
    np.testing.assert_array_equal(again.low[-1], seen.low[-1])
