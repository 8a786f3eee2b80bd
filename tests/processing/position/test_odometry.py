"""The common form of free paths: which steps a span touches."""

import numpy as np
import pytest

from processing.position.odometry import in_spans

ROWS_S = np.array([0.0, 1.0, 2.0, 3.0, 4.0])


@pytest.mark.parametrize(
    ("span", "touched"),
    [
        ((1.2, 1.4), [1]),
        ((0.5, 2.5), [0, 1, 2]),
        ((2.0, 2.0), [2]),  # a moment on a row lies in the step after, so that its variance is not lost
        ((4.0, 4.0), []),
        ((-5.0, 0.5), [0]),
    ],
)
def test_a_span_touches_the_steps_it_reaches_into(span, touched):
    assert list(np.flatnonzero(in_spans(ROWS_S, np.array([span])))) == touched
