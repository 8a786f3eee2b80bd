"""The crash guard tells what nobody caught, on any thread, and the zip holds log and versions and nothing else."""

import json
import logging
import sys
import threading
import zipfile

import pytest

from app.diagnostics import CrashGuard, start_log, versions, write_zip


@pytest.fixture
def guard(qapp):
    guard = CrashGuard()
    guard.install()
    yield guard
    guard.remove()


def test_an_error_on_the_main_thread_is_logged_and_told(guard, caplog):
    told = []
    guard.crashed.connect(told.append)
    error = ZeroDivisionError("a fault of ours")
    sys.excepthook(type(error), error, error.__traceback__)
    assert told == ["ZeroDivisionError: a fault of ours"]
    assert "ZeroDivisionError: a fault of ours" in caplog.text


def test_an_error_on_another_thread_is_told_too(guard, qtbot, caplog):
    def fails():
        raise ValueError("in a thread")

    with qtbot.waitSignal(guard.crashed) as told:
        thread = threading.Thread(target=fails)
        thread.start()
        thread.join()
    assert told.args == ["ValueError: in a thread"]


def test_the_hooks_are_given_back(qapp):
    before = sys.excepthook, threading.excepthook
    guard = CrashGuard()
    guard.install()
    guard.remove()
    assert (sys.excepthook, threading.excepthook) == before


def test_the_zip_holds_the_log_and_the_versions(tmp_path):
    root = logging.getLogger()
    handlers, level = list(root.handlers), root.level
    try:
        file = start_log(tmp_path / "log")
        logging.getLogger("somewhere").warning("a line of the log")
        target = write_zip(tmp_path / "out.zip", file)
    finally:
        for handler in set(root.handlers) - set(handlers):
            root.removeHandler(handler)
            handler.close()
        root.setLevel(level)
    with zipfile.ZipFile(target) as archive:
        assert set(archive.namelist()) == {"versions.json", "leakline.log"}
        assert json.loads(archive.read("versions.json")) == versions()
        assert b"a line of the log" in archive.read("leakline.log")


def test_a_log_that_cannot_be_written_is_no_log(tmp_path):
    (tmp_path / "file").write_text("", encoding="utf-8")
    assert start_log(tmp_path / "file") is None
