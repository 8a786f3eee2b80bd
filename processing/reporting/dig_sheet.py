"""One leak's page for the crew that digs: what is said, how sure it is, and whether to dig at all."""

from dataclasses import replace
from typing import Any

import numpy as np

from processing.position.distance import NORMAL_95
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.listing import coordinate_lines, status
from processing.reporting.marks import VERDICT_COLOURS
from processing.reporting.qr import geo_link
from processing.reporting.references import (
    LAUNCH,
    Reference,
    Tape,
    covariance,
    ellipse,
    is_heading_known,
    nearest_tapes,
)
from processing.reporting.traffic_light import BELL_HOLE_M, REFERENCE_95_M, TAPE_REACH_M, Assessment, Cause, assess
from processing.reporting.words import Words
from processing.review_facts import DigResult
from processing.sound.size_words import size_sentence
from processing.survey import Decision, Verdict

NOTE_CHARACTERS = 300  # what has room on the sheet; the whole note then stands in the appendix
_NAME_CHARACTERS = 34
_BOX_CHARACTERS = 24  # of one line in the box for a name
_CAUSES_AT_MOST = 4


def sheet(row: LeakRow, content: ReportContent, words: Words, known: tuple[Reference, ...] = ()) -> dict[str, Any]:
    """Return one leak's page; ``known`` are the references of the run, which all sheets share."""
    c = row.candidate
    heading = "leak_heading" if row.decision.verdict is Verdict.CONFIRMED else "place_heading"
    tapes = nearest_tapes(c, content.results, known)
    assessment = assess(c, row.decision, content.results, content.record, tapes)
    placed = bool(np.isfinite(c.chainage_m))
    geographic = row.latitude is not None and row.longitude is not None
    return {
        "id": str(c.label),
        "heading": words(heading, id=c.label),
        "status": status(row, words),
        "verdict": row.decision.verdict.value,
        "colour": VERDICT_COLOURS[row.decision.verdict],
        "place": words.place(c.chainage_m) if placed else words.seconds(c.time_s),
        "place_label": words("place_label" if placed else "time_label"),
        "window": words("window_value", span=words.span(c.chainage_low95_m, c.chainage_high95_m)) if placed else "",
        "light": light(assessment, words),
        "tapes": [tape_row(tape, words) for tape in tapes],
        "coordinates": [*coordinate_lines(row, content, words), *coordinates_off(row, content, words)],
        "geo": geo_link(row.latitude, row.longitude) if geographic else "",  # type: ignore[arg-type]
        "no_geo": "" if geographic else why_no_code(row, content, words),
        "facts": facts(row, content, words),
        "dug": dug_lines(content.record.digs.get(c.label), words),
        "photo_caption": photo_caption(row, content, words),
    }


def coordinates_off(row: LeakRow, content: ReportContent, words: Words) -> list[str]:
    """Return how far off coordinates may be, the longer half axis of the 95 % ellipse; nothing where there are none."""
    cov = covariance(row.candidate, content.results)
    if cov is None or not is_heading_known(content.results):
        return []
    return [words("coordinates_off", off=words.plus_minus(ellipse(cov).major_m))]


def why_no_code(row: LeakRow, content: ReportContent, words: Words) -> str:
    """Return why a sheet has no QR code: the leak has no place, the path no direction, or the launch no coordinates."""
    if not np.all(np.isfinite(row.candidate.position_w_m)):
        return words("no_qr_place")
    return words("no_qr" if is_heading_known(content.results) else "no_qr_direction")


def light(assessment: Assessment, words: Words) -> dict[str, Any]:
    """Return the light as a key, its word, its reasons and the whole rule."""
    causes = [cause_sentence(cause, words) for cause in assessment.causes[:_CAUSES_AT_MOST]]
    if len(assessment.causes) > _CAUSES_AT_MOST:
        causes.append(words("light_more", count=len(assessment.causes) - _CAUSES_AT_MOST))
    return {
        "light": assessment.light.value,
        "word": words(f"light_{assessment.light.value}"),
        "causes": causes,
        "rule": rule(words),
    }


