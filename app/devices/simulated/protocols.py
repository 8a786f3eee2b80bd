"""How a ball may speak to Leakline live: one encoder for each protocol, the inverse of what the importers read.

For makers of balls, in order of preference. All of them work on a serial port (8 data bits, no parity, any speed that
carries the rate), a TCP server or UDP datagrams; a sample is sent when it is taken, several may share a write.

``frames``
    Leakline's binary frames (:mod:`processing.importing.frames` has the table): counter, device time in µs, SI
    values, CRC-16. 42 bytes a sample, 54 with a magnetometer. The only one in which nothing false can be taken for a
    sample, so new balls should speak it.
``csv``
    Text lines of the columns of the survey folder's ``imu.csv``, parted by commas, after one header line that names
    them; here with ``counter`` as last one. Send the header first, and again each second: who begins to listen later
    would not know the columns.
``ximu3``, ``ximu3-binary``
    The messages of xio's x-IMU3 (User Manual, "Communication protocol"): inertial ``I``, magnetometer ``M``,
    quaternion ``Q``, temperature ``T``, as ASCII lines or as stuffed binary messages. Device time, no counter, no sum.
``printed``
    The lines of the recorder of P0 and P3: g, °/s and µT in words, neither time nor counter, so that nothing but the
    moment of arrival places them. Kept for old recorders.
"""

from collections.abc import Callable, Mapping
from typing import Protocol

import numpy as np
import numpy.typing as npt

from processing.importing import frames as binary
from processing.importing.frames import Frames
from processing.importing.units import factor

SEPARATE_NUMBERS = "%.9g"  # enough digits for any 32-bit float to come back as it was
_TEMPERATURE_EVERY = 50


class Encoder(Protocol):
    """Turns samples into what goes over the wire."""

    name: str
    is_checked: bool  # whether a sample that bytes were put before is still known for what it is

    def header(self) -> bytes:
        """Return what is sent when somebody begins to listen."""
        ...

    def encode(self, frames: Frames) -> list[bytes]:
        """Return the bytes of each sample."""
        ...


class FrameEncoder:
    """Leakline's binary frames, without the host's time: the device does not know it."""

    name = "frames"
    is_checked = True

    def header(self) -> bytes:
        """Return nothing: each frame says what it holds."""
        return b""

    def encode(self, frames: Frames) -> list[bytes]:
        """Return one frame a sample."""
        if not len(frames):
            return []
        whole = binary.encode(without_host_time(frames))
        size = len(whole) // len(frames)
        return [whole[at : at + size] for at in range(0, len(whole), size)]


class TableEncoder:
    """Lines of ``imu.csv``; columns that the first samples lack are not in it."""

    name = "csv"
    is_checked = False

    def __init__(self, frames: Frames) -> None:
        self._kinds = [kind for kind in _COLUMNS if np.isfinite(getattr(frames, kind)).any()]
        names = [name for kind in self._kinds for name in _COLUMNS[kind]]
        self._names = ["time_s", *names, "counter"]
        self._form = ",".join(["%.6f", *[SEPARATE_NUMBERS] * len(names), "%d"]) + "\n"

    def header(self) -> bytes:
        """Return the line of names."""
        return (",".join(self._names) + "\n").encode()

    def encode(self, frames: Frames) -> list[bytes]:
        """Return one line a sample."""
        columns = [1e-6 * frames.time_us.astype(np.float64)]
        columns += [np.asarray(getattr(frames, kind), np.float64) for kind in self._kinds]
        table = np.column_stack([*columns, frames.counter])
        return [(self._form % tuple(row)).encode() for row in table.tolist()]


_COLUMNS: Mapping[str, tuple[str, ...]] = {
    "acc_s_mps2": ("acc_x_mps2", "acc_y_mps2", "acc_z_mps2"),
    "gyr_s_radps": ("gyr_x_radps", "gyr_y_radps", "gyr_z_radps"),
    "mag_s_ut": ("mag_x_uT", "mag_y_uT", "mag_z_uT"),
    "quat_ws": ("quat_w", "quat_x", "quat_y", "quat_z"),
    "pressure_kpa": ("pressure_kPa",),
    "temperature_c": ("temperature_C",),
}


