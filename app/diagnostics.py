"""The crash guard: whatever escapes goes to the log and to one honest message; the log and versions fit into a zip.

Nothing of the survey is at stake in a crash: each decision is on disk when it is made. The zip holds no survey data.
"""

import importlib.metadata
import json
import logging
import logging.handlers
import platform
import sys
import threading
import traceback
import zipfile
from pathlib import Path
from types import TracebackType

from PySide6.QtCore import QObject, Signal, qVersion

log = logging.getLogger("leakline.crash")

SHOWN_CHARACTERS = 240  # the log has the rest

DISTRIBUTIONS = ("leakline", "PySide6-Essentials", "pyqtgraph", "numpy", "scipy", "soundfile", "sounddevice", "typst")


def start_log(folder: Path) -> Path | None:
    """Write all records of level INFO and above to ``leakline.log`` in ``folder``; returns it, None if it cannot be."""
    file = folder / "leakline.log"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handler = logging.handlers.RotatingFileHandler(file, maxBytes=1_000_000, backupCount=2, encoding="utf-8")
    except OSError:
        return None
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(name)s: %(message)s"))
    root = logging.getLogger()
    for other in root.handlers:
        other.setLevel(max(other.level, root.level))  # the terminal goes on showing only what it showed
    root.addHandler(handler)
    root.setLevel(min(root.level or logging.INFO, logging.INFO))
    return file


class CrashGuard(QObject):
    """Catches what nobody caught, on any thread, and tells it once on the GUI thread."""

    crashed = Signal(str)  # the last line of the traceback

    def install(self) -> None:
        """Take over the interpreter's hooks; :meth:`remove` gives them back."""
        self._before = (sys.excepthook, threading.excepthook)
        sys.excepthook = self._on_main
        threading.excepthook = self._on_thread

    def remove(self) -> None:
        """Give the hooks back."""
        sys.excepthook, threading.excepthook = self._before

    def tell(self, error: BaseException) -> None:
        """Log ``error`` with its traceback and announce it."""
        log.error("unexpected: %s", "".join(traceback.format_exception(error)))
        line = " ".join("".join(traceback.format_exception_only(error)).split())
        self.crashed.emit(line if len(line) <= SHOWN_CHARACTERS else line[:SHOWN_CHARACTERS] + " …")

    def _on_main(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        if issubclass(kind, KeyboardInterrupt):
            self._before[0](kind, error, trace)
            return
        self.tell(error)

    def _on_thread(self, args: threading.ExceptHookArgs) -> None:
        if args.exc_value is not None and not issubclass(args.exc_type, SystemExit):
            self.tell(args.exc_value)


def versions() -> dict[str, str]:
    """Return what runs here: Python, system, Qt and the libraries."""
    found = {"python": sys.version, "platform": platform.platform(), "qt": qVersion()}
    for name in DISTRIBUTIONS:
        try:
            found[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found


def write_zip(target: Path, log_file: Path | None) -> Path:
    """Write logs and versions to ``target``; raises OSError where the disc refuses."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("versions.json", json.dumps(versions(), indent=1))
        if log_file is not None:
            for file in sorted(log_file.parent.glob(f"{log_file.name}*")):
                archive.write(file, file.name)
    return target
