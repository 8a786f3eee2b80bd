"""What is told of a run before it is recorded: its name, the pipe, the ball, where it is stored, how long it takes."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QFormLayout, QHBoxLayout, QLabel, QLineEdit, QPlainTextEdit, QPushButton, QWidget

from processing.quantities import METRES_PER_US_FOOT
from processing.survey import Motion, Survey
from widgets import units
from widgets.optional_number import OptionalNumber, parse_number
from widgets.quiet_combo import QuietCombo
from widgets.vocabulary import motion_text

_HEIGHT = 40
_METRES = {"m": 1.0, "ft": METRES_PER_US_FOOT}
ExpectedPlaces = tuple[tuple[str, float | None], ...]


def parse_places(text: str) -> ExpectedPlaces:
    """Return the places of a list, one a line: ``valve 12 120.5`` is the name and its chainage, metres.

    A number followed by ``m`` or ``ft`` says its unit; one without is in that of the window.
    """
    places: list[tuple[str, float | None]] = []
    for line in text.splitlines():
        words = line.replace(";", " ").replace("=", " ").split()
        if not words:
            continue
        unit = _METRES.get(words[-1]) if len(words) > 2 else None
        bare = words[:-1] if unit is not None else words
        chainage_m: float | None = None
        # a lone number at the end of a name is its chainage only where a name is left: "valve 12" is a name
        if len(bare) > 1 and (unit is not None or len(bare) > 2 or any(sign in line for sign in ";=")):
            try:
                chainage_m = parse_number(bare[-1])
            except ValueError:
                chainage_m = None
        if chainage_m is not None:
            chainage_m *= units.length_unit().factor if unit is None else unit
        name = " ".join(bare[:-1] if chainage_m is not None else words)
        places.append((name, chainage_m))
    return tuple(places)


def with_units(text: str) -> str:
    """Return the list with the unit written behind every chainage: so it means the same in another unit's window."""
    lines = []
    for line in text.splitlines():
        told = parse_places(line)
        has_unit = line.split()[-1:] and line.split()[-1] in _METRES
        bare = not told or told[0][1] is None or has_unit
        lines.append(line if bare else f"{line.rstrip()} {units.length_unit().sign}")
    return "\n".join(lines)


