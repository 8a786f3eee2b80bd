"""What lies along one run besides its levels: knocks, joints, bends, named valves, tones; gathered once for all places.

Everything is in the detector's own coordinate: metres along the pipe, or survey seconds where there is no path.
"""

import re
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from processing.position.bends import turning
from processing.position.distance import chainage_at
from processing.position.joint_chain import find_chain
from processing.sound.bands import is_low
from processing.sound.cells import Frames
from processing.sound.onsets import imu_events
from processing.sound.scan import SoundScan
from processing.survey import BoolArray, FloatArray, ImuSamples, Survey, TiePoint, Track

TONE_STEP_S = 1.0
_TONE_SMOOTH_S = 31  # a pump hums for minutes, and swells within seconds
_TONE_USUAL = 0.2  # quantile of the run: a pump that runs most of the time must not become the usual state
_CHORD_M = 2.5
_TURN_STEP_M = 0.5
_MOST_KNOCKS_PM, _MOST_KNOCKS = 0.7, 8000  # a metre and in all: joints are among the stronger; more costs a minute
_VALVE = re.compile(r"\b(valve|vana|vanas[ıi]|hydrant|hidrant|vantuz|gate|sv|pv|av)\b", re.IGNORECASE)


@dataclass(frozen=True)
class Ground:
    """One run: ``x`` (t,) is chainage in metres, or survey seconds where ``in_metres`` is False; NaN off the path.

    ``listened`` are frames that are heard, standing ones included; ``moving`` those that the detector counts.
    """

    scan: SoundScan
    time_s: FloatArray  # (t,)
    x: FloatArray  # (t,)
    speed_mps: FloatArray  # (t,)
    listened: BoolArray  # (t,)
    moving: BoolArray  # (t,)
    in_metres: bool
    tones_db: FloatArray  # (k,) how far tones stand out below 1 kHz, a second each, above the run's usual
    knock_s: FloatArray | None  # (e,) blows that the accelerometer felt; None where there is none
    knock_strength: FloatArray  # (e,) in medians of its surroundings
    joint_m: FloatArray  # (j,) places of joints that follow each other regularly
    turn_m: FloatArray  # (n,) places along the path
    turn_rad: FloatArray  # (n,) how far it turns there within two chords
    valve_m: FloatArray  # (v,) tie points whose name says that there is a valve


def ground_of(
    scan: SoundScan, frames: Frames, track: Track | None, imu: ImuSamples | None, survey: Survey, *, in_metres: bool
) -> Ground:
    """Return what lies along a run; ``frames`` are the detector's, ``in_metres`` is False where it works in time."""
    track = track if in_metres else None
    events = imu_events(imu) if imu is not None else None
    turn_m, turn_rad = _turns(track)
    x = frames.chainage_m if in_metres else frames.time_s
    return Ground(
        scan=scan,
        time_s=frames.time_s,
        x=x,
        speed_mps=frames.speed_mps,
        listened=(np.asarray(scan.state) == 0) & np.isfinite(x),
        moving=frames.counts,
        in_metres=in_metres,
        tones_db=_tones(scan),
        knock_s=events.time_s if events is not None else None,
        knock_strength=events.strength if events is not None else np.zeros(0),
        joint_m=_joints(track, events.time_s, events.strength) if events is not None else np.zeros(0),
        turn_m=turn_m,
        turn_rad=turn_rad,
        valve_m=_valves(track, survey.tie_points),
    )


def _tones(scan: SoundScan) -> FloatArray:
    """Return the crest below 1 kHz, which tells tones, a second each, smoothed over half a minute, above the usual."""
    low = np.flatnonzero(is_low(scan.bands_hz))
    size = max(1, round(TONE_STEP_S / scan.frame_s))
    count = len(scan.crest_db) // size
    if not len(low) or not count:
        return np.zeros(max(count, 1))
    seconds = np.empty(count)
    block = 4096
    for first in range(0, count, block):  # a memory-mapped array of hours is not taken into memory at once
        last = min(first + block, count)
        rows = np.asarray(scan.crest_db[first * size : last * size], np.float32)[:, low]
        seconds[first:last] = rows.mean(axis=1).reshape(-1, size).mean(axis=1)
    smooth = ndimage.median_filter(seconds, _TONE_SMOOTH_S, mode="nearest")
    return np.asarray(smooth - np.quantile(smooth, _TONE_USUAL), np.float64)


def _joints(track: Track | None, time_s: FloatArray, strength: FloatArray) -> FloatArray:
    if track is None:
        return np.zeros(0)
    moving = np.interp(time_s, track.time_s, np.abs(track.speed_mps), left=0.0, right=0.0) > 0.05
    place, strength = chainage_at(track, time_s[moving]), strength[moving]
    most = min(int(_MOST_KNOCKS_PM * float(track.chainage_m[-1])), _MOST_KNOCKS)
    if len(place) > most:
        keep = np.sort(np.argsort(strength, kind="stable")[len(place) - most :])
        place = place[keep]
    chain = find_chain(place)
    return place[chain.rows] if chain is not None else np.zeros(0)


def _turns(track: Track | None) -> tuple[FloatArray, FloatArray]:
    none = np.zeros(0)
    if track is None or float(track.chainage_m[-1] - track.chainage_m[0]) < 4 * _CHORD_M:
        return none, none
    chainage, rows = np.unique(track.chainage_m, return_index=True)
    at = np.arange(float(chainage[0]) + _CHORD_M, float(chainage[-1]) - _CHORD_M, _TURN_STEP_M)

    def places(s: FloatArray) -> FloatArray:
        return np.column_stack([np.interp(s, chainage, axis) for axis in track.position_w_m[rows, :2].T])

    return at, np.abs(turning(places(at - _CHORD_M), places(at), places(at + _CHORD_M)))


def _valves(track: Track | None, ties: tuple[TiePoint, ...]) -> FloatArray:
    """Return where the technician named a valve: the chainage told, else where the path was at that moment."""
    if track is None:
        return np.zeros(0)
    named = [t for t in ties if _VALVE.search(t.name)]
    told = [t.chainage_m if t.chainage_m is not None else float(chainage_at(track, t.time_s)[0]) for t in named]
    return np.array(told, np.float64)


def nearest(places: FloatArray, place: float) -> float:
    """Return how far the nearest of ``places`` is; NaN where there are none."""
    return float(np.min(np.abs(places - place))) if len(places) else float("nan")


def tone_span_s(ground: Ground, time_s: float) -> tuple[float, float]:
    """Return how far tones stand out at ``time_s`` (dB), and for how many seconds around they stay at half of that."""
    audio_s = time_s - float(ground.time_s[0])
    at = int(np.clip(audio_s / TONE_STEP_S, 0, len(ground.tones_db) - 1))
    level = float(ground.tones_db[at])
    if level <= 0:
        return level, 0.0
    below = np.flatnonzero(ground.tones_db < 0.5 * level)
    after = int(np.searchsorted(below, at))
    first = int(below[after - 1]) + 1 if after > 0 else 0
    last = int(below[after]) if after < len(below) else len(ground.tones_db)
    return level, (last - first) * TONE_STEP_S
