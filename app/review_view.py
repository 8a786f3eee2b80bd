"""How the operator sees the review: what is selected, filtered and visible; an undo brings it back."""

from dataclasses import dataclass

from widgets.candidate_row import CandidateFilter
from widgets.time_axis import AxisMode
from widgets.time_cursor import TimeCursor


@dataclass(frozen=True)
class ReviewView:
    """A moment of the review as it was seen; ``x_range`` in the unit of ``axis_mode``."""

    selected: int | None
    filter: CandidateFilter
    axis_mode: AxisMode
    x_range: tuple[float, float]


def visible_range(cursor: TimeCursor, view: ReviewView) -> None:
    """Show the range of a view again, on its axis; without a path to count metres by, the range stays."""
    if cursor.set_axis_mode(view.axis_mode):
        cursor.set_x_range(*view.x_range)
