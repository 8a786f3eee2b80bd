"""Where the odometer cannot be trusted: sliding, spinning on the spot, a lost attitude, a gyro at its limit.

Rolling ties rotation to motion: when the rolled speed ``u = r ω × ẑ`` changes, the accelerometer feels the same change,
``Δu = ∫ a dt``. A ball that lets go of the wall slows its turning without being braked, and is spun up again without
being pushed. What two such steps enclose was slid, at about the speed that went missing. How closely the two sides
agree elsewhere in the run sets the threshold, so that a rough road or a poor sensor raises no alarm.
A rest is no slip: it is braked and pushed like any motion. Slow slip is the fit's affair.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.orientation.quaternions import rotate
from processing.position.evidence import SlipSpan
from processing.position.odometry import Odometry
from processing.progress import Progress
from processing.survey import Attitude, BoolArray, FloatArray, ImuSamples

_BIN_S = 0.1
_BLOCK_ROWS = 250_000
_GRAVITY_MPS2 = 9.81
_WINDOW_S = 1.5
_LEAST_STEP_MPS = 0.25
_STEP_SHARE = 0.4  # of the usual speed
_STEP_SIGMAS = 8.0
_LONGEST_SLIDE_S = 120.0
_BLOW_MPS2 = 40.0  # a blow that sampling may have missed the middle of
_SPIN_RATIO = 2.0
_SPIN_RADPS = 1.0
_SPIN_WINDOW_S = 2.0
_TILT_MPS2 = 3.4  # gravity 20° off
_TILT_WINDOW_S = 3.0
_BAD_SHARE = 0.1
_BAD_WINDOW_S = 1.0
_LIMITS_DPS = (125.0, 245.0, 250.0, 300.0, 400.0, 450.0, 500.0, 1000.0, 2000.0, 4000.0)
_NEAR_LIMIT = 0.97
_LOST_HEADING_RAD = 0.5


@dataclass(frozen=True)
class _Bins:
    """Means over a tenth of a second: rolled velocity (k, 2), acceleration (k, 3) less gravity, turning (k, 3).

    ``bad`` is the share of rows that are missing or not valid, ``logged`` whether there is any row; ``blow`` is the
    largest specific force and ``peak`` the largest rate about an axis.
    """

    time_s: FloatArray
    rolled_mps: FloatArray
    acc_mps2: FloatArray
    turning_radps: FloatArray
    bad: FloatArray
    logged: BoolArray
    blow_mps2: FloatArray
    peak_radps: FloatArray


def find_slips(imu: ImuSamples, attitude: Attitude, odometry: Odometry, progress: Progress) -> tuple[SlipSpan, ...]:
    """Return the spans in which a rolling device did not roll, or its sensors could not tell, in order of time."""
    radius = odometry.quality.get("radius_m")
    if not isinstance(radius, float) or len(imu.time_s) < 2:
        return ()
    bins = _binned(imu, attitude, radius, progress)
    if len(bins.time_s) < 100:
        return ()
    spans = [*_limits(bins, imu), *_tilted(bins), *_spinning(bins)]
    if odometry.scale_sigma < 0.3:  # without a radius the two sides cannot be compared
        spans += _slides(bins, spans)
    return tuple(sorted(spans, key=lambda s: (s.start_s, s.end_s)))


def _binned(imu: ImuSamples, attitude: Attitude, radius_m: float, progress: Progress) -> _Bins:
    start = float(imu.time_s[0])
    count = int((float(imu.time_s[-1]) - start) / _BIN_S) + 1
    # a clock that jumps by years must not fill the memory
    count = min(count, 20 * len(imu.time_s))
    sums, good, logged = np.zeros((count, 6)), np.zeros(count), np.zeros(count)
    blow, peak = np.zeros(count), np.zeros(count)
    for low in range(0, len(imu.time_s), _BLOCK_ROWS):
        rows = np.arange(low, min(low + _BLOCK_ROWS, len(imu.time_s)))
        at = ((imu.time_s[rows] - start) / _BIN_S).astype(np.int64)
        logged += np.bincount(at[at < count], minlength=count)
        rows, at = rows[imu.valid[rows]], at[imu.valid[rows]]
        rows, at = rows[at < count], at[at < count]
        bias = attitude.bias_radps if attitude.bias_radps.ndim == 1 else attitude.bias_radps[rows]
        quat, gyr, acc = attitude.quat_ws[rows], imu.gyr_s_radps[rows] - bias, imu.acc_s_mps2[rows]
        both = np.hstack([rotate(quat, gyr), rotate(quat, acc)])
        for column in range(6):
            sums[:, column] += np.bincount(at, both[:, column], minlength=count)
        good += np.bincount(at, minlength=count)
        np.maximum.at(blow, at, np.linalg.norm(acc, axis=1))
        np.maximum.at(peak, at, np.max(np.abs(imu.gyr_s_radps[rows]), axis=1))
        progress.update((low + len(rows)) / len(imu.time_s), "position_slip")
    time_s = np.asarray(start + _BIN_S * (np.arange(count) + 0.5), dtype=np.float64)
    usual = max(float(np.median(good[good > 0])), 1.0) if np.any(good > 0) else 1.0
    mean = sums / np.maximum(good, 1.0)[:, None]
    for column in range(6):
        mean[:, column] = np.interp(time_s, time_s[good > 0], mean[good > 0, column]) if np.any(good > 0) else 0.0
    turning, acc = mean[:, :3], mean[:, 3:] - np.array([0.0, 0.0, _GRAVITY_MPS2])
    rolled = np.asarray(radius_m * np.column_stack([turning[:, 1], -turning[:, 0]]), dtype=np.float64)
    bad = np.clip(1.0 - good / usual, 0.0, 1.0)
    blow, peak = np.asarray(blow, dtype=np.float64), np.asarray(peak, dtype=np.float64)
    turning, acc = np.asarray(turning, dtype=np.float64), np.asarray(acc, dtype=np.float64)
    return _Bins(time_s, rolled, acc, turning, bad, logged > 0, blow, peak)


def _smooth(values: FloatArray, window_s: float) -> FloatArray:
    from scipy.ndimage import uniform_filter1d

    return np.asarray(uniform_filter1d(values, max(round(window_s / _BIN_S), 1), axis=0, mode="nearest"))


def _spans(flags: BoolArray, time_s: FloatArray, margin_s: float) -> list[tuple[float, float]]:
    """Spans of time of the true rows, widened by ``margin_s`` and joined where they then touch."""
    edges = np.flatnonzero(np.diff(flags.astype(np.int8), prepend=0, append=0))
    out: list[tuple[float, float]] = []
    for low, high in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        start, end = float(time_s[low]) - margin_s, float(time_s[high - 1]) + margin_s
        if out and start <= out[-1][1]:
            out[-1] = (out[-1][0], end)
        else:
            out.append((start, end))
    return out


def _limits(bins: _Bins, imu: ImuSamples) -> list[SlipSpan]:
    """Spans with many rows that are masked: where the rates beside them stand at a gyro's range, it was the range.

    Holes without any row belong to the odometer, which bridges and names them.
    """
    share = _smooth(bins.bad, _BAD_WINDOW_S)
    flags = (share > _BAD_SHARE) & bins.logged
    if not np.any(flags) or bool(np.all(imu.valid)):
        return []
    out = []
    limits = np.radians(_LIMITS_DPS)
    top = float(bins.peak_radps.max())
    ranged = bool(np.any((top > _NEAR_LIMIT * limits) & (top < 1.01 * limits)))
    for start, end in _spans(flags, bins.time_s, 0.0):
        inside = (bins.time_s >= start - _BAD_WINDOW_S) & (bins.time_s <= end + _BAD_WINDOW_S)
        at_limit = ranged and float(bins.peak_radps[inside].max()) > 0.9 * top
        lost = min(float(share[inside].max()), 1.0)
        reason = "slip_gyro_limit" if at_limit else ""
        out.append(SlipSpan(start, end, reason, lost, 0.0, _LOST_HEADING_RAD * lost if at_limit else 0.0))
    return out


def _tilted(bins: _Bins) -> list[SlipSpan]:
    """Spans in which the mean specific force, less what rolling explains, is far from the vertical."""
    felt = _smooth(bins.acc_mps2, _TILT_WINDOW_S)
    width = max(round(_TILT_WINDOW_S / _BIN_S), 2)
    explained = np.zeros((len(felt), 2))
    half = width // 2
    if len(felt) > 2 * half:
        explained[half:-half] = (bins.rolled_mps[2 * half :] - bins.rolled_mps[: -2 * half]) / (2 * half * _BIN_S)
    off = np.hypot(*(felt[:, :2] - explained).T)
    flags = (off > _TILT_MPS2) | (felt[:, 2] < -0.4 * _GRAVITY_MPS2)
    flags &= _smooth(bins.bad, _TILT_WINDOW_S) < 0.5
    return [
        SlipSpan(a, b, "slip_attitude_lost", 1.0, 0.0, _LOST_HEADING_RAD)
        for a, b in _spans(flags, bins.time_s, 0.5 * _TILT_WINDOW_S)
    ]


def _spinning(bins: _Bins) -> list[SlipSpan]:
    """Spans in which the ball spins about the vertical much more than it rolls: it floats, or is caught in an eddy."""
    upright = _smooth(np.abs(bins.turning_radps[:, 2]), _SPIN_WINDOW_S)
    level = _smooth(np.hypot(bins.turning_radps[:, 0], bins.turning_radps[:, 1]), _SPIN_WINDOW_S)
    flags = upright > _SPIN_RATIO * level + _SPIN_RADPS
    return [
        SlipSpan(a, b, "slip_spinning", 1.0, 0.5) for a, b in _spans(flags, bins.time_s, 0.0) if b - a > _SPIN_WINDOW_S
    ]


@dataclass(frozen=True)
class _Step:
    """At bin ``row`` the rolled velocity changed by ``missing_mps`` more than was felt, and the rolled speed rose or
    fell by ``rise_mps``."""

    row: int
    missing_mps: float
    rise_mps: float


def _slides(bins: _Bins, known: list[SlipSpan]) -> list[SlipSpan]:
    """Spans between a step of the turning that no push explains and the step that undoes it.

    Slower turning that nothing braked is a slide; quicker turning that nothing pushed is a ball caught on the spot.
    """
    speed = _smooth(np.hypot(*bins.rolled_mps.T), 0.5)
    steps = _unfelt_steps(bins, speed, known)
    half = round(0.5 * _WINDOW_S / _BIN_S)
    most = round(_LONGEST_SLIDE_S / _BIN_S)
    out: list[SlipSpan] = []
    k = 0
    while k < len(steps):
        step = steps[k]
        low, high = step.row, step.row
        undone = _undone_by(steps, k, most)
        if undone is not None:
            high = steps[undone].row
            k = undone
        elif step.rise_mps < 0.0:  # its end was too gentle: until it turns again as before
            again = speed[high + half : high + most] > speed[max(low - half, 0)] + 0.5 * step.rise_mps
            high += half + int(np.argmax(again)) if np.any(again) else 0
        else:
            before = speed[max(low - most, 0) : max(low - half, 0)][::-1]
            again = before > speed[min(high + half, len(speed) - 1)] - 0.5 * step.rise_mps
            low -= half + int(np.argmax(again)) if np.any(again) else 0
        start, end = (float(bins.time_s[np.clip(r, 0, len(speed) - 1)]) for r in (low - half, high + half))
        reason = "slip_slid" if step.rise_mps < 0.0 or low < step.row else "slip_on_the_spot"
        out.append(SlipSpan(start, end, reason, 1.0, step.missing_mps * (end - start)))
        k += 1
    return out


def _undone_by(steps: list[_Step], k: int, most: int) -> int | None:
    """The next step back to the speed before; a slide round a bend leaves others between, that change no speed."""
    for later in range(k + 1, len(steps)):
        rise = steps[later].rise_mps
        if steps[later].row - steps[k].row > most or rise * steps[k].rise_mps > 0.25 * steps[k].rise_mps ** 2:
            return None
        if rise * steps[k].rise_mps < -0.25 * steps[k].rise_mps ** 2:
            return later
    return None


def _unfelt_steps(bins: _Bins, speed: FloatArray, known: list[SlipSpan]) -> list[_Step]:
    half = max(round(0.5 * _WINDOW_S / _BIN_S), 1)
    if len(bins.time_s) <= 4 * half:
        return []
    moving = speed > 0.05
    if np.count_nonzero(moving) < 10 * half:
        return []
    # a turn's lever arm and wobble average out over some tenths
    rolled, felt = _smooth(bins.rolled_mps, 0.5), np.cumsum(bins.acc_mps2[:, :2], axis=0) * _BIN_S
    felt = _smooth(felt, 0.5)
    missing = np.zeros_like(rolled)
    span = slice(half, -half)
    missing[span] = rolled[2 * half :] - rolled[: -2 * half] - (felt[2 * half :] - felt[: -2 * half])
    # a slow lean of the attitude, over ten seconds, is no step
    missing -= _medians(missing, round(10.0 / _BIN_S))
    size = np.hypot(*missing.T)
    usual = float(np.median(size[moving])) / 1.1774  # Rayleigh
    # a knock is felt and turns nothing: sampling may make a push of it, but no slip
    turned = np.zeros(len(size))
    turned[span] = np.hypot(*(rolled[2 * half :] - rolled[: -2 * half]).T)
    size[turned < 0.5 * size] = 0.0
    limit = max(_LEAST_STEP_MPS, _STEP_SHARE * float(np.median(speed[moving])), _STEP_SIGMAS * usual)
    size[_smooth((bins.blow_mps2 > _BLOW_MPS2).astype(float), 2.0 * _WINDOW_S) > 0.0] = 0.0
    # a tenth of a second holds one row more or less: that is no hole
    size[_smooth(bins.bad, 2.0 * _WINDOW_S) > _BAD_SHARE] = 0.0
    for span_known in known:
        size[(bins.time_s > span_known.start_s - 2.0) & (bins.time_s < span_known.end_s + 2.0)] = 0.0
    return [
        _Step(int(row), float(size[row]), float(speed[min(row + half, len(speed) - 1)] - speed[row - half]))
        for row in _tops(size, limit, 2 * half)
    ]


def _medians(values: FloatArray, window: int) -> FloatArray:
    from scipy.ndimage import median_filter

    return np.column_stack([median_filter(column, window, mode="nearest") for column in values.T])


def _tops(size: FloatArray, limit: float, apart: int) -> npt.NDArray[np.intp]:
    from scipy.ndimage import maximum_filter1d

    return np.flatnonzero((size >= maximum_filter1d(size, 2 * apart + 1)) & (size > limit))
