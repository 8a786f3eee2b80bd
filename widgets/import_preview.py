"""What lies in a device's folder: the files and what each is taken for, first rows, and forms for what is unknown."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtCore import QLocale, Qt, Signal
from PySide6.QtWidgets import (
    QAbstractItemView,
    QHeaderView,
    QLabel,
    QSplitter,
    QStackedWidget,
    QTableWidget,
    QTableWidgetItem,
    QVBoxLayout,
    QWidget,
)

from processing.importing.column_mapping import ColumnMapping
from widgets.column_mapping_table import ColumnMappingTable
from widgets.raw_form import RawForm

ROW_HEIGHT = 36


@dataclass(frozen=True)
class PreviewedFile:
    """One file as the preview shows it; ``mapping`` is there where the operator may say what the columns hold."""

    name: str
    taken_for: str  # in words: "Motion: Xsens MT Manager"
    size: int
    columns: tuple[str, ...] = ()
    rows: tuple[tuple[str, ...], ...] = ()
    mapping: ColumnMapping | None = None
    needs_raw_form: bool = False


class ImportPreview(QWidget):
    """Shows the files; what must be asked about a file is asked below the list."""

    mapping_chosen = Signal(str, object)  # file name, ColumnMapping
    raw_form_answered = Signal(object)  # RawAnswer

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._files: tuple[PreviewedFile, ...] = ()
        self._list = _table([self.tr("File"), self.tr("Taken for"), self.tr("Size")])
        self._list.setAccessibleName(self.tr("Files"))
        self._list.setSelectionBehavior(QAbstractItemView.SelectionBehavior.SelectRows)
        self._list.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self._list.currentCellChanged.connect(self._on_file)
        self._list.horizontalHeader().setSectionResizeMode(1, QHeaderView.ResizeMode.Stretch)
        self._rows = _table([])
        self._rows.setAccessibleName(self.tr("First rows"))
        self._mapping = ColumnMappingTable()
        self._mapping.mapping_changed.connect(self._on_mapping)
        self._raw = RawForm()
        self._raw.answered.connect(self.raw_form_answered)
        self._nothing = QLabel()
        self._nothing.setAlignment(Qt.AlignmentFlag.AlignCenter)
        self._below = QStackedWidget()
        for widget in (self._nothing, self._rows, self._mapping, self._raw):
            self._below.addWidget(widget)
        splitter = QSplitter(Qt.Orientation.Vertical)
        splitter.setChildrenCollapsible(False)
        splitter.addWidget(self._list)
        splitter.addWidget(self._below)
        splitter.setSizes([140, 200])
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(splitter)

    def set_files(self, files: Sequence[PreviewedFile]) -> None:
        """Show these files; the first one that must be asked about, else the first, is selected."""
        before = self._list.currentRow()
        same = [f.name for f in files] == [f.name for f in self._files]
        self._files = tuple(files)
        self._list.setRowCount(len(files))
        for i, file in enumerate(files):
            size = QLocale().formattedDataSize(file.size, 1)
            for column, text in enumerate((file.name, file.taken_for, size)):
                item = QTableWidgetItem(text)
                item.setToolTip(text)
                self._list.setItem(i, column, item)
        asked = next((i for i, f in enumerate(files) if f.mapping is not None or f.needs_raw_form), 0)
        wanted = before if same and before >= 0 else asked
        self._list.setCurrentCell(wanted if files else -1, 0)
        self._show_file(wanted)

    def _on_file(self, row: int, _column: int, _before_row: int, _before_column: int) -> None:
        self._show_file(row)

    def _show_file(self, row: int) -> None:
        file = self._files[row] if 0 <= row < len(self._files) else None
        self._below.setVisible(file is not None and bool(file.rows or file.mapping or file.needs_raw_form))
        if file is None:
            self._below.setCurrentWidget(self._nothing)
        elif file.needs_raw_form:
            self._below.setCurrentWidget(self._raw)
        elif file.mapping is not None:
            if self._mapping.mapping() != file.mapping or self._below.currentWidget() is not self._mapping:
                self._mapping.set_table(file.columns, file.rows, file.mapping)
            self._below.setCurrentWidget(self._mapping)
        elif file.rows:
            self._fill_rows(file)
            self._below.setCurrentWidget(self._rows)
        else:
            self._below.setCurrentWidget(self._nothing)

    def _fill_rows(self, file: PreviewedFile) -> None:
        width = max((len(row) for row in file.rows), default=0)
        self._rows.setColumnCount(max(width, len(file.columns)))
        self._rows.setHorizontalHeaderLabels(list(file.columns))
        self._rows.setRowCount(len(file.rows))
        for i, row in enumerate(file.rows):
            for column, text in enumerate(row):
                self._rows.setItem(i, column, QTableWidgetItem(text))
        self._rows.resizeColumnsToContents()

    def _on_mapping(self, mapping: ColumnMapping) -> None:
        row = self._list.currentRow()
        if 0 <= row < len(self._files):
            self.mapping_chosen.emit(self._files[row].name, mapping)


def _table(titles: list[str]) -> QTableWidget:
    table = QTableWidget(0, len(titles))
    table.setTabKeyNavigation(False)  # Tab leads on; arrows go about the cells
    table.setHorizontalHeaderLabels(titles)
    table.setEditTriggers(QAbstractItemView.EditTrigger.NoEditTriggers)
    table.verticalHeader().hide()
    table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
    table.horizontalHeader().setSectionResizeMode(QHeaderView.ResizeMode.ResizeToContents)
    table.setHorizontalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
    return table
