"""From `leakline open` of a processed hour to the first frame that can be worked with, in fresh processes.

    python tests/benchmarks/bench_open.py [FOLDER]     FOLDER: a device's folder; without it long-main is simulated

The first process imports and processes; the later ones only open. "Ready" is: candidates listed, and the spectrogram
drawn sharp at its size.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run

CHILD = "--child"
PATIENCE_S = 300.0


def child(path: Path, began: float) -> None:
    """Open a window as the command does, and print how long it took until it was ready."""
    from PySide6.QtCore import QTimer
    from PySide6.QtWidgets import QApplication

    from app import diagnostics
    from app.application import Application
    from app.settings import PreferencesStore, log_folder
    from widgets.spectrogram_view import SpectrogramView

    qt = QApplication([])
    application = Application(qt, PreferencesStore(), diagnostics.start_log(log_folder()))
    application.window.resize(1366, 768)
    application.window.show()
    shown = time.time() - began
    QTimer.singleShot(0, lambda: application.window.files.open_path(path, read_only=False))

    def look() -> None:
        late = time.time() - began > PATIENCE_S
        results = application.services.session.results
        pictures = [v for v in application.window.findChildren(SpectrogramView) if v.isVisible()]
        if late or (results is not None and results.candidates and pictures and all(v.is_sharp for v in pictures)):
            print(json.dumps({"window_s": round(shown, 2), "ready_s": round(time.time() - began, 2), "late": late}))
            application.shut_down()
            os._exit(0)

    timer = QTimer()
    timer.timeout.connect(look)
    timer.start(10)
    qt.exec()


def main() -> None:
    """Open the survey four times and print each time."""
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(scratch) / "hour"
        if len(sys.argv) < 2:
            write_run(simulate(load_scenario("long-main"), 0), folder)
        places = {f"XDG_{name}_HOME": scratch for name in ("CONFIG", "DATA", "CACHE", "STATE")}
        for turn in range(4):
            projects = sorted(folder.parent.glob("*.leakline"))
            path = projects[0] if projects and turn else folder
            words = [sys.executable, __file__, CHILD, str(path), repr(time.time())]
            done = subprocess.run(words, env={**os.environ, **places}, capture_output=True, text=True, check=True)
            print("imported and processed" if turn == 0 else "opened", done.stdout.strip().splitlines()[-1])


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == CHILD:
        child(Path(sys.argv[2]), float(sys.argv[3]))
    else:
        main()
