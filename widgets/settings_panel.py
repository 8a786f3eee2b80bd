"""The settings page: language, looks, quantities, people and the report's company; each change is told at once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import (
    QComboBox,
    QFormLayout,
    QFrame,
    QGroupBox,
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QPushButton,
    QScrollArea,
    QSizePolicy,
    QVBoxLayout,
    QWidget,
)

from widgets.company_form import CompanyForm
from widgets.quiet_combo import QuietCombo

TEXT_SCALES = (100, 125, 150, 175, 200)
HEIGHT = 44
MOST_WIDTH = 900  # pixels: longer lines are hard to follow


@dataclass(frozen=True)
class ShownSettings:
    """What stands on the page; names and values are those of the preferences."""

    language: str = "en"
    theme: str = "light"
    text_scale: int = 100
    units: str = "metric"
    places: str = "chainage"
    report_language: str = ""
    operator: str = ""
    reviewer: str = ""
    company: Mapping[str, str] = field(default_factory=dict)


class SettingsPanel(QWidget):
    """Signals out; it changes nothing itself."""

    changed = Signal(str, object)  # name of a preference, its new value
    company_changed = Signal(object)  # dict[str, str]
    logo_asked = Signal()
    logo_removed = Signal()
    restart_asked = Signal()
    hints_asked = Signal()
    reset_asked = Signal()
    done = Signal()

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._choices: dict[str, QComboBox] = {}
        self._lines: dict[str, QLineEdit] = {}
        self.company = CompanyForm()
        self.company.changed.connect(self.company_changed)
        self.company.logo_asked.connect(self.logo_asked)
        self.company.logo_removed.connect(self.logo_removed)
        inside = QWidget()
        inside.setMaximumWidth(MOST_WIDTH)
        column = QVBoxLayout(inside)
        for box in (self._window_box(), self._quantity_box(), self._people_box(), self.company, self._reset_box()):
            column.addWidget(box)
        column.addStretch(1)
        scroll = QScrollArea()
        scroll.setWidget(inside)
        scroll.setWidgetResizable(True)
        scroll.setFrameShape(QFrame.Shape.NoFrame)
        scroll.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(8, 6, 8, 6)
        layout.addLayout(self._head())
        layout.addWidget(scroll, 1)

    # --- building ---

    def _head(self) -> QHBoxLayout:
        title = QLabel(self.tr("Settings"))
        title.setObjectName("page_title")
        done = self._button("settings_done", self.tr("Back (F7)"))
        done.clicked.connect(self.done)
        head = QHBoxLayout()
        head.addWidget(title, 1)
        head.addWidget(done)
        return head

    def _window_box(self) -> QGroupBox:
        sizes = [(self.tr("{percent} %").format(percent=percent), percent) for percent in TEXT_SCALES]
        box, form = self._box(self.tr("Window"))
        self._choice(form, "language", self.tr("Language"), (("English", "en"), ("Türkçe", "tr")))
        themes = (self.tr("Light"), "light"), (self.tr("Sun: for outdoors"), "sun"), (self.tr("Dark"), "dark")
        self._choice(form, "theme", self.tr("Colours"), themes)
        self._choice(form, "text_scale", self.tr("Size of letters and buttons"), sizes)
        self._restart_words = QLabel(self.tr("The new size takes effect when Leakline starts anew."))
        self._restart_words.setWordWrap(True)
        self._restart = self._button("restart", self.tr("Start anew now"))
        self._restart.clicked.connect(self.restart_asked)
        form.addRow("", self._restart_words)
        form.addRow("", self._restart)
        self.set_restart(needed=False)
        return box

    def _quantity_box(self) -> QGroupBox:
        box, form = self._box(self.tr("Quantities"))
        units = (self.tr("metric: m, mm, bar"), "metric"), (self.tr("US: ft, in, psi"), "us")
        self._choice(form, "units", self.tr("Units"), units)
        places = (self.tr("chainage: 1234.5"), "chainage"), (self.tr("stationing: 1+234.5"), "stationing")
        self._choice(form, "places", self.tr("Places along the pipe"), places)
        words = QLabel(self.tr("For the window and the report. Data files always are in metres, with a point."))
        words.setWordWrap(True)
        form.addRow(words)
        return box

    def _people_box(self) -> QGroupBox:
        box, form = self._box(self.tr("People and report"))
        self._line(form, "operator", self.tr("Operator of new surveys"))
        self._line(form, "reviewer", self.tr("Second reviewer"))
        languages = (self.tr("as the window"), ""), ("English", "en"), ("Türkçe", "tr")
        self._choice(form, "report_language", self.tr("Language of the report"), languages)
        return box

    def _reset_box(self) -> QGroupBox:
        box, form = self._box(self.tr("Start afresh"))
        hints = self._button("show_hints", self.tr("Show the hints again"))
        hints.clicked.connect(self.hints_asked)
        reset = self._button("reset_settings", self.tr("Reset to defaults"))
        reset.clicked.connect(self.reset_asked)
        words = QLabel(self.tr("Language, names, company and the list of surveys stay; looks, units and layouts go."))
        words.setWordWrap(True)
        form.addRow(hints)
        form.addRow(words)
        form.addRow(reset)
        return box

    def _box(self, title: str) -> tuple[QGroupBox, QFormLayout]:
        box = QGroupBox(title)
        form = QFormLayout(box)
        form.setFieldGrowthPolicy(QFormLayout.FieldGrowthPolicy.ExpandingFieldsGrow)
        form.setRowWrapPolicy(QFormLayout.RowWrapPolicy.WrapLongRows)
        return box, form

    def _button(self, name: str, text: str) -> QPushButton:
        button = QPushButton(text)
        button.setObjectName(name)
        button.setMinimumHeight(HEIGHT)
        return button

    def _choice(self, form: QFormLayout, name: str, title: str, choices: Sequence[tuple[str, object]]) -> None:
        combo = QuietCombo()
        combo.setObjectName(f"setting_{name}")
        combo.setMinimumHeight(HEIGHT)
        combo.setAccessibleName(title)
        combo.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        combo.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)
        for text, value in choices:
            combo.addItem(text, value)
        combo.activated.connect(lambda _index, n=name: self.changed.emit(n, self._choices[n].currentData()))
        self._choices[name] = combo
        form.addRow(self._label(title, combo), combo)

    def _line(self, form: QFormLayout, name: str, title: str) -> None:
        line = QLineEdit()
        line.setObjectName(f"setting_{name}")
        line.setMinimumHeight(HEIGHT)
        line.setAccessibleName(title)
        line.editingFinished.connect(lambda n=name: self.changed.emit(n, self._lines[n].text().strip()))
        self._lines[name] = line
        form.addRow(self._label(title, line), line)

    def _label(self, title: str, field: QWidget) -> QLabel:
        label = QLabel(title)
        label.setMinimumHeight(HEIGHT)  # beside the middle of the field, not its top
        label.setBuddy(field)
        return label

    # --- what it is told ---

    def show_settings(self, shown: ShownSettings) -> None:
        """Show these without a signal."""
        for name, combo in self._choices.items():
            combo.setCurrentIndex(max(0, combo.findData(getattr(shown, name))))
        for name, line in self._lines.items():
            line.setText(getattr(shown, name))
        self.company.set_values(shown.company)

    def set_restart(self, *, needed: bool) -> None:
        """Say that a new size waits for the next start, and offer it."""
        self._restart_words.setVisible(needed)
        self._restart.setVisible(needed)
