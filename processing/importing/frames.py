"""Leakline's binary frames: how a ball may send, or keep, its IMU samples so that nothing is taken for what it is not.

One frame a sample, little-endian, the same on a wire and in a file (``.lkf``), so that a file is what was sent:

====== ======== ===========================================================================================
offset type     content
====== ======== ===========================================================================================
0      2 bytes  0xC5 0x4C
2      uint8    version, 1
3      uint8    what follows the gyro: 1 magnetometer, 2 pressure, 4 temperature, 8 orientation, 16 host time
4      uint32   counter, one more a sample, from 4294967295 to 0
8      uint64   the device's time in microseconds
16     3 float  specific force, m/s²
28     3 float  turn rate, rad/s
40     …        float: 3 magnetic field, µT; 1 pressure, kPa; 1 temperature, °C; 4 orientation w x y z; double: host, s
end    uint16   CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) of all from offset 2 on
====== ======== ===========================================================================================

A frame without its end, with a wrong sum, or with anything between frames costs itself and nothing else.
"""

import binascii
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

SYNC = b"\xc5\x4c"
VERSION = 1
MAG, PRESSURE, TEMPERATURE, ORIENTATION, HOST = 1, 2, 4, 8, 16
_ALL = MAG | PRESSURE | TEMPERATURE | ORIENTATION | HOST
_HEAD = 4
_CRC_START = 0xFFFF
_RUN = 512  # frames looked at together: what is torn after each frame must not cost the square of the block

Float32 = npt.NDArray[np.float32]
Float64 = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Frames:
    """``n`` samples; what a frame does not hold is NaN. Force in m/s², rates in rad/s, field in µT, pressure in kPa."""

    counter: npt.NDArray[np.uint32]  # (n,)
    time_us: npt.NDArray[np.uint64]  # (n,) on the device's clock
    acc_s_mps2: Float32  # (n, 3)
    gyr_s_radps: Float32  # (n, 3)
    mag_s_ut: Float32  # (n, 3)
    pressure_kpa: Float32  # (n,)
    temperature_c: Float32  # (n,)
    quat_ws: Float32  # (n, 4)
    host_s: Float64  # (n,) when it arrived, on the host's clock

    def __len__(self) -> int:
        return len(self.counter)


_OPTIONAL = (
    (MAG, "mag_s_ut", "<f4", 3),
    (PRESSURE, "pressure_kpa", "<f4", 1),
    (TEMPERATURE, "temperature_c", "<f4", 1),
    (ORIENTATION, "quat_ws", "<f4", 4),
    (HOST, "host_s", "<f8", 1),
)


def _layout(flags: int) -> np.dtype[np.void]:
    """Return one frame as a packed structure."""
    parts: list[tuple[str, str] | tuple[str, str, tuple[int]]] = [
        ("sync", "S2"),
        ("version", "u1"),
        ("flags", "u1"),
        ("counter", "<u4"),
        ("time_us", "<u8"),
        ("acc_s_mps2", "<f4", (3,)),
        ("gyr_s_radps", "<f4", (3,)),
    ]
    parts += [(name, kind, (width,)) for flag, name, kind, width in _OPTIONAL if flags & flag]
    return np.dtype([*parts, ("crc", "<u2")])


_LAYOUTS = {flags: _layout(flags) for flags in range(_ALL + 1)}
LONGEST = _LAYOUTS[_ALL].itemsize


def checksums(rows: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint16]:
    """Return the CRC-16/CCITT-FALSE (k,) of rows of bytes (k, m)."""
    data, width = rows.tobytes(), rows.shape[1]
    sums = (binascii.crc_hqx(data[at : at + width], _CRC_START) for at in range(0, len(data), width))
    return np.fromiter(sums, np.uint16, len(rows))


