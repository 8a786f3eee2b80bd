"""What is known of each metre of the pipe: a leak, perhaps one, none found, or not assessed; the stretches tile it.

Utilities map their pipes so. A stretch's borders are as exact as the path there; the file says how exact.
"""

from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np

from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.review_facts import DigFinding, DigResult
from processing.survey import LeakClass, Verdict

LEAST_HALF_M = 0.1  # a leak never vanishes between its neighbours


class StretchStatus(StrEnum):
    """What a stretch of the pipe is said to be."""

    LEAK = "leak"  # the 95 % interval of a confirmed leak
    SUSPECTED = "suspected"  # that of a place which nobody has decided yet
    CLEAR = "no_leak_found"
    NOT_ASSESSED = "not_assessed"


# what is said where several hold: a leak that was heard is told even where the sound was poor
_FIRST = (StretchStatus.LEAK, StretchStatus.SUSPECTED, StretchStatus.NOT_ASSESSED, StretchStatus.CLEAR)
_DUG = {
    DigFinding.LEAK: StretchStatus.LEAK,
    DigFinding.OTHER: StretchStatus.CLEAR,
    DigFinding.NOTHING: StretchStatus.SUSPECTED,  # the pipe is sound where it was laid open; what was heard is not told
}


@dataclass(frozen=True)
class PipeStretch:
    """A stretch of one status: ``leaks`` are the numbers of the places in it, ``reasons`` keys of [reasons].

    ``half95_m`` is how well its less certain border is known along the pipe.
    """

    start_m: float
    end_m: float
    status: StretchStatus
    leaks: tuple[int, ...] = ()
    reasons: tuple[str, ...] = ()
    half95_m: float = float("nan")


@dataclass(frozen=True)
class _Span:
    start_m: float
    end_m: float
    status: StretchStatus
    leak: int | None = None
    reason: str | None = None


def pipe_stretches(content: ReportContent) -> tuple[PipeStretch, ...]:
    """Return the whole path as stretches without gap or overlap, in the order of the pipe; none without a path."""
    track = content.results.track
    if track is None:
        return ()
    first, last = float(track.chainage_m[0]), float(track.chainage_m[-1])
    if not last > first:
        return ()
    spans = [*_leak_spans(content), *_unassessed_spans(content)]
    found = tile(first, last, [(span.start_m, span.end_m) for span in spans])
    merged: list[PipeStretch] = []
    for start, end, inside in found:
        stretch = _stretch(start, end, [spans[i] for i in inside])
        before = merged[-1] if merged else None
        if before is not None and _same(before, stretch):
            merged[-1] = _stretch_like(before, end)
        else:
            merged.append(stretch)
    borders = np.array([[s.start_m, s.end_m] for s in merged])
    sigma = distance.places_at(track, distance.times_at(track, borders.ravel())[0]).sigma_along_m.reshape(-1, 2)
    half = distance.NORMAL_95 * sigma.max(axis=1)
    return tuple(
        PipeStretch(s.start_m, s.end_m, s.status, s.leaks, s.reasons, float(h))
        for s, h in zip(merged, half, strict=True)
    )


def tile(first: float, last: float, spans: list[tuple[float, float]]) -> list[tuple[float, float, tuple[int, ...]]]:
    """Cut ``first``..``last`` at every end of a span; return each piece with the indices of the spans that cover it."""
    clipped = [(max(start, first), min(end, last)) for start, end in spans]
    begins: dict[float, list[int]] = {}
    ends: dict[float, list[int]] = {}
    for i, (start, end) in enumerate(clipped):
        if end > start:
            begins.setdefault(start, []).append(i)
            ends.setdefault(end, []).append(i)
    cuts = sorted({first, last, *begins, *ends})
    covering: set[int] = set()
    pieces = []
    for start, end in pairwise(cuts):
        covering.difference_update(ends.get(start, ()))
        covering.update(begins.get(start, ()))
        pieces.append((start, end, tuple(sorted(covering))))
    return pieces


def status_of(row: LeakRow, dig: DigResult | None) -> StretchStatus:
    """Return what a candidate makes of its interval: the dig knows best, then the operator."""
    if dig is not None:
        return _DUG[dig.finding]
    verdict = row.decision.verdict
    if verdict is Verdict.REJECTED:
        return StretchStatus.CLEAR
    if verdict is Verdict.CONFIRMED:
        is_leak = row.leak_class in (LeakClass.LEAK, LeakClass.UNKNOWN)
        return StretchStatus.LEAK if is_leak else StretchStatus.CLEAR
    return StretchStatus.SUSPECTED


def metres_by_status(stretches: tuple[PipeStretch, ...]) -> dict[StretchStatus, float]:
    """Return how many metres have each status."""
    return {
        status: sum((s.end_m - s.start_m for s in stretches if s.status is status), start=0.0)
        for status in StretchStatus
    }


def _leak_spans(content: ReportContent) -> list[_Span]:
    spans = []
    for row in content.rows:
        c = row.candidate
        status = status_of(row, content.record.digs.get(c.label))
        if status is StretchStatus.CLEAR or not np.isfinite(c.chainage_m):
            continue
        low, high = c.chainage_low95_m, c.chainage_high95_m
        low = min(low, c.chainage_m - LEAST_HALF_M) if np.isfinite(low) else c.chainage_m - LEAST_HALF_M
        high = max(high, c.chainage_m + LEAST_HALF_M) if np.isfinite(high) else c.chainage_m + LEAST_HALF_M
        spans.append(_Span(low, high, status, leak=c.label))
    return spans


def _unassessed_spans(content: ReportContent) -> list[_Span]:
    return [
        _Span(part.start_m, part.end_m, StretchStatus.NOT_ASSESSED, reason=part.stretch.reason)
        for part in content.unassessed
        if part.start_m is not None and part.end_m is not None
    ]


def _stretch(start: float, end: float, spans: list[_Span]) -> PipeStretch:
    told = {span.status for span in spans} | {StretchStatus.CLEAR}
    status = next(status for status in _FIRST if status in told)
    leaks = tuple(sorted({span.leak for span in spans if span.leak is not None}))
    reasons = tuple(sorted({span.reason for span in spans if span.reason is not None}))
    return PipeStretch(start, end, status, leaks, reasons)


def _same(one: PipeStretch, other: PipeStretch) -> bool:
    return (one.status, one.leaks, one.reasons) == (other.status, other.leaks, other.reasons)


def _stretch_like(stretch: PipeStretch, end_m: float) -> PipeStretch:
    return PipeStretch(stretch.start_m, end_m, stretch.status, stretch.leaks, stretch.reasons)
