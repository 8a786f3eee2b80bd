"""Reads what a WAV, RF64 or BW64 header says and what the file really holds, without believing the header.

Recorders die with the power: sizes stay 0 or −1, stop at the last header update, or wrap at 4 GiB. The samples are on
the disc nevertheless. This module finds them; it never writes. Sources: EBU Tech 3306 (RF64), ITU-R BS.2088 (BW64).
"""

from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place

WAVE_MAGICS = (b"RIFF", b"RIFX", b"RF64", b"BW64")
_UNKNOWN_32 = 0xFFFFFFFF
_UNKNOWN_64 = 0xFFFFFFFFFFFFFFFF
_WRAP = 1 << 32
_MAX_CHUNKS = 4096
_PROBE_BYTES = 65536
_PCM_SUBTYPES = {8: "PCM_U8", 16: "PCM_16", 24: "PCM_24", 32: "PCM_32"}
_FLOAT_SUBTYPES = {32: "FLOAT", 64: "DOUBLE"}
_TAG_PCM, _TAG_FLOAT, _TAG_ALAW, _TAG_ULAW, _TAG_EXTENSIBLE = 1, 3, 6, 7, 0xFFFE


@dataclass(frozen=True)
class WaveLayout:
    """Where the samples of a wave file lie; ``subtype`` is None where the samples are compressed or odd.

    ``claimed_bytes`` is what the header promises (None: it promises nothing), ``data_bytes`` what is there.
    """

    sample_rate_hz: float
    channels: int
    subtype: str | None
    endian: str
    frame_bytes: int
    data_offset: int
    data_bytes: int
    claimed_bytes: int | None

    @property
    def frames(self) -> int:
        """Whole frames in the file; a torn last frame is dropped."""
        return self.data_bytes // self.frame_bytes

    @property
    def is_repaired(self) -> bool:
        """Whether the header's size was not believed (one missing pad byte is no lie)."""
        return self.claimed_bytes is None or abs(self.claimed_bytes - self.data_bytes) >= self.frame_bytes


def read_wave_layout(path: Path) -> WaveLayout:
    """Return the layout of the wave file at ``path``.

    Raises:
        LeaklineError: AUDIO_UNREADABLE with the byte where the header makes no sense.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        magic, kind = (head := file.read(12))[:4], head[8:]
        if kind != b"WAVE":
            raise _unreadable(path, 8, "it is not a WAVE file")
        order = "big" if magic == b"RIFX" else "little"
        walk = _ChunkWalk(file, size, order)
        walk.find_data(path)
        fmt, claimed = walk.fmt, walk.claimed
        if fmt is None or len(fmt) < 16:
            raise _unreadable(path, 12, "the header does not say what format the samples have")
        available = size - walk.data_offset
        data_bytes, claimed = _believe(file, size, walk.data_offset, claimed, order)
    return _layout(path, fmt, order, walk.data_offset, min(data_bytes, available), claimed)


class _ChunkWalk:
    """Steps over the chunks in front of the samples."""

    def __init__(self, file: BufferedReader, size: int, order: str) -> None:
        self._file, self._size, self._order = file, size, order
        self.fmt: bytes | None = None
        self.data_offset = 0
        self.claimed: int | None = None
        self._ds64_data: int | None = None

    def _number(self, raw: bytes) -> int:
        return int.from_bytes(raw, "big" if self._order == "big" else "little")

    def find_data(self, path: Path) -> None:
        """Walk from byte 12 to the ``data`` chunk, keeping ``fmt`` and ``ds64``."""
        at = 12
        for _ in range(_MAX_CHUNKS):
            self._file.seek(at)
            head = self._file.read(8)
            if len(head) < 8:
                raise _unreadable(path, min(at, self._size), "the header ends before the samples begin")
            name, length = head[:4], self._number(head[4:])
            if name == b"data":
                self.data_offset = at + 8
                self.claimed = self._claim(length)
                return
            if name == b"fmt ":
                self.fmt = self._file.read(min(length, 64))
            elif name == b"ds64":
                body = self._file.read(min(length, 28))
                self._ds64_data = self._number(body[8:16]) if len(body) >= 16 else None
            at += 8 + length + (length & 1)
        raise _unreadable(path, at, "the header has too many parts")

    def _claim(self, length: int) -> int | None:
        if length == _UNKNOWN_32 and self._ds64_data is not None:
            return None if self._ds64_data in (0, _UNKNOWN_64) else self._ds64_data
        return None if length in (0, _UNKNOWN_32) else length


def _believe(file: BufferedReader, size: int, offset: int, claimed: int | None, order: str) -> tuple[int, int | None]:
    """Return ``(bytes of samples in the file, bytes the header claims)``."""
    rest = size - offset
    if claimed is None:
        # a file closed properly with no sample in it has only metadata behind an empty data chunk
        return (0, 0) if rest == 0 or (rest >= 8 and _is_chunk_list(file, offset, size, order)) else (rest, None)
    if claimed >= rest:
        return rest, claimed
    for real in range(claimed, rest + 1, _WRAP):  # sizes beyond 4 GiB are written modulo 2^32 by some recorders
        if _is_chunk_list(file, offset + real + (real & 1), size, order):
            return real, claimed
    is_padding = rest - claimed < 4096 or _is_all_zero(file, offset + claimed, size)
    return (claimed if is_padding else rest), claimed


def _is_chunk_list(file: BufferedReader, at: int, size: int, order: str) -> bool:
    """Whether well-formed chunks fill the file from byte ``at`` to its end."""
    for _ in range(_MAX_CHUNKS):
        if size - at <= 1:
            return True
        file.seek(at)
        head = file.read(8)
        if len(head) < 8 or not all(0x20 <= c < 0x7F for c in head[:4]):
            return False
        length = int.from_bytes(head[4:], "big" if order == "big" else "little")
        at += 8 + length + (length & 1)
        if at > size + 1:
            return False
    return False


def _is_all_zero(file: BufferedReader, start: int, end: int) -> bool:
    for at in (start, max(start, end - _PROBE_BYTES)):
        file.seek(at)
        if any(file.read(_PROBE_BYTES)):
            return False
    return True


def _layout(path: Path, fmt: bytes, order: str, offset: int, data_bytes: int, claimed: int | None) -> WaveLayout:
    def number(start: int, end: int) -> int:
        return int.from_bytes(fmt[start:end], "big" if order == "big" else "little")

    tag, channels, rate, align, bits = number(0, 2), number(2, 4), number(4, 8), number(12, 14), number(14, 16)
    if tag == _TAG_EXTENSIBLE and len(fmt) >= 26:
        tag = number(24, 26)
    if channels == 0:
        raise _unreadable(path, 22, "the header says that there are no channels")
    subtype = {
        _TAG_PCM: _PCM_SUBTYPES.get(bits),
        _TAG_FLOAT: _FLOAT_SUBTYPES.get(bits),
        _TAG_ALAW: "ALAW" if bits == 8 else None,
        _TAG_ULAW: "ULAW" if bits == 8 else None,
    }.get(tag)
    frame_bytes = channels * bits // 8
    if align != frame_bytes:  # e.g. 24 bits in 4 bytes: leave it to libsndfile
        subtype = None if align else subtype
    return WaveLayout(
        float(rate), channels, subtype, order.upper(), max(frame_bytes, 1), offset, max(data_bytes, 0), claimed
    )


def _unreadable(path: Path, byte: int, reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.AUDIO_UNREADABLE, Place(path, byte=byte), reason=reason)
