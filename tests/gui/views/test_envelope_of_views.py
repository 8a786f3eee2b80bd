from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from widgets.envelope import BLOCKS_A_COLUMN, EnvelopePyramid, joined


def brute_force(x, samples, edges):
    low, high = np.full(len(edges) - 1, np.nan), np.full(len(edges) - 1, np.nan)
    for k, (a, b) in enumerate(pairwise(edges)):
        last = k == len(low) - 1
        inside = samples[(x >= a) & ((x <= b) if last else (x < b))]
        inside = inside[np.isfinite(inside)]
        if len(inside):
            low[k], high[k] = inside.min(), inside.max()
    return low, high


@settings(max_examples=50, deadline=None)
@given(st.integers(1, 4000), st.integers(1, 60), st.integers(0, 2**32 - 1), st.floats(-0.2, 0.9), st.floats(0.05, 1.4))
def test_columns_hold_every_sample_of_their_span_and_none_from_far_away(count, columns, seed, start, width):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.uniform(0.5, 1.5, count)) / count
    samples = rng.normal(size=count).astype(np.float32).astype(float)
    samples[rng.random(count) < 0.05] = np.nan
    edges = np.linspace(start, start + width, columns + 1)
    pyramid = EnvelopePyramid.build(x, samples)
    low, high = pyramid.columns(edges)
    want_low, want_high = brute_force(x, samples, edges)
    has = np.isfinite(want_low)
    if count < BLOCKS_A_COLUMN * 8 * columns:  # drawn from the samples themselves: exact
        np.testing.assert_array_equal(low[has], want_low[has])
        np.testing.assert_array_equal(high[has], want_high[has])
    assert np.all(low[has] <= want_low[has])
    assert np.all(high[has] >= want_high[has])


def test_one_sample_among_millions_shows_at_every_zoom_and_only_where_it_is():
    count, place = 2_000_003, 1_234_567
    samples = np.zeros(count)
    samples[place] = 5.0
    pyramid = EnvelopePyramid.build(np.arange(count) / 100.0, samples)
    for start, end in ((0.0, 20_000.03), (12_000.0, 13_000.0), (12_345.0, 12_346.0), (12_345.66, 12_345.68)):
        edges = np.linspace(start, end, 1001)
        high = pyramid.columns(edges)[1]
        column = int((place / 100.0 - start) / (end - start) * 1000)
        assert np.nanmax(high[max(column - 1, 0) : column + 2]) == 5.0
        far = np.abs(np.arange(1000) - column) > 2
        assert np.nanmax(high[far], initial=0.0) < 5.0 or end - start < 1.0


def test_a_hole_in_the_log_stays_a_hole():
    x = np.concatenate((np.arange(0, 100), np.arange(200, 300))) * 0.1
    pyramid = EnvelopePyramid.build(x, np.ones(200))
    low, _ = pyramid.columns(np.linspace(0.0, 30.0, 301))
    assert np.all(np.isnan(low[105:195]))
    assert np.all(low[:99] == 1.0)
    assert np.isnan(pyramid.value_at(15.0))
    assert pyramid.value_at(5.02) == 1.0


def test_between_two_samples_runs_a_straight_line():
    pyramid = EnvelopePyramid.build(np.array([0.0, 1.0, 2.0]), np.array([0.0, 10.0, 0.0]))
    low, high = pyramid.columns(np.linspace(0.0, 1.0, 11) + 1e-9)
    np.testing.assert_allclose(low[1:-1], np.arange(1.5, 9.0, 1.0), atol=1e-6)
    np.testing.assert_array_equal(low[1:-1], high[1:-1])


@pytest.mark.parametrize("count", [0, 1])
def test_no_samples_or_one_draw_nothing_or_a_point(count):
    pyramid = EnvelopePyramid.build(np.zeros(count), np.full(count, 3.0))
    low, _ = pyramid.columns(np.linspace(-1.0, 1.0, 5))
    assert np.count_nonzero(np.isfinite(low)) == count
    assert pyramid.span() == ((3.0, 3.0) if count else None)


def test_only_invalid_samples_are_no_signal():
    pyramid = EnvelopePyramid.build(np.arange(5000.0), np.full(5000, np.nan))
    assert np.all(np.isnan(pyramid.columns(np.linspace(0, 5000, 11))[0]))
    assert pyramid.span() is None


def test_samples_are_read_in_bounded_pieces_and_hours_keep_an_eighth():
    asked = []

    def read(start, stop):
        asked.append(stop - start)
        return np.sin(np.arange(start, stop))

    pyramid = EnvelopePyramid.build(np.arange(1_000_000.0), read)
    assert max(asked) <= 2**18
    assert sum(a.nbytes for a in (*pyramid.lows, *pyramid.highs)) < 1_000_000 * 4 * 2 / 8 * 1.2
    asked.clear()
    pyramid.columns(np.linspace(0, 1e6, 1001))
    assert asked == []


def test_neighbouring_columns_of_a_curve_touch():
    low, high = joined(np.array([0.0, 5.0, 1.0, np.nan, 2.0]), np.array([1.0, 6.0, 1.5, np.nan, 2.0]))
    assert high[0] >= low[1] - 1e-12
    assert low[1] <= high[2] + 1e-12
    assert np.isnan(low[3])
    assert (low[4], high[4]) == (2.0, 2.0)
