"""What a first look chose for itself does not bind the picture that follows it."""

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


@pytest.mark.parametrize("told", [False, True])
def test_colours_fit_another_sound_anew_unless_the_operator_chose_them(view, qtbot, told):
    with qtbot.waitSignal(view.db_range_changed):
        view.set_source(EvenSound(60))  # −100 dB
        view.grab()
    assert view.db_range[0] < -100 < view.db_range[1]
    if told:
        view.set_db_range(-95.0, -45.0)
    view.set_source(EvenSound(200))  # −30 dB
    qtbot.waitUntil(lambda: bool(view.grab()) and view.is_sharp)
    if told:
        assert view.db_range == (-95.0, -45.0)
    else:
        qtbot.waitUntil(lambda: bool(view.grab()) and view.db_range[0] < -30 < view.db_range[1])
        assert view.db_range[0] > -100


def test_an_empty_list_tells_whether_anybody_has_looked_for_leaks(qtbot):
    table = CandidateTable(LIGHT)
    qtbot.addWidget(table)
    table.set_rows([], searched=False)
    assert "not been looked for" in table._empty.text()
    table.set_rows([])
    assert "No leak candidates were found" in table._empty.text()
