"""Says what the columns of an unknown text file hold: a meaning and a unit for each, with the first rows beside."""

from collections.abc import Sequence

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from processing.importing.column_mapping import ColumnMapping, MappedColumn, Quantity
from processing.importing.units import AUTO, FACTORS
from widgets.optional_number import OptionalNumber
from widgets.quiet_combo import QuietCombo

_QUANTITIES: dict[Quantity, str] = {
    Quantity.TIME: str(QT_TRANSLATE_NOOP("Columns", "time")),
    Quantity.COUNTER: str(QT_TRANSLATE_NOOP("Columns", "sample number")),
    Quantity.ACC_X: str(QT_TRANSLATE_NOOP("Columns", "accelerometer x")),
    Quantity.ACC_Y: str(QT_TRANSLATE_NOOP("Columns", "accelerometer y")),
    Quantity.ACC_Z: str(QT_TRANSLATE_NOOP("Columns", "accelerometer z")),
    Quantity.GYR_X: str(QT_TRANSLATE_NOOP("Columns", "gyroscope x")),
    Quantity.GYR_Y: str(QT_TRANSLATE_NOOP("Columns", "gyroscope y")),
    Quantity.GYR_Z: str(QT_TRANSLATE_NOOP("Columns", "gyroscope z")),
    Quantity.MAG_X: str(QT_TRANSLATE_NOOP("Columns", "magnetometer x")),
    Quantity.MAG_Y: str(QT_TRANSLATE_NOOP("Columns", "magnetometer y")),
    Quantity.MAG_Z: str(QT_TRANSLATE_NOOP("Columns", "magnetometer z")),
    Quantity.QUAT_W: str(QT_TRANSLATE_NOOP("Columns", "quaternion w")),
    Quantity.QUAT_X: str(QT_TRANSLATE_NOOP("Columns", "quaternion x")),
    Quantity.QUAT_Y: str(QT_TRANSLATE_NOOP("Columns", "quaternion y")),
    Quantity.QUAT_Z: str(QT_TRANSLATE_NOOP("Columns", "quaternion z")),
    Quantity.PRESSURE: str(QT_TRANSLATE_NOOP("Columns", "pressure")),
    Quantity.TEMPERATURE: str(QT_TRANSLATE_NOOP("Columns", "temperature")),
}
UNIT_SIGNS = {
    "mps2": "m/s²", "cmps2": "cm/s²", "radps": "rad/s", "dps": "°/s", "mdps": "m°/s", "mradps": "mrad/s", "ut": "µT",
    "nt": "nT", "mt": "mT", "t": "T", "gauss": "Gs", "mgauss": "mGs", "kpa": "kPa", "pa": "Pa", "hpa": "hPa",
    "bar": "bar", "c": "°C", "k": "K", "f": "°F", "us": "µs", "100us": "0.1 ms", "clock": "hh:mm:ss", "1": "–",
}  # fmt: skip
NAME, SAMPLES, MEANING, UNIT = range(4)
SHOWN_SAMPLES = 3


def quantity_text(quantity: Quantity) -> str:
    """Return what a column holds, in the window's language."""
    return QCoreApplication.translate("Columns", _QUANTITIES[quantity])


