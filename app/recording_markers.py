"""Markers of a running recording: the moment is stored at the press, its name and chainage when they were typed."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from PySide6.QtCore import QObject, Signal

from app.ordered_calls import OrderedCalls
from app.recording_parts import RecorderLike
from processing.survey import TiePoint
from widgets.marker_line import MarkerPanel
from widgets.recording_form import ExpectedPlaces
from widgets.recording_words import clock_text


@dataclass
class _Mark:
    """A marker; ``point`` is None until the recorder has stored it, and is set by the thread that did."""

    name: str
    host_s: float
    point: TiePoint | None = None


class RecordingMarkers(QObject):
    """Belongs to one page; :meth:`begin` gives it the recorder of each new recording."""

    changed = Signal(object)  # tuple[TiePoint, ...]
    failed = Signal(object)  # Exception

    def __init__(
        self,
        panel: MarkerPanel,
        calls: OrderedCalls,
        places: Callable[[], ExpectedPlaces],
        where_m: Callable[[], float | None],
        parent: QObject,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        super().__init__(parent)
        self._panel, self._calls, self._places, self._where_m = panel, calls, places, where_m
        self._monotonic = monotonic
        self._recorder: RecorderLike | None = None
        self._marks: list[_Mark] = []
        self._asked: _Mark | None = None  # whose line is open
        self._number = 0
        panel.mark_asked.connect(self.mark)
        panel.undo_asked.connect(self.undo)
        panel.line.named.connect(self._name)
        panel.line.given_up.connect(self._close_line)

    @property
    def points(self) -> tuple[TiePoint, ...]:
        """The markers that are stored, in the order of their moments."""
        return tuple(mark.point for mark in self._marks if mark.point is not None)

    @property
    def running(self) -> bool:
        """Whether a recording runs that can be marked."""
        return self._recorder is not None

    def begin(self, recorder: RecorderLike) -> None:
        """A recording has begun: there are no markers yet."""
        self._recorder, self._marks, self._number = recorder, [], 0
        self._panel.set_ready(ready=True)
        self._show()

    def end(self) -> None:
        """It has ended; a line that is still open is stored as it stands."""
        self.finish_line()
        self._recorder = None
        self._panel.set_ready(ready=False)
        self._show()

    def mark(self) -> None:
        """Keep this very moment, then ask for its name."""
        host_s, recorder = self._monotonic(), self._recorder
        if recorder is None:
            return
        self.finish_line()
        self._number += 1
        mark = _Mark(self.tr("marker {number}").format(number=self._number), host_s)
        self._marks.append(mark)

        def store() -> None:
            mark.point = recorder.mark(mark.name, host_s=host_s)

        self._calls.run(store, lambda _: self._show(), lambda error: self._refused(mark, error))
        self._asked = mark
        places = self._places()
        moment = clock_text(recorder.status().elapsed_s)
        title = self.tr("{name} at {time}: what is it?").format(name=mark.name, time=moment)
        self._panel.line.ask(title, places, self._likely(places))

    def undo(self) -> None:
        """Take the last marker back."""
        recorder = self._recorder
        if recorder is None or not self._marks:
            return
        mark = self._marks.pop()
        if self._asked is mark:
            self._close_line()

        def take_back() -> None:
            if mark.point is not None:
                recorder.unmark()

        self._calls.run(take_back, lambda _: self._show(), self.failed.emit)
        self._show()

    def finish_line(self) -> None:
        """Store what stands in the open line, if there is one."""
        line = self._panel.line
        if self._asked is not None:
            self._name(line.name.text().strip(), line.chainage.value)

    # --- the line ---

    def _name(self, name: str, chainage_m: float | None) -> None:
        mark, recorder = self._asked, self._recorder
        self._close_line()
        if mark is None or recorder is None or not (name or chainage_m is not None):
            return
        mark.name = name or mark.name

        def amend() -> None:
            if mark.point is not None:  # else it could not be stored, and that was told
                mark.point = recorder.amend(mark.point, replace(mark.point, name=mark.name, chainage_m=chainage_m))

        self._calls.run(amend, lambda _: self._show(), self.failed.emit)

    def _close_line(self) -> None:
        self._asked = None
        had_focus = self._panel.line.isAncestorOf(self._panel.window().focusWidget() or self._panel)
        self._panel.line.hide()
        if had_focus:
            self._panel.window().setFocus()  # so that the next M marks instead of being typed

    def _likely(self, places: ExpectedPlaces) -> int | None:
        """Return which of the places it is probably: the nearest that was not marked yet, else the next in order."""
        taken = {mark.name for mark in self._marks}
        free = [number for number, (name, _) in enumerate(places) if name not in taken]
        here_m = self._where_m()
        away: list[tuple[float, int]] = []
        for number in free:
            chainage_m = places[number][1]
            if chainage_m is not None and here_m is not None:
                away.append((abs(chainage_m - here_m), number))
        if away:
            return min(away)[1]
        return free[0] if free else None

    def _refused(self, mark: _Mark, error: Exception) -> None:
        if mark in self._marks:
            self._marks.remove(mark)
        if self._asked is mark:
            self._close_line()
        self._show()
        self.failed.emit(error)

    def _show(self) -> None:
        self._panel.set_marks(self.points)
        self.changed.emit(self.points)
