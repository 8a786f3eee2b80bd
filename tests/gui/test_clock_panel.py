"""The picture of the clocks: what is drawn where, and what is said where there is nothing to draw."""

import numpy as np
import pytest
from PySide6.QtGui import QColor

from processing.clock_fit import ClockFit, PairKind, Pairs
from processing.clock_picture import clock_picture
from processing.survey import ClockMap
from widgets.clock_panel import ClockPanel
from widgets.plot_theme import DARK, LIGHT


@pytest.fixture
def panel(qtbot):
    panel = ClockPanel(LIGHT)
    qtbot.addWidget(panel)
    panel.resize(460, 600)
    panel.show()
    qtbot.waitExposed(panel)
    return panel


def fit(late_ms):
    both = np.linspace(10, 1000, 50)
    clock = ClockMap(-2.0, 80.0, 0.002, "bumps", 1.0, 500.0, 0.002)
    heard = clock.to_audio(both) + 0.001 * late_ms
    return ClockFit(clock, (), {str(PairKind.BUMPS): Pairs(both, heard - both)}, both, heard)


def dots(panel):
    """The rows of pixels in the colour of the dots within the lowest third."""
    image = panel.view.grab().toImage()
    wanted = QColor(LIGHT.curve_second).rgb()
    first = 2 * image.height() // 3 + 20
    return [y for y in range(first, image.height() - 20) for x in range(image.width()) if image.pixel(x, y) == wanted]


def test_a_pair_whose_sound_is_late_lies_above_the_line_of_zero(panel):
    panel.show_clock("", clock_picture(fit(0.0)))
    level = np.mean(dots(panel))
    panel.show_clock("", clock_picture(fit(np.full(50, 6.0))))
    assert np.mean(dots(panel)) < level - 20
    panel.show_clock("", clock_picture(fit(np.full(50, -6.0))))
    assert np.mean(dots(panel)) > level + 20


def test_without_any_pair_it_says_so(panel):
    panel.show_clock("Nothing was found.", clock_picture(ClockFit(ClockMap())))
    assert panel.words == "Nothing was found."
    assert "No blow was found" in panel.view._hint
    panel.apply_theme(DARK)
    assert panel.view.grab().toImage().pixelColor(2, 2) == QColor(DARK.background)
