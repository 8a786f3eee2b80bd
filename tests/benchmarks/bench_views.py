"""Frame times of the views over an hour of survey, in multiples of a bare image blit of the same size.

Run it by hand: ``python tests/benchmarks/bench_views.py [width] [height]``. A frame is all that the window's thread
does for one step of panning or zooming, from the cursor's signal to the painted pixels; reads by workers run beside it.
``cpu`` is the time of that thread alone, which other work stretches little; ``wall`` is what one waits. Of the sound
page (``... bench_views.py 1920 1000 sound``) every turn of the event loop in which something was painted is a frame,
while it is panned, zoomed and measured on, and while the views follow the playback, page by page and centred; of the
``leaks`` page and the ``path`` page too.
"""

import os
import statistics
import sys
import time

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

import numpy as np
from PySide6.QtGui import QImage, QPainter
from PySide6.QtWidgets import QApplication, QVBoxLayout, QWidget

from processing.survey import Candidate, ImuSamples, LeakClass, Track
from widgets.imu_view import ImuView
from widgets.level_view import LevelCurves, LevelView
from widgets.overview_strip import OverviewStrip
from widgets.path_view import PathView
from widgets.plot_theme import LIGHT, SUN
from widgets.profile_view import ProfileView
from widgets.spectrogram_view import SpectrogramView
from widgets.time_cursor import TimeCursor

HOUR_S = 3600.0
COLUMN_S = 0.186
FRAMES, WARM_UP = 64, 4


class MemoryTiles:
    """An hour of noise in a pyramid of factor 4, as the science keeps it."""

    low_db, step_db, start_s, end_s = -130.0, 0.5, 0.0, HOUR_S

    def __init__(self):
        rng = np.random.default_rng(1)
        self.frequencies_hz = np.linspace(0.0, 22_050.0, 512)
        level = rng.integers(60, 140, (round(HOUR_S / COLUMN_S), 512), dtype=np.uint8)
        self.levels = [level]
        while len(level) > 1024:
            level = np.maximum.reduceat(level, np.arange(0, len(level), 4), axis=0)
            self.levels.append(level)

    def columns(self, start_s, end_s, columns, plane="max"):
        pixel_s = (end_s - start_s) / columns
        level = max((k for k in range(len(self.levels)) if COLUMN_S * 4**k <= pixel_s), default=0)
        stored = self.levels[level]
        edges = np.linspace(start_s, end_s, columns + 1) / (COLUMN_S * 4**level)
        first = np.clip(edges[:-1].astype(int), 0, len(stored) - 1)
        last = np.maximum(np.clip(np.ceil(edges[1:]).astype(int), 0, len(stored)), first + 1)
        piece = np.concatenate([stored[first[0] : last[-1]], stored[-1:]])
        marks = np.column_stack([first, last]).ravel() - first[0]
        return np.maximum.reduceat(piece, marks, axis=0)[::2].T


def an_hour():
    """A winding track of an hour at 20 Hz and its IMU log at 200 Hz."""
    time_s = np.arange(0.0, HOUR_S, 0.05)
    speed = 0.7 + 0.3 * np.sin(time_s / 60.0)
    speed[(time_s > 1000) & (time_s < 1120)] = 0.0
    chainage = np.cumsum(speed) * 0.05
    heading = np.cumsum(np.sin(chainage / 80.0)) * 0.05 * 0.01 + 0.5
    position = np.cumsum(np.stack([np.sin(heading), np.cos(heading), 0.01 * np.sin(chainage / 50.0)], axis=1), axis=0)
    position *= 0.05 * speed.mean()
    sigma = 0.2 + 0.002 * chainage
    quat = np.tile([1.0, 0.0, 0.0, 0.0], (len(time_s), 1))
    track = Track(time_s, chainage, position, sigma, sigma, sigma, quat, speed, "bench")
    count = round(HOUR_S * 200)
    rng = np.random.default_rng(2)
    acc, gyr = rng.normal(0, 1, (count, 3)), rng.normal(0, 3, (count, 3))
    return track, ImuSamples(np.arange(count) / 200.0, acc, gyr, np.ones(count, bool))


def candidates(track):
    rows = np.linspace(1000, len(track.time_s) - 1000, 40).astype(int)
    return tuple(
        Candidate(
            id=k,
            time_s=float(track.time_s[r]),
            chainage_m=float(track.chainage_m[r]),
            chainage_low95_m=float(track.chainage_m[r]) - 2.0,
            chainage_high95_m=float(track.chainage_m[r]) + 2.0,
            position_w_m=tuple(track.position_w_m[r]),
            score=0.5,
            level_db=6.0,
            leak_class=LeakClass.LEAK,
            band_hz=(500.0, 4000.0),
            width_m=3.0,
        )
        for k, r in enumerate(rows, 1)
    )


