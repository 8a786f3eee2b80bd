"""What is heard: the sound raw or cleaned, whole or in one band, at its own speed or slowed, each equally loud.

Everything here runs in the playback's thread; the window only replaces :attr:`Listening.hearing`, and the next block is
made of it. So one may switch between raw and cleaned while it plays, and the place is not lost.
"""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from app.devices.audio_output import FloatBlock, ReadFrames
from processing.sound.loudness import LOOK_FRAMES, a_weight, usual_power
from processing.survey import AudioSource

if TYPE_CHECKING:
    from processing.sound.cleaning import CleaningContext, CleanReader
    from processing.sound.source import AudioReader

LEAD_FRAMES = 4096  # a filter is run in on so many samples before what is heard
MOST_GAIN_DB = 36.0  # a band may be so much quieter than the whole

Band = tuple[float, float]
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Hearing:
    """How one listens; ``slow`` is 1, 2 or 4 times as long at the same pitch."""

    cleaned: bool = False
    band_hz: Band | None = None
    slow: int = 1


class BandFilter:
    """Wraps a reader so that only one band is heard; causal, and continuous from block to block.

    After a jump it is run in on what lies before, so that nothing swells or clicks.
    """

    def __init__(self, read: ReadFrames, sample_rate_hz: float, band_hz: Band) -> None:
        from scipy import signal  # slow to import: only who listens to a band pays for it

        self._sections = band_sections(sample_rate_hz, band_hz)
        self._filter = signal.sosfilt
        self._state = np.zeros((self._sections.shape[0], 2))
        self._read = read
        self._next = -1

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return the filtered samples; a jump starts the filter anew."""
        if start != self._next:
            self._state = np.zeros_like(self._state)
            lead = self._read(max(0, start - LEAD_FRAMES), min(start, LEAD_FRAMES))
            if lead.size:
                self._state = self._filter(self._sections, lead, zi=self._state)[1]
        block = self._read(start, count)
        self._next = start + block.size
        filtered, self._state = self._filter(self._sections, block, zi=self._state)
        return np.asarray(filtered, dtype=np.float32)


def band_sections(sample_rate_hz: float, band_hz: Band) -> Floats:
    """Return the second-order sections (n, 6) of the filter for a band."""
    from scipy import signal

    nyquist = sample_rate_hz / 2.0
    high = min(band_hz[1], 0.98 * nyquist)
    low = min(max(band_hz[0], 1.0), 0.5 * high)  # a recording too slow for the band: the top of what there is
    sections = signal.butter(4, [low, high], "bandpass", fs=sample_rate_hz, output="sos")
    return np.asarray(sections, np.float64)


class Loudness:
    """How loud raw and cleaned sound usually are, so that one can be played as loud as the other.

    Loud is the A-weighted power, so that the rumble that nobody hears does not count. One factor for the whole
    recording: within a mode, what is louder stays louder.
    """

    def __init__(self, sample_rate_hz: float, frames: int) -> None:
        self._rate_hz, self._frames = sample_rate_hz, frames
        self._hz = np.asarray(np.fft.rfftfreq(LOOK_FRAMES, 1.0 / sample_rate_hz), np.float64)
        self._weight = a_weight(self._hz)
        self._raw: Floats | None = None

    def gain(self, hearing: Hearing, raw: "AudioReader", cleaned: Floats | None) -> float:
        """Return the factor that makes this as loud as the raw sound; ``cleaned`` is the usual power of the cleaned."""
        if self._raw is None:
            self._raw = usual_power(raw, self._frames)
        own = cleaned if hearing.cleaned and cleaned is not None else self._raw
        if hearing.band_hz is not None:
            from scipy import signal

            sections = band_sections(self._rate_hz, hearing.band_hz)
            _, response = signal.sosfreqz(sections, worN=self._hz, fs=self._rate_hz)
            own = own * np.square(np.abs(response))
        before, after = float(self._raw @ self._weight), float(own @ self._weight)
        if before <= 0.0 or after <= 0.0:
            return 1.0
        gain_db = 10.0 * np.log10(before / after)
        return float(10.0 ** (np.clip(gain_db, -MOST_GAIN_DB, MOST_GAIN_DB) / 20.0))


class Listening:
    """Reads what is to be heard of one recording; made by the window, read in the playback's thread, closed after it.

    ``hearing``, ``context`` and ``matched`` may be replaced at any moment by the window.
    """

    def __init__(
        self,
        source: AudioSource,
        hearing: Hearing,
        context: "CleaningContext | None",
        loudness: Loudness,
        *,
        matched: bool = True,
    ) -> None:
        self.hearing, self.context, self.matched = hearing, context, matched
        self._source, self._loudness = source, loudness
        from processing.sound.source import AudioReader  # opens the library that decodes: not before one listens

        self._raw = AudioReader(source)
        self._clean: CleanReader | None = None
        self._now: Hearing | None = None
        self._chain: ReadFrames | None = None

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return the samples from frame ``start`` on; where the hearing has changed, one fades into the other."""
        wanted = self._possible()
        if self._chain is not None and self._now == wanted:
            return self._chain(start, count)
        old, self._chain = self._chain, self._made(wanted)
        self._now = wanted
        block = self._chain(start, count)
        if old is None:
            return block
        before = old(start, count)
        share = np.linspace(0.0, 1.0, len(block), dtype=np.float32)
        return np.asarray(before + share * (block - before), np.float32)

    def close(self) -> None:
        """Close the files; called when the playback's thread has ended."""
        self._raw.close()
        if self._clean is not None:
            self._clean.close()
        self._chain = self._now = None

    def _possible(self) -> Hearing:
        """Return what is asked for, less what cannot be: slowness is not made here."""
        hearing = replace(self.hearing, slow=1)
        return hearing if self.context is not None else replace(hearing, cleaned=False)

    def _made(self, hearing: Hearing) -> ReadFrames:
        read = self._reader(cleaned=hearing.cleaned)
        gain = np.float32(1.0)
        if self.matched and hearing != Hearing():
            usual = self.context.usual_power if self.context is not None else None
            gain = np.float32(self._loudness.gain(hearing, self._raw, usual))
        if hearing.band_hz is not None:
            read = BandFilter(read, self._source.sample_rate_hz, hearing.band_hz)
        return lambda at, count: read(at, count) * gain

    def _reader(self, *, cleaned: bool) -> ReadFrames:
        context = self.context
        if not cleaned or context is None:
            return self._raw.read
        if self._clean is None:
            from processing.sound.cleaning import CleanReader

            self._clean = CleanReader(self._source, context)
        return self._clean.read
