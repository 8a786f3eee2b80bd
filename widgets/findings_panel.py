"""What the import and the processing noticed, in sentences, and the stretches that could not be assessed."""

from collections.abc import Sequence
from html import escape

from PySide6.QtCore import Qt, QUrl, Signal
from PySide6.QtGui import QColor, QPainter, QPen, QPixmap, QTextDocument
from PySide6.QtWidgets import QTextBrowser, QVBoxLayout, QWidget

from processing import messages
from processing.survey import Channel, Finding, Severity, Stretch
from widgets.units import quantities
from widgets.vocabulary import clock_text, severity_text

ORDER = (Severity.WARNING, Severity.MASKED, Severity.REPAIRED, Severity.INFO)
SIGNS = {
    Severity.WARNING: ("!", "#b23c00"),
    Severity.MASKED: ("/", "#8a6d3b"),
    Severity.REPAIRED: ("+", "#00805c"),
    Severity.INFO: ("i", "#0072b2"),
}
SIGN_PIXELS = 22
MOMENT = "moment"  # the scheme of links that lead to a moment


class FindingsPanel(QWidget):
    """A list, the most important first; choosing a stretch tells where it begins."""

    moment_chosen = Signal(float)  # survey seconds

    def __init__(self, language: str, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._language = language
        self._rows: list[tuple[Severity, str, float | None]] = []
        self._browser = QTextBrowser()
        self._browser.setOpenLinks(False)
        self._browser.setAccessibleName(self.tr("Findings"))
        self._browser.anchorClicked.connect(self._on_link)
        layout = QVBoxLayout(self)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self._browser)

    def set_content(
        self, findings: Sequence[Finding], not_assessed: Sequence[Stretch] = (), notes: Sequence[str] = ()
    ) -> None:
        """Show these findings and stretches; ``notes`` are sentences that come first."""
        self._rows = [(Severity.WARNING, note, None) for note in notes]
        for finding in sorted(findings, key=lambda f: ORDER.index(f.severity)):
            self._rows.append(
                (finding.severity, messages.finding_sentence(finding, self._language, quantities().units), None)
            )
        for stretch in not_assessed:
            self._rows.append((Severity.MASKED, self._stretch_text(stretch), stretch.start_s))
        if not self._rows:
            self._rows.append((Severity.INFO, self.tr("Nothing to complain about."), None))
        document = self._browser.document()
        self._browser.clear()
        for severity in Severity:
            url = QUrl(f"sign:{severity.value}")
            document.addResource(QTextDocument.ResourceType.ImageResource.value, url, severity_pixmap(severity))
        lines = "".join(self._line(*row) for row in self._rows)
        self._browser.setHtml(f"<table cellpadding='4' width='100%'>{lines}</table>")

    def texts(self) -> list[str]:
        """Return all sentences as shown."""
        return [text for _, text, _ in self._rows]

    def _line(self, severity: Severity, text: str, start_s: float | None) -> str:
        image = f"<img src='sign:{severity.value}' width='{SIGN_PIXELS}' title='{escape(severity_text(severity))}'>"
        what, do = messages.what_and_do(text)
        grave = severity in (Severity.WARNING, Severity.MASKED)
        words = f"{escape(what)}{messages.THEN}<b>{escape(do)}</b>" if do and grave else escape(text)
        if start_s is not None:
            words = f"<a href='{MOMENT}:{start_s!r}'>{words}</a>"
        return f"<tr><td width='{SIGN_PIXELS + 4}'>{image}</td><td style='vertical-align: middle'>{words}</td></tr>"

    def _stretch_text(self, stretch: Stretch) -> str:
        what = self.tr("Path") if stretch.channel is Channel.PATH else self.tr("Sound")
        reason = messages.reason_sentence(stretch.reason, self._language)
        return self.tr("{what} not assessed from {start} to {end}: {reason}").format(
            what=what, start=clock_text(stretch.start_s), end=clock_text(stretch.end_s), reason=reason
        )

    def _on_link(self, url: QUrl) -> None:
        if url.scheme() == MOMENT:
            self.moment_chosen.emit(float(url.path()))


def severity_pixmap(severity: Severity, size: int = SIGN_PIXELS) -> QPixmap:
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
    return pixmap
