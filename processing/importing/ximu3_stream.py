"""The byte stream of xio's x-IMU3, the same on every interface and in its logger's ``.ximu3`` files.

Messages end with a line feed (User Manual, "Communication protocol"): ASCII ones are a capital letter, the time in µs
and numbers, parted by commas; binary ones are the letter plus 0x80, a 64-bit time in µs and 32-bit floats,
little-endian, stuffed as in SLIP so that no line feed is in them. Gyroscope in °/s, accelerometer in g, magnetometer
in units of Earth's field, temperature in °C. There is no checksum: what has not its kind's length is passed over.
"""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import merge
from processing.importing.raw import GrowingArray, RawImu, ReadContext
from processing.importing.streams import decoded
from processing.importing.text_layout import TextLayout
from processing.importing.units import factor
from processing.survey import Finding, FloatArray, Severity

SUFFIX = ".ximu3"
WIDTHS = {"I": 6, "M": 3, "Q": 4, "T": 1}  # the kinds that are read, and how many numbers each holds
_END, _ESCAPE = b"\n", b"\xdb"
_STUFFED = ((b"\xdb\xdc", b"\n"), (b"\xdb\xdd", b"\xdb"))
_LONGEST = 2000  # a notification may be long; without an end in so many bytes it is no such stream
_LAYOUTS = {
    kind: np.dtype([("kind", "u1"), ("time_us", "<u8"), ("values", "<f4", (width,))]) for kind, width in WIDTHS.items()
}
_FIXED_LENGTHS = {kind: 9 + 4 * width for kind, width in WIDTHS.items()}
_OTHERS = frozenset("HRALEBWSNF")  # documented kinds that say nothing of use here
_HEAD_BYTES = 1 << 16
_FEWEST = 5


class Ximu3Decoder:
    """Finds messages in a stream of bytes, however it is cut; what is none is counted and passed over."""

    def __init__(self) -> None:
        self._left = b""
        self.garbage_bytes = 0
        self.order: dict[str, list[int]] = {kind: [] for kind in WIDTHS}

    def feed(self, data: bytes) -> dict[str, FloatArray]:
        """Return the messages that are complete now: kind → (n, 1 + width), the time in µs first.

        ``order`` then tells of each row its message's place among those of all kinds.
        """
        *messages, self._left = (self._left + data).split(_END)
        if len(self._left) > _LONGEST:
            self.garbage_bytes += len(self._left)
            self._left = b""
        binary: dict[str, list[bytes]] = {kind: [] for kind in WIDTHS}
        text: dict[str, list[list[float]]] = {kind: [] for kind in WIDTHS}
        places: dict[str, tuple[list[int], list[int]]] = {kind: ([], []) for kind in WIDTHS}
        for place, message in enumerate(messages):
            if not message:
                continue
            first = message[0]
            kind = chr(first & 0x7F)
            if kind not in WIDTHS:
                if kind not in _OTHERS and first != ord("{"):
                    self.garbage_bytes += len(message) + 1
            elif first & 0x80:
                whole = _unstuffed(message) if _ESCAPE in message else message
                if len(whole) == _FIXED_LENGTHS[kind]:
                    binary[kind].append(whole)
                    places[kind][0].append(place)
                else:
                    self.garbage_bytes += len(message) + 1
            else:
                numbers = _numbers(message, WIDTHS[kind])
                if numbers is None:
                    self.garbage_bytes += len(message) + 1
                else:
                    text[kind].append(numbers)
                    places[kind][1].append(place)
        self.order = {kind: of_binary + of_text for kind, (of_binary, of_text) in places.items()}
        # one stream is of one sort: where both come, a setting was changed, and the sorts keep their order in time
        return {kind: _table(kind, binary[kind], text[kind]) for kind in WIDTHS}

    def finish(self) -> None:
        """Count what is left over as garbage: nothing follows."""
        self.garbage_bytes += len(self._left)
        self._left = b""


def _unstuffed(message: bytes) -> bytes:
    """Undo the stuffing; in this order, as an escape that was undone may stand before any byte."""
    return message.replace(*_STUFFED[0]).replace(*_STUFFED[1])


def _numbers(message: bytes, width: int) -> list[float] | None:
    parts = message.rstrip(b"\r").split(b",")[1:]
    if len(parts) != 1 + width:
        return None
    try:
        return [float(part) for part in parts]
    except ValueError:
        return None


def _table(kind: str, binary: list[bytes], text: list[list[float]]) -> FloatArray:
    table = np.empty((len(binary), 1 + WIDTHS[kind]))
    if binary:
        rows: npt.NDArray[np.void] = np.frombuffer(b"".join(binary), _LAYOUTS[kind])
        with np.errstate(invalid="ignore"):  # damage may look like a number that signals
            table[:, 0], table[:, 1:] = rows["time_us"], rows["values"]
    if not text:
        return table
    return np.concatenate([table, np.array(text, np.float64)])


def sniff(path: Path, _layout: TextLayout | None) -> float:
    """Return how sure it is (0..1) that the file holds such a stream."""
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    decoder = Ximu3Decoder()
    found = len(decoder.feed(head)["I"])
    return 0.98 if found >= _FEWEST and decoder.garbage_bytes < 0.2 * len(head) else 0.0


def read(path: Path, context: ReadContext) -> RawImu:
    """Return the inertial samples, with field, orientation and temperature brought onto their times.

    Raises:
        LeaklineError: FILE_UNREADABLE, and where no inertial message is in it.
    """
    decoder = Ximu3Decoder()
    stores = {kind: GrowingArray(1 + width, context.scratch) for kind, width in WIDTHS.items()}
    for found in decoded(path, decoder, context):
        for kind, table in found.items():
            stores[kind].append(table)
    tables = {kind: store.finish() for kind, store in stores.items()}
    inertial = tables["I"]
    if not len(inertial):
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason="no inertial message of an x-IMU3 is in it")
    time = 1e-6 * (inertial[:, 0] - inertial[0, 0])
    raw = RawImu(
        time,
        acc=inertial[:, 4:7] * factor("acc", "g"),
        gyr=inertial[:, 1:4] * factor("gyr", "dps"),
        time_unit="s",
        acc_unit="g",
        gyr_unit="dps",
        mag_unit="au",
    )
    beside = {kind: 1e-6 * (tables[kind][:, 0] - inertial[0, 0]) for kind in "MQT"}
    if len(tables["M"]):
        field = merge.onto(time, beside["M"], tables["M"][:, 1:], context.scratch)
        raw.mag = field * factor("mag", "au")
    if len(tables["Q"]):
        raw.quat = merge.quaternions_onto(time, beside["Q"], tables["Q"][:, 1:], context.scratch)
    if len(tables["T"]):
        raw.temperature = np.interp(time, beside["T"], tables["T"][:, 1])
    if decoder.garbage_bytes:
        params: dict[str, str | float] = {"bytes": decoder.garbage_bytes}
        raw.findings.append(Finding("stream_garbage", Severity.MASKED, params))
    return raw
