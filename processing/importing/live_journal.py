"""What the journal of a live recording says of its gaps: as findings, and as stretches that cannot be assessed.

The journal is a file like any other: its values are checked, what is unknown or makes no sense is passed over.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import JournalLine
from processing.storage.journal import JOURNAL_NAME, JournalEvent, read_journal
from processing.survey import AudioGap, AudioSource, Channel, Finding, Severity, Stretch

MOST_BYTES = 64 << 20  # twelve hours with a gap every second have ten
RESTARTED = "live_restart"
_LOST = "live_lost"
_SOUND_LOST = "live_sound_lost"
_LONGEST_S = 1e6
_MOST = 1 << 48  # frames or samples
_JOIN_S = 1.0  # gaps of the sound closer than this are one
_MOST_GAPS = 1000  # that are kept apart: a bad cable for hours is one trouble


@dataclass(frozen=True)
class Journal:
    """The journal's file and what it says; gaps of the sound in frames, of the motion in survey time."""

    path: Path
    sound_gaps: tuple[tuple[int, int, str], ...] = ()  # first frame, frames, reason
    motion_gaps: tuple[Stretch, ...] = ()
    lost: int = 0  # samples of the motion
    restarts: int = 0
    fault: str = ""  # code of the error that ended it

    def findings(self, sample_rate_hz: float | None) -> tuple[Finding, ...]:
        """Return what the operator has to know of it."""
        found = []
        if self.sound_gaps and sample_rate_hz:
            first, longest = self.sound_gaps[0], max(self.sound_gaps, key=lambda gap: gap[1])
            params: dict[str, str | float] = {
                "count": len(self.sound_gaps),
                "total_s": sum(frames for _, frames, _ in self.sound_gaps) / sample_rate_hz,
                "first_s": first[0] / sample_rate_hz,
                "longest_s": longest[1] / sample_rate_hz,
                "longest_at_s": longest[0] / sample_rate_hz,
            }
            found.append(Finding("live_sound_lost", Severity.MASKED, params))
        if self.lost:
            found.append(Finding("live_motion_lost", Severity.MASKED, {"count": self.lost}))
        if self.restarts:
            again = [gap for gap in self.motion_gaps if gap.reason == RESTARTED]
            longest_s = max((gap.end_s - gap.start_s for gap in again), default=0.0)
            first_s = again[0].start_s if again else 0.0
            params = {"count": self.restarts, "first_s": first_s, "longest_s": longest_s}
            found.append(Finding("live_motion_restarts", Severity.WARNING, params))
        if self.fault:
            is_full = self.fault == ErrorCode.DISC_FULL.value
            found.append(Finding("live_ended_disc_full" if is_full else "live_ended_by_fault", Severity.WARNING))
        return tuple(found)


def journal_in(folder: Path) -> tuple[Journal | None, tuple[Finding, ...]]:
    """Return what the journal in a folder says; None, and why, where it cannot be read."""
    path = folder / JOURNAL_NAME
    if not path.is_file():
        return None, ()
    unreadable = (Finding("live_journal_unreadable", Severity.WARNING, {"file": path.name}),)
    try:
        if path.stat().st_size > MOST_BYTES:
            return None, unreadable
        lines = read_journal(path)
    except (OSError, LeaklineError):  # sound and motion may be as good as ever
        return None, unreadable
    gaps = tuple(gap for line in lines if (gap := _sound_gap(line)) is not None)
    holes = tuple(hole for line in _of(lines, JournalEvent.MOTION_GAP) if (hole := _hole(line)) is not None)
    lost = sum(_whole(line.values.get("lost")) for line in _of(lines, JournalEvent.MOTION_GAP))
    restarts = sum(1 for _ in _of(lines, JournalEvent.MOTION_RESTART))
    faults = [str(line.values.get("code", ""))[:100] for line in _of(lines, JournalEvent.FAULT)]
    again = max(restarts, sum(hole.reason == RESTARTED for hole in holes))
    return Journal(path, gaps, holes, lost, again, faults[-1] if faults else ""), ()


