"""The widget that paints itself: whatever its painting raises reaches the crash guard instead of ending the program."""

from PySide6.QtGui import QPainter, QPaintEvent
from PySide6.QtWidgets import QWidget

from widgets.plot_marks import report_paint_error


class PaintedWidget(QWidget):
    """A base for widgets that draw themselves: they write ``_paint``.

    PySide ends the process when a paint event raises, and a painter that was not ended takes the next one down.
    """

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw everything."""
        del event
        painter = QPainter(self)
        try:
            self._paint(painter)
        except Exception:  # noqa: BLE001  # handed on
            report_paint_error()
        finally:
            painter.end()

    def _paint(self, painter: QPainter) -> None:
        """Draw the whole widget with ``painter``, which the caller ends."""
        raise NotImplementedError
