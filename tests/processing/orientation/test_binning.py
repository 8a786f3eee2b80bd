"""Sums over bins of time, whatever the blocks and the holes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from processing.orientation.binning import BinSums


@given(st.lists(st.floats(0.0, 5.0), min_size=1, max_size=60), st.integers(1, 20))
def test_blocks_of_any_size_give_the_histogram(steps, block):
    time_s = 3.0 + np.cumsum(steps)
    terms = np.column_stack([np.ones(len(steps)), np.arange(len(steps), dtype=float)])
    sums = BinSums(3.0, 0.5, 2, most_empty=1000)
    for a in range(0, len(steps), block):
        sums.add(time_s[a : a + block], terms[a : a + block])
    bins = sums.result()
    number = np.floor((time_s - 3.0) / 0.5).astype(int)
    np.testing.assert_array_equal(bins.number, np.arange(number[0], number[-1] + 1))
    for k in range(2):
        expected = np.bincount(number - number[0], terms[:, k], len(bins.number))
        np.testing.assert_allclose(bins.sums[:, k], expected)
    np.testing.assert_allclose(bins.start_of, 3.0 + 0.5 * bins.number)


def test_a_long_hole_is_cut_short_and_the_times_after_it_stay_right():
    sums = BinSums(0.0, 1.0, 1, most_empty=2)
    sums.add(np.array([0.5, 1e12 + 0.5]), np.ones((2, 1)))
    bins = sums.result()
    np.testing.assert_array_equal(bins.sums[:, 0], [1.0, 0.0, 0.0, 1.0])
    assert bins.start_of[-1] == 1e12


def test_nothing_in_is_nothing_out():
    assert BinSums(0.0, 1.0, 3, most_empty=1).result().sums.shape == (0, 3)
