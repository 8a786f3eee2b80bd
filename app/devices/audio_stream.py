"""One open sound input, and the queue into which its callback copies: nothing else happens on PortAudio's thread."""

import math
import queue
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, NamedTuple, Protocol

from app.devices import portaudio
from app.devices.audio_devices import AudioDevice
from processing.errors import ErrorCode, LeaklineError

LATENCY_S = 0.4  # of room for a busy computer; ALSA makes even blocks of a quarter of it
RATE_TOLERANCE = 0.005  # cards know their rate to 200 ppm; more is another rate
_CLOCKS = (time.monotonic, time.time, time.perf_counter)
_SAME_CLOCK_S = 5.0  # a callback is not that late; other clocks are years apart
_INTERRUPTED_S = 2e-4  # between two readings that belong together
_READINGS = 3
_WASAPI = "Windows WASAPI"


class Chunk(NamedTuple):
    """What one callback brought. ``first`` counts the frames of this opening, those that found no room too."""

    data: bytes
    frames: int
    opening: int
    first: int
    host_s: float  # when the callback ran
    age_s: float  # how long before that its first frame was digitised; NaN where the system does not tell
    is_after_overflow: bool


class Handover:
    """From the callback to the worker: takes without ever waiting, at most ``limit_s`` of sound."""

    def __init__(self, limit_s: float) -> None:
        self._limit_s = limit_s
        self._queue: queue.SimpleQueue[Chunk | None] = queue.SimpleQueue()
        self._put = 0  # frames; written by the callback only
        self._taken = 0  # by the worker only
        self._limit = 0
        self._openings = 0
        self.overflows = 0
        self.refused_frames = 0

    def opened(self, rate_hz: float) -> "Callback":
        """Return the callback for a stream that is about to be opened."""
        self._limit = int(self._limit_s * rate_hz)
        self._openings += 1
        return Callback(self, self._openings)

    def offer(self, chunk: Chunk) -> None:
        """Take a chunk, or count what it held where the worker is too far behind."""
        if self._put - self._taken + chunk.frames > self._limit:
            self.refused_frames += chunk.frames
            return
        self._put += chunk.frames
        self._queue.put(chunk)

    def end(self) -> None:
        """Let the worker end after what is still waiting."""
        self._queue.put(None)

    def take(self, timeout_s: float) -> Chunk | None:
        """Return the next chunk, None at the end; raises queue.Empty after ``timeout_s``."""
        chunk = self._queue.get(timeout=timeout_s)
        if chunk is not None:
            self._taken += chunk.frames
        return chunk

    @property
    def waiting_frames(self) -> int:
        """How many frames the worker has not taken yet."""
        return self._put - self._taken


class Callback:
    """What PortAudio calls for one opening of a device: copies, notes the times, and never raises."""

    def __init__(self, handover: Handover, opening: int) -> None:
        self._handover, self._opening = handover, opening
        self._came = 0
        self.is_heard = True  # False: what comes is counted as lost
        self.last_s: float | None = None  # when it was last called
        self.finished = threading.Event()

    def __call__(self, data: Any, frames: int, times: Any, status: Any) -> None:  # noqa: ANN401  # C structures
        """Copy what came; ``data`` is only valid until this returns."""
        self.last_s = time.monotonic()
        first, self._came = self._came, self._came + frames
        try:
            overflow = bool(status.input_overflow)
            self._handover.overflows += overflow
            now, age = digitised(times.currentTime, times.inputBufferAdcTime)
            if self.is_heard:
                self._handover.offer(Chunk(bytes(data), frames, self._opening, first, now, age, overflow))
        except Exception:  # noqa: BLE001  # no memory left; an exception here would end the stream
            self._handover.refused_frames += frames

    def on_finished(self) -> None:
        """Note that the stream ended, by us or because the device went."""
        self.finished.set()


