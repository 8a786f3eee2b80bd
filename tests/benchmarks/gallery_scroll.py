"""How smoothly a gallery of hundreds scrolls: milliseconds of the window's thread a frame, memory, time to read.

    python tests/benchmarks/gallery_scroll.py [candidates] [theme]

Scrolls through all candidates by 40 pixels a frame, first while the pictures are still being read, then again; the
sound is noise of ten minutes at 16 kHz over 600 m.
"""

import os
import resource
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers"))

import numpy as np
import soundfile
from PySide6.QtWidgets import QApplication
from small_survey import candidate

from app import view_data
from processing.settings import Settings
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import ClockMap, Decision, Verdict
from widgets.candidate_row import CandidateRow
from widgets.gallery_panel import GalleryPanel
from widgets.gallery_pictures import GallerySound
from widgets.level_view import LevelCurves
from widgets.plot_scale import Scale
from widgets.plot_theme import THEMES
from widgets.spectrogram_picture import Plane
from widgets.time_axis import DistanceMap

RATE_HZ, DURATION_S = 16_000, 600.0
FRAME_PX = 40


def make_sound(place: Path) -> GallerySound:
    noise = np.random.default_rng(1).normal(0.0, 0.05, int(RATE_HZ * DURATION_S))
    soundfile.write(place / "a.wav", noise, RATE_HZ, subtype="PCM_16")
    audio, _ = open_audio([place / "a.wav"])
    found = scan(audio, Settings().sound, out_dir=place / "scan")
    time_s = np.arange(0.0, DURATION_S, 0.1)
    distances = DistanceMap(time_s, time_s.copy())
    level = 3.0 * np.sin(time_s / 3.0) - 40.0
    curves = LevelCurves(time_s, level, time_s.copy(), np.full_like(level, -42.0), np.full_like(level, -36.0))
    source = view_data.ScanTiles(found, ClockMap(), None)
    colours = tuple(0xFF000000 + 0x010101 * number for number in range(256))
    return GallerySound(source, distances, curves, (), Scale(50.0, RATE_HZ / 2), Plane.SHORT, colours, 1)


def rss_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * resource.getpagesize() / 1e6


def scroll(application: QApplication, panel: GalleryPanel) -> np.ndarray:
    bar = panel._area.verticalScrollBar()
    took = []
    bar.setValue(0)
    application.processEvents()
    for value in range(0, bar.maximum() + 1, FRAME_PX):
        start = time.perf_counter()
        bar.setValue(value)
        application.processEvents()
        took.append(1000.0 * (time.perf_counter() - start))
        time.sleep(0.012)  # the worker reads meanwhile, as between two frames of a screen
    return np.array(took)


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 200
    theme = THEMES[sys.argv[2] if len(sys.argv) > 2 else "light"]
    application = QApplication([])
    with tempfile.TemporaryDirectory() as folder:
        sound = make_sound(Path(folder))
        panel = GalleryPanel(theme)
        panel.resize(1366, 700)
        rows = []
        for number in range(count):
            verdict = list(Verdict)[number % 4]
            rows.append(CandidateRow(candidate(number + 1, 10.0 + 580.0 * number / count, 0.9), Decision(verdict)))
        before = rss_mb()
        panel.show_sound(sound, (-90.0, -30.0))
        panel.show_rows(rows, count, 0, filtered=False)
        panel.show()
        application.processEvents()
        for name in ("while reading", "again"):
            took = scroll(application, panel)
            p50, p95, worst = np.percentile(took, 50), np.percentile(took, 95), took.max()
            print(f"{name:>14}: {len(took)} frames, median {p50:.1f} ms, 95 % {p95:.1f} ms, worst {worst:.1f} ms")
        start = time.perf_counter()
        panel.grid.set_width_index(3)
        while not panel.grid.all_read:
            application.processEvents()
        print(f"largest size, a screenful read anew: {time.perf_counter() - start:.2f} s")
        kept = panel.grid.kept_bytes / 1e6
        print(f"kept {kept:.1f} MB, process grew by {rss_mb() - before:.0f} MB")
        panel.grid.stop()
        panel.close()


if __name__ == "__main__":
    main()
