import numpy as np
import pytest
from PySide6.QtCore import QPoint, Qt
from PySide6.QtGui import QColor
from PySide6.QtWidgets import QCheckBox, QPushButton

from widgets.plot_theme import LIGHT, THEMES
from widgets.spectrogram_tools import SpectrogramTools
from widgets.spectrum_panel import SpectrumPanel
from widgets.spectrum_view import SpectrumCurve, SpectrumMark, SpectrumView


def curve(name="A", level=-60.0, peak_hz=1000.0):
    hz = np.linspace(0.0, 8000.0, 1601)
    values = level + 20.0 * np.exp(-(((hz - peak_hz) / 100.0) ** 2))
    return SpectrumCurve(name, hz, values, values - 1.5, values + 1.5)


@pytest.fixture
def view(shown):
    return shown(SpectrumView(), 600, 300)


def test_the_peak_is_drawn_at_its_frequency_and_level(view):
    view.set_curves([curve()], "dB")
    image = view.grab().toImage()
    wanted = QColor(LIGHT.curve)
    columns = {}
    for x in range(int(view.plot_rect().center().x()), int(view.plot_rect().right()) - 3):
        rows = [
            y
            for y in range(int(view.plot_rect().top()) + 2, int(view.plot_rect().bottom()))
            if abs(image.pixelColor(x, y).red() - wanted.red()) + abs(image.pixelColor(x, y).green() - wanted.green())
            < 60
        ]
        if rows:
            columns[x] = min(rows)
    highest = min(columns.values())
    top = int(np.median([x for x, y in columns.items() if y == highest]))
    assert view.frequency_at(top) == pytest.approx(1000.0, rel=0.03)
    assert highest == pytest.approx(view.y_of(-40.0), abs=3)


def test_the_mouse_and_the_arrow_keys_read_values_off(view, qtbot):
    view.set_curves([curve(), curve("B", -70.0)], "dB")
    x = round(view.x_of(1000.0))
    qtbot.mouseMove(view, QPoint(x, round(view.plot_rect().center().y())))
    lines = view.reading(1000.0)
    assert lines == ["1000 Hz", "A: −40.0 ± 1.5 dB", "B: −50.0 ± 1.5 dB"]
    view._point(1000.0)
    with qtbot.waitSignal(view.pointed) as told:
        qtbot.keyClick(view, Qt.Key.Key_Right)
    assert told.args[0] > 1000.0
    with qtbot.waitSignal(view.pointed) as far:
        qtbot.keyClick(view, Qt.Key.Key_Left, Qt.KeyboardModifier.ShiftModifier)
    assert far.args[0] < 1000.0


@pytest.mark.parametrize("theme", list(THEMES.values()), ids=list(THEMES))
def test_it_paints_empty_flat_endless_and_marked_in_every_theme(shown, theme):
    view = shown(SpectrumView(theme), 300, 160)
    view.set_hint("nothing yet")
    view.grab()
    flat = curve()
    silent = SpectrumCurve("S", flat.frequency_hz, np.full(1601, -300.0), np.full(1601, -301.0), np.full(1601, -299.0))
    view.set_curves([silent, flat], "dB", bands_hz=[(900.0, 1100.0)])
    view.set_marks([SpectrumMark(50.0 * k, f"{k} × 50") for k in range(1, 40)])
    view.grab()
    view.resize(60, 30)
    view.grab()
    assert view.image(800, 400).size().toTuple() == (800, 400)


def test_the_picture_that_is_written_is_the_one_that_is_shown(view):
    view.set_curves([curve()], "dB")
    assert view.image(view.width(), view.height()).pixelColor(300, 150) == view.grab().toImage().pixelColor(300, 150)


def test_buttons_are_large_enough_for_gloves_and_say_what_is_wanted(shown, qtbot):
    panel = shown(SpectrumPanel(), 420, 500)
    assert min(w.minimumHeight() for w in (*panel.findChildren(QPushButton), *panel.findChildren(QCheckBox))) >= 36
    assert not panel.findChild(QPushButton, "spectrum_a").isEnabled()
    panel.set_able(selection=True, stretches="a")
    for name, wanted in (("spectrum_a", "a"), ("spectrum_b", "b"), ("spectrum_around", "around")):
        with qtbot.waitSignal(panel.use_asked) as told:
            qtbot.mouseClick(panel.findChild(QPushButton, name), Qt.MouseButton.LeftButton)
        assert told.args == [wanted]
    with qtbot.waitSignal(panel.export_asked) as told:
        qtbot.mouseClick(panel.findChild(QPushButton, "spectrum_csv"), Qt.MouseButton.LeftButton)
    assert told.args == ["csv"]


def test_the_tools_show_what_is_chosen_and_tell_only_what_the_operator_changes(shown, qtbot):
    tools = shown(SpectrogramTools(), 1000, 50)
    heard = []
    for signal in (tools.plane_chosen, tools.scale_chosen, tools.colours_chosen):
        signal.connect(heard.append)
    tools.show_looks("mean", "log", "magma")
    tools.show_band(500.0, 4000.0)
    assert heard == []
    tools._plane.setCurrentIndex(2)
    tools._scales["mel"].trigger()
    tools._colours["grey"].trigger()
    assert heard == ["excess", "mel", "grey"]


def test_a_band_is_asked_for_once_its_figures_have_been_typed_and_make_one(shown, qtbot):
    tools = shown(SpectrogramTools(), 1000, 50)
    tools.show_band(500.0, 4000.0)
    heard = []
    tools.band_chosen.connect(lambda *band: heard.append(band))
    tools._low.setValue(800)
    tools._low.editingFinished.emit()
    assert heard == [(800.0, 4000.0)]
    tools.show_band(800.0, 4000.0)
    tools._high.setValue(800)
    tools._high.editingFinished.emit()
    assert len(heard) == 1  # no band
    assert tools._high.value() == 4000