def digitised(current_s: float, adc_s: float) -> tuple[float, float]:
    """Return host time now, and how long ago a callback's first frame was digitised; NaN where that is not told.

    ``current_s`` and ``adc_s`` are PortAudio's, which it reads before it calls us: on a busy computer Python's lock, or
    the processor, comes up to 0.1 s later. So the age is counted to now, on whichever of the host's clocks PortAudio
    reads on this system; where that is none of them, to PortAudio's own now.
    """
    now = time.monotonic()
    if not adc_s > 0.0:
        return now, math.nan
    for clock in _CLOCKS:
        for _ in range(_READINGS):
            now, its_now, after = time.monotonic(), clock(), time.monotonic()
            if after - now < _INTERRUPTED_S:
                break
        if -_INTERRUPTED_S < its_now - current_s < _SAME_CLOCK_S:
            return now, its_now - adc_s
    return now, current_s - adc_s


class OpenInput(Protocol):
    """An input that runs."""

    sample_rate_hz: float
    is_converted: bool  # the system was asked to resample

    def close(self) -> None:
        """Stop and let the device go; may take as long as the system likes."""


Opener = Callable[[AudioDevice, int, int, Callback], OpenInput]  # device, rate in Hz, channels, its callback


class _PortAudioInput:
    def __init__(self, stream: Any, hold: portaudio.Hold, is_converted: bool) -> None:  # noqa: ANN401
        self._stream, self._hold = stream, hold
        self.sample_rate_hz = float(stream.samplerate)
        self.is_converted = is_converted

    def close(self) -> None:
        self._stream.abort()
        self._stream.close()
        self._hold.release()


def open_input(device: AudioDevice, rate_hz: int, channels: int, callback: Callback) -> OpenInput:
    """Open a device and start it; 32 bits a sample, so that 24 arrive exactly.

    Raises LeaklineError (SOUND_DEVICE_REFUSED) with the system's reason, also where it would run at another rate.
    """
    sounddevice = portaudio.library()
    reason = ""
    for settings, is_converted in _ways(sounddevice, device):
        hold = portaudio.Hold()
        stream = None
        try:
            stream = sounddevice.RawInputStream(
                device=device.index,
                samplerate=rate_hz,
                channels=channels,
                dtype="int32",
                latency=LATENCY_S,
                blocksize=0,  # as the device has them: PortAudio need not cut and join
                extra_settings=settings,
                callback=callback,
                finished_callback=callback.on_finished,
            )
            _check_rate(stream, rate_hz)
            stream.start()
        except Exception as error:  # noqa: BLE001  # PortAudioError derives from Exception directly
            reason = str(error)
            if stream is not None:
                with suppress(Exception):  # it did not run; why it does not close says nothing more
                    stream.close()
            hold.release()
        else:
            return _PortAudioInput(stream, hold, is_converted)
    raise LeaklineError(
        ErrorCode.SOUND_DEVICE_REFUSED, name=device.name, rate_hz=rate_hz, channels=channels, reason=reason
    )


def _check_rate(stream: Any, rate_hz: int) -> None:  # noqa: ANN401
    got_hz = float(stream.samplerate)
    if abs(got_hz - rate_hz) > RATE_TOLERANCE * rate_hz:
        raise ValueError(f"{got_hz:.0f} Hz")


def _ways(sounddevice: Any, device: AudioDevice) -> Iterator[tuple[Any, bool]]:  # noqa: ANN401
    """Yield how to open a device, best first: WASAPI shares it only at its own rate, then alone, then resampled."""
    yield None, False
    if device.host_api == _WASAPI:
        yield sounddevice.WasapiSettings(exclusive=True), False
        yield sounddevice.WasapiSettings(auto_convert=True), True


def suitable_rate(device: AudioDevice, channels: int) -> int:
    """Return the rate to record with where none was asked for: 48 kHz if the device takes it, else its own."""
    sounddevice = portaudio.library()
    try:
        sounddevice.check_input_settings(device=device.index, channels=channels, dtype="int32", samplerate=48_000)
    except Exception:  # noqa: BLE001  # PortAudioError and ValueError both mean: not so
        return round(device.default_rate_hz)
    return 48_000
