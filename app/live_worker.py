"""Turns the recorder's blocks into pictures in a thread of its own, at most thirty a second, never more than one ahead.

The window takes a picture when it has time; the next one is made only then, and holds all that came meanwhile. So a
window that is slow, hidden or blocked costs nothing but pictures.
"""

import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from app.recording_parts import Block, Feed, ViewLike

if TYPE_CHECKING:
    from processing.live.picture import LivePicture

log = logging.getLogger(__name__)

FRAME_S = 1.0 / 30.0
LOOK_EVERY_S = 0.008  # how often the feed is looked at: a part of the delay from sample to screen

Listener = Callable[[Block], None]


class LiveWorker:
    """Runs from :meth:`start` to :meth:`stop`; ``on_ready``, ``on_fault`` and the listeners are called from its thread.

    ``listeners`` are who else hears every block.
    """

    def __init__(
        self,
        feed: Feed,
        make_view: Callable[[], ViewLike],
        on_ready: Callable[[], None],
        on_fault: Callable[[Exception], None],
        listeners: Callable[[], Sequence[Listener]] = tuple,
    ) -> None:
        self._feed, self._make_view, self._on_ready, self._on_fault = feed, make_view, on_ready, on_fault
        self._listeners = listeners
        self._end = threading.Event()
        self._lock = threading.Lock()
        self._orders: deque[Callable[[ViewLike], None]] = deque()
        self._wanted = True
        self._made: LivePicture | None = None
        self._drawn: LivePicture | None = None
        self._rate_hz = 0.0
        self._told_fault = False
        self._thread = threading.Thread(target=self._run, name="live-views", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self) -> None:
        """End soon; the callbacks may come once more."""
        self._end.set()

    def join(self, timeout_s: float) -> None:
        """Wait for the end."""
        self._thread.join(timeout_s)

    def take(self) -> "LivePicture | None":
        """Return the picture that is ready, and ask for the next one; None while there is none."""
        with self._lock:
            picture, self._made = self._made, None
            if picture is not None:
                self._drawn, self._wanted = picture, True
            return picture

    def order(self, what: Callable[[ViewLike], None]) -> None:
        """Have something done to the view, in its thread, before the next block."""
        self._orders.append(what)

    def set_sample_rate(self, rate_hz: float) -> None:
        """Tell the rate of the sound, as often as one likes."""
        if rate_hz and rate_hz != self._rate_hz:
            self._rate_hz = rate_hz
            self.order(lambda view: view.set_sample_rate(rate_hz))

    # --- the thread ---

    def _run(self) -> None:
        try:
            self._work()
        except Exception as fault:  # no view can be made at all: told, or the page would stand still without a word
            log.exception("there is no live view")
            self._on_fault(fault)

    def _work(self) -> None:
        view = self._make_view()
        next_s = 0.0
        fresh = False
        while not self._end.wait(LOOK_EVERY_S):
            try:
                while self._orders:
                    self._orders.popleft()(view)
                    fresh = True
                for block in self._feed.take():
                    view.add(block)
                    fresh = True
                    for listener in self._listeners():
                        listener(block)
                now = time.monotonic()
                if fresh and self._wanted and now >= next_s:
                    self._make(view)
                    fresh, next_s = False, now + FRAME_S
            except Exception as fault:  # a view that stumbles is begun anew: the recording does not depend on it
                log.exception("the live view stumbled")
                view = self._begin_anew(fault)

    def _make(self, view: ViewLike) -> None:
        picture = view.picture(self._drawn)
        with self._lock:
            self._made, self._wanted = picture, False
        self._on_ready()

    def _begin_anew(self, fault: Exception) -> ViewLike:
        if not self._told_fault:  # once is enough: what stumbles thirty times a second must not flood the log window
            self._told_fault = True
            self._on_fault(fault)
        view = self._make_view()
        if self._rate_hz:
            view.set_sample_rate(self._rate_hz)
        with self._lock:
            self._drawn, self._wanted = None, True
        return view
