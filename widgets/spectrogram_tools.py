"""The row of tools over the spectrogram: what is shown, contrast, selecting, and the leak band in figures."""

from collections.abc import Sequence

from PySide6.QtCore import QEvent, QSize, Qt, QTimer, Signal, SignalInstance
from PySide6.QtGui import QAction, QActionGroup, QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QPushButton, QSpinBox, QToolButton, QWidget

from widgets.color_maps import COLOR_MAPS
from widgets.plot_scale import ScaleKind
from widgets.quiet_combo import QuietCombo
from widgets.spectrogram_picture import Plane

LEAST_HEIGHT = 40
MENU_STYLE = "QMenu::item { padding: 9px 28px 9px 28px; }"  # for gloves


class SpectrogramTools(QWidget):
    """Signals out; each says what the operator wants, and the setters show how it is."""

    plane_chosen = Signal(str)
    scale_chosen = Signal(str)
    colours_chosen = Signal(str)
    axis_asked = Signal()
    contrast_asked = Signal()
    select_toggled = Signal(bool)
    band_chosen = Signal(float, float)  # Hz
    band_reset_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._plane = QuietCombo()
        self._plane.setObjectName("plane")
        self._plane.setAccessibleName(self.tr("What is shown"))
        self._plane.setMinimumHeight(LEAST_HEIGHT)
        self._plane.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        for plane, text in (
            (Plane.SHORT, self.tr("short events")),
            (Plane.STEADY, self.tr("steady sounds")),
            (Plane.EXCESS, self.tr("over the background")),
        ):
            self._plane.addItem(text, plane.value)
        self._plane.currentIndexChanged.connect(lambda _row: self.plane_chosen.emit(self._plane.currentData()))
        self._plane.currentTextChanged.connect(self._plane.setToolTip)  # on the smallest screens its words are cut
        self._plane.setToolTip(self._plane.currentText())
        self.menu = self._build_menu()
        self._more = QToolButton()
        self._more.setObjectName("spectrogram_menu")
        self._more.setText(self.tr("Axes, colours"))
        self._more.setToolTip(self._more.text())
        self._more.setMenu(self.menu)
        self._more.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self._more.setMinimumHeight(LEAST_HEIGHT)
        self._contrast = self._button(
            "contrast", self.tr("Contrast"), self.tr("Choose the colours' range by what is visible")
        )
        self._contrast.clicked.connect(self.contrast_asked)
        self._select = self._button(
            "select", self.tr("Select"), self.tr("Drag a rectangle to measure it (else Shift and drag)")
        )
        self._select.setCheckable(True)
        self._select.toggled.connect(self.select_toggled)
        self._low, self._high = (
            self._hertz("band_low", self.tr("Lower edge")),
            self._hertz("band_high", self.tr("Upper edge")),
        )
        self._reset = self._button("band_reset", self.tr("Reset"), self.tr("Look for leaks in the usual band"))
        self._reset.clicked.connect(self.band_reset_asked)
        self._band_hz = (0.0, 0.0)
        layout = QHBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.setSpacing(4)
        for widget in (self._plane, self._more, self._contrast, self._select):
            layout.addWidget(widget)
        layout.addStretch(1)
        name = QLabel(self.tr("Leak band"))
        edges: tuple[QWidget, ...] = (name, self._low, QLabel("–"), self._high, self._reset)
        for part in edges:
            layout.addWidget(part)
        # in the sun's bold letters the row is wider than a field laptop: what has another way makes room
        self._sparing = (name, self._contrast, self._reset)
        layout.setSizeConstraint(QHBoxLayout.SizeConstraint.SetNoConstraint)

    def minimumSizeHint(self) -> QSize:
        """Qt: the row without what it can spare."""
        spared = sum(w.sizeHint().width() + 4 for w in self._sparing if not w.isHidden())
        size = super().minimumSizeHint()
        return QSize(size.width() - spared, size.height())

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: show what fits."""
        super().resizeEvent(event)
        self._make_room()

    def changeEvent(self, event: QEvent) -> None:
        """Qt: another theme has wider letters."""
        super().changeEvent(event)
        if event.type() in (QEvent.Type.FontChange, QEvent.Type.StyleChange):
            QTimer.singleShot(0, self, self._make_room)

    def _make_room(self) -> None:
        layout = self.layout()
        if layout is None:
            return
        for widget in self._sparing:
            widget.show()
        for widget in self._sparing:
            if layout.minimumSize().width() <= self.width():
                return
            widget.hide()

    def _build_menu(self) -> QMenu:
        menu = QMenu(self)
        menu.setStyleSheet(MENU_STYLE)
        scales = (
            (ScaleKind.LOG, self.tr("Frequencies by octaves")),
            (ScaleKind.LINEAR, self.tr("Frequencies evenly")),
            (ScaleKind.MEL, self.tr("Frequencies as the ear hears (mel)")),
        )
        self._scales = self._choices(menu, [(kind.value, text) for kind, text in scales], self.scale_chosen)
        menu.addSeparator()
        names = {
            "viridis": self.tr("Green colours"),
            "magma": self.tr("Red colours"),
            "cividis": self.tr("Yellow and blue"),
            "grey": self.tr("Grey, for print"),
        }
        self._colours = self._choices(menu, [(name, names[name]) for name in COLOR_MAPS], self.colours_chosen)
        menu.addSeparator()
        self._axis = menu.addAction(self.tr("Metres along the pipe"))
        self._axis.setCheckable(True)
        self._axis.triggered.connect(lambda _on: self.axis_asked.emit())
        return menu

    def _choices(self, menu: QMenu, rows: Sequence[tuple[str, str]], chosen: SignalInstance) -> dict[str, QAction]:
        group, actions = QActionGroup(menu), {}
        for name, text in rows:
            action = menu.addAction(text)
            action.setCheckable(True)
            group.addAction(action)
            action.triggered.connect(lambda _on, name=name: chosen.emit(name))
            actions[name] = action
        return actions

    # --- how it is ----------------------------------------------------------------------------------------------

    def show_looks(self, plane: str, scale: str, colours: str) -> None:
        """Show what is chosen; emits nothing."""
        self._plane.blockSignals(True)
        self._plane.setCurrentIndex(max(0, self._plane.findData(plane)))
        self._plane.blockSignals(False)
        for name, actions in ((scale, self._scales), (colours, self._colours)):
            if name in actions:
                actions[name].setChecked(True)

    def show_axis(self, *, metres: bool, able: bool) -> None:
        """Show whether the axis counts metres, and whether it could."""
        self._axis.setChecked(metres)
        self._axis.setEnabled(able)

    def show_band(self, low_hz: float, high_hz: float) -> None:
        """Show the leak band; emits nothing."""
        self._band_hz = (low_hz, high_hz)
        for box, value in ((self._low, low_hz), (self._high, high_hz)):
            box.blockSignals(True)
            box.setValue(round(value))
            box.blockSignals(False)

    def set_band_able(self, *, able: bool) -> None:
        """Say whether the band may be changed."""
        for widget in (self._low, self._high, self._reset):
            widget.setEnabled(able)

    def set_selecting(self, *, on: bool) -> None:
        """Show whether a plain drag selects."""
        self._select.setChecked(on)

    def _take_band(self) -> None:
        low, high = sorted((float(self._low.value()), float(self._high.value())))
        if (low, high) != tuple(float(round(v)) for v in self._band_hz) and high >= 1.05 * low:
            self.band_chosen.emit(low, high)
        else:
            self.show_band(*self._band_hz)

    def _button(self, name: str, text: str, tip: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setToolTip(tip)
        button.setMinimumHeight(LEAST_HEIGHT)
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        return button

    def _hertz(self, name: str, title: str) -> QSpinBox:
        box = QSpinBox()
        box.setObjectName(name)
        box.setAccessibleName(title)
        box.setToolTip(title)
        box.setRange(10, 200_000)
        box.setSingleStep(50)
        box.setSuffix(self.tr(" Hz"))
        box.setGroupSeparatorShown(False)
        box.setButtonSymbols(QSpinBox.ButtonSymbols.NoButtons)
        box.setMinimumHeight(LEAST_HEIGHT)
        box.setKeyboardTracking(False)
        box.editingFinished.connect(self._take_band)
        return box
