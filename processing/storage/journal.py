"""The journal of a recording (``recording.jsonl``): what happened when, one JSON object a line, only ever appended to.

A line is ``{"event": …, "utc": …, "host_s": …, "values": {…}}``. A program that died, or a disc that lost its power,
leaves a torn line at the end: it costs itself and nothing else.
"""

import json
import math
import os
import time
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from enum import StrEnum
from pathlib import Path
from typing import IO, Any

from processing.live.stream import JournalLine
from processing.storage.files import reading
from processing.storage.plain import to_plain

JOURNAL_NAME = "recording.jsonl"
_LONGEST_LINE = 1 << 20  # bytes; ours have a few hundred, a pre-launch sheet some thousand
_MOST_LINES = 1_000_000
_TAIL_BYTES = 1 << 16


class JournalEvent(StrEnum):
    """What can happen, with the values of its line. ``frame`` counts the sound's frames, ``time_us`` is as stored."""

    STARTED = "started"  # version, operator, part_s, sound: {rate_hz, channels, subtype} or None, motion: bool
    PART = "part"  # stream: sound | motion, file, first_frame or first_time_us
    CLOCK = "clock"  # start_time_s, drift_ppm, start_sigma_s, drift_sigma_ppm: the sound's clock as known by now
    MARK = "mark"  # the fields of a TiePoint
    AMENDED = "amended"  # name, time_s of a mark; now: the fields it has now, None where it was taken back
    SOUND_STATE = "sound_state"  # state: LinkState, device
    SOUND_GAP = "sound_gap"  # frame, frames, reason: as many zeros stand in the file from that frame on
    MOTION_STATE = "motion_state"  # state: LinkState, device
    MOTION_GAP = "motion_gap"  # start_s, end_s (survey time), lost, reason: no samples between the two
    MOTION_RESTART = "motion_restart"  # time_us: the device's clock began anew and was put on here
    DISC_LOW = "disc_low"  # seconds_left, free_bytes
    FAULT = "fault"  # code of the error, reason: why the recording ended by itself
    CHECK = "check"  # what the check before the launch found
    NOTE = "note"  # anything else
    STOPPED = "stopped"  # sound_frames, motion_samples: nothing follows; without it the recording ended badly


def journal_line(event: str, values: Mapping[str, Any], host_s: float | None = None) -> JournalLine:
    """Return a line that happens now; ``values`` become plain JSON values, numbers that are none become None."""
    now = datetime.now(UTC).isoformat(timespec="milliseconds")
    at = time.monotonic() if host_s is None else host_s
    return JournalLine(str(event), now, at, {key: _finite(value) for key, value in to_plain(values).items()})


def line_bytes(line: JournalLine) -> bytes:
    """Return a line as it stands in the file, its end included."""
    plain = {"event": line.event, "utc": line.utc, "host_s": round(line.host_s, 6), "values": line.values}
    return json.dumps(plain, ensure_ascii=True, allow_nan=False, separators=(",", ":")).encode("ascii") + b"\n"


def read_journal(path: Path) -> tuple[JournalLine, ...]:
    """Return the lines that are whole, in order; torn or foreign ones are passed over.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE.
    """
    with reading(path), path.open("rb") as file:
        return tuple(line for raw in _lines(file) if (line := _parsed(raw)) is not None)


def is_ended(path: Path) -> bool:
    """Return whether the journal says that the recording was stopped as it should be; looks at its end only.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE.
    """
    with reading(path), path.open("rb") as file:
        file.seek(max(0, os.fstat(file.fileno()).st_size - _TAIL_BYTES))
        lines = [line for raw in _lines(file) if (line := _parsed(raw)) is not None]
    return bool(lines) and lines[-1].event == JournalEvent.STOPPED


def _lines(file: IO[bytes]) -> Iterator[bytes]:
    for _ in range(_MOST_LINES):
        raw = file.readline(_LONGEST_LINE)
        if not raw:
            return
        yield raw


def _parsed(raw: bytes) -> JournalLine | None:
    if not raw.endswith(b"\n"):
        return None
    try:
        plain = json.loads(raw)
        event, utc, host_s, values = plain["event"], plain["utc"], float(plain["host_s"]), plain["values"]
    except (ValueError, KeyError, TypeError, RecursionError, OverflowError):
        return None
    is_right = isinstance(event, str) and isinstance(utc, str) and isinstance(values, dict) and math.isfinite(host_s)
    return JournalLine(event, utc, host_s, values) if is_right else None


def _finite(value: Any) -> Any:  # noqa: ANN401  # any JSON value
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(inner) for key, inner in value.items()}
    return [_finite(inner) for inner in value] if isinstance(value, list) else value
