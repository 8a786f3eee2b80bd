"""Which recordings, how their clocks relate, which stretch: the left half of the correlator's page."""

from dataclasses import dataclass
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QFormLayout,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from processing.correlation.recordings import MOST_DRIFT_PPM, Sync, SyncKind
from widgets.optional_number import OptionalNumber
from widgets.plot_scale import number_text
from widgets.quiet_combo import QuietCombo

_MS = 1e-3


@dataclass(frozen=True)
class ShownRecording:
    """What is said of a recording: its files, how long, how many samples a second, how many channels, which is used."""

    paths: tuple[Path, ...]
    duration_s: float
    rate_hz: float
    channels: int
    channel: int


class RecordingBox(QGroupBox):
    """One sensor's recording: choose or drop a file, and choose its channel."""

    choose_asked = Signal()
    dropped = Signal(list)  # paths
    channel_chosen = Signal(int)

    def __init__(self, title: str, parent: QWidget | None = None) -> None:
        super().__init__(title, parent)
        self.setAcceptDrops(True)
        self._name = QLabel(self.tr("No file yet: choose one, or drop it here."))
        self._name.setTextFormat(Qt.TextFormat.PlainText)
        self._name.setWordWrap(True)
        self._name.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)  # names may be long
        self._choose = QPushButton(self.tr("Choose…"))
        self._choose.setMinimumHeight(40)
        self._choose.clicked.connect(self.choose_asked)
        self.channel = QuietCombo()
        self.channel.setMinimumHeight(40)
        self.channel.setAccessibleName(self.tr("Channel"))
        self.channel.activated.connect(self.channel_chosen)
        self.channel.hide()
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 4, 8, 6)
        for widget in (self._name, self._choose, self.channel):
            layout.addWidget(widget)

    def show_recording(self, shown: ShownRecording | None) -> None:
        """Show what was chosen; None shows nothing."""
        self.channel.clear()
        if shown is None:
            self._name.setText(self.tr("No file yet: choose one, or drop it here."))
            self.channel.hide()
            return
        name = shown.paths[0].name
        if len(shown.paths) > 1:
            name = self.tr("{name} and {count} more").format(name=name, count=len(shown.paths) - 1)
        facts = self.tr("{seconds} s, {rate} Hz").format(
            seconds=number_text(shown.duration_s, 1, self.locale()), rate=number_text(shown.rate_hz, 0, self.locale())
        )
        self._name.setText(f"{name}\n{facts}")
        self._name.setToolTip("\n".join(str(path) for path in shown.paths))
        for number in range(shown.channels):
            self.channel.addItem(self.tr("Channel {number}").format(number=number + 1))
        self.channel.setCurrentIndex(shown.channel)
        self.channel.setVisible(shown.channels > 1)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Qt: files may be dropped here."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Qt: hand on what was dropped."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.dropped.emit(paths)


