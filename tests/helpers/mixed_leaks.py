"""Real recordings mixed into a simulated run: leaks that the device passes, and noise that is there all the time.

A recording is cut into pieces of six seconds, drawn at random and faded into each other with constant power, so that it
lasts as long as wanted without a period. What lies below 300 Hz is cut from leaks: there the recordings of
``hydrophone_pvc`` hold the rig's pump and building, no less without a leak than with one.

A leak's ``snr_db`` is that in 800–3200 Hz at closest approach, above flow and rolling noise at nominal speed, by the
recording's steady part: the median over 64 ms, since the mean of these recordings is that of their knocks.
"""

from dataclasses import dataclass

import numpy as np
import soundfile as sf
from scipy import signal

from processing.simulation.sources import background_shape

SNR_BAND_HZ = (800.0, 3200.0)
CUT_HZ = 300.0
_PIECE_S, _FADE_S = 6.0, 0.5


@dataclass(frozen=True)
class MixedLeak:
    """A passed leak that sounds like the recording ``kind``: power 1/(1 + ((s − chainage_m)/half_width_m)²)."""

    kind: str
    chainage_m: float
    half_width_m: float
    snr_db: float


def recording(path, rate_hz):
    """Return the first channel of a recording at ``rate_hz``, without its mean."""
    x, own_rate = sf.read(path, always_2d=True)
    x = x[:, 0] - np.mean(x[:, 0])
    if own_rate != rate_hz:
        factor = np.gcd(int(own_rate), int(rate_hz))
        x = signal.resample_poly(x, int(rate_hz) // factor, int(own_rate) // factor)
    return x


def high_passed(x, rate_hz, cut_hz=CUT_HZ):
    """Return ``x`` without what lies below ``cut_hz``."""
    return signal.sosfiltfilt(signal.butter(4, cut_hz, "high", fs=rate_hz, output="sos"), x)


def limited(x, rate_hz, over_db=3.0):
    """Return ``x`` with its knocks and surges held down to ``over_db`` above the median over 64 ms."""
    frame = int(0.064 * rate_hz)
    level = np.sqrt(np.mean(x[: len(x) // frame * frame].reshape(-1, frame) ** 2, axis=1))
    gain = np.minimum(1.0, np.median(level) * 10 ** (over_db / 20) / np.maximum(level, 1e-12))
    middles = (np.arange(len(level)) + 0.5) * frame
    return x * np.interp(np.arange(len(x)), middles, gain)


def lasting(x, count, rate_hz, rng):
    """Return ``count`` samples of the recording ``x`` without a period: pieces of it, faded with constant power."""
    piece, fade = int(_PIECE_S * rate_hz), int(_FADE_S * rate_hz)
    piece = min(piece, len(x) - 1)
    fade = min(fade, piece // 3)
    rise = np.sin(0.5 * np.pi * (np.arange(fade) + 0.5) / fade)
    window = np.concatenate([rise, np.ones(piece - 2 * fade), rise[::-1]])
    out = np.zeros(count + piece, np.float32)
    for start in range(0, count, piece - fade):
        at = int(rng.integers(0, len(x) - piece))
        out[start : start + piece] += (window * x[at : at + piece]).astype(np.float32)
    # the first piece rises from nothing: let the sound begin where it is full
    return np.concatenate([out[fade:count], out[:fade]]) if count > fade else out[:count]


def band_power(x, rate_hz, low_hz, high_hz):
    """Return the power (of full scale squared) of ``x`` within a band."""
    f, p = signal.welch(x, rate_hz, nperseg=4096)
    return float(p[(f >= low_hz) & (f < high_hz)].sum() * (f[1] - f[0]))


def steady_power(x, rate_hz, low_hz, high_hz):
    """Return the median power over 64 ms of ``x`` within a band."""
    inside = signal.sosfiltfilt(signal.butter(4, (low_hz, high_hz), "band", fs=rate_hz, output="sos"), x)
    frame = int(0.064 * rate_hz)
    return float(np.median(np.mean(inside[: len(inside) // frame * frame].reshape(-1, frame) ** 2, axis=1)))


def background_power(scenario, low_hz, high_hz):
    """Return the power of flow and rolling noise at nominal speed within a band."""
    hz = np.fft.rfftfreq(8192, 1 / scenario.sound.rate_hz)
    return float(background_shape(scenario, hz)[(hz >= low_hz) & (hz < high_hz)].sum())


class Mixed:
    """Adds real sounds to a run, block by block; called as ``mixed(block, first, run)``.

    ``recordings`` are (n,) samples at the run's rate by kind; ``noises`` are (kind, steady power in the SNR band above
    the run's own background in dB, low cut in Hz) that sound all the time.
    """

    def __init__(self, leaks, recordings, noises=(), seed=0):
        self.leaks, self.noises, self.seed = tuple(leaks), tuple(noises), seed
        self._recordings = recordings
        self._tracks = None

    def __repr__(self):
        return f"steady {self.leaks} {self.noises} {self.seed}"

    def __call__(self, block, first, run):
        if self._tracks is None:
            self._tracks = self._made(run)
        rate = run.sound.rate_hz
        out = np.array(block, np.float32)
        coarse = np.append(np.arange(0, len(block), 256), len(block) - 1)
        t = run.clock.to_survey((first + coarse) / rate)
        chainage = np.interp(t, run.motion.time_s, run.motion.chainage_m)
        for leak, start, samples in self._tracks:
            a, b = max(start, first), min(start + len(samples), first + len(block))
            if a >= b:
                continue
            part = samples[a - start : b - start]
            if leak is not None:
                away = (chainage - leak.chainage_m) / leak.half_width_m
                gain = np.interp(np.arange(a - first, b - first), coarse, 1 / np.sqrt(1 + away**2))
                part = part * gain.astype(np.float32)
            out[a - first : b - first] += part
        return out

    def _made(self, run):
        rate = run.sound.rate_hz
        below = background_power(run.scenario, *SNR_BAND_HZ)
        tracks = []
        for number, leak in enumerate(self.leaks):
            rng = np.random.default_rng([self.seed, 95, number])
            x = high_passed(self._recordings[leak.kind], rate)
            x = x * np.sqrt(below * 10 ** (leak.snr_db / 10) / steady_power(x, rate, *SNR_BAND_HZ))
            # as far as the run goes: a strong leak is heard far off
            tracks.append((leak, 0, lasting(x, run.sound.frames, rate, rng)))
        for number, (kind, level_db, cut_hz) in enumerate(self.noises):
            rng = np.random.default_rng([self.seed, 96, number])
            x = high_passed(self._recordings[kind], rate, cut_hz)
            x = x * np.sqrt(below * 10 ** (level_db / 10) / steady_power(x, rate, *SNR_BAND_HZ))
            tracks.append((None, 0, lasting(x, run.sound.frames, rate, rng)))
        return tracks
