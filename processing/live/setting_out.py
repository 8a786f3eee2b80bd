"""In which direction a path sets out that has only begun.

:func:`processing.position.heading.initial_direction` looks at the whole run, and takes at most a third of it for the
first metres. A path of ten metres with a bend in the second would turn with every look at it.
"""

import numpy as np

from processing.position.odometry import Odometry

_BASELINES_M = (20.0, 12.0, 8.0, 5.0, 3.0, 2.0, 1.2, 0.8, 0.5, 0.3)
_STRAIGHT_M = 0.02  # rms; a pipe bend within the baseline leaves ten times as much
_STRAIGHT_SHARE = 0.004  # of the baseline, where that is less: half a bend fits a parabola too


def setting_out_direction(odometry: Odometry) -> float | None:
    """Return the yaw (rad) of the free path at its beginning; None where it has not left yet.

    A parabola is laid over the first metres, over as many as it fits.
    """
    distinct, first = np.unique(odometry.chainage_m, return_index=True)
    lengths = [b for b in _BASELINES_M if b <= distinct[-1]]
    direction = None
    for baseline in lengths:
        at = np.linspace(0.0, baseline, 60)
        east, north = (np.interp(at, distinct, axis[first]) for axis in odometry.position_w_m[:, :2].T)
        east, north = east - east[0], north - north[0]
        chord = float(np.arctan2(north[-1], east[-1]))
        along = east * np.cos(chord) + north * np.sin(chord)
        aside = north * np.cos(chord) - east * np.sin(chord)
        basis = np.column_stack([along, along**2])
        found, *_ = np.linalg.lstsq(basis, aside, rcond=None)
        direction = chord + float(np.arctan(found[0]))
        if float(np.sqrt(np.mean((aside - basis @ found) ** 2))) < min(_STRAIGHT_M, _STRAIGHT_SHARE * baseline):
            return direction
    return direction
