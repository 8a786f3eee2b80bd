"""Time to chainage and back, and the place with its 95 % interval at any moment of a track."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray, Track

NORMAL_95 = 1.959964  # two-sided 95 % of a normal distribution; the track's sigmas are calibrated for it


@dataclass(frozen=True)
class PlacesAt:
    """Where the device was at k moments; the interval encloses the true chainage in 95 of 100 cases."""

    time_s: FloatArray  # (k,)
    chainage_m: FloatArray  # (k,)
    low95_m: FloatArray  # (k,) never below 0
    high95_m: FloatArray  # (k,)
    position_w_m: FloatArray  # (k, 3)
    sigma_along_m: FloatArray  # (k,)
    sigma_cross_m: FloatArray  # (k,)
    sigma_up_m: FloatArray  # (k,)


def places_at(track: Track, time_s: npt.ArrayLike) -> PlacesAt:
    """Return where the device was at ``time_s`` (k,); before and after the track its ends hold."""
    at = np.atleast_1d(np.asarray(time_s, dtype=np.float64))
    chainage = chainage_at(track, at)
    along = np.interp(at, track.time_s, track.sigma_along_m)
    return PlacesAt(
        time_s=at,
        chainage_m=chainage,
        low95_m=np.maximum(chainage - NORMAL_95 * along, 0.0),
        high95_m=chainage + NORMAL_95 * along,
        position_w_m=np.column_stack([np.interp(at, track.time_s, column) for column in track.position_w_m.T]),
        sigma_along_m=along,
        sigma_cross_m=np.interp(at, track.time_s, track.sigma_cross_m),
        sigma_up_m=np.interp(at, track.time_s, track.sigma_up_m),
    )


def chainage_at(track: Track, time_s: npt.ArrayLike) -> FloatArray:
    """Return the chainage (k,) at ``time_s`` (k,); it never decreases with time."""
    return np.asarray(np.interp(np.atleast_1d(np.asarray(time_s, dtype=np.float64)), track.time_s, track.chainage_m))


def times_at(track: Track, chainage_m: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return when the device reached and when it left ``chainage_m`` (k,): two arrays, different where it rested.

    Beyond the ends of the track its first or last moment holds.
    """
    wanted = np.atleast_1d(np.asarray(chainage_m, dtype=np.float64))
    return _crossing(track, wanted, "left"), _crossing(track, wanted, "right")


def _crossing(track: Track, wanted: FloatArray, side: str) -> FloatArray:
    chainage, time_s = track.chainage_m, track.time_s
    after = np.searchsorted(chainage, wanted, side="left" if side == "left" else "right")
    right = np.clip(after, 1, len(chainage) - 1)
    rise = chainage[right] - chainage[right - 1]
    part = np.where(rise > 0.0, (wanted - chainage[right - 1]) / np.where(rise > 0.0, rise, 1.0), 0.0)
    found = time_s[right - 1] + np.clip(part, 0.0, 1.0) * (time_s[right] - time_s[right - 1])
    found = np.where(after == 0, time_s[0], found)
    return np.asarray(np.where(after == len(chainage), time_s[-1], found))
