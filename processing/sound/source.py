"""Opens sound of any usual kind, whole or damaged, and reads one channel of it from anywhere, never writing to it."""

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import IO, Any, Self

import numpy as np
import soundfile

from processing.errors import ErrorCode, LeaklineError, Place
from processing.sound.pcm import BYTES_PER_SAMPLE, RawForm, Samples, decode
from processing.sound.riff import WAVE_MAGICS, WaveLayout, read_wave_layout
from processing.survey import AudioPart, AudioSource, Finding, Severity

__all__ = ["AUDIO_SUFFIXES", "AudioReader", "RawForm", "blocks", "open_audio", "read_frames"]

_USUAL = (".wav", ".wave", ".bwf", ".rf64", ".bw64", ".w64", ".flac", ".caf", ".ogg", ".aiff", ".aif")
AUDIO_SUFFIXES = frozenset({*_USUAL, ".oga", ".opus", ".aifc", ".au", ".snd", ".mp3", ".voc", ".raw", ".pcm"})
_MAGICS = (*WAVE_MAGICS, b"fLaC", b"OggS", b"FORM", b"caff", b".snd", b"riff", b"ID3")
_RATE_RANGE_HZ = (1000.0, 1_000_000.0)
_MAX_CHANNELS = 64
_MAX_DURATION_S = 14 * 86400.0  # a longer claim is a damaged header; streaming it would never end
_HARDLY_BEGUN_BYTES = 65536  # less than a second of sound
_COUNT_BLOCK = 65536
_COUNT_FINE = 1024


def open_audio(
    paths: Sequence[Path], raw_form: RawForm | None = None, channel: int = 0
) -> tuple[AudioSource, tuple[Finding, ...]]:
    """Return the recording in ``paths``, parts in the given order, and what was odd about the files.

    Args:
        paths: one file or more; several follow each other without a gap.
        raw_form: how to read files that have no header of their own.
        channel: which channel to analyse; one that does not exist becomes 0, with a finding.

    Raises:
        LeaklineError: FILE_MISSING, FILE_EMPTY, FILE_UNREADABLE, AUDIO_UNREADABLE, AUDIO_NEEDS_FORM,
            AUDIO_PARTS_DIFFER.
    """
    if not paths:
        raise ValueError("no path given")
    findings: list[Finding] = []
    opened = _open_parts([Path(path) for path in paths], raw_form, findings)
    _, rate, channels = opened[0]
    for part, other_rate, other_channels in opened[1:]:
        if (other_rate, other_channels) != (rate, channels):
            raise LeaklineError(ErrorCode.AUDIO_PARTS_DIFFER, Place(part.path))
    if not 0 <= channel < channels:
        params: dict[str, str | float] = {"channel": channel, "channels": channels}
        findings.append(Finding("audio_channel_missing", Severity.WARNING, params))
        channel = 0
    source = AudioSource(tuple(part for part, _, _ in opened), rate, channels, channel)
    if len(opened) > 1:
        params = {"count": len(opened), "duration_s": source.duration_s}
        findings.append(Finding("audio_parts", Severity.INFO, params))
    return source, tuple(findings)


def read_frames(source: AudioSource, start: int, count: int) -> Samples:
    """Return ``count`` samples of ``source.channel`` from frame ``start`` on, float32 (count,), short at the end.

    For many reads of one source use an :class:`AudioReader`, which keeps the files open.
    """
    with AudioReader(source) as reader:
        return reader.read(start, count)


def blocks(source: AudioSource, size: int) -> Iterator[Samples]:
    """Yield the whole channel in order, ``size`` samples at a time, the last one shorter."""
    with AudioReader(source) as reader:
        for start in range(0, source.frames, size):
            yield reader.read(start, size)


