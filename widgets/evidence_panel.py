"""Why a leak: what a candidate may be, what speaks for and against, its spectrum and its rise and fall, at a glance."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFrame, QLabel, QPushButton, QScrollArea, QSizePolicy, QVBoxLayout, QWidget

from widgets.evidence_plots import ChancesBar, SmallPlot, SmallPlotView, Weighed, WeighedStrip
from widgets.plot_theme import Theme

ROWS = 6


@dataclass(frozen=True)
class EvidenceRow:
    """One plain sentence with the figure behind it."""

    sentence: str
    weighed: Weighed


@dataclass(frozen=True)
class ShownEvidence:
    """All that the panel shows of one candidate."""

    title: str
    size: str  # a sentence; empty where the size is not known
    chances: tuple[tuple[str, float], ...]
    rows: tuple[EvidenceRow, ...]
    spectrum: SmallPlot
    rise: SmallPlot
    places: int
    may_be_known: bool = False  # whether it may be told that this is a leak of known flow


class EvidencePanel(QWidget):
    """Shows the evidence on one candidate; it is told everything and knows nothing."""

    known_leak_asked = Signal()  # this is a leak of known flow, or is one no more

    def __init__(self, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._title = self._label("evidence_title")
        self._size = self._label("evidence_size")
        self._about = self._label("evidence_about")
        self._chances = ChancesBar(theme)
        self._spectrum = SmallPlotView(theme, "Hz")
        self._rise = SmallPlotView(theme, "m")
        self._sentences = [self._label(f"evidence_row_{i}") for i in range(ROWS)]
        self._strips = [WeighedStrip(theme) for _ in range(ROWS)]
        self._known = QPushButton(self.tr("Known leak…"))
        self._known.setObjectName("known_leak")
        self._known.setMinimumHeight(40)
        self._known.setToolTip(self.tr("A tap of measured flow: other leaks are sized beside it"))
        self._known.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._known.clicked.connect(self.known_leak_asked.emit)
        inner = QWidget()
        layout = QVBoxLayout(inner)
        layout.setContentsMargins(2, 2, 2, 2)
        layout.setSpacing(2)
        layout.addWidget(self._title)
        layout.addWidget(self._chances)
        layout.addWidget(self._spectrum)
        layout.addWidget(self._rise)
        layout.addWidget(self._size)
        layout.addWidget(self._known)
        for sentence, strip in zip(self._sentences, self._strips, strict=True):
            layout.addWidget(sentence)
            layout.addWidget(strip)
        layout.addWidget(self._about)
        layout.addStretch(1)
        self._area = QScrollArea()
        self._area.setFrameShape(QFrame.Shape.NoFrame)
        self._area.setWidgetResizable(True)
        self._area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._area.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self._area.setWidget(inner)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(0, 0, 0, 0)
        whole.addWidget(self._area)
        self.show_evidence(None, "")

    def _label(self, name: str) -> QLabel:
        label = QLabel()
        label.setObjectName(name)
        label.setWordWrap(True)
        label.setTextFormat(Qt.TextFormat.PlainText)
        label.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Minimum)
        return label

    def apply_theme(self, theme: Theme) -> None:
        """Draw everything in this theme."""
        for piece in (self._chances, self._spectrum, self._rise, *self._strips):
            piece.apply_theme(theme)

    def show_evidence(self, shown: ShownEvidence | None, waiting: str) -> None:
        """Show the evidence, or the sentence ``waiting`` where there is none (yet)."""
        self._title.setText(shown.title if shown is not None else waiting)
        for piece in (self._chances, self._spectrum, self._rise):
            piece.setVisible(shown is not None)
        rows: Sequence[EvidenceRow] = shown.rows[:ROWS] if shown is not None else ()
        for i, (sentence, strip) in enumerate(zip(self._sentences, self._strips, strict=True)):
            sentence.setVisible(i < len(rows))
            strip.setVisible(i < len(rows))
            if i < len(rows):
                sentence.setText(rows[i].sentence)
                strip.show_weighed(rows[i].weighed)
        self._size.setVisible(shown is not None and bool(shown.size))
        self._about.setVisible(shown is not None)
        self._known.setVisible(shown is not None and shown.may_be_known)
        if shown is None:
            return
        self._size.setText(shown.size)
        about = self.tr("Dot: here. Bar: {count} places elsewhere (half within). + speaks for a leak, − against.")
        self._about.setText(about.format(count=shown.places))
        self._chances.show_chances(shown.chances)
        self._spectrum.show_plot(self.tr("Level over the surroundings; blue: 95 % of them"), shown.spectrum)
        self._rise.show_plot(self.tr("Rise and fall along the pipe, with the fit"), shown.rise)