def with_gaps(audio: AudioSource, journal: Journal) -> AudioSource:
    """Return the sound with the spans in which nothing was heard, though the file has zeros there.

    Gaps that are close together are one; the more there are, the further apart that is.
    """
    rate_hz, end_s = audio.sample_rate_hz, audio.duration_s
    gaps = [
        AudioGap(first / rate_hz, min((first + frames) / rate_hz, end_s), reason)
        for first, frames, reason in sorted(journal.sound_gaps)
        if first / rate_hz < end_s
    ]
    join_s = _JOIN_S
    gaps = _joined(gaps, join_s)
    while len(gaps) > _MOST_GAPS:
        join_s *= 2.0
        gaps = _joined(gaps, join_s)
    return replace(audio, gaps=tuple(gaps))


def _joined(gaps: list[AudioGap], join_s: float) -> list[AudioGap]:
    out: list[AudioGap] = []
    for gap in gaps:
        if out and gap.start_s - out[-1].end_s <= join_s:
            out[-1] = replace(out[-1], end_s=max(out[-1].end_s, gap.end_s))
        else:
            out.append(gap)
    return out


def with_restarts(stretches: tuple[Stretch, ...], journal: Journal, end_s: float) -> tuple[Stretch, ...]:
    """Return the spans without motion, those in which the device began anew with that reason."""
    again = [gap for gap in journal.motion_gaps if gap.reason == RESTARTED and gap.end_s <= end_s + 1.0]
    again = again[:_MOST_GAPS]
    kept = [s for s in stretches if not any(_is_within(s, gap) for gap in again)]
    return tuple(sorted([*kept, *again], key=lambda s: (s.start_s, s.end_s)))


def _is_within(stretch: Stretch, gap: Stretch, slack_s: float = 0.01) -> bool:
    return (
        stretch.channel is gap.channel
        and stretch.reason == "imu_gap"
        and gap.start_s - slack_s <= stretch.start_s
        and stretch.end_s <= gap.end_s + slack_s
    )


def _of(lines: tuple[JournalLine, ...], event: JournalEvent) -> Iterator[JournalLine]:
    return (line for line in lines if line.event == event)


def _sound_gap(line: JournalLine) -> tuple[int, int, str] | None:
    if line.event != JournalEvent.SOUND_GAP:
        return None
    first, frames = line.values.get("frame"), _whole(line.values.get("frames"))
    if isinstance(first, bool) or not isinstance(first, int) or not 0 <= first < _MOST or not frames:
        return None
    return first, frames, _reason(line.values.get("reason"), _SOUND_LOST)


def _hole(line: JournalLine) -> Stretch | None:
    start_s, end_s = _seconds(line.values.get("start_s")), _seconds(line.values.get("end_s"))
    if start_s is None or end_s is None or not max(start_s, 0.0) < end_s:  # before the recording nothing was missed
        return None
    return Stretch(max(start_s, 0.0), end_s, Channel.PATH, _reason(line.values.get("reason"), _LOST))


def _whole(value: Any) -> int:  # noqa: ANN401  # any JSON value
    """Return a count, 0 for what is none."""
    is_count = isinstance(value, int) and not isinstance(value, bool) and 0 <= value < _MOST
    return int(value) if is_count else 0


def _seconds(value: Any) -> float | None:  # noqa: ANN401  # any JSON value
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    # compared before it is made a float, which the largest whole numbers cannot be; nothing is true of a NaN
    return float(value) if abs(value) <= _LONGEST_S else None


def _reason(value: Any, otherwise: str) -> str:  # noqa: ANN401  # any JSON value
    """Return a reason that has a sentence."""
    return value if isinstance(value, str) and value in messages.table("reasons") else otherwise
