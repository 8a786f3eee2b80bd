"""Colours can be read: contrast after WCAG 2.2, verdicts told apart by the colour-blind (Machado et al. 2009)."""

import itertools

import numpy as np
import pytest
from PySide6.QtGui import QColor, QPalette

from app.appearance import palette
from processing.survey import Verdict
from widgets.plot_theme import THEMES

# severity 1.0, linear RGB to linear RGB; Machado, Oliveira and Fernandes 2009, tables 1 and 2
BLIND = {
    "protanopia": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deuteranopia": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
}
XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = XYZ @ np.ones(3)
# verdicts have shapes and signs too; colours this far apart are told apart side by side (2.3 is just noticeable)
LEAST_DELTA_E = 8.0


def linear(colour):
    values = np.array(QColor(colour).getRgbF()[:3])
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def luminance(colour):
    return float(linear(colour) @ [0.2126, 0.7152, 0.0722])


def contrast(first, second):
    high, low = sorted((luminance(first), luminance(second)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def lab(rgb):
    t = XYZ @ np.clip(rgb, 0.0, 1.0) / WHITE
    f = np.where(t > (6 / 29) ** 3, np.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def delta_e(first, second, kind=None):
    matrix = np.eye(3) if kind is None else np.array(BLIND[kind])
    return float(np.linalg.norm(lab(matrix @ linear(first)) - lab(matrix @ linear(second))))


def test_the_measure_is_that_of_the_standard():
    assert contrast("#000000", "#ffffff") == pytest.approx(21.0)
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)  # the well-known grey just below 4.5
    assert delta_e("#000000", "#ffffff") == pytest.approx(100.0, abs=0.01)
    assert delta_e("#ff0000", "#00ff00", "deuteranopia") < 0.6 * delta_e("#ff0000", "#00ff00")


@pytest.mark.parametrize("name", sorted(THEMES))
def test_letters_can_be_read_on_every_ground(name):
    theme, least = THEMES[name], 7.0 if name == "sun" else 4.5
    grounds = theme.background, theme.canvas
    pairs = [(colour, ground) for colour in (theme.text, theme.cursor, theme.accent) for ground in grounds]
    pairs += [(theme.canvas, theme.accent), (theme.canvas, theme.cursor)]  # banner, warning, chosen menu
    pairs += [(colour, theme.canvas) for colour in (theme.curve, theme.curve_second, theme.curve_third)]  # figures too
    worst = {pair: contrast(*pair) for pair in pairs if contrast(*pair) < least}
    assert worst == {}


@pytest.mark.parametrize("name", sorted(THEMES))
def test_hints_in_empty_fields_can_be_read(name):
    colours = palette(THEMES[name])
    shown = colours.color(QPalette.ColorRole.PlaceholderText).name()
    assert contrast(shown, colours.color(QPalette.ColorRole.Base).name()) >= (7.0 if name == "sun" else 4.5)


@pytest.mark.parametrize("name", sorted(THEMES))
def test_marks_and_lines_stand_out_from_the_ground(name):
    theme = THEMES[name]
    lines = [*theme.verdicts.values(), theme.route, theme.not_assessed, theme.tie_point]
    assert {colour: contrast(colour, theme.canvas) for colour in lines if contrast(colour, theme.canvas) < 3.0} == {}


@pytest.mark.parametrize("kind", [None, *BLIND])
@pytest.mark.parametrize("name", sorted(THEMES))
def test_verdicts_differ_for_every_eye(name, kind):
    verdicts = THEMES[name].verdicts
    apart = {(a.value, b.value): delta_e(verdicts[a], verdicts[b], kind) for a, b in itertools.combinations(Verdict, 2)}
    assert {pair: round(far, 1) for pair, far in apart.items() if far < LEAST_DELTA_E} == {}
