"""From opening a survey to the first picture of its sound, and to a window that can be worked with; fresh processes.

    python tests/benchmarks/bench_open.py [FOLDER]        a device's folder; without it an hour is simulated
    python tests/benchmarks/bench_open.py --sound FILE    a folder that holds only this sound: twelve hours, say

Three ways: a device's folder (copied and processed), its survey folder without the cache (processed), and with it
(opened), the last three times. Seconds count from the moment when the path was given to the window: ``picture_s`` until
a spectrogram of the whole sound stands at its size, ``coarse`` if it was a first look; ``ready_s`` until the results
are there and drawn sharp; ``…_cpu_s`` is what the processors did for us meanwhile, less disturbed by neighbours.
``window_s`` is how long the program took to start before that.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from processing.importing.survey_toml import write_survey_toml
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run
from processing.survey import Survey, SurveyInfo

CHILD = "--child"
PATIENCE_S = 1800.0


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
    application.warm_up()
    told = {"window_s": time.time() - began}
    opened = [0.0, 0.0]

    def give() -> None:
        opened[:] = time.time(), time.process_time()
        application.window.files.open_path(path, read_only=False)

    def look() -> None:
        since = time.time() - opened[0]
        results = application.services.session.results
        pictures = [v for v in application.window.findChildren(SpectrogramView) if v.isVisible()]
        sharp = bool(pictures) and all(v.is_sharp for v in pictures)
        if sharp and "picture_s" not in told:
            told.update(picture_s=since, picture_cpu_s=time.process_time() - opened[1], coarse=results is None)
        if since > PATIENCE_S or (results is not None and sharp):
            told.update(ready_s=since, ready_cpu_s=time.process_time() - opened[1])
            print(json.dumps({k: round(v, 2) if isinstance(v, float) else v for k, v in told.items()}))
            application.shut_down()
            os._exit(0)

    timer = QTimer()
    timer.timeout.connect(look)

    def begin() -> None:  # once the window has stood there for a moment, as when somebody clicks
        if application.services.jobs.running:
            QTimer.singleShot(100, begin)
            return
        give()
        timer.start(10)

    QTimer.singleShot(1000, begin)
    qt.exec()


def made_folder(folder: Path, words: list[str]) -> None:
    """Put a device's folder there."""
    if words[:1] == ["--sound"]:
        folder.mkdir()
        (folder / f"audio{Path(words[1]).suffix}").symlink_to(Path(words[1]).absolute())
        write_survey_toml(folder / "survey.toml", Survey(info=SurveyInfo(name="sound")))
    else:
        write_run(simulate(load_scenario("long-main"), 0), folder)


def main() -> None:
    """Open the survey in all ways and print each time."""
    words = sys.argv[1:]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(words[0]) if words and words[0] != "--sound" else Path(scratch) / "run"
        if not folder.exists():
            made_folder(folder, words)
        places = {f"XDG_{name}_HOME": scratch for name in ("CONFIG", "DATA", "CACHE", "STATE")}
        for turn in ("device's folder", "without cache", "cached", "cached", "cached"):
            projects = sorted(folder.parent.glob("*.leakline"))
            path = folder if turn == "device's folder" or not projects else projects[0]
            if turn == "without cache":
                shutil.rmtree(path / "cache")
            arguments = [sys.executable, __file__, CHILD, str(path), repr(time.time())]
            done = subprocess.run(arguments, env={**os.environ, **places}, capture_output=True, text=True, check=False)
            if done.returncode:
                sys.exit(done.stdout + done.stderr)
            print(f"{turn:16}", done.stdout.strip().splitlines()[-1], flush=True)


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == CHILD:
        child(Path(sys.argv[2]), float(sys.argv[3]))
    else:
        main()
