"""Brings the correlator's page to life: reads the recordings in a job, analyses at every change, listens, saves."""

import logging
from dataclasses import dataclass, replace

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QWidget

from app.correlator_files import CorrelatorFiles
from app.correlator_listening import Ears, Listening, MakeSink
from app.correlator_measuring import CorrelatorMeasuring
from app.correlator_page import CorrelatorPage
from app.correlator_showing import show_result
from app.devices.audio_output import SoundUnavailableError, open_sink
from app.jobs import Job, Jobs
from app.settings import PreferencesStore
from processing import messages
from processing.correlation.analysis import Choice, Correlation, Reading, analyse, longest_delay_s, read
from processing.correlation.correlogram import suppression
from processing.correlation.phase_fit import DispersionChoice
from processing.correlation.pipe import Pipe
from processing.correlation.recordings import Pair
from processing.correlation.report import CorrelationReport
from processing.correlation.session import CorrelatorSession
from processing.correlation.weighting import Band, Weighting
from processing.errors import LeaklineError

log = logging.getLogger(__name__)

SETTLE_MS = 60  # a dragged band asks for more results than can be had
_DISPERSION = 0.03


@dataclass(frozen=True)
class _Have:
    """What was read, and from what."""

    pair: Pair
    reading: Reading
    longest_s: float


