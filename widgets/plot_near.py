"""Which candidates a plot need draw: those in sight, or so little beside it that their marks reach in."""

import numpy as np

from processing.survey import Candidate
from widgets.plot_marks import Marks
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor

FEW_CANDIDATES = 8


def near(marks: Marks, cursor: TimeCursor, x_span: tuple[float, float]) -> list[Candidate]:
    """Return the candidates within a span of the common axis (in its unit) or little beside it, in drawing order."""
    candidates, (low, high) = marks.in_drawing_order, x_span
    if len(candidates) <= FEW_CANDIDATES:
        return candidates
    metres = np.array([candidate.chainage_m for candidate in candidates])
    x = cursor.x_of_time(np.nan_to_num(np.array([candidate.time_s for candidate in candidates])))
    if cursor.axis_mode is AxisMode.DISTANCE:
        x = np.where(np.isfinite(metres), metres, x)
    spare = 0.05 * (high - low)
    return [candidates[row] for row in np.flatnonzero((x >= low - spare) & (x <= high + spare))]
