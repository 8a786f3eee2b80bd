"""Sudden changes of the pressure: valves, pumps that start or stop, water hammer; when, how large, and how they ring.

A change counts as sudden where the means of a third of a second on either side differ by more than the channel's own
scatter and by more than the device could climb meanwhile. Slow surges, and a ball that rolls down a slope, are none.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import ndimage, signal

from processing.orientation.binning import BinSums
from processing.sound.background import robust_sigma
from processing.survey import BoolArray, FloatArray, ImuSamples, Track

KPA_PER_M = 9.81
_RATE_HZ = 30.0
_BLOCK = 500_000
_SIDE_S = 0.3
_SIGMAS = 8.0
_LEAST_KPA = 1.0
_STEEPEST = 0.5  # m/m: nothing rolls through a steeper pipe
_AFTER_S = 12.0  # a transient's ringing is looked for so long
_APART_S = 4.0
_BEFORE_S = 2.0
_LASTING_SHARE = 0.5  # of the size: else the pressure came back
_CYCLES = 3.0
_RING_SHARE = 0.5  # of the power after the onset, in one line
_MOST = 10_000


@dataclass(frozen=True)
class Transient:
    """One sudden change at survey time ``time_s``.

    ``size_kpa`` is the largest departure within the seconds after, with its sign; ``lasting_kpa`` what stays.
    ``ringing_hz`` and ``ringing_kpa`` (amplitude at the onset, fading in ``fading_s``) are 0 where it does not ring.
    """

    time_s: float
    size_kpa: float
    lasting_kpa: float
    ringing_hz: float = 0.0
    ringing_kpa: float = 0.0
    fading_s: float = 0.0

    @property
    def kind(self) -> str:
        """``hammer`` where it rings, ``step`` where the change stays, else ``pulse``."""
        if self.ringing_hz > 0.0:
            return "hammer"
        return "step" if abs(self.lasting_kpa) >= _LASTING_SHARE * abs(self.size_kpa) else "pulse"


@dataclass(frozen=True)
class PressureRows:
    """The pressure in even rows: ``values_kpa`` (n,) from ``start_s`` on, bridged where not ``known`` (n,)."""

    start_s: float
    rate_hz: float
    values_kpa: FloatArray
    known: BoolArray

    @property
    def time_s(self) -> FloatArray:
        """Middles of the rows."""
        return np.asarray(self.start_s + (np.arange(len(self.values_kpa)) + 0.5) / self.rate_hz, np.float64)


def pressure_rows(imu: ImuSamples, rate_hz: float = _RATE_HZ) -> PressureRows | None:
    """Return the means of the valid readings in rows of ``1/rate_hz``, blockwise; None without a pressure.

    A hole longer than a minute is cut short by the binning; nothing is looked for in one.
    """
    if imu.pressure_kpa is None or len(imu.time_s) < 2:
        return None
    width = 1.0 / min(rate_hz, imu.sample_rate_hz)
    sums = BinSums(float(imu.time_s[0]), width, 2, most_empty=round(3600.0 / width))
    for start in range(0, len(imu.time_s), _BLOCK):
        rows = slice(start, start + _BLOCK)
        good = imu.valid[rows] & np.isfinite(imu.pressure_kpa[rows])
        kept = imu.pressure_kpa[rows][good]
        sums.add(imu.time_s[rows][good], np.column_stack([np.ones(len(kept)), kept]))
    found = sums.result()
    some = found.sums[:, 0] > 0
    if np.count_nonzero(some) < 2:
        return None
    number = found.number[some] - found.number[some][0]
    values = found.sums[some, 1] / found.sums[some, 0]
    count = int(number[-1]) + 1
    if count > 4 * len(found.number) + 1000:  # a clock that jumps by years
        return None
    known = np.zeros(count, np.bool_)
    known[number] = True
    whole = np.interp(np.arange(count), number, values)
    start_s = float(found.start_of[some][0])
    return PressureRows(start_s, 1.0 / width, np.asarray(whole, np.float64), known)


def find_transients(rows: PressureRows, track: Track | None = None) -> tuple[Transient, ...]:
    """Return the transients in order of time; ``track`` tells how far the device may have climbed meanwhile."""
    side = max(2, round(_SIDE_S * rows.rate_hz))
    values = rows.values_kpa
    if len(values) < 8 * side:
        return ()
    total = np.concatenate([[0.0], np.cumsum(values - values[0])])
    at = np.arange(side, len(values) - side)
    change = (total[at + side] - 2.0 * total[at] + total[at - side]) / side
    climb = _climb_kpa(rows, at, side, track)
    limit = np.maximum(max(_SIGMAS * robust_sigma(change), _LEAST_KPA), climb)
    whole = ndimage.uniform_filter1d(rows.known.astype(np.float64), 2 * side + 1)[at] > 0.99
    hits = np.flatnonzero((np.abs(change) > limit) & whole)
    out: list[Transient] = []
    last_s = -np.inf
    for group in np.split(hits, np.flatnonzero(np.diff(hits) > 1) + 1) if len(hits) else []:
        peak = int(group[np.argmax(np.abs(change[group]))])
        time_s = rows.start_s + float(at[peak]) / rows.rate_hz
        if time_s - last_s < _APART_S:
            last_s = time_s  # it still rings
            continue
        out.append(_measured(rows, _onset(rows, int(at[peak]), side)))
        last_s = time_s
        if len(out) == _MOST:
            break
    return tuple(out)


def _climb_kpa(rows: PressureRows, at: npt.NDArray[np.int64], side: int, track: Track | None) -> FloatArray:
    if track is None:
        return np.zeros(len(at))
    way = np.interp(rows.time_s, track.time_s, track.chainage_m)
    return np.asarray(_STEEPEST * KPA_PER_M * np.abs(way[at + side] - way[at - side]) * 0.5, np.float64)


def _onset(rows: PressureRows, at: int, side: int) -> int:
    """Return the first row that has left the level before by a third of what follows: ringing moves the means' peak."""
    low = max(0, at - side - round(_BEFORE_S * rows.rate_hz))
    before = rows.values_kpa[low : max(at - side, low + 1)]
    near = np.abs(rows.values_kpa[at - side : at + side] - float(np.median(before)))
    left = near > max(float(near.max()) / 3.0, 4.0 * robust_sigma(before))
    return at - side + int(np.argmax(left)) if left.any() else at


