"""How loud a stream of sound is at this moment, channel by channel, and whether it can be trusted.

RMS over 300 ms; the highest peak of the same stretch; a held peak, which stands for 2 s and then falls by 20 dB in
1.7 s (the return time of a peak meter of type I, IEC 60268-10); clipping, at full scale or below it, latched until
cleared; digital silence; and the steady voltage. What it says does not depend on how the stream was cut into blocks.
"""

import threading
from collections import deque
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.live.stream import SoundFrames
from processing.sound.soundness import FULL_SCALE, clipped_at

CELL_S = 0.01  # all is counted in these
RMS_S = 0.3
HOLD_S = 2.0
FALL_DB_PER_S = 20.0 / 1.7
SILENCE_S = 1.0  # this long not one bit changed
CLIP_S = 1.0  # flat tops are looked for in stretches as long as this
OFFSET_S = 1.0
FLOOR_DB = -200.0  # stands for no sound at all; the last bit of 24 is at -138.5
_FULL = 2.0**31

Float64 = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Levels:
    """One look at the meter: one value a channel, levels in dB below full scale (a full sine has RMS -3.01)."""

    rms_db: tuple[float, ...]
    peak_db: tuple[float, ...]
    held_peak_db: tuple[float, ...]
    clipped: tuple[bool, ...]  # since it was last cleared
    offset: tuple[float, ...]  # mean of the last second, full scale is 1
    is_digital_silence: bool  # no channel changed by one bit for a second


class LevelMeter:
    """Takes the frames of one stream in turn; :meth:`levels` and :meth:`clear_clip` may be called from any thread."""

    def __init__(self, rate_hz: float, channels: int) -> None:
        self._cell = max(1, round(CELL_S * rate_hz))
        cells_per_s = rate_hz / self._cell
        self._channels = channels
        self._lock = threading.Lock()
        kept = round(max(RMS_S, OFFSET_S, SILENCE_S) * cells_per_s)
        self._rms_cells = max(1, round(RMS_S * cells_per_s))
        self._silent_cells = max(1, round(SILENCE_S * cells_per_s))
        self._hold_cells = round(HOLD_S * cells_per_s)
        self._fall = 10.0 ** (-FALL_DB_PER_S / cells_per_s / 20.0)
        self._clip_cells = max(1, round(CLIP_S * cells_per_s))
        # a row a finished cell and channel: sum, sum of squares, lowest, highest
        self._cells: deque[Float64] = deque(maxlen=kept)
        self._begun = np.zeros((0, channels), np.int32)  # frames of the cell that is not full yet
        self._for_clip: list[npt.NDArray[np.float32]] = []
        self._for_clip_cells = 0
        self._held = np.zeros(channels)
        self._held_for = np.zeros(channels, np.int64)
        self._clipped = np.zeros(channels, np.bool_)
        self._still = 0  # cells in a row in which no bit changed
        self._still_at: Float64 | None = None

    def add(self, frames: SoundFrames) -> None:
        """Take the next frames, (n, channels), full scale 2³¹."""
        if not len(frames):
            return
        together = np.concatenate([self._begun, frames]) if len(self._begun) else frames
        count = len(together) // self._cell
        whole, self._begun = together[: count * self._cell], together[count * self._cell :].copy()
        if not count:
            return
        # channel by channel: sums along neighbouring samples are ten times faster
        sound = np.multiply(whole.T, np.float32(1 / _FULL), dtype=np.float32, order="C")
        sound = sound.reshape(self._channels, count, self._cell)
        lowest, highest = sound.min(axis=2), sound.max(axis=2)
        squares = np.einsum("ijk,ijk->ij", sound, sound)
        cells = np.stack([sound.sum(axis=2), squares, lowest, highest]).astype(np.float64)
        with self._lock:
            for nth in range(count):
                self._take(cells[:, :, nth])
        self._look_for_flat_tops(sound, max(-float(lowest.min()), float(highest.max())))

    def levels(self) -> Levels:
        """Return the levels at the end of what was taken."""
        with self._lock:
            rows = np.array(self._cells).reshape(-1, 4, self._channels)
            held, clipped = self._held.copy(), self._clipped.copy()
            silent = self._still >= self._silent_cells
        recent = rows[-self._rms_cells :]
        frames = max(1, len(recent) * self._cell)
        rms = np.sqrt(recent[:, 1].sum(axis=0) / frames)
        peak = _magnitude(recent).max(axis=0, initial=0.0)
        offset = rows[:, 0].sum(axis=0) / max(1, len(rows) * self._cell)
        return Levels(
            _decibels(rms), _decibels(peak), _decibels(held), tuple(clipped.tolist()), tuple(offset.tolist()), silent
        )

    def clear_clip(self) -> None:
        """Forget that it clipped, and the held peaks."""
        with self._lock:
            self._clipped[:] = False
            self._held[:] = 0.0

    def _take(self, cell: Float64) -> None:
        self._cells.append(cell)
        peak = np.maximum(-cell[2], cell[3])
        self._held_for += 1
        falling = self._held_for > self._hold_cells
        self._held[falling] *= self._fall
        higher = peak >= self._held
        self._held[higher], self._held_for[higher] = peak[higher], 0
        is_still = bool((cell[2] == cell[3]).all())
        goes_on = is_still and self._still_at is not None and bool((cell[2] == self._still_at).all())
        self._still = self._still + 1 if goes_on else int(is_still)
        self._still_at = cell[2] if is_still else None

    def _look_for_flat_tops(self, sound: npt.NDArray[np.float32], peak: float) -> None:
        """Latch the lamp of channels that clip: at full scale at once, below it once a second of sound is there."""
        if peak >= FULL_SCALE:
            self._latch(sound)
        self._for_clip.append(sound)
        self._for_clip_cells += sound.shape[1]
        if self._for_clip_cells < self._clip_cells:
            return
        together = np.concatenate(self._for_clip, axis=1)
        while together.shape[1] >= self._clip_cells:
            self._latch(together[:, : self._clip_cells])
            together = together[:, self._clip_cells :]
        self._for_clip, self._for_clip_cells = [together], together.shape[1]

    def _latch(self, sound: npt.NDArray[np.float32]) -> None:
        for channel, of_channel in enumerate(sound):
            stands, _ = clipped_at(of_channel.reshape(-1), of_channel.min(axis=1), of_channel.max(axis=1))
            if stands is not None and stands.any():
                with self._lock:
                    self._clipped[channel] = True


def _magnitude(rows: Float64) -> Float64:
    return np.maximum(-rows[:, 2], rows[:, 3])


def _decibels(amplitude: Float64) -> tuple[float, ...]:
    with np.errstate(divide="ignore"):
        return tuple(np.maximum(20.0 * np.log10(amplitude), FLOOR_DB).tolist())