class AudioReader:
    """Reads samples of one channel from anywhere in a source and keeps its files open; one reader a thread.

    Samples that are NaN or infinite come out as 0; ``not_finite`` counts them.
    """

    def __init__(self, source: AudioSource) -> None:
        self._source = source
        self._open_index = -1
        self._handle: Any = None
        self.not_finite = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the files; reading again opens them again."""
        if self._handle is not None:
            self._handle.close()
        self._handle, self._open_index = None, -1

    def read(self, start: int, count: int) -> Samples:
        """Return up to ``count`` samples from frame ``start`` (>= 0) on, across parts, float32.

        Raises:
            LeaklineError: AUDIO_UNREADABLE where a file gives less than it held when it was opened.
        """
        if start < 0:
            raise ValueError("start lies before the recording")
        pieces: list[Samples] = []
        part_start = 0
        for index, part in enumerate(self._source.parts):
            first = max(start, part_start)
            last = min(start + count, part_start + part.frames)
            if first < last:
                pieces.append(self._read_part(index, part, first - part_start, last - first))
            part_start += part.frames
        samples = pieces[0] if len(pieces) == 1 else np.concatenate([np.zeros(0, np.float32), *pieces])
        return self._made_finite(samples)

    def _read_part(self, index: int, part: AudioPart, start: int, count: int) -> Samples:
        try:
            if self._open_index != index:
                self.close()
                self._handle = part.path.open("rb") if part.raw_subtype else soundfile.SoundFile(_name_of(part.path))
                self._open_index = index
            if part.raw_subtype:
                samples = _read_raw(self._handle, part, self._source.channels, self._source.channel, start, count)
            else:
                samples = self._read_decoded(part, start, count)
        except OSError as error:
            raise LeaklineError(
                ErrorCode.AUDIO_UNREADABLE, Place(part.path), reason=error.strerror or str(error)
            ) from error
        except soundfile.SoundFileError as error:
            raise LeaklineError(ErrorCode.AUDIO_UNREADABLE, Place(part.path), reason=_reason(error)) from error
        if len(samples) < count:
            reason = f"it ends after {start + len(samples)} of {part.frames} samples"
            raise LeaklineError(ErrorCode.AUDIO_UNREADABLE, Place(part.path), reason=reason)
        return samples

    def _read_decoded(self, part: AudioPart, start: int, count: int) -> Samples:
        if self._handle.tell() != start:
            try:
                self._handle.seek(start)
            except soundfile.SoundFileError:
                # a compressed file that was cut off can often be read but not sought: read on from its beginning
                self._handle.close()
                self._handle = soundfile.SoundFile(_name_of(part.path))
                for at in range(0, start, _COUNT_BLOCK):
                    self._handle.read(min(_COUNT_BLOCK, start - at), dtype="float32")
        data = self._handle.read(count, dtype="float32", always_2d=True)
        return np.ascontiguousarray(data[:, self._source.channel])

    def _made_finite(self, samples: Samples) -> Samples:
        bad = ~np.isfinite(samples) if samples.size and not np.isfinite(samples.sum(dtype=np.float64)) else None
        if bad is None:
            return samples
        self.not_finite += int(bad.sum())
        return np.where(bad, np.float32(0), samples)


def _read_raw(file: IO[bytes], part: AudioPart, channels: int, channel: int, start: int, count: int) -> Samples:
    assert part.raw_subtype is not None
    frame_bytes = BYTES_PER_SAMPLE[part.raw_subtype] * channels
    file.seek(part.data_offset + start * frame_bytes)
    return decode(file.read(count * frame_bytes), part.raw_subtype, part.endian, channels, channel)


# --- opening one file ----------------------------------------------------------------------------------------------


def _name_of(path: Path) -> str | bytes:
    """Return the name as soundfile takes it; outside of Windows as bytes, which need not be text in any encoding."""
    return str(path) if os.name == "nt" else os.fsencode(path)


_Opened = tuple[AudioPart, float, int]  # part, sample rate, channels


def _open_parts(paths: list[Path], raw_form: RawForm | None, findings: list[Finding]) -> list[_Opened]:
    """Open all parts; a last one that the power cut left with hardly more than its header does not cost the others."""
    opened = []
    for path in paths:
        try:
            opened.append(_open_part(path, raw_form, findings))
        except LeaklineError:
            if path is not paths[-1] or not opened or not _is_hardly_begun(path):
                raise
            findings.append(Finding("audio_part_hardly_begun", Severity.WARNING, {"file": path.name}))
    return opened


def _is_hardly_begun(path: Path) -> bool:
    """Whether the file is hardly more than a header, or nothing but the zeros that a power cut leaves on some discs."""
    if not path.is_file():
        return False
    if path.stat().st_size <= _HARDLY_BEGUN_BYTES:
        return True
    with path.open("rb") as file:
        return not any(file.read(_HARDLY_BEGUN_BYTES))


def _open_part(path: Path, raw_form: RawForm | None, findings: list[Finding]) -> _Opened:
    magic = _magic(path)
    if magic.startswith(WAVE_MAGICS):
        opened = _open_wave(path, read_wave_layout(path), findings)
    elif not magic.startswith(_MAGICS) and (raw_form is not None or path.suffix.lower() == ".raw"):
        opened = _open_raw(path, raw_form, findings)
    else:
        opened = _open_decoded(path, magic, findings)
    part, rate, channels = opened
    if not (_RATE_RANGE_HZ[0] <= rate <= _RATE_RANGE_HZ[1] and 1 <= channels <= _MAX_CHANNELS):
        raise _unreadable(path, f"it claims {rate:.0f} samples a second in {channels} channels")
    if part.frames <= 0:
        raise _unreadable(path, "it holds no sound")
    if part.frames / rate > _MAX_DURATION_S:
        raise _unreadable(path, f"it claims to last {part.frames / rate / 3600:.0f} hours")
    return opened


def _magic(path: Path) -> bytes:
    try:
        if not path.exists():
            raise LeaklineError(ErrorCode.FILE_MISSING, Place(path))
        if not path.is_file():  # a folder, or a pipe that would block for ever
            raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason="not a file")
        with path.open("rb") as file:
            magic = file.read(16)
    except OSError as error:
        reason = error.strerror or str(error)
        raise LeaklineError(ErrorCode.FILE_UNREADABLE, Place(path), reason=reason) from error
    if not magic:
        raise LeaklineError(ErrorCode.FILE_EMPTY, Place(path))
    return magic


def _open_wave(path: Path, layout: WaveLayout, findings: list[Finding]) -> _Opened:
    if layout.subtype is None:  # compressed inside, or an odd container: libsndfile knows more kinds than we do
        return _open_decoded(path, b"RIFF", findings)
    rate, channels = layout.sample_rate_hz, layout.channels
    if layout.is_repaired and layout.frames > 0 and rate > 0:
        params: dict[str, str | float] = {"file": path.name, "found_s": layout.frames / rate}
        if layout.claimed_bytes is None:
            findings.append(Finding("audio_header_unfinished", Severity.REPAIRED, params))
        else:
            params["claimed_s"] = layout.claimed_bytes / layout.frame_bytes / rate
            findings.append(Finding("audio_header_wrong", Severity.REPAIRED, params))
    if _libsndfile_frames(path) == layout.frames:
        return AudioPart(path, layout.frames), rate, channels
    part = AudioPart(path, layout.frames, layout.subtype, layout.endian, layout.data_offset)
    return part, rate, channels


def _libsndfile_frames(path: Path) -> int | None:
    if path.suffix.lower() == ".raw":  # soundfile goes by this name and would not look at the header
        return None
    try:
        with soundfile.SoundFile(_name_of(path)) as file:
            return int(file.frames)
    except soundfile.SoundFileError:
        return None


def _open_raw(path: Path, form: RawForm | None, findings: list[Finding]) -> _Opened:
    if form is None:
        raise LeaklineError(ErrorCode.AUDIO_NEEDS_FORM, Place(path))
    if form.subtype is None or form.channels < 1 or form.data_offset < 0:
        raise _unreadable(path, f"there is no {form.encoding} format of {form.bits} bits")
    frame_bytes = BYTES_PER_SAMPLE[form.subtype] * form.channels
    frames = max(0, path.stat().st_size - form.data_offset) // frame_bytes
    endian = "BIG" if form.endian.lower() == "big" else "LITTLE"
    params: dict[str, str | float] = {
        "file": path.name,
        "sample_rate_hz": form.sample_rate_hz,
        "bits": form.bits,
        "channels": form.channels,
        "duration_s": frames / form.sample_rate_hz if form.sample_rate_hz > 0 else 0.0,
    }
    findings.append(Finding("audio_read_as_raw", Severity.INFO, params))
    return (
        AudioPart(path, frames, form.subtype, endian, form.data_offset),
        float(form.sample_rate_hz),
        form.channels,
    )


def _open_decoded(path: Path, magic: bytes, findings: list[Finding]) -> _Opened:
    try:
        with soundfile.SoundFile(_name_of(path)) as file:
            rate, channels, claimed = float(file.samplerate), int(file.channels), int(file.frames)
            is_whole = 0 < claimed / rate <= _MAX_DURATION_S and _has_frame(file, claimed - 1)
    except (soundfile.SoundFileError, TypeError, ZeroDivisionError) as error:
        if not magic.startswith(_MAGICS):
            raise LeaklineError(ErrorCode.AUDIO_NEEDS_FORM, Place(path)) from error
        raise _unreadable(path, _reason(error)) from error
    frames = claimed if is_whole else _count_readable(path)
    if not is_whole and frames > 0:
        params: dict[str, str | float] = {"file": path.name, "found_s": frames / rate}
        findings.append(Finding("audio_cut_short", Severity.REPAIRED, params))
    return AudioPart(path, frames), rate, channels


def _has_frame(file: Any, frame: int) -> bool:  # noqa: ANN401  # soundfile has no types
    try:
        file.seek(frame)
        return len(file.read(1)) == 1
    except soundfile.SoundFileError:
        return False


def _count_readable(path: Path) -> int:
    """Return how many frames can be read before the first error, whatever the header claims."""
    limit = int(_MAX_DURATION_S * _RATE_RANGE_HZ[1])
    coarse, has_failed = _count_until_error(path, limit)
    # a block that fails gives nothing of itself: go up to it again in finer steps
    return _count_until_error(path, coarse)[0] if has_failed else coarse


def _count_until_error(path: Path, coarse_until: int) -> tuple[int, bool]:
    count = 0
    with soundfile.SoundFile(_name_of(path)) as file:
        while True:
            size = _COUNT_BLOCK if count + _COUNT_BLOCK <= coarse_until else _COUNT_FINE
            try:
                got = len(file.read(size, dtype="float32"))
            except soundfile.SoundFileError:
                return count, True
            count += got
            if got < size:
                return count, False


def _reason(error: BaseException) -> str:
    text = getattr(error, "error_string", "") or str(error)
    return str(text).strip().rstrip(".").replace(os.linesep, " ") or type(error).__name__


def _unreadable(path: Path, reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.AUDIO_UNREADABLE, Place(path), reason=reason)
