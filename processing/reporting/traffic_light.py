"""Whether a crew may dig at a leak: green, yellow or red by a written rule, and the reasons that set it.

Green: dig here. Yellow: pinpoint on the surface first. Red: do not dig. The rule is written on each dig sheet in words;
its limits are constants here, so that sheet and rule cannot drift apart.
"""

import math
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np

from processing.position.tie_checks import TieCheck
from processing.reporting.references import LAUNCH, Tape
from processing.results import Results
from processing.review_facts import ReviewRecord
from processing.survey import Candidate, Channel, Decision, LeakClass, Params, Verdict

BELL_HOLE_M = (0.9, 4.6)  # what one bell-hole lays open of the pipe (findings §6)
TAPE_REACH_M = 100.0  # two lengths of a 50 m tape: further away a place is set out with coordinates, not with a tape
REFERENCE_95_M = BELL_HOLE_M[1] / 2  # taped from a reference that is known worse, a bell-hole can miss the leak
_NORMAL_99 = 2.576  # each sheet asks two tie points: at 95 % one sheet in ten would be held up by chance


class Light(StrEnum):
    """What the crew may do."""

    GREEN = "green"
    YELLOW = "yellow"
    RED = "red"


_SEVERITY = (Light.GREEN, Light.YELLOW, Light.RED)


@dataclass(frozen=True)
class Cause:
    """One reason for a light: ``code`` is a key ``light_<code>`` of the [report] table, lengths are in metres."""

    light: Light
    code: str
    lengths_m: Params = field(default_factory=dict)
    texts: Params = field(default_factory=dict)


@dataclass(frozen=True)
class Assessment:
    """The light and all reasons for it, the weightiest first."""

    light: Light
    causes: tuple[Cause, ...]


def assess(
    candidate: Candidate, decision: Decision, results: Results, record: ReviewRecord, tapes: tuple[Tape, ...]
) -> Assessment:
    """Return whether a crew may dig at ``candidate``; the worst reason decides."""
    causes = [
        *_by_verdict(candidate, decision, results, record),
        *_by_interval(candidate, results, record),
        *_by_reference(tapes),
        *_by_quality(candidate, results),
        *_by_others(candidate, decision, record),
    ]
    worst = max((cause.light for cause in causes), key=_SEVERITY.index, default=Light.GREEN)
    causes.sort(key=lambda cause: -_SEVERITY.index(cause.light))
    # why it is green is no reason where it is not
    told = tuple(cause for cause in causes if cause.light is not Light.GREEN or worst is Light.GREEN)
    return Assessment(worst, told)


def _by_verdict(candidate: Candidate, decision: Decision, results: Results, record: ReviewRecord) -> list[Cause]:
    causes = []
    if results.survey.info.simulated:
        causes.append(Cause(Light.RED, "simulated"))
    dug = record.digs.get(candidate.label)
    if dug is not None:
        causes.append(Cause(Light.RED, f"dug_{dug.finding.value}", texts={"date": dug.date}))
    if decision.verdict is Verdict.REJECTED:
        causes.append(Cause(Light.RED, "rejected"))
    elif decision.verdict is Verdict.NONE:
        causes.append(Cause(Light.RED, "undecided"))
    elif decision.verdict is Verdict.UNSURE:
        causes.append(Cause(Light.YELLOW, "unsure"))
    else:
        causes.append(Cause(Light.GREEN, "confirmed"))
    kind = decision.leak_class or candidate.leak_class
    if kind not in (LeakClass.LEAK, LeakClass.UNKNOWN):
        causes.append(Cause(Light.YELLOW, "class", texts={"class": kind.value}))
    return causes