def _measured(rows: PressureRows, at: int) -> Transient:
    """Return the transient that begins at row ``at``."""
    rate = rows.rate_hz
    time_s = rows.start_s + at / rate
    before = rows.values_kpa[max(0, at - round(_BEFORE_S * rate)) : max(1, at - 1)]
    after = rows.values_kpa[at : at + round(_AFTER_S * rate)]
    level = float(np.median(before))
    rest = after - level
    smooth = ndimage.uniform_filter1d(rest, max(1, round(0.1 * rate)))
    size = float(smooth[np.argmax(np.abs(smooth[: max(2, round(_APART_S * rate))]))])
    lasting = float(np.median(rest[len(rest) // 3 :]))
    hz, amplitude, fading = _ringing(rest - lasting, rate, abs(size))
    return Transient(time_s, size, lasting, hz, amplitude, fading)


def _ringing(rest: FloatArray, rate_hz: float, size: float) -> tuple[float, float, float]:
    """Return frequency, amplitude at the onset and time constant of a damped oscillation; zeros where there is none."""
    if len(rest) < 16 or size <= 0.0:
        return 0.0, 0.0, 0.0
    count = 4 * len(rest)
    power = np.square(np.abs(np.fft.rfft((rest - rest.mean()), count)))
    frequency = np.fft.rfftfreq(count, 1.0 / rate_hz)
    usable = frequency >= _CYCLES * rate_hz / len(rest)
    if not usable.any():
        return 0.0, 0.0, 0.0
    best = int(np.argmax(np.where(usable, power, 0.0)))
    hz = float(frequency[best])
    width = max(2.0 * rate_hz / len(rest), 0.25 * hz)
    line = float(power[np.abs(frequency - hz) <= width].sum())
    if line < _RING_SHARE * float(power[1:].sum()):
        return 0.0, 0.0, 0.0
    time_s = np.arange(len(rest)) / rate_hz
    carrier = rest * np.exp(-2j * np.pi * hz * time_s)
    window = signal.windows.hann(2 * max(1, round(0.75 * rate_hz / hz)) + 1)
    slow = 2.0 * np.abs(np.convolve(carrier, window / window.sum(), mode="same"))
    inside = slice(len(window) // 2, None)  # the window's half before it has no sound in it
    heard = slow[inside] > 0.15 * slow[inside].max(initial=0.0)
    length = int(np.argmin(heard)) if not heard.all() else len(heard)
    if length < max(4, round(1.5 * rate_hz / hz)):
        return 0.0, 0.0, 0.0
    slope, start = np.polyfit(time_s[inside][:length], np.log(slow[inside][:length]), 1)
    fading = float(np.clip(-1.0 / min(slope, -1e-3), 0.0, 1e3))
    amplitude = float(min(np.exp(start), 3.0 * size))
    if amplitude < 0.15 * size or fading * hz < 0.7:
        return 0.0, 0.0, 0.0
    return hz, amplitude, fading
