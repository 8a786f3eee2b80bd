"""The quality plots: every group has its words, works only while it is looked at, and draws what it was given."""

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication, QComboBox
from small_survey import make_folder, make_results

from app.quality_control import GROUPS, QualityControl
from app.survey_session import SurveySession
from processing import messages
from processing import quality as processing_quality
from widgets.allan_plot import AllanLines, AllanPlot
from widgets.plot_theme import DARK, LIGHT
from widgets.quality_panel import NOISE, QualityLine, QualityLines, QualityPanel


@pytest.fixture
def opened(qtbot, tmp_path):
    session = SurveySession()
    panel = QualityPanel(session.cursor, LIGHT)
    qtbot.addWidget(panel)
    panel.resize(500, 500)
    control = QualityControl(session, panel, "en")
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder))
    panel.show()
    yield session, panel, control
    panel.stop()
    session.close()


def test_every_group_is_offered_in_both_languages():
    assert set(GROUPS) == {*processing_quality.GROUPS, NOISE}
    for language in messages.LANGUAGES:
        texts = messages.table("quality", language)
        assert all(texts[f"{group}_title"] and texts[f"{group}_words"].endswith(".") for group in GROUPS)


def test_nothing_is_worked_out_before_somebody_looks(opened, qtbot):
    _, panel, control = opened
    assert not panel.view._loader.busy
    with qtbot.waitSignal(panel.view.ready):
        control.set_shown(True)
    assert [strip.name for strip in panel.view._strips] == ["along", "across", "up"]


def test_another_group_replaces_the_strips(opened, qtbot):
    _, panel, control = opened
    control.set_shown(True)
    with qtbot.waitSignal(panel.view.ready):
        panel.choose("attitude")
    assert [strip.unit for strip in panel.view._strips] == ["°", "°", "°"]
    assert "Compass" in panel._hint.text()


def test_without_a_rest_the_noise_says_what_to_do(opened, qtbot):
    _, panel, control = opened
    control.set_shown(True)
    panel.choose(NOISE)
    qtbot.waitUntil(lambda: "minute" in panel.noise._hint)


def test_the_value_of_an_interval_stands_with_its_plus_minus(opened, qtbot):
    session, panel, _ = opened
    time_s = np.array([0.0, 50.0])
    lines = tuple(QualityLine("", time_s, np.full(2, v)) for v in (1.0, 0.4, 1.6))
    with qtbot.waitSignal(panel.view.ready):
        panel.show_strips(lambda: (QualityLines("slip", "%", lines, 1.0, interval=True),))
    session.cursor.set_time(25.0)
    (strip,) = panel.view._strips
    assert [text for text, _ in panel.view._value_lines(strip)] == ["1.00 %", "± 0.60 %"]
    panel.apply_theme(DARK)
    assert panel.view._strips[0].curves[2][1] == DARK.curve


def test_the_noise_plot_stands_on_decades_and_falls_as_it_should(qtbot):
    plot = AllanPlot(LIGHT)
    qtbot.addWidget(plot)
    plot.resize(400, 300)
    tau = np.geomspace(0.01, 10.0, 20)
    white = np.column_stack([1e-2 / np.sqrt(tau)] * 3)
    plot.set_lines([AllanLines("Gyro", "°/s", tau, white, 0.9 * white, 1.1 * white)])
    image = plot.grab().toImage()
    curve = [
        y for y in range(300) for x in range(80, 380) if image.pixelColor(x, y).name() == LIGHT.curve_third
    ]  # the last axis lies on top
    assert max(curve) - min(curve) > 100


def test_the_wheel_passes_over_the_choice_of_a_group(opened):
    _, panel, _ = opened
    combo = panel.findChild(QComboBox, "quality_group")
    combo.setFocus()
    before, at = panel.group, QPointF(5, 5)
    none, still = Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier
    phase = Qt.ScrollPhase.NoScrollPhase
    wheel = QWheelEvent(at, combo.mapToGlobal(at), QPoint(), QPoint(0, -120), none, still, phase, False)
    QApplication.sendEvent(combo, wheel)
    assert panel.group == before
