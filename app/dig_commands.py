"""What was found at a dig, as an undoable command."""

from PySide6.QtGui import QUndoCommand

from app.dig_ledger import DigLedger, write_dig
from processing.review_facts import DigResult


class RecordDig(QUndoCommand):
    """Enters, corrects or (``after`` None) takes back what a dig showed; the survey's log keeps every step.

    It keeps the session, not the ledger, which goes with its window when the language changes.
    """

    def __init__(self, ledger: DigLedger, text: str, number: int, after: DigResult | None) -> None:
        super().__init__(text)
        self._session, self._number = ledger.session, number
        self._before, self._after = ledger.results.get(number), after

    def redo(self) -> None:
        """Qt: write it."""
        if not write_dig(self._session, self._number, self._after):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: write what was there before."""
        if not write_dig(self._session, self._number, self._before):
            self.setObsolete(True)
