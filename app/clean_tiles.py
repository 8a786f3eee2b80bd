"""The picture of the sound that can be asked for raw or cleaned, without being changed for another one.

Cleaned columns are made when they are asked for, from the cleaned sound of the visible span; what was made is kept, so
that a step aside makes only what comes into view. Wider spans than :data:`LONGEST_S` show the raw picture.
"""

import threading
from collections import OrderedDict
from typing import TYPE_CHECKING

import numpy as np

from app.view_data import ScanTiles
from widgets.tile_source import Levels

if TYPE_CHECKING:
    from processing.sound.cleaning import CleaningContext
    from processing.sound.pcm import Samples
    from processing.survey import AudioSource, FloatArray

LONGEST_S = 90.0
_BLOCK_S = 1.0
_KEPT_BLOCKS = 200  # 35 MB at 44.1 kHz


class _KeptSound:
    """Reads cleaned sound through a memory of blocks."""

    def __init__(self, audio: "AudioSource", context: "CleaningContext") -> None:
        from processing.sound.cleaning import CleanReader

        self._size = max(1, int(_BLOCK_S * audio.sample_rate_hz))
        self._frames = audio.frames
        self._reader = CleanReader(audio, context)
        self._blocks: OrderedDict[int, Samples] = OrderedDict()

    def read(self, start: int, count: int) -> "Samples":
        """Return up to ``count`` samples from frame ``start`` on."""
        end = min(start + count, self._frames)
        pieces = [np.zeros(0, np.float32)]
        for number in range(start // self._size, -(-end // self._size)):
            first = number * self._size
            pieces.append(self._block(number)[max(start - first, 0) : end - first])
        return np.concatenate(pieces)

    def close(self) -> None:
        """Close the files."""
        self._reader.close()

    def _block(self, number: int) -> "Samples":
        if number not in self._blocks:
            self._blocks[number] = self._reader.read(number * self._size, self._size)
            while len(self._blocks) > _KEPT_BLOCKS:
                self._blocks.popitem(last=False)
        self._blocks.move_to_end(number)
        return self._blocks[number]


class CleanableTiles:
    """A :class:`widgets.tile_source.TileSource` of raw sound, or where it is told so, of cleaned."""

    def __init__(self, raw: ScanTiles) -> None:
        self._raw = raw
        self._lock = threading.Lock()  # several workers of a view read
        self._context: CleaningContext | None = None
        self._cleaned: _KeptSound | None = None

    @property
    def frequencies_hz(self) -> "FloatArray":
        """Centres of the bins."""
        return self._raw.frequencies_hz

    @property
    def low_db(self) -> float:
        """Level that 0 stands for."""
        return self._raw.low_db

    @property
    def step_db(self) -> float:
        """Decibels from one number to the next."""
        return self._raw.step_db

    @property
    def start_s(self) -> float:
        """First moment."""
        return self._raw.start_s

    @property
    def end_s(self) -> float:
        """Last moment."""
        return self._raw.end_s

    def set_cleaning(self, context: "CleaningContext | None") -> bool:
        """Show the cleaned sound from the next question on, with None the raw one; return whether that is a change."""
        if context is self._context:
            return False
        audio, self._context = self._raw.audio, context
        self._cleaned = _KeptSound(audio, context) if context is not None and audio is not None else None
        return True

    def columns(self, start_s: float, end_s: float, columns: int, plane: str = "max") -> Levels:
        """Return uint8 (bins, columns) between survey seconds; called in a worker thread."""
        cleaned, audio = self._cleaned, self._raw.audio
        if cleaned is None or audio is None or end_s - start_s > LONGEST_S:
            return self._raw.columns(start_s, end_s, columns, plane)
        from processing.sound.tiles import spectrogram_detail

        first, last = float(self._raw.clock.to_audio(start_s)), float(self._raw.clock.to_audio(end_s))
        with self._lock:
            try:
                return spectrogram_detail(audio, first, last, columns, plane, cleaned)
            finally:
                cleaned.close()  # a stick may be pulled out between two looks
