"""What was found at a dig, as an undoable command."""

from PySide6.QtGui import QUndoCommand

from app.dig_ledger import DigLedger
from processing.review_facts import DigResult


class RecordDig(QUndoCommand):
    """Enters, corrects or (``after`` None) takes back what a dig showed; the survey's log keeps every step."""

    def __init__(self, ledger: DigLedger, text: str, number: int, after: DigResult | None) -> None:
        super().__init__(text)
        self._ledger, self._number = ledger, number
        self._before, self._after = ledger.results.get(number), after

    def redo(self) -> None:
        """Qt: write it."""
        if not self._ledger.write(self._number, self._after):
            self.setObsolete(True)

    def undo(self) -> None:
        """Qt: write what was there before."""
        if not self._ledger.write(self._number, self._before):
            self.setObsolete(True)
