"""Follows a recording as it comes: the same recursions as after the run, with the state carried from block to block.

However the rows are cut into blocks, the attitudes are those of the whole run at once.
"""

from dataclasses import replace

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.orientation import quaternions as qt
from processing.orientation.calibration import Calibration
from processing.orientation.magnetometer import FieldReference
from processing.orientation.recursion import Recursion
from processing.orientation.registry import ESTIMATORS, estimator
from processing.orientation.samples import Block, TrustedSamples, in_segments
from processing.orientation.start import TAIL_S, Before, end_of, first_attitude
from processing.settings import OrientationSettings
from processing.survey import FloatArray, ImuSamples

LIVE_NAMES = tuple(row.name for row in ESTIMATORS if row.recursion is not None)
Attitudes = tuple[FloatArray, FloatArray]


class LiveAttitude:
    """One estimator and its state; rows go in as they come, attitudes come out."""

    def __init__(
        self,
        name: str,
        calibration: Calibration,
        settings: OrientationSettings,
        period_s: float,
        *,
        field: FieldReference | None = None,
        yaw_rad: float = 0.0,
    ) -> None:
        """Begin with the device's sample period and what the rest before the launch told.

        ``field`` is the undisturbed field where the magnetometer may tell the heading, ``yaw_rad`` the first yaw where
        it may not.

        Raises:
            LeaklineError: SETTING_INVALID for an estimator that needs the whole run.
        """
        row = estimator(name)
        if row.recursion is None:
            allowed = ", ".join(LIVE_NAMES)
            raise LeaklineError(ErrorCode.SETTING_INVALID, name="processing.orientation", value=name, allowed=allowed)
        self._make = row.recursion
        field = field if row.uses_field else None
        self._view = TrustedSamples(_no_rows(), calibration, settings, field, None, ((0, 0),), period_s)
        self._yaw_rad = yaw_rad
        self._rows = _no_rows()  # those that wait, after the last one of a segment under way
        self._recursion: Recursion | None = None
        self._state: FloatArray | None = None
        self._under_way = False
        self._tail: list[tuple[Block, FloatArray]] = []
        self._before: Before | None = None
        self.bias_radps = np.zeros(3)  # what the estimator itself takes off the calibrated rates by now

    def recalibrate(self, calibration: Calibration, turn_rad: float = 0.0) -> None:
        """Go on with what was learnt since: the attitude is kept, turned about up; the estimator's offset is not."""
        self._view = replace(self._view, calibration=calibration)
        self._recursion = None
        self.bias_radps = np.zeros(3)
        turn = qt.turn_about_up(turn_rad)
        self._tail = [(block, qt.multiply(turn, quat)) for block, quat in self._tail]
        if self._under_way and self._state is not None:
            self._recursion = self._make(replace(self._view, imu=self._rows))
            self._state = self._recursion.begin(qt.multiply(turn, self._state[:4]), None)

    def add(self, imu: ImuSamples) -> Attitudes:
        """Take rows (m,); return times (k,) and attitudes (k, 4) of the trusted rows that have become known.

        At the beginning, and after a hole that loses the attitude, rows wait until ``start_s`` of them tell the tilt.
        """
        self._rows = _joined(self._rows, _trusted(imu))
        return self._work(end=False)

    def finish(self) -> Attitudes:
        """Return the attitudes of what still waits, however short."""
        return self._work(end=True)

    def _work(self, *, end: bool) -> Attitudes:
        found: list[Attitudes] = [(np.zeros(0), np.zeros((0, 4)))]
        while len(self._rows.time_s) > self._under_way:
            view = in_segments(replace(self._view, imu=self._rows, segments=((0, len(self._rows.time_s)),)))
            stop = view.segments[0][1]
            whole = len(view.segments) > 1
            if stop > self._under_way:
                if not (self._under_way or whole or end or self._tells_the_tilt()):
                    break
                found.append(self._advance(view, stop))
            if whole:
                self._end_segment()
                self._rows = _cut(self._rows, stop)
            else:
                self._rows = _cut(self._rows, stop - 1)
        times, quats = zip(*found, strict=True)
        return np.concatenate(times), np.concatenate(quats)

    def _tells_the_tilt(self) -> bool:
        return bool(self._rows.time_s[-1] - self._rows.time_s[0] >= self._view.settings.start_s)

    def _advance(self, view: TrustedSamples, stop: int) -> Attitudes:
        """Move the state over a segment's rows up to ``stop``."""
        block = view.block(int(self._under_way), stop, first=not self._under_way)
        if self._recursion is None:
            self._recursion = self._make(view)
        if not self._under_way:
            q = first_attitude(block, view.settings.start_s, self._yaw_rad, self._before)
            self._state = self._recursion.begin(q, self._state)
            self._under_way = True
        assert self._state is not None
        quat, bias = np.empty((len(block.time_s), 4)), np.empty((len(block.time_s), 3))
        self._recursion.advance(block, self._state, quat, bias)
        if self._recursion.estimates_bias and len(bias):
            self.bias_radps = bias[-1].copy()
        self._tail.append((block, quat))
        while len(self._tail) > 1 and self._tail[1][0].time_s[0] <= block.time_s[-1] - TAIL_S:
            self._tail.pop(0)
        return block.time_s, quat

    def _end_segment(self) -> None:
        if self._tail:
            blocks, quats = zip(*self._tail, strict=True)
            joined = {n: np.concatenate([getattr(b, n) for b in blocks]) for n in ("time_s", "dt_s", "turn")}
            self._before = end_of(replace(blocks[-1], **joined), np.concatenate(quats))
        self._tail, self._under_way = [], False


def _no_rows() -> ImuSamples:
    return ImuSamples(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, dtype=np.bool_))


def _trusted(imu: ImuSamples) -> ImuSamples:
    """Return the valid rows, with the channels that an estimator reads."""
    valid = np.asarray(imu.valid)
    return ImuSamples(
        time_s=np.asarray(imu.time_s)[valid],
        acc_s_mps2=np.asarray(imu.acc_s_mps2)[valid],
        gyr_s_radps=np.asarray(imu.gyr_s_radps)[valid],
        valid=valid[valid],
        mag_s_ut=None if imu.mag_s_ut is None else np.asarray(imu.mag_s_ut)[valid],
    )


def _joined(first: ImuSamples, second: ImuSamples) -> ImuSamples:
    if not len(first.time_s):
        return second
    mag = None
    if first.mag_s_ut is not None and second.mag_s_ut is not None:
        mag = np.concatenate([first.mag_s_ut, second.mag_s_ut])
    return ImuSamples(
        np.concatenate([first.time_s, second.time_s]),
        np.concatenate([first.acc_s_mps2, second.acc_s_mps2]),
        np.concatenate([first.gyr_s_radps, second.gyr_s_radps]),
        np.concatenate([first.valid, second.valid]),
        mag,
    )


def _cut(imu: ImuSamples, start: int) -> ImuSamples:
    mag = None if imu.mag_s_ut is None else imu.mag_s_ut[start:]
    return ImuSamples(imu.time_s[start:], imu.acc_s_mps2[start:], imu.gyr_s_radps[start:], imu.valid[start:], mag)
