"""Pipe joints as an odometer: blows at a regular spacing, or the joints' magnetic signature, count the pipes.

Each joint jolts the ball, and in iron each leaves a mark in the field. Where such marks follow each other at a steady
distance, the distance from joint to joint is that of a pipe, whatever the ball slipped in between. With the pipes'
length told, that is also a scale; without it, it only says that the odometer's scale stayed the same.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.position.evidence import ChainageIncrement
from processing.position.joint_chain import Chain, find_chain
from processing.position.odometry import Odometry
from processing.progress import Progress
from processing.sound.onsets import Events, imu_events
from processing.survey import Finding, FloatArray, ImuSamples, Params, Severity

SHOCKS, MAGNETIC = "joint_shocks", "joint_field"
STANDARD_M = (3.0, 4.0, 5.0, 5.5, 6.0, 7.0, 8.0, 10.0, 11.8, 12.0, 12.2, 13.5, 18.0)
_STANDARD_SHARE = 0.01
_TOLD_SHARE = 0.005  # what all pipes may be longer or shorter than told, laying gap included
_UNTOLD_SHARE = 0.05
_MOVING_MPS = 0.05
_MOST_INCREMENTS = 1000
_DENSITIES_PM = (2.0, 0.7, 0.35)  # blows a metre that are looked at: all, the stronger, the strongest
_FIELD_BIN_M = 0.3  # about one turn of a ball, which averages its own iron out
_FIELD_WINDOW = 11  # bins
_FIELD_SIGMAS = 5.0
_FIELD_APART_M = 1.2
_BLOCK_ROWS = 500_000


@dataclass(frozen=True)
class JointMatch:
    """From joint to joint, and what to say of it."""

    increments: tuple[ChainageIncrement, ...]
    findings: tuple[Finding, ...]


def find_joints(imu: ImuSamples, odometry: Odometry, told_m: float | None, progress: Progress) -> JointMatch:
    """Return the way between joints that follow each other regularly; nothing where they do not.

    ``told_m`` is the length of a pipe, None where unknown: then the increments share a free scale, and only say that
    the spacing is constant. Blows and field are of the same joints, so only the clearer of the two is used.
    """
    shocks = _in_motion(imu_events(imu), odometry)
    progress.update(0.6, "position_joints")
    best = _clearest(SHOCKS, shocks, odometry, told_m)
    field = _clearest(MAGNETIC, field_events(imu, odometry), odometry, told_m) if imu.mag_s_ut is not None else None
    if best is None or (field is not None and field.chain.score > best.chain.score):
        best = field
    progress.update(1.0)
    if best is None:
        missing = (Finding("joints_not_found", Severity.INFO, {"metres": told_m}),) if told_m is not None else ()
        return JointMatch((), missing)
    return JointMatch(_increments(best, told_m), _findings(best, told_m))


@dataclass(frozen=True)
class _Found:
    source: str
    time_s: FloatArray
    place_m: FloatArray
    chain: Chain


def _clearest(source: str, events: Events, odometry: Odometry, told_m: float | None) -> _Found | None:
    """The best chain among all events, the stronger and the strongest of them."""
    length = float(odometry.chainage_m[-1])
    share = 3.0 * odometry.scale_sigma
    around = {} if told_m is None else {"around_m": (told_m * (1.0 - min(share, 0.3)), told_m * (1.0 + share))}
    best: _Found | None = None
    seen = 0
    for density in _DENSITIES_PM:
        some = events.strongest(int(density * length))
        if len(some.time_s) == seen:
            continue
        seen = len(some.time_s)
        place = np.interp(some.time_s, odometry.time_s, odometry.chainage_m)
        chain = find_chain(place, **around)
        if chain is not None and (best is None or chain.score > best.chain.score):
            best = _Found(source, some.time_s, place, chain)
    return best


def _in_motion(events: Events, odometry: Odometry) -> Events:
    """Knocks on a device that lies still are no joints."""
    moving = np.interp(events.time_s, odometry.time_s, odometry.speed_mps) > _MOVING_MPS
    moving &= np.interp(events.time_s, odometry.time_s, odometry.chainage_m) > 0.0
    return Events(events.time_s[moving], events.strength[moving])


def field_events(imu: ImuSamples, odometry: Odometry) -> Events:
    """Return places where the strength of the field differs from that around, in survey seconds, strength in MADs.

    The strength, not the direction: the ball turns. It is averaged over about a turn, against the ball's own iron.
    """
    none = Events(np.zeros(0), np.zeros(0))
    bins = int(float(odometry.chainage_m[-1]) / _FIELD_BIN_M)
    if imu.mag_s_ut is None or bins < 10 * _FIELD_WINDOW:
        return none
    sums, count = np.zeros(bins + 1), np.zeros(bins + 1)
    for start in range(0, len(imu.time_s), _BLOCK_ROWS):
        rows = slice(start, start + _BLOCK_ROWS)
        size = np.linalg.norm(imu.mag_s_ut[rows], axis=1)
        good = np.isfinite(size) & imu.valid[rows]
        place = np.interp(imu.time_s[rows][good], odometry.time_s, odometry.chainage_m)
        at = np.clip((place / _FIELD_BIN_M).astype(np.int64), 0, bins)
        sums += np.bincount(at, size[good], minlength=bins + 1)
        count += np.bincount(at, minlength=bins + 1)
    if np.count_nonzero(count) < 0.9 * len(count):
        return none
    middle = (np.arange(bins + 1) + 0.5) * _FIELD_BIN_M
    strength: FloatArray = np.interp(middle, middle[count > 0], sums[count > 0] / count[count > 0])
    return _peaks(np.asarray(middle, dtype=np.float64), strength, odometry)


def _peaks(middle_m: FloatArray, strength: FloatArray, odometry: Odometry) -> Events:
    from scipy.ndimage import maximum_filter1d, median_filter

    away = np.abs(strength - median_filter(strength, _FIELD_WINDOW, mode="nearest"))
    usual = float(np.median(away)) + 1e-9
    top = maximum_filter1d(away, 2 * round(_FIELD_APART_M / _FIELD_BIN_M) + 1)
    rows = np.flatnonzero((away >= top) & (away > _FIELD_SIGMAS * usual))
    rows = rows[(rows > 0) & (rows < len(away) - 1)]
    around = rows[:, None] + np.array([-1, 0, 1])
    place = np.sum(away[around] * middle_m[around], axis=1) / np.sum(away[around], axis=1)
    distinct, first = np.unique(odometry.chainage_m, return_index=True)
    return Events(np.interp(place, distinct, odometry.time_s[first]), away[rows] / usual)


def _increments(found: _Found, told_m: float | None) -> tuple[ChainageIncrement, ...]:
    chain = found.chain
    time_s, place = found.time_s[chain.rows], found.place_m[chain.rows]
    spacing = told_m if told_m is not None else chain.spacing_m
    share = _TOLD_SHARE if told_m is not None else _UNTOLD_SHARE
    left = np.abs(np.diff(place) - chain.pipes * chain.spacing_m)
    # a link that the odometer denies is a slip, or no joint: it may be either
    variance = np.maximum(chain.pipes * chain.sigma_m**2, np.where(left > 4.0 * chain.sigma_m, 0.25 * left**2, 0.0))
    together = max(-(-len(chain.pipes) // _MOST_INCREMENTS), 1)
    out = []
    for first in range(0, len(chain.pipes), together):
        last = min(first + together, len(chain.pipes))
        length = float(chain.pipes[first:last].sum()) * spacing
        sigma = float(np.sqrt(variance[first:last].sum()))
        out.append(ChainageIncrement(float(time_s[first]), float(time_s[last]), length, sigma, found.source, share))
    return tuple(out)


def _findings(found: _Found, told_m: float | None) -> tuple[Finding, ...]:
    chain = found.chain
    code = "joints_counted" if found.source == SHOCKS else "joints_counted_field"
    figures: Params = {"spacing_m": told_m or chain.spacing_m, "count": float(chain.pipes.sum() + 1)}
    out = [Finding(code, Severity.INFO, figures)]
    if told_m is None:
        near = [m for m in STANDARD_M if abs(chain.spacing_m / m - 1.0) < _STANDARD_SHARE]
        if len(near) == 1:
            out.append(Finding("joints_standard", Severity.INFO, {"spacing_m": chain.spacing_m, "standard_m": near[0]}))
    return tuple(out)


def without_scale(match: JointMatch) -> JointMatch:
    """Return the increments as saying nothing of the scale: only that the spacing is constant."""
    free = tuple(replace(i, scale_sigma=_UNTOLD_SHARE) for i in match.increments)
    return JointMatch(free, match.findings)
