"""Hears the same place in one run and in the other, equally loud, again and again."""

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.devices.audio_output import FloatBlock, Playback, Sink, SoundUnavailableError, Stretch, open_sink
from processing.errors import LeaklineError

if TYPE_CHECKING:
    from processing.results import Results

POLL_MS = 100
LOUD = 0.12  # root mean square that is pleasant to hear, of full scale
_MOST_GAIN = 1000.0
_PROBED_S = 60.0  # of which the loudness is taken: a device may stand at a place for hours


class _PlaceReader:
    """Reads one run's sound, made as loud as is pleasant over the stretch."""

    def __init__(self, results: "Results", first: int, last: int) -> None:
        from processing.sound.source import AudioReader

        audio = results.recording.audio
        assert audio is not None  # the caller has asked
        self._reader = AudioReader(audio)
        try:
            probe = self._reader.read(first, max(1, last - first))
        except BaseException:
            self._reader.close()
            raise
        power = float(np.mean(np.square(probe, dtype=np.float64))) if len(probe) else 0.0
        self._gain = np.float32(min(LOUD / np.sqrt(power), _MOST_GAIN) if power > 0.0 else 1.0)

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return samples from ``start`` on."""
        return np.ascontiguousarray(self._gain * self._reader.read(start, count), dtype=np.float32)

    def close(self) -> None:
        """Close the files."""
        self._reader.close()


class RepeatListening(QObject):
    """Plays until it is stopped; ``make_sink`` opens the sound card."""

    ended = Signal()
    failed = Signal(object)  # Exception

    def __init__(self, make_sink: Callable[[float], Sink] = open_sink, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._make_sink = make_sink
        self._playback: Playback | None = None
        self._reader: _PlaceReader | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(POLL_MS)
        self._timer.timeout.connect(self._look)

    @property
    def playing(self) -> bool:
        """Whether sound is coming out."""
        return self._playback is not None

    def play(self, results: "Results", start_s: float, end_s: float) -> bool:
        """Play survey seconds of a run in a loop; False where it has no sound there, or no card."""
        self.stop()
        audio = results.recording.audio
        if audio is None:
            return False
        rate = audio.sample_rate_hz
        ends = [round(float(results.clock.to_audio(s)) * rate) for s in (start_s, end_s)]
        first, last = (min(max(frame, 0), audio.frames) for frame in ends)
        if last - first < 0.1 * rate:
            return False
        try:
            self._reader = _PlaceReader(results, first, min(last, first + round(_PROBED_S * rate)))
            sink = self._make_sink(rate)
        except (SoundUnavailableError, LeaklineError) as error:  # the other survey's disc may be gone by now
            self.stop()
            self.failed.emit(error)
            return False
        self._playback = Playback(sink, self._reader, rate, Stretch(first, last, loop=True, loop_start=first))
        self._playback.start()
        self._timer.start()
        return True

    def stop(self) -> None:
        """Be silent."""
        self._timer.stop()
        playback, self._playback = self._playback, None
        reader, self._reader = self._reader, None
        if playback is not None:
            playback.stop()
        if reader is not None:
            reader.close()

    def _look(self) -> None:
        if self._playback is not None and not self._playback.active:
            error = self._playback.error
            self.stop()
            self.ended.emit()
            if error is not None:
                self.failed.emit(error)
