"""What a report says, as pure numbers: one row a leak with its place, its interval and its neighbours.

CSV, GIS and PDF are three ways of writing the same rows.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from processing.coordinates import LOCAL, LocalFrame, frame_of, is_local
from processing.position import distance
from processing.reporting.options import ReportOptions
from processing.reporting.references import is_heading_known
from processing.results import Results
from processing.review_facts import ReviewRecord
from processing.sound.sizes import LeakSize, size_of
from processing.stated import as_stated
from processing.survey import Candidate, Channel, Decision, LeakClass, Stretch, TiePoint, Verdict

STATUS = {
    Verdict.NONE: "candidate",
    Verdict.UNSURE: "candidate",
    Verdict.CONFIRMED: "confirmed",
    Verdict.REJECTED: "rejected",
}


@dataclass(frozen=True)
class Neighbour:
    """The nearest known place in one direction along the pipe: ``distance_m`` is along the pipe, never negative."""

    name: str
    chainage_m: float
    distance_m: float


@dataclass(frozen=True)
class LeakRow:
    """One candidate with what the operator said of it and where it lies; None where unknown."""

    candidate: Candidate
    decision: Decision
    latitude: float | None
    longitude: float | None
    before: Neighbour | None
    after: Neighbour | None
    size: LeakSize | None = None  # None for what is no leak

    @property
    def status(self) -> str:
        """``candidate``, ``confirmed`` or ``rejected``, as formats.md has it."""
        return STATUS[self.decision.verdict]

    @property
    def leak_class(self) -> LeakClass:
        """The operator's class, else the machine's."""
        return self.decision.leak_class or self.candidate.leak_class

    @property
    def interval_m(self) -> float:
        """Half of the 95 % interval."""
        return (self.candidate.chainage_high95_m - self.candidate.chainage_low95_m) / 2


@dataclass(frozen=True)
class UnassessedStretch:
    """A stretch of the pipe of which nothing can be said, in metres where the path is known."""

    stretch: Stretch
    start_m: float | None
    end_m: float | None


@dataclass(frozen=True)
class ReportContent:
    """All numbers of a report, what people added to them, and how the operator wants them written."""

    results: Results
    rows: tuple[LeakRow, ...]
    known_places: tuple[Neighbour, ...]
    unassessed: tuple[UnassessedStretch, ...]
    frame: LocalFrame
    record: ReviewRecord = field(default_factory=ReviewRecord)
    options: ReportOptions = field(default_factory=ReportOptions)

    @property
    def undecided(self) -> int:
        """How many candidates nobody has judged."""
        return sum(row.decision.verdict in (Verdict.NONE, Verdict.UNSURE) for row in self.rows)

    def grid_place(self, position_w_m: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return east, north, up in the survey's own coordinate system, in which its tie points are given too."""
        east, north, up = self.frame.to_grid(np.array([position_w_m]), self.frame.grid)[0]
        return float(east), float(north), float(up)

    @property
    def unassessed_m(self) -> float:
        """Metres of pipe that could not be assessed, overlaps counted once."""
        spans = sorted((u.start_m, u.end_m) for u in self.unassessed if u.start_m is not None and u.end_m is not None)
        total, reached = 0.0, -np.inf
        for start, end in spans:
            total += max(0.0, end - max(start, reached))
            reached = max(reached, end)
        return total


def make_content(
    results: Results,
    decisions: Mapping[int, Decision],
    record: ReviewRecord | None = None,
    options: ReportOptions | None = None,
) -> ReportContent:
    """Return what a report of ``results`` says; ``decisions`` maps candidate ids to verdicts.

    Intervals along the pipe are widened where the operator has chosen so after digs (:mod:`processing.stated`).
    """
    results = as_stated(results)
    frame = told_frame(results)
    places = known_places(results)
    rows = tuple(
        _sized(leak_row(candidate, decisions.get(candidate.id, Decision()), frame, places), results)
        for candidate in sorted(results.candidates, key=best_first)
    )
    unassessed = tuple(unassessed_stretch(results, stretch) for stretch in results.not_assessed)
    return ReportContent(results, rows, places, unassessed, frame, record or ReviewRecord(), options or ReportOptions())


