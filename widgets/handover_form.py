"""Chooses what is handed over besides the report: files, coordinate system, units, names of columns, one zip."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QComboBox,
    QFormLayout,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from processing.importing.route_files.crs import CrsEntry
from processing.quantities import Units
from processing.reporting.options import ColumnScheme, FileKind, HandoverOptions
from widgets.crs_field import CrsField
from widgets.quiet_combo import QuietCombo

HEIGHT = 44
LONGEST_PIPE_ID = 80


class HandoverForm(QWidget):
    """Each change is told at once; ``options`` is what stands on the form."""

    changed = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._boxes = {kind: self._check(kind.value, text) for kind, text in self._kinds()}
        self._zip = self._check("as_zip", self.tr("All of it also as one zip file"))
        self.crs = CrsField()
        self.crs.crs_chosen.connect(self._take_crs)
        self._crs = ""
        self._local = QLabel(
            self.tr("The launch has no known place: map files are in local metres, KML and GPX are left out.")
        )
        self._local.setWordWrap(True)
        self._local.hide()
        self._units = self._choice(
            "handover_units",
            self.tr("Lengths in tables"),
            ((self.tr("metres"), Units.METRIC.value), (self.tr("US survey feet"), Units.US.value)),
        )
        self._columns = self._choice(
            "handover_columns",
            self.tr("Names of columns"),
            (
                (self.tr("Leakline's, with their unit"), ColumnScheme.LEAKLINE.value),
                (self.tr("for asset systems: pipe_id, leak_distance, x, y"), ColumnScheme.ASSET.value),
            ),
        )
        self._pipe_id = QLineEdit()
        self._pipe_id.setObjectName("pipe_id")
        self._pipe_id.setMinimumHeight(HEIGHT)
        self._pipe_id.setMaxLength(LONGEST_PIPE_ID)
        self._pipe_id.setAccessibleName(self.tr("Number of the pipe"))
        self._pipe_id.setPlaceholderText(self.tr("as the asset system has it"))
        self._pipe_id.editingFinished.connect(self.changed)
        self._lay_out()

    # --- what stands on it ---

    @property
    def options(self) -> HandoverOptions:
        """What is chosen now."""
        return HandoverOptions(
            files=frozenset(kind for kind, box in self._boxes.items() if box.isChecked()),
            crs=self._crs,
            units=Units(self._units.currentData()),
            columns=ColumnScheme(self._columns.currentData()),
            pipe_id=self._pipe_id.text().strip(),
            as_zip=self._zip.isChecked(),
        )

    def set_options(self, options: HandoverOptions) -> None:
        """Show these, without telling of a change."""
        self.blockSignals(True)
        for kind, box in self._boxes.items():
            box.setChecked(kind in options.files)
        self._zip.setChecked(options.as_zip)
        self._crs = options.crs
        self._units.setCurrentIndex(self._units.findData(options.units.value))
        self._columns.setCurrentIndex(self._columns.findData(options.columns.value))
        self._pipe_id.setText(options.pipe_id)
        self.blockSignals(False)
        self.crs.set_crs(self._crs)

    def set_systems(
        self,
        entries: Sequence[CrsEntry],
        recent: Sequence[str],
        near: tuple[float, float] | None,
        proposed: str,
    ) -> None:
        """Offer these systems; ``proposed`` is the label of what is taken where nobody chooses, empty without a launch.

        Without a launch there is nothing to choose.
        """
        self._local.setVisible(not proposed)
        self.crs.setVisible(bool(proposed))
        fixed = (("", self.tr("{crs} (as proposed)").format(crs=proposed)),) if proposed else ()
        self.crs.set_choices(entries, fixed, recent, near)
        self.crs.set_crs(self._crs)

    def set_narrow(self, *, narrow: bool) -> None:
        """Put the boxes below each other, or two abreast."""
        self._place_boxes(across=1 if narrow else 2)

    # --- building ---

    def _kinds(self) -> tuple[tuple[FileKind, str], ...]:
        return (
            (FileKind.EXCEL_CSV, self.tr("Excel tables")),
            (FileKind.DECISIONS_CSV, self.tr("Log of decisions")),
            (FileKind.GEOPACKAGE, self.tr("GeoPackage (QGIS)")),
            (FileKind.SHAPEFILE, self.tr("Shapefile (GIS)")),
            (FileKind.KML, self.tr("KML (Google Earth)")),
            (FileKind.GPX, self.tr("GPX (GPS receivers)")),
            (FileKind.DXF, self.tr("DXF (drawing)")),
            (FileKind.RAVEN, self.tr("Raven (sound)")),
        )

    def _check(self, name: str, text: str) -> QCheckBox:
        box = QCheckBox(text)
        box.setObjectName(f"file_{name}")
        box.setMinimumHeight(HEIGHT)
        box.toggled.connect(lambda _on: self.changed.emit())
        return box

    def _choice(self, name: str, label: str, choices: Sequence[tuple[str, str]]) -> QComboBox:
        combo = QuietCombo()
        combo.setObjectName(name)
        combo.setMinimumHeight(HEIGHT)
        combo.setMinimumContentsLength(10)
        combo.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        combo.setAccessibleName(label)
        for text, value in choices:
            combo.addItem(text, value)
        combo.activated.connect(lambda _row: self.changed.emit())
        return combo

    def _lay_out(self) -> None:
        files = QGroupBox(self.tr("Files for others"))
        self._grid = QGridLayout(files)
        self._place_boxes(across=2)
        self._grid.addWidget(self._zip, len(self._boxes), 0, 1, 2)
        self._grid.addLayout(self._all_or_none(), len(self._boxes) + 1, 0, 1, 2)
        places = QGroupBox(self.tr("Coordinate system of the map files"))
        column = QVBoxLayout(places)
        column.addWidget(self._local)
        column.addWidget(self.crs)
        tables = QGroupBox(self.tr("Tables and map files"))
        form = QFormLayout(tables)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapAllRows)
        for label, field in (
            (self.tr("Lengths in tables"), self._units),
            (self.tr("Names of columns"), self._columns),
            (self.tr("Number of the pipe"), self._pipe_id),
        ):
            form.addRow(label, field)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        for group in (files, places, tables):
            layout.addWidget(group)

    def _place_boxes(self, across: int) -> None:
        for i, box in enumerate(self._boxes.values()):
            self._grid.addWidget(box, i // across, i % across)

    def _all_or_none(self) -> QHBoxLayout:
        row = QHBoxLayout()
        for name, text, on in (("all_files", self.tr("All"), True), ("no_files", self.tr("None"), False)):
            button = QPushButton(text)
            button.setObjectName(name)
            button.setMinimumHeight(HEIGHT)
            button.clicked.connect(lambda _checked=False, on=on: self._tick(on=on))
            row.addWidget(button)
        row.addStretch(1)
        return row

    def _tick(self, *, on: bool) -> None:
        self.blockSignals(True)
        for box in (*self._boxes.values(), self._zip):
            box.setChecked(on)
        self.blockSignals(False)
        self.changed.emit()

    def _take_crs(self, crs: str) -> None:
        self._crs = crs
        self.changed.emit()
