"""The one way to run long work: ``jobs.start(step, title=…, on_success=…)`` runs it in a thread, answers in the GUI's.

The caller owns the :class:`Job` (a QObject on the GUI thread, whose signals the worker emits), the QRunnable is not
deleted by the pool, and cancelling sets a ``threading.Event`` that the step's :class:`Progress` looks at.
"""

import logging
import threading
import time
from collections.abc import Callable
from typing import Any

from PySide6.QtCore import QObject, QRunnable, QThreadPool, QTimer, Signal, Slot

from processing.errors import Cancelled
from processing.progress import Progress
from widgets.own_thread import in_own_thread

log = logging.getLogger(__name__)

SHOWN_AFTER_MS = 500  # shorter work needs no bar, and a flashing one disturbs
REPORT_EVERY_S = 0.05

Step = Callable[[Progress], Any]


class Job(QObject):
    """One piece of long work; lives on the GUI thread, its signals carry plain values over from the worker."""

    reported = Signal(float, str)  # fraction 0..1, key of [progress]
    shown = Signal()  # it takes long enough to be worth a bar
    finished = Signal()  # after success, failure or cancel; always once
    _ended = Signal(object, object)  # value, exception

    def __init__(self, title: str, parent: QObject, *, quiet: bool = False) -> None:
        super().__init__(parent)
        self.title = title
        self.quiet = quiet  # of no interest to the operator: no line in the strip
        self.running = True
        self._cancel = threading.Event()
        self._on_success: Callable[[Any], None] | None = None
        self._on_failure: Callable[[Exception], None] | None = None
        self._on_cancel: Callable[[], None] | None = None
        self._ended.connect(self._end)
        self._delay = QTimer(self)
        self._delay.setSingleShot(True)
        self._delay.timeout.connect(self.shown)
        self._delay.start(SHOWN_AFTER_MS)

    def cancel(self) -> None:
        """Ask the step to stop at its next report."""
        self._cancel.set()

    def forget_callbacks(self) -> None:
        """Tell nobody how it ends: whoever asked for it has gone on to something else."""
        self._on_success = self._on_failure = self._on_cancel = None

    @property
    def cancelled(self) -> bool:
        """Whether it was asked to stop."""
        return self._cancel.is_set()

    @Slot(object, object)
    def _end(self, value: object, error: Exception | None) -> None:
        self.running = False
        self._delay.stop()
        self.finished.emit()
        if isinstance(error, Cancelled):
            if self._on_cancel is not None:
                self._on_cancel()
        elif error is not None:
            if self._on_failure is not None:
                self._on_failure(error)
        elif self._on_success is not None:
            self._on_success(value)


class _Work(QRunnable):
    def __init__(self, job: Job, step: Step) -> None:
        super().__init__()
        self.setAutoDelete(False)
        self._job, self._step = job, step
        self._last_s, self._phrase = 0.0, ""

    def run(self) -> None:
        progress = Progress(self._report, self._job._cancel.is_set)  # noqa: SLF001
        value, error = in_own_thread(lambda: self._step(progress), self._job.title)
        self._job._ended.emit(value, error)  # noqa: SLF001

    def _report(self, fraction: float, phrase: str) -> None:
        now_s = time.monotonic()
        if phrase != self._phrase or now_s - self._last_s >= REPORT_EVERY_S:
            self._last_s, self._phrase = now_s, phrase
            self._job.reported.emit(fraction, phrase)


class Jobs(QObject):
    """Starts and remembers the running jobs; an error nobody handles goes to ``failed``."""

    started = Signal(object)  # Job
    failed = Signal(object)  # Exception that no on_failure took
    became_idle = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._pool = QThreadPool(self)
        self._pool.setMaxThreadCount(3)  # the work, a look at something beside it, and a search for a sound card
        self._works: dict[Job, _Work] = {}
        self._spent: list[tuple[Job, _Work]] = []  # ended, but perhaps still on their way out of the worker thread

    def start(
        self,
        step: Step,
        *,
        title: str,
        on_success: Callable[[Any], None] | None = None,
        on_failure: Callable[[Exception], None] | None = None,
        on_cancel: Callable[[], None] | None = None,
        quiet: bool = False,
    ) -> Job:
        """Run ``step(progress)`` in a thread; exactly one of the three callbacks runs, on the GUI thread."""
        self._sweep()
        job = Job(title, self, quiet=quiet)
        job._on_success, job._on_cancel = on_success, on_cancel  # noqa: SLF001
        job._on_failure = on_failure or self.failed.emit  # noqa: SLF001
        work = _Work(job, step)
        self._works[job] = work
        job.finished.connect(lambda: self._forget(job))
        self.started.emit(job)
        log.info("job started: %s", title)
        self._pool.start(work)
        return job

    @property
    def running(self) -> tuple[Job, ...]:
        """The jobs that have not ended."""
        return tuple(self._works)

    def stop_all(self, timeout_ms: int = 10_000) -> bool:
        """Cancel everything and wait; returns False if a step would not stop in time."""
        for job in self._works:
            job.cancel()
        return self._pool.waitForDone(timeout_ms)

    def _forget(self, job: Job) -> None:
        self._spent.append((job, self._works.pop(job)))
        log.info("job ended: %s", job.title)
        if not self._works:
            self.became_idle.emit()

    def _sweep(self) -> None:
        if self._pool.activeThreadCount() == 0:
            for job, _work in self._spent:
                job.deleteLater()
            self._spent.clear()
