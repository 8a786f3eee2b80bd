"""The PortAudio library of this process: imported late, and looked at anew only while none of its streams is open.

PortAudio lists the devices once, when it is initialised; to see one that was plugged in later it must be terminated,
which ends every open stream without a word. So whoever opens a stream holds the library, and a refresh asks first.
"""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from processing.errors import ErrorCode, LeaklineError

WAIT_S = 3.0  # for a call of another thread; longer, and the system hangs


class _Held:
    """Which streams of this process are open. One a process, as the C library behind it is."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self.streams: set[Hold] = set()

    @contextmanager
    def locked(self) -> Iterator[None]:
        if not self._lock.acquire(timeout=WAIT_S):
            raise LeaklineError(ErrorCode.SOUND_SYSTEM_HANGS)
        try:
            yield
        finally:
            self._lock.release()


_held = _Held()


def library() -> Any:  # noqa: ANN401  # sounddevice has no types
    """Return sounddevice; raises LeaklineError (SOUND_LIBRARY_MISSING) where it, or PortAudio, is not installed."""
    try:
        import sounddevice
    except (ImportError, OSError) as error:  # OSError: the PortAudio library is not installed
        raise LeaklineError(ErrorCode.SOUND_LIBRARY_MISSING, reason=str(error)) from error
    return sounddevice


def refresh() -> bool:
    """See the devices that are there now; returns False, and leaves all as it was, while a stream is open.

    Raises LeaklineError (SOUND_LIBRARY_MISSING, or SOUND_SYSTEM_HANGS where another thread waits for the system, or it
    cannot be begun anew now).
    """
    sounddevice = library()
    with _held.locked():
        if _held.streams:
            return False
        # python-sounddevice offers these two for just this, but has no public name for them (its issue 3)
        try:
            if sounddevice._initialized:  # noqa: SLF001  # not so where it could not be begun the last time
                sounddevice._terminate()  # noqa: SLF001
            sounddevice._initialize()  # noqa: SLF001
        except sounddevice.PortAudioError as error:  # while the sound server is being started again
            raise LeaklineError(ErrorCode.SOUND_SYSTEM_HANGS, reason=str(error)) from error
        return True


class Hold:
    """Keeps :func:`refresh` away from before a stream is opened until it is closed.

    Raises LeaklineError (SOUND_SYSTEM_HANGS) where a refresh does not end.
    """

    def __init__(self) -> None:
        with _held.locked():
            _held.streams.add(self)

    def release(self) -> None:
        """Let the library go, without ever waiting; a second time does nothing."""
        _held.streams.discard(self)
