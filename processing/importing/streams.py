"""Hands a file of a device's byte stream to a decoder, block by block."""

from collections.abc import Iterator
from pathlib import Path
from typing import Protocol, TypeVar

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.raw import ReadContext

Found = TypeVar("Found")
Found_co = TypeVar("Found_co", covariant=True)
_BLOCK_BYTES = 4 << 20


class Decoder(Protocol[Found_co]):
    """Finds what it knows in a stream, however it is cut."""

    def feed(self, data: bytes) -> Found_co:
        """Return what is complete now."""
        ...

    def finish(self) -> None:
        """Count what is left over: nothing follows."""
        ...


def decoded(path: Path, decoder: Decoder[Found], context: ReadContext) -> Iterator[Found]:
    """Yield what ``decoder`` finds in each block of a file, or in its first ``context.max_bytes``.

    Raises:
        LeaklineError: FILE_UNREADABLE.
    """
    try:
        total = max(path.stat().st_size, 1)
        done = 0
        with path.open("rb") as file:
            while block := file.read(min(_BLOCK_BYTES, context.max_bytes or _BLOCK_BYTES)):
                done += len(block)
                yield decoder.feed(block)
                context.progress.update(done / total, "import_reading")
                if context.max_bytes is not None and done >= context.max_bytes:
                    return
    except OSError as fault:
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=fault.strerror or str(fault)) from None
    decoder.finish()