def told_frame(results: Results) -> LocalFrame:
    """Return the frame in which places are told: the survey's, but a local one where the path's direction is arbitrary.

    A path that may be turned as a whole about its launch has no latitudes and no grid coordinates: whoever told them
    would send a crew to any place of a circle.
    """
    frame = frame_of(results.survey)
    if is_heading_known(results):
        return frame
    origin = frame.grid_origin if is_local(frame.grid) else (0.0, 0.0)
    return replace(frame, latitude=None, longitude=None, grid=LOCAL, grid_origin=origin)


def best_first(candidate: Candidate) -> tuple[bool, float, float]:
    """Return what sorts by falling score; what the operator marked has no score and comes last, along the pipe."""
    marked = bool(np.isnan(candidate.score))
    return marked, 0.0 if marked else -candidate.score, candidate.time_s


def leak_row(candidate: Candidate, decision: Decision, frame: LocalFrame, places: tuple[Neighbour, ...]) -> LeakRow:
    """Return one candidate's row."""
    latitude = longitude = None
    if frame.is_geographic and np.all(np.isfinite(candidate.position_w_m)):
        degrees = frame.to_geographic(np.array([candidate.position_w_m]))[0]
        latitude, longitude = float(degrees[0]), float(degrees[1])
    at = candidate.chainage_m
    before = [Neighbour(p.name, p.chainage_m, at - p.chainage_m) for p in places if p.chainage_m <= at]
    after = [Neighbour(p.name, p.chainage_m, p.chainage_m - at) for p in places if p.chainage_m > at]
    return LeakRow(
        candidate,
        decision,
        latitude,
        longitude,
        min(before, key=lambda n: n.distance_m, default=None),
        min(after, key=lambda n: n.distance_m, default=None),
    )


def _sized(row: LeakRow, results: Results) -> LeakRow:
    """Return the row with the size of the leak, where it may be one."""
    if row.leak_class not in (LeakClass.LEAK, LeakClass.UNKNOWN):
        return row
    size = size_of(row.candidate, results.survey, results.settings.size, results.candidates)
    return replace(row, size=size)


def known_places(results: Results) -> tuple[Neighbour, ...]:
    """Return launch and tie points with the chainage that the fitted path gives them."""
    places = [Neighbour("launch", 0.0, 0.0)]
    track = results.track
    for tie in results.survey.tie_points:
        chainage = tie_chainage(tie, results)
        if tie.enabled and chainage is not None:
            places.append(Neighbour(tie.name, chainage, 0.0))
    return tuple(places) if track is not None else ()


def tie_chainage(tie: TiePoint, results: Results) -> float | None:
    """Return the chainage of a tie point: as surveyed, else where the path was at its time."""
    if tie.chainage_m is not None:
        return tie.chainage_m
    track = results.track
    if track is None or not track.time_s[0] <= tie.time_s <= track.time_s[-1]:
        return None
    return float(distance.chainage_at(track, tie.time_s)[0])


def unassessed_stretch(results: Results, stretch: Stretch) -> UnassessedStretch:
    """Return a stretch in metres where there is a path."""
    if results.track is None:
        return UnassessedStretch(stretch, None, None)
    ends = distance.chainage_at(results.track, [stretch.start_s, stretch.end_s])
    return UnassessedStretch(stretch, float(ends[0]), float(ends[1]))


def verdict_counts(content: ReportContent) -> dict[str, int]:
    """Return how many rows have each status."""
    counts = dict.fromkeys(("confirmed", "rejected", "candidate"), 0)
    for row in content.rows:
        counts[row.status] += 1
    return counts


def sound_unassessed(content: ReportContent) -> tuple[UnassessedStretch, ...]:
    """Return the stretches in which the sound could not be assessed."""
    return tuple(u for u in content.unassessed if u.stretch.channel is Channel.SOUND)
