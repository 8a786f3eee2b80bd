"""Pictures of every page: three themes, two languages, letters at 100 % and 200 %, two screens; to be looked at.

    python tests/benchmarks/window_pictures.py --out pictures [--pages leaks sound] [--themes sun] [--scales 200]

Each scale runs in a process of its own, as Qt reads its factor only once. The demonstration survey is opened from a
folder beside the pictures; its results stay in its cache. Besides ``<page>_<theme>_<language>_<scale>_<size>.png`` a
contact sheet of each size and scale is written, and what a page wanted more room for than there was is printed.
"""

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

SIZES = ("1366x768", "1920x1080")
THEMES = ("light", "sun", "dark")
LANGUAGES = ("en", "tr")
SCALES = (100, 200)
PLAIN = ("start", "data", "path", "sound", "leaks", "report")
THUMB = 480


def main():
    words = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    words.add_argument("--out", type=Path, required=True)
    words.add_argument("--pages", nargs="*", default=[])
    words.add_argument("--themes", nargs="*", default=THEMES)
    words.add_argument("--languages", nargs="*", default=LANGUAGES)
    words.add_argument("--sizes", nargs="*", default=SIZES)
    words.add_argument("--scales", nargs="*", type=int, default=SCALES)
    words.add_argument("--units", default="metric")
    words.add_argument("--child", type=int, help=argparse.SUPPRESS)
    told = words.parse_args()
    told.out.mkdir(parents=True, exist_ok=True)
    if told.child is not None:
        draw(told, told.child)
        return
    for scale in told.scales:
        environment = os.environ | {
            "QT_QPA_PLATFORM": "offscreen",
            "QT_SCALE_FACTOR": f"{scale / 100:g}",
            "XDG_DATA_HOME": str(told.out / "home"),
            "XDG_CONFIG_HOME": str(told.out / "home"),
        }
        subprocess.run([sys.executable, __file__, *sys.argv[1:], "--child", str(scale)], env=environment, check=True)


def draw(told, scale):
    """Draw all pages at one scale."""
    from PySide6.QtWidgets import QApplication

    from app.application import Application
    from app.devices.audio_output import open_sink
    from app.settings import PreferencesStore

    qt = QApplication(sys.argv[:1])
    folder = demonstration(told.out)
    pictures = {}
    for language in told.languages:
        preferences = PreferencesStore(told.out / "home" / f"preferences-{language}-{scale}.json")
        preferences.change(language=language, theme=told.themes[0], units=told.units, tour_seen=True, text_scale=100)
        application = Application(qt, preferences, None, open_sink, lambda: "")
        window = application.window
        window.show()
        pages = told.pages or [*PLAIN, *sorted({"correlator", "recording", *window.work._host.openers})]
        if "start" in pages:
            photograph(application, told, scale, language, ["start"], pictures)
        window.files.open_path(folder)
        settle(qt, lambda app=application: app.services.session.results is not None and not app.services.jobs.running)
        session = application.services.session
        session.select(session.ordered_ids()[0])
        photograph(application, told, scale, language, [p for p in pages if p != "start"], pictures)
        application.window.close()
        application.shut_down()
        application.window.deleteLater()
        settle(qt, pause_s=0.2)
    for size in told.sizes:
        rows = [(name, image) for (name, at), image in pictures.items() if at == size]
        contact_sheet(rows, len(told.themes) * len(told.languages)).save(str(told.out / f"sheet_{scale}_{size}.jpg"))


def photograph(application, told, scale, language, pages, pictures):
    """Save each page in each theme and size."""
    from PySide6.QtWidgets import QApplication

    qt = QApplication.instance()
    window = application.window
    factor = scale / 100
    for size in told.sizes:
        width, height = (round(int(word) / factor) for word in size.split("x"))
        for page in pages:
            for theme in told.themes:
                window.use_theme(theme)
                window.resize(width, height)
                show(window, page)
                settle(qt, lambda: not application.services.jobs.running, pause_s=0.5)
                least = window._stack.currentWidget().minimumSizeHint()
                room = window._stack.size()
                if least.width() > room.width() or least.height() > room.height():
                    wanted = f"{least.width()}×{least.height()} of {room.width()}×{room.height()}"
                    print(f"{page} {theme} {language} {scale} %: scrolls, {wanted}", flush=True)
                if (window.width(), window.height()) != (width, height):
                    wanted = f"{window.width()}×{window.height()}"
                    print(f"{page} {theme} {language} {scale} %: wants {wanted} for {width}×{height}", flush=True)
                image = window.grab().toImage()
                name = f"{page}_{theme}_{language}_{scale}"
                image.save(str(told.out / f"{name}_{size}.png"))
                pictures[name, size] = thumbnail(image)


def show(window, page):
    """Bring a page to the front."""
    if window.page == page:
        return
    if page == "correlator":
        window.correlator.show()
    elif page == "recording":
        window.recording.show()
    elif not window.work.open_page(page):
        window.show_page(page)


def demonstration(place):
    """Return the demonstration's survey folder, made and processed at the first time."""
    from app.demonstration import demonstration_folder
    from processing.progress import Progress

    del place  # it lies in the data folder of the environment
    return demonstration_folder(Progress())


def settle(qt, done=lambda: True, pause_s=0.0, wait_s=60.0):
    """Let Qt work until ``done``, and ``pause_s`` longer."""
    start = time.monotonic()
    ready = None
    while ready is None or time.monotonic() - ready < pause_s:
        qt.processEvents()
        time.sleep(0.005)
        if ready is None and done():
            ready = time.monotonic()
        if time.monotonic() - start > wait_s:
            raise TimeoutError("the window does not come to rest")


def thumbnail(image):
    """Return a small copy."""
    from PySide6.QtCore import Qt

    small = image.scaledToWidth(THUMB, Qt.TransformationMode.SmoothTransformation)
    small.setDevicePixelRatio(1.0)
    return small


def contact_sheet(rows, columns):
    """Return one picture of all, with their names."""
    from PySide6.QtCore import Qt
    from PySide6.QtGui import QImage, QPainter

    rows.sort()
    high = max((image.height() for _, image in rows), default=1) + 18
    sheet = QImage(columns * (THUMB + 4), -(-len(rows) // columns) * high, QImage.Format.Format_RGB32)
    sheet.fill(Qt.GlobalColor.white)
    painter = QPainter(sheet)
    for number, (name, image) in enumerate(rows):
        x, y = number % columns * (THUMB + 4), number // columns * high
        painter.drawText(x + 2, y + 13, name)
        painter.drawImage(x, y + 16, image)
    painter.end()
    return sheet


if __name__ == "__main__":
    main()
