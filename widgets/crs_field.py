"""Chooses a coordinate system: a search by code, name or country, with what was used before and what fits in front."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt, Signal
from PySide6.QtWidgets import (
    QHBoxLayout,
    QLabel,
    QLineEdit,
    QListWidget,
    QListWidgetItem,
    QPushButton,
    QVBoxLayout,
    QWidget,
)

from processing.importing.route_files.crs import CrsEntry, search
from widgets.units import quantities

ROW_HEIGHT = 52  # room for two lines
SHOWN = 60
CODE = Qt.ItemDataRole.UserRole


class CrsField(QWidget):
    """``fixed`` are choices that are no entries of the register: code and text."""

    crs_chosen = Signal(str)

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._entries: tuple[CrsEntry, ...] = ()
        self._fixed: tuple[tuple[str, str], ...] = ()
        self._recent: tuple[str, ...] = ()
        self._near: tuple[float, float] | None = None
        self._fitting: dict[str, float] = {}
        self._chosen: str | None = None
        self._current = QLabel()
        self._current.setTextFormat(Qt.TextFormat.PlainText)
        self._current.setWordWrap(True)
        self._search = QLineEdit()
        self._search.setObjectName("crs_search")
        self._search.setMinimumHeight(40)
        self._search.setClearButtonEnabled(True)
        self._search.setPlaceholderText(self.tr("Search: code, name or country"))
        self._search.setAccessibleName(self.tr("Search a coordinate system"))
        self._search.textEdited.connect(self._fill)
        self._search.returnPressed.connect(self._take_first)
        self._list = QListWidget()
        self._list.setObjectName("crs_list")
        self._list.setAccessibleName(self.tr("Coordinate systems"))
        self._list.setMinimumHeight(3 * ROW_HEIGHT)
        self._list.setWordWrap(True)
        self._list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.itemClicked.connect(self._take)
        self._list.itemActivated.connect(self._take)
        self._change = QPushButton(self.tr("Change…"))
        self._change.setObjectName("crs_change")
        self._change.setMinimumHeight(40)
        self._change.setAutoDefault(False)
        self._change.clicked.connect(self._open)
        head = QHBoxLayout()
        head.addWidget(self._current, 1)
        head.addWidget(self._change)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addLayout(head)
        layout.addWidget(self._search)
        layout.addWidget(self._list, 1)

    def set_choices(
        self,
        entries: Sequence[CrsEntry],
        fixed: Sequence[tuple[str, str]],
        recent: Sequence[str],
        near: tuple[float, float] | None,
        fitting: Sequence[tuple[str, float]] = (),
    ) -> None:
        """Offer these; ``near`` (longitude, latitude) brings the systems of that place to the front.

        In ``fitting`` stand those in which the file passes the launch, and by how many metres.
        """
        self._entries, self._fixed, self._recent, self._near = tuple(entries), tuple(fixed), tuple(recent), near
        self._fitting = dict(fitting)
        self._fill()

    def set_crs(self, crs: str | None) -> None:
        """Show what is chosen, without a signal."""
        self._chosen = crs
        text = self.text_of(crs) if crs is not None else self.tr("Not known: choose it below.")
        self._current.setText(text)
        self._current.setStyleSheet("font-weight: bold" if crs is not None else "font-weight: bold; color: #c62828")
        self._show_list(shown=crs is None)
        self._mark()

    def _open(self) -> None:
        self._show_list(shown=True)
        self._search.setFocus()

    def _show_list(self, *, shown: bool) -> None:
        """The list takes half the window: it is there while it is needed."""
        self._search.setVisible(shown)
        self._list.setVisible(shown)
        self._change.setVisible(not shown)

    def text_of(self, crs: str) -> str:
        """Return how a system is called here."""
        named = dict(self._fixed).get(crs)
        if named is not None:
            return named
        entry = next((entry for entry in self._entries if entry.code == crs), None)
        return f"{crs}   {entry.name}" if entry is not None else crs[:80]

    def _fill(self) -> None:
        text = self._search.text()
        words = text.casefold().split()
        fixed = [pair for pair in self._fixed if all(word in pair[1].casefold() for word in words)]
        rows = []
        if not words:
            known = {entry.code: entry for entry in self._entries}
            first = [code for code in dict.fromkeys((*self._fitting, *self._recent)) if code in known]
            rows = [(code, self._named(known[code]), known[code].area) for code in first]
        rows += [(code, name, "") for code, name in fixed]
        taken = {code for code, _, _ in rows}
        found = search(self._entries, text, self._near, SHOWN)
        rows += [(entry.code, self._named(entry), entry.area) for entry in found if entry.code not in taken]
        self._list.clear()
        for code, name, area in rows:
            item = QListWidgetItem(name)
            item.setData(CODE, code)
            item.setToolTip(area or name)
            item.setSizeHint(QSize(0, ROW_HEIGHT))
            self._list.addItem(item)
        self._mark()

    def _named(self, entry: CrsEntry) -> str:
        name = f"{entry.code}   {entry.name}"
        if entry.code not in self._fitting:
            return name
        away = self.tr("{length} from the launch").format(length=quantities().length(self._fitting[entry.code], 0))
        return f"{name}   ({away})"

    def _mark(self) -> None:
        row = next((i for i in range(self._list.count()) if self._list.item(i).data(CODE) == self._chosen), -1)
        self._list.setCurrentRow(row)

    def _take(self, item: QListWidgetItem) -> None:
        self.set_crs(str(item.data(CODE)))
        self.crs_chosen.emit(str(item.data(CODE)))

    def _take_first(self) -> None:
        if self._list.count() and self._search.text().strip():
            self._take(self._list.item(0))
