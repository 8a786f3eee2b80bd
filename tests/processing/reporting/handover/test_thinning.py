"""Lines with fewer vertices stay where they were."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.reporting.handover.thinning import thinned


def from_line(point, line):
    """Distance of a point from a line, by dense sampling: 100 points on each piece."""
    parts = np.linspace(0.0, 1.0, 101)[:, None]
    return min(np.linalg.norm(a + parts * (b - a) - point, axis=1).min() for a, b in itertools.pairwise(line))


@settings(max_examples=25)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.05, 0.3, 2.0]))
def test_no_vertex_is_further_from_the_thinned_line_than_the_tolerance(seed, tolerance):
    rng = np.random.default_rng(seed)
    line = np.cumsum(rng.normal(size=(12, 3)), axis=0)
    fewer = thinned(line, tolerance)
    assert (fewer[0] == line[0]).all()
    assert (fewer[-1] == line[-1]).all()
    longest = np.linalg.norm(np.diff(fewer, axis=0), axis=1).max()
    assert max(from_line(point, fewer) for point in line) <= tolerance + longest / 100


def test_a_straight_line_keeps_its_ends_only_and_a_corner_stays():
    along = np.linspace(0.0, 100.0, 201)
    straight = np.column_stack([along, 2.0 * along, -along])
    assert len(thinned(straight, 0.001)) == 2
    bent = np.concatenate([straight, straight[-1] + np.column_stack([along[1:], 0 * along[1:], 0 * along[1:]])])
    assert thinned(bent, 0.001)[1] == pytest.approx(straight[-1])
