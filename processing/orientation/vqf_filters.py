"""VQF and its offline form by their authors' package, on runs with holes, jitter and any length.

D. Laidig, T. Seel, "VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic disturbance
rejection", Information Fusion 91 (2023), 187–204. The package wants a steady rate, so it is given the turn between
samples divided by the median period: the integrated angles stay those of the true time stamps.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.recursion import Estimate, fill_untrusted
from processing.orientation.samples import BLOCK_ROWS, Block, TrustedSamples
from processing.orientation.start import Before, continuing_turn, end_of, with_yaw, yaw_towards
from processing.progress import Progress
from processing.survey import FloatArray

CHUNK_ROWS = 8 * BLOCK_ROWS  # the offline form needs some 350 bytes a row
_OVERLAP_S = 60.0


def vqf(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return VQF's attitude, causal: what it would have shown live; 9D where the field is trusted, else 6D."""
    from vqf import VQF

    quat, bias = _empty(samples)
    before: Before | None = None
    for segment in samples.segments:
        live = VQF(samples.period_s)
        turn_about_up = 0.0
        for block in samples.blocks(segment):
            result = live.updateBatch(*_inputs(block, samples.period_s))
            found = _quaternions(block, result)
            if block.start == segment[0] and not len(block.mag):
                turn_about_up = _yaw_offset(block, found, before, yaw_rad)
            found = qt.multiply(qt.turn_about_up(turn_about_up), found)
            index = samples.index(block.start, block.stop)
            quat[index], bias[index] = found, result["bias"]
            before = end_of(block, found)
            progress.update(block.stop / samples.count, "orientation_attitude")
    fill_untrusted(samples, quat, bias)
    return Estimate(quat, bias)


def offline_vqf(samples: TrustedSamples, yaw_rad: float, progress: Progress) -> Estimate:
    """Return offline VQF's attitude: forward and backward over the run; 9D where the field is trusted, else 6D.

    Long segments are taken in chunks that overlap by a minute on either side; without a field each chunk is turned
    about up so that it continues the one before over the common stretch.
    """
    from vqf import offlineVQF

    quat, bias = _empty(samples)
    before: Before | None = None
    for segment in samples.segments:
        tail: tuple[int, FloatArray] | None = (
            None  # first row and attitudes of what the last chunk shares with the next
        )
        for start, stop, low, high in chunks(samples, segment):
            block = samples.block(low, high, first=low == segment[0])
            result = offlineVQF(*_inputs(block, samples.period_s), samples.period_s)
            found = _quaternions(block, result)
            if not len(block.mag):
                turn = _yaw_offset(block, found, before, yaw_rad) if tail is None else seam_turn(low, found, tail)
                found = qt.multiply(qt.turn_about_up(turn), found)
            index = samples.index(start, stop)
            quat[index], bias[index] = found[start - low : stop - low], result["bias"][start - low : stop - low]
            # half a minute on either side of the seam, where this chunk and the next are both past their beginnings
            half = (high - stop) // 2
            tail = (stop - half, found[stop - half - low : stop + half - low].copy())
            if stop == segment[1]:
                before = end_of(block, found)
            progress.update(stop / samples.count, "orientation_attitude")
    fill_untrusted(samples, quat, bias)
    return Estimate(quat, bias)


def six_axes(block: Block, period_s: float) -> FloatArray:
    """Return offline VQF's attitude (m, 4) of a block without its field; the yaw begins at 0."""
    from vqf import offlineVQF

    return np.asarray(offlineVQF(block.turn / period_s, block.acc_g * 9.81, None, period_s)["quat6D"], dtype=np.float64)


def bias_in_motion(samples: TrustedSamples) -> tuple[FloatArray, FloatArray]:
    """Return gyro offset and 1 sigma (3,), (3,) rad/s as offline VQF sees them in the run's longest segment.

    For runs without a rest; the filter's own sigma is optimistic, so it is doubled and never under 0.2 °/s.
    """
    from vqf import offlineVQF

    start, stop = max(samples.segments, key=lambda s: s[1] - s[0])
    stop = min(stop, start + CHUNK_ROWS)
    block = samples.block(start, stop, first=True)
    result = offlineVQF(block.turn / samples.period_s, block.acc_g * 9.81, None, samples.period_s)
    weight = 1.0 / np.asarray(result["biasSigma"], dtype=np.float64) ** 2
    offset = np.average(result["bias"], axis=0, weights=weight)
    sigma = max(2.0 * float(np.min(result["biasSigma"])), float(np.radians(0.2)))
    return np.asarray(offset, dtype=np.float64), np.full(3, sigma)


def _empty(samples: TrustedSamples) -> tuple[FloatArray, FloatArray]:
    total = len(samples.imu.time_s)
    return np.empty((total, 4)), np.empty((total, 3))


def _inputs(block: Block, period_s: float) -> tuple[FloatArray, FloatArray, FloatArray | None]:
    """Return rates, specific force and field (or None) as the package wants them."""
    mag = np.ascontiguousarray(block.mag) if len(block.mag) else None
    return block.turn / period_s, block.acc_g * 9.81, mag


def _quaternions(block: Block, result: dict[str, FloatArray]) -> FloatArray:
    return np.asarray(result["quat9D" if len(block.mag) else "quat6D"], dtype=np.float64)


def _yaw_offset(block: Block, found: FloatArray, before: Before | None, yaw_rad: float) -> float:
    """Return the turn about up that gives a segment's first attitude the wanted yaw, or lets it continue the last."""
    if before is not None:
        return continuing_turn(block, found, before)
    return float(yaw_towards(found[0], with_yaw(found[0], yaw_rad)))


def seam_turn(low: int, found: FloatArray, tail: tuple[int, FloatArray]) -> float:
    """Return the turn about up by which a chunk from row ``low`` continues ``tail``: a row and attitudes (m, 4)."""
    common, before = tail
    angles = yaw_towards(found[common - low : common - low + len(before)], before)
    return float(np.angle(np.mean(np.exp(1j * angles))))


def chunks(samples: TrustedSamples, segment: tuple[int, int]) -> Iterator[tuple[int, int, int, int]]:
    """Yield each chunk's own rows ``start``..``stop`` and the rows ``low``..``high`` that it is computed from."""
    overlap = min(int(_OVERLAP_S / samples.period_s), CHUNK_ROWS // 4)
    count = max(1, -(-(segment[1] - segment[0]) // CHUNK_ROWS))
    edges = np.linspace(segment[0], segment[1], count + 1).astype(int).tolist()
    for start, stop in pairwise(edges):
        yield start, stop, max(start - overlap, segment[0]), min(stop + overlap, segment[1])
