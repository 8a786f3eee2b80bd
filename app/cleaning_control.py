"""Switches sound and picture between raw and cleaned, and tells what the cleaning does in the visible span."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer

from app.clean_tiles import LONGEST_S, CleanableTiles
from app.jobs import Job, Jobs
from app.player import Player
from app.survey_session import SurveySession
from app.view_data import tiles
from processing import messages
from processing.progress import Progress
from processing.sound.cleanable import NotCleaned, why_not_cleaned
from widgets.latest_loader import LatestLoader
from widgets.vocabulary import number

if TYPE_CHECKING:
    from app.review_page import ReviewPage
    from processing.results import Results
    from processing.sound.cleaning import CleaningContext, CleaningFigures

_REST_MS = 400  # the view must rest so long before figures are worth the work


class CleaningControl(QObject):
    """One switch for the ear and the eye. What it needs is learnt from the run when it is first used, in a job."""

    def __init__(
        self,
        session: SurveySession,
        jobs: Jobs,
        page: "ReviewPage",
        player: Player,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._page, self._player = session, jobs, page, player
        self._language = language
        self._tiles: CleanableTiles | None = None
        self._context: CleaningContext | None = None
        self._reason = ""
        self._on = False
        self._job: Job | None = None
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._tell)
        self._rest = QTimer(self)
        self._rest.setSingleShot(True)
        self._rest.setInterval(_REST_MS)
        self._rest.timeout.connect(self._ask)
        page.playback.cleaned_asked.connect(self.toggle)
        session.results_changed.connect(self._on_results)
        session.cursor.range_changed.connect(self._on_range)
        self._on_results()

    @property
    def on(self) -> bool:
        """Whether cleaned sound is heard and seen."""
        return self._on and self._context is not None

    def toggle(self) -> None:
        """Change between raw and cleaned; what plays goes on from where it is."""
        if self._session.results is None or self._reason:
            return
        self._on = not self._on
        if self._on and self._context is None:
            self._learn(self._session.results)
        self._show()

    def stop(self) -> None:
        """Let the present run go: nothing reads it any more."""
        self._rest.stop()
        self._loader.stop()
        if self._job is not None:
            self._job.forget_callbacks()
            self._job.cancel()
            self._job = None

    def _on_results(self) -> None:
        self.stop()
        self._context, self._reason = None, ""
        results = self._session.results
        raw = tiles(results)
        self._tiles = CleanableTiles(raw) if raw is not None else None
        if self._tiles is not None:
            self._page.spectrogram.set_source(self._tiles)
        if results is None:
            self._on = False
        else:
            self._refuse(why_not_cleaned(results))
            if self._on:
                self._learn(results)
        self._show()

    def _learn(self, results: "Results") -> None:
        if self._job is not None:
            return

        def learn(progress: Progress) -> "CleaningContext | NotCleaned":
            from processing.sound.cleaning import prepare_cleaning

            return prepare_cleaning(results, progress)

        self._job = self._jobs.start(
            learn,
            title=self.tr("Learning the noise of rolling"),
            on_success=self._learnt,
            on_failure=self._failed,
            on_cancel=self._cancelled,
        )

    def _learnt(self, found: "CleaningContext | NotCleaned") -> None:
        self._job = None
        if isinstance(found, NotCleaned):
            self._refuse(found)
        else:
            self._context = found
        self._show()

    def _failed(self, error: Exception) -> None:
        self._cancelled()
        self._jobs.failed.emit(error)

    def _cancelled(self) -> None:
        self._job, self._on = None, False
        self._show()

    def _refuse(self, why: "NotCleaned | None") -> None:
        if why is not None:
            self._on = False
            self._reason = messages.text("reasons", why.value, self._language)

    def _show(self) -> None:
        context = self._context if self._on else None
        self._page.playback.set_cleaned(on=self._on, reason=self._reason)
        self._player.set_cleaning(context)
        if self._tiles is not None and self._tiles.set_cleaning(context):
            self._page.spectrogram.reload()
        if context is None:
            self._loader.cancel()
            self._page.playback.set_note("")
        self._on_range()

    # --- what it does in the visible span ---

    def _on_range(self) -> None:
        if self.on:
            self._rest.start()
        else:
            self._rest.stop()

    def _ask(self) -> None:
        results, context = self._session.results, self._context
        audio = results.recording.audio if results is not None else None
        if results is None or context is None or audio is None or not self.on:
            return
        first_s, last_s = (float(results.clock.to_audio(t)) for t in self._session.cursor.range_s)
        band_hz = results.settings.sound.band_low_hz, results.settings.sound.band_high_hz

        def read() -> "CleaningFigures":
            from processing.sound.cleaning import figures

            return figures(audio, context, first_s, last_s, band_hz)

        self._loader.request(read)

    def _tell(self, found: "CleaningFigures") -> None:
        if not self.on:
            return
        text = self.tr("rolling noise {change} dB, {turns} turns/s").format(
            change=number(-found.removed_db, 1), turns=number(found.turns_hz, 2)
        )
        if found.bumps:
            more = self.tr("{count} bumps ducked, {felt} of them felt")
            text += ", " + more.format(count=found.bumps, felt=found.felt)
        start_s, end_s = self._session.cursor.range_s
        if end_s - start_s > LONGEST_S:
            closer = self.tr("the picture is cleaned where less than {seconds} s are shown")
            text += "; " + closer.format(seconds=number(LONGEST_S, 0))
        self._page.playback.set_note(text)