class ClockBox(QGroupBox):
    """How it is known that the recordings are simultaneous; without that there is a delay, but no place."""

    changed = Signal()
    event_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTitle(self.tr("Clocks"))
        self.kind = QuietCombo()
        self.kind.setMinimumHeight(40)
        self.kind.setAccessibleName(self.tr("How the clocks relate"))
        for kind, text in (
            (SyncKind.ONE_CLOCK, self.tr("One clock: one recorder, or radio or GPS time")),
            (SyncKind.TYPED, self.tr("The offset is known")),
            (SyncKind.EVENT, self.tr("Both were knocked together")),
            (SyncKind.TAPS, self.tr("By taps beyond both ends")),
            (SyncKind.UNKNOWN, self.tr("Unknown: delay only, no place")),
        ):
            self.kind.addItem(text, kind.value)
        self.kind.activated.connect(self._on_change)
        self._at_s = 0.0  # when the offset held; a typed one holds at the beginning
        self.offset = OptionalNumber(-1e7, 1e7, factor=_MS, hint="0")
        self.offset.value_changed.connect(self._forget_moment)
        self.sigma = OptionalNumber(0.0, 1e4, factor=_MS, hint="0")
        self.drift = OptionalNumber(-MOST_DRIFT_PPM, MOST_DRIFT_PPM, hint="0")
        self.drift.setToolTip(self.tr("How much faster B's clock runs; what remains is found from the sound itself"))
        for field in (self.offset, self.sigma, self.drift):
            field.value_changed.connect(self._on_change)
        self.find_event = QPushButton(self.tr("Find the knocks in the stretch"))
        self.find_event.setMinimumHeight(40)
        self.find_event.setToolTip(
            self.tr(
                "Hold both recorders in one hand, knock five times, irregularly; choose that stretch and press here"
            )
        )
        self.find_event.clicked.connect(self.event_asked)
        grid = QGridLayout(self)
        grid.setContentsMargins(8, 4, 8, 6)
        grid.addWidget(self.kind, 0, 0, 1, 4)
        grid.addWidget(QLabel(self.tr("B began later by (ms)")), 1, 0)
        grid.addWidget(self.offset, 1, 1)
        grid.addWidget(QLabel(self.tr("±")), 1, 2)
        grid.addWidget(self.sigma, 1, 3)
        grid.addWidget(QLabel(self.tr("B runs fast by (ppm)")), 2, 0)
        grid.addWidget(self.drift, 2, 1)
        grid.addWidget(self.find_event, 3, 0, 1, 4)
        self._show_fields()

    def sync(self) -> Sync:
        """Return what is entered."""
        kind = SyncKind(self.kind.currentData())
        if kind is SyncKind.ONE_CLOCK:
            return Sync(kind)
        return Sync(kind, self.offset.value or 0.0, self.sigma.value or 0.0, self.drift.value or 0.0, self._at_s)

    def set_sync(self, sync: Sync) -> None:
        """Show this without a signal."""
        self.kind.setCurrentIndex(self.kind.findData(sync.kind.value))
        self.offset.set_value(sync.offset_s or None)
        self.sigma.set_value(sync.sigma_s or None)
        self.drift.set_value(sync.drift_ppm or None)
        self._at_s = sync.at_s
        self._show_fields()

    def _forget_moment(self) -> None:
        self._at_s = 0.0

    def _on_change(self) -> None:
        self._show_fields()
        self.changed.emit()

    def _show_fields(self) -> None:
        kind = SyncKind(self.kind.currentData())
        for field in (self.offset, self.sigma, self.drift):
            field.setEnabled(kind is not SyncKind.ONE_CLOCK)
        self.find_event.setVisible(kind is SyncKind.EVENT)


class StretchBox(QGroupBox):
    """Which seconds of the recordings are used."""

    changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTitle(self.tr("Stretch (seconds of A)"))
        self.start = OptionalNumber(0.0, 1e7, hint="0")
        self.end = OptionalNumber(0.0, 1e7, hint=self.tr("end"))
        row = QHBoxLayout(self)
        row.setContentsMargins(8, 4, 8, 6)
        for text, field in ((self.tr("from"), self.start), (self.tr("to"), self.end)):
            row.addWidget(QLabel(text))
            row.addWidget(field)
            field.value_changed.connect(self.changed)

    def stretch(self) -> tuple[float, float | None]:
        """Return begin and end; None is the end of the recording."""
        start, end = self.start.value or 0.0, self.end.value
        return start, end if end is None or end > start else None

    def set_stretch(self, start_s: float, end_s: float | None) -> None:
        """Show this without a signal."""
        self.start.set_value(start_s or None)
        self.end.set_value(end_s)


class TapBox(QGroupBox):
    """Measuring the speed of sound: a tap at a known place is the chosen peak."""

    tap_asked = Signal(str)  # "a", "b", "place"

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setTitle(self.tr("Measure the speed"))
        about = QLabel(
            self.tr("Tap on the pipe beyond a sensor, choose that stretch and its peak, and say where you tapped:")
        )
        about.setWordWrap(True)
        self.beyond_a = QPushButton(self.tr("Beyond A"))
        self.beyond_b = QPushButton(self.tr("Beyond B"))
        self.at_place = QPushButton(self.tr("At metre"))
        self.place = OptionalNumber(0.0, 20_000.0)
        self._said = QLabel()
        self._said.setWordWrap(True)
        self._said.setTextFormat(Qt.TextFormat.PlainText)
        row = QHBoxLayout()
        for button, key in ((self.beyond_a, "a"), (self.beyond_b, "b"), (self.at_place, "place")):
            button.setMinimumHeight(40)
            button.setEnabled(False)
            button.clicked.connect(lambda _checked=False, k=key: self.tap_asked.emit(k))
            row.addWidget(button)
        row.addWidget(self.place)
        form = QFormLayout(self)
        form.setContentsMargins(8, 4, 8, 6)
        form.addRow(about)
        form.addRow(row)
        form.addRow(self._said)

    def set_ready(self, *, ready: bool) -> None:
        """Switch the buttons on where there is a peak to take."""
        for button in (self.beyond_a, self.beyond_b, self.at_place):
            button.setEnabled(ready)

    def say(self, text: str) -> None:
        """Tell what came out."""
        self._said.setText(text)