class CorrelatorControl(QObject):
    """Owns the result and what was chosen; the recordings are those of ``files``."""

    told = Signal(str)
    result_changed = Signal()

    def __init__(
        self,
        jobs: Jobs,
        preferences: PreferencesStore,
        page: CorrelatorPage,
        language: str,
        parent: QWidget,
        make_sink: MakeSink = open_sink,
    ) -> None:
        super().__init__(parent)
        self._jobs, self._page, self._language = jobs, page, language
        self.files = CorrelatorFiles(jobs, preferences, page, language, parent)
        self.listening = Listening(make_sink, self)
        self._have: _Have | None = None
        self._result: Correlation | None = None
        self._choice = Choice()
        self._note = ""
        self._reading_job: Job | None = None
        self._analysing: Job | None = None
        self._again = False
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.setInterval(SETTLE_MS)
        self._timer.timeout.connect(self._analyse)
        self.measuring = CorrelatorMeasuring(jobs, page, language, self.pair, lambda: self._result, self)
        self._connect()
        self._show_sketch()

    @property
    def result(self) -> Correlation | None:
        """What is shown; None where there is nothing."""
        return self._result

    @property
    def busy(self) -> bool:
        """Whether something is still being computed."""
        return self._reading_job is not None or self._analysing is not None or self._timer.isActive()

    def leave(self) -> None:
        """Be silent: another page is in front."""
        self.listening.stop()

    def stop(self) -> None:
        """Let go of everything; the window closes."""
        self._timer.stop()
        self.listening.stop()

    def _connect(self) -> None:
        page, files = self._page, self.files
        files.changed.connect(self._read_again)
        files.failed.connect(self._fail)
        files.told.connect(self.told)
        files.session_opened.connect(self._take_session)
        files.save_asked.connect(lambda: files.save(self.session()))
        files.export_asked.connect(self._export)
        for thing in (page.clock, page.stretch):
            thing.changed.connect(self._read_again)
        page.pipe.changed.connect(self._pipe_changed)
        page.weighting.activated.connect(self._choose_weighting)
        page.auto_band.clicked.connect(lambda: self._set_band(None))
        page.coherence.band_moved.connect(self._move_band)
        page.coherence.band_dropped.connect(self._move_band)
        for field in (page.band_low, page.band_high):
            field.value_changed.connect(self._type_band)
        for check in (page.hum, page.resonances, page.bend):
            check.toggled.connect(self._choose_checks)
        page.reference.value_changed.connect(self._choose_checks)
        page.correlation.peak_chosen.connect(self.choose_peak)
        page.suppress.clicked.connect(self.suppress)
        page.restore.clicked.connect(self.restore)
        page.dropped.connect(lambda paths: files.take("b" if files.source("a") is not None else "a", paths))
        self.measuring.pipe_measured.connect(self._pipe_changed)
        self.measuring.clock_measured.connect(self._read_again)
        self.measuring.failed.connect(self._fail)
        for button, ears in ((page.listen_a, Ears.A), (page.listen_b, Ears.B), (page.listen_both, Ears.BOTH)):
            button.clicked.connect(lambda _checked=False, e=ears: self._listen(e))
        page.band_only.toggled.connect(self._listen_on)
        self.listening.changed.connect(self._show_listening)
        self.listening.failed.connect(self._listening_failed)

    # --- what is entered ---

    def pair(self) -> Pair | None:
        """Return the recordings with clocks and stretch as entered; None until both are there."""
        a, b = self.files.source("a"), self.files.source("b")
        if a is None or b is None:
            return None
        start, end = self._page.stretch.stretch()
        return Pair(a, b, self._page.clock.sync(), start, end)

    def session(self) -> CorrelatorSession:
        """Return everything that leads to this result again."""
        start, end = self._page.stretch.stretch()
        return CorrelatorSession(
            a=self.files.recording("a"),
            b=self.files.recording("b"),
            sync=self._page.clock.sync(),
            start_s=start,
            end_s=end,
            pipe=self._page.pipe.pipe(),
            choice=replace(self._choice, peak_s=None),
            note=self._note,
        )

    def _take_session(self, session: CorrelatorSession) -> None:
        page = self._page
        self._choice, self._note = session.choice, session.note
        self.measuring.forget()
        page.clock.set_sync(session.sync)
        page.stretch.set_stretch(session.start_s, session.end_s)
        page.pipe.set_pipe(session.pipe)
        page.weighting.setCurrentIndex(page.weighting.findData(session.choice.weighting.value))
        bend = session.choice.dispersion
        for check, on in (
            (page.hum, session.choice.band is None or session.choice.band.without_hum),
            (page.resonances, session.choice.divide_resonances),
            (page.bend, bend.sigma > 0.0 or bend.slope != 0.0),
        ):
            check.blockSignals(True)
            check.setChecked(on)
            check.blockSignals(False)
        page.reference.set_value(bend.reference_hz)
        page.restore.setEnabled(bool(session.choice.suppressed))
        self._show_sketch()

    # --- reading and analysing ---

    def _read_again(self) -> None:
        """Read the recordings, as soon as everything needed is there."""
        self.listening.stop()
        self._have = None
        self._cancel_reading()
        pair, pipe = self.pair(), self._page.pipe.pipe()
        if pair is None:
            self._clear()
            return
        try:
            pipe.checked()
        except LeaklineError as error:
            self._fail(error)
            return
        longest_s = longest_delay_s(pipe, pair.sync)

        def done(reading: Reading) -> None:
            self._have = _Have(pair, reading, longest_s)
            self._analyse()

        self._page.say(self.tr("Comparing…"), ())
        job = self._jobs.start(
            lambda progress: read(pair, pipe, progress),
            title=self.tr("Correlator"),
            on_success=done,
            on_failure=self._fail,
            on_cancel=lambda: self._page.say(self.tr("Stopped"), ()),
        )
        self._reading_job = job
        job.finished.connect(lambda: self._reading_ended(job))

    def _reading_ended(self, job: Job) -> None:
        if self._reading_job is job:
            self._reading_job = None

    def _cancel_reading(self) -> None:
        if self._reading_job is not None:
            self._reading_job.forget_callbacks()
            self._reading_job.cancel()
            self._reading_job = None

    def _pipe_changed(self) -> None:
        """A pipe with other travel times may need longer segments; else what was read is enough."""
        self._show_sketch()
        have, pair = self._have, self.pair()
        if have is None or pair is None:
            self._read_again()
            return
        try:
            needed_s = longest_delay_s(self._page.pipe.pipe().checked(), pair.sync)
        except LeaklineError as error:
            self._fail(error)
            return
        if needed_s > 2.0 * have.longest_s or 4.0 * needed_s > have.reading.spectra.grid.segment_s:
            self._read_again()
        else:
            self._timer.start()

    def _analyse(self) -> None:
        """Analyse in a job; while one runs, the next one waits and takes the newest choice."""
        have = self._have
        if have is None:
            return
        if self._analysing is not None:
            self._again = True
            return
        pipe, choice = self._page.pipe.pipe(), self._choice

        def done(result: Correlation) -> None:
            if self._have is have:
                self._show(result, pipe)

        job = self._jobs.start(
            lambda _progress: analyse(have.reading, pipe, have.pair.sync, choice),
            title=self.tr("Correlator"),
            on_success=done,
            on_failure=self._fail,
            quiet=True,
        )
        self._analysing = job
        job.finished.connect(self._analysis_ended)

    def _analysis_ended(self) -> None:
        self._analysing = None
        if self._again:
            self._again = False
            self._timer.start()

    # --- showing ---

    def _show(self, result: Correlation, pipe: Pipe) -> None:
        self._result = result
        show_result(self._page, result, pipe, self._choice, self.pair(), self._language)
        self.result_changed.emit()

    def _show_sketch(self) -> None:
        self._page.sketch.show_pipe(self._page.pipe.pipe(), None)

    def _fail(self, error: Exception) -> None:
        if not isinstance(error, LeaklineError):
            self._jobs.failed.emit(error)
            return
        self._clear()
        self._page.say(self.tr("No result"), (messages.error_sentence(error, self._language),))

    def _clear(self) -> None:
        self._result = None
        self._page.set_ready(ready=False)
        self._page.say("", ())
        self._page.sketch.show_pipe(self._page.pipe.pipe(), None)
        self.result_changed.emit()

    # --- choices ---

    def _change(self, choice: Choice) -> None:
        self._choice = choice
        self._page.restore.setEnabled(bool(choice.suppressed))
        if self._have is not None:
            self._timer.start()

    def _choose_weighting(self) -> None:
        self._change(replace(self._choice, weighting=Weighting(self._page.weighting.currentData())))

    def _move_band(self, low: float, high: float) -> None:
        self._set_band(Band(low, high, self._page.hum.isChecked()))

    def _type_band(self) -> None:
        low, high = self._page.band_low.value, self._page.band_high.value
        if low is not None and high is not None and high > 1.02 * low:
            self._set_band(Band(low, high, self._page.hum.isChecked()))

    def _set_band(self, band: Band | None) -> None:
        self._change(replace(self._choice, band=band))

    def _choose_checks(self) -> None:
        page, band = self._page, self._choice.band
        if band is None and not page.hum.isChecked() and self._result is not None:
            band = self._result.band  # an automatic band leaves tones out: hold it where it is
        if band is not None:
            band = replace(band, without_hum=page.hum.isChecked())
        bend = DispersionChoice(0.0, _DISPERSION if page.bend.isChecked() else 0.0, page.reference.value)
        if page.bend.isChecked() and self._choice.dispersion.slope != 0.0:
            bend = replace(self._choice.dispersion, reference_hz=page.reference.value)
        self._change(replace(self._choice, band=band, dispersion=bend, divide_resonances=page.resonances.isChecked()))

    def choose_peak(self, delay_s: float) -> None:
        """Take another peak for the leak."""
        self._change(replace(self._choice, peak_s=delay_s))

    def suppress(self) -> None:
        """Take the chosen peak out under the name that was typed, and go to the next."""
        result = self._result
        if result is None or result.chosen is None:
            return
        gone = suppression(result.correlogram, result.chosen, self._page.peak_name.text().strip())
        self._page.peak_name.clear()
        self._change(replace(self._choice, suppressed=(*self._choice.suppressed, gone), peak_s=None))

    def restore(self) -> None:
        """Put back what was taken out last."""
        self._change(replace(self._choice, suppressed=self._choice.suppressed[:-1], peak_s=None))

    # --- listening, writing ---

    def _listen(self, ears: Ears) -> None:
        if self.listening.ears is ears:
            self.listening.stop()
            self._show_listening()
        else:
            self._play(ears)

    def _listen_on(self) -> None:
        if self.listening.ears is not None:
            self._play(self.listening.ears)

    def _play(self, ears: Ears) -> None:
        pair, result = self.pair(), self._result
        if pair is None:
            return
        band = None
        if self._page.band_only.isChecked() and result is not None:
            band = (result.band.low_hz, result.band.high_hz)
        try:
            self.listening.play(pair, ears, band)
        except LeaklineError as error:
            self._fail(error)
        self._show_listening()

    def _show_listening(self) -> None:
        page = self._page
        for button, ears in ((page.listen_a, Ears.A), (page.listen_b, Ears.B), (page.listen_both, Ears.BOTH)):
            button.setChecked(self.listening.ears is ears)

    def _listening_failed(self, error: Exception) -> None:
        self._show_listening()
        if isinstance(error, LeaklineError):
            self._fail(error)
        elif isinstance(error, SoundUnavailableError | OSError):
            self.told.emit(self.tr("Nothing can be played: {reason}").format(reason=error))
        else:
            self._jobs.failed.emit(error)

    def _export(self) -> None:
        result, pair = self._result, self.pair()
        if result is not None and pair is not None:
            pipe = self._page.pipe.pipe()
            self.files.export(CorrelationReport(result, pair, pipe, self._choice, self._note, self._language))
