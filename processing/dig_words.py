"""What the digs say of the stated intervals, in sentences: the same in the window and in the report."""

import math

from processing import messages
from processing.dig_history import ANY
from processing.dig_statistics import FEWEST
from processing.quantities import Quantities
from processing.review_facts import DigHistory, ScoreBand

_MANY_FOR_95 = 20  # of fewer the 95th percentile is the largest
_TOLD_BIAS = 1.96  # a mean error of fewer of its own sigmas says nothing


def kind_words(kind: str, language: str) -> str:
    """Return which digs a history speaks of: ``rolling runs in ductile iron, 110 to 300 mm, with tie points``."""
    words = messages.table("digs", language)
    motion, material, diameter, tied = (*kind.split("/"), ANY, ANY, ANY)[:4]
    name = {ANY: words["any"], "?": words["unknown"]}.get(material) or words.get(material, material)
    parts = [words["kind"].format(motion=words.get(motion, motion), material=name)]
    parts += [words[key] for key in (f"up_to_{diameter}", tied) if key in words]
    return ", ".join(parts)


def history_sentences(history: DigHistory, quantities: Quantities) -> tuple[str, ...]:
    """Return what the digs of this kind showed, the accuracy statement's own sentence first."""
    language, count = quantities.language, history.count

    def text(key: str, **params: object) -> str:
        return messages.text("digs", key, language, **params)

    median, p95 = quantities.length(history.median_error_m), quantities.length(history.p95_error_m)
    key = "held_none" if count == 0 else "held_one" if history.held else "missed_one"
    if count > 1:
        key = "held" if count >= _MANY_FOR_95 else "held_few"
    words = kind_words(history.kind, language)
    out = [text(key, count=count, held=history.held, kind=words, median=median, p95=p95)]
    if count >= FEWEST:
        out.append(text("share", low=_hundredths(history.held_low), high=_hundredths(history.held_high)))
    if history.widen != 1.0:
        key = "narrow" if history.widen > 1.0 else "wide"
        out.append(text(key, factor=quantities.number(history.widen, 1 if history.widen > 1.0 else 2)))
    elif count:
        out.append(text("few" if count < FEWEST else "right"))
    if count >= FEWEST and abs(history.bias_m) > _TOLD_BIAS * history.bias_sigma_m:
        key = "bias_away" if history.bias_m > 0.0 else "bias_towards"
        sigma = quantities.length(_TOLD_BIAS * history.bias_sigma_m)
        out.append(text(key, bias=quantities.length(abs(history.bias_m)), sigma=sigma))
    if history.dug > 1:
        low, high = _hundredths(history.dry_low), _hundredths(history.dry_high)
        out.append(text("dry", dug=history.dug, dry=history.dry_holes, low=low, high=high))
    if history.missed:
        out.append(text("missed", missed=history.missed))
    return tuple(out)


def band_sentence(band: ScoreBand, quantities: Quantities) -> str:
    """Return how often the machine's probability was right: for the report, no score is changed by it."""
    return messages.text(
        "digs",
        "band",
        quantities.language,
        low=quantities.number(band.low, 1),
        high=quantities.number(band.high, 1),
        leaks=band.leaks,
        digs=band.digs,
        share_low=_hundredths(band.share_low),
        share_high=_hundredths(band.share_high),
    )


def widened_sentence(factor: float, kind: str, quantities: Quantities) -> str:
    """Return that, why and by what factor the intervals of a report were widened; empty where they were not."""
    if not factor > 1.0:
        return ""
    number = quantities.number(factor, 1)
    return messages.text(
        "digs", "widened", quantities.language, factor=number, kind=kind_words(kind, quantities.language)
    )


def _hundredths(share: float) -> int:
    return math.floor(100.0 * share + 0.5)