def encode(frames: Frames) -> bytes:
    """Return the bytes of the samples; a frame holds what is finite in at least one of them."""
    if not len(frames):
        return b""
    flags = 0
    for flag, name, _, _ in _OPTIONAL:
        flags |= flag if np.isfinite(getattr(frames, name)).any() else 0
    rows = np.zeros(len(frames), _LAYOUTS[flags])
    rows["sync"], rows["version"], rows["flags"] = SYNC, VERSION, flags
    for name in ("counter", "time_us", "acc_s_mps2", "gyr_s_radps"):
        rows[name] = getattr(frames, name)
    for flag, name, _, width in _OPTIONAL:
        if flags & flag:
            rows[name] = np.reshape(getattr(frames, name), (len(frames), width))
    raw = rows.view(np.uint8).reshape(len(frames), -1)
    rows["crc"] = checksums(raw[:, 2:-2])
    return rows.tobytes()


class FrameDecoder:
    """Finds frames in a stream of bytes, however it is cut; what is no frame is counted and passed over."""

    def __init__(self) -> None:
        self._left = b""
        self.garbage_bytes = 0
        self.bad_sums = 0

    def feed(self, data: bytes) -> Frames:
        """Return the samples that are complete now."""
        data = self._left + data
        found: list[npt.NDArray[np.void]] = []
        at = 0
        while True:
            start = data.find(SYNC, at)
            if start < 0:
                keep = 1 if data.endswith(SYNC[:1], at) else 0
                self.garbage_bytes += len(data) - keep - at
                at = len(data) - keep
                break
            self.garbage_bytes += start - at
            at = start
            if len(data) - at < _HEAD:
                break
            version, flags = data[at + 2], data[at + 3]
            if version != VERSION or flags > _ALL:
                at += 1
                self.garbage_bytes += 1
                continue
            layout = _LAYOUTS[flags]
            if len(data) - at < layout.itemsize:
                break
            rows = self._run(data, at, layout)
            if not len(rows):
                self.bad_sums += 1
                self.garbage_bytes += 1
                at += 1  # what looked like a beginning may stand in the middle of something else
                continue
            found.append(rows)
            at += len(rows) * layout.itemsize
        self._left = data[at:]
        return _joined(found)

    def finish(self) -> None:
        """Count what is left over as garbage: nothing follows."""
        self.garbage_bytes += len(self._left)
        self._left = b""

    @staticmethod
    def _run(data: bytes, at: int, layout: np.dtype[np.void]) -> npt.NDArray[np.void]:
        """Return the frames of this kind from ``at`` on, up to the first that is not right."""
        whole = binascii.crc_hqx(data[at + 2 : at + layout.itemsize - 2], _CRC_START)
        if whole != int.from_bytes(data[at + layout.itemsize - 2 : at + layout.itemsize], "little"):
            return np.empty(0, layout)
        count = min((len(data) - at) // layout.itemsize, _RUN)
        raw = np.frombuffer(data, np.uint8, count * layout.itemsize, at).reshape(count, -1)
        same = (raw[:, :_HEAD] == raw[0, :_HEAD]).all(axis=1)
        count = int(np.argmin(same)) if not same.all() else count
        rows: npt.NDArray[np.void] = raw[:count].copy().view(layout)[:, 0]
        right = checksums(raw[:count, 2:-2]) == rows["crc"]
        return rows if right.all() else rows[: int(np.argmin(right))]


def _joined(found: list[npt.NDArray[np.void]]) -> Frames:
    total = sum(len(rows) for rows in found)
    columns: dict[str, Any] = {
        "counter": np.zeros(total, np.uint32),
        "time_us": np.zeros(total, np.uint64),
        "acc_s_mps2": np.zeros((total, 3), np.float32),
        "gyr_s_radps": np.zeros((total, 3), np.float32),
    }
    for _, name, kind, width in _OPTIONAL:
        columns[name] = np.full((total, width) if width > 1 else (total,), np.nan, np.dtype(kind))
    at = 0
    for rows in found:
        here = slice(at, at + len(rows))
        for name in rows.dtype.names or ():
            if name in columns:
                columns[name][here] = rows[name] if columns[name].ndim == rows[name].ndim else rows[name][:, 0]
        at += len(rows)
    return Frames(**columns)
