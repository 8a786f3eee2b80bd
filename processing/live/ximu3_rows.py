"""Joins an x-IMU3's messages into rows: each inertial one with the latest field, orientation, temperature before it."""

import numpy as np
import numpy.typing as npt

from processing.importing.frames import Frames
from processing.importing.text_blocks import drop_absurd
from processing.importing.units import factor
from processing.importing.ximu3_stream import WIDTHS, Ximu3Decoder
from processing.live.decoded_rows import frames_of, usable_time
from processing.live.frame_rows import no_frames
from processing.survey import FloatArray

_STALE_US = 2e6  # a value this old, on the device's clock, is no longer what is now


class Ximu3RowsDecoder:
    """Finds rows in a stream of ASCII or binary messages, however it is cut; ``latest`` means in the stream's order."""

    name = "ximu3"
    has_time = True
    has_counter = False

    def __init__(self) -> None:
        self._messages = Ximu3Decoder()
        self._latest = {kind: np.full((1, 1 + WIDTHS[kind]), np.nan) for kind in "MQT"}
        self._count = 0
        self._garbage = 0
        self.bad_sums = 0

    @property
    def garbage_bytes(self) -> int:
        """How many bytes were in no message of this device."""
        return self._garbage + self._messages.garbage_bytes

    def feed(self, data: bytes) -> Frames:
        """Return the rows that are complete now."""
        found = self._messages.feed(data)
        if not any(map(len, found.values())):
            return no_frames()
        order = {kind: np.array(places, np.int64) for kind, places in self._messages.order.items()}
        inertial, places = _in_order(found["I"], order["I"])
        beside = {}
        for kind, latest in self._latest.items():
            if not len(found[kind]):
                beside[kind] = _fresh(latest[np.zeros(len(inertial), np.int64)], inertial[:, 0])
                continue
            values, at = _in_order(found[kind], order[kind])
            known = np.concatenate([latest, values])
            beside[kind] = _fresh(known[np.searchsorted(at, places)], inertial[:, 0])
            self._latest[kind] = known[-1:]
        good = usable_time(1e-6 * inertial[:, 0]) & np.isfinite(inertial[:, 1:]).all(axis=1)
        self._garbage += int((~good).sum()) * (9 + 4 * WIDTHS["I"])
        inertial = inertial[good]
        drop_absurd(inertial[:, 1:])
        counter = self._count + np.arange(len(inertial))
        self._count += len(inertial)
        return frames_of(
            1e-6 * inertial[:, 0],
            inertial[:, 4:7] * factor("acc", "g"),
            inertial[:, 1:4] * factor("gyr", "dps"),
            counter,
            mag_s_ut=beside["M"][good] * factor("mag", "au"),
            quat_ws=beside["Q"][good],
            temperature_c=beside["T"][good][:, 0],
        )

    def restart(self) -> None:
        """Begin in the middle of a message again: the device was away."""
        self._messages.finish()
        self._latest = {kind: np.full_like(latest, np.nan) for kind, latest in self._latest.items()}


def _in_order(table: FloatArray, places: npt.NDArray[np.int64]) -> tuple[FloatArray, npt.NDArray[np.int64]]:
    """Return a kind's rows, and their places, as they came."""
    if len(places) < 2 or bool((np.diff(places) > 0).all()):
        return table, places
    sequence = np.argsort(places, kind="stable")
    return table[sequence], places[sequence]


def _fresh(rows: FloatArray, time_us: FloatArray) -> FloatArray:
    """Return the values (n, k) of rows (n, 1 + k) whose time is near that of the samples, NaN for others."""
    values = rows[:, 1:].copy()
    values[~(np.abs(time_us - rows[:, 0]) < _STALE_US)] = np.nan
    drop_absurd(values)
    return values
