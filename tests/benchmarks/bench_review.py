"""Time from the key press of a verdict to the verdict on disk and to the next candidate drawn, of 200 candidates.

Run it by hand: ``python tests/benchmarks/bench_review.py [verdicts]``; on a screen with ``QT_QPA_PLATFORM=xcb``.
The survey is an hour of sound and path. *On disk*: the store's call has returned, which it does after SQLite's syncs;
each verdict is then read back by a second connection, outside the time. *Drawn*: the list and the spectrogram have got
their paint events since the key, and have painted; *cpu* is the time of the window's thread alone, which other work on
the computer stretches less. *All views drawn*: plan, profile, overview and level too, which follow.
Views: the whole run (nothing but marks changes), and 60 m of it (the views follow each candidate). *Alone* is the list
of undecided ones, which loses a row with each verdict.
"""

import os
import statistics
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

import numpy as np
import soundfile
from answering import CountingSink
from PySide6.QtCore import QEvent, QEventLoop, QObject, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from small_survey import RATE_HZ, SURVEY, candidate, make_device_folder, make_results, make_track

from app import appearance
from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.settings import Settings
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Verdict

HOUR_S, CANDIDATES, CLOSE_M = 3600.0, 200, 60.0
SPEED_MPS = 1.0
FIGURES = ("on disk", "drawn", "drawn, cpu", "all views drawn")
KEYS = {Qt.Key.Key_1: Verdict.CONFIRMED, Qt.Key.Key_2: Verdict.REJECTED, Qt.Key.Key_3: Verdict.UNSURE}
DEADLINE_S = 10.0
QUIET_TURNS = 20  # of the event loop without a paint event: everything has been drawn


class PaintTimes(QObject):
    """Notes which of ``widgets`` were asked to paint, and how often these and ``others`` were."""

    def __init__(self, widgets, others):
        super().__init__()
        self.widgets, self.others = widgets, others
        self.asked, self.count = set(), 0
        for widget in (*widgets, *others):
            widget.installEventFilter(self)

    def end(self):
        for widget in (*self.widgets, *self.others):
            widget.removeEventFilter(self)

    def eventFilter(self, watched, event):  # noqa: N802  # Qt
        if event.type() == QEvent.Type.Paint:
            self.asked.add(watched)
            self.count += 1
        return False


def hour_of_results(folder):
    """Return results of an hour: path, noise for sound, and candidates all along."""
    results = make_results(folder, (10.0,))
    audio, _ = open_audio([folder.original_dir / "audio.wav"])
    time_s = np.arange(0.0, HOUR_S, 0.1)
    count = len(time_s)
    place = SPEED_MPS * time_s
    zeros = np.zeros(count)
    track = replace(
        make_track(),
        time_s=time_s,
        chainage_m=place,
        position_w_m=np.column_stack([place, 20.0 * np.sin(place / 200.0), zeros]),
        sigma_along_m=np.full(count, 0.4),
        sigma_cross_m=np.full(count, 0.2),
        sigma_up_m=np.full(count, 0.1),
        quat_ws=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        speed_mps=np.full(count, SPEED_MPS),
    )
    places = np.linspace(20.0, HOUR_S * SPEED_MPS - 20.0, CANDIDATES)
    order = np.random.default_rng(3).permutation(CANDIDATES)  # the best score is anywhere along the pipe
    found = tuple(
        replace(
            candidate(k + 1, float(places[p]), 0.95 - 0.9 * k / CANDIDATES),
            time_s=float(places[p] / SPEED_MPS),
            evidence={"size_over_db": 6.0, "size_background_db": -60.0, "size_low_hz": 500.0, "size_high_hz": 3500.0},
        )
        for k, p in enumerate(order)
    )
    scanned = scan(audio, Settings().sound, out_dir=folder.path / "cache" / "scan-of-an-hour")
    recording = replace(results.recording, audio=audio)
    return replace(results, recording=recording, scan=scanned, track=track, candidates=found, not_assessed=())


def make_survey(place):
    """Return an open survey folder with an hour of noise."""
    device = make_device_folder(place)
    noise = np.random.default_rng(1).normal(0.0, 0.05, int(HOUR_S * RATE_HZ))
    soundfile.write(device / "audio.wav", noise, RATE_HZ, subtype="PCM_16")
    return SurveyFolder.create(place, SURVEY, [device / "imu.csv", device / "audio.wav"])


