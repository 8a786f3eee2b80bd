"""Where a simulated ball's sound goes: our own server's microphone, a sink of a running server, an output, a file."""

import os
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import soundfile

from app.devices import portaudio
from app.devices.simulated.sound_server import DIES_WITH_US, SoundServer
from app.devices.simulated.source import SoundArray
from processing.errors import ErrorCode, LeaklineError, Place

_PIPE_S = 0.1
_AT_ONCE_BYTES = 4096  # as much goes into a pipe whole or not at all (PIPE_BUF): no frame is ever torn
_PATIENCE_S, _RETRY_S = 1.0, 0.002
_LATENCY_MS = 2000  # a busy machine must not make holes in the sound


class SoundOut(Protocol):
    """Takes frames (n, channels)."""

    sets_pace: bool  # it takes frames at its own pace, writing waits; else the player keeps the time

    def write(self, frames: SoundArray) -> int:
        """Take frames; return how many of them were heard by somebody."""
        ...

    def unplug(self) -> None:
        """Let the sound source vanish."""
        ...

    def replug(self) -> None:
        """Bring it back."""
        ...

    def close(self) -> None:
        """Let it go."""
        ...


class MicrophoneOut:
    """The pipe of a :class:`SoundServer`; while nobody records, what was said is forgotten."""

    sets_pace = False

    def __init__(self, server: SoundServer, rate_hz: int, channels: int) -> None:
        self._server = server
        self._frame_bytes = 4 * channels
        self._size = 1 << int(np.ceil(np.log2(max(_PIPE_S * rate_hz * self._frame_bytes, 4 * _AT_ONCE_BYTES))))
        self._pipe = -1
        self._is_heard = False
        self._has_waiting = False  # something was written that may wait
        self._open()

    def _open(self) -> None:
        # for reading too: opening does not wait for the server then, and old sound can be taken out
        self._pipe = os.open(self._server.pipe, os.O_RDWR | os.O_NONBLOCK)
        if sys.platform == "linux":
            import fcntl

            with suppress(OSError):  # a longer pipe only means that old sound is older
                fcntl.fcntl(self._pipe, fcntl.F_SETPIPE_SZ, self._size)

    def write(self, frames: SoundArray) -> int:
        """Write frames; while nobody takes them out only the newest wait, so that a recording begins with now."""
        if self._pipe < 0:
            return 0
        if not self._is_heard:
            self._is_heard = self._has_waiting and not self._waiting_bytes()
            self._forget()
        data = np.ascontiguousarray(frames, "<f4").tobytes()
        step = _AT_ONCE_BYTES - _AT_ONCE_BYTES % self._frame_bytes
        for at in range(0, len(data), step):
            self._write(data[at : at + step])
        self._has_waiting = True
        return len(frames) if self._is_heard else 0

    def _write(self, piece: bytes) -> None:
        until = time.monotonic() + (_PATIENCE_S if self._is_heard else 0.0)
        while True:
            try:
                os.write(self._pipe, piece)
            except BlockingIOError:
                if time.monotonic() < until:  # a busy machine: whoever records will come to it
                    time.sleep(_RETRY_S)
                    continue
                self._forget()
                self._is_heard = False
            return

    def _waiting_bytes(self) -> int:
        import fcntl
        import termios

        return int.from_bytes(fcntl.ioctl(self._pipe, termios.FIONREAD, b"\0" * 4), sys.byteorder)

    def _forget(self) -> None:
        with suppress(BlockingIOError):
            while os.read(self._pipe, 1 << 20):
                pass

    def unplug(self) -> None:
        """Let the microphone vanish from the server."""
        self._close_pipe()
        self._server.unplug()

    def replug(self) -> None:
        """Bring it back."""
        self._server.replug()
        self._open()

    def close(self) -> None:
        """Close the pipe."""
        self._close_pipe()

    def _close_pipe(self) -> None:
        if self._pipe >= 0:
            os.close(self._pipe)
        self._pipe, self._is_heard, self._has_waiting = -1, False, False


class _Unplugged:
    """What cannot be taken out of somebody else's machine only falls silent."""

    def unplug(self) -> None:
        """Nothing: the player writes silence meanwhile."""

    def replug(self) -> None:
        """Nothing."""


