"""Cuts a stream of bytes into lines in bounded memory, and says where a line may lack its beginning."""

LONGEST = 1000  # of all the lines that are read here; without an end in so many bytes it is none


class LineCutter:
    """Gives whole lines; NULs (a break on the wire, a device starting) and what is far too long are garbage.

    ``starts_torn`` tells of the lines that the last :meth:`feed` returned whether the first one may lack its
    beginning, because the stream was joined, or joined again, in the middle of it.
    """

    def __init__(self) -> None:
        self._left = b""
        self._is_dropping = False  # the rest of a line that was far too long
        self._is_open = True  # the line that is being gathered may have begun before the stream did
        self.starts_torn = False
        self.garbage_bytes = 0

    def feed(self, data: bytes) -> list[bytes]:
        """Return the lines that are complete now, without their ends; empty ones are left out."""
        if b"\0" in data:
            clean = data.replace(b"\0", b"")
            self.garbage_bytes += len(data) - len(clean)
            data = clean
        if b"\r" in data:
            data = data.replace(b"\r", b"\n")
        *lines, self._left = (self._left + data).split(b"\n")
        self.starts_torn = False
        if lines:
            if self._is_dropping:
                self.garbage_bytes += len(lines[0]) + 1
                lines[0] = b""
                self._is_dropping = False
            self.starts_torn = self._is_open and 0 < len(lines[0]) <= LONGEST
            self._is_open = False
        if len(self._left) > LONGEST:
            self._is_dropping = True
        if self._is_dropping:
            self.garbage_bytes += len(self._left)
            self._left = b""
        return [line for line in lines if line and not self._is_too_long(line)]

    def restart(self) -> None:
        """Forget the line that was being gathered: what comes now does not continue it."""
        self.garbage_bytes += len(self._left)
        self._left = b""
        self._is_dropping, self._is_open = False, True

    def _is_too_long(self, line: bytes) -> bool:
        if len(line) <= LONGEST:
            return False
        self.garbage_bytes += len(line) + 1
        return True