def yardstick_ms(width, height):
    """Time of laying down one 32-bit picture of the window's size."""
    target, picture = (QImage(width, height, QImage.Format.Format_RGB32) for _ in range(2))
    picture.fill(0)
    times = []
    for _ in range(100):
        start = time.thread_time()
        painter = QPainter(target)
        painter.drawImage(0, 0, picture)
        painter.end()
        times.append(time.thread_time() - start)
    return 1e3 * statistics.median(times)


def measured(application, views, step, others=()):
    """Return (wall, cpu) times in ms of frames: ``step(k)`` and the painting of ``views``."""
    frames = []
    for k in range(FRAMES):
        # a repaint of one paints all that are due: the others are put off, so that one can be measured alone
        for other in others:
            other.setUpdatesEnabled(False)
        wall, cpu = time.perf_counter(), time.thread_time()
        step(k)
        for view in views:
            view.repaint()
        application.processEvents()  # pictures that have been read arrive here: part of the frame
        frames.append((1e3 * (time.perf_counter() - wall), 1e3 * (time.thread_time() - cpu)))
        for other in others:
            other.setUpdatesEnabled(True)
        time.sleep(0.01)
        application.processEvents()
    return frames[WARM_UP:]


def build(cursor, window):
    """Return the six views with an hour of data, by name."""
    track, imu = an_hour()
    cursor.set_extent(0.0, HOUR_S)
    cursor.set_track(track)
    column = QVBoxLayout(window)
    column.setContentsMargins(0, 0, 0, 0)
    kinds = {
        "overview": (OverviewStrip, 1),
        "spectrogram": (SpectrogramView, 6),
        "level": (LevelView, 3),
        "profile": (ProfileView, 2),
        "imu": (ImuView, 4),
        "path": (PathView, 4),
    }
    views = {}
    for name, (kind, share) in kinds.items():
        views[name] = kind(cursor)
        column.addWidget(views[name], share)
    metres = np.arange(0.0, track.chainage_m[-1], 0.25)
    noise = np.random.default_rng(3).normal(-60, 1, len(metres))
    at = track.time_s[np.searchsorted(track.chainage_m, metres)]
    flat = np.full(len(metres), -60.0)
    views["spectrogram"].set_source(MemoryTiles())
    views["level"].set_levels(LevelCurves(at, noise, metres, flat, flat + 4.0))
    views["profile"].set_track(track)
    views["path"].set_track(track)
    views["overview"].set_level(at, noise)
    views["imu"].set_imu(imu, track)
    for view in views.values():
        view.set_candidates(candidates(track))
    return views


PAGES = {
    "sound": ("overview", "spectrogram", "level", "imu"),
    "leaks": ("overview", "spectrogram", "level", "profile", "path"),
    "path": ("overview", "level", "imu", "profile", "path"),
}
TICK_S = 0.033  # of the playback


def followed(cursor, how):
    """Return a step of the playback after which the views follow: ``page`` or ``centre``, as the program does."""

    def step(k):
        del k
        cursor.set_time(cursor.time_s + TICK_S, reveal=False)
        low, high = cursor.x_range
        at = (float(cursor.x_of_time(cursor.time_s)) - low) / (high - low)
        if how == "centre":
            cursor.pan((at - 0.5) * (high - low))
        elif not 0.0 <= at <= 1.0:
            cursor.pan((at - 0.04) * (high - low))

    return step


def measured_on(cursor):
    """Return a step of the cursor with the ruler's live end, and the label that goes with it."""

    def step(k):
        cursor.ruler.label = f"{k / 10:.1f} ± 0.5 m   {k / 5:.1f} s"
        cursor.set_time(600.0 + 2.0 * k, reveal=False)

    return step


