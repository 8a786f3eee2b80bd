"""The PortAudio library of this process: imported late, and looked at anew only while none of its streams is open.

PortAudio lists the devices once, when it is initialised; to see one that was plugged in later it must be terminated,
which ends every open stream without a word. So whoever opens a stream holds the library, and a refresh asks first.
"""

import threading
from typing import Any

from processing.errors import ErrorCode, LeaklineError


class _Held:
    """How many streams of this process are open. One a process, as the C library behind it is."""

    def __init__(self) -> None:
        self.lock = threading.RLock()
        self.streams = 0


_held = _Held()


def library() -> Any:  # noqa: ANN401  # sounddevice has no types
    """Return sounddevice; raises LeaklineError (SOUND_LIBRARY_MISSING) where it, or PortAudio, is not installed."""
    try:
        import sounddevice
    except (ImportError, OSError) as error:  # OSError: the PortAudio library is not installed
        raise LeaklineError(ErrorCode.SOUND_LIBRARY_MISSING, reason=str(error)) from error
    return sounddevice


def refresh() -> bool:
    """See the devices that are there now; returns False, and leaves all as it was, while a stream is open."""
    sounddevice = library()
    with _held.lock:
        if _held.streams:
            return False
        # python-sounddevice offers these two for just this, but has no public name for them (its issue 3)
        sounddevice._terminate()  # noqa: SLF001
        sounddevice._initialize()  # noqa: SLF001
        return True


class Hold:
    """Keeps :func:`refresh` away from before a stream is opened until it is closed."""

    def __init__(self) -> None:
        self._is_held = True
        with _held.lock:
            _held.streams += 1

    def release(self) -> None:
        """Let the library go; a second time does nothing."""
        with _held.lock:
            if self._is_held:
                self._is_held = False
                _held.streams -= 1
