"""The window of the route import: map and list of the file's lines, coordinate system, direction, accuracy, length."""

from collections.abc import Sequence
from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QCheckBox,
    QDialog,
    QFrame,
    QGridLayout,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSplitter,
    QVBoxLayout,
    QWidget,
)

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files.building import FROM_LAUNCH, BuiltRoute
from processing.importing.route_files.crs import CrsEntry, crs_name
from processing.importing.route_files.lines import RouteFile
from processing.importing.route_files.proposal import RouteAnswer, RouteProposal, pieces_of
from processing.survey import Finding, Survey
from widgets import units
from widgets.crs_field import CrsField
from widgets.optional_number import OptionalNumber
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo
from widgets.route_map import RouteMap
from widgets.section_table import SectionTable


class RouteDialog(QDialog):
    """Asks; whoever opened it answers each ``asked`` with :meth:`show_proposal`. ``taken`` gives the route."""

    asked = Signal(object)  # RouteAnswer: what would that give?
    taken = Signal(object)  # BuiltRoute

    def __init__(self, language: str, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setWindowTitle(self.tr("Import route"))
        self.setWindowModality(Qt.WindowModality.WindowModal)
        self._language = language
        self._answer = RouteAnswer()
        self._proposal: RouteProposal | None = None
        self._chosen: frozenset[int] = frozenset()
        self._pipe_m: float | None = None
        self.map = RouteMap(theme)
        self.map.section_clicked.connect(self._on_section)
        self.table = SectionTable()
        self.table.setObjectName("route_sections")
        self.table.sections.toggled.connect(self._on_section)
        self.crs = CrsField()
        self.crs.crs_chosen.connect(lambda crs: self._change(crs=crs, reverse=None))
        self._build_fields()
        self._lay_out()

    # --- building ---

    def _build_fields(self) -> None:
        self._connect = self._button("route_connect", self.tr("Add what lies between"))
        self._connect.setToolTip(self.tr("Choose also the lines that connect the chosen ones by the shortest way"))
        self._connect.clicked.connect(lambda: self._change(connect=True))
        self._gap = OptionalNumber(0.0, 1000.0, factor=units.length_unit().factor)
        self._gap.setObjectName("route_gap")
        self._gap.value_changed.connect(self._on_gap)
        self._reverse = self._button("route_reverse", self.tr("Turn round"))
        self._reverse.clicked.connect(self._on_reverse)
        self._clip = QCheckBox(self.tr("Cut off what lies before the launch"))
        self._clip.setObjectName("route_clip")
        self._clip.setMinimumHeight(36)
        self._clip.clicked.connect(lambda checked: self._change(clip=checked))
        self._swap = QCheckBox(self.tr("East and north are swapped"))
        self._swap.setObjectName("route_swap")
        self._swap.setMinimumHeight(36)
        self._swap.clicked.connect(lambda checked: self._change(swap=checked, reverse=None))
        self._unit = QuietCombo()
        self._unit.setObjectName("route_unit")
        self._unit.setMinimumHeight(40)
        for text, unit_m in (
            (self.tr("as in the coordinate system"), None),
            (self.tr("metres"), 1.0),
            (self.tr("millimetres"), 0.001),
            (self.tr("centimetres"), 0.01),
            (self.tr("feet"), 0.3048),
            (self.tr("US survey feet"), 1200.0 / 3937.0),
            (self.tr("inches"), 0.0254),
        ):
            self._unit.addItem(text, unit_m)
        self._unit.activated.connect(lambda _index: self._change(unit_m=self._unit.currentData(), reverse=None))
        self._sigma = OptionalNumber(0.01, 100.0, factor=units.length_unit().factor)
        self._sigma.setObjectName("route_sigma")
        self._sigma.value_changed.connect(self._on_sigma)
        self._sigma.setToolTip(self.tr("How far the pipe may lie from the line of the map (one standard deviation)"))
        self._told = QLabel()
        self._told.setObjectName("route_told")
        self._told.setWordWrap(True)
        self._told.setTextFormat(Qt.TextFormat.PlainText)
        self._length = QLabel()
        self._length.setObjectName("readout")
        self._cancel = self._button("route_cancel", self.tr("Cancel"))
        self._cancel.clicked.connect(self.reject)
        self._take = self._button("route_take", self.tr("Use as route"))
        self._take.setMinimumSize(180, 52)
        self._cancel.setMinimumHeight(52)
        self._take.setDefault(True)
        self._take.clicked.connect(self._on_take)

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(44)
        button.setAutoDefault(False)
        return button

    def _lay_out(self) -> None:
        column = QWidget()
        boxes = QVBoxLayout(column)
        boxes.setContentsMargins(4, 0, 4, 0)
        boxes.addWidget(self._lines_box(), 1)
        boxes.addWidget(self._crs_box())
        boxes.addWidget(self._course_box())
        scroll = QScrollArea()
        scroll.setWidget(column)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        scroll.setMinimumWidth(column.minimumSizeHint().width() + 24)
        splitter = QSplitter(Qt.Orientation.Horizontal)
        splitter.setChildrenCollapsible(False)
        splitter.addWidget(self.map)
        splitter.addWidget(scroll)
        splitter.setSizes([700, 460])
        told = QVBoxLayout()
        told.addWidget(self._length)
        told.addWidget(self._told)
        foot = QHBoxLayout()
        foot.addLayout(told, 1)
        foot.addWidget(self._cancel)
        foot.addWidget(self._take)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 8)
        layout.addWidget(splitter, 1)
        layout.addLayout(foot)

    def _lines_box(self) -> QGroupBox:
        box = QGroupBox(self.tr("Lines: tap those that the run followed"))
        grid = QGridLayout(box)
        self.table.setMinimumHeight(150)
        grid.addWidget(self.table, 0, 0, 1, 3)
        grid.addWidget(self._connect, 1, 0)
        grid.addWidget(
            _labelled(self.tr("Join gaps up to ({unit})").format(unit=units.length_unit().sign), self._gap), 1, 1
        )
        grid.addWidget(self._gap, 1, 2)
        self._gap.setMaximumWidth(80)
        return box

    def _crs_box(self) -> QGroupBox:
        box = QGroupBox(self.tr("Coordinate system"))
        grid = QGridLayout(box)
        grid.addWidget(self.crs, 0, 0, 1, 2)
        self._unit_label = _labelled(self.tr("The numbers are in"), self._unit)
        grid.addWidget(self._unit_label, 1, 0)
        grid.addWidget(self._unit, 1, 1)
        grid.addWidget(self._swap, 2, 0, 1, 2)
        return box

    def _course_box(self) -> QGroupBox:
        box = QGroupBox(self.tr("Direction and accuracy"))
        grid = QGridLayout(box)
        grid.addWidget(self._reverse, 0, 0)
        grid.addWidget(
            _labelled(self.tr("Map accuracy ± 1σ ({unit})").format(unit=units.length_unit().sign), self._sigma), 0, 1
        )
        grid.addWidget(self._sigma, 0, 2)
        self._sigma.setMaximumWidth(80)
        grid.addWidget(self._clip, 1, 0, 1, 3)
        return box

    # --- what it is told ---

    def set_file(
        self,
        file: RouteFile,
        answer: RouteAnswer,
        survey: Survey,
        systems: Sequence[CrsEntry],
        recent: Sequence[str],
        near: tuple[float, float] | None,
        fitting: Sequence[tuple[str, float]] = (),
    ) -> None:
        """Begin with a file; :meth:`show_proposal` for ``answer`` follows."""
        self.setWindowTitle(self.tr("Import route: {file}").format(file=file.path.name))
        self._answer, self._pipe_m = answer, survey.pipe.length_m
        fixed = []
        if file.crs is not None and file.crs not in {entry.code for entry in systems} | {"local"}:
            fixed.append((file.crs, self.tr("As in the file: {name}").format(name=crs_name(file.crs))))
        fixed.append((FROM_LAUNCH, self.tr("Drawing's own metres: the line begins at the launch")))
        fixed.append(("local", self.tr("Metres east and north of the launch")))
        self.crs.set_choices(systems, fixed, recent, near, fitting)
        drawing = file.crs is None
        self._unit.setVisible(drawing)
        self._unit_label.setVisible(drawing)
        self._findings = [self._sentence(finding) for finding in file.findings]
        self._show_answer()

    def _sentence(self, finding: Finding) -> str:
        return messages.finding_sentence(finding, self._language, units.quantities().units)

    def show_proposal(self, proposal: RouteProposal) -> None:
        """Show what the answer gives; one that is no longer asked for is passed over."""
        if replace(proposal.answer, connect=False) != replace(self._answer, connect=False):
            return
        before, self._proposal = self._proposal, proposal
        self._chosen = proposal.chosen
        kept = before is not None and len(before.planes) == len(proposal.planes) and self._same_place(before, proposal)
        if proposal.answer.connect:
            self._answer = replace(self._answer, pieces=pieces_of(proposal, proposal.chosen), connect=False)
        self.map.set_lines(proposal.planes, keep_view=kept)
        self.map.set_route(proposal.chosen, proposal.way, proposal.launch)
        self.table.sections.set_sections(proposal.sections, proposal.lengths_m, proposal.chosen)
        if before is None and proposal.chosen:
            self.table.scrollTo(self.table.sections.index(min(proposal.chosen), 0))
        self._connect.setEnabled(len(proposal.chosen) > 1 and proposal.built is None)
        self._show_built(proposal.built, proposal.error)

    def _same_place(self, before: RouteProposal, now: RouteProposal) -> bool:
        return (before.answer.crs, before.answer.unit_m, before.answer.swap) == (
            now.answer.crs,
            now.answer.unit_m,
            now.answer.swap,
        )

    def _show_answer(self) -> None:
        answer = self._answer
        self.crs.set_crs(answer.crs)
        self._unit.setCurrentIndex(max(0, self._unit.findData(answer.unit_m)))
        self._swap.setChecked(answer.swap)
        self._clip.setChecked(answer.clip)
        self._sigma.set_value(answer.sigma_m)
        self._gap.set_value(answer.tolerance_m)

    def _show_built(self, built: BuiltRoute | None, error: LeaklineError | None) -> None:
        self._take.setEnabled(built is not None)
        self._reverse.setEnabled(built is not None)
        self._clip.setEnabled(built is not None and built.launch_off_m is not None)
        if built is None:
            self._length.setText("")
            self._told.setText(self._why_not(error))
            return
        told = units.quantities()
        texts = [self.tr("Route: {length}").format(length=told.length(built.length_m))]
        if self._pipe_m is not None:
            differs = self.tr("surveyed length {length}, difference {difference}")
            off_m = built.length_m - self._pipe_m
            difference = f"{'+' if off_m > 0.0 else ''}{told.length(off_m)}"
            texts.append(differs.format(length=told.length(self._pipe_m), difference=difference))
        if built.launch_off_m is not None:
            texts.append(self.tr("{off} from the launch").format(off=told.length(built.launch_off_m)))
        self._length.setText("   ·   ".join(texts))
        found = [
            *self._findings,
            *(self._sentence(f) for f in built.findings),
        ]
        self._told.setText("\n".join(found))

    def _why_not(self, error: LeaklineError | None) -> str:
        if error is None:
            return ""
        if error.code is ErrorCode.ROUTE_NEEDS_CRS:
            return self.tr("The file does not say its coordinate system: choose it, or the drawing's own metres.")
        if error.code is ErrorCode.ROUTE_NOT_ONE_LINE and error.params.get("lines") == 0:
            return self.tr("Tap the line that the run followed, in the map or in the list.")
        return messages.error_sentence(error, self._language, units.quantities().units)

    # --- what the operator does ---

    def _on_section(self, section: int) -> None:
        if self._proposal is None:
            return
        self._chosen ^= {section}  # of what was tapped last, which may not be answered yet
        self.map.set_route(self._chosen, self._proposal.way[:0], self._proposal.launch)
        self.table.sections.set_sections(self._proposal.sections, self._proposal.lengths_m, self._chosen)
        self._change(pieces=pieces_of(self._proposal, self._chosen), reverse=None)

    def _on_gap(self) -> None:
        self._change(tolerance_m=self._gap.value or 0.0)

    def _on_sigma(self) -> None:
        if self._sigma.value is not None:
            self._change(sigma_m=self._sigma.value)

    def _on_reverse(self) -> None:
        if self._proposal is not None and self._proposal.built is not None:
            self._change(reverse=not self._proposal.built.reversed)

    def _change(self, **values: object) -> None:
        self._answer = replace(self._answer, **values)  # type: ignore[arg-type]
        self._take.setEnabled(False)  # until it is known what this gives
        self.asked.emit(self._answer)

    def _on_take(self) -> None:
        if self._proposal is not None and self._proposal.built is not None:
            built = self._proposal.built
            self.accept()
            self.taken.emit(built)


def _labelled(text: str, widget: QWidget) -> QLabel:
    label = QLabel(text)
    label.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
    label.setBuddy(widget)
    widget.setAccessibleName(text)
    return label
