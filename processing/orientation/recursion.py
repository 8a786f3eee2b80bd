"""Drives a per-sample recursion through a run, block by block and segment by segment, and fills the untrusted rows."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.samples import Block, TrustedSamples
from processing.orientation.start import Before, end_of, first_attitude
from processing.progress import Progress
from processing.survey import FloatArray

Advance = Callable[[Block, FloatArray, FloatArray, FloatArray], None]
Begin = Callable[[FloatArray, FloatArray | None], FloatArray]


@dataclass(frozen=True)
class Estimate:
    """What an estimator returns for every row of a run: ``quat_ws`` (n, 4) without NaN.

    ``bias_radps`` (n, 3) is what the estimator itself took off the calibrated rates, None if nothing.
    """

    quat_ws: FloatArray
    bias_radps: FloatArray | None = None


@dataclass(frozen=True)
class Recursion:
    """A per-sample recursion whose state begins with q (4,): all it remembers between two blocks of rows.

    ``begin(q, state)`` returns the state at the first row of a segment, given the state at the end of the segment
    before (None for the first); ``advance(block, state, quat, bias)`` moves the state on and fills (m, 4) and (m, 3).
    """

    begin: Begin
    advance: Advance
    estimates_bias: bool


def run_recursion(samples: TrustedSamples, yaw_rad: float, progress: Progress, recursion: Recursion) -> Estimate:
    """Run a recursion over all segments; ``yaw_rad`` is the first yaw where no field tells it."""
    total = len(samples.imu.time_s)
    quat, bias = np.empty((total, 4)), np.empty((total if recursion.estimates_bias else 0, 3))
    state: FloatArray | None = None
    before: Before | None = None
    for segment in samples.segments:
        for block in samples.blocks(segment):
            if block.start == segment[0]:
                state = recursion.begin(first_attitude(block, samples.settings.start_s, yaw_rad, before), state)
            assert state is not None
            rows = len(block.time_s)
            block_quat, block_bias = np.empty((rows, 4)), np.empty((rows, 3))
            recursion.advance(block, state, block_quat, block_bias)
            if block.stop == segment[1]:
                before = end_of(block, block_quat)
            index = samples.index(block.start, block.stop)
            quat[index] = block_quat
            if recursion.estimates_bias:
                bias[index] = block_bias
            progress.update(block.stop / samples.count, "orientation_attitude")
    fill_untrusted(samples, quat, bias)
    return Estimate(quat, bias if recursion.estimates_bias else None)


def fill_untrusted(samples: TrustedSamples, quat: FloatArray, bias: FloatArray) -> None:
    """Give the rows that no estimator saw an attitude, in place: interpolated over a short hole, else held.

    ``quat`` (n, 4); ``bias`` (n, 3) or (0, 3), always held. Rows before the first trusted one get its values.
    """
    if samples.rows is None:
        return
    untrusted = np.flatnonzero(~samples.imu.valid)
    after = np.searchsorted(samples.rows, untrusted)
    left = samples.rows[np.maximum(after - 1, 0)]
    right = samples.rows[np.minimum(after, len(samples.rows) - 1)]
    time_s = samples.imu.time_s
    span = time_s[right] - time_s[left]
    bridged = (span > 0.0) & (span <= samples.bridge_s)
    fraction = np.where(bridged, (time_s[untrusted] - time_s[left]) / np.where(bridged, span, 1.0), 0.0)
    quat[untrusted] = qt.slerp(quat[left], quat[right], fraction)
    if len(bias):
        bias[untrusted] = bias[left]
