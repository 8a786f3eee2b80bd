"""A cache of which only what is there is taken: for those who look at another survey, and shall compute nothing."""

from pathlib import Path

from processing.errors import ErrorCode, LeaklineError
from processing.storage.cache import Cache


class KnownCache(Cache):
    """Reads; where an entry is missing or spoilt, the survey counts as not processed."""

    def get(self, step: str, key: str) -> Path:
        """Return the folder of a sound entry.

        Raises:
            LeaklineError: REPEAT_NOT_PROCESSED where there is none.
        """
        entry = super().get(step, key)
        if entry is None:
            raise LeaklineError(ErrorCode.REPEAT_NOT_PROCESSED)
        return entry

    def discard(self, step: str, key: str) -> None:
        """Leave what is spoilt where it is: it is another's survey."""
        del step, key
        raise LeaklineError(ErrorCode.REPEAT_NOT_PROCESSED)

    def _touch(self, entry: Path) -> None:
        """Leave no trace of the look."""
