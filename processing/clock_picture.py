"""What the picture of the clocks shows: the blows of both sensors side by side, how clearly they fit, and how well."""

from dataclasses import dataclass

import numpy as np

from processing.clock_fit import ClockFit, Pairs
from processing.survey import FloatArray

NORMAL_95 = 1.959964
SHIFT_ROOM_S = 0.5
SHIFT_STEP_S = 0.01
_CLOSE_S = 30.0
_MARGIN_S = 1.5
_MOST_EVENTS = 80
_BAND_POINTS = 60


@dataclass(frozen=True)
class CloseUp:
    """Half a minute: when the motion sensor (n,) and the microphone (m,) felt blows, in survey time; and both (k,)."""

    start_s: float
    end_s: float
    felt_s: FloatArray
    heard_s: FloatArray
    both_s: FloatArray


@dataclass(frozen=True)
class ClockPicture:
    """Close-ups; pairs of blows by how far apart they are; residuals of the pairs, and the 95 % band, along the run.

    ``counts`` (k,) are pairs of any two blows whose distance lies within ``SHIFT_STEP_S`` from ``shift_ms`` (k,) on:
    clocks that fit show one peak, at 0. Residuals and band are in milliseconds, positive where the sound comes late.
    """

    close_ups: tuple[CloseUp, ...]
    shift_ms: FloatArray
    counts: FloatArray
    time_s: FloatArray
    residual_ms: FloatArray
    band_time_s: FloatArray
    band_ms: FloatArray


def clock_picture(fit: ClockFit) -> ClockPicture:
    """Return what there is to see of a fit; arrays are empty where there was nothing to relate."""
    heard_s = fit.clock.to_survey(fit.heard_s)
    edges = np.arange(-SHIFT_ROOM_S, SHIFT_ROOM_S + SHIFT_STEP_S / 2, SHIFT_STEP_S)
    distances = _distances(np.asarray(fit.felt_s), heard_s)
    counts = np.histogram(distances, edges)[0].astype(np.float64)
    times = [np.asarray(pairs.survey_s) for pairs in fit.pairs.values()]
    residuals = [fit.residual_s(pairs) for pairs in fit.pairs.values()]
    ends = _ends(fit.felt_s, heard_s)
    band_time = np.linspace(*ends, _BAND_POINTS) if ends is not None else np.zeros(0)
    return ClockPicture(
        close_ups=tuple(_close_up(pairs, fit.felt_s, heard_s) for pairs in fit.pairs.values()),
        shift_ms=1000.0 * edges[:-1],
        counts=counts,
        time_s=np.concatenate([np.zeros(0), *times]),
        residual_ms=1000.0 * np.concatenate([np.zeros(0), *residuals]),
        band_time_s=band_time,
        band_ms=1000.0 * NORMAL_95 * fit.clock.sigma_at(band_time),
    )


def _ends(felt_s: FloatArray, heard_s: FloatArray) -> tuple[float, float] | None:
    if not len(felt_s) or not len(heard_s):
        return None
    return float(min(felt_s[0], heard_s[0])), float(max(felt_s[-1], heard_s[-1]))


def _distances(felt_s: FloatArray, heard_s: FloatArray) -> FloatArray:
    """Return heard − felt of all pairs less than ``SHIFT_ROOM_S`` apart."""
    first = np.searchsorted(heard_s, felt_s - SHIFT_ROOM_S)
    counts = np.searchsorted(heard_s, felt_s + SHIFT_ROOM_S) - first
    which = np.repeat(np.arange(len(felt_s)), counts)
    within = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.asarray(heard_s[first[which] + within] - felt_s[which], np.float64)


def _close_up(pairs: Pairs, felt_s: FloatArray, heard_s: FloatArray) -> CloseUp:
    """Return the half minute with most of the pairs."""
    both = np.sort(pairs.survey_s)
    until = np.searchsorted(both, both + _CLOSE_S - 2 * _MARGIN_S, side="right")
    at = int(np.argmax(until - np.arange(len(both))))
    start, last = float(both[at]) - _MARGIN_S, float(both[until[at] - 1]) + _MARGIN_S
    inside = [times[(times >= start) & (times <= last)][:_MOST_EVENTS] for times in (felt_s, heard_s, both)]
    return CloseUp(start, last, *inside)
