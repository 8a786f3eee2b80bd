"""The tool of the bands: asks about the selection, shows the map, hands a band on, and says what is wrong."""

import numpy as np
import pytest
from PySide6.QtCore import QPointF, Qt
from PySide6.QtGui import QMouseEvent
from PySide6.QtWidgets import QApplication, QComboBox, QLabel, QPushButton
from small_survey import make_folder, make_results

from app.band_control import METHODS, BandControl
from app.survey_session import SurveySession
from processing import messages
from processing.sound.band_methods import BAND_METHODS
from widgets.band_panel import BandPanel
from widgets.plot_theme import DARK, LIGHT
from widgets.sound_selection import SoundSelection
from widgets.spectrogram_view import SpectrogramView


@pytest.fixture
def opened(qtbot, tmp_path):
    session = SurveySession()
    spectrogram, panel = SpectrogramView(session.cursor, LIGHT), BandPanel(LIGHT)
    for widget in (spectrogram, panel):
        qtbot.addWidget(widget)
        widget.resize(500, 500)
    control = BandControl(session, spectrogram, panel, "en")
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder))
    panel.show()
    yield session, spectrogram, panel, control
    control.stop()
    spectrogram.set_source(None)
    session.close()


def result(panel):
    return panel.findChild(QLabel, "band_result").text()


def measured(qtbot, control, panel):
    control.measure()
    qtbot.waitUntil(lambda: not control._loader.busy)


def test_every_way_to_ask_has_its_words_in_both_languages():
    assert tuple(BAND_METHODS) == METHODS
    for language in messages.LANGUAGES:
        titles, words = messages.table("band_titles", language), messages.table("band_words", language)
        assert set(titles) == set(words) == set(METHODS)
        assert all(text.endswith((".", ").")) for text in words.values())
        assert all(f"found_{name}" in messages.table("bands", language) for name in METHODS)


def test_without_a_selection_it_says_what_to_do(opened, qtbot):
    _, spectrogram, panel, _ = opened
    button = panel.findChild(QPushButton, "band_measure")
    assert not button.isEnabled()
    assert "Select" in panel.view._hint
    spectrogram.select(SoundSelection(10.0, 20.0, 500.0, 2000.0))
    spectrogram.selection_changed.emit(10.0, 20.0, 500.0, 2000.0)
    assert button.isEnabled()


@pytest.mark.parametrize("method", METHODS)
def test_noise_stands_out_in_no_band_and_that_is_said(opened, qtbot, method):
    _, spectrogram, panel, control = opened
    spectrogram.select(SoundSelection(20.0, 30.0, 500.0, 2000.0))
    panel.choose(method)
    measured(qtbot, control, panel)
    assert "no band" in result(panel)
    assert len(panel.view._bands) > 50
    assert not panel.findChild(QPushButton, "band_take").isEnabled()


def test_a_band_is_chosen_by_a_click_and_handed_on(opened, qtbot):
    _, spectrogram, panel, control = opened
    spectrogram.select(SoundSelection(20.0, 30.0, 500.0, 2000.0))
    measured(qtbot, control, panel)
    view = panel.view
    number = int(np.flatnonzero((view._row == 1) & (view._bands[:, 0] == 1000.0))[0])
    place = view.band_rect(number).center()
    assert view.reading_at(place).startswith("1k–2kHz")
    left = Qt.MouseButton.LeftButton
    event = QMouseEvent(
        QMouseEvent.Type.MouseButtonRelease, place, QPointF(view.mapToGlobal(place.toPoint())), left, left,
        Qt.KeyboardModifier.NoModifier,
    )  # fmt: skip
    QApplication.sendEvent(view, event)
    assert "by hand" in result(panel)
    with qtbot.waitSignal(control.band_taken) as taken:
        panel.findChild(QPushButton, "band_take").click()
    assert taken.args == [1000.0, 2000.0]


def test_a_selection_too_short_is_told(opened, qtbot):
    _, spectrogram, panel, control = opened
    spectrogram.select(SoundSelection(20.0, 20.05, 500.0, 2000.0))
    measured(qtbot, control, panel)
    assert "need" in result(panel).lower()


def test_another_run_forgets_the_map_and_both_themes_are_painted(opened, qtbot):
    session, spectrogram, panel, control = opened
    spectrogram.select(SoundSelection(20.0, 30.0, 500.0, 2000.0))
    measured(qtbot, control, panel)
    bright = panel.view.grab().toImage()
    panel.apply_theme(DARK)
    assert panel.view.grab().toImage() != bright
    session.set_results(make_results(session.folder, run_hash="another"))
    assert not len(panel.view._bands)
    assert result(panel) == ""
    assert all(w.minimumHeight() >= 36 for kind in (QPushButton, QComboBox) for w in panel.findChildren(kind))
