"""The first look at a sound that has not been processed: a rough picture at once, which the running pass makes fine."""

import logging
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal

from app import opening
from app.jobs import Job, Jobs
from app.survey_session import SurveySession
from processing.errors import LeaklineError

if TYPE_CHECKING:
    from app.review_page import ReviewPage
    from processing.sound.coarse import CoarseTiles

log = logging.getLogger(__name__)

GRACE_MS = 150  # what lies in the cache is there sooner and needs no first look
EVERY_MS = 700


class FirstSound(QObject):
    """Opens a sound beside the processing and shows it until there are results."""

    changed = Signal()  # there is something to look at, or not any more
    told = Signal(str)  # how far the listening is; empty when there is no first look

    def __init__(self, session: SurveySession, jobs: Jobs, page: "ReviewPage", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._jobs, self._page = session, jobs, page
        self._look: opening.FirstLook | None = None
        self._tiles: CoarseTiles | None = None
        self._job: Job | None = None
        self._seen = 0.0
        self._grace, self._timer = QTimer(self), QTimer(self)
        self._grace.setSingleShot(True)
        self._grace.setInterval(GRACE_MS)
        self._grace.timeout.connect(self._open)
        self._timer.setInterval(EVERY_MS)
        self._timer.timeout.connect(self._renew)
        session.opened.connect(self.forget)
        session.results_changed.connect(self.forget)

    @property
    def is_shown(self) -> bool:
        """Whether there is a first look at a sound without results."""
        return self._tiles is not None

    def look_at(self, look: opening.FirstLook) -> None:
        """Show the sound of a recording, unless its results come at once, or there are some already."""
        if self._session.results is None:
            self.forget()
            self._look = look
            self._grace.start()

    def forget(self) -> None:
        """End the first look: results are shown instead, or another survey is."""
        self._grace.stop()
        self._timer.stop()
        if self._job is not None:
            self._job.forget_callbacks()
        shown, self._look, self._tiles, self._job = self.is_shown, None, None, None
        if shown:
            self.told.emit("")
            self.changed.emit()

    def _open(self) -> None:
        look = self._look
        if look is not None:
            self._job = self._jobs.start(
                lambda _progress: opening.coarse_sound(look),
                title=self.tr("A first look at the sound"),
                on_success=self._show,
                on_failure=self._leave,
                quiet=True,
            )

    def _leave(self, error: Exception) -> None:
        self._job = None
        if not isinstance(error, LeaklineError):
            raise error
        log.info("no first look at the sound: %s", error)  # the import says why, where it can be mended

    def _show(self, tiles: "CoarseTiles | None") -> None:
        self._job = None
        if tiles is None:
            return
        self._tiles, self._seen = tiles, tiles.known
        self._page.show_sound(tiles)
        self._timer.start()
        self._renew()
        self.changed.emit()

    def _renew(self) -> None:
        """Read the picture again where more of it is known; say how far it is."""
        look, tiles = self._look, self._tiles
        if look is None or tiles is None:
            return
        known, picture = tiles.known, self._page.spectrogram
        if known != self._seen and picture.is_sharp:  # else a read is under way, and asking again would void it
            self._seen = known
            picture.reload()
        share = look.growing.share
        text = self.tr("A first look at the sound: one moment here and there, until it is processed")
        if share > 0:
            text = self.tr("Still listening, {percent} %: beyond that it is a first look, one moment here and there")
        self.told.emit(text.format(percent=int(100 * share)))