class SinkOut(_Unplugged):
    """A sink of the running PulseAudio (or PipeWire), best a null sink whose monitor is recorded.

    Raises:
        LeaklineError: SIMULATED_SOUND_FAILED.
    """

    sets_pace = True

    def __init__(self, sink: str, rate_hz: int, channels: int) -> None:
        words = ["--raw", f"--device={sink}", "--format=float32le", f"--rate={rate_hz}", f"--channels={channels}"]
        try:
            self._player = subprocess.Popen(
                [*DIES_WITH_US, "pacat", "--playback", f"--latency-msec={_LATENCY_MS}", *words],
                stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True,
            )  # fmt: skip
        except OSError as error:
            raise _failed(f"pacat: {error.strerror or error}") from error

    def write(self, frames: SoundArray) -> int:
        """Write frames as the server takes them."""
        assert self._player.stdin is not None
        try:
            self._player.stdin.write(np.ascontiguousarray(frames, "<f4").tobytes())
        except (OSError, ValueError) as error:  # ValueError: closed meanwhile
            raise _failed("the sound server does not take it, or has no such sink") from error
        return len(frames)

    def close(self) -> None:
        """End the player."""
        self._player.kill()
        self._player.wait(5.0)
        if self._player.stdin is not None:
            with suppress(OSError):
                self._player.stdin.close()


class OutputOut(_Unplugged):
    """An output that PortAudio knows, by a part of its name: a virtual cable, or a loudspeaker beside a microphone.

    Raises:
        LeaklineError: SIMULATED_SOUND_FAILED, SOUND_LIBRARY_MISSING.
    """

    sets_pace = True

    def __init__(self, name: str, rate_hz: int, channels: int) -> None:
        sounddevice = portaudio.library()
        self._hold = portaudio.Hold()
        try:
            self._stream: Any = sounddevice.RawOutputStream(
                samplerate=rate_hz, channels=channels, dtype="float32", latency=0.5, device=name or None
            )
            self._stream.start()
        except Exception as error:  # no such device: ValueError; PortAudioError derives from Exception directly
            self._hold.release()
            raise _failed(str(error)) from error

    def write(self, frames: SoundArray) -> int:
        """Write frames as the card takes them."""
        try:
            self._stream.write(np.ascontiguousarray(frames, "<f4").tobytes())
        except Exception as error:  # PortAudioError derives from Exception directly
            raise _failed(str(error)) from error
        return len(frames)

    def close(self) -> None:
        """Stop at once."""
        try:
            self._stream.abort()
            self._stream.close()
        finally:
            self._hold.release()


class FileOut(_Unplugged):
    """A sound file, in the time it takes to hear it.

    Raises:
        LeaklineError: CANNOT_WRITE.
    """

    sets_pace = False

    def __init__(self, path: Path, rate_hz: int, channels: int) -> None:
        try:
            self._file: Any = soundfile.SoundFile(str(path), "w", rate_hz, channels, "FLOAT", format="RF64")
        except soundfile.SoundFileError as error:
            raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=str(error)) from error

    def write(self, frames: SoundArray) -> int:
        """Write frames."""
        self._file.write(frames)
        return len(frames)

    def close(self) -> None:
        """End the file."""
        self._file.close()


def open_out(words: str, server: SoundServer | None, rate_hz: int, channels: int) -> SoundOut | None:
    """Return where ``words`` send the sound: ``SINK``, ``output:NAME``, ``wav:FILE`` or ``none``; our server's else.

    Raises:
        LeaklineError: SIMULATED_SOUND_FAILED, CANNOT_WRITE, SETTING_INVALID.
    """
    kind, _, rest = words.partition(":")
    if kind == "wav" and rest:
        return FileOut(Path(rest), rate_hz, channels)
    if kind == "output":
        return OutputOut(rest, rate_hz, channels)
    if server is not None and words in {"", "none"}:
        return MicrophoneOut(server, rate_hz, channels)
    if words in {"", "none"}:
        return None
    if words == "wav":
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, name="--audio", value=words, allowed="SINK, output:NAME, wav:FILE, none"
        )
    return SinkOut(words, rate_hz, channels)


def _failed(reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.SIMULATED_SOUND_FAILED, reason=reason)
