"""Two runs compared, in sentences for window and report, and as a table in a file."""

import csv
import math
from pathlib import Path

from processing import messages
from processing.quantities import Quantities
from processing.repeat_alignment import NAMES
from processing.repeat_runs import Change, Comparison, Place
from processing.storage.files import writing
from processing.survey import Candidate

COLUMNS = (
    "change", "chainage_m", "low95_m", "high95_m", "leak", "other_leak", "other_chainage_m", "apart_m", "growth_db",
    "growth_half95_db", "growth_at_least", "score", "other_score",
)  # fmt: skip


def name_of(place: Place) -> str:
    """Return what a place is called: by our number, else by theirs with a prime."""
    if place.ours is not None:
        return f"L{place.ours.label}"
    return f"L{place.theirs.label}\N{PRIME}" if place.theirs is not None else "–"


def change_word(place: Place, language: str) -> str:
    """Return the change in a word or two, and of what is in both runs whether it is plainly louder or fainter.

    What only one run found, but both heard alike, is not called new or gone outright.
    """
    if place.change in (Change.NEW, Change.GONE) and place.heard_in_both:
        return messages.text("repeat", f"{place.change.value}_heard_word", language)
    word = messages.text("repeat", f"{place.change.value}_word", language)
    if place.change is not Change.SAME or not place.has_changed:
        return word
    return f"{word}, {messages.text('repeat', 'louder' if place.growth_db > 0.0 else 'fainter', language)}"


def basis_sentences(comparison: Comparison, quantities: Quantities) -> tuple[str, ...]:
    """Return how the runs were put side by side, how well, and how their levels were made alike."""
    language, alignment = quantities.language, comparison.alignment
    sigma = quantities.length(1.96 * alignment.sigma_m)
    params: dict[str, object] = {"sigma": sigma}
    if alignment.basis == NAMES:
        params["count"] = len(alignment.anchors)
    out = [messages.text("repeat", alignment.basis, language, **params)]
    if alignment.is_reversed:
        out.append(messages.text("repeat", "reversed", language))
    if comparison.may_be_reversed:
        out.append(messages.text("repeat", "may_be_reversed", language))
    if not comparison.order_known:
        out.append(messages.text("repeat", "order_unknown", language))
    out.append(messages.text("repeat", "common", language, common=quantities.length(comparison.common_m, 0)))
    if comparison.common_known:
        common_db = quantities.number(comparison.common_db, 1)
        out.append(messages.text("repeat", "level_known", language, common_db=common_db))
    else:
        out.append(messages.text("repeat", "level_unknown", language))
    return tuple(out)


def change_sentences(comparison: Comparison, quantities: Quantities) -> tuple[str, ...]:
    """Return "changes since …": the summary, then what could not be compared."""
    language, places = quantities.language, comparison.places
    counts = {change: sum(place.change is change for place in places) for change in Change}
    same = [place for place in places if place.change is Change.SAME and place.has_changed]
    older = comparison.older
    out = [
        messages.text(
            "repeat",
            "since",
            language,
            day=quantities.day(older.date) if older.date else older.name,
            new=counts[Change.NEW],
            gone=counts[Change.GONE],
            same=counts[Change.SAME],
            louder=sum(place.growth_db > 0.0 for place in same),
            fainter=sum(place.growth_db < 0.0 for place in same),
        )
    ]
    unfound = sum(place.change in (Change.NEW, Change.GONE) and place.heard_in_both for place in places)
    if unfound:
        out.append(messages.text("repeat", "heard_in_both", language, count=unfound))
    left = [change for change in (Change.MOVED, Change.NOT_HEARD) if counts[change]]
    out += [messages.text("repeat", change.value, language, count=counts[change]) for change in left]
    return tuple(out)


def place_sentence(place: Place, quantities: Quantities) -> str:
    """Return one place in a line."""
    return messages.text(
        "repeat",
        "place",
        quantities.language,
        name=name_of(place),
        place=quantities.place(place.chainage_m),
        half=quantities.length(place.half95_m),
        change=change_word(place, quantities.language),
        growth=growth_text(place, quantities),
    )


def growth_text(place: Place, quantities: Quantities) -> str:
    """Return the growth with its ±, beginning with a comma; empty where it is not known."""
    if not math.isfinite(place.growth_db):
        return ""
    key = "growth_at_least" if place.at_least else "growth"
    sign = "+" if round(place.growth_db, 1) > 0.0 else ""
    db = sign + quantities.number(place.growth_db, 1)
    return messages.text("repeat", key, quantities.language, db=db, half=quantities.number(place.growth_half95_db, 1))


def report_sentences(comparison: Comparison, quantities: Quantities) -> tuple[str, ...]:
    """Return the report's section on changes: the summary, its basis, then place by place."""
    lines = (place_sentence(place, quantities) for place in comparison.places)
    return (*change_sentences(comparison, quantities), *basis_sentences(comparison, quantities), *lines)


def write_csv(path: Path, comparison: Comparison) -> None:
    """Write one line a place; metres of our chainage, decimal points, empty where unknown.

    Raises:
        LeaklineError: CANNOT_WRITE, DISC_FULL.
    """
    with writing(path), path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(COLUMNS)
        for place in comparison.places:
            at, half = place.chainage_m, place.half95_m
            values: tuple[float, ...] = (at, max(at - half, 0.0), at + half)
            theirs = place.theirs.chainage_m if place.theirs is not None else math.nan
            table.writerow(
                [
                    place.change.value,
                    *(_figure(value) for value in values),
                    *(str(c.label) if c is not None else "" for c in (place.ours, place.theirs)),
                    _figure(theirs),
                    *(_figure(value) for value in (place.apart_m, place.growth_db, place.growth_half95_db)),
                    int(place.at_least),
                    *(_score(candidate) for candidate in (place.ours, place.theirs)),
                ]
            )


def _score(candidate: Candidate | None) -> str:
    return "" if candidate is None else _figure(candidate.score)


def _figure(value: float) -> str:
    return f"{value:.2f}" if math.isfinite(value) else ""
