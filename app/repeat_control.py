"""Compares the open survey with another run of its pipe: the page of repeat runs, built when asked for (Ctrl+L)."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app.appearance import theme_named
from app.jobs import Job
from app.page_host import PageHost
from app.repeat_listening import RepeatListening
from app.services import Services
from app.survey_cards import is_there
from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.position.distance import times_at
from processing.progress import Progress
from widgets.plot_theme import Theme
from widgets.units import quantities

if TYPE_CHECKING:
    from processing.quantities import Quantities
    from processing.repeat_runs import ComparedRun, Comparison, Place
    from widgets.repeat_page import RepeatPage

PAGE = "repeat"
SIGNS = {"same": "=", "new": "+", "gone": "−", "moved": "↔", "not_heard": "?"}
LISTENED_M = 6.0  # around a place


class RepeatControl(QObject):
    """Holds the comparison as long as the survey's results; ``comparison`` is there for the report."""

    told = Signal(str)
    open_asked = Signal(object)  # Path of a survey that was never processed
    changed = Signal()  # another comparison, or none

    def __init__(self, services: Services, host: PageHost, language: str, window: QWidget) -> None:
        super().__init__(window)
        self._session, self._jobs, self._preferences = services.session, services.jobs, services.preferences
        self._host, self._window, self._language = host, window, language
        self.page: RepeatPage | None = None
        self.comparison: Comparison | None = None  # as shown
        self._full: Comparison | None = None  # with what was rejected since
        self._other: Path | None = None
        self._turned: bool | None = None
        self._before = "leaks"
        self._job: Job | None = None
        self._heard: int | None = None
        self.listening = RepeatListening(services.make_sink, self)
        self.listening.ended.connect(lambda: self._hear(None))
        self.listening.failed.connect(self._tell)
        host.openers[PAGE] = self.toggle
        host.stack.currentChanged.connect(self._on_page)
        services.session.results_changed.connect(self._forget)
        services.session.opened.connect(self._forget)
        services.session.cursor.moved.connect(self._on_cursor)

    # --- the door ---

    def toggle(self) -> None:
        """Show the page; where it is in front already, go back to what was there before."""
        if self._session.results is None:
            self.told.emit(self.tr("Open and process a survey first, then compare it with another run of its pipe."))
            return
        if self._host.current() == PAGE:
            self._host.show(self._before)
            return
        if self.page is None:
            self._build()
        self._before = self._host.current()
        self._show_others()
        if self._full is not None:
            self.comparison = self.present()
            self._show()
        elif self._job is None:
            self._show_nothing(self.tr("Choose another run of this pipe: a recent survey, or its folder."))
        self._host.show(PAGE)
        assert self.page is not None  # built just now
        (self.page.table if self.comparison is not None else self.page).setFocus()

    def stop(self) -> None:
        """Leave no work behind: the window closes."""
        self.listening.stop()
        self._drop_job()

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        if self.page is not None:
            self.page.apply_theme(theme)

    def _build(self) -> None:
        from widgets.repeat_page import RepeatPage

        page = self.page = RepeatPage(theme_named(self._preferences.values.theme))
        self._host.add(PAGE, page)
        page.back_asked.connect(self.toggle)
        page.other_chosen.connect(lambda text: self.compare_with(Path(text)))
        page.browse_asked.connect(self._browse)
        page.open_asked.connect(self._open_other)
        page.turned.connect(self._turn)
        page.place_chosen.connect(self._choose)
        page.go_asked.connect(self._go)
        page.listen_asked.connect(self._listen)
        page.switch_asked.connect(self._switch)
        page.export_asked.connect(self._export)
        page.view.cursor_asked.connect(self._set_cursor)

    def _on_page(self, _row: int) -> None:
        if self.page is not None and self._host.stack.currentWidget() is not self.page:
            self._hear(None)

    # --- comparing ---

    def for_report(self) -> "Callable[[Quantities], tuple[str, ...]] | None":
        """Return what says the changes in a report's language and units; None where nothing was compared."""
        found = self.present()
        if found is None:
            return None
        from processing.repeat_words import report_sentences

        return partial(report_sentences, found)

    def present(self) -> "Comparison | None":
        """Return the comparison with what the operator decides and marks now; None where nothing was compared."""
        if self._full is None:
            return None
        from processing.repeat_runs import redecided

        return redecided(self._full, [row.candidate for row in self._session.rows()], self._session.decisions)

    def compare_with(self, path: Path, *, is_reversed: bool | None = None) -> None:
        """Put another survey beside the open one."""
        session = self._session
        folder, results = session.folder, session.results
        if folder is None or results is None:
            return
        from processing.repeat_runs import ComparedRun

        self._hear(None)
        self._drop_job()
        self._other, self._turned = path, is_reversed
        info = session.survey.info
        results = replace(results, candidates=tuple(row.candidate for row in session.rows()))
        name = info.name or folder.path.stem
        ours = ComparedRun(name, info.date, results, dict(session.decisions), folder.imported_utc)
        self._show_nothing(self.tr("Comparing …"))
        self._job = self._jobs.start(
            partial(_compared, ours, path, folder.identity, is_reversed),
            title=self.tr("Comparing two runs"),
            on_success=self._take,
            on_failure=self._failed,
        )

    def _take(self, comparison: "Comparison") -> None:
        self._job = None
        self.comparison = self._full = comparison
        self._turned = comparison.alignment.is_reversed
        self._show()
        self.changed.emit()

    def _failed(self, error: Exception) -> None:
        self._job = None
        if not isinstance(error, LeaklineError):
            raise error
        text = messages.error_sentence(error, self._language)
        self._show_nothing(text, may_open=error.code is ErrorCode.REPEAT_NOT_PROCESSED)

    def _tell(self, error: Exception) -> None:
        text = messages.error_sentence(error, self._language) if isinstance(error, LeaklineError) else str(error)
        self.told.emit(text)

    def _turn(self, turned: bool) -> None:
        if self._other is not None:
            self.compare_with(self._other, is_reversed=turned)

    def _browse(self) -> None:
        start = str(self._session.folder.path.parent) if self._session.folder is not None else ""
        title = self.tr("Another run of this pipe")
        chosen = QFileDialog.getExistingDirectory(self._window, title, start)
        if chosen:
            self.compare_with(Path(chosen))
            self._show_others()

    def _open_other(self) -> None:
        if self._other is not None:
            self.open_asked.emit(self._other)

    def _drop_job(self) -> None:
        if self._job is not None:
            self._job.forget_callbacks()
            self._job.cancel()
            self._job = None

    def _forget(self) -> None:
        self._hear(None)
        self._drop_job()
        if self.comparison is not None or self._other is not None:
            self.comparison = self._full = self._other = None
            self.changed.emit()
        if self.page is not None:
            self._show_others()
            self._show_nothing("")

    # --- one place ---

    def _place(self) -> "Place | None":
        if self.page is None or self.comparison is None:
            return None
        row = self.page.table.currentRow()
        return self.comparison.places[row] if 0 <= row < len(self.comparison.places) else None

    def _choose(self, _row: int) -> None:
        place = self._place()
        if place is None:
            return
        if place.ours is not None:
            self._session.select(place.ours.id)
        self._set_cursor(place.chainage_m)
        if self._heard is not None:
            self._hear(self._heard)

    def _go(self) -> None:
        """Show the place on the leaks page."""
        place = self._place()
        if place is not None:
            self._choose(0)
            self._host.show("leaks")

    def _set_cursor(self, chainage_m: float) -> None:
        results = self._session.results
        if results is not None and results.track is not None:
            self._session.cursor.set_time(float(times_at(results.track, chainage_m)[0][0]))

    def _on_cursor(self, _time_s: float) -> None:
        if self.page is not None and self.comparison is not None:
            self.page.view.set_cursor(self._session.cursor.chainage_m)

    # --- listening ---

    def _listen(self, run: int) -> None:
        self._hear(None if self._heard == run else run)

    def _switch(self) -> None:
        """The one run, then the other, at the same place."""
        self._hear(1 - self._heard if self._heard is not None else 0)

    def _hear(self, run: int | None) -> None:
        self.listening.stop()
        place, comparison = self._place(), self.comparison
        self._heard = None
        if run is not None and place is not None and comparison is not None:
            results = (comparison.ours, comparison.theirs)[run].results
            at = place.chainage_m if run == 0 else float(comparison.alignment.to_theirs(place.chainage_m)[0])
            assert results.track is not None  # compared by its path
            ends = times_at(results.track, [at - LISTENED_M / 2, at + LISTENED_M / 2])
            start, end = sorted((float(ends[0][0]), float(ends[1][1])))
            if self.listening.play(results, start, end):
                self._heard = run
        if self.page is not None:
            self.page.set_heard(self._heard)

    # --- showing and writing ---

    def _show_others(self) -> None:
        if self.page is None or self._session.folder is None:
            return
        here = self._session.folder.path
        recent = [Path(text) for text in self._preferences.values.recent]
        known = [path for path in recent if path != here and is_there(path)]
        if self._other is not None and self._other not in known:
            known.insert(0, self._other)
        self.page.set_others([(str(path), path.stem) for path in known], str(self._other or ""))

    def _show_nothing(self, words: str, *, may_open: bool = False) -> None:
        if self.page is None:
            return
        import numpy as np

        self.comparison = self._full = None
        self.page.view.set_content(np.empty(0), (), np.empty((0, 2)), ())
        self.page.view.set_hint(words or self.tr("Choose another run of this pipe"))
        self.page.set_lines(())
        self.page.set_words("", may_open=may_open)
        self.page.set_ready(ready=False)

    def _show(self) -> None:
        from processing.repeat_words import basis_sentences, change_sentences, change_word, growth_text, name_of
        from widgets.repeat_page import RepeatLine
        from widgets.repeat_view import RepeatMark, RepeatStrip

        page, found = self.page, self.comparison
        if page is None or found is None:
            return
        told = quantities()
        names = [f"{run.name}, {told.day(run.date)}" if run.date else run.name for run in (found.ours, found.theirs)]
        strips = [
            RepeatStrip(name, strip.picture_db, strip.excess_db)
            for name, strip in zip(names, found.strips, strict=True)
        ]
        marks = [RepeatMark(p.chainage_m, p.half95_m, SIGNS[p.change.value]) for p in found.places]
        page.view.set_hint("")
        page.view.set_content(found.chainage_m, strips, found.bands_hz, marks)
        page.view.set_cursor(self._session.cursor.chainage_m)
        ours, theirs = found.ours, found.theirs
        differ = ours.name != theirs.name
        page.set_names(*((r.name if differ else told.day(r.date) or r.name) for r in (ours, theirs)))
        self._show_others()
        page.set_ready(ready=True)
        page.set_turned(found.alignment.is_reversed)
        sentences = (*change_sentences(found, told), *basis_sentences(found, told))
        page.set_words("\n".join(sentences))
        page.set_lines(
            [
                RepeatLine(
                    name_of(place),
                    f"{told.place(place.chainage_m)} ± {told.length(place.half95_m)}",
                    f"{SIGNS[place.change.value]} {change_word(place, self._language)}",
                    growth_text(place, told).removeprefix(", "),
                )
                for place in found.places
            ]
        )

    def _export(self) -> None:
        if self.comparison is None:
            return
        from processing.repeat_words import write_csv

        title = self.tr("Write the changes")
        name, _ = QFileDialog.getSaveFileName(self._window, title, "leakline-changes.csv", "CSV (*.csv)")
        if not name:
            return
        try:
            write_csv(Path(name), self.comparison)
        except LeaklineError as error:
            self.told.emit(messages.error_sentence(error, self._language))
        else:
            self.told.emit(self.tr("Written to {folder}").format(folder=name))


def _compared(
    ours: "ComparedRun", path: Path, identity: str, is_reversed: bool | None, progress: Progress
) -> "Comparison":
    from app.repeat_source import other_run
    from processing.repeat_runs import compare

    return compare(ours, other_run(path, identity, progress), is_reversed=is_reversed)
