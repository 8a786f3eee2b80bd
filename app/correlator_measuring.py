"""Measuring on site with the correlator: the speed of sound by taps, the clocks by taps or by knocks on both."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app.correlator_page import CorrelatorPage
from app.jobs import Jobs
from processing import messages
from processing.correlation.events import offset_of_event, sync_of_events
from processing.correlation.pipe import Pipe
from processing.correlation.recordings import Pair, Sync, SyncKind
from processing.correlation.speed import Tap, speed_of_both_ends, speed_of_tap
from processing.errors import LeaklineError
from widgets.plot_scale import number_text

if TYPE_CHECKING:
    from processing.correlation.analysis import Correlation
    from processing.correlation.events import EventOffset
    from processing.correlation.speed import MeasuredSpeed

BEYOND_M = 1.0  # how far beyond a sensor was tapped does not matter
APART_S = 20.0  # knocks nearer to each other in time tell nothing of a drift: the later ones replace the earlier


class CorrelatorMeasuring(QObject):
    """Takes the chosen peak for a tap; what follows is written into the page's pipe and clock fields."""

    pipe_measured = Signal()
    clock_measured = Signal()
    failed = Signal(object)  # Exception

    def __init__(
        self,
        jobs: Jobs,
        page: CorrelatorPage,
        language: str,
        pair: Callable[[], Pair | None],
        result: "Callable[[], Correlation | None]",
        parent: QObject,
    ) -> None:
        super().__init__(parent)
        self._jobs, self._page, self._language = jobs, page, language
        self._pair, self._result = pair, result
        self._taps: dict[str, Tap] = {}
        self._tapped_s = 0.0  # seconds of A
        self._events: tuple[EventOffset, ...] = ()
        self._events_of: object = None
        page.taps.tap_asked.connect(self.measure_speed)
        page.clock.event_asked.connect(self.find_event)

    def forget(self) -> None:
        """Other recordings, other taps."""
        self._taps.clear()

    def measure_speed(self, where: str) -> None:
        """Take the chosen peak for a tap beyond ``a`` or ``b`` or at a ``place``; with both ends, the clock follows."""
        result, pipe, pair = self._result(), self._page.pipe.pipe(), self._pair()
        if result is None or result.chosen is None or pair is None:
            return
        place = {"a": -BEYOND_M, "b": pipe.length_m + BEYOND_M}.get(where, self._page.taps.place.value)
        if place is None:
            self._page.taps.say(self.tr("Enter at which metre from A you tapped."))
            return
        tap = Tap(place, result.delay_s, result.delay_sigma_s)
        self._tapped_s = float(result.spectra.part_s.mean())
        try:
            if where != "place":
                self._taps[where] = tap
            if {"a", "b"} <= self._taps.keys() and where != "place":
                measured = speed_of_both_ends(pipe, self._taps["a"], self._taps["b"])
            else:
                measured = speed_of_tap(pipe, tap, pair.sync.sigma_s)
        except LeaklineError as error:
            self._page.taps.say(messages.error_sentence(error, self._language))
            return
        self._take_speed(pipe, measured)

    def _take_speed(self, pipe: Pipe, measured: "MeasuredSpeed") -> None:
        page, locale = self._page, self._page.locale()
        text = self.tr("{speed} ± {sigma} m/s, taken over.").format(
            speed=number_text(measured.mean_mps, 1, locale), sigma=number_text(measured.mean_sigma_mps, 1, locale)
        )
        page.pipe.set_pipe(pipe.scaled(measured.factor, measured.part_sigma))
        if measured.offset_s is None or measured.offset_sigma_s is None:
            page.taps.say(text)
            self.pipe_measured.emit()
            return
        sync = page.clock.sync()
        offset_s = sync.offset_s + measured.offset_s
        page.clock.set_sync(Sync(SyncKind.TAPS, offset_s, measured.offset_sigma_s, sync.drift_ppm, self._tapped_s))
        text += " " + self.tr("Clock offset {offset} ms.").format(offset=number_text(1e3 * offset_s, 2, locale))
        self._taps.clear()
        page.taps.say(text)
        self.clock_measured.emit()

    def find_event(self) -> None:
        """Look in the chosen stretch for knocks that both recorders heard side by side."""
        pair = self._pair()
        if pair is None:
            return
        first, last = self._page.stretch.stretch()
        end = pair.a.duration_s if last is None else last
        bare = Pair(pair.a, pair.b)

        def done(found: "EventOffset") -> None:
            # knocks before and after tell the drift too; those of other recordings tell nothing
            files = (pair.a.parts, pair.b.parts)
            known = self._events if files == self._events_of else ()
            apart = tuple(event for event in known if abs(event.moment_s - found.moment_s) > APART_S)
            self._events, self._events_of = (*apart, found), files
            self._page.clock.set_sync(sync_of_events(self._events))
            self._page.stretch.set_stretch(0.0, None)
            self.clock_measured.emit()

        self._jobs.start(
            lambda progress: offset_of_event(bare, first, end, progress),
            title=self.tr("Looking for the knocks"),
            on_success=done,
            on_failure=self.failed.emit,
        )
