"""The spectrum tool beside the sound: take the selection as A or B, see both or their difference, write them out."""

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QCheckBox, QHBoxLayout, QLabel, QPushButton, QScrollArea, QVBoxLayout, QWidget

from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.spectrum_view import SpectrumView

LEAST_HEIGHT = 40


class SpectrumPanel(QWidget):
    """Signals out; it computes nothing itself."""

    use_asked = Signal(str)  # a, b, or around: what lies about A becomes B
    options_changed = Signal()
    export_asked = Signal(str)  # csv or png

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = SpectrumView(theme)
        self._uses = {
            "a": self._button("spectrum_a", self.tr("A: selection"), self.tr("Measure the selected stretch as A")),
            "b": self._button("spectrum_b", self.tr("B: selection"), self.tr("Measure the selected stretch as B")),
            "around": self._button(
                "spectrum_around", self.tr("B: around A"), self.tr("Measure what lies before and after A as B")
            ),
        }
        for what, button in self._uses.items():
            button.clicked.connect(lambda _checked=False, what=what: self.use_asked.emit(what))
        self._difference = self._check("spectrum_difference", self.tr("Difference A − B"))
        self._same = self._check("spectrum_same", self.tr("Same loudness"))
        self._same.setToolTip(self.tr("Take off by how much A is louder than B as a whole: compare the shapes"))
        self._average = QuietCombo()
        self._average.setObjectName("spectrum_average")
        self._average.setAccessibleName(self.tr("Average"))
        self._average.addItem(self.tr("without knocks (median)"), "median")
        self._average.addItem(self.tr("with knocks (mean)"), "mean")
        self._average.setMinimumHeight(LEAST_HEIGHT)
        self._average.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._average.setMinimumContentsLength(6)
        self._average.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._average.currentIndexChanged.connect(lambda _index: self.options_changed.emit())
        self._exports = {
            "csv": self._button("spectrum_csv", "CSV", self.tr("Write the numbers")),
            "png": self._button("spectrum_png", "PNG", self.tr("Write the picture")),
        }
        for kind, button in self._exports.items():
            button.clicked.connect(lambda _checked=False, kind=kind: self.export_asked.emit(kind))
        self._words = QLabel()
        self._words.setObjectName("spectrum_words")
        self._words.setWordWrap(True)
        self._words.setTextFormat(Qt.TextFormat.PlainText)
        self._words.setAlignment(Qt.AlignmentFlag.AlignTop)
        self._words.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._lay_out()
        self.set_words("")
        self.set_able(selection=False, stretches="")

    def _lay_out(self) -> None:
        uses, options, last = QHBoxLayout(), QHBoxLayout(), QHBoxLayout()
        for button in self._uses.values():
            uses.addWidget(button, 1)
        for box in (self._difference, self._same):
            options.addWidget(box, 1)
        last.addWidget(self._average, 2)
        for button in self._exports.values():
            last.addWidget(button, 1)
        self._room = QScrollArea()
        self._room.setWidgetResizable(True)
        self._room.setFrameShape(QScrollArea.Shape.NoFrame)
        self._room.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._room.setWidget(self._words)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        layout.addLayout(uses)
        layout.addWidget(self.view, 3)
        layout.addWidget(self._room, 2)
        layout.addLayout(options)
        layout.addLayout(last)

    @property
    def average(self) -> str:
        """``median`` or ``mean``."""
        return str(self._average.currentData())

    @property
    def wants_difference(self) -> bool:
        """Whether A over B is to be shown instead of both."""
        return self._difference.isChecked()

    @property
    def same_loudness(self) -> bool:
        """Whether only the shapes are to be compared."""
        return self._same.isChecked()

    def set_able(self, *, selection: bool, stretches: str) -> None:
        """Tell whether there is a selection, and which stretches have been chosen, as letters: ``ab`` is both."""
        self._uses["a"].setEnabled(selection)
        self._uses["b"].setEnabled(selection)
        self._uses["around"].setEnabled("a" in stretches)
        both = set("ab") <= set(stretches)
        self._difference.setEnabled(both)
        self._same.setEnabled(both)
        for button in self._exports.values():
            button.setEnabled(bool(stretches))

    def set_words(self, text: str) -> None:
        """Say what is shown, and what may be concluded."""
        self._words.setText(text)
        self._room.setVisible(bool(text))

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)

    def _button(self, name: str, text: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setMinimumHeight(LEAST_HEIGHT)
        button.setMinimumWidth(72)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _check(self, name: str, text: str) -> QCheckBox:
        box = QCheckBox(text)
        box.setObjectName(name)
        box.setMinimumHeight(LEAST_HEIGHT)
        box.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        box.toggled.connect(lambda _on: self.options_changed.emit())
        return box
