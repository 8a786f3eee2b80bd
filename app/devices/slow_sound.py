"""Makes sound last longer at the same pitch: waveform-similarity overlap-add (Verhelst & Roelands, ICASSP 1993).

Slowed at the same pitch rather than played slower: a leak is told from other noises by where in the spectrum it hisses,
which a tape at half speed would move down an octave. Steady noise comes through as it was, bumps come as often as twice
the time between them.
"""

import numpy as np

from app.devices.audio_output import FloatBlock, ReadFrames

_HOP_S = 0.012  # half an overlap; short enough for knocks, long enough for the tones of a pump
_SEARCH_S = 0.008  # how far from its place a piece may be taken


class SlowSound:
    """Wraps a reader: ``factor`` times as many samples come as are asked for; jumps and changes begin anew."""

    def __init__(self, read: ReadFrames, sample_rate_hz: float) -> None:
        self.factor = 1
        self._read = read
        self._hop = max(8, round(_HOP_S * sample_rate_hz))
        self._search = max(4, round(_SEARCH_S * sample_rate_hz))
        angle = np.pi * (np.arange(2 * self._hop) + 0.5) / (2 * self._hop)
        self._window = np.square(np.sin(angle)).astype(np.float32)
        self._began(-1, 1)

    def _began(self, start: int, factor: int) -> None:
        self._next, self._making = start, factor
        self._sound = np.zeros(0, np.float32)  # read ahead
        self._sound_at = start  # its first frame
        self._ready: list[FloatBlock] = []
        self._tail = np.zeros(0, np.float32)  # second half of the last piece, to be overlapped
        self._place = float(start)  # of the next piece, in frames
        self._follow = start  # where the sound itself goes on after the last piece

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return ``factor · count`` samples for ``count`` frames from ``start`` on; fewer where the sound ends."""
        factor = max(1, int(self.factor))
        if factor == 1:
            self._next = -1
            return self._read(start, count)
        if start != self._next or factor != self._making:
            self._began(start, factor)
        self._next = start + count
        wanted = factor * count
        while sum(map(len, self._ready)) < wanted:
            piece = self._piece()
            if piece.size == 0:
                break
            self._ready.append(piece)
        sound = np.concatenate([np.zeros(0, np.float32), *self._ready])
        self._ready = [sound[wanted:]]
        return sound[:wanted]

    def _piece(self) -> FloatBlock:
        """Return the next hop of slowed sound; empty at the end."""
        hop = self._hop
        place = round(self._place)
        if self._tail.size == 0:
            raw = self._frames(place, 2 * hop)
            at = place
        else:
            low = max(place - self._search, self._sound_at)
            region = self._frames(low, 2 * hop + place + self._search - low)
            goal = self._frames(self._follow, hop)
            at = low + _most_alike(region[: len(region) - hop], goal)
            raw = region[at - low : at - low + 2 * hop]
        if len(raw) < 2 * hop:
            last, self._tail = self._tail, np.zeros(0, np.float32)
            return last
        shaped = raw * self._window
        first = raw[:hop] if self._tail.size == 0 else self._tail + shaped[:hop]
        self._tail = shaped[hop:]
        self._follow = at + hop
        self._place += hop / self._making
        self._forget(min(self._follow, round(self._place) - self._search))
        return np.asarray(first, np.float32)

    def _frames(self, first: int, count: int) -> FloatBlock:
        """Return frames that were read ahead, reading on where they do not suffice."""
        missing = first + count - self._sound_at - len(self._sound)
        if missing > 0:
            more = self._read(self._sound_at + len(self._sound), max(missing, 4 * self._hop))
            self._sound = np.concatenate([self._sound, more])
        return self._sound[first - self._sound_at : first - self._sound_at + count]

    def _forget(self, before: int) -> None:
        drop = max(0, before - self._sound_at)
        self._sound, self._sound_at = self._sound[drop:], self._sound_at + drop


def _most_alike(region: FloatBlock, goal: FloatBlock) -> int:
    """Return where in ``region`` the sound is most like ``goal``, by normalised correlation."""
    if len(region) < len(goal) or not len(goal):
        return 0
    size = len(region) + len(goal)
    both = np.fft.irfft(np.fft.rfft(region, size) * np.conj(np.fft.rfft(goal, size)), size)
    both = both[: len(region) - len(goal) + 1]
    energy = np.concatenate([[0.0], np.cumsum(np.square(region, dtype=np.float64))])
    energy = energy[len(goal) :] - energy[: -len(goal)]
    return int(np.argmax(both / np.sqrt(energy + 1e-12)))
