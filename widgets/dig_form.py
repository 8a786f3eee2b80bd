"""The form of a dig: what was found, where, and what else the crew saw; it shows at once what follows from it."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QDate, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractButton,
    QButtonGroup,
    QDateEdit,
    QFormLayout,
    QFrame,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QVBoxLayout,
    QWidget,
)

from processing.review_facts import MEASURED_SIGMA_M, DigFinding, DigResult
from widgets import units
from widgets.optional_number import OptionalNumber
from widgets.quiet_combo import QuietCombo

HEIGHT = 48  # pixels: for gloves
TAPE, CHAINAGE, COORDINATES = "tape", "chainage", "coordinates"
AWAY, TOWARDS = 1, -1


@dataclass(frozen=True)
class DigAnswer:
    """What was typed; the distance is never negative, ``direction`` 1 away from the launch, −1 towards, 0 unsaid."""

    finding: DigFinding | None = None
    measured: str = TAPE
    distance_m: float | None = None
    direction: int = 0
    chainage_m: float | None = None
    coordinates: str = ""
    sigma_m: float | None = None
    across_m: float | None = None
    depth_m: float | None = None
    flow_lpm: float | None = None
    cause: str = ""
    date: str = ""
    dug_by: str = ""
    note: str = ""
    statement: int = 0  # row of the offered statements


class DigForm(QWidget):
    """Signals out; knows nothing of paths: ``set_told`` is what its owner makes of the answer."""

    edited = Signal()
    save_asked = Signal()
    clear_asked = Signal()
    photo_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._filling = False
        self._missed = self._entered = False
        self._title = QLabel()
        self._title.setTextFormat(Qt.TextFormat.PlainText)
        self._title.setWordWrap(True)
        self._title.setStyleSheet("font-weight: bold")
        self._statements = self._combo(self.tr("Dug by the report of"))
        self._findings = QButtonGroup(self)
        self._measured = QButtonGroup(self)
        self._directions = QButtonGroup(self)
        self._make_fields()
        self._told = QLabel()
        self._told.setWordWrap(True)
        self._told.setTextFormat(Qt.TextFormat.PlainText)
        self._told.setObjectName("dig_told")
        self._save = self._button(self.tr("Save this dig"), "dig_save")
        self._save.clicked.connect(self._on_save)
        self._clear = self._button(self.tr("Take back"), "dig_clear")
        self._clear.clicked.connect(self.clear_asked)
        self._photo = self._button(self.tr("Add photo…"), "dig_photo")
        self._photo.clicked.connect(self.photo_asked)
        self._lay_out()
        self._show_fields()

    def _make_fields(self) -> None:
        length, flow = units.length_unit(), units.flow_unit()
        self._distance = self._number(0.0, 1000.0, length.factor, self.tr("distance"))
        self._chainage = self._number(-100.0, 1e6, length.factor, self.tr("chainage"))
        self._coordinates = QLineEdit()
        self._coordinates.setMinimumHeight(HEIGHT)
        self._coordinates.setMaxLength(80)
        self._coordinates.setPlaceholderText(self.tr("latitude longitude, or east north"))
        self._coordinates.textEdited.connect(self._on_edit)
        self._sigma = self._number(0.01, 100.0, length.factor, self.tr("as usual"))
        self._across = self._number(-100.0, 100.0, length.factor, self.tr("not measured"))
        self._depth = self._number(0.0, 50.0, length.factor, self.tr("not measured"))
        self._flow = self._number(0.0, 1e6, flow.factor, self.tr("not measured"))
        self._cause = self._combo(self.tr("Cause"), editable=True)
        self._crew = self._combo(self.tr("Dug by"), editable=True)
        self._date = QDateEdit()
        self._date.setDisplayFormat("dd.MM.yyyy" if units.quantities().language == "tr" else "d MMM yyyy")
        self._date.setCalendarPopup(True)
        self._date.setMinimumHeight(HEIGHT)
        self._date.setAccessibleName(self.tr("Day of the dig"))
        self._date.setDate(QDate.currentDate())
        self._date.dateChanged.connect(self._on_edit)
        self._note = QLineEdit()
        self._note.setMinimumHeight(HEIGHT)
        self._note.setMaxLength(2000)
        self._note.setAccessibleName(self.tr("Note"))
        self._note.textEdited.connect(self._on_edit)

    def _lay_out(self) -> None:
        findings = self._choices(
            self._findings,
            ((self.tr("Leak"), "leak"), (self.tr("Something else"), "other"), (self.tr("Nothing"), "nothing")),
            "dig_finding_",
        )
        self._how = QWidget()
        self._how.setLayout(
            self._choices(
                self._measured,
                (
                    (self.tr("By tape"), TAPE),
                    (self.tr("By chainage"), CHAINAGE),
                    (self.tr("By coordinates"), COORDINATES),
                ),
                "dig_by_",
            )
        )
        directions = self._choices(
            self._directions,
            ((self.tr("◀ towards the launch"), "towards"), (self.tr("away from it ▶"), "away")),
            "dig_",
        )
        self._tape = QWidget()
        tape = QVBoxLayout(self._tape)
        tape.setContentsMargins(0, 0, 0, 0)
        line = QHBoxLayout()
        line.addWidget(self._distance, 1)
        line.addWidget(QLabel(self.tr("{unit} from the stated place").format(unit=units.length_unit().sign)), 2)
        tape.addLayout(line)
        tape.addLayout(directions)
        unit = units.length_unit().sign
        form = QFormLayout()
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        self._form = form
        for title, field in (
            (self.tr("Dug by the report of"), self._statements),
            (self.tr("Found at"), self._tape),
            (self.tr("Chainage ({unit})").format(unit=unit), self._chainage),
            (self.tr("Coordinates"), self._coordinates),
            (self.tr("Measured to ± ({unit})").format(unit=unit), self._sigma),
            (self.tr("Beside the path ({unit})").format(unit=unit), self._across),
            (self.tr("Depth ({unit})").format(unit=unit), self._depth),
            (self.tr("Flow ({unit})").format(unit=units.flow_unit().sign), self._flow),
            (self.tr("Cause"), self._cause),
            (self.tr("Day of the dig"), self._day()),
            (self.tr("Dug by"), self._crew),
            (self.tr("Note"), self._note),
        ):
            form.addRow(title, field)
            if not field.accessibleName():
                field.setAccessibleName(title)
        buttons = QHBoxLayout()
        for button in (self._save, self._clear, self._photo):
            buttons.addWidget(button)
        fields = QWidget()
        inner = QVBoxLayout(fields)
        inner.setContentsMargins(0, 0, 0, 0)
        inner.addWidget(self._how)
        inner.addLayout(form)
        inner.addStretch(1)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._title)
        layout.addLayout(findings)
        layout.addWidget(scrolled(fields), 1)
        layout.addWidget(self._told)  # what follows, and the buttons, are always in sight
        layout.addLayout(buttons)

    def _day(self) -> QWidget:
        """Return the day between buttons for the day before and after: the calendar's arrow is nothing for a glove."""
        day = QWidget()
        row = QHBoxLayout(day)
        row.setContentsMargins(0, 0, 0, 0)
        for sign, days, name in (("−", -1, self.tr("A day earlier")), ("+", 1, self.tr("A day later"))):
            button = self._button(sign, f"dig_day_{days}")
            button.setFixedWidth(HEIGHT)
            button.setAccessibleName(name)
            button.setToolTip(name)
            button.setAutoRepeat(True)
            button.clicked.connect(
                lambda _checked=False, step=days: self._date.setDate(self._date.date().addDays(step))
            )
            row.addWidget(button)
        row.insertWidget(1, self._date, 1)
        return day

    # --- content ---

    @property
    def answer(self) -> DigAnswer:
        """What the fields say."""
        finding = self._checked(self._findings, "dig_finding_")
        away, towards = (self._of(self._directions, f"dig_{name}").isChecked() for name in ("away", "towards"))
        return DigAnswer(
            DigFinding(finding) if finding else None,
            self._checked(self._measured, "dig_by_") or TAPE,
            self._distance.value,
            AWAY if away else TOWARDS if towards else 0,
            self._chainage.value,
            self._coordinates.text().strip(),
            self._sigma.value,
            self._across.value,
            self._depth.value,
            self._flow.value,
            self._cause.currentText().strip(),
            self._date.date().toString(Qt.DateFormat.ISODate),
            self._crew.currentText().strip(),
            self._note.text().strip(),
            max(self._statements.currentIndex(), 0),
        )

    def set_choices(self, causes: Sequence[str], crews: Sequence[str]) -> None:
        """Offer what was typed before."""
        self._filling = True
        for combo, texts in ((self._cause, causes), (self._crew, crews)):
            kept = combo.currentText()
            combo.clear()
            combo.addItems(list(texts))
            combo.setEditText(kept)
        self._filling = False

    def set_leak(
        self, title: str, statements: Sequence[str], chosen: int, result: DigResult | None, *, missed: bool
    ) -> None:
        """Show a leak's dig, or an empty form; of a ``missed`` leak nothing was stated to measure from."""
        self._filling = True
        self._missed, self._entered = missed, result is not None
        self._title.setText(title)
        self._statements.clear()
        self._statements.addItems(list(statements))
        self._statements.setCurrentIndex(chosen)
        self._fill(result if result is not None else DigResult(0, DigFinding.LEAK), entered=result is not None)
        self._filling = False
        self._show_fields()

    def _fill(self, result: DigResult, *, entered: bool) -> None:
        for button in self._findings.buttons():
            self._check(button, on=entered and button.objectName() == f"dig_finding_{result.finding.value}")
        if not entered and self._missed:
            self._check(self._of(self._findings, "dig_finding_leak"), on=True)
        measured = CHAINAGE if self._missed else TAPE  # whatever it was found by is kept as an offset
        self._check(self._of(self._measured, f"dig_by_{measured}"), on=True)
        off = result.off_along_m
        self._distance.set_value(None if off is None else abs(off))
        for name, on in (("away", off is not None and off > 0.0), ("towards", off is not None and off < 0.0)):
            self._check(self._of(self._directions, f"dig_{name}"), on=on)
        stated = result.stated_chainage_m
        self._chainage.set_value(None if off is None or stated is None else stated + off)
        self._coordinates.clear()
        rough = MEASURED_SIGMA_M[COORDINATES] if result.measured == COORDINATES else None
        self._sigma.set_value(rough if result.sigma_m is None else result.sigma_m)
        self._across.set_value(result.off_across_m)
        self._depth.set_value(result.depth_m)
        self._flow.set_value(result.flow_lpm)
        self._cause.setEditText(result.cause)
        if result.dug_by or entered:  # the next dig of the day is most often the same crew's
            self._crew.setEditText(result.dug_by)
        day = QDate.fromString(result.date, Qt.DateFormat.ISODate)
        if day.isValid():
            self._date.setDate(day)
        self._note.setText(result.note)
        self._clear.setEnabled(entered)
        self._save.setText(self.tr("Save correction") if entered else self.tr("Save this dig"))

    def set_chainage(self, chainage_m: float) -> None:
        """Show the chainage of a leak that nobody had stated."""
        self._chainage.set_value(chainage_m)
        self._on_edit()

    def set_told(self, text: str) -> None:
        """Say what follows from the answer, or what it still lacks."""
        self._told.setText(text)

    def set_writable(self, writable: bool) -> None:
        """Let nobody type into a survey that cannot be changed."""
        self.setEnabled(writable)

    def focus_finding(self) -> None:
        """Put the keyboard where the answer begins."""
        chosen = self._findings.checkedButton()
        (chosen or self._findings.buttons()[0]).setFocus(Qt.FocusReason.ShortcutFocusReason)

    # --- inner workings ---

    def _on_edit(self, *_values: object) -> None:
        if not self._filling:
            self._show_fields()
            self.edited.emit()

    def _on_save(self) -> None:
        self.flush()
        self.save_asked.emit()

    def flush(self) -> None:
        """Take what is still being typed."""
        focus = self.focusWidget()
        if isinstance(focus, QLineEdit):
            focus.clearFocus()

    def _show_fields(self) -> None:
        measured = self._checked(self._measured, "dig_by_") or TAPE
        nothing = self._checked(self._findings, "dig_finding_") == DigFinding.NOTHING.value
        placed = self._missed and self._entered  # the mark stands where it was found
        self._how.setVisible(not nothing and not placed)
        self._of(self._measured, f"dig_by_{TAPE}").setVisible(not self._missed)
        self._form.setRowVisible(self._statements, self._statements.count() > 1 and not self._missed)
        self._form.setRowVisible(self._tape, measured == TAPE and not nothing and not self._missed)
        self._form.setRowVisible(self._chainage, measured == CHAINAGE and not nothing and not placed)
        self._form.setRowVisible(self._coordinates, measured == COORDINATES and not nothing and not placed)
        self._form.setRowVisible(self._sigma, not nothing and not self._missed)
        for field in (self._across, self._flow, self._cause):
            self._form.setRowVisible(field, not nothing)

    def _choices(self, group: QButtonGroup, choices: Sequence[tuple[str, str]], prefix: str) -> QHBoxLayout:
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        for text, name in choices:
            button = self._button(text, f"{prefix}{name}")
            button.setCheckable(True)
            group.addButton(button)
            row.addWidget(button, 1)
        group.buttonClicked.connect(self._on_edit)
        return row

    def _checked(self, group: QButtonGroup, prefix: str) -> str:
        button = group.checkedButton()
        return button.objectName().removeprefix(prefix) if button is not None else ""

    def _check(self, button: QAbstractButton, *, on: bool) -> None:
        group = button.group()
        exclusive = group.exclusive()
        group.setExclusive(False)  # else the last one pressed could not be let go
        if on and exclusive:
            for other in group.buttons():
                other.setChecked(False)
        button.setChecked(on)
        group.setExclusive(exclusive)

    def _of(self, group: QButtonGroup, name: str) -> QAbstractButton:
        return next(b for b in group.buttons() if b.objectName() == name)

    def _button(self, text: str, name: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(HEIGHT)
        button.setAutoDefault(False)
        return button

    def _number(self, low: float, high: float, factor: float, hint: str) -> OptionalNumber:
        field = OptionalNumber(low, high, factor=factor, hint=hint)
        field.setMinimumHeight(HEIGHT)
        field.setAccessibleName(hint)
        field.value_changed.connect(self._on_edit)
        return field

    def _combo(self, title: str, *, editable: bool = False) -> QuietCombo:
        combo = QuietCombo()
        combo.setAccessibleName(title)
        combo.setMinimumHeight(HEIGHT)
        combo.setSizeAdjustPolicy(QuietCombo.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        combo.setMinimumContentsLength(12)
        combo.setEditable(editable)
        if editable:
            combo.setInsertPolicy(QuietCombo.InsertPolicy.NoInsert)
            combo.editTextChanged.connect(self._on_edit)
        else:
            combo.currentIndexChanged.connect(self._on_edit)
        return combo


def scrolled(widget: QWidget) -> QScrollArea:
    """Return a widget in an area that scrolls up and down where there is too little room."""
    area = QScrollArea()
    area.setWidget(widget)
    area.setWidgetResizable(True)
    area.setFrameShape(QFrame.Shape.NoFrame)
    area.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
    return area
