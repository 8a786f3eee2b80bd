"""Listening to the correlator's recordings: A, B, or both at once, A in the left ear, as loud as is pleasant."""

from collections.abc import Callable
from enum import StrEnum

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.devices.audio_output import FloatBlock, Playback, Sink, SoundUnavailableError, Stretch, open_sink
from processing.correlation.recordings import Pair
from processing.sound.source import AudioReader

POLL_MS = 100
LOUD = 0.12  # root mean square that is pleasant to hear, of full scale
PROBE_S = 4.0
MakeSink = Callable[[float, int], Sink]  # samples a second, channels


class Ears(StrEnum):
    """Which sensors are heard."""

    A = "a"
    B = "b"
    BOTH = "both"


class PairReader:
    """Reads the chosen sensors at A's rate, B moved by the clocks' offset, as one row of samples; both: in turn.

    With a band, only that is heard. A jump starts the filters anew.
    """

    def __init__(self, pair: Pair, ears: Ears, band_hz: tuple[float, float] | None) -> None:
        self._pair, self._ears = pair, ears
        self._readers = (AudioReader(pair.a), AudioReader(pair.b))
        self._next = -1
        self.channels = 2 if ears is Ears.BOTH else 1
        self.rate_hz = pair.a.sample_rate_hz
        self._sections: np.ndarray | None = None
        self._states: list[np.ndarray] = []
        if band_hz is not None:
            from scipy import signal  # slow to import: only who listens to a band pays for it

            high = min(band_hz[1], 0.45 * self.rate_hz)
            low = min(max(band_hz[0], 2.0), 0.8 * high)
            self._sections = signal.butter(4, [low, high], "bandpass", fs=self.rate_hz, output="sos")
            self._filter = signal.sosfilt
        self._gains = self._probed()

    def close(self) -> None:
        """Close the files."""
        for reader in self._readers:
            reader.close()

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return ``count`` samples from ``start`` on (with both sensors: of both, in turn)."""
        frame, frames = start // self.channels, count // self.channels
        if frame != self._next or not self._states:
            sections = self._sections
            self._states = [] if sections is None else [np.zeros((len(sections), 2)) for _ in range(2)]
        self._next = frame + frames
        heard = [gain * self._filtered(number, frame, frames) for number, gain in self._gains.items()]
        return np.ascontiguousarray(np.column_stack(heard).ravel(), dtype=np.float32)

    def _probed(self) -> dict[int, float]:
        """Return the loudness factor of each sensor that is heard, from its first seconds in the stretch."""
        chosen = {Ears.A: (0,), Ears.B: (1,), Ears.BOTH: (0, 1)}[self._ears]
        first, last = self._pair.common_span_s()
        start = int(first * self.rate_hz)
        count = max(1, int(min(PROBE_S, max(last - first, 0.0)) * self.rate_hz))
        gains = {}
        for number in chosen:
            self._states = [] if self._sections is None else [np.zeros((len(self._sections), 2)) for _ in range(2)]
            power = float(np.mean(np.square(self._filtered(number, start, count), dtype=np.float64)))
            gains[number] = LOUD / np.sqrt(power) if power > 0.0 else 1.0
        self._states = []
        return gains

    def _filtered(self, number: int, frame: int, frames: int) -> FloatBlock:
        samples = self._raw(number, frame, frames)
        if self._sections is None:
            return samples
        filtered, self._states[number] = self._filter(self._sections, samples, zi=self._states[number])
        return np.asarray(filtered, dtype=np.float32)

    def _raw(self, number: int, frame: int, frames: int) -> FloatBlock:
        """Return samples at A's rate; nothing where a recording has none."""
        source = (self._pair.a, self._pair.b)[number]
        sync = self._pair.sync
        first = float(frame)
        ratio = 1.0
        if number == 1:
            ratio = source.sample_rate_hz * (1.0 + 1e-6 * sync.drift_ppm) / self.rate_hz
            first = (frame - sync.offset_s * self.rate_hz) * ratio
        at = int(np.floor(first))
        need = int(np.ceil(frames * ratio)) + 2
        begin = max(at, 0)
        found = self._readers[number].read(begin, max(0, at + need - begin))
        whole = np.zeros(need, np.float32)
        whole[begin - at : begin - at + len(found)] = found
        if ratio == 1.0 and first == at:
            return whole[:frames]
        places = first - at + np.arange(frames) * ratio
        return np.asarray(np.interp(places, np.arange(need), whole), dtype=np.float32)


class Listening(QObject):
    """Plays until it is stopped or the stretch ends; ``make_sink`` opens the sound card."""

    changed = Signal()  # it began or ended
    failed = Signal(object)  # Exception

    def __init__(self, make_sink: MakeSink = open_sink, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._make_sink = make_sink
        self._playback: Playback | None = None
        self._reader: PairReader | None = None
        self.ears: Ears | None = None
        self._timer = QTimer(self)
        self._timer.setInterval(POLL_MS)
        self._timer.timeout.connect(self._look)

    @property
    def playing(self) -> bool:
        """Whether sound is coming out."""
        return self._playback is not None

    def play(self, pair: Pair, ears: Ears, band_hz: tuple[float, float] | None) -> None:
        """Play the pair's stretch from its beginning, again and again."""
        self.stop()
        first, last = pair.common_span_s()
        rate = pair.a.sample_rate_hz
        start, end = int(first * rate), int(last * rate)
        if end - start < rate * 0.1:
            return
        try:
            reader = PairReader(pair, ears, band_hz)
            sink = self._make_sink(rate, reader.channels)
        except SoundUnavailableError as error:
            self.failed.emit(error)
            return
        channels = reader.channels
        stretch = Stretch(start * channels, end * channels, loop=True, loop_start=start * channels)
        self._reader, self.ears = reader, ears
        self._playback = Playback(sink, reader, rate * channels, stretch)
        self._playback.start()
        self._timer.start()
        self.changed.emit()

    def stop(self) -> None:
        """Be silent."""
        self._timer.stop()
        playback, self._playback = self._playback, None
        reader, self._reader = self._reader, None
        self.ears = None
        if playback is not None:
            playback.stop()
            self.changed.emit()
        if reader is not None:
            reader.close()

    def _look(self) -> None:
        if self._playback is not None and not self._playback.active:
            error = self._playback.error
            self.stop()
            if error is not None:
                self.failed.emit(error)
