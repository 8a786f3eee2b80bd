"""The sheets of the checks that were made with a live recording, from its journal."""

from pathlib import Path

from processing.errors import LeaklineError
from processing.importing.live_journal import MOST_BYTES
from processing.live.check_sheet import CheckSheet
from processing.storage.journal import JOURNAL_NAME, JournalEvent, read_journal

MOST_SHEETS = 20


def check_sheets(folder: Path) -> tuple[CheckSheet, ...]:
    """Return the sheets in the order of the checks; none where no journal lies in ``folder`` or it cannot be read."""
    journal = folder / JOURNAL_NAME
    if not journal.is_file():
        return ()
    try:
        if journal.stat().st_size > MOST_BYTES:
            return ()
        lines = read_journal(journal)
    except (OSError, LeaklineError):  # the recording itself may be as good as ever
        return ()
    found = [CheckSheet.from_json(line.values) for line in lines if line.event == JournalEvent.CHECK]
    return tuple(sheet for sheet in found if sheet is not None)[-MOST_SHEETS:]
