"""Writes Raven selection tables: each candidate as a box in the time of its sound file and in frequency.

One table a file, ``<file>.selections.txt``, tab-separated, in the file's own seconds: Raven opens it beside that file.
A table with ``Begin Path`` and ``File Offset`` can be opened in two ways that disagree, so these columns are left out.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.files import whole_file
from processing.reporting.handover.outcome import Written
from processing.survey import Finding, Severity

FOLDER = "raven"
HEADER = (
    "Selection", "View", "Channel", "Begin Time (s)", "End Time (s)", "Low Freq (Hz)", "High Freq (Hz)", "Begin File",
    "Leak", "Verdict", "Class", "Score", "Level (dB)", "Chainage (m)", "Interval 95 % (m)", "Note",
)  # fmt: skip
VIEW = "Spectrogram 1"
SHORTEST_S = 0.5  # a box that can still be seen


@dataclass(frozen=True)
class Selection:
    """A box: seconds on the audio clock, Hz."""

    row: LeakRow
    centre_s: float
    begin_s: float
    end_s: float
    low_hz: float
    high_hz: float


def write_raven(folder: Path, content: ReportContent) -> Written:
    """Write a table for each part of the sound; places that lie outside of all sound are told. Raises OSError."""
    audio = content.results.recording.audio
    if audio is None:
        return Written((), (Finding("handover_no_sound", Severity.INFO, {"file": f"{FOLDER}/"}),))
    folder.mkdir(parents=True, exist_ok=True)
    selections = [selection(row, content) for row in content.rows]
    selections.sort(key=lambda s: s.centre_s)
    files, names, start_s, written = [], set[str](), 0.0, 0
    for nth, part in enumerate(audio.parts, start=1):
        length_s = part.frames / audio.sample_rate_hz
        own = [s for s in selections if start_s <= s.centre_s < start_s + length_s]
        name = part.path.stem if part.path.stem not in names else f"{part.path.stem}-{nth}"
        names.add(name)
        path = folder / f"{name}.selections.txt"
        _write(path, own, start_s, length_s, part.path.name, audio.channel + 1)
        files.append(path)
        start_s += length_s
        written += len(own)
    findings: tuple[Finding, ...] = ()
    if written < len(selections):
        params: dict[str, str | float] = {"count": len(selections) - written, "file": f"{FOLDER}/"}
        findings = (Finding("handover_outside_sound", Severity.INFO, params),)
    return Written(tuple(files), findings)


def selection(row: LeakRow, content: ReportContent) -> Selection:
    """Return the box of a candidate: while the device was within its width, in the band that it was found in."""
    results, c = content.results, row.candidate
    audio = results.recording.audio
    assert audio is not None  # asked before
    begin, end = c.time_s, c.time_s
    if results.track is not None and np.isfinite(c.chainage_m) and np.isfinite(c.width_m):
        at = c.chainage_m + np.array([-0.5, 0.5]) * c.width_m
        reached, left = distance.times_at(results.track, at)
        begin, end = min(begin, float(left[0])), max(end, float(reached[1]))
    centre, first, last = (float(v) for v in results.clock.to_audio(np.array([c.time_s, begin, end])))
    nyquist = audio.sample_rate_hz / 2.0
    low, high = (v if np.isfinite(v) else None for v in c.band_hz)
    return Selection(
        row,
        centre,
        min(first, centre - SHORTEST_S / 2),
        max(last, centre + SHORTEST_S / 2),
        0.0 if low is None else min(max(low, 0.0), nyquist),
        nyquist if high is None or not high > (low or 0.0) else min(high, nyquist),
    )


def _write(
    path: Path, selections: Sequence[Selection], start_s: float, length_s: float, file_name: str, channel: int
) -> None:
    lines = ["\t".join(HEADER)]
    for number, one in enumerate(selections, start=1):
        c = one.row.candidate
        begin, end = max(one.begin_s - start_s, 0.0), min(one.end_s - start_s, length_s)
        cells = [
            str(number), VIEW, str(channel), f"{begin:.6f}", f"{end:.6f}", f"{one.low_hz:.1f}", f"{one.high_hz:.1f}",
            file_name, str(c.label), one.row.decision.verdict.value, one.row.leak_class.value, _number(c.score, 4),
            _number(c.level_db, 2), _number(c.chainage_m, 3), _number(one.row.interval_m, 3), one.row.decision.note,
        ]  # fmt: skip
        lines.append("\t".join(" ".join(cell.split()) for cell in cells))  # Raven knows no quotes
    with whole_file(path) as file:
        file.write("\n".join(lines) + "\n")


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if np.isfinite(value) else ""
