"""Choice of a channel, a filter and its settings, and the picture of what the filter makes of the channel."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QPushButton, QVBoxLayout, QWidget

from widgets.channel_view import ChannelView, Load
from widgets.optional_number import OptionalNumber
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.time_cursor import TimeCursor

_HEIGHT = 40


@dataclass(frozen=True)
class Choice:
    """A name for the program, a title and plain words for people."""

    name: str
    title: str
    words: str = ""


@dataclass(frozen=True)
class FilterSetting:
    """A setting of a filter: one of ``options``, or a number between ``low`` and ``high``."""

    name: str
    title: str
    value: str | float
    low: float = 0.0
    high: float = 0.0
    options: tuple[Choice, ...] = ()
    why: str = ""


class ChannelPanel(QWidget):
    """``changed`` asks for another picture: another channel, filter or value of a setting was chosen."""

    changed = Signal()

    def __init__(self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.view = ChannelView(cursor, theme)
        self._settings: dict[str, tuple[FilterSetting, ...]] = {}
        self._values: dict[str, str | float] = {}  # what was chosen, kept from filter to filter
        self._words: dict[str, str] = {}
        self._channel, self._filter = self._combo("channel"), self._combo("channel_filter")
        self._channel.setAccessibleName(self.tr("Channel"))
        self._filter.setAccessibleName(self.tr("Filter"))
        self._channel.currentIndexChanged.connect(self.changed)
        self._filter.currentIndexChanged.connect(self._on_filter)
        self._open = QPushButton(self.tr("Settings"))
        self._open.setCheckable(True)
        self._open.setMinimumHeight(_HEIGHT)
        self._open.toggled.connect(self._show_form)
        self._form = QWidget()
        self._form.hide()
        self._fields = QFormLayout(self._form)
        self._fields.setContentsMargins(0, 0, 0, 0)
        self._fields.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        self._hint, self._figures = QLabel(), QLabel()
        for label in (self._hint, self._figures):
            label.setWordWrap(True)
            label.setTextFormat(Qt.TextFormat.PlainText)
        self._figures.setAccessibleName(self.tr("Figures of the filter"))
        self.view.ready.connect(self._figures.setText)
        top = QHBoxLayout()
        top.addWidget(self._channel, 1)
        top.addWidget(self._open)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(top)
        layout.addWidget(self._filter)
        layout.addWidget(self._hint)
        layout.addWidget(self._form)
        layout.addWidget(self.view, 1)
        layout.addWidget(self._figures)

    @staticmethod
    def _combo(name: str) -> QuietCombo:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setMinimumHeight(_HEIGHT)
        combo.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        combo.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        combo.setMinimumContentsLength(10)
        return combo

    def set_choices(
        self,
        channels: Sequence[Choice],
        filters: Sequence[Choice],
        settings: dict[str, tuple[FilterSetting, ...]],
    ) -> None:
        """Offer these channels and filters, and each filter's ``settings``; asks for nothing yet."""
        self._settings, self._words = settings, {row.name: row.words for row in filters}
        for combo, rows in ((self._channel, channels), (self._filter, filters)):
            combo.blockSignals(True)
            combo.clear()
            for row in rows:
                combo.addItem(row.title, row.name)
            combo.blockSignals(False)
        self._show_filter()

    @property
    def channel(self) -> str:
        """The chosen channel."""
        return str(self._channel.currentData())

    @property
    def filter(self) -> str:
        """The chosen filter."""
        return str(self._filter.currentData())

    @property
    def values(self) -> dict[str, str | float]:
        """The settings of the chosen filter that differ from what was given."""
        given = {row.name: row.value for row in self._settings.get(self.filter, ())}
        return {name: value for name, value in self._values.items() if name in given and value != given[name]}

    def choose(self, channel: str | None = None, filter_name: str | None = None) -> None:
        """Choose a channel, a filter, or both."""
        if channel is not None:
            self._channel.setCurrentIndex(max(0, self._channel.findData(channel)))
        if filter_name is not None:
            self._filter.setCurrentIndex(max(0, self._filter.findData(filter_name)))

    def set_value(self, name: str, value: str | float) -> None:
        """Set one of the chosen filter's settings, as the form does."""
        if self._values.get(name) != value:
            self._values[name] = value
            self._fill_form()
            self.changed.emit()

    def show_channel(self, load: Load | None, told: str = "") -> None:
        """Show a picture, worked out by ``load``, or say why there is none."""
        self._figures.setText(told)
        self.view.load(load)

    def tell(self, text: str) -> None:
        """Say something below the picture."""
        self._figures.setText(text)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self.view.apply_theme(theme)

    def stop(self) -> None:
        """Wait for the work in progress and drop it."""
        self.view.stop()

    # --- the form ---

    def _on_filter(self) -> None:
        self._show_filter()
        self.changed.emit()

    def _show_filter(self) -> None:
        self._hint.setText(self._words.get(self.filter, ""))
        self._fill_form()

    def _show_form(self, shown: bool) -> None:
        self._form.setVisible(shown)

    def _fill_form(self) -> None:
        while self._fields.rowCount():
            self._fields.removeRow(0)
        for row in self._settings.get(self.filter, ()):
            value = self._values.get(row.name, row.value)
            field = self._options(row, str(value)) if row.options else self._number(row, float(value))
            field.setAccessibleName(row.title)
            label = QLabel(row.title)
            label.setToolTip(row.why)
            label.setBuddy(field)
            self._fields.addRow(label, field)

    def _options(self, row: FilterSetting, value: str) -> QWidget:
        combo = self._combo(row.name)
        for option in row.options:
            combo.addItem(option.title, option.name)
        combo.setCurrentIndex(max(0, combo.findData(value)))
        # after the event: the form is made anew, and with it the field that speaks
        combo.currentIndexChanged.connect(
            lambda index: self.set_value(row.name, str(combo.itemData(index))), Qt.ConnectionType.QueuedConnection
        )
        return combo

    def _number(self, row: FilterSetting, value: float) -> QWidget:
        field = OptionalNumber(row.low, row.high)
        field.setObjectName(row.name)
        field.set_value(value)

        def changed() -> None:
            self.set_value(row.name, row.value if field.value is None else field.value)

        field.value_changed.connect(changed, Qt.ConnectionType.QueuedConnection)
        return field
