"""The words of the page of digs: lines, titles, and what follows from an answer."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.dig_answers import Figured, Missing
from app.survey_session import SurveySession
from processing import messages
from processing.review_facts import DigFinding, DigHistory, DigResult
from processing.stated import widened
from processing.survey import StatedIntervals, Verdict
from widgets.candidate_row import CandidateRow
from widgets.dig_list import SIGNS, DigLine, Held
from widgets.units import quantities
from widgets.vocabulary import place_text

if TYPE_CHECKING:
    from processing.storage.digs import Statement

_MISSED = -1


class DigWording(QObject):
    """Translates; holds no state."""

    def __init__(self, language: str) -> None:
        super().__init__()
        self._language = language

    # --- leaks ---

    def row_of(self, session: SurveySession, number: int) -> CandidateRow | None:
        """Return the candidate of this number, None where the present run has none."""
        return next((row for row in session.rows() if row.candidate.label == number), None)

    def name(self, session: SurveySession, number: int) -> str:
        """Return what a leak is called."""
        row = self.row_of(session, number)
        return row.name if row is not None else f"L{number}"

    def numbers(self, session: SurveySession, results: Mapping[int, DigResult]) -> list[int]:
        """Return the leaks that may be dug or were: confirmed ones along the pipe, and all with a result."""
        rows = {row.candidate.label: row for row in session.rows()}
        wanted = {n for n, row in rows.items() if row.decision.verdict is Verdict.CONFIRMED} | set(results)
        if session.selected is not None and (row := session.row(session.selected)) is not None:
            wanted.add(row.candidate.label)

        def place(number: int) -> tuple[bool, float, int]:
            at = rows[number].candidate.chainage_m if number in rows else float("nan")
            return at != at, at if at == at else 0.0, number

        return sorted(wanted, key=place)

    def lines(self, session: SurveySession, results: Mapping[int, DigResult]) -> list[DigLine]:
        """Return the lines of the list."""
        rows = {row.candidate.label: row for row in session.rows()}
        widen = session.survey.stated.widen
        return [
            self._line(number, rows.get(number), results.get(number), widen)
            for number in self.numbers(session, results)
        ]

    def _line(self, number: int, row: CandidateRow | None, result: DigResult | None, widen: float) -> DigLine:
        told = quantities()
        stated = place_text(widened(row.candidate, widen)) if row is not None else "–"
        if result is None:
            return DigLine(number, row.name if row is not None else f"L{number}", stated, "–", "", Held.OPEN, "")
        if result.stated_chainage_m is not None:
            stated = told.place(result.stated_chainage_m)
            if result.stated_low95_m is not None and result.stated_high95_m is not None:
                stated += f" ± {told.length((result.stated_high95_m - result.stated_low95_m) / 2)}"
        elif result.missed:
            stated = "–"
        name = row.name if row is not None else f"L{number}"
        day = told.day(result.date)
        off = self._arrow(result)
        return DigLine(number, name, stated, self.finding(result.finding), off, self.held(result), day)

    def _arrow(self, result: DigResult) -> str:
        """Return how far off it was found, the direction as an arrow: for a column."""
        off = result.off_along_m
        if off is None:
            return ""
        length = quantities().length(abs(off))
        return length if round(off, 2) == 0.0 else f"{length} ▶" if off > 0.0 else f"◀ {length}"

    def held(self, result: DigResult) -> Held:
        """Return whether the stated interval held, the tape considered."""
        from processing.dig_statistics import errors_of

        if result.missed:
            return Held.MISSED
        if result.finding is DigFinding.NOTHING:
            return Held.DRY
        held = errors_of([result]).held
        if len(held):
            return Held.INSIDE if bool(held[0]) else Held.OUTSIDE
        return Held.DRY if result.finding is DigFinding.OTHER else Held.OPEN

    def finding(self, finding: DigFinding) -> str:
        """Return the finding in one or two words."""
        return {
            DigFinding.LEAK: self.tr("leak"),
            DigFinding.OTHER: self.tr("something else"),
            DigFinding.NOTHING: self.tr("nothing"),
        }[finding]

    def off(self, result: DigResult) -> str:
        """Return how far off it was found and in which direction; empty where nobody measured."""
        off = result.off_along_m
        if off is None:
            return ""
        length = quantities().length(abs(off))
        if round(off, 2) == 0.0:
            return length
        text = self.tr("{length} away from launch ▶") if off > 0.0 else self.tr("◀ {length} towards launch")
        return text.format(length=length)

    def title(self, session: SurveySession, number: int, known: DigResult | None) -> str:
        """Return the head of the form."""
        if number == _MISSED:
            return self.tr("A leak that was found where none had been stated. Where was it?")
        row = self.row_of(session, number)
        name = self.name(session, number)
        if known is not None and known.missed:
            return self.tr("{name}: a leak that had not been stated").format(name=name)
        if row is None:
            return self.tr("{name}: the present run has no such place any more").format(name=name)
        return self.tr("{name}, stated at {place}").format(
            name=name, place=place_text(widened(row.candidate, session.survey.stated.widen))
        )

    def statement(self, statement: "Statement") -> str:
        """Return which report this is, and what it stated."""
        text = self.tr("run {run}, {day}: {place}")
        day = quantities().day(statement.run_utc)
        return text.format(run=statement.run_id, day=day, place=place_text(statement.candidate))

    def causes(self) -> list[str]:
        """Return the causes that are offered before any was typed."""
        return [
            self.tr("joint"),
            self.tr("crack"),
            self.tr("hole"),
            self.tr("corrosion"),
            self.tr("service connection"),
            self.tr("valve"),
            self.tr("earlier repair"),
        ]

    # --- what follows ---

    def missing(self, found: Figured) -> str:
        """Return what an answer lacks."""
        if found.error is not None:
            return messages.error_sentence(found.error, self._language)
        return {
            Missing.NOTHING: "",
            Missing.FINDING: self.tr("What was found? Press Leak, Something else or Nothing."),
            Missing.DIRECTION: self.tr("In which direction was it found? Press one of the two arrows."),
            Missing.PLACE: self.tr("Type the chainage or the coordinates of the leak."),
            Missing.STATED: self.tr("No place had been stated in metres: measure by tape, or leave the place empty."),
            Missing.PATH: self.tr("This survey has no path to put coordinates on: measure by tape."),
        }[found.missing]

    def followed(self, found: Figured) -> str:
        """Return what an answer means for the statement."""
        result = found.result
        assert result is not None  # else it is what is missing that is said
        held = self.held(result)
        parts = []
        if found.found_m is not None:
            parts.append(self.tr("found at {place}").format(place=quantities().place(found.found_m)))
        off = self.off(result)
        if off:
            parts.append(off)
        if result.off_across_m is not None:
            text = self.tr("{length} beside the path")
            parts.append(text.format(length=quantities().length(abs(result.off_across_m))))
        verdicts = {
            Held.INSIDE: self.tr("the stated interval holds it"),
            Held.OUTSIDE: self.tr("outside the stated interval"),
            Held.DRY: self.tr("no leak where one was stated"),
            Held.MISSED: self.tr("not stated before: it is marked by hand, confirmed"),
            Held.OPEN: self.tr("not measured: it counts as found, not as an error"),
        }
        parts.append(f"{SIGNS[held]} {verdicts[held]}".strip())
        return ", ".join(parts)

    def widening(self, stated: StatedIntervals, history: DigHistory | None) -> str:
        """Return what the button offers; empty for nothing."""
        told = quantities()
        if stated.widen > 1.0:
            text = self.tr("State the intervals as computed again (now {factor} times as wide)")
            return text.format(factor=told.number(stated.widen, 1))
        if history is not None and history.widen > 1.0:
            factor = math.ceil(10.0 * history.widen - 1e-9) / 10.0
            text = self.tr("State all intervals of this report {factor} times as wide")
            return text.format(factor=told.number(factor, 1))
        return ""