def report_page(page, application, cursor, views):
    """Print percentiles of all frames while a page of linked views is panned, zoomed, measured on and listened to."""
    for name, view in views.items():
        view.setVisible(name in PAGES[page])
        if name != "path":
            view.set_x_axis_visible(name in ("level", "imu", "profile"))
    print(f"{page + ' page':40}{'n':>6}{'cpu p50':>9}{'p95':>7}{'p99':>7}{'wall p50':>10}{'p95':>7}{'p99':>7}")
    for mode in ("time", "distance"):
        cursor.set_axis_mode(mode)
        cursor.fit()
        cursor.zoom(0.1, cursor.x_extent[1] / 3.0)
        step = 0.005 * cursor.x_extent[1]
        for name, move in (
            ("panning", lambda k, step=step: cursor.pan(step if k < 75 else -step)),
            ("zooming", lambda k: cursor.zoom(0.9 if k % 30 < 15 else 1.0 / 0.9)),
            ("moving the cursor", lambda k: cursor.set_time(600.0 + 5.0 * k, reveal=False)),
            ("measuring", measured_on(cursor)),
            ("following by pages", followed(cursor, "page")),
            ("following centred", followed(cursor, "centre")),
        ):
            cursor.ruler.remove()
            if name == "measuring":
                cursor.set_time(600.0, reveal=False)
                cursor.ruler.press(600.0)
            if name.startswith("following"):
                cursor.set_time(float(cursor.time_of_x(sum(cursor.x_range) / 2.0)), reveal=False)
            cpu, wall = zip(*turns_of_the_loop(application, move), strict=True)
            figures = (*np.percentile(cpu, (50, 95, 99)), *np.percentile(wall, (50, 95, 99)))
            widths = (9, 7, 7, 10, 7, 7)
            text = "".join(f"{figure:{width}.1f}" for figure, width in zip(figures, widths, strict=True))
            print(f"{mode + ', ' + name:40}{len(cpu):6}{text}")


def turns_of_the_loop(application, move, steps=150):
    """Return (cpu, wall) in ms of each turn that painted something: a step every 16 ms, and what follows from it."""
    found = []
    for k in range(steps):
        for phase in range(2):
            wall, cpu = time.perf_counter(), time.thread_time()
            if phase == 0:
                move(k)
            application.processEvents()
            found.append((1e3 * (time.thread_time() - cpu), 1e3 * (time.perf_counter() - wall)))
            if phase == 0:
                time.sleep(0.016)
    return [frame for frame in found[2 * WARM_UP :] if frame[0] > 0.2]


def main():
    width, height = (int(a) for a in sys.argv[1:3]) if len(sys.argv) > 2 else (1920, 1000)
    application = QApplication([])
    window, cursor = QWidget(), TimeCursor()
    views = build(cursor, window)
    window.resize(width, height)
    window.show()
    until = time.perf_counter() + 3.0
    while time.perf_counter() < until:
        application.processEvents()
    unit = yardstick_ms(width, height)
    print(f"{width}×{height}, yardstick (blit of the window): {unit:.2f} ms of cpu")
    pages = [page for page in PAGES if page in sys.argv]
    if pages:
        for page in pages:
            report_page(page, application, cursor, views)
        window.close()
        views["spectrogram"].set_source(None)
        return
    print(f"{'':40}{'cpu ms':>16}{'blits':>16}{'wall ms':>16}")
    print(f"{'':40}{'median':>8}{'worst':>8}{'median':>8}{'worst':>8}{'median':>8}{'worst':>8}")

    def report(name, shown, step):
        others = [view for view in views.values() if view not in shown]
        wall, cpu = (sorted(times) for times in zip(*measured(application, shown, step, others), strict=True))
        middle = len(wall) // 2
        figures = (cpu[middle], cpu[-1], cpu[middle] / unit, cpu[-1] / unit, wall[middle], wall[-1])
        print(f"{name:40}" + "".join(f"{figure:8.1f}" for figure in figures))

    def pan(k):
        cursor.pan(cursor.x_extent[1] * (0.005 if k < FRAMES / 2 else -0.005))

    everything = list(views.values())
    for theme in (LIGHT, SUN):
        for view in everything:
            view.apply_theme(theme)
        for mode in ("time", "distance"):
            cursor.set_axis_mode(mode)
            cursor.fit()
            what = f"{theme.name}, {mode}: "
            report(what + "moving the cursor", everything, lambda k: cursor.set_time(600.0 + 10.0 * k, reveal=False))
            cursor.zoom(0.1, cursor.x_extent[1] / 3.0)
            for name, view in views.items():
                report(f"{what}panning, {name}", [view], pan)
            report(what + "panning, all six", everything, pan)
            report(what + "zooming, all six", everything, lambda k: cursor.zoom(0.85 if k < FRAMES / 2 else 1 / 0.85))
    window.close()
    views["spectrogram"].set_source(None)


if __name__ == "__main__":
    main()
