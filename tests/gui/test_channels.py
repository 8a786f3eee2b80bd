"""The channels panel: every channel and filter has its words, works only while looked at, and tells what is wrong."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtWidgets import QComboBox, QLabel, QPushButton
from small_survey import make_folder, make_results

from app.channel_control import CHANNELS, NAME, ChannelControl, channel_picture
from app.page_tools import PageTools, TabTools
from app.survey_session import SurveySession
from processing import messages
from processing.conditioning import channels as processing_channels
from processing.conditioning.names import CONDITIONER_FIELDS
from processing.conditioning.settings import ConditioningSettings
from widgets.channel_panel import ChannelPanel
from widgets.optional_number import OptionalNumber
from widgets.plot_theme import DARK, LIGHT


@pytest.fixture
def opened(qtbot, tmp_path):
    session = SurveySession()
    panel = ChannelPanel(session.cursor, LIGHT)
    beside, side = TabTools(QLabel(), "Motion", "beside"), TabTools(QLabel(), "Leaks", "side")
    tools = PageTools(beside, side)
    tools.add_tool(NAME, "Channels", panel, pages=("sound",))
    qtbot.addWidget(beside)
    qtbot.addWidget(side)
    side.resize(500, 600)
    control = ChannelControl(session, tools, panel, "en")
    session.open(make_folder(tmp_path))
    results = make_results(session.folder)
    imu = results.recording.imu
    pressure = 400.0 + np.random.default_rng(0).normal(0.0, 0.5, len(imu.time_s))
    session.set_results(replace(results, recording=replace(results.recording, imu=replace(imu, pressure_kpa=pressure))))
    tools.set_page("sound")
    side.show()
    yield session, panel, tools, control
    panel.stop()
    session.close()


def look(qtbot, panel, tools):
    with qtbot.waitSignal(panel.view.ready):
        tools.choose(NAME)


def test_every_channel_and_filter_has_its_words_in_both_languages():
    assert processing_channels.CHANNELS == CHANNELS
    for language in messages.LANGUAGES:
        titles, words = messages.table("conditioner_titles", language), messages.table("conditioner_words", language)
        settings = messages.table("conditioner_settings", language)
        assert set(titles) == set(words) == set(CONDITIONER_FIELDS)
        assert all(text.endswith(".") for text in words.values())
        assert {field for used in CONDITIONER_FIELDS.values() for field in used} | {"zero", "causal"} == set(settings)
        assert set(messages.table("channel_titles", language)) == set(CHANNELS)


def test_nothing_is_worked_out_before_somebody_looks(opened, qtbot):
    _, panel, tools, _ = opened
    assert not panel.view.busy
    assert not panel.view._strips
    look(qtbot, panel, tools)
    assert [strip.unit for strip in panel.view._strips] == ["kPa"] * 3
    assert "noise" in panel._figures.text()


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_every_filter_shows_raw_filtered_and_what_was_taken_off(opened, language):
    session = opened[0]
    for name in CONDITIONER_FIELDS:
        picture = channel_picture(session.results, "pressure", name, ConditioningSettings(), language)
        whole, residual, doubt = picture.strips
        raw, filtered = whole.lines
        np.testing.assert_allclose(residual.lines[0].values, raw.values - filtered.values, atol=1e-9)
        assert np.std(filtered.values) < 0.6 * np.std(raw.values)
        assert (doubt.lines[0].values > 0).all()
        assert picture.figures


def test_another_channel_filter_or_setting_asks_for_another_picture(opened, qtbot):
    _, panel, tools, _ = opened
    look(qtbot, panel, tools)
    with qtbot.waitSignal(panel.view.ready):
        panel.choose("speed")
    assert panel.view._strips[0].unit == "m/s"
    with qtbot.waitSignal(panel.view.ready):
        panel.choose("pressure", "fir")
    field = panel.findChild(OptionalNumber, "cutoff_hz")
    field.setText("0,25")
    field.textEdited.emit("0,25")
    with qtbot.waitSignal(panel.view.ready):
        field.editingFinished.emit()
    assert panel.values == {"cutoff_hz": 0.25}


def test_looking_back_can_be_switched_off_and_stays_so_for_the_next_filter(opened, qtbot):
    _, panel, tools, _ = opened
    look(qtbot, panel, tools)
    with qtbot.waitSignal(panel.view.ready):
        phase = panel.findChild(QComboBox, "phase")
        phase.setCurrentIndex(phase.findData("causal"))
    assert panel.values == {"phase": "causal"}
    with qtbot.waitSignal(panel.view.ready):
        panel.choose(filter_name="adaptive")
    assert panel.values == {"phase": "causal"}


def test_a_cut_off_that_the_channel_does_not_allow_is_told_and_not_drawn(opened, qtbot):
    _, panel, tools, _ = opened
    look(qtbot, panel, tools)
    with qtbot.waitSignal(panel.view.ready):
        panel.choose(filter_name="fir")
    with qtbot.waitSignal(panel.view.failed):
        panel.set_value("cutoff_hz", 50.0)
    assert "Hz" in panel._figures.text()
    assert not panel.view._strips


def test_a_run_without_the_channel_says_so(opened, qtbot):
    session, panel, tools, _ = opened
    look(qtbot, panel, tools)
    recording = session.results.recording
    bare = replace(session.results, recording=replace(recording, imu=replace(recording.imu, pressure_kpa=None)))
    with qtbot.waitSignal(panel.view.ready):
        session.set_results(bare)
    assert "no such channel" in panel._figures.text()


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_a_pump_and_a_hammer_are_told_with_their_times(opened, language):
    results = opened[0].results
    imu = results.recording.imu
    pump = np.where(imu.time_s > 15.0, 9.0, 0.0)
    ringing = 20.0 * np.exp(-(imu.time_s - 30.0) / 3.0) * np.cos(2.0 * np.pi * (imu.time_s - 30.0))
    pressure = imu.pressure_kpa + pump + np.where(imu.time_s > 30.0, ringing, 0.0)
    told = replace(results, recording=replace(results.recording, imu=replace(imu, pressure_kpa=pressure)))
    figures = channel_picture(told, "pressure", "kalman", ConditioningSettings(), language).figures
    assert ("water hammer" if language == "en" else "koç darbesi") in figures
    assert "0:15" in figures
    assert "0:30" in figures


def test_buttons_are_for_gloves_and_the_settings_open_and_close(opened, qtbot):
    _, panel, tools, _ = opened
    look(qtbot, panel, tools)
    button = panel.findChild(QPushButton)
    assert button.minimumHeight() >= 36
    assert all(combo.minimumHeight() >= 36 for combo in panel.findChildren(QComboBox))
    button.click()
    assert panel.findChild(QComboBox, "phase").isVisible()
    panel.apply_theme(DARK)
    assert panel.view._strips[0].curves[0][1] == DARK.curve
