"""Rests of a device as they happen, and what they tell of its gyro: the live counterpart of orientation/rests.py.

Sums over quarter-second bins; four of them are the window whose scatter is held against the same thresholds as after
the run. A rest's first and last bins may hold the end or the onset of motion and are left out.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np

from processing.orientation.calibration import STANDARD_GRAVITY_MPS2, Calibration
from processing.settings import OrientationSettings
from processing.survey import FloatArray, ImuSamples

_BIN_S = 0.25
_WINDOW = 4
_EDGE = 2  # bins at the end of a rest that are not trusted until more follow
_WALK_RADPS_RTS = np.radians(3e-3)  # bias random walk of consumer MEMS (navigation §6.4)
_INSTABILITY_RADPS = np.radians(0.003)  # a rest, however long, tells the bias no better (navigation §6.2)
_UNKNOWN_RADPS = np.radians(1.0)
_NOISIEST_RADPS = np.radians(0.05)  # of a mean over a rest of two seconds: worse is no measurement of an offset


@dataclass(frozen=True)
class _Bin:
    """Sums over a quarter second: samples, and of acc and gyr (6,) the values and their squares."""

    number: int
    count: int
    first: FloatArray
    second: FloatArray


class RestWatch:
    """Samples go in; whether the device lies still, and its gyro's offset with gravity, come out."""

    def __init__(self, settings: OrientationSettings) -> None:
        """Begin with nothing known: an offset of zero ± 1 °/s."""
        self._settings = settings
        self._least = int(np.ceil(settings.rest_min_s / _BIN_S))
        self._open: _Bin | None = None
        self._recent: deque[_Bin] = deque(maxlen=_WINDOW)
        self._run: list[_Bin] = []  # bins of the rest under way
        self._told = 0  # bins of it that have already been made use of
        self._prior = (np.zeros(3), _UNKNOWN_RADPS, -np.inf)  # offset, its sigma and when, before this rest
        self._gravity_sum, self._gravity_count = 0.0, 0.0
        self._bias, self._sigma, self._at_s = np.zeros(3), float(_UNKNOWN_RADPS), 0.0
        self.rests = 0
        self.is_resting = False

    def add(self, imu: ImuSamples) -> bool:
        """Take trusted rows (m,); return whether the calibration has become better."""
        place = np.floor(imu.time_s / _BIN_S).astype(np.int64)
        starts = np.flatnonzero(np.diff(place, prepend=place[:1] - 1))
        both = np.column_stack([imu.acc_s_mps2, imu.gyr_s_radps])
        first, second = (np.add.reduceat(v, starts, axis=0) for v in (both, both * both))
        counts = np.diff(np.append(starts, len(place)))
        better = False
        for k, number in enumerate(place[starts].tolist()):
            part = _Bin(number, int(counts[k]), first[k], second[k])
            if self._open is not None and self._open.number == number:
                self._open = _added(self._open, part)
                continue
            if self._open is not None:
                better |= self._close(self._open)
            self._open = part
        return better

    def calibration(self) -> Calibration:
        """Return what the rests so far have told."""
        known = self.rests > 0
        gravity = self._gravity_sum / self._gravity_count if self._gravity_count else 0.0
        return Calibration(
            bias_time_s=np.array([self._at_s]),
            bias_radps=self._bias[None].copy(),
            bias_sigma_radps=np.full((1, 3), self._sigma),
            basis="rest" if known else "none",
            gravity_mps2=gravity if gravity > 0.0 else STANDARD_GRAVITY_MPS2,  # a dead accelerometer reads none
        )

    def _close(self, whole: _Bin) -> bool:
        """Judge a bin that is complete; return whether the calibration has become better."""
        if self._recent and whole.number != self._recent[-1].number + 1:
            self._recent.clear()
        self._recent.append(whole)
        if len(self._recent) < _WINDOW or not self._is_quiet():
            return self._end_rest() if self.is_resting else False
        if not self.is_resting:
            self.is_resting = True
            self._run, self._told = list(self._recent), 0
            self._prior = (self._bias, self._sigma, self._at_s if self.rests else -np.inf)
        else:
            self._run.append(whole)
        # at two seconds, then whenever it has become half as long again
        if len(self._run) - _EDGE >= max(self._least, 1.5 * self._told):
            return self._use()
        return False

    def _is_quiet(self) -> bool:
        count = sum(b.count for b in self._recent)
        mean = np.sum([b.first for b in self._recent], axis=0) / count
        scatter = np.sum([b.second for b in self._recent], axis=0) / count - mean * mean
        acc, gyr = (float(np.sqrt(max(v.sum(), 0.0))) for v in (scatter[:3], scatter[3:]))
        s = self._settings
        return bool(
            count >= 4
            and acc < s.rest_acc_std_mps2
            and gyr < np.radians(s.rest_gyr_std_dps)
            and float(np.linalg.norm(mean[3:])) < np.radians(s.rest_gyr_mean_dps)
        )

    def _end_rest(self) -> bool:
        self.is_resting = False
        better = len(self._run) - _EDGE > max(self._told, self._least) and self._use()
        self._run, self._told = [], 0
        return better

    def _use(self) -> bool:
        """Take the offset from the rest under way; a rate unlike the offset known was a slow steady turn."""
        bins = self._run[1 : len(self._run) - _EDGE]
        count = sum(b.count for b in bins)
        mean = np.sum([b.first for b in bins], axis=0) / count
        variance = np.maximum(np.sum([b.second for b in bins], axis=0) / count - mean * mean, 0.0)
        before, sigma, at_s = self._prior
        if np.isfinite(at_s) and np.linalg.norm(mean[3:] - before) > np.radians(self._settings.rest_agree_dps):
            return False
        noise = float(np.sqrt(np.mean(variance[3:]) / count))
        read = float(np.hypot(noise, _INSTABILITY_RADPS))
        if read > _NOISIEST_RADPS:
            return False
        now_s = (bins[-1].number + 1) * _BIN_S
        if np.isfinite(at_s):
            sigma = float(np.hypot(sigma, _WALK_RADPS_RTS * np.sqrt(max(now_s - at_s, 0.0))))
        gain = sigma**2 / (sigma**2 + read**2)
        self._bias, self._sigma, self._at_s = before + gain * (mean[3:] - before), float(np.sqrt(gain)) * read, now_s
        if self._told == 0:
            self.rests += 1
        weight = count - sum(b.count for b in self._run[1 : 1 + self._told])
        self._gravity_sum += weight * float(np.linalg.norm(mean[:3]))
        self._gravity_count += weight
        self._told = len(bins)
        return True


def _added(a: _Bin, b: _Bin) -> _Bin:
    return _Bin(a.number, a.count + b.count, a.first + b.first, a.second + b.second)