def rule(words: Words) -> str:
    """Return the written rule of the traffic light."""
    least, most = (words.length(hole) for hole in BELL_HOLE_M)
    sure = words.plus_minus(REFERENCE_95_M)
    return words("light_rule", least=least, hole=most, reach=words.length(TAPE_REACH_M, 0), sure=sure)


def cause_sentence(cause: Cause, words: Words) -> str:
    """Return one reason in words."""
    params = {name: words.length(float(value), 0 if name == "limit" else 1) for name, value in cause.lengths_m.items()}
    params |= {name: words.name(str(value), _NAME_CHARACTERS) for name, value in cause.texts.items()}
    if "name" in params:
        params["name"] = params["name"] or words("launch")
    if "class" in params:
        params["class"] = words(f"class_{params['class']}")
    if "date" in params:
        params["date"] = words.quantities.day(params["date"]) or words("unknown")
    return words(f"light_{cause.code}", **params)


def tape_row(tape: Tape, words: Words) -> list[str]:
    """Return one line of the tape table: reference, along the pipe, over ground, and the direction to walk."""
    name = words("launch") if tape.name == LAUNCH else words.name(tape.name, _NAME_CHARACTERS)
    way = words("onward" if tape.onward else "backward")
    surface = words("not_known")
    if tape.surface_m is not None:
        surface = f"{words.length(tape.surface_m)} {words.plus_minus(tape.surface_95_m)}"
    bearing = words.bearing(tape.bearing_deg) if tape.bearing_deg is not None else words("not_known")
    return [name, f"{words.length(tape.along_m)} {words.plus_minus(tape.along_95_m)}", way, surface, bearing]


def facts(row: LeakRow, content: ReportContent, words: Words) -> list[list[str]]:
    """Return label and value pairs: what it is, how loud, what the interval is made of, what people say."""
    c = row.candidate
    low, high = (words.number(hz, 0) for hz in c.band_hz)
    level = words("level_value", level=words.signed(c.level_db, 1), low=low, high=high)
    scored = np.isfinite(c.score)
    pairs = [
        [words("col_class"), words(f"class_{row.leak_class.value}")],
        [
            words("size"),
            size_sentence(row.size, words.language, words.quantities.units) if row.size is not None else "",
        ],
        [words("col_level"), level if np.isfinite(c.level_db) else ""],
        [words("col_score"), words("probability_value", percent=words.share(c.score)) if scored else words("marked")],
        [words("made_of"), interval_parts(row, content, words)],
        [words("pipe"), pipe_line(content, words)],
        [words("elevation"), elevation(row, content, words)],
        [words("second_reviewer"), opinions(row, content, words)],
        [words("note"), words.shortened(row.decision.note, NOTE_CHARACTERS)],
    ]
    return [pair for pair in pairs if pair[1]]


def pipe_line(content: ReportContent, words: Words) -> str:
    """Return the pipe's data in one line, as far as they were stated."""
    pipe = content.results.survey.pipe
    parts = [words.shortened(pipe.material, 40)]
    parts += [words.quantities.small_length(pipe.diameter_m)] if pipe.diameter_m is not None else []
    parts += [words.quantities.pressure(pipe.pressure_bar)] if pipe.pressure_bar is not None else []
    return ", ".join(part for part in parts if part)


def interval_parts(row: LeakRow, content: ReportContent, words: Words) -> str:
    """Return what path, clock and sound add to the interval, each ± 95 %; empty where the run did not tell.

    What digs made of it afterwards stands behind it: the parts are those of the run.
    """
    evidence = row.candidate.evidence
    parts = []
    for name in ("path", "clock", "sound"):
        sigma = evidence.get(f"sigma_{name}_m")
        if isinstance(sigma, float | int) and np.isfinite(sigma):
            parts.append(words(f"made_of_{name}", off=words.plus_minus(NORMAL_95 * float(sigma))))
    widen = content.results.survey.stated.widen
    if parts and widen > 1.0:
        parts.append(words("made_of_widened", factor=words.number(widen, 1)))
    return ", ".join(parts)


