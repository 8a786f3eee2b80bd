"""The life of a recording as the page drives it: devices open, monitoring, recording, stopped, and on to processing.

The recorder's calls go through one ordered thread; ten times a second its status is looked at. Nothing here waits.
"""

import logging
import sys
import time
from collections.abc import Callable
from pathlib import Path

from PySide6.QtCore import QObject, QTimer, Signal

from app.live_worker import Listener, LiveWorker
from app.ordered_calls import OrderedCalls
from app.recording_markers import RecordingMarkers
from app.recording_memory import recall, remembered
from app.recording_page import RecordingPage
from app.recording_parts import FoundDevices, RecorderLike, RecordingKit, RecordingWish
from app.recording_telling import RecordingTelling
from app.settings import PreferencesStore
from processing.errors import LeaklineError
from processing.live.check_sheet import CheckSheet
from processing.live.stream import RecordingState, RecordingStatus
from widgets.press_twice import PressTwice
from widgets.recording_words import clock_text

log = logging.getLogger(__name__)

LOOK_MS = 100
DEAF_S = 1.5  # after a start no press counts: a double click must not begin to stop it
_ENDED = (RecordingState.FAILED, RecordingState.STOPPED)
_BUSY = (RecordingState.RECORDING, RecordingState.STOPPING)


