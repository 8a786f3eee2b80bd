"""A choice that the mouse wheel passes by: a hand that scrolls over it must not change it unseen."""

from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QComboBox


class QuietCombo(QComboBox):
    """Opens by click or key; the wheel is left to what scrolls around it."""

    def wheelEvent(self, event: QWheelEvent) -> None:
        """Qt: not ours."""
        event.ignore()
