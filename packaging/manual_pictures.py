#!/usr/bin/env python3
"""Takes the manual's pictures: the real window with the demonstration survey, in each language, without a screen.

    python packaging/manual_pictures.py [PLACE]

writes ``resources/manual/<language>/*.png``. Run it with the Python of ``.venv`` after what the window shows has
changed. The survey is made and processed in PLACE (else in a temporary folder), where it is found again.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))
sys.path = [entry for entry in sys.path if Path(entry or ".").resolve() != ROOT / "packaging"]  # PyPI's has that name
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from PIL import Image  # noqa: E402
from PySide6.QtCore import QBuffer, QIODevice  # noqa: E402
from PySide6.QtWidgets import QApplication, QWidget  # noqa: E402

if TYPE_CHECKING:
    from app.main_window import MainWindow

SIZE = (1366, 728)  # of the smallest laptop's window
WIDTH = 860  # of a picture: what the manual's window has room for
COLOURS = 256
DEADLINE_S = 600.0
SETTLE_S = 1.2  # pictures of the spectrogram come from workers


def main(place: Path) -> None:
    """Take all pictures in both languages."""
    os.environ["XDG_CONFIG_HOME"] = str(place / "config")
    os.environ["XDG_DATA_HOME"] = str(place / "data")
    qt = QApplication([])
    from app.application import Application
    from app.demonstration import demonstration_folder
    from app.settings import PreferencesStore
    from processing.progress import silent

    device = demonstration_folder(silent())
    for language in ("en", "tr"):
        preferences = PreferencesStore(place / "config" / f"preferences-{language}.json")
        preferences.change(language=language, tour_seen=True, recent=[])
        application = Application(qt, preferences, None, why_silent=lambda: None)
        window = application.window
        window.resize(*SIZE)
        window.show()
        window.files.open_path(device)
        _wait(lambda: window._session.results is not None and not application.services.jobs.running)  # noqa: B023, SLF001
        for name, show in _pictures(window).items():
            shown = show()
            _settle()
            window.notices.told.hide()  # it names a folder of this computer
            window.data_page.set_path(device.name)
            _save(shown, ROOT / "resources" / "manual" / language / f"{name}.png")
        window.close()
        application.shut_down()
        window.deleteLater()
        _settle(0.1)


def _pictures(window: MainWindow) -> dict[str, Callable[[], QWidget]]:
    """Return how each picture is brought to the front; the last one closes the survey."""

    def page(name: str) -> Callable[[], QWidget]:
        def show() -> QWidget:
            window.show_page(name)
            return window

        return show

    def path() -> QWidget:
        window.show_page("path")
        window.review.fit()
        return window

    def ties() -> QWidget:
        window.work.guide.show_ties()
        return window

    def lights() -> QWidget:
        window.show_page("leaks")
        window.work.guide.show_all()
        return window

    def leaks() -> QWidget:
        window.work.guide.show_all()  # it was open: away with it
        window.show_page("leaks")
        window.review.go_to_candidate()
        return window

    def tool(show: Callable[[], None]) -> Callable[[], QWidget]:
        def shown() -> QWidget:
            show()
            return window

        return shown

    def start() -> QWidget:
        window.review.confirm()
        window.review.reject()
        window.files.close_survey()
        return window

    return {
        "data": page("data"),
        "path": path,
        "ties": ties,
        "sound": page("sound"),
        "lights": lights,
        "leaks": leaks,
        "gallery": tool(window.work.gallery.show),
        "digs": tool(window.work.digs.toggle),
        "report": page("report"),
        "settings": tool(window.work.settings.show),
        "correlator": tool(window.correlator.show),
        "recording": tool(window.recording.show),
        "start": start,
    }


def _save(widget: QWidget, file: Path) -> None:
    """Write the widget's picture, small: fewer colours and fewer pixels, no date in it."""
    buffer = QBuffer()
    buffer.open(QIODevice.OpenModeFlag.WriteOnly)
    widget.grab().save(buffer, "PNG")
    import io

    with Image.open(io.BytesIO(bytes(buffer.data().data()))) as picture:
        height = round(picture.height * WIDTH / picture.width)
        small = picture.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
        file.parent.mkdir(parents=True, exist_ok=True)
        small.quantize(COLOURS, kmeans=1, dither=Image.Dither.NONE).save(file, optimize=True)
    print(f"{file.relative_to(ROOT)}  {file.stat().st_size / 1024:.0f} kB")


def _wait(done: Callable[[], bool]) -> None:
    end = time.monotonic() + DEADLINE_S
    while not done():
        if time.monotonic() > end:
            raise TimeoutError("the survey was not processed in time")
        _settle(0.05)


def _settle(seconds: float = SETTLE_S) -> None:
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        QApplication.processEvents()
        time.sleep(0.005)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(Path(sys.argv[1]).absolute())
    else:
        with tempfile.TemporaryDirectory(prefix="leakline-pictures-") as made:
            main(Path(made))
