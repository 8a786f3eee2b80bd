"""The table of presets: what the program expects in pipes of each make, to be looked at, changed, added to, reset."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, Qt
from PySide6.QtWidgets import (
    QDialog,
    QDialogButtonBox,
    QFormLayout,
    QHBoxLayout,
    QHeaderView,
    QLabel,
    QLineEdit,
    QPushButton,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from processing.sound.presets import BASES, KINDS, Preset, PresetValue
from widgets.optional_number import OptionalNumber, number_text, parse_number
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import number, warning_colour

HEIGHT = 40
WHAT, VALUE, RANGE, BASIS, SOURCE = range(5)
_NAMES: dict[str, str] = {
    "band_low_hz": str(QT_TRANSLATE_NOOP("Presets", "Leak band from")),
    "band_high_hz": str(QT_TRANSLATE_NOOP("Presets", "Leak band to")),
    "background_m": str(QT_TRANSLATE_NOOP("Presets", "Background within ±")),
    "half_width_low_m": str(QT_TRANSLATE_NOOP("Presets", "Leak's half-width, least (told only)")),
    "half_width_high_m": str(QT_TRANSLATE_NOOP("Presets", "Leak's half-width, most (told only)")),
    "attenuation_low_db_per_m": str(QT_TRANSLATE_NOOP("Presets", "Loss below 400 Hz (told only)")),
    "attenuation_high_db_per_m": str(QT_TRANSLATE_NOOP("Presets", "Loss at 400–800 Hz (told only)")),
    "modulus_gpa": str(QT_TRANSLATE_NOOP("Presets", "Modulus of the wall")),
    "diameter_per_wall": str(QT_TRANSLATE_NOOP("Presets", "Diameter over wall")),
    "size_low_hz": str(QT_TRANSLATE_NOOP("Presets", "Size told from")),
    "size_high_hz": str(QT_TRANSLATE_NOOP("Presets", "Size told to")),
    "small_below_db": str(QT_TRANSLATE_NOOP("Presets", "Small below")),
    "large_above_db": str(QT_TRANSLATE_NOOP("Presets", "Large above")),
    "joint_spacing_m": str(QT_TRANSLATE_NOOP("Presets", "Joint to joint (told only)")),
}
_BASES: dict[str, str] = {
    "measured": str(QT_TRANSLATE_NOOP("Presets", "measured")),
    "theory": str(QT_TRANSLATE_NOOP("Presets", "theory")),
    "convention": str(QT_TRANSLATE_NOOP("Presets", "usual")),
    "own": str(QT_TRANSLATE_NOOP("Presets", "own")),
}


def _words(text: str) -> str:
    return QCoreApplication.translate("Presets", text)


class PresetDialog(QDialog):
    """Edits a copy of the rows; after acceptance ``rows`` holds them. ``shipped`` are what *Reset* goes back to."""

    def __init__(
        self, rows: Sequence[Preset], shipped: Sequence[Preset], current: str, language: str,
        parent: QWidget | None = None,
    ) -> None:  # fmt: skip
        super().__init__(parent)
        self.rows = tuple(rows)
        self._shipped = {row.key: row for row in shipped}
        self._language, self._quiet = language, False
        self.setWindowTitle(self.tr("Table of presets"))
        self.resize(980, 640)
        self._choice = QuietCombo()
        self._choice.setObjectName("preset_choice")
        self._choice.setMinimumHeight(HEIGHT)
        self._choice.currentIndexChanged.connect(self._show)
        self._name, self._materials = QLineEdit(), QLineEdit()
        self._least = OptionalNumber(0.0, 20000.0)
        self._most = OptionalNumber(0.0, 20000.0)
        self._speed = QLabel()
        self._wrong = QLabel()
        self._wrong.setWordWrap(True)
        self._values = self._table()
        self._lay_out()
        self._list(current)

    def _table(self) -> QTableWidget:
        table = QTableWidget(len(KINDS), SOURCE + 1)
        table.setTabKeyNavigation(False)  # Tab leads on; arrows go about the cells
        table.setObjectName("preset_values")
        table.setHorizontalHeaderLabels(
            [self.tr("What"), self.tr("Value"), self.tr("Allowed"), self.tr("Basis"), self.tr("Source")]
        )
        table.verticalHeader().setVisible(False)
        table.verticalHeader().setDefaultSectionSize(HEIGHT)
        table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
        table.horizontalHeader().setSectionResizeMode(SOURCE, QHeaderView.ResizeMode.Stretch)
        table.itemChanged.connect(self._on_item)
        return table

    def _lay_out(self) -> None:
        top = QHBoxLayout()
        top.addWidget(self._choice, 1)
        for text, tip, handler in (
            (self.tr("Add a copy"), self.tr("A row of your own, with the values of this one"), self._add),
            (self.tr("Reset"), self.tr("Back to what came with the program; a row of your own goes"), self._reset),
        ):
            top.addWidget(self._push(text, tip, handler))
        span = QHBoxLayout()
        for field in (self._least, self._most):
            field.setMinimumHeight(HEIGHT)
            field.value_changed.connect(self._on_head)
            span.addWidget(field)
        form = QFormLayout()
        for line, title in ((self._name, self.tr("Name")), (self._materials, self.tr("Materials, with commas"))):
            line.setMinimumHeight(HEIGHT)
            line.setAccessibleName(title)
            line.editingFinished.connect(self._on_head)
            form.addRow(title, line)
        form.addRow(self.tr("Inner diameter from, to (mm)"), span)
        form.addRow(self.tr("Speed of sound (theory)"), self._speed)
        buttons = QDialogButtonBox()
        self._keep = buttons.addButton(self.tr("Save"), QDialogButtonBox.ButtonRole.AcceptRole)
        leave = buttons.addButton(self.tr("Cancel"), QDialogButtonBox.ButtonRole.RejectRole)
        for button in (self._keep, leave):
            button.setMinimumHeight(HEIGHT)
        buttons.accepted.connect(self.accept)
        buttons.rejected.connect(self.reject)
        layout = QVBoxLayout(self)
        layout.addLayout(top)
        layout.addLayout(form)
        layout.addWidget(self._values, 1)
        layout.addWidget(self._wrong)
        layout.addWidget(buttons)

    def _push(self, text: str, tip: str, handler: Callable[[], None]) -> QPushButton:
        button = QPushButton(text)
        button.setToolTip(tip)
        button.setMinimumHeight(HEIGHT)
        button.setAutoDefault(False)
        button.clicked.connect(handler)
        return button

    # --- the chosen row ---

    @property
    def _row(self) -> Preset:
        return self.rows[max(self._choice.currentIndex(), 0)]

    def _list(self, current: str) -> None:
        self._quiet = True
        self._choice.clear()
        for row in self.rows:
            title = row.title(self._language)
            self._choice.addItem(self.tr("{name} (own)").format(name=title) if row.own else title, row.key)
        self._choice.setCurrentIndex(max(self._choice.findData(current), 0))
        self._quiet = False
        self._show()

    def _show(self) -> None:
        if self._quiet:
            return
        self._quiet = True
        row = self._row
        self._name.setText(row.title(self._language))
        self._materials.setText(", ".join(row.materials))
        self._least.set_value(row.diameter_mm[0])
        self._most.set_value(row.diameter_mm[1])
        for line, name in enumerate(KINDS):
            self._show_value(line, name, row.told.get(name))
        self._show_speed()
        self._quiet = False
        self._check()

    def _show_value(self, line: int, name: str, told: PresetValue | None) -> None:
        kind = KINDS[name]
        unit = "" if kind.unit == "1" else f" {kind.unit}"
        allowed = f"{number_text(kind.low)} … {number_text(kind.high)}{unit}"
        texts = (
            _words(_NAMES[name]),
            number_text(told.value) if told is not None else "",
            allowed,
            _words(_BASES[told.basis]) if told is not None else "",
            told.source if told is not None else "",
        )
        for column, text in enumerate(texts):
            item = QTableWidgetItem(text)
            item.setToolTip(text)
            if column not in (VALUE, SOURCE):
                item.setFlags(item.flags() & ~Qt.ItemFlag.ItemIsEditable)
            self._values.setItem(line, column, item)

    def _show_speed(self) -> None:
        speed = self._row.sound_speed_mps
        self._speed.setText(self.tr("{speed} m/s").format(speed=number(speed, 0)) if speed is not None else "–")

    def _put(self, row: Preset) -> None:
        """Take a changed row: it is the user's own from now on."""
        at = max(self._choice.currentIndex(), 0)
        self.rows = (*self.rows[:at], replace(row, own=True), *self.rows[at + 1 :])

    def _on_head(self) -> None:
        if self._quiet:
            return
        row, name = self._row, self._name.text().strip()
        least, most = self._least.value, self._most.value
        changed = replace(
            row,
            materials=tuple(m for part in self._materials.text().split(",") if (m := part.strip())),
            diameter_mm=(least if least is not None else 0.0, most if most is not None else 20000.0),
        )
        if name and name != row.title(self._language):
            changed = replace(changed, name=name, name_tr="")
        if changed != row:
            self._put(changed)
        self._check()

    def _on_item(self, item: QTableWidgetItem) -> None:
        if self._quiet:
            return
        name, row = list(KINDS)[item.row()], self._row
        values = dict(row.told)
        if item.column() == SOURCE:
            if name in values:
                values[name] = replace(values[name], source=item.text().strip())
        else:
            try:
                value = parse_number(item.text())
            except ValueError:
                self._check()
                return
            if value is None:
                values.pop(name, None)
            elif name not in values or values[name].value != value:
                values[name] = PresetValue(value, BASES[-1], "")
        if values != dict(row.told):
            self._put(replace(row, values=values))
            self._quiet = True
            self._show_value(item.row(), name, values.get(name))
            self._show_speed()
            self._quiet = False
        self._check()

    def _add(self) -> None:
        keys = {row.key for row in self.rows}
        count = next(n for n in range(1, len(keys) + 2) if f"own_{n}" not in keys)
        name = self.tr("{name} (copy)").format(name=self._row.title(self._language))
        self.rows = (*self.rows, replace(self._row, key=f"own_{count}", name=name, name_tr="", own=True))
        self._list(f"own_{count}")

    def _reset(self) -> None:
        row = self._row
        shipped = self._shipped.get(row.key)
        kept = [shipped if r.key == row.key else r for r in self.rows]
        self.rows = tuple(r for r in kept if r is not None)
        self._list(row.key)

    def _check(self) -> None:
        """Say what is wrong with the row, and save nothing as long as something is."""
        wrong = []
        self._quiet = True
        for line, name in enumerate(KINDS):
            item, title, kind = self._values.item(line, VALUE), self._values.item(line, WHAT), KINDS[name]
            if item is None or title is None:
                continue
            try:
                value = parse_number(item.text())
                fits = value is None or kind.low <= value <= kind.high
            except ValueError:
                fits = False
            item.setForeground(warning_colour() if not fits else self.palette().text().color())
            if not fits:
                wrong.append(title.text())
        for low, high in (("band_low_hz", "band_high_hz"), ("size_low_hz", "size_high_hz")):
            told = self._row.told
            if low in told and high in told and told[low].value >= told[high].value:
                wrong.append(_words(_NAMES[high]))
        self._quiet = False
        text = self.tr("Not possible: {names}").format(names=", ".join(wrong)) if wrong else ""
        self._wrong.setText(text)
        self._keep.setEnabled(not wrong)
        self._choice.setEnabled(not wrong)
