"""Level meter: a bar of the root mean square a channel, its peak and held peak, and a clip light that stays on."""

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QSizePolicy, QWidget

from processing.live.stream import LinkState, SoundStatus
from processing.survey import Verdict
from widgets.painted_widget import PaintedWidget
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.recording_words import state_text

LOWEST_DB = -96.0
WARM_DB, HOT_DB = -12.0, -3.0  # from here on the next bump may clip; from here on it does
_ROWS_MOST = 8


class LevelMeter(PaintedWidget):
    """Shows the levels of a :class:`SoundStatus`; a click anywhere on it asks to clear the clip light."""

    clear_asked = Signal()

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme = theme
        self._status = SoundStatus()
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        self.setToolTip(self.tr("Level in dB below full scale. Click or press Q to put out the clip light"))

    def set_status(self, status: SoundStatus) -> None:
        """Show these levels."""
        rows_before, before = self.rows, self._status
        self._status = status
        if self.rows != rows_before:
            self.updateGeometry()
        if status != before:
            self.setAccessibleName(self.tr("Level meter") + ": " + self.words)
            self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.updateGeometry()
        self.update()

    @property
    def rows(self) -> int:
        """Channels shown."""
        return max(1, min(len(self._status.rms_db), _ROWS_MOST))

    @property
    def words(self) -> str:
        """What is wrong, or the loudest level; empty where no device was chosen."""
        status = self._status
        if status.state is not LinkState.LIVE:
            return state_text(status.state)
        if any(status.clipped):
            return self.tr("clipped: too loud")
        if status.is_digital_silence:
            return state_text(LinkState.SILENT)
        return f"{number_text(max(status.rms_db, default=LOWEST_DB), 0, self.locale())} dB"

    def sizeHint(self) -> QSize:
        """Ask for a thick bar a channel, and the scale."""
        line = self._theme.metrics().height()
        return QSize(300, round(self.rows * 1.5 * line + 1.3 * line))

    def minimumSizeHint(self) -> QSize:
        """Ask for the same height."""
        return QSize(160, self.sizeHint().height())

    def x_of(self, level_db: float) -> float:
        """Return the pixel of a level."""
        rect = self._bars()
        part = (level_db - LOWEST_DB) / -LOWEST_DB
        return rect.left() + rect.width() * min(max(part, 0.0), 1.0)

    def _bars(self) -> QRectF:
        metrics = self._theme.metrics()
        light = metrics.horizontalAdvance(self._light) + 20
        return QRectF(4, 2, max(20.0, self.width() - light - 10), self.height() - 1.3 * metrics.height() - 2)

    @property
    def _light(self) -> str:
        return self.tr("CLIP")

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        """Clear the clip light."""
        if event.button() is Qt.MouseButton.LeftButton:
            self.clear_asked.emit()

    def _paint(self, painter: QPainter) -> None:
        theme, rect, status = self._theme, self._bars(), self._status
        painter.setFont(theme.font())
        painter.fillRect(rect, QColor(theme.canvas))
        each = rect.height() / self.rows
        for row in range(self.rows if status.rms_db else 0):
            self._paint_row(painter, QRectF(rect.left(), rect.top() + row * each + 1, rect.width(), each - 2), row)
        self._paint_scale(painter, rect)
        painter.setBrush(Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.text), 1))
        painter.drawRect(rect)
        self._paint_light(painter, rect)
        quiet = status.state is LinkState.LIVE and not status.is_digital_silence
        if not quiet:
            font = theme.font()
            font.setBold(True)
            painter.setFont(font)
            painter.setPen(QColor(theme.cursor if status.state is LinkState.LOST else theme.text))
            painter.drawText(rect, Qt.AlignmentFlag.AlignCenter, self.words)

    def _paint_row(self, painter: QPainter, rect: QRectF, row: int) -> None:
        theme, status = self._theme, self._status
        rms = status.rms_db[row]
        good, warm, hot = theme.verdicts[Verdict.CONFIRMED], theme.verdicts[Verdict.UNSURE], theme.cursor
        for low, high, colour in ((LOWEST_DB, WARM_DB, good), (WARM_DB, HOT_DB, warm), (HOT_DB, 0.0, hot)):
            if rms > low:
                left, right = self.x_of(low), self.x_of(min(rms, high))
                painter.fillRect(QRectF(left, rect.top(), right - left, rect.height()), QColor(colour))
        if row < len(status.peak_db) and status.peak_db[row] > LOWEST_DB:
            x = self.x_of(status.peak_db[row])
            painter.fillRect(QRectF(x - 1, rect.top() + rect.height() / 3, 2, rect.height() / 3), QColor(theme.text))
        if row < len(status.held_peak_db) and status.held_peak_db[row] > LOWEST_DB:
            x = self.x_of(status.held_peak_db[row])
            painter.fillRect(QRectF(x - 2, rect.top(), 4, rect.height()), QColor(theme.text))

    def _paint_scale(self, painter: QPainter, rect: QRectF) -> None:
        metrics, grid = self._theme.metrics(), QColor(self._theme.text)
        half = metrics.horizontalAdvance("−000")
        for level in range(0, int(LOWEST_DB), -12 if rect.width() > 8 * half else -24):
            x = self.x_of(level)
            painter.setPen(QPen(grid, 1))
            painter.drawLine(QPointF(x, rect.bottom()), QPointF(x, rect.bottom() + 4))
            left = min(max(x - half, 0.0), self.width() - 2 * half)
            box = QRectF(left, rect.bottom() + 2, 2 * half, 1.2 * metrics.height())
            painter.drawText(box, Qt.AlignmentFlag.AlignCenter, number_text(level, 0, self.locale()))

    def _paint_light(self, painter: QPainter, rect: QRectF) -> None:
        theme, on = self._theme, any(self._status.clipped)
        box = QRectF(rect.right() + 6, rect.top(), self.width() - rect.right() - 8, rect.height())
        painter.setBrush(QColor(theme.cursor) if on else Qt.BrushStyle.NoBrush)
        painter.setPen(QPen(QColor(theme.cursor if on else theme.route), 2))
        painter.drawRoundedRect(box, 4, 4)
        font = theme.font()
        font.setBold(on)
        painter.setFont(font)
        painter.setPen(QColor(theme.canvas if on else theme.route))
        painter.drawText(box, Qt.AlignmentFlag.AlignCenter, self._light)
