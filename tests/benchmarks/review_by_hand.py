"""A whole review by a hand on the real program: by the keyboard alone, then by the mouse alone; counts what it takes.

Run it by hand, with Xvfb and xdotool installed: ``python tests/benchmarks/review_by_hand.py [keyboard|mouse]``. Each
hand opens a simulated survey of more than 20 candidates, judges 20, takes the last verdict back and gives it again,
marks a leak that the machine missed, judges it, and exports everything. After each step ``survey.db`` is read by
another connection, and at the end the files of the export. The program is started with an observer in it that only
tells where its buttons are; whatever is done to it comes through the X server, as from a hand.
"""

import csv
import json
import os
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests" / "helpers")]
SIZE = (1366, 768)
VERDICTS = ("confirmed", "rejected", "unsure")
STATUS = {"unsure": "candidate"}  # as the table of leaks tells it; the table of decisions has the word itself
JUDGED = 20
OPENED_WITHIN_S, DONE_WITHIN_S = 240.0, 20.0
OBSERVED_EVERY_MS = 150


class Hand:
    """Presses keys and buttons of one X screen, and counts them."""

    def __init__(self, display, state, folder):
        self.environment = {**os.environ, "DISPLAY": display}
        self.state_file, self.folder = state, folder
        self.keys = self.clicks = 0

    def _do(self, *words):
        subprocess.run(["xdotool", *words], env=self.environment, check=True, capture_output=True)

    def key(self, name):
        self.keys += 1
        self._do("key", name)

    def write(self, text):
        self.keys += len(text)
        self._do("type", "--delay", "15", text)

    def click(self, name, part=(0.5, 0.5)):
        """Click into the middle of a widget by its name, or at a part of its width and height."""
        left, top, width, height = self.wait(lambda: self.state()["places"].get(name), f"{name} in sight")
        self.clicks += 1
        x, y = round(left + part[0] * width), round(top + part[1] * height)
        self._do("mousemove", str(x), str(y), "click", "1")

    def focus(self):
        """There is no window manager: give the keyboard to the window that was opened last."""
        found = subprocess.run(
            ["xdotool", "search", "--onlyvisible", "--class", "."],
            env=self.environment, capture_output=True, text=True, check=False,
        ).stdout.split()  # fmt: skip
        for window in found:
            subprocess.run(["xdotool", "windowfocus", window], env=self.environment, check=False, capture_output=True)

    def state(self):
        """What the observer tells: page, places of widgets, whether work is going on."""
        try:
            return json.loads(self.state_file.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            return {"page": "", "places": {}, "working": True, "dialogs": 0}

    def wait(self, condition, what, within_s=DONE_WITHIN_S):
        until = time.monotonic() + within_s
        while time.monotonic() < until:
            found = condition()
            if found:
                return found
            time.sleep(0.03)
        raise TimeoutError(f"no {what} within {within_s:.0f} s; {self.state()}")

    def decided(self):
        """Return candidate id → verdict, and the ids marked by hand, as survey.db has them now."""
        from processing.storage.folder import SurveyFolder

        with SurveyFolder.open(self.folder, read_only=True) as other:
            run = other.review.latest_run()
            if run is None:
                return {}, frozenset()
            decisions = other.review.decisions(run)
            return {i: d.verdict.value for i, d in decisions.items()}, other.review.manual_ids(run)


class KeyboardHand:
    """How each step is done by keys alone."""

    name = "keyboard"

    def __init__(self, hand):
        self.hand = hand

    def open(self):
        self.hand.key("ctrl+o")
        self.hand.wait(lambda: self.hand.state()["dialogs"], "dialog")
        self.hand.focus()
        self.hand.write(str(self.hand.folder))
        for _ in range(3):  # the first Return may only take what the field proposes
            self.hand.key("Return")
            time.sleep(1.0)
            if not self.hand.state()["dialogs"]:
                break
        self.hand.focus()

    def give(self, verdict):
        self.hand.key(str(1 + VERDICTS.index(verdict)))

    def undo(self):
        self.hand.key("ctrl+z")

    def redo(self):
        self.hand.key("ctrl+y")

    def mark(self):
        for _ in range(6):
            self.hand.key("shift+Right")
        self.hand.key("m")

    def export(self):
        self.hand.key("ctrl+e")


class MouseHand:
    """How each step is done by the mouse alone."""

    name = "mouse"

    def __init__(self, hand):
        self.hand = hand

    def open(self):
        self.hand.click("recent_survey")

    def give(self, verdict):
        self.hand.click(f"verdict_{verdict}")

    def undo(self):
        self.hand.click("tool_undo")

    def redo(self):
        self.hand.click("tool_redo")

    def mark(self):
        self.hand.click("spectrogram", (0.62, 0.7))
        self.hand.click("tool_mark")

    def export(self):
        self.hand.click("tool_export")


def pressed(hand):
    """Return the number of presses so far."""
    return hand.keys + hand.clicks


def review(doer):
    """Do the whole review; returns the presses of each part and the seconds that the 20 verdicts took."""
    hand, counts = doer.hand, {}

    def counted(name, step):
        before = pressed(hand)
        step()
        counts[name] = pressed(hand) - before

    counted("open", doer.open)
    hand.wait(lambda: hand.state()["page"] == "leaks" and not hand.state()["working"], "leaks page", OPENED_WITHIN_S)
    hand.focus()
    time.sleep(0.5)
    began = time.monotonic()
    counted("20 verdicts", lambda: judge(doer))
    seconds = time.monotonic() - began
    verdicts, _ = hand.decided()
    counted("undo and redo", lambda: there_and_back(doer, verdicts))
    counted("mark", lambda: mark(doer))
    counted("verdict on the mark", lambda: judge_mark(doer))
    exports = hand.folder / "exports"
    counted("export all", doer.export)
    out = hand.wait(lambda: next((p for p in exports.glob("*") if p.is_dir()), None), "export")
    hand.wait(lambda: not hand.state()["working"] and (out / "leaks.csv").is_file(), "end of the export", 120.0)
    check_files(hand, out)
    return counts, seconds, sorted(path.name for path in out.iterdir())


def judge(doer):
    """Give 20 verdicts; each must be on disk before the next is given."""
    known = {}
    for k in range(JUDGED):
        verdict = VERDICTS[k % len(VERDICTS)]
        doer.give(verdict)
        found = doer.hand.wait(lambda known=known: next_state(doer.hand, known), f"verdict {k + 1}")
        (fresh,) = found.keys() - known.keys()
        assert found[fresh] == verdict, (found[fresh], verdict)
        known = found


def next_state(hand, known):
    """Return what is decided once it is not ``known`` any more."""
    found, _ = hand.decided()
    return found if found != known else None


def there_and_back(doer, verdicts):
    doer.undo()
    left = doer.hand.wait(lambda: next_state(doer.hand, verdicts), "undo")
    assert len(left) == len(verdicts) - 1
    assert left.items() <= verdicts.items()
    doer.redo()
    doer.hand.wait(lambda: next_state(doer.hand, left) == verdicts, "redo")


def mark(doer):
    doer.mark()
    doer.hand.wait(lambda: len(doer.hand.decided()[1]) == 1, "mark")


def judge_mark(doer):
    doer.give("confirmed")
    doer.hand.wait(lambda: doer.hand.decided()[0].get(next(iter(doer.hand.decided()[1]))) == "confirmed", "its verdict")


def check_files(hand, out):
    """The table of leaks must say what the database says, and the report must be there."""
    from processing.storage.folder import SurveyFolder

    verdicts, marks = hand.decided()
    with SurveyFolder.open(hand.folder, read_only=True) as other:
        numbers = {c.id: c.label for c in other.review.candidates(other.review.latest_run())}
    with (out / "leaks.csv").open(encoding="utf-8-sig", newline="") as file:
        rows = {int(row["id"]): row["status"] for row in csv.DictReader(file)}
    assert set(rows) == set(numbers.values()), (rows, numbers)
    told = {numbers[i]: STATUS.get(verdict, verdict) for i, verdict in verdicts.items()}
    assert {number: status for number, status in rows.items() if number in told} == told, (rows, told)
    assert len(marks) == 1
    assert list(out.glob("*.pdf"))


# --- the program with an observer, the screen, the survey ---


def observed_program(state_file):
    """Run the real program; it writes where its widgets are."""
    from PySide6.QtCore import QPoint, QTimer
    from PySide6.QtWidgets import QApplication, QDialog, QWidget

    from app import application

    class Observed(application.Application):
        def __init__(self, *args, **kwargs):
            super().__init__(*args, **kwargs)
            self.observer = QTimer(self)
            self.observer.timeout.connect(self.observe)
            self.observer.start(OBSERVED_EVERY_MS)

        def observe(self):
            window = self.window
            seen = [w for w in window.findChildren(QWidget) if w.objectName() and w.isVisible() and w.isEnabled()]
            named = {w.objectName(): w for w in reversed(seen)} | {"spectrogram": window.review_page.spectrogram}
            places = {}
            for name, widget in named.items():
                corner = widget.mapToGlobal(QPoint(0, 0))
                places[name] = (corner.x(), corner.y(), widget.width(), widget.height())
            told = {
                "page": window.page,
                "working": any(not job.quiet for job in self.services.jobs.running),
                "dialogs": sum(isinstance(w, QDialog) and w.isVisible() for w in QApplication.topLevelWidgets()),
                "places": places,
            }
            aside = state_file.with_suffix(".new")
            aside.write_text(json.dumps(told), encoding="utf-8")
            aside.replace(state_file)

    application.Application = Observed
    return application.run_window(None)


@contextmanager
def screen():
    """Start an X screen; yields its name."""
    read, write = os.pipe()
    size = f"{SIZE[0]}x{SIZE[1]}x24"
    command = ["Xvfb", "-displayfd", str(write), "-screen", "0", size, "-nolisten", "tcp"]
    server = subprocess.Popen(command, pass_fds=(write,), stderr=subprocess.DEVNULL)
    os.close(write)
    try:
        with os.fdopen(read) as file:
            yield f":{file.readline().strip()}"
    finally:
        server.terminate()
        server.wait(10)


@contextmanager
def program(place, display, state):
    """Start the program on a screen, with settings of its own."""
    environment = {
        **os.environ, "DISPLAY": display, "QT_QPA_PLATFORM": "xcb", "PYTHONPATH": str(ROOT),
        "XDG_CONFIG_HOME": str(place / "config"), "XDG_DATA_HOME": str(place / "data"),
        "XDG_STATE_HOME": str(place / "state"), "XDG_CACHE_HOME": str(place / "cache"),
    }  # fmt: skip
    command = [sys.executable, __file__, "--program", str(state)]
    running = subprocess.Popen(command, env=environment, cwd=place)
    try:
        yield running
    finally:
        running.terminate()
        running.wait(20)


def prepare(place):
    """Make the survey folder and the settings; returns the survey's path."""
    from many_leaks import write_many_leaks

    from processing.importing.choosing import read_survey
    from processing.storage.folder import SurveyFolder

    write_many_leaks(place / "device")
    files = [place / "device" / "imu.csv", place / "device" / "audio.wav"]
    with SurveyFolder.create(place, read_survey(place / "device"), files) as made:
        folder = made.path
    settings = place / "config" / "Leakline" / "preferences.json"
    settings.parent.mkdir(parents=True)
    settings.write_text(json.dumps({"language": "en", "recent": [str(folder)], "tour_seen": True}), encoding="utf-8")
    return folder


def by(kind):
    """Do the review by one kind of hand and print what it took."""
    with tempfile.TemporaryDirectory() as text, screen() as display:
        place = Path(text)
        folder, state = prepare(place), place / "state.json"
        with program(place, display, state):
            hand = Hand(display, state, folder)
            hand.wait(lambda: hand.state()["page"] == "start", "start page", OPENED_WITHIN_S)
            time.sleep(1.0)
            hand.focus()
            try:
                counts, seconds, files = review(kind(hand))
            except BaseException:
                subprocess.run(["import", "-window", "root", "review_by_hand.png"], env=hand.environment, check=False)
                raise
    print(f"by {kind.name} alone: {counts['20 verdicts'] / JUDGED:.2f} presses a verdict, {pressed(hand)} in all")
    print(f"  {counts}; 20 verdicts in {seconds:.1f} s with each read back from disk; exported: {', '.join(files)}")


def main():
    if sys.argv[1:2] == ["--program"]:
        return observed_program(Path(sys.argv[2]))
    kinds = {kind.name: kind for kind in (KeyboardHand, MouseHand)}
    for name in sys.argv[1:] or kinds:
        by(kinds[name])
    return 0


if __name__ == "__main__":
    sys.exit(main())
