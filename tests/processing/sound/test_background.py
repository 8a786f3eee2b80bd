"""The running median and the spread estimates against brute force."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from processing.sound.background import lower_sigma, robust_sigma, running_median

values = arrays(np.float64, st.integers(1, 60), elements=st.floats(-100, 100).map(lambda x: round(x, 3)))


@given(values, st.integers(0, 12))
def test_it_is_the_median_of_the_values_around(x, half):
    half = min(half, len(x) - 1)
    mirrored = np.pad(x, half, mode="symmetric")
    brute = [np.median(mirrored[i : i + 2 * half + 1]) for i in range(len(x))]
    np.testing.assert_allclose(running_median(x, half), brute)


@given(values, st.integers(0, 12), st.floats(-50, 50))
def test_what_is_added_everywhere_is_added_to_the_background(x, half, offset):
    np.testing.assert_allclose(running_median(x + offset, half), running_median(x, half) + offset, atol=1e-9)


def test_a_leak_narrower_than_half_the_window_does_not_lift_it():
    noise = np.random.default_rng(0).normal(0, 1, 2000)
    leak = 20 / (1 + ((np.arange(2000) - 1000) / 8) ** 2)
    lifted = running_median(noise + leak, 96) - running_median(noise, 96)
    assert abs(lifted).max() < 1.1  # of 20: under the apex the window holds only the leak's own flanks and the noise
    assert abs(lifted[:850]).max() < 0.3


def test_holes_stay_holes_and_do_not_pull():
    x = np.arange(100.0)
    x[40:50] = np.nan
    median = running_median(x, 5)
    assert np.isnan(median[40:50]).all()
    np.testing.assert_allclose(median[6:40], np.arange(6.0, 40))
    np.testing.assert_allclose(median[50:94], np.arange(50.0, 94))
    assert np.isnan(running_median(np.full(5, np.nan), 2)).all()


def test_spread_of_a_normal_distribution_is_its_sigma_and_outliers_do_not_matter():
    x = np.random.default_rng(1).normal(3, 2, 20000)
    assert robust_sigma(x) == pytest.approx(2, rel=0.03)
    assert lower_sigma(x) == pytest.approx(2, rel=0.03)
    x[:2000] += 100
    assert robust_sigma(x) == pytest.approx(2, rel=0.25)
    assert lower_sigma(x) == pytest.approx(2, rel=0.12)
    assert robust_sigma(np.array([np.nan])) == lower_sigma(np.array([])) == 0.0
