"""The pipe between the sensors: a table of its sections, and a sketch with the leak in it."""

import math
from collections.abc import Sequence

from PySide6.QtCore import QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import QColor, QPainter, QPaintEvent, QPen
from PySide6.QtWidgets import QGridLayout, QHBoxLayout, QLabel, QPushButton, QSizePolicy, QVBoxLayout, QWidget

from processing.correlation.pipe import MATERIALS, MOST_SECTIONS, OTHER, Pipe, PipeSection, Position
from processing.errors import LeaklineError
from widgets.optional_number import OptionalNumber
from widgets.plot_scale import number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.quiet_combo import QuietCombo

_MM = 1e-3


class SectionRow(QWidget):
    """One section: length, material, diameter, wall, speed; where the speed is left empty it follows from the rest."""

    changed = Signal()

    def __init__(self, names: Sequence[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.length = OptionalNumber(0.01, 20_000.0)
        self.length_sigma = OptionalNumber(0.0, 1000.0, hint="0")
        self.material = QuietCombo()
        for key, name in names:
            self.material.addItem(name, key)
        self.material.currentTextChanged.connect(self.material.setToolTip)  # a long name is cut in its narrow column
        self.material.setToolTip(self.material.currentText())
        self.material.setMinimumSize(92, 40)
        self.material.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Fixed)
        self.diameter = OptionalNumber(0.005, 5.0, factor=_MM)
        self.wall = OptionalNumber(0.0005, 0.5, factor=_MM)
        self.speed = OptionalNumber(100.0, 1600.0)
        self.speed_sigma = OptionalNumber(0.0, 500.0)
        for field in self.fields():
            field.value_changed.connect(self._on_change)
            digits = "000" if field in (self.length_sigma, self.speed_sigma) else "0000"
            field.setMinimumWidth(field.fontMetrics().horizontalAdvance(digits) + 18)
        self.material.currentIndexChanged.connect(self._on_change)

    def fields(self) -> tuple[OptionalNumber, ...]:
        """Return the number fields, left to right."""
        return self.length, self.length_sigma, self.diameter, self.wall, self.speed, self.speed_sigma

    def cells(self) -> tuple[QWidget, ...]:
        """Return all fields, left to right."""
        return self.length, self.length_sigma, self.material, self.diameter, self.wall, self.speed, self.speed_sigma

    def section(self) -> PipeSection:
        """Return what is entered; a length of 0 where there is none yet."""
        return PipeSection(
            length_m=self.length.value or 0.0,
            material=str(self.material.currentData()),
            diameter_m=self.diameter.value,
            wall_m=self.wall.value,
            speed_mps=self.speed.value,
            speed_sigma_mps=self.speed_sigma.value,
            length_sigma_m=self.length_sigma.value or 0.0,
        )

    def set_section(self, section: PipeSection) -> None:
        """Show a section without a signal."""
        self.length.set_value(section.length_m or None)
        self.length_sigma.set_value(section.length_sigma_m or None)
        self.material.blockSignals(True)
        self.material.setCurrentIndex(max(self.material.findData(section.material), 0))
        self.material.blockSignals(False)
        self.diameter.set_value(section.diameter_m)
        self.wall.set_value(section.wall_m)
        self.speed.set_value(section.speed_mps)
        self.speed_sigma.set_value(section.speed_sigma_mps)
        self.show_theory()

    def show_theory(self) -> None:
        """Say in the empty fields which speed follows from material and size."""
        try:
            speed, sigma = self.section().speed()
        except LeaklineError:
            speed, sigma = math.nan, math.nan
        known = math.isfinite(speed)
        self.speed.setPlaceholderText(number_text(speed, 0) if known else self.tr("m/s"))
        self.speed_sigma.setPlaceholderText(number_text(sigma, 0) if known else "")

    def _on_change(self) -> None:
        self.show_theory()
        self.changed.emit()


class PipeTable(QWidget):
    """The sections from A to B; add, remove, and the whole distance as a check."""

    changed = Signal()

    def __init__(self, names: Sequence[tuple[str, str]], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._names = list(names)
        self._rows: list[SectionRow] = []
        self._grid = QGridLayout()
        self._grid.setSpacing(3)
        titles = (
            self.tr("Length m"), self.tr("±"), self.tr("Material"), self.tr("Ø mm"), self.tr("Wall mm"),
            self.tr("Speed m/s"), self.tr("±"),
        )  # fmt: skip
        self._titles = titles
        for column, title in enumerate(titles):
            label = QLabel(title)
            label.setWordWrap(True)
            self._grid.addWidget(label, 0, column)
        for column, stretch in enumerate((4, 2, 6, 3, 3, 3, 2)):
            self._grid.setColumnStretch(column, stretch)
        self._add = QPushButton(self.tr("Add section"))
        self._remove = QPushButton(self.tr("Remove last"))
        self.distance = OptionalNumber(0.01, 20_000.0, hint=self.tr("not measured"))
        self.distance.setAccessibleName(self.tr("A to B (m)"))
        self.distance.setToolTip(self.tr("The whole distance from A to B as measured: a check of the sections"))
        self.distance.value_changed.connect(self.changed)
        buttons = QHBoxLayout()
        for button in (self._add, self._remove):
            button.setMinimumHeight(40)
            buttons.addWidget(button)
        buttons.addWidget(QLabel(self.tr("A to B (m)")))
        buttons.addWidget(self.distance)
        self._add.clicked.connect(self._on_add)
        self._remove.clicked.connect(self._on_remove)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(self._grid)
        layout.addLayout(buttons)
        self.set_pipe(Pipe((PipeSection(100.0, "ductile_iron", 0.15),)))

    def pipe(self) -> Pipe:
        """Return what is entered, checked by nobody."""
        return Pipe(tuple(row.section() for row in self._rows), self.distance.value)

    def set_pipe(self, pipe: Pipe) -> None:
        """Show a pipe without a signal."""
        wanted = pipe.sections or (PipeSection(0.0),)
        while len(self._rows) < len(wanted):
            self._append()
        while len(self._rows) > len(wanted):
            self._drop_last()
        for row, section in zip(self._rows, wanted, strict=True):
            row.set_section(section)
        self.distance.set_value(pipe.distance_m)
        self._show_buttons()

    @property
    def rows(self) -> tuple[SectionRow, ...]:
        """The rows as they stand."""
        return tuple(self._rows)

    def _append(self) -> None:
        row = SectionRow(self._names, self)
        row.hide()  # it only holds its fields together; the grid shows them
        for column, cell in enumerate(row.cells()):
            cell.setAccessibleName(self._titles[column])
            self._grid.addWidget(cell, len(self._rows) + 1, column)
            cell.show()
        row.changed.connect(self.changed)
        self._rows.append(row)

    def _drop_last(self) -> None:
        row = self._rows.pop()
        for cell in row.cells():
            self._grid.removeWidget(cell)
            cell.hide()
            cell.deleteLater()
        row.deleteLater()

    def _on_add(self) -> None:
        last = self._rows[-1].section()
        self._append()
        self._rows[-1].set_section(PipeSection(0.0, last.material, last.diameter_m, last.wall_m))
        self._rows[-1].length.setFocus()
        self._show_buttons()
        self.changed.emit()

    def _on_remove(self) -> None:
        self._drop_last()
        self._show_buttons()
        self.changed.emit()

    def _show_buttons(self) -> None:
        self._remove.setEnabled(len(self._rows) > 1)
        self._add.setEnabled(len(self._rows) < MOST_SECTIONS)


def material_names(names: dict[str, str]) -> list[tuple[str, str]]:
    """Return key and name of each material, the unknown one last."""
    return [(key, names[key]) for key in (*MATERIALS, OTHER)]


class PipeSketch(QWidget):
    """The pipe drawn from A to B, its sections told apart, the leak and its interval in it."""

    def __init__(self, names: dict[str, str], theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._names, self._theme = names, theme
        self._pipe: Pipe | None = None
        self._position: Position | None = None
        self.setAccessibleName(self.tr("Sketch of the pipe"))
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Fixed)

    def show_pipe(self, pipe: Pipe | None, position: Position | None) -> None:
        """Show a pipe and where the leak is; None shows none."""
        self._pipe, self._position = pipe, position
        self.update()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        self.updateGeometry()
        self.update()

    def sizeHint(self) -> QSize:
        """Need three lines of letters."""
        return QSize(400, round(4.0 * self._theme.metrics().height()))

    def paintEvent(self, event: QPaintEvent) -> None:
        """Draw pipe, sensors and leak."""
        del event
        painter = QPainter(self)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        painter.setFont(self._theme.font())
        painter.fillRect(self.rect(), QColor(self._theme.background))
        pipe = self._pipe
        if pipe is not None and pipe.length_m > 0.0:
            self._paint_pipe(painter, pipe)
        painter.end()

    def _x(self, pipe: Pipe, metres: float) -> float:
        return 40.0 + min(max(metres / pipe.length_m, -0.02), 1.02) * (self.width() - 80.0)

    def _paint_pipe(self, painter: QPainter, pipe: Pipe) -> None:
        metrics = self._theme.metrics()
        line = metrics.height()
        middle = 1.95 * line
        start_m = 0.0
        for number, section in enumerate(pipe.sections):
            left, right = self._x(pipe, start_m), self._x(pipe, start_m + section.length_m)
            box = QRectF(left, middle - 0.5 * line, right - left, line)
            painter.setPen(QPen(QColor(self._theme.text), 1.2 * self._theme.line_width))
            painter.setBrush(QColor(self._theme.band if number % 2 == 0 else self._theme.grid))
            painter.drawRect(box)
            painter.setPen(QColor(self._theme.text))
            words = self._words(section)
            shown = metrics.elidedText(words, Qt.TextElideMode.ElideRight, max(right - left - 6, 0.0))
            painter.drawText(
                QRectF(left, middle + 0.6 * line, right - left, 1.2 * line), Qt.AlignmentFlag.AlignCenter, shown
            )
            start_m += section.length_m
        for name, metres in (("A", 0.0), ("B", pipe.length_m)):
            painter.setBrush(QColor(self._theme.accent))
            painter.setPen(QPen(QColor(self._theme.outline), 1.5))
            centre = QPointF(self._x(pipe, metres), middle)
            painter.drawEllipse(centre, 0.75 * line, 0.75 * line)
            painter.setPen(QColor(self._theme.canvas))
            painter.drawText(QRectF(centre.x() - 20, middle - line, 40, 2 * line), Qt.AlignmentFlag.AlignCenter, name)
        if self._position is not None:
            self._paint_leak(painter, pipe, self._position, middle)

    def _paint_leak(self, painter: QPainter, pipe: Pipe, position: Position, middle: float) -> None:
        line = self._theme.metrics().height()
        low, high = self._x(pipe, position.low95_m), self._x(pipe, position.high95_m)
        ground = QColor(self._theme.cursor)
        ground.setAlpha(110)
        painter.fillRect(QRectF(low, middle - 0.6 * line, max(high - low, 3.0), 1.2 * line), ground)
        x = self._x(pipe, position.from_a_m)
        painter.setPen(QPen(QColor(self._theme.cursor), 2.0 * self._theme.line_width))
        painter.drawLine(QPointF(x, middle - 0.8 * line), QPointF(x, middle + 0.8 * line))
        painter.setPen(QColor(self._theme.text))
        width = 160.0
        left = min(max(x - 0.5 * width, 0.0), self.width() - width)
        text = self.tr("{metres} m").format(metres=number_text(position.from_a_m, 2, self.locale()))
        painter.drawText(QRectF(left, 0.0, width, 1.25 * line), Qt.AlignmentFlag.AlignCenter, text)

    def _words(self, section: PipeSection) -> str:
        name = self._names.get(section.material, section.material)
        try:
            speed = section.speed()[0]
        except LeaklineError:
            speed = math.nan
        return self.tr("{length} m {material}, {speed} m/s").format(
            length=number_text(section.length_m, 1, self.locale()),
            material=name,
            speed=number_text(speed, 0, self.locale()) if math.isfinite(speed) else "?",
        )
