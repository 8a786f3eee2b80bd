"""The data page: what the device recorded and what is wrong with it, form, tie points, and the Process button."""

from collections.abc import Sequence
from dataclasses import replace

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QFrame,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QScrollArea,
    QSplitter,
    QTabWidget,
    QVBoxLayout,
    QWidget,
)

from processing.survey import Finding, Route, Stretch, Survey
from widgets.findings_panel import FindingsPanel
from widgets.import_preview import ImportPreview, PreviewedFile
from widgets.method_panel import MethodRow
from widgets.survey_form import SurveyForm
from widgets.tie_point_panel import TiePointPanel


class DataPage(QWidget):
    """Shows a preview before processing, and the same of an open survey after it."""

    process_asked = Signal()
    state_changed = Signal()  # what can be processed, or why not
    survey_edited = Signal(object, str)  # Survey, what was edited: "form", "tie_points" or "route"

    def __init__(self, language: str, methods: dict[str, tuple[MethodRow, ...]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._survey = Survey()
        self.preview = ImportPreview()
        self.findings = FindingsPanel(language)
        self.form = SurveyForm(methods)
        self.tie_points = TiePointPanel()
        self._path = QLabel()
        self._path.setTextFormat(Qt.TextFormat.PlainText)
        self._path.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self._state = QLabel()
        self._state.setWordWrap(True)
        self._process = QPushButton(self.tr("Process"))
        self._process.setObjectName("process")
        self._process.setMinimumSize(200, 52)
        self._process.clicked.connect(self.process_asked)
        self.form.survey_changed.connect(self._on_form)
        self.tie_points.tie_points_changed.connect(self._on_tie_points)
        self._lay_out()
        self.set_survey(Survey(), writable=False)

    def _lay_out(self) -> None:
        scroll = QScrollArea()
        scroll.setWidget(self.form)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        self._tabs = QTabWidget()
        self._tabs.addTab(scroll, self.tr("Form"))
        self._tabs.addTab(self.tie_points, self.tr("Tie points"))
        left = QSplitter(Qt.Orientation.Vertical)
        left.setChildrenCollapsible(False)
        left.addWidget(self.preview)
        left.addWidget(self._titled(self.tr("Findings"), self.findings))
        left.setSizes([300, 260])
        self._left = left
        columns = QSplitter(Qt.Orientation.Horizontal)
        columns.setChildrenCollapsible(False)
        columns.addWidget(left)
        columns.addWidget(self._tabs)
        columns.setSizes([600, 560])
        foot = QHBoxLayout()
        foot.addWidget(self._state, 1)
        foot.addWidget(self._process)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 8, 8, 6)
        layout.addWidget(self._path)
        layout.addWidget(columns, 1)
        layout.addLayout(foot)

    def _titled(self, title: str, widget: QWidget) -> QWidget:
        box = QWidget()
        layout = QVBoxLayout(box)
        layout.setContentsMargins(0, 0, 0, 0)
        label = QLabel(title)
        label.setStyleSheet("font-weight: bold")
        layout.addWidget(label)
        layout.addWidget(widget, 1)
        return box

    @property
    def survey(self) -> Survey:
        """What form and tie points say now."""
        return self._survey

    def set_files(self, files: Sequence[PreviewedFile]) -> None:
        """Show the files; where something is asked about one of them, with room for it."""
        self.preview.set_files(files)
        asked = any(file.mapping is not None or file.needs_raw_form for file in files)
        self._left.setSizes([440, 120] if asked else [300, 260])

    def set_path(self, text: str) -> None:
        """Show which folder this is about."""
        self._path.setText(text)

    def set_survey(self, survey: Survey, *, writable: bool) -> None:
        """Show form and tie points."""
        self._survey = survey
        self.form.set_survey(survey)
        self.form.setEnabled(writable)
        self.tie_points.set_tie_points(survey.tie_points, survey.launch, writable=writable)
        self._tabs.setTabText(1, self.tr("Tie points ({count})").format(count=len(survey.tie_points)))

    def edit_route(self, route: Route | None) -> None:
        """Give the survey another mapped route, or none."""
        self._edit(replace(self._survey, route=route), "route")

    def set_findings(
        self, findings: Sequence[Finding], not_assessed: Sequence[Stretch] = (), notes: Sequence[str] = ()
    ) -> None:
        """Show what was noticed."""
        self.findings.set_content(findings, not_assessed, notes)

    def set_process(self, text: str, *, enabled: bool, state: str = "") -> None:
        """Say what the button does, whether it can, and why (not)."""
        self._process.setText(text)
        self._process.setEnabled(enabled)
        self._state.setText(state)
        self.state_changed.emit()

    def show_form(self) -> None:
        """Bring the form to the front."""
        self._tabs.setCurrentIndex(0)

    def show_tie_points(self) -> None:
        """Bring the tie points to the front."""
        self._tabs.setCurrentIndex(1)

    def _on_form(self, survey: Survey) -> None:
        self._edit(survey, "form")

    def _on_tie_points(self, points: object) -> None:
        assert isinstance(points, tuple)
        self._edit(replace(self._survey, tie_points=points), "tie_points")

    def _edit(self, survey: Survey, what: str) -> None:
        self._survey = survey
        self.survey_edited.emit(survey, what)