def _by_interval(candidate: Candidate, results: Results, record: ReviewRecord) -> list[Cause]:
    low, high = candidate.chainage_low95_m, candidate.chainage_high95_m
    width = high - low
    if not math.isfinite(width):
        return [Cause(Light.RED, "no_place")]
    # what digs ask for and the stated interval does not have yet
    asked = record.history.widen if record.history is not None else 1.0
    widen = max(1.0, asked / max(1.0, results.survey.stated.widen))
    width *= widen
    if width <= BELL_HOLE_M[1]:
        code = "window_fits" if widen == 1.0 else "window_fits_widened"
        return [Cause(Light.GREEN, code, {"width": width, "hole": BELL_HOLE_M[1]})]
    code = "window_long" if widen == 1.0 else "window_long_widened"
    return [Cause(Light.YELLOW, code, {"width": width, "hole": BELL_HOLE_M[1]})]


def _by_reference(tapes: tuple[Tape, ...]) -> list[Cause]:
    if not tapes:
        return [Cause(Light.YELLOW, "no_reference")]
    sure = [tape for tape in tapes if tape.reference_95_m <= REFERENCE_95_M]
    nearest = min(sure or tapes, key=lambda tape: tape.along_m)
    params: Params = {"distance": nearest.along_m, "limit": TAPE_REACH_M}
    name: Params = {"name": "" if nearest.name == LAUNCH else nearest.name}
    if nearest.along_m > TAPE_REACH_M:
        return [Cause(Light.YELLOW, "reference_far", params, name)]
    if not sure:
        off: Params = {"off": nearest.reference_95_m}
        return [Cause(Light.YELLOW, "reference_vague", off, name)]
    return [Cause(Light.GREEN, "reference_near", params, name)]


def _by_quality(candidate: Candidate, results: Results) -> list[Cause]:
    causes = []
    if results.recording.audio is not None and results.clock.basis == "assumed":
        causes.append(Cause(Light.YELLOW, "clock"))
    if results.track is not None and not results.survey.tie_points and results.survey.pipe.length_m is None:
        causes.append(Cause(Light.YELLOW, "free_path"))
    if any(check.held_down for check in results.tie_checks):
        causes.append(Cause(Light.YELLOW, "tie_contradicts"))
    elif any(abs(check.left_out_m) > _NORMAL_99 * check.left_out_sigma_m for check in _beside(candidate, results)):
        causes.append(Cause(Light.YELLOW, "tie_outside"))
    codes = {finding.code for finding in results.findings}
    causes += [Cause(Light.YELLOW, code) for code in ("fit_not_settled", "radius_unknown") if code in codes]
    at = candidate.time_s
    if any(s.start_s <= at <= s.end_s and s.channel is Channel.PATH for s in results.not_assessed):
        causes.append(Cause(Light.YELLOW, "path_not_assessed"))
    if not np.isfinite(candidate.score):
        causes.append(Cause(Light.YELLOW, "marked_by_hand"))
    return causes


def _beside(candidate: Candidate, results: Results) -> list[TieCheck]:
    """Return the checks of the tie points next to a candidate, one before it and one after it."""
    before = [check for check in results.tie_checks if check.time_s <= candidate.time_s]
    after = [check for check in results.tie_checks if check.time_s > candidate.time_s]
    nearest = [max(before, key=lambda check: check.time_s)] if before else []
    return nearest + ([min(after, key=lambda check: check.time_s)] if after else [])


def _by_others(candidate: Candidate, decision: Decision, record: ReviewRecord) -> list[Cause]:
    """Return what a second reviewer says against a verdict that allows to dig: the verdict, or what it is taken for."""
    if decision.verdict is not Verdict.CONFIRMED:
        return []
    return [
        Cause(Light.YELLOW, "second_disagrees", texts={"reviewer": opinion.reviewer})
        for opinion in record.opinions
        if opinion.number == candidate.label and _is_against_digging(opinion.decision)
    ]


def _is_against_digging(said: Decision) -> bool:
    if said.verdict is Verdict.CONFIRMED:
        return said.leak_class not in (None, LeakClass.LEAK, LeakClass.UNKNOWN)
    return said.verdict is not Verdict.NONE