def settle(application, seconds=0.05):
    """Let everything that is due happen."""
    until = time.perf_counter() + seconds
    while time.perf_counter() < until:
        application.processEvents(QEventLoop.ProcessEventsFlag.AllEvents, 10)


def one_verdict(application, window, key, paints, stored):
    """Press a verdict; return (on disk, drawn, drawn by this thread alone, all views drawn) in ms."""
    paints.asked.clear()
    stored.clear()
    start, cpu = time.perf_counter(), time.thread_time()
    QTest.keyClick(window.review_page.spectrogram, key)
    while not paints.asked.issuperset(paints.widgets):
        application.processEvents()
        if time.perf_counter() - start > DEADLINE_S:
            raise TimeoutError(f"not drawn: {set(paints.widgets) - paints.asked}")
    drawn, drawn_cpu = time.perf_counter() - start, time.thread_time() - cpu
    quiet, last = 0, drawn
    while quiet < QUIET_TURNS:
        before = paints.count
        application.processEvents()
        quiet = 0 if paints.count > before else quiet + 1
        last = time.perf_counter() - start if paints.count > before else last
    return 1e3 * (stored[0] - start), 1e3 * drawn, 1e3 * drawn_cpu, 1e3 * last


def measure(application, window, session, count, *, close, alone):
    """Give ``count`` verdicts in one arrangement of view and filter; return rows of (on disk, drawn) in ms."""
    for candidate_id, decision in session.decisions.items():
        session.write_decision(candidate_id, replace(decision, verdict=Verdict.NONE), "undo")
    session.undo_stack.clear()
    session.set_filter(replace(session.filter, verdict=Verdict.NONE if alone else None))
    session.select(session.ordered_ids()[0])
    session.cursor.fit()
    if close:
        middle = float(session.cursor.x_of_time(session.cursor.time_s))
        session.cursor.set_x_range(middle - CLOSE_M / 2, middle + CLOSE_M / 2)
    settle(application, 0.5)
    page, stored, rows = window.review_page, [], []
    others = [view._canvas.viewport() for view in page.views if view is not page.spectrogram and view.isVisible()]
    paints = PaintTimes((page.spectrogram._canvas.viewport(), page.table._table.viewport()), others)
    decide = session.folder.review.decide

    def noted(*args, **kwargs):
        found = decide(*args, **kwargs)
        stored.append(time.perf_counter())
        return found

    session.folder.review.decide = noted
    keys = list(KEYS)
    for k in range(count):
        at, key = session.selected, keys[k % 3]
        rows.append(one_verdict(application, window, key, paints, stored))
        with SurveyFolder.open(session.folder.path, read_only=True) as other:
            assert other.review.decision(at) == Decision(KEYS[key])
        assert session.selected != at or k == CANDIDATES - 1
        settle(application)
    del session.folder.review.decide
    paints.end()
    return rows


def told(title, rows):
    """Print the figures of one arrangement."""
    for name, values in zip(FIGURES, zip(*rows, strict=True), strict=True):
        cuts = statistics.quantiles(values, n=20)
        print(f"{title:25s} {name:17s} p50 {statistics.median(values):6.1f}  p95 {cuts[-1]:6.1f}  "
              f"worst {max(values):6.1f} ms  ({len(values)})")  # fmt: skip


def main():
    count = min(int(sys.argv[1]) if len(sys.argv) > 1 else CANDIDATES, CANDIDATES)
    application = QApplication([])
    appearance.apply_theme(application, appearance.theme_named("light"))
    with tempfile.TemporaryDirectory() as place:
        preferences = PreferencesStore(Path(place) / "preferences.json")
        services = Services(SurveySession(), Jobs(), preferences, None, lambda _rate: CountingSink(), lambda: None)
        session = services.session
        session.open(make_survey(Path(place)))
        session.set_results(hour_of_results(session.folder))
        window = MainWindow(services, "en")
        window.show_page("leaks")
        window.resize(1366, 736)
        window.show()
        window.activateWindow()
        settle(application, 2.0)
        window.review_page.focus_views()
        for close, alone in ((False, False), (True, False), (True, True)):
            rows = measure(application, window, session, count, close=close, alone=alone)
            view = f"{CLOSE_M:.0f} m in view" if close else "whole run in view"
            told(f"{view}, {'alone' if alone else 'all'}", rows)
        window.close()
        services.jobs.stop_all()
        session.close()


if __name__ == "__main__":
    main()