class PrintedEncoder:
    """The printed lines of P0 and P3, four decimals as theirs."""

    name = "printed"
    is_checked = False

    def header(self) -> bytes:
        """Return nothing: each line names its values."""
        return b""

    def encode(self, frames: Frames) -> list[bytes]:
        """Return one line a sample."""
        has_field = bool(np.isfinite(frames.mag_s_ut).any())
        words = ["Accelerometer", "Gyroscope"] + ["Magnetometer"] * has_field
        form = ", ".join(f"{word}(xyz)=%.4f,%.4f,%.4f" for word in words) + "---\n"
        columns = [_in("acc", "g", frames.acc_s_mps2), _in("gyr", "dps", frames.gyr_s_radps)]
        columns += [np.asarray(frames.mag_s_ut, np.float64)] * has_field
        return [(form % tuple(row)).encode() for row in np.column_stack(columns).tolist()]


class Ximu3Encoder:
    """The messages of an x-IMU3; field and orientation with each sample, temperature now and then."""

    is_checked = False

    def __init__(self, *, is_binary: bool) -> None:
        self.name = "ximu3-binary" if is_binary else "ximu3"
        self._message = _binary_message if is_binary else _ascii_message

    def header(self) -> bytes:
        """Return nothing: each message says what it is."""
        return b""

    def encode(self, frames: Frames) -> list[bytes]:
        """Return the messages of each sample."""
        rates, force = _in("gyr", "dps", frames.gyr_s_radps), _in("acc", "g", frames.acc_s_mps2)
        tables = {}
        if np.isfinite(frames.mag_s_ut).any():
            tables["M"] = _in("mag", "au", frames.mag_s_ut)
        if np.isfinite(frames.quat_ws).any():
            tables["Q"] = np.asarray(frames.quat_ws, np.float64)
        tables["I"] = np.column_stack([rates, force])  # last: what came before belongs to it
        times = frames.time_us.tolist()
        each = [[self._message(k, t, v) for t, v in zip(times, table)] for k, table in tables.items()]
        rows = [b"".join(messages) for messages in zip(*each)]
        if np.isfinite(frames.temperature_c).any():
            for row in np.flatnonzero(frames.counter % _TEMPERATURE_EVERY == 0).tolist():
                value = np.array([frames.temperature_c[row]], np.float64)
                rows[row] = self._message("T", times[row], value) + rows[row]
        return rows


Numbers = npt.NDArray[np.float64]


def _ascii_message(kind: str, time_us: int, values: Numbers) -> bytes:
    return f"{kind},{time_us},{','.join(f'{value:.4f}' for value in values.tolist())}\r\n".encode()


def _binary_message(kind: str, time_us: int, values: Numbers) -> bytes:
    whole = bytes([ord(kind) | 0x80]) + time_us.to_bytes(8, "little") + values.astype("<f4").tobytes()
    return whole.replace(b"\xdb", b"\xdb\xdd").replace(b"\n", b"\xdb\xdc") + b"\n"


def _in(kind: str, unit: str, values: npt.NDArray[np.float32]) -> Numbers:
    return np.asarray(values, np.float64) / factor(kind, unit)


def without_host_time(frames: Frames) -> Frames:
    """Return the samples as the device knows them."""
    return with_host_time(frames, np.full(len(frames), np.nan))


def with_host_time(frames: Frames, host_s: Numbers) -> Frames:
    """Return the samples with when they were sent."""
    names = ("counter", "time_us", "acc_s_mps2", "gyr_s_radps", "mag_s_ut", "pressure_kpa", "temperature_c", "quat_ws")
    return Frames(**{name: getattr(frames, name) for name in names}, host_s=host_s)


_MADE: Mapping[str, Callable[[Frames], Encoder]] = {
    "frames": lambda _: FrameEncoder(),
    "csv": TableEncoder,
    "printed": lambda _: PrintedEncoder(),
    "ximu3": lambda _: Ximu3Encoder(is_binary=False),
    "ximu3-binary": lambda _: Ximu3Encoder(is_binary=True),
}
PROTOCOLS = tuple(_MADE)


def encoder_named(protocol: str, first: Frames) -> Encoder:
    """Return the encoder of one of :data:`PROTOCOLS`; ``first`` samples show which channels there are."""
    return _MADE[protocol](first)
