"""What follows from the form of a dig: the result that will be stored, where it was found, or what is still missing."""

from dataclasses import dataclass, replace
from enum import StrEnum

from processing.coordinates import LocalFrame
from processing.dig_place import FAR_M, Projected, local_place, on_path
from processing.errors import ErrorCode, LeaklineError
from processing.review_facts import DigFinding, DigResult
from processing.survey import Track
from widgets.dig_form import CHAINAGE, COORDINATES, TAPE, DigAnswer


class Missing(StrEnum):
    """What an answer lacks before it can be stored."""

    NOTHING = ""
    FINDING = "finding"
    DIRECTION = "direction"
    PLACE = "place"  # where the leak is that nobody had stated
    STATED = "stated"  # no place was stated to measure from: there is no path
    PATH = "path"  # coordinates need one


@dataclass(frozen=True)
class Figured:
    """The result, and the chainage at which it was found (None: not known)."""

    result: DigResult | None
    found_m: float | None = None
    missing: Missing = Missing.NOTHING
    error: LeaklineError | None = None


def figured(answer: DigAnswer, stated: DigResult, track: Track | None, frame: LocalFrame) -> Figured:
    """Return what an answer amounts to; ``stated`` is an empty result with number and statement."""
    if answer.finding is None:
        return Figured(None, missing=Missing.FINDING)
    if answer.finding is DigFinding.NOTHING:
        return Figured(_result(answer, stated, None, None))
    if answer.measured == TAPE:
        return _by_tape(answer, stated)
    across = answer.across_m
    found: float | None = None
    if answer.measured == CHAINAGE:
        found = answer.chainage_m
    elif answer.measured == COORDINATES and answer.coordinates:
        if track is None:
            return Figured(None, missing=Missing.PATH)
        try:
            projected = _projected(answer.coordinates, track, frame, stated.stated_chainage_m)
        except LeaklineError as error:
            return Figured(None, error=error)
        found = projected.chainage_m
        across = projected.across_m if across is None else across
    if found is None:
        if _nowhere(stated):
            return Figured(None, missing=Missing.PLACE)
        return Figured(_result(answer, stated, None, across))
    if stated.missed:
        return Figured(_result(answer, stated, None, across), found)
    if stated.stated_chainage_m is None:
        return Figured(None, missing=Missing.STATED)
    return Figured(_result(answer, stated, found - stated.stated_chainage_m, across), found)


def _projected(text: str, track: Track, frame: LocalFrame, near_m: float | None) -> Projected:
    """Return where on the path typed coordinates are; raises LeaklineError PLACE_UNREADABLE, PLACE_FAR."""
    projected = on_path(track, *local_place(text, frame), near_m=near_m)
    if abs(projected.across_m) > FAR_M:
        raise LeaklineError(ErrorCode.PLACE_FAR, away_m=abs(projected.across_m))
    return projected


def _by_tape(answer: DigAnswer, stated: DigResult) -> Figured:
    if _nowhere(stated):
        return Figured(None, missing=Missing.PLACE)
    distance = answer.distance_m
    if distance is None:
        return Figured(_result(answer, stated, None, answer.across_m))
    if distance > 0.0 and answer.direction == 0:
        return Figured(None, missing=Missing.DIRECTION)
    off = answer.direction * distance
    found = None if stated.stated_chainage_m is None else stated.stated_chainage_m + off
    return Figured(_result(answer, stated, off, answer.across_m), found)


def _nowhere(stated: DigResult) -> bool:
    """Tell whether this is a leak that has neither been stated nor marked yet."""
    return stated.missed and stated.number == 0


def _result(answer: DigAnswer, stated: DigResult, off_m: float | None, across_m: float | None) -> DigResult:
    assert answer.finding is not None  # asked before
    nothing = answer.finding is DigFinding.NOTHING
    return replace(
        stated,
        finding=answer.finding,
        date=answer.date,
        off_along_m=off_m,
        off_across_m=across_m,
        depth_m=answer.depth_m,
        flow_lpm=None if nothing else answer.flow_lpm,
        cause="" if nothing else answer.cause,
        note=answer.note,
        dug_by=answer.dug_by,
        measured=answer.measured,
        sigma_m=None if off_m is None else answer.sigma_m,
    )
