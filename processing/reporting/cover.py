"""The report's first pages in words: who, what and where, the result in one glance, and how exact it is and why."""

from dataclasses import dataclass

import numpy as np

from processing import messages
from processing.dig_words import band_sentence, history_sentences, widened_sentence
from processing.position.distance import NORMAL_95
from processing.reporting.content import ReportContent, verdict_counts
from processing.reporting.words import Words
from processing.survey import Motion, Verdict

_LINE = 120  # characters of a typed field that a cover shows


def banner(content: ReportContent, words: Words) -> str:
    """Return the line that keeps a reader from digging too soon: simulated data, or undecided places."""
    parts = []
    if content.results.survey.info.simulated:
        parts.append(words("simulated"))
    if content.undecided:
        parts.append(words("draft", count=content.undecided))
    return " · ".join(parts)


def watermark(content: ReportContent, words: Words) -> str:
    """Return what stands across each page: simulated data always, a draft while anything is undecided or unsure."""
    if content.results.survey.info.simulated:
        return words("watermark_simulated")
    return words("watermark_draft") if content.undecided else ""


def company_lines(content: ReportContent, words: Words) -> list[str]:
    """Return the company's address, contact and licence as lines; its name and footer stand elsewhere."""
    company = content.options.company
    lines = [line for field in (company.address, company.contact) for line in field.splitlines() if line.strip()]
    if company.licence:
        lines.append(words("licence", number=company.licence))
    return [words.shortened(line, _LINE // 2) for line in lines[:8]]


def cover_facts(content: ReportContent, words: Words) -> list[list[str]]:
    """Return label and value pairs of the cover, the company's own lines last."""
    results, survey = content.results, content.results.survey
    pipe = words(
        "pipe_value",
        material=survey.pipe.material or words("unknown"),
        diameter=known(words.quantities.small_length(survey.pipe.diameter_m), words),
        length=known(words.length(survey.pipe.length_m), words),
    )
    if survey.pipe.pressure_bar is not None:
        pipe += words("pipe_pressure", pressure=words.quantities.pressure(survey.pipe.pressure_bar))
    device = {
        Motion.ROLLING: words(
            "device_rolling", radius=known(words.quantities.small_length(survey.device.radius_m), words)
        ),
        Motion.CARRIED: words("device_carried"),
        Motion.FOOT: words("device_foot"),
    }[survey.device.motion]
    track = results.track
    path = messages.table("position_titles", words.language).get(track.method, track.method) if track else ""
    method = words(
        "method_value",
        orientation=results.attitude_method or words("unknown"),
        position=path or words("unknown"),
    )
    facts = [
        [words("operator"), survey.info.operator],
        [words("client"), survey.info.client],
        [words("date"), words.quantities.day(survey.info.date)],
        [words("pipe"), pipe],
        [words("device"), device],
        [words("method"), method],
        [words("reviewers"), ", ".join(reviewers(content))],
        *([label, value] for label, value in content.options.company.extra[:12]),
    ]
    return [[words.shortened(label, 40), words.shortened(value, _LINE)] for label, value in facts if value.strip()]


def known(text: str, words: Words) -> str:
    """Return the text, or that nobody stated it."""
    return words("unknown") if text == "–" else text


def reviewers(content: ReportContent) -> list[str]:
    """Return who decided, in the order they first did, second reviewers too."""
    names = [entry.operator for entry in content.record.log if entry.reason in ("decide", "add")]
    names += [opinion.reviewer for opinion in content.record.opinions]
    return list(dict.fromkeys(name for name in names if name))


@dataclass(frozen=True)
class Glance:
    """The result in figures: places by verdict, and metres of the pipe."""

    confirmed: int
    unsure: int
    undecided: int
    rejected: int
    total_m: float | None
    unassessed_m: float


def glance_of(content: ReportContent) -> Glance:
    """Return the result in one glance; metres are None where there is no path."""
    counts = {verdict: sum(row.decision.verdict is verdict for row in content.rows) for verdict in Verdict}
    track = content.results.track
    total = float(track.chainage_m[-1] - track.chainage_m[0]) if track is not None else None
    return Glance(
        counts[Verdict.CONFIRMED],
        counts[Verdict.UNSURE],
        counts[Verdict.NONE],
        counts[Verdict.REJECTED],
        total,
        min(content.unassessed_m, total) if total is not None else 0.0,
    )


def glance_tiles(content: ReportContent, words: Words) -> list[list[str]]:
    """Return the glance as tiles: a big figure, and what it counts."""
    glance = glance_of(content)
    tiles = [
        [str(glance.confirmed), words("tile_confirmed"), "confirmed"],
        [str(glance.unsure), words("tile_unsure"), "unsure"],
        [str(glance.undecided), words("tile_undecided"), "none"],
    ]
    if glance.total_m is not None:
        assessed = glance.total_m - glance.unassessed_m
        total = words.length(glance.total_m, 0).replace(" ", "\N{NO-BREAK SPACE}")
        tiles.append([words.length(assessed, 0), words("tile_assessed", total=total), "plain"])
        tiles.append([words.length(glance.unassessed_m, 0), words("tile_unassessed", total=total), "plain"])
    return tiles


def result_sentence(content: ReportContent, words: Words) -> str:
    """Return the result as one sentence."""
    counts = verdict_counts(content)
    unassessed = words.length(content.unassessed_m)
    if content.results.track is None:
        unassessed = words.seconds(sum(part.end_s - part.start_s for part in content.results.not_assessed))
    return words("result_value", **counts, unassessed=unassessed)


def accuracy(content: ReportContent, words: Words) -> list[str]:
    """Return the accuracy statement, sentence by sentence, each with its basis."""
    results, track = content.results, content.results.track
    if track is None:
        return [words("accuracy_no_path")]
    sentences = [words("accuracy_meaning"), *_interval_sentences(content, words), *_tie_sentences(content, words)]
    if results.survey.pipe.length_m is not None:
        sentences.append(words("accuracy_length", length=words.length(results.survey.pipe.length_m)))
    elif not any(tie.enabled for tie in results.survey.tie_points):
        sentences.append(words("accuracy_free"))
    if results.recording.audio is not None:
        clock = results.clock
        sigma_ms, sigma_s = words.number(1000 * clock.sigma_s, 0), words.number(clock.sigma_s, 1)
        sentences.append(words(f"accuracy_clock_{clock.basis}", sigma_ms=sigma_ms, sigma_s=sigma_s))
    sentences += _width_sentence(content, words)
    if any(finding.code == "heading_unknown" for finding in results.findings):
        sentences.append(words("heading_unknown"))
    return sentences + _history_sentences(content, words)


def _interval_sentences(content: ReportContent, words: Words) -> list[str]:
    """Return how wide the intervals are, at their widest and at the leaks."""
    track = content.results.track
    assert track is not None  # the caller has seen to it
    half = NORMAL_95 * track.sigma_along_m
    widest = int(np.argmax(half))
    params = {"widest": words.plus_minus(float(half[widest])), "at": words.place(float(track.chainage_m[widest]))}
    at_leaks = [row.interval_m for row in content.rows if np.isfinite(row.interval_m)]
    if not at_leaks:
        return [words("accuracy_interval_plain", **params)]
    least, most = words.plus_minus(min(at_leaks)), words.plus_minus(max(at_leaks))
    return [words("accuracy_interval", **params, least=least, most=most)]


def _tie_sentences(content: ReportContent, words: Words) -> list[str]:
    track = content.results.track
    used = [tie for tie in content.results.survey.tie_points if tie.enabled]
    if not used or track is None:
        return []
    sentences = [words("accuracy_ties", count=len(used))]
    rms, worst = track.quality.get("tie_residual_rms_m"), track.quality.get("tie_left_out_max_m")
    if isinstance(rms, float | int) and isinstance(worst, float | int):
        sentences.append(words("accuracy_tie_check", rms=words.length(rms, 2), worst=words.length(worst, 2)))
    return sentences


def _width_sentence(content: ReportContent, words: Words) -> list[str]:
    """Return how sharply the sound marks a leak: the width of its rise, of which the top is placed."""
    widths = [row.candidate.width_m for row in content.rows if np.isfinite(row.candidate.width_m)]
    if not widths:
        return []
    middle = words.length(float(np.median(widths)))
    return [words("accuracy_width", middle=middle, least=words.length(min(widths)), most=words.length(max(widths)))]


def _history_sentences(content: ReportContent, words: Words) -> list[str]:
    """Return what earlier digs showed the intervals to be worth, and whether they were widened for it."""
    history, stated = content.record.history, content.results.survey.stated
    widened = widened_sentence(stated.widen, stated.kind, words.quantities)
    sentences = [widened] if widened else []
    if history is None:
        return [*sentences, words("history_none")]
    bands = [band_sentence(band, words.quantities) for band in history.bands]
    return [*sentences, *history_sentences(history, words.quantities), *bands]
