"""Plays a stretch of a long recording through the sound card: one thread reads bounded blocks and writes them out.

The sink is injected, so that tests and machines without a sound card need no library; :func:`open_sink` is the real
one.
"""

import logging
import threading
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from app.devices import portaudio
from processing.errors import LeaklineError

log = logging.getLogger(__name__)

BLOCK_S = 0.05
LATENCY_S = 0.25  # a busy laptop must not make it stutter; the cursor takes it into account
FloatBlock = npt.NDArray[np.float32]
ReadFrames = Callable[[int, int], FloatBlock]  # start frame, count -> up to count samples


class Slowable(Protocol):
    """Reads sound that may last longer than it did: ``factor`` samples for each frame."""

    factor: int

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return ``factor · count`` samples for the frames from ``start`` on, fewer at the end."""


class SoundUnavailableError(Exception):
    """There is no sound card, or not the library that speaks to it; the text says which."""


class Sink(Protocol):
    """Where samples go; :meth:`write` blocks until there is room, so it sets the pace."""

    latency_s: float

    def write(self, block: FloatBlock) -> None:
        """Take one block, waiting while the buffer is full; raises OSError when the device is gone."""

    def drain(self) -> None:
        """Wait until what was taken has been heard."""

    def close(self) -> None:
        """Stop at once and let the device go."""


class _PortAudioSink:
    def __init__(self, stream: Any, channels: int, hold: portaudio.Hold) -> None:  # noqa: ANN401
        self._stream, self._channels, self._hold = stream, channels, hold
        self.latency_s = float(stream.latency)

    def write(self, block: FloatBlock) -> None:
        try:
            self._stream.write(block.reshape(-1, self._channels))
        except Exception as error:  # PortAudioError derives from Exception directly
            raise OSError(str(error)) from error

    def drain(self) -> None:
        # not by stop(): behind ALSA's plugins it drops what they hold. Silence pushes the last samples through instead
        frames = int((2.0 * self.latency_s + 0.1) * self._stream.samplerate)
        self.write(np.zeros(frames * self._channels, np.float32))

    def close(self) -> None:
        self._stream.abort()
        self._stream.close()
        self._hold.release()


def open_sink(sample_rate_hz: float, channels: int = 1) -> Sink:
    """Open the default output; raises SoundUnavailableError with a reason in the system's words.

    With more than one channel, blocks hold the samples of all channels in turn.
    """
    sounddevice = _library()
    try:
        hold = portaudio.Hold()  # looking for microphones anew would end what plays
    except LeaklineError as error:
        raise SoundUnavailableError(str(error)) from error
    try:
        stream = sounddevice.OutputStream(
            samplerate=sample_rate_hz, channels=channels, dtype="float32", latency=LATENCY_S, blocksize=0
        )
        stream.start()
    except Exception as error:
        hold.release()
        raise SoundUnavailableError(str(error)) from error
    return _PortAudioSink(stream, channels, hold)


def why_silent() -> str | None:
    """Return why nothing can be played, None where a default output exists."""
    try:
        sounddevice = _library()
        sounddevice.query_devices(kind="output")
    except SoundUnavailableError as error:
        return str(error)
    except Exception as error:  # noqa: BLE001  # PortAudioError and ValueError both mean: no device
        return str(error)
    return None


def _library() -> Any:  # noqa: ANN401  # sounddevice has no types
    try:
        import sounddevice
    except (ImportError, OSError) as error:  # OSError: the PortAudio library is not installed
        raise SoundUnavailableError(str(error)) from error
    return sounddevice


@dataclass(frozen=True)
class Stretch:
    """What to play, in frames: from ``start`` to ``end``; with ``loop`` again from ``loop_start``."""

    start: int
    end: int
    loop: bool = False
    loop_start: int = 0


class Playback:
    """One run of playing; made, started, asked for its position, stopped. Not reused."""

    def __init__(
        self,
        sink: Sink,
        read: ReadFrames | Slowable,
        sample_rate_hz: float,
        stretch: Stretch,
        gain: Callable[[], float] = lambda: 1.0,
    ) -> None:
        self._sink, self._read, self._rate_hz, self._stretch, self._gain = sink, read, sample_rate_hz, stretch, gain
        self._slow = 1  # samples that the last frames became
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._written = stretch.start  # next frame that goes to the sink
        self._first = stretch.loop_start if stretch.loop else stretch.start  # nothing before it is heard
        self._jump: int | None = None
        self.error: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="playback", daemon=True)

    def start(self) -> None:
        """Begin to play."""
        self._thread.start()

    def stop(self, timeout_s: float = 2.0) -> None:
        """Stop at once; returns when the thread has ended."""
        self._stop.set()
        self._thread.join(timeout_s)

    def seek(self, frame: int) -> None:
        """Go on from another frame; what waits in the card is still heard."""
        with self._lock:
            self._jump = frame
            self._first = frame

    @property
    def active(self) -> bool:
        """Whether it still plays."""
        return self._thread.is_alive()

    @property
    def position(self) -> int:
        """The frame that is heard now: what was written, less what still waits in the card."""
        with self._lock:
            written = self._written if self._jump is None else self._jump
            first = self._first
        heard = written - int(self._sink.latency_s * self._rate_hz / self._slow)
        return max(heard, min(first, self._stretch.start) if self._stretch.loop else first)

    def _run(self) -> None:
        try:
            self._play()
        except Exception as error:  # noqa: BLE001  # an unplugged card or a file gone: told by whoever polls
            log.warning("playback ended: %s", error)
            self.error = error
        finally:
            self._sink.close()

    def _play(self) -> None:
        size = max(1, int(BLOCK_S * self._rate_hz))
        while not self._stop.is_set():
            with self._lock:
                at = self._written if self._jump is None else self._jump
                self._jump = None
            if at >= self._stretch.end:
                if not self._stretch.loop:
                    break
                at = self._stretch.loop_start
            slow = int(getattr(self._read, "factor", 1))
            count = min(max(1, size // slow), self._stretch.end - at)
            block = self._read(at, count)
            if block.size == 0:
                break
            self._sink.write(np.clip(block * np.float32(self._gain()), -1.0, 1.0))
            with self._lock:
                self._slow = slow
                self._written = at + min(count, -(-block.size // slow))
        if not self._stop.is_set():
            self._sink.drain()
