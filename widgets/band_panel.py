"""The tool that asks in which band the selected stretch stands out, shows the map, and hands the band on."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QLabel, QPushButton, QVBoxLayout, QWidget

from widgets.band_map import BandMapView
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import frequency_text

_HEIGHT = 40


class BandPanel(QWidget):
    """Signals out; it computes nothing itself."""

    measure_asked = Signal()
    band_taken = Signal(float, float)  # Hz

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = BandMapView(theme)
        self.view.band_clicked.connect(self._choose)
        self.view.pointed.connect(self._point)
        self._words: dict[str, str] = {}
        self._band: tuple[float, float] | None = None
        self._result_text = ""
        self._method = QuietCombo()
        self._method.setObjectName("band_method")
        self._method.setAccessibleName(self.tr("How to ask"))
        self._method.setMinimumHeight(_HEIGHT)
        self._method.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self._method.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self._method.setMinimumContentsLength(10)
        self._method.currentIndexChanged.connect(self._on_method)
        self._measure = self._button("band_measure", self.tr("Measure the selection"))
        self._measure.clicked.connect(self.measure_asked)
        self._take = self._button("band_take", self.tr("Take as the leak band"))
        self._take.clicked.connect(self._hand_on)
        self._hint, self._result = QLabel(), QLabel()
        self._result.setObjectName("band_result")
        for label in (self._hint, self._result):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._method)
        layout.addWidget(self._hint)
        layout.addWidget(self.view, 1)
        layout.addWidget(self._result)
        # above one another: side by side, in bold letters, they would push the page wider than a field laptop
        layout.addWidget(self._measure)
        layout.addWidget(self._take)
        self.set_able(selection=False)
        self.show_band(None)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(_HEIGHT)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def set_methods(self, methods: Sequence[tuple[str, str, str]]) -> None:
        """Offer these ways to ask: name, title, and what each finds, in plain words."""
        self._words = {name: words for name, _, words in methods}
        self._method.blockSignals(True)
        self._method.clear()
        for name, title, _ in methods:
            self._method.addItem(title, name)
        self._method.blockSignals(False)
        self._hint.setText(self._words.get(self.method, ""))

    @property
    def method(self) -> str:
        """The chosen way to ask."""
        return str(self._method.currentData())

    def choose(self, method: str) -> None:
        """Choose a way to ask."""
        self._method.setCurrentIndex(max(0, self._method.findData(method)))

    def set_able(self, *, selection: bool) -> None:
        """Tell whether there is a stretch to measure."""
        self._measure.setEnabled(selection)

    def tell(self, text: str) -> None:
        """Say what was found, or why nothing could be."""
        self._result_text = text
        self._result.setText(text)

    def show_band(self, band: tuple[float, float] | None) -> None:
        """Offer this band to be taken; None offers none."""
        self._band = band
        self._take.setEnabled(band is not None)
        tip = self.tr("{low} to {high}: the sound is measured again in this band")
        low, high = (frequency_text(hz) for hz in band) if band is not None else ("", "")
        self._take.setToolTip(tip.format(low=low, high=high) if band is not None else "")

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)

    def _on_method(self) -> None:
        self._hint.setText(self._words.get(self.method, ""))
        if self._measure.isEnabled():
            self.measure_asked.emit()

    def _choose(self, low_hz: float, high_hz: float) -> None:
        self.show_band((low_hz, high_hz))
        chosen = self.tr("Chosen by hand: {low} to {high}.")
        self.tell(chosen.format(low=frequency_text(low_hz), high=frequency_text(high_hz)))

    def _point(self, text: str) -> None:
        self._result.setText(text or self._result_text)

    def _hand_on(self) -> None:
        if self._band is not None:
            self.band_taken.emit(*self._band)
