"""What a dig showed, entered beside what was stated: the page of digs, built when it is first asked for (Ctrl+F)."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.dig_answers import Figured, figured
from app.dig_commands import RecordDig
from app.dig_ledger import DigLedger
from app.dig_wording import DigWording
from app.marking import candidate_at
from app.page_host import PageHost
from app.review_commands import Decide, EditSurvey, Mark
from app.services import Services
from processing.coordinates import LocalFrame, frame_of
from processing.errors import LeaklineError
from processing.review_facts import DigFinding, DigResult
from processing.survey import Decision, LeakClass, StatedIntervals, Verdict
from widgets.dig_form import COORDINATES
from widgets.dig_list import SIGNS
from widgets.units import quantities

if TYPE_CHECKING:
    from processing.storage.digs import Statement
    from widgets.dig_page import DigPage

PAGE = "digs"
MISSED = -1  # the number of a leak that is being entered and that nobody had stated
_MOST_REMEMBERED = 12


class DigControl(QObject):
    """Connects the session, the ledger and the page; ``ledger.history`` is what the report prints."""

    told = Signal(str)
    photo_asked = Signal()
    marked = Signal(object)  # dict[int, str]: the leaks that were dug up, by number, with the sign of what that showed

    def __init__(self, services: Services, host: PageHost, language: str, window: QWidget) -> None:
        super().__init__(window)
        self._session, self._preferences, self._host, self._window = (
            services.session, services.preferences, host, window
        )  # fmt: skip
        self._language = language
        self._words = DigWording(language)
        self.ledger = DigLedger(services.session, services.jobs, language, self)
        self.ledger.told.connect(self.told)
        self.page: DigPage | None = None
        self._before = "leaks"
        self._number: int | None = None
        self._statements: tuple[Statement, ...] = ()
        host.openers[PAGE] = self.toggle
        session = services.session
        for changed in (self.ledger.changed, session.results_changed, session.candidates_changed):
            changed.connect(self._show)
        self.ledger.changed.connect(self.show_marks)
        session.reviewer_changed.connect(self.show_marks)
        self.ledger.history_changed.connect(self._show_history)
        for shown in (self._show_history, self._show_lines):  # not the form: somebody may be typing
            session.survey_changed.connect(shown)
        session.decision_changed.connect(lambda _candidate: self._show_lines())

    def show_marks(self) -> None:
        """Tell the list and the plan which leaks were dug up."""
        digs = {} if self._session.reviewer else self.ledger.results  # a second reviewer judges by the sound alone
        self.marked.emit({number: SIGNS[self._words.held(dig)] or "•" for number, dig in digs.items()})

    # --- the door ---

    def toggle(self) -> None:
        """Show the page with the selected leak; where it is in front already, go back to what was there before."""
        if self._session.results is None:
            self.told.emit(self.tr("Process the survey first: what a dig showed belongs to a leak."))
            return
        if self._host.current() == PAGE:
            self._host.show(self._before)
            return
        if self.page is None:
            self._build()
        self._before = self._host.current()
        row = self._session.row(self._session.selected)
        numbers = self._words.numbers(self._session, self.ledger.results)
        self._number = row.candidate.label if row is not None else next(iter(numbers), None)
        self._show()
        self._show_history()
        self._host.show(PAGE)
        assert self.page is not None  # built just now
        self.page.form.focus_finding()

    def _build(self) -> None:
        from widgets.dig_page import DigPage

        page = self.page = DigPage()
        self._host.add(PAGE, page)
        page.back_asked.connect(self.toggle)
        page.missed_asked.connect(self._begin_missed)
        page.widen_asked.connect(self._toggle_widening)
        page.export_asked.connect(self._write_out)
        page.import_asked.connect(self._take_in)
        page.list.chosen.connect(self._choose)
        page.form.edited.connect(self._show_figured)
        page.form.save_asked.connect(self._save)
        page.form.clear_asked.connect(self._take_back)
        page.form.photo_asked.connect(self._ask_photo)

    def stop(self) -> None:
        """Leave no work behind: the window closes."""
        self.ledger.stop()

    # --- one leak ---

    def _choose(self, number: int) -> None:
        self._number = number
        row = self._words.row_of(self._session, number)
        if row is not None:
            self._session.select(row.candidate.id)
        self._show_form()

    def _ask_photo(self) -> None:
        """Let a photo be attached to the leak in the form, which need not be the one that is selected in the list."""
        row = None if self._number is None else self._words.row_of(self._session, self._number)
        if row is None:
            self.told.emit(self.tr("Save the dig first: a photo belongs to a leak that is on the list."))
            return
        self._session.select(row.candidate.id)
        self.photo_asked.emit()

    def _begin_missed(self) -> None:
        self._number = MISSED
        self._show_lines()
        self._show_form()
        if self.page is not None:
            self.page.form.focus_finding()

    def _stated(self, statement: int) -> DigResult:
        """Return an empty result with number and statement: kept as it was, or by the statement that is chosen."""
        from processing.storage.digs import stated_as, stated_by

        number = self._number
        assert number is not None  # the form is off without one
        empty = DigResult(max(number, 0), DigFinding.LEAK)
        known = self.ledger.results.get(number)
        if number == MISSED or (known is not None and known.missed):
            return replace(empty, missed=True)
        chosen = self._statements[statement] if statement < len(self._statements) else None
        if known is not None and (chosen is None or chosen.run_id == known.run_id):
            return stated_as(known, empty)
        if chosen is None:
            return empty
        runs = [offered.run_id for offered in self._statements]
        if known is not None and known.run_id not in runs and statement == 0:
            return stated_as(known, empty)  # its own run states it no more, and nobody has chosen another
        newest = chosen.run_id == max(runs)
        widen = self._session.survey.stated.widen if newest else 1.0
        return stated_by(chosen.candidate, chosen.run_id, empty, widen)

    def _figured(self) -> Figured:
        from processing.reporting.references import is_heading_known

        assert self.page is not None  # asked by its form
        answer = self.page.form.answer
        results = self._session.results
        placed = results is not None and is_heading_known(results)  # else the path lies anyhow on the map
        track = results.track if results is not None and (placed or answer.measured != COORDINATES) else None
        return figured(answer, self._stated(answer.statement), track, self._frame())

    def _frame(self) -> LocalFrame:
        try:
            return frame_of(self._session.survey)
        except LeaklineError:  # the data page tells of it; here it is a survey without a place in the world
            return LocalFrame()

    def _save(self) -> None:
        if self.page is None or self._number is None:
            return
        found = self._figured()
        if found.result is None:
            self.page.form.set_told(self._words.missing(found))
            self.page.form.focus_finding()
            return
        self._remember(found.result)
        if self._number == MISSED:
            self._save_missed(found)
            return
        text = self.tr("dig at {name}").format(name=self._words.name(self._session, self._number))
        self._session.push(RecordDig(self.ledger, text, self._number, found.result))
        if self.ledger.results.get(self._number) is not None:
            self.told.emit(self.tr("Saved: {what}").format(what=self._words.followed(found)))

    def _save_missed(self, found: Figured) -> None:
        """Mark the place by hand, confirmed, with its dig: one step of undo."""
        session, results = self._session, self._session.results
        if results is None or results.track is None or found.found_m is None or found.result is None:
            return
        from processing.position.distance import times_at

        known = {row.candidate.id for row in session.rows()}
        candidate = candidate_at(results, float(times_at(results.track, found.found_m)[0][0]))
        text = self.tr("leak found elsewhere")
        session.undo_stack.beginMacro(text)
        session.push(Mark(session, text, candidate))
        row = session.row(session.selected)
        if row is not None and row.candidate.id not in known:
            after = Decision(Verdict.CONFIRMED, LeakClass.LEAK)
            session.push(Decide(session, text, row.candidate.id, after))
            self._number = row.candidate.label
            session.push(RecordDig(self.ledger, text, self._number, replace(found.result, number=self._number)))
            self.told.emit(self.tr("Saved: {what}").format(what=self._words.followed(found)))
        session.undo_stack.endMacro()
        self._show()

    def _take_back(self) -> None:
        if self._number in self.ledger.results:
            assert self._number is not None  # a key of the results
            text = self.tr("dig at {name}").format(name=self._words.name(self._session, self._number))
            self._session.push(RecordDig(self.ledger, text, self._number, None))

    # --- the history ---

    def _toggle_widening(self) -> None:
        """Widen the stated intervals of this survey's report as the history asks, or take that back; logged."""
        session, history = self._session, self.ledger.history
        if session.survey.stated.widen > 1.0:
            stated, text = StatedIntervals(), self.tr("intervals as computed")
        elif history is not None and history.widen > 1.0:
            factor = math.ceil(10.0 * history.widen - 1e-9) / 10.0
            stated, text = StatedIntervals(factor, history.count, history.kind), self.tr("wider intervals")
        else:
            return
        session.push(EditSurvey(session, text, replace(session.survey, stated=stated)))

    def _write_out(self) -> None:
        title = self.tr("Write history of digs")
        name, _ = QFileDialog.getSaveFileName(self._window, title, "leakline-digs.jsonl", "JSON Lines (*.jsonl)")
        if name:
            self.ledger.write_out(Path(name))

    def _take_in(self) -> None:
        title = self.tr("Take in history of digs")
        name, _ = QFileDialog.getOpenFileName(self._window, title, "", "JSON Lines (*.jsonl);;* (*)")
        if name:
            self.ledger.take_in(Path(name))

    # --- what was typed before ---

    def _remembered(self, what: str) -> list[str]:
        try:
            texts = json.loads(self._preferences.values.layout.get(f"digs.{what}", "[]"))
        except ValueError:
            return []
        return [text for text in texts if isinstance(text, str)] if isinstance(texts, list) else []

    def _remember(self, result: DigResult) -> None:
        layout = dict(self._preferences.values.layout)
        for what, text in (("causes", result.cause), ("crews", result.dug_by)):
            known = self._remembered(what)
            if text:
                layout[f"digs.{what}"] = json.dumps([text, *(t for t in known if t != text)][:_MOST_REMEMBERED])
        if layout != self._preferences.values.layout:
            self._preferences.change(layout=layout)

    # --- showing ---

    def _show(self) -> None:
        if self.page is None:
            return
        if self._session.results is None:
            self._number = None
        self.page.set_writable(self._session.writable and self._session.results is not None)
        self._show_lines()
        self._show_form()

    def _show_lines(self) -> None:
        if self.page is not None:
            lines = self._words.lines(self._session, self.ledger.results)
            self.page.list.set_lines(lines, self._number)

    def _show_form(self) -> None:
        page, number, folder = self.page, self._number, self._session.folder
        if page is None:
            return
        if number is None or folder is None:
            page.form.setEnabled(False)
            return
        page.form.setEnabled(self._session.writable)
        known = self.ledger.results.get(number)
        missed = number == MISSED or (known is not None and known.missed)
        own = known.run_id if known is not None else None
        self._statements = () if missed else _different(folder.digs.statements(number), own)
        runs = [statement.run_id for statement in self._statements]
        chosen = runs.index(known.run_id) if known is not None and known.run_id in runs else 0
        defaults = self._words.causes()
        causes = [*self._remembered("causes"), *(c for c in defaults if c not in self._remembered("causes"))]
        page.form.set_choices(causes, self._remembered("crews"))
        titles = [self._words.statement(statement) for statement in self._statements]
        page.form.set_leak(self._words.title(self._session, number, known), titles, chosen, known, missed=missed)
        self._show_figured()

    def _show_figured(self) -> None:
        if self.page is not None and self._number is not None:
            found = self._figured()
            self.page.form.set_told(self._words.followed(found) if found.result else self._words.missing(found))

    def _show_history(self) -> None:
        if self.page is None:
            return
        from processing.dig_words import band_sentence, history_sentences, widened_sentence

        told, history, stated = quantities(), self.ledger.history, self._session.survey.stated
        sentences: list[str] = [widened_sentence(stated.widen, stated.kind, told)]
        if history is None:
            sentences.append(
                self.tr("No digs are known yet. Each one that is entered here makes the statement better.")
            )
        else:
            sentences += [*history_sentences(history, told), *(band_sentence(band, told) for band in history.bands)]
        if self.ledger.remembered.damaged:
            text = self.tr("Damaged lines of the history that were left out: {count}")
            sentences.append(text.format(count=self.ledger.remembered.damaged))
        self.page.set_history("\n".join(s for s in sentences if s), self._words.widening(stated, history))


def _different(statements: "tuple[Statement, ...]", own: int | None) -> "tuple[Statement, ...]":
    """Return the statements, newest first, without those that say what the one before says; run ``own`` always stays.

    What a dig is held against is frozen: a later run that happens to say the same must not take its place.
    """
    kept: list[Statement] = []
    for statement in statements:
        if not kept or _figures(kept[-1]) != _figures(statement):
            kept.append(statement)
        elif statement.run_id == own:
            kept[-1] = statement
    return tuple(kept)


def _figures(statement: "Statement") -> tuple[float, float, float]:
    candidate = statement.candidate
    return round(candidate.chainage_m, 2), round(candidate.chainage_low95_m, 2), round(candidate.chainage_high95_m, 2)
