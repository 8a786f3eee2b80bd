"""The sound page by keys and tools, in the whole window: looks that stay, a selection, its spectrum, the band."""

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QComboBox, QPushButton, QSpinBox, QToolButton
from small_survey import SPEED_MPS, make_folder, make_results

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from widgets.time_axis import AxisMode

KEY, MODIFIER = Qt.Key, Qt.KeyboardModifier


@pytest.fixture
def services(qapp, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, lambda _rate: CountingSink(), lambda: None)
    services.session.open(make_folder(tmp_path))
    services.session.set_results(make_results(services.session.folder))
    yield services
    services.jobs.stop_all()
    services.session.close()


@pytest.fixture
def open_window(qtbot, services):
    def opened():
        window = MainWindow(services, "en")
        window.boxes = AnsweringBoxes()
        window.resize(1366, 768)
        window.show_page("sound")
        window.show()
        qtbot.waitUntil(lambda: not services.jobs.running)
        window.review_page.focus_views()
        windows.append(window)
        return window

    windows = []
    yield opened
    for window in windows:
        window.close()
        window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


def press(window, key, modifier=MODIFIER.NoModifier):
    QTest.keyClick(QApplication.focusWidget() or window, key, modifier)


def test_what_keys_choose_stays_for_the_next_start(open_window, services):
    window = open_window()
    spectrogram = window.review_page.spectrogram
    press(window, KEY.Key_E)
    press(window, KEY.Key_L)
    press(window, KEY.Key_J)
    press(window, KEY.Key_D)
    chosen = (spectrogram.plane, spectrogram.frequency_scale, spectrogram.color_map)
    assert chosen == ("mean", "linear", "magma")
    assert services.session.cursor.axis_mode is AxisMode.TIME
    assert window.findChild(QComboBox, "plane").currentData() == "mean"
    services.session.cursor.set_axis_mode(AxisMode.DISTANCE)  # as a new survey begins
    again = open_window().review_page.spectrogram
    assert (again.plane, again.frequency_scale, again.color_map) == chosen
    assert services.session.cursor.axis_mode is AxisMode.TIME


def test_a_selection_by_keys_holds_the_leak_band_and_its_spectrum_comes_to_the_front(open_window, services, qtbot):
    window = open_window()
    cursor, page = services.session.cursor, window.review_page
    cursor.set_time(10.0)
    press(window, KEY.Key_V)
    cursor.set_time(20.0)
    press(window, KEY.Key_V)
    assert page.spectrogram.selection.start_s == 10.0
    assert page.spectrogram.selection.end_s == 20.0
    assert (page.spectrogram.selection.low_hz, page.spectrogram.selection.high_hz) == page.spectrogram.band_hz
    assert f"{10.0 * SPEED_MPS:.2f} m" in page.spectrogram.selection_text()
    press(window, KEY.Key_Y)
    assert page.tools.is_in_front("spectrum")
    qtbot.waitUntil(lambda: len(page.spectrum.view.curves) == 2, timeout=10_000)
    # the recording is the same noise everywhere
    assert window.spectrum._found.comparison.louder_db == pytest.approx(0.0, abs=0.3)


def test_every_tool_of_the_row_is_large_enough_for_gloves_and_fits_the_laptop(open_window):
    tools = open_window().review_page.spectrogram_tools
    kinds = (QPushButton, QToolButton, QComboBox, QSpinBox)
    widgets = [w for kind in kinds for w in tools.findChildren(kind) if w.isVisible() and w.objectName()]
    assert len(widgets) >= 7
    for widget in widgets:
        assert widget.height() >= 36, widget.objectName()
        assert widget.geometry().right() <= tools.width(), widget.objectName()


def test_a_band_typed_into_the_row_is_asked_about_and_given_back_where_it_is_refused(open_window, services):
    window = open_window()
    window.boxes = AnsweringBoxes("keep")
    box = window.findChild(QSpinBox, "band_high")
    before = box.value()
    box.setValue(before - 500)
    box.editingFinished.emit()
    assert window.boxes.told  # the question
    assert box.value() == before
    assert window.review_page.spectrogram.band_hz[1] == before