class ColumnMappingTable(QWidget):
    """One line a column; every choice comes out as a whole new mapping."""

    mapping_changed = Signal(object)  # ColumnMapping

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._names: tuple[str, ...] = ()
        self._quiet = False
        self._table = QTableWidget(0, 4)
        self._table.setTabKeyNavigation(False)  # Tab leads on; arrows go about the cells
        self._table.setHorizontalHeaderLabels(
            [self.tr("Column"), self.tr("First rows"), self.tr("Meaning"), self.tr("Unit")]
        )
        self._table.setAccessibleName(self.tr("Meaning of the columns"))
        self._table.setEditTriggers(QTableWidget.EditTrigger.NoEditTriggers)
        self._table.verticalHeader().hide()
        self._table.verticalHeader().setDefaultSectionSize(44)
        header = self._table.horizontalHeader()
        header.setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        header.setSectionResizeMode(SAMPLES, QHeaderView.ResizeMode.Stretch)
        self._rate = OptionalNumber(0.1, 1e6, hint="100")
        self._rate.value_changed.connect(self._changed)
        self._missing = QLabel()
        self._missing.setWordWrap(True)
        foot = QHBoxLayout()
        foot.addWidget(QLabel(self.tr("Samples a second, if there is no time column")))
        foot.addWidget(self._rate)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._table, 1)
        layout.addLayout(foot)
        layout.addWidget(self._missing)

    def set_table(self, names: Sequence[str], rows: Sequence[Sequence[str]], mapping: ColumnMapping) -> None:
        """Show the columns ``names`` with the first ``rows`` and the present meaning of each."""
        self._quiet = True
        self._names = tuple(names)
        self._rate.set_value(mapping.sample_rate_hz)
        self._table.setRowCount(len(names))
        held = {column.column: column for column in mapping.columns}
        for i, name in enumerate(names):
            samples = "   ".join(row[i] for row in rows[:SHOWN_SAMPLES] if i < len(row))
            self._table.setItem(i, NAME, QTableWidgetItem(name or str(i + 1)))
            self._table.setItem(i, SAMPLES, QTableWidgetItem(samples))
            meaning, unit = QuietCombo(), QuietCombo()
            meaning.addItem(self.tr("not used"), None)
            for quantity in Quantity:
                meaning.addItem(quantity_text(quantity), quantity)
            column = held.get(i)
            meaning.setCurrentIndex(meaning.findData(column.quantity) if column is not None else 0)
            self._fill_units(unit, column.quantity if column is not None else None)
            unit.setCurrentIndex(max(0, unit.findData(column.unit)) if column is not None else 0)
            for combo in (meaning, unit):
                combo.setMinimumHeight(40)
                combo.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
            meaning.activated.connect(lambda _index, row=i: self._on_meaning(row))
            unit.activated.connect(self._changed)
            self._table.setCellWidget(i, MEANING, meaning)
            self._table.setCellWidget(i, UNIT, unit)
        self._quiet = False
        self._show_missing()

    def mapping(self) -> ColumnMapping:
        """Return what is chosen."""
        columns = []
        for i, name in enumerate(self._names):
            quantity = self._combo(i, MEANING).currentData()
            if quantity is not None:
                columns.append(MappedColumn(i, Quantity(quantity), str(self._combo(i, UNIT).currentData()), name))
        return ColumnMapping(tuple(columns), self._rate.value)

    def _combo(self, row: int, column: int) -> QComboBox:
        combo = self._table.cellWidget(row, column)
        assert isinstance(combo, QComboBox)
        return combo

    def _fill_units(self, combo: QComboBox, quantity: Quantity | None) -> None:
        combo.clear()
        combo.setEnabled(quantity is not None)
        if quantity is None:
            return
        combo.addItem(self.tr("find out"), AUTO)
        for unit in FACTORS[quantity.kind]:
            combo.addItem(UNIT_SIGNS.get(unit, unit), unit)

    def _on_meaning(self, row: int) -> None:
        data = self._combo(row, MEANING).currentData()
        chosen = None if data is None else Quantity(data)  # Qt gives a plain string back
        for other in range(len(self._names)):  # a meaning belongs to one column
            if other != row and chosen is not None and self._combo(other, MEANING).currentData() == chosen.value:
                self._combo(other, MEANING).setCurrentIndex(0)
                self._fill_units(self._combo(other, UNIT), None)
        self._fill_units(self._combo(row, UNIT), chosen)
        self._changed()

    def _changed(self) -> None:
        if not self._quiet:
            self._show_missing()
            self.mapping_changed.emit(self.mapping())

    def _show_missing(self) -> None:
        missing = self.mapping().missing
        names = ", ".join(quantity_text(q) for q in missing)
        self._missing.setText(self.tr("Still missing: {names}").format(names=names) if missing else "")
