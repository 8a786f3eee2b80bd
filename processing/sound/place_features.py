"""Measures what one place of a run sounds like: the same figures for a candidate and for any place without one.

Each figure answers one question that a listener asks (does it rumble, gurgle, knock, hum, does it belong to the place
or to the moment); :mod:`processing.sound.classes` weighs them, the evidence panel shows them against their background.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.sound.cells import impulses
from processing.sound.ground import Ground, nearest, tone_span_s
from processing.survey import BoolArray, FloatArray

Features = dict[str, float]

FEATURES = (
    "rumble_db",
    "flutter",
    "impulsive_share",
    "knock",
    "joint_m",
    "turn_deg",
    "valve_m",
    "tones_db",
    "tones_s",
    "place_not_moment",
    "width_m",
    "peak_hz",
    "spread_octaves",
    "lopsided",
    "speed_ratio",
)

_REACH_M, _REACH_S = 24.0, 60.0  # of the background
_CELL_M, _CELL_S = 0.5, 1.0
_LOW_HZ = 300.0  # bends, valves and traffic rumble below (acoustics §5.1)
_FINE_HZ = 1000.0  # bands above it have levels of 64 ms, quick enough for a gurgle of 2 to 9 Hz
_KNOCK_S = 0.15
_KNOCK_REACH = 0.6  # m or s
_TURN_REACH_M = 1.5
_LEAST_FRAMES = 6
_FIT_WIDTHS = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8)
_FIT_REACH_WIDTHS, _FIT_REACH = 5.0, 6.0
_FIT_MOST = 600


@dataclass(frozen=True)
class Patch:
    """The frames (m,) around a place: ``away`` from it, natural logarithm of band power, and local cells of it."""

    rows: npt.NDArray[np.intp]
    away: FloatArray  # (m,)
    log_power: FloatArray  # (m, b + 1)
    moving: BoolArray  # (m,)
    cell_away: FloatArray  # (c,)
    cell_log_power: FloatArray  # (c, b + 1) mean power of moving frames
    background: FloatArray  # (b + 1,) median of the cells away from the place


def patch_at(ground: Ground, place: float, width: float) -> Patch | None:
    """Return what was heard around ``place``; None where too little was."""
    reach, cell = (_REACH_M, _CELL_M) if ground.in_metres else (_REACH_S, _CELL_S)
    rows = np.flatnonzero(ground.listened & (np.abs(ground.x - place) <= reach + 3 * width))
    moving = ground.moving[rows]
    if np.count_nonzero(moving) < _LEAST_FRAMES:
        return None
    away = ground.x[rows] - place
    log_power = np.asarray(ground.scan.level_db[rows], np.float64) * (np.log(10) / 10)
    index = np.round(away[moving] / cell).astype(np.int64)
    order = np.argsort(index, kind="stable")
    values, first = np.unique(index[order], return_index=True)
    power = np.exp(log_power[moving][order])
    number = np.diff(np.append(first, len(order)))
    cells = np.asarray(np.log(np.add.reduceat(power, first, axis=0) / number[:, None]), np.float64)
    cell_away = np.asarray(values * cell, np.float64)
    outside = np.abs(cell_away) > max(2 * width, 2 * cell)
    around = cells[outside] if np.count_nonzero(outside) >= _LEAST_FRAMES else cells
    background = np.asarray(np.median(around, axis=0), np.float64)
    return Patch(rows, away, log_power, moving, cell_away, cells, background)


def excess_spectrum_db(patch: Patch, width: float) -> FloatArray:
    """Return how far each band (b + 1,) stands above its background at the place, dB."""
    near = np.abs(patch.cell_away) <= max(width / 2, float(np.min(np.abs(patch.cell_away))) + 1e-9)
    power = np.log(np.exp(patch.cell_log_power[near] - patch.background).mean(axis=0))
    return np.asarray(power * (10 / np.log(10)), np.float64)


def features_at(ground: Ground, place: float, width: float, band_hz: tuple[float, float]) -> Features:
    """Return every figure of :data:`FEATURES` at ``place``; NaN where it cannot be told.

    ``width`` is the half-width of the sound and ``band_hz`` the band it stands out in; both in the ground's own
    coordinate.
    """
    patch = patch_at(ground, place, width)
    told = dict.fromkeys(FEATURES, float("nan"))
    told |= _mapped(ground, place)
    if patch is None:
        return told
    excess_db = excess_spectrum_db(patch, width)
    middle = np.sqrt(ground.scan.bands_hz[:, 0] * ground.scan.bands_hz[:, 1])
    inside = (middle >= band_hz[0]) & (middle <= band_hz[1])
    inside[-1] = False
    if not inside.any():
        inside[-1] = True
    told |= _spectral(excess_db[:-1], middle[:-1], float(excess_db[inside].mean()))
    near = np.abs(patch.away) <= max(width, 0.5)
    told["impulsive_share"] = _impulsive(patch, near & patch.moving, inside)
    told["flutter"] = _flutter(patch, near & patch.moving, excess_db, middle)
    level = _weighed(patch, excess_db, np.isin(np.arange(len(middle)), np.flatnonzero(inside)))
    told["knock"] = _knock(ground, patch, level)
    told["lopsided"] = _lopsided(patch, inside, width)
    told["place_not_moment"] = _place_not_moment(ground, patch, level, width)
    time_s = float(np.median(ground.time_s[patch.rows[near]])) if near.any() else float("nan")
    if np.isfinite(time_s):
        told["tones_db"], told["tones_s"] = tone_span_s(ground, time_s)
    speed = ground.speed_mps[patch.rows]
    if ground.in_metres:
        told["width_m"] = width
        passing = speed[near & patch.moving]
        if len(passing):
            told["speed_ratio"] = float(np.log(np.median(passing) / np.median(speed[patch.moving])))
    return told


def loudness_at(ground: Ground, place: float, width: float, band_hz: tuple[float, float]) -> tuple[float, float] | None:
    """Return how far the place's own sound stands over its background in ``band_hz`` (dB), and that background (dBFS).

    The first is of the sound alone, its background taken off; None where nothing stands out.
    """
    patch = patch_at(ground, place, width)
    if patch is None:
        return None
    middle = np.sqrt(ground.scan.bands_hz[:-1, 0] * ground.scan.bands_hz[:-1, 1])
    inside = np.append((middle >= band_hz[0]) & (middle <= band_hz[1]), False)
    if not inside.any():
        return None
    near = np.abs(patch.cell_away) <= max(width / 2, float(np.min(np.abs(patch.cell_away))) + 1e-9)
    heard = float(np.exp(patch.cell_log_power[near][:, inside]).sum(axis=1).mean())
    background = float(np.exp(patch.background[inside]).sum())
    if heard <= 1.01 * background:
        return None
    return float(10 * np.log10(heard / background - 1.0)), float(10 * np.log10(background))


def _mapped(ground: Ground, place: float) -> Features:
    """What map and path say of the place, whatever is heard there."""
    told = {"valve_m": nearest(ground.valve_m, place), "joint_m": nearest(ground.joint_m, place)}
    close = np.abs(ground.turn_m - place) <= _TURN_REACH_M
    if ground.in_metres and close.any():
        told["turn_deg"] = float(np.degrees(ground.turn_rad[close].max()))
    return told


def _spectral(excess_db: FloatArray, hz: FloatArray, inside_db: float) -> Features:
    """Where the excess lies: how much of it rumbles below 300 Hz, its middle and its breadth."""
    low = hz < _LOW_HZ
    told = {"rumble_db": float(excess_db[low].mean() - inside_db) if low.any() else float("nan")}
    weight = np.expm1(np.clip(excess_db, 0.0, 30.0) * (np.log(10) / 10))
    if weight.sum() > 0:
        octaves = np.log2(hz)
        centre = float(weight @ octaves / weight.sum())
        told["peak_hz"] = float(2.0**centre)
        told["spread_octaves"] = float(np.sqrt(weight @ (octaves - centre) ** 2 / weight.sum()))
    return told


def _impulsive(patch: Patch, near: BoolArray, inside: BoolArray) -> float:
    """The share of the energy at the place that comes in impulses of a frame or two."""
    if not near.any():
        return float("nan")
    power = np.exp(patch.log_power[:, inside] - patch.background[inside]).mean(axis=1)
    gated = impulses(np.log(power).astype(np.float32), patch.moving)
    return float(power[near & gated].sum() / power[near].sum())


def _weighed(patch: Patch, excess_db: FloatArray, wanted: BoolArray) -> FloatArray:
    """The power (m,) over its background, each band weighed by how far it stands out."""
    weight = np.where(wanted, np.expm1(np.clip(excess_db, 0.1, 30.0) * (np.log(10) / 10)), 0.0)
    ratio = np.exp(np.minimum(patch.log_power - patch.background, 20.0))
    return np.asarray(ratio @ weight / max(weight.sum(), 1e-12), np.float64)


def _flutter(patch: Patch, near: BoolArray, excess_db: FloatArray, hz: FloatArray) -> float:
    """How much more the level wavers at 2 to 8 Hz at the place than around it: ln of the ratio of the scatters.

    Of second differences from frame to frame: the ball's turning is slower and all but drops out of them.
    """
    quick = hz >= _FINE_HZ
    quick[-1] = False
    away = patch.moving & ~near
    if not quick.any() or np.count_nonzero(near) < 2 * _LEAST_FRAMES or np.count_nonzero(away) < 4 * _LEAST_FRAMES:
        return float("nan")
    level = np.log(_weighed(patch, excess_db, quick))
    bend = np.full(len(level), np.nan)
    bend[1:-1] = level[2:] - 2 * level[1:-1] + level[:-2]
    gap = np.diff(patch.rows, prepend=-2) != 1  # neighbours in the patch that are none in time
    bend[gap] = np.nan
    bend[:-1][gap[1:]] = np.nan
    inner, outer = bend[near & np.isfinite(bend)], bend[away & np.isfinite(bend)]
    if len(inner) < _LEAST_FRAMES or len(outer) < _LEAST_FRAMES:
        return float("nan")
    return 0.5 * float(np.log(max(_robust_power(inner), 1e-9) / max(_robust_power(outer), 1e-9)))


def _robust_power(values: FloatArray) -> float:
    """Return the mean square, values beyond four medians pulled in: a blow is no gurgle."""
    size = np.abs(values)
    return float(np.mean(np.minimum(size, 4 * np.median(size)) ** 2))


def _knock(ground: Ground, patch: Patch, level: FloatArray) -> float:
    """The strength (ln) of a blow that the accelerometer felt when the sound at the place was loudest; 0 for none."""
    if ground.knock_s is None:
        return float("nan")
    close = np.flatnonzero(np.abs(patch.away) <= _KNOCK_REACH)
    if not len(close):
        return 0.0
    loudest = float(ground.time_s[patch.rows[close[int(np.argmax(level[close]))]]])
    first, last = np.searchsorted(ground.knock_s, [loudest - _KNOCK_S, loudest + _KNOCK_S])
    return float(np.log(np.max(ground.knock_strength[first:last]))) if last > first else 0.0


def _lopsided(patch: Patch, inside: BoolArray, width: float) -> float:
    """ln of what is heard behind the place over what is heard before it, within three half-widths."""
    ratio = np.exp(np.minimum(patch.cell_log_power[:, inside] - patch.background[inside], 20.0)).mean(axis=1)
    over = np.maximum(ratio - 1.0, 0.0)
    reach = max(3 * width, 1.5)
    before = float(over[(patch.cell_away < 0) & (patch.cell_away >= -reach)].sum())
    behind = float(over[(patch.cell_away > 0) & (patch.cell_away <= reach)].sum())
    if before + behind <= 0:
        return float("nan")
    return float(np.log((behind + 0.1) / (before + 0.1)))


def _place_not_moment(ground: Ground, patch: Patch, level: FloatArray, width: float) -> float:
    """How much better a rise and fall in metres explains what was heard than one in seconds: ln of what each leaves.

    0 where the device went evenly: then metres and seconds are the same.
    """
    if not ground.in_metres:
        return float("nan")
    reach = max(_FIT_REACH_WIDTHS * width, _FIT_REACH)
    used = np.flatnonzero(np.abs(patch.away) <= reach)
    if len(used) < 4 * _LEAST_FRAMES:
        return float("nan")
    group = max(1, len(used) // _FIT_MOST)
    used = used[: len(used) // group * group]
    y = np.log(np.clip(level[used], 1e-3, np.quantile(level[used], 0.99))).reshape(-1, group).mean(axis=1)
    metres = patch.away[used].reshape(-1, group).mean(axis=1)
    time_s = ground.time_s[patch.rows[used]].reshape(-1, group).mean(axis=1)
    middle = time_s[int(np.argmin(np.abs(metres)))]
    speed = max(float(np.median(ground.speed_mps[patch.rows[used]])), 0.02)
    height = max(float(np.quantile(y, 0.98) - np.quantile(y, 0.2)), 0.1)
    by_place = _left_over(metres, y, width, height)
    by_moment = _left_over((time_s - middle) * speed, y, width, height)
    return float(np.log(by_moment / by_place))


def _left_over(x: FloatArray, y: FloatArray, width: float, height: float) -> float:
    """The share of the variance of ``y`` that the best rise and fall in ``x`` leaves, over centres and widths."""
    widths = width * np.array(_FIT_WIDTHS)
    centres = np.linspace(-1.5 * width, 1.5 * width, 13)
    at = (x[None, None, :] - centres[:, None, None]) / widths[None, :, None]
    lift = np.expm1(height)
    shapes = np.concatenate([np.log1p(lift / (1 + at**2)), np.log1p(lift * np.exp(-0.5 * at**2))]).reshape(-1, len(x))
    shapes = shapes - shapes.mean(axis=1, keepdims=True)
    centred = y - y.mean()
    power = np.maximum((shapes**2).sum(axis=1), 1e-12)
    explained = np.maximum(shapes @ centred, 0.0) ** 2 / power / max(float(centred @ centred), 1e-12)
    return float(max(1.0 - explained.max(), 0.02))