class RecordingControl(QObject):
    """Lives as long as its page; the window tells it when the page comes and goes."""

    told = Signal(str)
    changed = Signal()  # recording or not, markers
    process_asked = Signal(object)  # Path of a recording's folder
    folder_asked = Signal()
    looked = Signal()  # the status was looked at
    stopped = Signal()  # a recording has ended, its files are closed
    _ready = Signal()
    _stumbled = Signal(object)

    def __init__(
        self,
        page: RecordingPage,
        preferences: PreferencesStore,
        kit: RecordingKit,
        parent: QObject,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(parent)
        self._page, self._preferences, self._kit, self._monotonic = page, preferences, kit, monotonic
        self._calls = OrderedCalls("recorder", self)
        self._telling = RecordingTelling(page, self._calls, kit.battery, monotonic)
        self._calls.failed.connect(self._on_failure)
        self._recorder: RecorderLike | None = None
        self._worker: LiveWorker | None = None
        self._listeners: tuple[Listener, ...] = ()
        self._status: RecordingStatus | None = None
        self._busy = False  # a start or a stop is on its way
        self._in_front = False
        self._folder: Path | None = None
        self._let_sleep: Callable[[], None] | None = None
        self._chainage_m: float | None = None
        self.guard = PressTwice(monotonic)
        self.markers = RecordingMarkers(
            page.markers, self._calls, lambda: page.form.places, lambda: self._chainage_m, self, monotonic
        )
        self._timer = QTimer(self)
        self._timer.setInterval(LOOK_MS)
        self._timer.timeout.connect(self.look)
        values = preferences.values
        recall(page, values.recording | {"operator": values.recording.get("operator") or values.operator})
        self._connect()

    def _connect(self) -> None:
        page = self._page
        page.panel.pressed.connect(self.press)
        page.meter.clear_asked.connect(self.clear_clip)
        page.devices.changed.connect(self._on_devices)
        page.devices.search_asked.connect(self.search)
        page.form.changed.connect(self._remember)
        page.form.folder_asked.connect(self.folder_asked)
        page.process_asked.connect(self._process)
        page.another_asked.connect(self.another)
        self.markers.failed.connect(self._on_failure)
        self.markers.changed.connect(self._on_marks)
        self._ready.connect(self._draw)
        self._stumbled.connect(self._on_stumble)

    # --- what is asked from outside ---

    @property
    def recording(self) -> bool:
        """Whether something is being written, or about to be."""
        return self._busy or (self._status is not None and self._status.state in _BUSY)

    @property
    def elapsed_s(self) -> float:
        """How long it has been recorded."""
        return self._status.elapsed_s if self._status is not None else 0.0

    @property
    def status(self) -> RecordingStatus | None:
        """The last look at the recorder; None while no device is open."""
        return self._status

    @property
    def wish(self) -> RecordingWish:
        """What the page says now."""
        page = self._page
        return RecordingWish(
            page.form.survey, page.form.folder, page.devices.sound, page.devices.motion, page.form.planned_s
        )

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Hand every block to ``listener``, in the live views' thread, as long as devices are open; returns its end."""
        self._listeners = (*self._listeners, listener)

        def end() -> None:
            self._listeners = tuple(one for one in self._listeners if one is not listener)

        return end

    def enter(self) -> None:
        """The page has come to the front: look for devices, open them, draw."""
        self._in_front = True
        self._timer.start()
        if self._recorder is None and not self._folder:
            self.search()
        self._draw()
        self.look()

    def leave(self) -> None:
        """Another page is in front: let the devices go, unless they are recorded."""
        self._in_front = False
        self._remember()
        if not self.recording:
            self._release()
            self._timer.stop()

    def shut(self) -> None:
        """The window closes: let everything go, and wait for it."""
        self._timer.stop()
        self._remember()
        self._release()
        self._sleep_again()
        if not self._calls.finish(5.0):
            log.warning("the recorder would not close in time")

    # --- devices ---

    def search(self) -> None:
        """Look for devices again, then open the chosen ones."""
        if self.recording:
            return
        self._release()
        self._page.devices.search.setEnabled(False)
        self._calls.run(self._kit.find_devices, self._on_found, self._on_found_nothing)

    def _on_found(self, found: FoundDevices) -> None:
        self._page.devices.search.setEnabled(True)
        self._page.devices.set_found(found.sounds, found.ports)
        if found.trouble is not None:
            self._on_failure(found.trouble)
        self._open()

    def _on_found_nothing(self, error: Exception) -> None:
        self._page.devices.search.setEnabled(True)
        self._on_failure(error)
        self._open()

    def _on_devices(self) -> None:
        self._remember()
        if not self.recording:
            self._release()
            self._open()

    def _open(self) -> None:
        """Let the chosen devices run, so that they are seen before anything is recorded."""
        wish = self.wish
        if wish.is_empty or not self._in_front or self._recorder is not None or self._folder is not None:
            self.look()
            return
        try:
            recorder = self._kit.make_recorder(wish)
        except LeaklineError as error:
            self._on_failure(error)
            return
        self._recorder = recorder
        self._telling.forget()
        self._calls.run(recorder.open, lambda _: self._on_open(recorder), lambda e: self._on_not_open(recorder, e))

    def _on_open(self, recorder: RecorderLike) -> None:
        if recorder is not self._recorder:
            return
        survey = self.wish.survey
        worker = LiveWorker(
            recorder.feed,
            lambda: self._kit.make_view(survey),
            self._ready.emit,
            self._stumbled.emit,
            lambda: self._listeners,
        )
        self._page.forget_views()
        self._worker = worker
        worker.start()
        self.look()

    def _on_not_open(self, recorder: RecorderLike, error: Exception) -> None:
        if recorder is self._recorder:
            self._recorder = None
        self._on_failure(error)
        self.look()

    def _release(self) -> None:
        """Let the devices go; what is open is closed in the recorder's own thread."""
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.stop()
            self._calls.run(lambda: worker.join(5.0))
        recorder, self._recorder = self._recorder, None
        self._status = None
        if recorder is not None:
            self._calls.run(recorder.close)

    # --- recording ---

    def press(self) -> None:
        """The big button or its key: begin; or, the second time within three seconds, end."""
        if self._status is not None and self._status.state is RecordingState.RECORDING:
            if self.guard.press():
                self.stop()
            self.look()
        elif not self._busy and not self._folder:
            self.start()

    def start(self) -> None:
        """Record with what stands on the page now."""
        wish, recorder = self.wish, self._recorder
        if wish.is_empty or recorder is None or self._busy:
            return
        self._remember()
        self._busy = True
        self._calls.run(lambda: recorder.begin(wish), lambda _: self._on_start(recorder), self._on_not_started)
        self.look()

    def _on_start(self, recorder: RecorderLike) -> None:
        self._busy = False
        self._telling.forget()
        self.guard.reset(DEAF_S)
        if self._worker is not None:
            self._worker.order(lambda view: view.restart_path())
        self._let_sleep = self._kit.keep_awake()
        self.markers.begin(recorder)
        self._lock(locked=True)
        self._page.show_panel("markers")
        self.look()
        self.changed.emit()

    def _on_not_started(self, error: Exception) -> None:
        self._busy = False
        self._on_failure(error)
        self.look()

    def stop(self) -> None:
        """End the recording; its files are closed in the recorder's thread."""
        recorder = self._recorder
        if recorder is None or self._busy:
            return
        self._busy = True  # first: the end of the markers is told, and whoever hears it may ask to stop
        self.markers.end()
        self._calls.run(recorder.stop, self._on_stop, self._on_not_stopped)
        self.look()

    def _on_stop(self, folder: Path | None) -> None:
        self.look()  # still busy: what ended here is not taken for an end by itself
        self._busy = False
        elapsed = clock_text(self.elapsed_s)
        self._sleep_again()
        self._lock(locked=False)
        self.guard.reset(DEAF_S)
        self._folder = folder
        self._release()
        if folder is not None:
            self._preferences.remember_recent(folder)
            text = self.tr("Recorded {time} as {name}").format(time=elapsed, name=folder.name)
            self._page.show_done(text)
        self._show_button()
        self.stopped.emit()
        self.changed.emit()

    def _on_not_stopped(self, error: Exception) -> None:
        self._on_failure(error)
        self._on_stop(self._status.folder if self._status is not None else None)

    def another(self) -> None:
        """Open the devices again for the next recording."""
        self._folder = None
        self._page.show_done("")
        self._page.show_panel("setup")
        self._open()
        self.look()

    def _process(self) -> None:
        folder, self._folder = self._folder, None
        self._page.show_done("")
        if folder is not None:
            self.process_asked.emit(folder)

    def keep_sheet(self, sheet: CheckSheet) -> None:
        """Keep the sheet of a check with the recording under way."""
        recorder = self._recorder
        if recorder is not None:
            self._calls.run(lambda: recorder.keep_sheet(sheet))

    def clear_clip(self) -> None:
        """Put out the clip light."""
        if self._recorder is not None:
            self._calls.run(self._recorder.clear_clip)

    def set_folder(self, folder: Path) -> None:
        """Store recordings here."""
        self._page.form.set_folder(folder)
        self._remember()

    # --- looking ---

    def look(self) -> None:
        """Show how everything is now."""
        recorder = self._recorder
        status = recorder.status() if recorder is not None else None
        before, self._status = self._status, status
        if self._worker is not None and status is not None:
            self._worker.set_sample_rate(status.sound.sample_rate_hz)
        fault = recorder.sound_fault if recorder is not None else None
        self._telling.show(status, self.wish, fault, done=self._folder is not None)
        self._show_button()
        self.looked.emit()
        ran = before is not None and before.state is RecordingState.RECORDING
        if ran and status is not None and status.state in _ENDED and not self._busy:
            self.stop()  # it ended by itself: bring the page to the same end

    def _show_button(self) -> None:
        state = self._status.state if self._status is not None else None
        if self._busy and state is RecordingState.RECORDING:
            state = RecordingState.STOPPING
        ready = self._recorder is not None and not self._busy and not self._folder
        self._page.panel.show_state(state, armed=self.guard.armed, ready=ready)

    def _draw(self) -> None:
        if not self._in_front or self._worker is None:
            return
        picture = self._worker.take()
        if picture is not None:
            self._chainage_m = picture.pose.chainage_m if picture.pose is not None else None
            self._page.show_picture(picture)

    # --- the rest ---

    def _lock(self, *, locked: bool) -> None:
        self._page.devices.set_locked(locked=locked)
        self._page.form.set_locked(locked=locked)

    def _sleep_again(self) -> None:
        let_sleep, self._let_sleep = self._let_sleep, None
        if let_sleep is not None:
            let_sleep()

    def _on_marks(self, points: object) -> None:
        ties = tuple(point for point in self.markers.points if point.chainage_m is not None)
        if self._worker is not None:
            self._worker.order(lambda view: view.set_tie_points(ties))
        self._page.set_marks(self.markers.points)
        del points
        self.changed.emit()

    def _remember(self) -> None:
        values = {**self._preferences.values.recording, **remembered(self._page)}
        if values != self._preferences.values.recording:
            self._preferences.change(recording=values)

    def _on_failure(self, error: Exception) -> None:
        self._telling.fail(error)
        self.look()

    def _on_stumble(self, error: Exception) -> None:
        sys.excepthook(type(error), error, error.__traceback__)
