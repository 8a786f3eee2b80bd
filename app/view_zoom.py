"""Zooming and panning by keys: they act on the view that has the focus, as the wheel does on the one under it."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject
from PySide6.QtWidgets import QApplication

from widgets.linked_plot import LinkedPlot
from widgets.path_view import PathView
from widgets.time_cursor import TimeCursor

if TYPE_CHECKING:
    from app.review_page import ReviewPage

CLOSER = 2.0  # a key press shows half of it, or twice as much
PAN = 0.5  # of what is shown


class ViewZoom(QObject):
    """Public methods without arguments are actions' handlers."""

    def __init__(self, cursor: TimeCursor, page: "ReviewPage", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._cursor, self._page = cursor, page

    def zoom_in(self) -> None:
        """Show half of it: of the plan if that has the focus, else of what all plots show."""
        self._zoom(CLOSER)

    def zoom_out(self) -> None:
        """Show twice as much."""
        self._zoom(1.0 / CLOSER)

    def zoom_in_upright(self) -> None:
        """Show half of the frequencies, or of the values of the plot that has the focus."""
        self._plot.zoom_vertical(1.0 / CLOSER)

    def zoom_out_upright(self) -> None:
        """Show twice as many of them."""
        self._plot.zoom_vertical(CLOSER)

    def pan_back(self) -> None:
        """Show what lies before, without moving the cursor."""
        self._pan(-PAN, 0.0)

    def pan_forward(self) -> None:
        """Show what lies after, without moving the cursor."""
        self._pan(PAN, 0.0)

    def pan_up(self) -> None:
        """Show what lies to the north on the plan."""
        self._pan(0.0, PAN)

    def pan_down(self) -> None:
        """Show what lies to the south on the plan."""
        self._pan(0.0, -PAN)

    @property
    def _plan(self) -> PathView | None:
        focused = QApplication.focusWidget()
        return focused if focused is self._page.path else None

    @property
    def _plot(self) -> LinkedPlot:
        focused = QApplication.focusWidget()
        return focused if isinstance(focused, LinkedPlot) else self._page.spectrogram

    def _zoom(self, factor: float) -> None:
        plan = self._plan
        if plan is not None:
            plan.zoom(factor)
        else:
            self._cursor.zoom(1.0 / factor)

    def _pan(self, right: float, up: float) -> None:
        plan = self._plan
        if plan is not None:
            scale = plan.plan_scale
            plan.pan_to(scale.moved(-right * scale.size[0], up * scale.size[1]))
        elif right:
            low, high = self._cursor.x_range
            self._cursor.pan(right * (high - low))
