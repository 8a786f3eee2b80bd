"""What the window tells without a box: the state of the survey in a banner, and a line that goes away by itself."""

from PySide6.QtCore import QObject, Qt, QTimer
from PySide6.QtWidgets import QLabel, QWidget

from app.survey_session import SurveySession
from processing import messages
from processing.errors import LeaklineError
from widgets.units import quantities

TOLD_MS = 15_000


class Notices(QObject):
    """Holds both labels; the window lays them out."""

    def __init__(self, language: str, parent: QWidget) -> None:
        super().__init__(parent)
        self._language = language
        self._listening = ""
        self.banner = QLabel(parent)
        self.banner.setObjectName("banner")
        self.banner.setTextFormat(Qt.TextFormat.PlainText)
        self.banner.setWordWrap(True)
        self.told = QLabel(parent)
        self.told.setObjectName("told")
        self.told.setTextFormat(Qt.TextFormat.PlainText)
        self.told.setMargin(6)
        self.told.hide()
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self.told.hide)

    def show_listening(self, text: str, session: SurveySession) -> None:
        """Say in the banner that what is seen of the sound is not all yet; empty when it is."""
        self._listening = text
        self.show_state(session)

    def show_state(self, session: SurveySession) -> None:
        """Say in the banner what must not be overlooked about the open survey."""
        hints = [self._listening] if self._listening else []
        if session.folder is not None:
            if session.survey.info.simulated:
                hints.append(self.tr("Demonstration (simulated): nothing here is a real pipe"))
            if session.reviewer:
                text = self.tr("Second review by {name}, blind: Ctrl+J ends it")
                hints.append(text.format(name=session.reviewer))
            if session.folder.read_only:
                hints.append(self.tr("Read-only: nothing can be changed"))
            if session.results is not None and session.results.not_assessed:
                text = self.tr("Not assessed (hatched): {count}")
                hints.append(text.format(count=len(session.results.not_assessed)))
            if session.orphans:
                text = self.tr("Earlier verdicts without a candidate: {count}, see the data page")
                hints.append(text.format(count=len(session.orphans)))
        self.banner.setText("   ·   ".join(hints))
        self.banner.setVisible(bool(hints))

    def tell(self, text: str) -> None:
        """Show a line for a quarter of a minute."""
        self.told.setText(text)
        self.told.show()
        self._timer.start(TOLD_MS)

    def tell_error(self, error: Exception) -> None:
        """Tell without a box what may come again with every move, such as a stick that was pulled out."""
        if isinstance(error, LeaklineError):
            self.tell(messages.error_sentence(error, self._language, quantities().units))
        else:
            self.tell(str(error))

    def stop(self) -> None:
        """Leave the line as it is: the window closes."""
        self._timer.stop()
