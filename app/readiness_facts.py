"""Gathers from the open survey what the lights beside the steps are decided by; it reads nothing but what is loaded."""

from collections.abc import Iterable
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from app.presets import settings_in_force
from processing.errors import LeaklineError
from processing.readiness import Facts
from processing.survey import Channel, Severity, Stretch, Survey, Verdict

if TYPE_CHECKING:
    from app.survey_session import SurveySession
    from processing.results import Results

NORMAL_95 = 1.959964
LENGTH = ""  # the name of the check of the pipe's length among the tie checks


def facts_of_preview(survey: Survey, *, readable: bool) -> Facts:
    """Return what is known of a device's folder that has not been processed, with what form and tie points say."""
    return replace(_told(survey), previewing=True, readable=readable)


def facts_of_session(session: "SurveySession", exported_s: float | None, changed_s: float | None, length: str) -> Facts:
    """Return what is known of the open survey.

    ``exported_s`` and ``changed_s`` are when it was exported and decided last (seconds since 1970), None for never;
    ``length`` names the pipe's length where it is contradicted as a tie point is.
    """
    if session.folder is None:
        return Facts()
    survey, results = session.survey, session.results
    facts = replace(_told(survey), is_open=True, writable=session.writable)
    if results is None:
        return facts
    decisions = [session.decision(row).verdict for row in session.ordered_ids()]
    present = (survey, settings_in_force(session))
    facts = replace(
        facts,
        processed=True,
        stale=(results.survey, results.settings) != present,
        candidates=len(decisions),
        undecided=decisions.count(Verdict.NONE),
        unsure=decisions.count(Verdict.UNSURE),
        confirmed=decisions.count(Verdict.CONFIRMED),
        warnings=sum(finding.severity is Severity.WARNING for finding in session.findings),
        exported=None if exported_s is None else _day(exported_s),
        changed_since=exported_s is not None and changed_s is not None and changed_s > exported_s,
    )
    return _of_path(_of_sound(facts, results), results, length)


def newest_export_s(exports_dir: Path) -> float | None:
    """Return when something was exported last, in seconds since 1970; None where nothing was."""
    try:
        found = [entry.stat().st_mtime for entry in exports_dir.iterdir() if not entry.name.startswith(".")]
    except OSError:  # no such folder, or its stick is gone
        return None
    return max(found, default=None)


def newest_export_day(exports_dir: Path) -> str | None:
    """Return the ISO day of the newest export; None where there is none."""
    when = newest_export_s(exports_dir)
    return None if when is None else _day(when)


def last_decision_s(session: "SurveySession") -> float | None:
    """Return when something was decided last, in seconds since 1970; None where nothing was."""
    if session.folder is None:
        return None
    try:
        log = session.folder.review.decision_log()
    except LeaklineError:  # a newer survey: what cannot be understood decides nothing here
        return None
    return datetime.fromisoformat(log[-1].at_utc).timestamp() if log else None


def _day(when_s: float) -> str:
    return datetime.fromtimestamp(when_s, UTC).astimezone().date().isoformat()


def _told(survey: Survey) -> Facts:
    ties = sum(point.enabled for point in survey.tie_points)
    return Facts(ties=ties, has_length=survey.pipe.length_m is not None)


def _of_sound(facts: Facts, results: "Results") -> Facts:
    audio, has_sound = results.recording.audio, results.scan is not None
    lost = _covered_s(s for s in results.not_assessed if s.channel is Channel.SOUND)
    return replace(
        facts,
        has_motion=results.recording.imu is not None,
        has_sound=has_sound,
        sound_s=audio.duration_s if audio is not None else 0.0,
        sound_lost_s=lost,
        clock_assumed=has_sound and results.recording.imu is not None and results.clock.basis == "assumed",
    )


def _of_path(facts: Facts, results: "Results", length: str) -> Facts:
    track = results.track
    if track is None or len(track.time_s) < 2:
        return facts
    widest = int(np.argmax(track.sigma_along_m))
    lost_m = 0.0
    for stretch in results.not_assessed:
        if stretch.channel is Channel.PATH:
            ends = np.interp([stretch.start_s, stretch.end_s], track.time_s, track.chainage_m)
            lost_m += float(abs(ends[1] - ends[0]))
    checks = results.tie_checks
    doubted = dict.fromkeys(length if check.name == LENGTH else check.name for check in checks if check.held_down)
    misses = [abs(check.left_out_m) for check in checks if not check.held_down and np.isfinite(check.left_out_m)]
    return replace(
        facts,
        has_path=True,
        length_m=float(track.chainage_m[-1]),
        widest_m=NORMAL_95 * float(track.sigma_along_m[widest]),
        widest_at_m=float(track.chainage_m[widest]),
        path_lost_m=lost_m,
        direction_known=all(finding.code != "heading_unknown" for finding in results.findings),
        ties_doubted=tuple(doubted),
        worst_miss_m=max(misses, default=None),
    )


def _covered_s(stretches: Iterable[Stretch]) -> float:
    """Return how many seconds the stretches cover, overlaps counted once."""
    total, reached = 0.0, -np.inf
    for stretch in sorted(stretches, key=lambda s: s.start_s):
        total += max(0.0, stretch.end_s - max(stretch.start_s, reached))
        reached = max(reached, stretch.end_s)
    return float(total)
