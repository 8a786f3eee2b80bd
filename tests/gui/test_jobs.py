"""Long work: one callback each, on the GUI thread; cancel; nothing lost when a step fails."""

import subprocess
import sys
import threading
from pathlib import Path

import pytest
from PySide6.QtCore import QThread

from app.jobs import SHOWN_AFTER_MS, Jobs
from processing.errors import ErrorCode, LeaklineError


@pytest.fixture
def jobs(qapp):
    jobs = Jobs()
    yield jobs
    assert jobs.stop_all()


def test_a_result_comes_back_on_the_gui_thread(qtbot, jobs):
    seen = []
    jobs.start(
        lambda _progress: threading.get_ident(),
        title="work",
        on_success=lambda r: seen.append((r, QThread.currentThread())),
    )
    qtbot.waitUntil(lambda: bool(seen))
    worker, thread = seen[0]
    assert worker != threading.get_ident()
    assert thread is QThread.currentThread()
    assert jobs.running == ()


def test_progress_carries_fraction_and_phrase(qtbot, jobs):
    told, connected = [], threading.Event()

    def step(progress):
        connected.wait()
        progress.update(0.25, "importing")
        progress.update(0.75, "position")

    job = jobs.start(step, title="work")
    job.reported.connect(lambda fraction, phrase: told.append((fraction, phrase)))
    connected.set()
    qtbot.waitUntil(lambda: not jobs.running)
    assert told == [(0.25, "importing"), (0.75, "position")]


def test_a_cancelled_job_calls_neither_success_nor_failure(qtbot, jobs):
    began, calls = threading.Event(), []

    def step(progress):
        began.set()
        while True:
            progress.update(0.5, "importing")
            threading.Event().wait(0.001)

    job = jobs.start(
        step,
        title="endless",
        on_success=lambda _: calls.append("success"),
        on_failure=lambda _: calls.append("failure"),
        on_cancel=lambda: calls.append("cancel"),
    )
    assert began.wait(5)
    job.cancel()
    qtbot.waitUntil(lambda: not jobs.running)
    assert calls == ["cancel"]


def test_an_error_that_nobody_handles_is_announced(qtbot, jobs):
    def step(_progress):
        raise LeaklineError(ErrorCode.DISC_FULL)

    with qtbot.waitSignal(jobs.failed) as told:
        jobs.start(step, title="work")
    assert told.args[0].code is ErrorCode.DISC_FULL


def test_a_forgotten_job_tells_nobody(qtbot, jobs):
    calls, go = [], threading.Event()
    job = jobs.start(lambda _p: go.wait(5), title="old", on_success=calls.append, on_failure=calls.append)
    job.forget_callbacks()
    go.set()
    qtbot.waitUntil(lambda: not jobs.running)
    assert calls == []


def test_a_quick_job_is_never_shown_and_a_slow_one_is(qtbot, jobs):
    shown, go = [], threading.Event()
    quick = jobs.start(lambda _p: None, title="quick")
    quick.shown.connect(lambda: shown.append("quick"))
    slow = jobs.start(lambda _p: go.wait(10), title="slow")
    slow.shown.connect(lambda: shown.append("slow"))
    qtbot.waitUntil(lambda: "slow" in shown, timeout=SHOWN_AFTER_MS + 5000)
    go.set()
    qtbot.waitUntil(lambda: not jobs.running)
    assert shown == ["slow"]


def test_two_hundred_jobs_end_cleanly(qtbot, jobs):
    results = []
    for number in range(200):
        jobs.start(lambda _p, n=number: n, title="many", on_success=results.append)
    qtbot.waitUntil(lambda: not jobs.running, timeout=20_000)
    assert sorted(results) == list(range(200))


def test_stop_all_waits_for_the_worker(qtbot, jobs):
    left = threading.Event()

    def step(progress):
        try:
            while True:
                progress.update(0.1)
                threading.Event().wait(0.001)
        finally:
            left.set()

    jobs.start(step, title="endless")
    assert jobs.stop_all()
    assert left.is_set()
    qtbot.waitUntil(lambda: not jobs.running)


def test_two_steps_after_each_other_may_ask_for_coordinate_systems():
    # in a process of its own: where it goes wrong (a pool's thread reused under pyproj) it takes the process with it
    script = """
import sys
from PySide6.QtCore import QCoreApplication
from pyproj import CRS
from app.jobs import Jobs
application, jobs, done = QCoreApplication([]), Jobs(), []

def next_one(_name=None):
    done.append(_name)
    if len(done) > 5:
        application.quit()
    else:
        jobs.start(lambda _progress: CRS.from_epsg(32600 + len(done)).name, title="work", on_success=next_one)

next_one()
application.exec()
jobs.stop_all()
print(done[-1])
"""
    root = Path(__file__).resolve().parent.parent.parent
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=root, capture_output=True, text=True, timeout=120, check=False
    )
    assert (done.returncode, done.stdout.strip()) == (0, "WGS 84 / UTM zone 5N"), done.stderr
