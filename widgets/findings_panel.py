"""What the import and the processing noticed, in sentences, and the stretches that could not be assessed."""

from collections.abc import Sequence

from PySide6.QtCore import Qt, Signal
from PySide6.QtGui import QColor, QIcon, QPainter, QPen, QPixmap
from PySide6.QtWidgets import QAbstractItemView, QListWidget, QListWidgetItem, QVBoxLayout, QWidget

from processing import messages
from processing.survey import Channel, Finding, Severity, Stretch
from widgets.vocabulary import clock_text, severity_text

ORDER = (Severity.WARNING, Severity.MASKED, Severity.REPAIRED, Severity.INFO)
SIGNS = {
    Severity.WARNING: ("!", "#b23c00"),
    Severity.MASKED: ("/", "#8a6d3b"),
    Severity.REPAIRED: ("+", "#00805c"),
    Severity.INFO: ("i", "#0072b2"),
}
START_S = Qt.ItemDataRole.UserRole


class FindingsPanel(QWidget):
    """A list, the most important first; choosing a stretch tells where it begins."""

    moment_chosen = Signal(float)  # survey seconds

    def __init__(self, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._language = language
        self._list = QListWidget()
        self._list.setWordWrap(True)
        self._list.setSelectionMode(QAbstractItemView.SelectionMode.SingleSelection)
        self._list.setVerticalScrollMode(QAbstractItemView.ScrollMode.ScrollPerPixel)
        self._list.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._list.setSpacing(3)
        self._list.setAccessibleName(self.tr("Findings"))
        self._list.itemActivated.connect(self._on_item)
        self._list.itemClicked.connect(self._on_item)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._list)

    def set_content(
        self, findings: Sequence[Finding], not_assessed: Sequence[Stretch] = (), notes: Sequence[str] = ()
    ) -> None:
        """Show these findings and stretches; ``notes`` are sentences that come first."""
        self._list.clear()
        for note in notes:
            self._add(note, Severity.WARNING)
        for finding in sorted(findings, key=lambda f: ORDER.index(f.severity)):
            self._add(messages.finding_sentence(finding, self._language), finding.severity)
        for stretch in not_assessed:
            self._add(self._stretch_text(stretch), Severity.MASKED).setData(START_S, stretch.start_s)
        if self._list.count() == 0:
            self._add(self.tr("Nothing to complain about."), Severity.INFO)

    def texts(self) -> list[str]:
        """Return all sentences as shown."""
        return [self._list.item(i).text() for i in range(self._list.count())]

    def _stretch_text(self, stretch: Stretch) -> str:
        what = self.tr("Path") if stretch.channel is Channel.PATH else self.tr("Sound")
        reason = messages.table("reasons", self._language).get(stretch.reason, stretch.reason)
        return self.tr("{what} not assessed from {start} to {end}: {reason}").format(
            what=what, start=clock_text(stretch.start_s), end=clock_text(stretch.end_s), reason=reason
        )

    def _add(self, text: str, severity: Severity) -> QListWidgetItem:
        item = QListWidgetItem(severity_icon(severity), text)
        item.setToolTip(severity_text(severity))
        self._list.addItem(item)
        return item

    def _on_item(self, item: QListWidgetItem) -> None:
        start_s = item.data(START_S)
        if start_s is not None:
            self.moment_chosen.emit(float(start_s))


def severity_icon(severity: Severity, size: int = 22) -> QIcon:
    """Return a round sign with the severity's letter."""
    sign, colour = SIGNS[severity]
    pixmap = QPixmap(size * 2, size * 2)
    pixmap.setDevicePixelRatio(2)
    pixmap.fill(Qt.GlobalColor.transparent)
    painter = QPainter(pixmap)
    painter.setRenderHint(QPainter.RenderHint.Antialiasing)
    painter.setPen(QPen(QColor(colour), 1.5))
    painter.setBrush(QColor(colour))
    painter.drawEllipse(1, 1, size - 2, size - 2)
    font = painter.font()
    font.setBold(True)
    font.setPixelSize(size * 2 // 3)
    painter.setFont(font)
    painter.setPen(QColor("white"))
    painter.drawText(0, 0, size, size, Qt.AlignmentFlag.AlignCenter, sign)
    painter.end()
    return QIcon(pixmap)
