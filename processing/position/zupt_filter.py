"""The zero-velocity aided error-state Kalman filter and its smoother over a whole run, in pieces of bounded memory.

State: position, velocity, attitude error, offsets of accelerometer and gyro (15). The strapdown runs at the sensor's
rate; covariances are kept at nodes: the track's own rows, and every 20 ms of a standstill. The smoother of a piece
begins two minutes after its end: by then a standstill has long told all it can about what went before.

Sources: P4 section 2.1; Skog et al. 2010; Foxlin 2005; Rauch, Tung, Striebel 1965. The smoother takes more than half
off the vertical error of a stride, which the filter only learns at the stride's end.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.position import kernels_zupt as kernels
from processing.position import kernels_zupt_smoother as smoother
from processing.progress import Progress
from processing.survey import FloatArray

IndexArray = npt.NDArray[np.int64]
_PIECE = 16_000  # nodes: 90 MB of covariances
_LAG = 3_000


@dataclass(frozen=True)
class Inertial:
    """What the strapdown reads of some rows (k): specific force and rate (k, 3), and of the interval that ends at each
    row the turn (k, 3; rad) and the time (k,); all contiguous.
    """

    acc_s_mps2: FloatArray
    gyr_s_radps: FloatArray
    turn_s_rad: FloatArray
    step_s: FloatArray
    gravity_mps2: float


@dataclass(frozen=True)
class Updates:
    """At nodes ``rows`` (m,), rising rows: 1-sigma of zero velocity (m/s), of zero rate (rad/s) and of the heading
    ``yaw_rad``; 0 where there is none. Before a node the noise of
    acceleration and rate is ``looser`` (m, 2) times the usual (impacts, a gap in the samples).
    """

    rows: IndexArray
    velocity_sigma: FloatArray
    rate_sigma: FloatArray
    yaw_rad: FloatArray
    yaw_sigma: FloatArray
    looser: FloatArray


@dataclass(frozen=True)
class Start:
    """The first nominal state (16: p, v, q, b_a, b_g) and the 1-sigma of its error (15: …, rotation vector, …)."""

    state: FloatArray
    sigma: FloatArray


@dataclass(frozen=True)
class Noise:
    """Densities: acceleration (m/s/√s), rate (rad/√s), and the walks of their offsets (m/s²/√s, rad/s/√s)."""

    acc: float
    gyr: float
    acc_offset: float
    gyr_offset: float

    def as_array(self) -> FloatArray:
        """The four as an array."""
        return np.array([self.acc, self.gyr, self.acc_offset, self.gyr_offset])


@dataclass(frozen=True)
class Smoothed:
    """At each node: state (m, 16), covariance of position and velocity (m, 6, 6), and of each zero velocity the
    normalised innovation squared (−1 where there was none) and the velocity that it took off (m, 3).
    """

    state: FloatArray
    covariance: FloatArray
    nis: FloatArray
    missed_mps: FloatArray


def run_filter(
    read: Callable[[slice], Inertial],
    updates: Updates,
    start: Start,
    noise: Noise,
    gate: float,
    progress: Progress,
    *,
    smooth: bool = True,
) -> Smoothed:
    """Return the smoothed (or only filtered) states at the nodes of a run whose rows ``read`` gives.

    ``gate`` is the normalised innovation squared beyond which a zero velocity is trusted less (16.3: 99.9 % of χ²₃).
    """
    count = len(updates.rows)
    out = Smoothed(np.empty((count, 16)), np.empty((count, 6, 6)), np.empty(count), np.zeros((count, 3)))
    x, p = start.state.astype(np.float64), np.diag(start.sigma.astype(np.float64) ** 2)
    for first in range(0, count, _PIECE):
        part = slice(first, min(first + _PIECE + _LAG, count))
        own = slice(first, min(first + _PIECE, count))
        room = _Room(part.stop - part.start)
        rows = slice(int(updates.rows[part.start]), int(updates.rows[part.stop - 1]) + 1)
        room.forward(read(rows), updates, part, noise, gate, x, p)
        keep = own.stop - own.start
        out.nis[own], out.missed_mps[own] = room.nis[:keep], room.missed[:keep]
        if smooth:
            room.backward()
            out.state[own], out.covariance[own] = room.smoothed[:keep], room.p_smoothed[:keep]
        else:
            out.state[own], out.covariance[own] = room.filtered[:keep], room.p_filtered[:keep, :6, :6]
        if own.stop < count:  # the next piece starts before its first node's updates
            x, p = room.predicted[keep].copy(), room.p_predicted[keep].copy()
        progress.update(own.stop / count, "position_reckon")
    return out


class _Room:
    """The arrays of one piece."""

    def __init__(self, nodes: int) -> None:
        self.predicted, self.filtered, self.smoothed = (np.empty((nodes, 16)) for _ in range(3))
        self.p_predicted, self.p_filtered, self.phi = (np.empty((nodes, 15, 15)) for _ in range(3))
        self.p_smoothed = np.empty((nodes, 6, 6))
        self.nis, self.missed = np.empty(nodes), np.zeros((nodes, 3))
        self.work, self.other = np.zeros((15, 18)), np.zeros((15, 15))

    def forward(
        self, imu: Inertial, updates: Updates, part: slice, noise: Noise, gate: float, x: FloatArray, p: FloatArray
    ) -> None:
        """Filter the nodes ``part`` from state ``x`` and covariance ``p``, which are overwritten."""
        kernels.forward(
            imu.acc_s_mps2,
            imu.gyr_s_radps,
            imu.turn_s_rad,
            imu.step_s,
            np.ascontiguousarray(updates.rows[part] - updates.rows[part.start], dtype=np.int64),
            np.ascontiguousarray(updates.velocity_sigma[part]),
            np.ascontiguousarray(updates.rate_sigma[part]),
            np.ascontiguousarray(updates.yaw_rad[part]),
            np.ascontiguousarray(updates.yaw_sigma[part]),
            np.ascontiguousarray(updates.looser[part]),
            imu.gravity_mps2,
            noise.as_array(),
            gate,
            x,
            p,
            self.predicted,
            self.filtered,
            self.p_predicted,
            self.p_filtered,
            self.phi,
            self.nis,
            self.missed,
            self.work,
            np.zeros((3, 3)),
            np.zeros(15),
            np.zeros(kernels.SCRATCH_SIZE),
        )

    def backward(self) -> None:
        """Smooth what was filtered."""
        smoother.backward(
            self.predicted,
            self.filtered,
            self.p_predicted,
            self.p_filtered,
            self.phi,
            self.smoothed,
            self.p_smoothed,
            self.p_filtered[-1].copy(),
            self.work,
            self.other,
            np.zeros(15),
            np.zeros(15),
            np.zeros(15),
        )
