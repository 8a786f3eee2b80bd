"""The correlator's page: recordings, clocks and pipe at the left; place, sketch and plots at the right."""

from collections.abc import Sequence
from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QDragEnterEvent, QDropEvent
from PySide6.QtWidgets import (
    QCheckBox,
    QFrame,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from processing import messages
from processing.correlation.weighting import Weighting
from widgets.correlator_form import ClockBox, RecordingBox, StretchBox, TapBox
from widgets.correlator_pipe import PipeSketch, PipeTable, material_names
from widgets.correlator_plot import CorrelationPlot
from widgets.correlator_spectrum import CoherencePlot, PartsPlot, PhasePlot
from widgets.optional_number import OptionalNumber
from widgets.plot_theme import Theme
from widgets.quiet_combo import QuietCombo

_FORM_WIDTH = 440
_BUTTON_HEIGHT = 40


class CorrelatorPage(QWidget):
    """Holds the widgets; :class:`app.correlator_control.CorrelatorControl` fills them and listens to them."""

    dropped = Signal(list)  # paths, beside the two boxes that take their own

    def __init__(self, theme: Theme, language: str) -> None:
        super().__init__()
        self.setAcceptDrops(True)
        names = dict(messages.table("materials", language))
        self.box_a = RecordingBox(self.tr("Sensor A"))
        self.box_b = RecordingBox(self.tr("Sensor B"))
        self.clock = ClockBox()
        self.stretch = StretchBox()
        self.pipe = PipeTable(material_names(names))
        self.taps = TapBox()
        self.sketch = PipeSketch(names, theme)
        self.correlation = CorrelationPlot(theme)
        self.coherence = CoherencePlot(theme)
        self.phase = PhasePlot(theme)
        self.parts = PartsPlot(theme)
        self._plots = (self.correlation, self.coherence, self.phase, self.parts)
        self.place = QLabel()
        self.place.setObjectName("candidate_title")
        self.place.setTextFormat(Qt.TextFormat.PlainText)
        self.notes = QLabel()
        self.notes.setWordWrap(True)
        self.notes.setTextFormat(Qt.TextFormat.PlainText)
        self.readout = QLabel()
        self.readout.setObjectName("readout")
        self.readout.setTextFormat(Qt.TextFormat.PlainText)
        for label in (self.place, self.readout):  # long words must not widen the page
            label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        for plot in self._plots:
            plot.pointed.connect(self.readout.setText)
        self._build_tools(language)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.addWidget(self._form())
        splitter.addWidget(self._results())
        splitter.setStretchFactor(1, 1)
        splitter.setSizes([_FORM_WIDTH, 800])
        layout = QHBoxLayout(self)
        layout.setContentsMargins(6, 6, 6, 6)
        layout.addWidget(splitter)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        for plot in self._plots:
            plot.apply_theme(theme)
        self.sketch.apply_theme(theme)

    def dragEnterEvent(self, event: QDragEnterEvent) -> None:
        """Qt: recordings and sessions may be dropped anywhere."""
        if any(url.isLocalFile() for url in event.mimeData().urls()):
            event.acceptProposedAction()

    def dropEvent(self, event: QDropEvent) -> None:
        """Qt: hand on what was dropped."""
        paths = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
        if paths:
            event.acceptProposedAction()
            self.dropped.emit(paths)

    def set_ready(self, *, ready: bool) -> None:
        """Switch on what needs a result."""
        for widget in (self.suppress, self.export, self.listen_a, self.listen_b, self.listen_both):
            widget.setEnabled(ready)
        self.taps.set_ready(ready=ready)

    def say(self, place: str, notes: Sequence[str]) -> None:
        """Tell the result, or why there is none, in large letters, and what else was noticed below."""
        self.place.setText(place)
        self.notes.setText("\n".join(notes))
        self.notes.setVisible(bool(notes))

    def _build_tools(self, language: str) -> None:
        self.open = self._button(self.tr("Open…"), self.tr("Open a saved correlation"))
        self.save = self._button(self.tr("Save…"), self.tr("Save recordings, pipe and choices as a small file"))
        self.export = self._button(self.tr("Export…"), self.tr("Write the page as PDF, the curve as CSV, all as JSON"))
        self.swap = self._button(self.tr("Swap"), self.tr("Exchange the recordings of A and B"))
        self.weighting = QuietCombo()
        self.weighting.setMinimumHeight(_BUTTON_HEIGHT)
        self.weighting.setAccessibleName(self.tr("Weighting"))
        self.weighting.setToolTip(self.tr("How much each frequency counts"))
        for weighting in Weighting:
            self.weighting.addItem(messages.text("weightings", weighting.value, language), weighting.value)
        self.weighting.setCurrentIndex(self.weighting.findData(Weighting.MAXIMUM_LIKELIHOOD.value))
        self.band_low = OptionalNumber(1.0, 100_000.0)
        self.band_high = OptionalNumber(2.0, 100_000.0)
        for field in (self.band_low, self.band_high):
            field.setMaximumWidth(76)
            field.setAccessibleName(self.tr("Band (Hz)"))
        self.auto_band = self._button(self.tr("Auto band"), self.tr("Use the frequencies in which both hear the same"))
        self.hum = QCheckBox(self.tr("No hum"))
        self.hum.setToolTip(self.tr("Leave out narrow tones: mains hum, pumps"))
        self.hum.setChecked(True)
        self.resonances = QCheckBox(self.tr("Divide resonances"))
        self.resonances.setToolTip(self.tr("Take out the ringing of one sensor or its fitting"))
        self.bend = QCheckBox(self.tr("Dispersion"))
        self.bend.setToolTip(self.tr("Let the speed grow with frequency as the phase shows it"))
        self.bend.setChecked(True)
        self.reference = OptionalNumber(1.0, 20_000.0, hint=self.tr("?"))
        self.reference.setMaximumWidth(70)
        self.reference.setAccessibleName(self.tr("speeds hold at (Hz)"))
        self.reference.setToolTip(self.tr("At which frequency the speeds of the sections hold; empty: not known"))
        for check in (self.hum, self.resonances, self.bend):
            check.setMinimumHeight(_BUTTON_HEIGHT)
        self.peak_name = QLineEdit()
        self.peak_name.setPlaceholderText(self.tr("what it is: draw-off, echo …"))
        self.peak_name.setMinimumHeight(_BUTTON_HEIGHT)
        self.peak_name.setMaxLength(60)
        self.peak_name.setMinimumWidth(80)
        self.peak_name.setAccessibleName(self.peak_name.placeholderText())
        self.peak_name.setToolTip(self.peak_name.placeholderText())
        self.suppress = self._button(self.tr("Take peak out"), self.tr("Remove the chosen peak and show the next"))
        self.restore = self._button(self.tr("Put back"), self.tr("Put back the peak that was taken out last"))
        self.restore.setEnabled(False)
        self.listen_a = self._button(self.tr("Hear A"), self.tr("Listen to sensor A"))
        self.listen_b = self._button(self.tr("Hear B"), self.tr("Listen to sensor B"))
        self.listen_both = self._button(self.tr("Hear both"), self.tr("A in the left ear, B in the right"))
        for button in (self.listen_a, self.listen_b, self.listen_both):
            button.setCheckable(True)
        self.band_only = QCheckBox(self.tr("Hear band only"))
        self.band_only.setMinimumHeight(_BUTTON_HEIGHT)
        self.band_only.setChecked(True)
        self.set_ready(ready=False)

    def _button(self, text: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setMinimumHeight(_BUTTON_HEIGHT)
        button.setToolTip(tip)
        return button

    def _form(self) -> QWidget:
        inner = QWidget()
        column = QVBoxLayout(inner)
        column.setContentsMargins(0, 0, 4, 0)
        column.addLayout(_row(self.open, self.save, self.export, self.swap))
        column.addLayout(_row(self.box_a, self.box_b))
        column.addWidget(self.clock)
        column.addWidget(self.stretch)
        title = QLabel(self.tr("Pipe from A to B"))
        title.setObjectName("readout")
        column.addWidget(title)
        column.addWidget(self.pipe)
        column.addWidget(self._method())
        column.addWidget(self.taps)
        column.addStretch(1)
        area = QScrollArea()
        area.setWidget(inner)
        area.setWidgetResizable(True)
        area.setFrameShape(QFrame.Shape.NoFrame)
        area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        area.setMinimumWidth(inner.minimumSizeHint().width() + area.verticalScrollBar().sizeHint().width() + 4)
        return area

    def _results(self) -> QWidget:
        tabs = QTabWidget()
        tabs.addTab(self.coherence, self.tr("Coherence"))
        tabs.addTab(self.phase, self.tr("Phase"))
        tabs.addTab(self.parts, self.tr("Over time"))
        plots = QSplitter(Qt.Orientation.Vertical)
        plots.addWidget(self.correlation)
        plots.addWidget(tabs)
        plots.setStretchFactor(0, 3)
        plots.setStretchFactor(1, 2)
        inner = QWidget()
        column = QVBoxLayout(inner)
        column.setContentsMargins(4, 0, 0, 0)
        column.setSpacing(3)
        column.addWidget(self.place)
        column.addWidget(self.notes)
        column.addWidget(self.sketch)
        column.addWidget(plots, 1)
        band = (QLabel(self.tr("Band (Hz)")), self.band_low, self.band_high, self.auto_band, self.hum)
        first = _row(*band, self.band_only)
        first.addWidget(self.readout, 1)
        column.addLayout(first)
        hear = (self.listen_a, self.listen_b, self.listen_both)
        column.addLayout(_row(self.suppress, self.restore, self.peak_name, *hear))
        return inner

    def _method(self) -> QGroupBox:
        box = QGroupBox(self.tr("Method"))
        rows = QVBoxLayout(box)
        rows.setContentsMargins(8, 4, 8, 6)
        rows.addLayout(_row(QLabel(self.tr("Weighting")), self.weighting, self.resonances))
        rows.addLayout(_row(self.bend, QLabel(self.tr("speeds hold at (Hz)")), self.reference))
        return box


def _row(*widgets: QWidget) -> QHBoxLayout:
    layout = QHBoxLayout()
    layout.setSpacing(4)
    for widget in widgets:
        layout.addWidget(widget)
    return layout