class RecordingForm(QWidget):
    """Edits the few fields of a :class:`Survey` that are wanted before launch; the rest of it passes through."""

    changed = Signal()
    folder_asked = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._survey = Survey()
        self._folder = Path()
        self._name = self._line("recording_name", self.tr("Main Street"))
        self._operator = self._line("recording_operator", "")
        self._motion = QuietCombo()
        self._motion.setObjectName("recording_motion")
        self._motion.setMinimumHeight(_HEIGHT)
        for motion in Motion:
            self._motion.addItem(motion_text(motion), motion)
        self._diameter = self._number("recording_diameter", 0.01, 10.0, units.small_unit().factor)
        self._radius = self._number("recording_radius", 0.005, 2.0, units.small_unit().factor)
        self._planned = self._number("recording_planned", 60.0, 86_400.0, 60.0)
        self._places = QPlainTextEdit()
        self._places.setObjectName("recording_places")
        self._places.setTabChangesFocus(True)
        self._places.setMaximumHeight(72)
        self._places.setPlaceholderText(self.tr("valve 12 = 120.5\nhydrant 3 = 240"))
        self._places.setToolTip(self.tr("Places the device will pass, one a line: name = distance from the launch"))
        self._places.textChanged.connect(self.changed)
        self._where = QLabel()
        self._where.setWordWrap(True)
        self.choose = QPushButton(self.tr("Change…"))
        self.choose.setObjectName("recording_folder")
        self.choose.setMinimumHeight(_HEIGHT)
        self.choose.clicked.connect(self.folder_asked)
        self._motion.currentIndexChanged.connect(self._on_edited)
        self._lay_out()

    def _lay_out(self) -> None:
        form = QFormLayout(self)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)  # in the sun's letters it would be too wide
        form.setContentsMargins(0, 0, 0, 0)
        form.addRow(self.tr("Name"), self._name)
        form.addRow(self.tr("Operator"), self._operator)
        form.addRow(self.tr("The device is"), self._motion)
        small = units.small_unit().sign
        form.addRow(self.tr("Rolling radius ({unit})").format(unit=small), self._radius)
        form.addRow(self.tr("Inner diameter ({unit})").format(unit=small), self._diameter)
        form.addRow(self.tr("Planned time (min)"), self._planned)
        form.addRow(self.tr("Places on the way"), self._places)
        row = QHBoxLayout()
        row.addWidget(self._where, 1)
        row.addWidget(self.choose)
        form.addRow(self.tr("Stored in"), row)

    def _line(self, name: str, hint: str) -> QLineEdit:
        line = QLineEdit()
        line.setObjectName(name)
        line.setMinimumHeight(_HEIGHT)
        line.setPlaceholderText(hint)
        line.editingFinished.connect(self._on_edited)
        return line

    def _number(self, name: str, low: float, high: float, factor: float) -> OptionalNumber:
        number = OptionalNumber(low, high, factor=factor, hint=self.tr("unknown"))
        number.setObjectName(name)
        number.value_changed.connect(self._on_edited)
        return number

    # --- values ---

    @property
    def survey(self) -> Survey:
        """What was told."""
        return self._survey

    @property
    def folder(self) -> Path:
        """The folder in which the recording's own folder is made."""
        return self._folder

    @property
    def planned_s(self) -> float:
        """How long the run is going to take; 0 where nobody said."""
        return self._planned.value or 0.0

    @property
    def places(self) -> ExpectedPlaces:
        """The places that are passed, with their chainage where it was told."""
        return parse_places(self._places.toPlainText())

    @property
    def places_text(self) -> str:
        """The places as they were typed, with the unit of each."""
        return with_units(self._places.toPlainText())

    def set_survey(self, survey: Survey) -> None:
        """Show a survey without a signal."""
        self._survey = survey
        self._name.setText(survey.info.name)
        self._operator.setText(survey.info.operator)
        blocked = self._motion.blockSignals(True)
        self._motion.setCurrentIndex(self._motion.findData(survey.device.motion))
        self._motion.blockSignals(blocked)
        self._radius.set_value(survey.device.radius_m)
        self._radius.setEnabled(survey.device.motion is Motion.ROLLING)
        self._diameter.set_value(survey.pipe.diameter_m)

    def set_folder(self, folder: Path) -> None:
        """Show where recordings are stored."""
        self._folder = folder
        self._where.setText(str(folder))
        self._where.setToolTip(str(folder))

    def set_planned(self, planned_s: float) -> None:
        """Show the planned time; 0 leaves it open."""
        self._planned.set_value(planned_s or None)

    def set_places(self, text: str) -> None:
        """Show the list of places without a signal."""
        blocked = self._places.blockSignals(True)
        self._places.setPlainText(text)
        self._places.blockSignals(blocked)

    def set_locked(self, *, locked: bool) -> None:
        """Let nothing be changed that is written already; the places may still be completed."""
        fields: Sequence[QWidget] = (
            self._name, self._operator, self._motion, self._radius, self._diameter, self._planned, self.choose
        )  # fmt: skip
        for field in fields:
            field.setEnabled(not locked)
        self._radius.setEnabled(not locked and self._survey.device.motion is Motion.ROLLING)

    def _on_edited(self) -> None:
        survey = self._survey
        motion = Motion(self._motion.currentData() or Motion.ROLLING)  # Qt hands back a plain text
        edited = replace(
            survey,
            info=replace(survey.info, name=self._name.text().strip(), operator=self._operator.text().strip()),
            device=replace(survey.device, motion=motion, radius_m=self._radius.value),
            pipe=replace(survey.pipe, diameter_m=self._diameter.value),
        )
        self._survey = edited
        self._radius.setEnabled(motion is Motion.ROLLING)
        self.changed.emit()
