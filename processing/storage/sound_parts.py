"""The sound of a recording on disc: ``audio-001.wav``, ``audio-002.wav`` … that continue each other without a gap.

We write the header ourselves, not through libsndfile: its header update is reached only by private names of
python-soundfile, it tells neither a full disc from a pulled stick nor gives the file to sync, and RF64, which needs
such updates most, is of no use to parts that stay below 2 GiB. So a part is plain WAV, its header true after every
write: any program opens it at any moment, also after a kill (measured for libsndfile's own update: acoustics.md §7).
"""

import struct
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.live.stream import SoundFrames
from processing.storage.growing_file import GrowingFile

# one byte more and programs that count with signed 32 bits lose the sound
LARGEST_PART = (1 << 31) - (1 << 16)
_SILENCE_BYTES = 1 << 20
_TAG_PCM, _TAG_FLOAT = 1, 3
_BITS = {"PCM_16": 16, "PCM_24": 24, "PCM_32": 32, "FLOAT": 32}


@dataclass(frozen=True)
class SoundForm:
    """How sound is written; ``subtype`` is ``PCM_16``, ``PCM_24``, ``PCM_32`` or ``FLOAT``."""

    rate_hz: int
    channels: int = 1
    subtype: str = "PCM_24"

    def __post_init__(self) -> None:
        if self.subtype not in _BITS or self.channels < 1 or self.rate_hz < 1:
            raise ValueError(f"no such form of sound: {self}")

    @property
    def frame_bytes(self) -> int:
        """Bytes of one frame, all channels."""
        return self.channels * _BITS[self.subtype] // 8

    @property
    def bytes_per_s(self) -> float:
        """What a second takes on the disc."""
        return float(self.rate_hz * self.frame_bytes)


def packed(frames: SoundFrames, subtype: str) -> bytes:
    """Return frames (n, channels), full scale 2³¹, as the bytes of a WAV file; what the subtype lacks is cut off."""
    whole = np.ascontiguousarray(frames, dtype="<i4")
    if subtype == "PCM_32":
        return whole.tobytes()
    if subtype == "FLOAT":
        return (whole * np.float32(2.0**-31)).astype("<f4").tobytes()
    if subtype == "PCM_16":
        return (whole >> 16).astype("<i2").tobytes()
    quads = whole.view(np.uint8).reshape(-1, 4)
    triples = np.empty((len(quads), 3), np.uint8)
    for byte in range(3):  # six times faster than one copy of the three columns
        triples[:, byte] = quads[:, byte + 1]
    return triples.tobytes()


def wave_header(form: SoundForm, data_bytes: int) -> bytes:
    """Return the header of a WAV file with that much sound (Microsoft's RIFF WAVE, as all readers know it).

    Always tag 1 (or 3 for floats), as libsndfile writes it: WAVE_FORMAT_EXTENSIBLE is refused by more programs than
    three channels or 24 bits without it.
    """
    is_float = form.subtype == "FLOAT"
    bits = _BITS[form.subtype]
    tag = _TAG_FLOAT if is_float else _TAG_PCM
    rates = (form.rate_hz, form.rate_hz * form.frame_bytes, form.frame_bytes, bits)
    parts = [b"fmt " + struct.pack("<IHHIIHH", 16, tag, form.channels, *rates)]
    if is_float:
        parts.append(b"fact" + struct.pack("<II", 4, data_bytes // form.frame_bytes))
    parts.append(b"data" + struct.pack("<I", data_bytes))
    body = b"WAVE" + b"".join(parts)
    # no byte is added after an odd number of them: the file would not be true while it grows
    return b"RIFF" + struct.pack("<I", len(body) + data_bytes) + body


class SoundParts:
    """Writes sound into parts of ``part_s`` seconds; ``begun`` is told each new file and its first frame.

    :meth:`put` only remembers; :meth:`flush` writes, and may be called again after it failed. One thread only.
    """

    def __init__(self, folder: Path, form: SoundForm, part_s: float, begun: Callable[[GrowingFile, int], None]) -> None:
        self.form = form
        self.frames = 0  # that are written
        head = len(wave_header(form, 0))
        self._part_frames = max(1, min(round(part_s * form.rate_hz), (LARGEST_PART - head - 1) // form.frame_bytes))
        self._folder, self._begun, self._head = folder, begun, head
        self._pieces: deque[bytes | int] = deque()  # packed frames, or how many are silent
        self._file: GrowingFile | None = None
        self._parts = 0
        self._stamped = 0  # bytes of the file when its header was written

    def put(self, piece: bytes | int) -> None:
        """Take packed frames, or a number of silent ones."""
        if piece:
            self._pieces.append(piece)

    def flush(self) -> None:
        """Write all that was put; raises DISC_FULL or CANNOT_WRITE, and keeps what is not written."""
        try:
            while self._pieces:
                self._write(self._pieces.popleft())
        finally:
            self._stamp()

    def finish(self) -> None:
        """End the last part: nothing follows."""
        if self._file is not None:
            self._file.is_finished, self._file = True, None

    def _write(self, piece: bytes | int) -> None:
        """Write as much of ``piece`` as the part takes; the rest stays the first of the pieces."""
        each = self.form.frame_bytes
        count = piece if isinstance(piece, int) else len(piece) // each
        room = self._part_frames - self.frames % self._part_frames
        now = min(count, room, _SILENCE_BYTES // each) if isinstance(piece, int) else min(count, room)
        data = bytes(now * each) if isinstance(piece, int) else piece[: now * each]
        try:
            self._append(data)
        except BaseException:
            self._pieces.appendleft(piece)
            raise
        self.frames += now
        if now < count:
            self._pieces.appendleft(piece - now if isinstance(piece, int) else piece[now * each :])
        if self.frames % self._part_frames == 0:
            self._stamp()
            self.finish()

    def _append(self, data: bytes) -> None:
        if self._file is not None:
            self._file.append(data)
            return
        name = f"audio-{self._parts + 1:03d}.wav"
        # header and first frames at once: a part without a frame would be no sound to any reader
        self._file = GrowingFile(self._folder / name, "audio", wave_header(self.form, len(data)) + data)
        self._stamped = self._file.size
        self._parts += 1
        self._begun(self._file, self.frames)

    def _stamp(self) -> None:
        """Make the header true. Its bytes are there already: this needs no room on the disc."""
        file = self._file
        if file is not None and file.size != self._stamped:
            file.rewrite(0, wave_header(self.form, file.size - self._head))
            self._stamped = file.size
