"""Every GUI test ends as it began: no window, timer or thread is left behind."""

import threading

import pytest
from PySide6.QtCore import QEvent, QLocale, QTimer
from PySide6.QtWidgets import QApplication

FIRST_LOCALE = QLocale()  # before any test has chosen another


def _with_quantities_put_back():
    application = QApplication.instance()
    before = None if application is None else application.property("leakline_quantities")
    locale = QLocale()
    yield
    QLocale.setDefault(locale)
    application = QApplication.instance()
    if application is not None:
        application.setProperty("leakline_quantities", before)


@pytest.fixture(autouse=True, scope="module")
def quantities_of_a_module_put_back():
    """Let no module's windows leave their language or units to the next module, nor tests of other folders theirs."""
    QLocale.setDefault(FIRST_LOCALE)
    application = QApplication.instance()
    if application is not None:
        application.setProperty("leakline_quantities", None)
    yield from _with_quantities_put_back()


@pytest.fixture(autouse=True)
def quantities_put_back(quantities_of_a_module_put_back):
    """Let no test leave its language or units to the next one."""
    yield from _with_quantities_put_back()


@pytest.fixture(autouse=True)
def nothing_left_behind(request):
    """Fail the test that leaves a visible window, a running timer of ours or a thread behind."""
    threads_before = set(threading.enumerate())
    yield
    application = QApplication.instance()
    if application is None:
        return
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    visible = [w for w in QApplication.topLevelWidgets() if w.isVisible()]
    for widget in visible:
        widget.close()
    timers = [t for w in QApplication.topLevelWidgets() for t in w.findChildren(QTimer) if t.isActive()]
    threads = [
        t for t in set(threading.enumerate()) - threads_before if t.is_alive() and not t.name.startswith("Dummy")
    ]
    assert not visible, visible
    assert not timers, timers
    assert not threads, threads
