"""What a first look shows is measured by the same colours as the picture that follows it."""

import numpy as np
import pytest

from widgets.candidate_table import CandidateTable
from widgets.plot_theme import LIGHT
from widgets.spectrogram_view import SpectrogramView


class EvenSound:
    """The same level everywhere."""

    low_db, step_db = -130.0, 0.5
    start_s, end_s = 0.0, 600.0
    frequencies_hz = np.linspace(0.0, 8000.0, 65)

    def __init__(self, level):
        self.level = level

    def columns(self, start_s, end_s, columns, plane="max"):
        return np.full((65, columns), self.level, np.uint8)


@pytest.fixture
def view(cursor, shown):
    view = shown(SpectrogramView(cursor), 1000, 300)
    yield view
    view.set_source(None)


def test_colours_are_the_same_for_another_sound(view, qtbot):
    view.set_source(EvenSound(60))  # −100 dB
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)
    fixed = view.db_range
    assert view.auto_db_range()
    assert view.db_range != fixed
    view.set_source(EvenSound(200))  # −30 dB
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)
    assert view.db_range == fixed
    assert not view.contrast_is_auto


def test_an_empty_list_tells_whether_anybody_has_looked_for_leaks(qtbot):
    table = CandidateTable(LIGHT)
    qtbot.addWidget(table)
    table.set_rows([], searched=False)
    assert "not been looked for" in table._empty.text()
    table.set_rows([])
    assert "No leak candidates were found" in table._empty.text()
