"""Picks the sound files that belong to a recording, in their order, and compares their length with the IMU log's."""

import re
from collections.abc import Sequence
from pathlib import Path

from processing.errors import ErrorCode, LeaklineError, Place
from processing.settings import ImportSettings
from processing.sound.pcm import RawForm
from processing.sound.source import AUDIO_SUFFIXES
from processing.survey import AudioInfo, AudioSource, Finding, ImuSamples, Severity

_NUMBER = re.compile(r"(\d+)")


def natural_key(path: Path) -> tuple[tuple[int, int, str], ...]:
    """Return a key under which ``part-2`` stands before ``part-10``."""
    parts = _NUMBER.split(path.name.casefold())
    return tuple((0, int(p), "") if p.isdecimal() and len(p) < 19 else (1, 0, p) for p in parts)


def is_audio(path: Path) -> bool:
    """True for a file whose name says that it is sound."""
    return path.suffix.casefold() in AUDIO_SUFFIXES


def pick_audio(folder: Path, files: Sequence[Path], info: AudioInfo) -> tuple[tuple[Path, ...], tuple[Finding, ...]]:
    """Return the sound files of the run, in order, and a finding for those that were left aside.

    ``[audio].file`` names one file, or several by a pattern (``part-*.wav``). Without it the first sound file counts
    (``audio.*`` before others), and with it those that differ from it only in a number that goes on: parts.

    Raises:
        LeaklineError: FILE_MISSING where the named file is not there.
    """
    if info.file:
        named = _named(folder, info.file)
        if not named:
            raise LeaklineError(ErrorCode.FILE_MISSING, Place(folder / info.file))
        return named, ()
    sounds = sorted((f for f in files if is_audio(f)), key=natural_key)
    if not sounds:
        return (), ()
    first = next((f for f in sounds if f.stem.casefold() == "audio"), sounds[0])
    parts = parts_from(first, sounds)
    others = [f.name for f in sounds if f not in parts]
    if not others:
        return parts, ()
    params: dict[str, str | float] = {"chosen": parts[0].name, "others": ", ".join(others)[:300]}
    return parts, (Finding("sound_files_left", Severity.WARNING, params),)


def _named(folder: Path, name: str) -> tuple[Path, ...]:
    relative = Path(name)
    if relative.is_absolute() or ".." in relative.parts:
        return (relative,) if relative.is_file() else ()
    exact = folder / relative
    if exact.is_file():
        return (exact,)
    if not any(c in name for c in "*?["):
        return ()
    return tuple(sorted((f for f in folder.glob(name) if f.is_file()), key=natural_key))


def parts_from(first: Path, others: Sequence[Path]) -> tuple[Path, ...]:
    """Return the files that continue ``first``: the same name but for its last number, one more each time."""
    pieces = _NUMBER.split(first.stem)
    if len(pieces) < 3:
        return (first,)
    parts = [first]
    by_name = {f.name.casefold(): f for f in others if f.parent == first.parent}
    number, width = int(pieces[-2][:18]), len(pieces[-2])
    while True:
        number += 1
        names = {f"{''.join(pieces[:-2])}{number:0{w}d}{pieces[-1]}{first.suffix}".casefold() for w in (width, 1)}
        following = next((by_name[n] for n in names if n in by_name), None)
        if following is None:
            return tuple(parts)
        parts.append(following)


def raw_form_of(info: AudioInfo) -> RawForm | None:
    """Return the form of headerless sound that survey.toml states, None where it states none."""
    if info.raw_sample_rate_hz is None:
        return None
    return RawForm(
        sample_rate_hz=info.raw_sample_rate_hz,
        bits=info.raw_bits or 16,
        channels=info.raw_channels or 1,
        encoding=info.raw_encoding or "signed",
        endian=info.raw_endian or "little",
    )


def compare_lengths(imu: ImuSamples, audio: AudioSource, settings: ImportSettings) -> tuple[Finding, ...]:
    """Return a warning where sound and IMU log can hardly be of one run, one being much longer."""
    apart = audio.duration_s - imu.duration_s
    allowed = max(settings.sound_mismatch_s, settings.sound_mismatch_pct / 100.0 * imu.duration_s)
    if abs(apart) <= allowed:
        return ()
    params: dict[str, str | float] = {"sound_s": audio.duration_s, "imu_s": imu.duration_s}
    return (Finding("sound_longer" if apart > 0 else "sound_shorter", Severity.WARNING, params),)
