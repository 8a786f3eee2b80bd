"""Decodes interleaved PCM bytes of any usual kind to float32 in −1..1, one channel at a time."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Samples = npt.NDArray[np.float32]

BYTES_PER_SAMPLE = {
    "PCM_S8": 1,
    "PCM_U8": 1,
    "PCM_16": 2,
    "PCM_24": 3,
    "PCM_32": 4,
    "FLOAT": 4,
    "DOUBLE": 8,
    "ULAW": 1,
    "ALAW": 1,
}


@dataclass(frozen=True)
class RawForm:
    """What the operator must tell about sound without a header.

    ``encoding`` is ``signed``, ``unsigned``, ``float``, ``ulaw`` or ``alaw``; ``endian`` ``little`` or ``big``.
    """

    sample_rate_hz: float
    bits: int
    channels: int = 1
    encoding: str = "signed"
    endian: str = "little"
    data_offset: int = 0

    @property
    def subtype(self) -> str | None:
        """The soundfile name of the sample format; None where no such format exists."""
        return {
            ("signed", 8): "PCM_S8",
            ("unsigned", 8): "PCM_U8",
            ("signed", 16): "PCM_16",
            ("signed", 24): "PCM_24",
            ("signed", 32): "PCM_32",
            ("float", 32): "FLOAT",
            ("float", 64): "DOUBLE",
            ("ulaw", 8): "ULAW",
            ("alaw", 8): "ALAW",
        }.get((self.encoding, self.bits))


def decode(raw: bytes, subtype: str, endian: str, channels: int, channel: int) -> Samples:
    """Return ``channel`` of the interleaved bytes ``raw`` as float32; a torn last frame is dropped."""
    frame_bytes = BYTES_PER_SAMPLE[subtype] * channels
    raw = raw[: len(raw) // frame_bytes * frame_bytes]
    order = ">" if endian == "BIG" else "<"
    if subtype == "PCM_24":
        return _decode_24(raw, order, channels, channel)
    if subtype in ("ULAW", "ALAW"):
        codes = np.frombuffer(raw, np.uint8)[channel::channels]
        return (_ulaw_table() if subtype == "ULAW" else _alaw_table())[codes]
    if subtype in ("FLOAT", "DOUBLE"):
        floats = np.frombuffer(raw, f"{order}f{BYTES_PER_SAMPLE[subtype]}")[channel::channels]
        with np.errstate(over="ignore", invalid="ignore"):  # the reader zeroes and counts what is not finite
            return floats.astype(np.float32)
    if subtype == "PCM_U8":
        shifted = np.frombuffer(raw, np.uint8)[channel::channels].astype(np.float32)
        return (shifted - np.float32(128)) * np.float32(1 / 128)
    width = BYTES_PER_SAMPLE[subtype]
    integers = np.frombuffer(raw, f"{order}i{width}")[channel::channels]
    return integers.astype(np.float32) * np.float32(2.0 ** (1 - 8 * width))


def _decode_24(raw: bytes, order: str, channels: int, channel: int) -> Samples:
    triples = np.frombuffer(raw, np.uint8).reshape(-1, channels, 3)[:, channel, :]
    padded = np.zeros((len(triples), 4), np.uint8)
    padded[:, 1:] = triples if order == "<" else triples[:, ::-1]
    # the empty lowest byte makes the integer 256 times too large, and its sign right
    return padded.view("<i4")[:, 0].astype(np.float32) * np.float32(2.0**-31)


def _ulaw_table() -> Samples:
    """ITU-T G.711 μ-law."""
    codes = ~np.arange(256, dtype=np.uint8)
    magnitude = (((codes & 0x0F).astype(np.int32) << 3) + 0x84 << ((codes & 0x70).astype(np.int32) >> 4)) - 0x84
    return (np.where(codes & 0x80, -magnitude, magnitude) / 32768.0).astype(np.float32)


def _alaw_table() -> Samples:
    """ITU-T G.711 A-law."""
    codes = np.arange(256, dtype=np.uint8) ^ np.uint8(0x55)
    exponent = (codes & 0x70).astype(np.int32) >> 4
    mantissa = ((codes & 0x0F).astype(np.int32) << 4) + 8
    magnitude = np.where(exponent == 0, mantissa, (mantissa + 0x100) << np.maximum(exponent - 1, 0))
    return (np.where(codes & 0x80, magnitude, -magnitude) / 32768.0).astype(np.float32)