def elevation(row: LeakRow, content: ReportContent, words: Words) -> str:
    """Return the pipe's elevation where the launch's is known: ground level minus it is the depth; else nothing."""
    track, launch = content.results.track, content.results.survey.launch
    up = row.candidate.position_w_m[2]
    if track is None or launch.elevation_m is None or not np.isfinite(up):
        return ""
    off = NORMAL_95 * float(np.interp(row.candidate.time_s, track.time_s, track.sigma_up_m))
    level = words.elevation(content.frame.height_m + up)
    return words("elevation_value", level=level, off=words.plus_minus(off))


def opinions(row: LeakRow, content: ReportContent, words: Words) -> str:
    """Return what each second reviewer says, and whether it differs."""
    said, first = [], row.decision
    if first.verdict is Verdict.CONFIRMED:  # then it matters what for, be it the machine who named it
        first = replace(first, leak_class=row.leak_class)
    for opinion in content.record.opinions:
        if opinion.number == row.candidate.label and opinion.decision.verdict is not Verdict.NONE:
            agrees = agree(first, opinion.decision)
            key = "opinion_agrees" if agrees else "opinion_differs"
            reviewer = words.name(opinion.reviewer, _NAME_CHARACTERS) or words("unknown")
            said_class = opinion.decision.leak_class
            verdict = verdict_word(opinion.decision.verdict, words)
            if said_class is not None and said_class is not row.leak_class:
                verdict = f"{verdict}, {words(f'class_{said_class.value}')}"
            text = words(key, reviewer=reviewer, verdict=verdict)
            note = words.shortened(opinion.decision.note, 60)
            said.append(f"{text} ({note})" if note else text)
    return "; ".join(said[:3])


def agree(first: Decision, second: Decision) -> bool:
    """Return whether two reviewers say the same: verdict, and class where both named one."""
    if first.verdict is not second.verdict:
        return False
    classes = {first.leak_class, second.leak_class} - {None}
    return len(classes) < 2


def verdict_word(verdict: Verdict, words: Words) -> str:
    """Return a verdict as a word."""
    key = {
        Verdict.NONE: "status_candidate",
        Verdict.CONFIRMED: "status_confirmed",
        Verdict.REJECTED: "status_rejected",
        Verdict.UNSURE: "verdict_unsure",
    }[verdict]
    return words(key)


def dug_lines(dug: DigResult | None, words: Words) -> dict[str, str]:
    """Return what the dig showed, box by box; an empty dict where nobody has dug: the boxes then wait for a pen."""
    if dug is None:
        return {}
    off = ""
    if dug.off_along_m is not None:
        key = "found_onward" if dug.off_along_m >= 0 else "found_backward"
        off = words(key, off=words.length(abs(dug.off_along_m), 2))
    return {
        "finding": words(f"found_{dug.finding.value}"),
        "off": off,
        "depth": words.length(dug.depth_m, 2) if dug.depth_m is not None else "",
        "cause": words.shortened(dug.cause, 40),
        "date": words.quantities.day(dug.date),
        "name": words.shortened(dug.dug_by or dug.operator, _BOX_CHARACTERS),
    }


def photo_caption(row: LeakRow, content: ReportContent, words: Words) -> str:
    """Return the caption of the first photo, and how many more there are."""
    own = [photo for photo, _ in content.record.photos if photo.number == row.candidate.label]
    if not own:
        return ""
    caption = words.shortened(own[0].caption, 70)
    more = words("photo_more", count=len(own) - 1) if len(own) > 1 else ""
    return " ".join(part for part in (caption, more) if part)
