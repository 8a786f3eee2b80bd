"""The check before the launch: what to do now in large letters, then a list of lights with what was found."""

from html import escape

from PySide6.QtCore import QRectF, Qt, Signal
from PySide6.QtGui import QPainter
from PySide6.QtWidgets import (
    QFormLayout,
    QHBoxLayout,
    QLabel,
    QProgressBar,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from processing import messages
from processing.live.check_sheet import CheckItem, CheckSheet, CheckView, Light, Phase
from processing.live.check_words import item_sentence, item_title, light_word
from processing.survey import Verdict
from widgets.optional_number import OptionalNumber
from widgets.painted_widget import PaintedWidget
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.recording_words import Mark, paint_mark

_HEIGHT = 40
SPEEDS_MPS = (0.01, 10.0)
_RANGES_DPS = (250.0, 500.0, 1000.0, 2000.0, 4000.0)
_SIGNS = {Light.GREEN: "✓", Light.YELLOW: "!", Light.RED: "X", Light.OPEN: "–"}
_MARK_PIXELS = 30


def light_mark(light: Light, theme: Theme) -> Mark:
    """Return shape and colour of a light; each has a shape of its own."""
    return {
        Light.GREEN: Mark("circle", theme.verdicts[Verdict.CONFIRMED]),
        Light.YELLOW: Mark("triangle", theme.verdicts[Verdict.UNSURE]),
        Light.RED: Mark("diamond", theme.cursor),
        Light.OPEN: Mark("ring", theme.verdicts[Verdict.REJECTED]),
    }[light]


class LightMark(PaintedWidget):
    """One light: shape, letter and colour."""

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._theme, self._light = theme, Light.OPEN
        self.setFixedSize(_MARK_PIXELS, _MARK_PIXELS)

    def show_light(self, light: Light, theme: Theme) -> None:
        """Show this light in this theme."""
        self._light, self._theme = light, theme
        self.update()

    def _paint(self, painter: QPainter) -> None:
        box = QRectF(0, 0, _MARK_PIXELS, _MARK_PIXELS)
        paint_mark(painter, light_mark(self._light, self._theme), _SIGNS[self._light], box, self._theme)


class PrelaunchPanel(QWidget):
    """Asks for a check, guides through it and shows its sheet."""

    check_asked = Signal(str)  # launch | end
    skip_asked = Signal()
    stop_asked = Signal()
    changed = Signal()  # speed or range

    def __init__(self, language: str, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._language, self._theme = language, theme
        self._sheet: CheckSheet | None = None
        self._rows: list[QWidget] = []
        self._running = False
        self.speed = OptionalNumber(*SPEEDS_MPS, hint=self.tr("unknown"))
        self.speed.setObjectName("check_speed")
        self.speed.value_changed.connect(self.changed)
        self.gyro_range = QuietCombo()
        self.gyro_range.setObjectName("check_range")
        self.gyro_range.setMinimumHeight(_HEIGHT)
        for value in _RANGES_DPS:
            self.gyro_range.addItem(f"±{value:.0f} °/s", value)
        self.gyro_range.setCurrentIndex(_RANGES_DPS.index(2000.0))
        self.gyro_range.currentIndexChanged.connect(self.changed)
        self.start = self._button("check_start", self.tr("Check before the launch"))
        self.start.clicked.connect(lambda: self.check_asked.emit("launch"))
        self.knocks = self._button("check_end", self.tr("Knocks at the end"))
        self.knocks.setToolTip(self.tr("Knock again before you stop: it settles the drift of the clocks"))
        self.knocks.clicked.connect(lambda: self.check_asked.emit("end"))
        self.skip = self._button("check_skip", self.tr("Skip this step"))
        self.skip.clicked.connect(self.skip_asked)
        self.cancel = self._button("check_stop", self.tr("Break off"))
        self.cancel.clicked.connect(self.stop_asked)
        self._task = QLabel()
        self._task.setWordWrap(True)
        self._task.setObjectName("check_task")
        self._bar = QProgressBar()
        self._bar.setRange(0, 1000)
        self._bar.setTextVisible(False)
        self._list = QVBoxLayout()
        self._lay_out()
        self.apply_theme(theme)
        self._show_running(running=False)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(48)
        return button

    def _lay_out(self) -> None:
        form = QFormLayout()
        form.addRow(self.tr("Expected speed (m/s)"), self.speed)
        form.addRow(self.tr("Range of the gyro"), self.gyro_range)
        buttons = QHBoxLayout()
        for button in (self.start, self.knocks, self.skip, self.cancel):
            buttons.addWidget(button)
        inner = QWidget()
        self._list.setContentsMargins(0, 0, 0, 0)
        holder = QVBoxLayout(inner)
        holder.setContentsMargins(0, 0, 0, 0)
        holder.addLayout(self._list)
        holder.addStretch(1)
        area = QScrollArea()
        area.setWidgetResizable(True)
        area.setFrameShape(QScrollArea.Shape.NoFrame)
        area.setWidget(inner)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(form)
        layout.addLayout(buttons)
        layout.addWidget(self._task)
        layout.addWidget(self._bar)
        layout.addWidget(area, 1)

    # --- values ---

    @property
    def speed_mps(self) -> float | None:
        """The expected speed."""
        return self.speed.value

    @property
    def gyro_range_dps(self) -> float:
        """The chosen range of the gyro."""
        return float(self.gyro_range.currentData())

    def set_values(self, speed_mps: float | None, gyro_range_dps: float) -> None:
        """Show remembered values without a signal."""
        self.speed.set_value(speed_mps)
        blocked = self.gyro_range.blockSignals(True)
        nearest = min(_RANGES_DPS, key=lambda value: abs(value - gyro_range_dps))
        self.gyro_range.setCurrentIndex(_RANGES_DPS.index(nearest))
        self.gyro_range.blockSignals(blocked)

    # --- the check ---

    def set_ready(self, *, devices: bool, recording: bool) -> None:
        """Say what can be asked for: nothing without a device; the knocks at the end only while recording."""
        self.start.setEnabled(devices)
        self.knocks.setEnabled(devices and recording)

    def show_view(self, view: CheckView) -> None:
        """Show what is to be done now and how far it is."""
        self._show_running(running=view.phase is not Phase.DONE)
        key = "rest_moved" if view.phase is Phase.REST and view.moved else view.phase.value
        task = messages.text("check_phases", key, self._language)
        if view.phase is Phase.KNOCK:
            task += " " + self.tr("Heard {heard}, felt {felt}, both {both}.").format(
                heard=view.heard, felt=view.felt, both=view.both
            )
        self._task.setText(task)
        self._bar.setValue(round(1000 * view.fraction))

    def show_broken_off(self) -> None:
        """Show that no check is under way."""
        self._task.clear()
        self._bar.setValue(0)
        self._show_running(running=False)

    def _show_running(self, *, running: bool) -> None:
        self._running = running
        for button in (self.start, self.knocks):
            button.setVisible(not running)
        for button in (self.skip, self.cancel):
            button.setVisible(running)
        self._bar.setVisible(running)

    @property
    def task(self) -> str:
        """What is asked for at this moment."""
        return self._task.text()

    def show_sheet(self, sheet: CheckSheet | None) -> None:
        """Show the lights of a check, the worst first; None clears them."""
        self._sheet = sheet
        for row in self._rows:
            self._list.removeWidget(row)
            row.deleteLater()
        self._rows = []
        if sheet is None:
            return
        order = (Light.RED, Light.YELLOW, Light.GREEN, Light.OPEN)
        for item in sorted(sheet.items, key=lambda item: order.index(item.light)):
            self._rows.append(self._row(item))
            self._list.addWidget(self._rows[-1])

    def _row(self, item: CheckItem) -> QWidget:
        row = QWidget()
        layout = QHBoxLayout(row)
        layout.setContentsMargins(0, 2, 0, 2)
        mark = LightMark(self._theme)
        mark.show_light(item.light, self._theme)
        title, found = item_title(item, self._language), item_sentence(item, self._language)
        words = QLabel(f"<b>{escape(title)}</b>: {escape(found)}")
        words.setWordWrap(True)
        words.setTextFormat(Qt.TextFormat.RichText)
        row.setAccessibleName(f"{light_word(item.light, self._language)}: {title}: {found}")
        layout.addWidget(mark, 0, Qt.AlignmentFlag.AlignTop)
        layout.addWidget(words, 1)
        return row

    def texts(self) -> list[str]:
        """Return all rows as shown, for tests and for reading aloud."""
        return [row.accessibleName() for row in self._rows]

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        font = theme.font()
        font.setPointSizeF(1.4 * font.pointSizeF())
        font.setBold(True)
        self._task.setFont(font)
        items = self._sheet.items if self._sheet is not None else ()
        if items:
            self.show_sheet(self._sheet)
