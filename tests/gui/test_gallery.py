"""The gallery shows every candidate at its own metres, judges by the same keys, and scrolls without reading anew."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from kept_window import kept_fixture, window_fixture
from PySide6.QtCore import QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from small_survey import SPEED_MPS, candidate

from app.settings import PreferencesStore
from processing.survey import Verdict
from widgets.candidate_row import CandidateFilter
from widgets.gallery_cells import WIDTHS, CellShape
from widgets.gallery_pictures import HALF_M, GallerySound, KeptPictures
from widgets.plot_scale import Scale
from widgets.plot_theme import LIGHT
from widgets.spectrogram_picture import Plane
from widgets.time_axis import DistanceMap

KEY = Qt.Key


class Ramp:
    """A sound whose level tells the moment: the number at second s is s + 1, in all frequencies."""

    frequencies_hz = np.linspace(0.0, 4000.0, 65)
    low_db, step_db, start_s, end_s = -120.0, 0.5, 0.0, 100.0

    def columns(self, start_s, end_s, columns, plane="max"):
        edges = np.linspace(start_s, end_s, columns + 1)
        middle = 0.5 * (edges[1:] + edges[:-1])
        inside = (middle >= self.start_s) & (middle <= self.end_s)
        return np.where(inside, np.floor(middle) + 1.0, 0.0).astype(np.uint8)[None, :].repeat(65, axis=0)


def sound(distances, plane=Plane.SHORT):
    colours = tuple(range(256))
    return GallerySound(Ramp(), distances, None, (), Scale(50.0, 4000.0), plane, colours, 1)


def candidate_at(small_candidate, chainage_m, time_s):
    return replace(small_candidate, chainage_m=chainage_m, time_s=time_s)


@pytest.fixture
def one():
    return candidate(1, 40.0, 0.9)


def test_a_picture_shows_the_sound_of_its_metres_whatever_the_speed_was(one):
    # 1 m/s up to 40 m, then 4 m/s: the moment at c metres is c, or 40 + (c − 40) / 4
    distances = DistanceMap(np.array([0.0, 40.0, 100.0]), np.array([0.0, 40.0, 280.0]))
    key = sound(distances).key(candidate_at(one, 40.0, 40.0), 160, 4)
    levels = sound(distances).read([key])[key]
    metres = 40.0 - HALF_M + (np.arange(160) + 0.5) * 2 * HALF_M / 160
    seconds = np.where(metres < 40.0, metres, 40.0 + (metres - 40.0) / 4.0)
    assert levels.shape == (4, 160)
    assert np.max(np.abs(levels[0].astype(float) - 1.0 - np.floor(seconds))) <= 1.0  # a column may hold two seconds
    assert np.mean(levels[0] == np.floor(seconds) + 1) > 0.85


def test_what_lies_outside_of_the_pipe_is_empty(one):
    distances = DistanceMap(np.array([0.0, 100.0]), np.array([0.0, 100.0]))
    key = sound(distances).key(candidate_at(one, 2.0, 2.0), 160, 4)
    levels = sound(distances).read([key])[key]
    outside = (np.arange(160) + 1) * 2 * HALF_M / 160 + 2.0 - HALF_M <= 0.0
    assert not levels[:, outside].any()
    assert levels[:, ~outside].all()


def test_without_a_path_the_pictures_count_seconds(one):
    key = sound(None).key(candidate_at(one, float("nan"), 50.0), 160, 4)
    levels = sound(None).read([key])[key]
    assert (levels[0, 0], levels[0, -1]) == (43, 58)  # from 42 s to 58 s


def test_a_candidate_without_a_place_has_no_picture(one):
    distances = DistanceMap(np.array([0.0, 100.0]), np.array([0.0, 100.0]))
    assert sound(distances).key(candidate_at(one, float("nan"), 50.0), 160, 4) is None


def test_no_more_pictures_are_kept_than_there_is_room_for(one):
    distances = DistanceMap(np.array([0.0, 100.0]), np.array([0.0, 100.0]))
    keys = [sound(distances).key(candidate_at(one, 10.0 + m, 10.0 + m), 100, 10) for m in range(20)]
    kept = KeptPictures(most_bytes=5000)
    for key in keys:
        kept.take({key: np.zeros((10, 100), np.uint8)})
        assert kept.size_bytes <= 5000
    assert [key in kept for key in keys] == [False] * 15 + [True] * 5
    assert kept.find(keys[15]) is not None
    kept.take({keys[0]: np.zeros((10, 100), np.uint8)})
    assert keys[15] in kept  # it was looked at since
    assert keys[16] not in kept


@pytest.mark.parametrize("width", WIDTHS)
def test_the_parts_of_a_cell_do_not_overlap(qapp, width):
    shape = CellShape.of(width, LIGHT)
    parts = (shape.head, shape.picture, shape.level, shape.foot)
    for upper, lower in pairwise(parts):
        assert upper.bottom() <= lower.top()
    assert shape.foot.bottom() <= shape.size.height()
    assert shape.size.width() >= width


# --- in the window


kept = kept_fixture(tuple(np.linspace(10.0, 90.0, 12)))
window = window_fixture()


@pytest.fixture
def services(kept, window):
    return kept.services


@pytest.fixture
def session(services):
    return services.session


def press(window, key, modifier=Qt.KeyboardModifier.NoModifier):
    QTest.keyClick(QApplication.focusWidget() or window, key, modifier)


@pytest.fixture
def grid(qtbot, window):
    press(window, KEY.Key_O)
    grid = window.work.gallery.panel.grid
    qtbot.waitUntil(lambda: grid.all_read)
    return grid


def test_a_key_shows_the_gallery_and_the_same_key_leads_back(window, grid):
    assert window.page == "gallery"
    assert grid.isVisible()
    press(window, KEY.Key_O)
    assert window.page == "leaks"
    assert window.review_page.isVisible()


def test_the_stored_sound_is_in_the_pictures(window, session, grid):
    row = session.list.shown()[0]
    levels = grid._pictures.find(grid._key(row))
    results = session.results
    tiles = results.scan.tiles
    first, last = (row.candidate.chainage_m + end for end in (-HALF_M, HALF_M))
    direct = tiles.columns(first / SPEED_MPS, last / SPEED_MPS, levels.shape[1], "max")
    # the rows pool frequencies; over all of them the loudest of each column is the same
    in_view = tiles.frequency_hz >= grid._sound.frequency.low
    assert np.mean(np.abs(levels.max(axis=0).astype(float) - direct[in_view].max(axis=0)) <= 1) > 0.95


def test_arrows_walk_over_the_grid_and_digits_judge_and_go_on(window, session, grid):
    ids = session.ordered_ids()
    assert session.selected == ids[0]
    press(window, KEY.Key_Right)
    assert session.selected == ids[1]
    press(window, KEY.Key_Down)
    assert session.selected == ids[min(1 + grid.cells_across, len(ids) - 1)]
    press(window, KEY.Key_Home)
    press(window, KEY.Key_Left)
    assert session.selected == ids[0]
    press(window, KEY.Key_1)
    assert session.decision(ids[0]).verdict is Verdict.CONFIRMED
    assert session.folder.review.decision(ids[0]).verdict is Verdict.CONFIRMED
    assert session.selected == ids[1]
    press(window, KEY.Key_2)
    assert session.decision(ids[1]).verdict is Verdict.REJECTED
    press(window, KEY.Key_Z, Qt.KeyboardModifier.ControlModifier)
    assert session.decision(ids[1]).verdict is Verdict.NONE
    assert session.selected == ids[1]
    press(window, KEY.Key_End)
    assert session.selected == ids[-1]


def test_down_never_leaves_the_grid_and_reaches_a_short_last_row(window, session, grid):
    ids = session.ordered_ids()
    seen = set()
    for _ in range(len(ids)):
        press(window, KEY.Key_Down)
        seen.add(session.selected)
    assert ids.index(session.selected) // grid.cells_across == (len(ids) - 1) // grid.cells_across
    assert seen <= set(ids)


def test_enter_opens_the_candidate_among_the_views(window, session, grid):
    press(window, KEY.Key_Right)
    wanted = session.row(session.selected).candidate
    press(window, KEY.Key_Return)
    assert window.page == "leaks"
    assert session.selected == wanted.id
    assert session.cursor.time_s == pytest.approx(wanted.time_s)
    low, high = session.cursor.x_range
    assert low < wanted.chainage_m < high


def test_a_click_chooses_a_double_click_opens_and_the_buttons_judge(window, session, grid):
    ids = session.ordered_ids()
    place = grid.cell_rect(1).center()
    QTest.mouseClick(grid, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, place)
    assert session.selected == ids[1]
    QTest.mouseClick(grid, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, QPoint(2, 2))
    assert session.selected == ids[1]  # between the cells
    window.work.gallery.panel.findChild(QPushButton, "gallery_unsure").click()
    assert session.decision(ids[1]).verdict is Verdict.UNSURE
    assert QApplication.focusWidget() is grid
    QTest.mouseDClick(grid, Qt.MouseButton.LeftButton, Qt.KeyboardModifier.NoModifier, grid.cell_rect(0).center())
    assert window.page == "leaks"
    assert session.selected == ids[0]


def test_sizes_change_by_keys_and_are_remembered(window, services, grid):
    grid.set_width_index(1)
    press(window, KEY.Key_Z)
    assert grid.width_index == 2
    press(window, KEY.Key_X)
    press(window, KEY.Key_X)
    press(window, KEY.Key_X)
    assert grid.width_index == 0
    assert PreferencesStore(services.preferences.file).values.layout["gallery.width"] == "0"


def test_the_filter_and_the_order_of_the_list_are_those_of_the_gallery(qtbot, window, session, grid):
    ids = session.ordered_ids()
    press(window, KEY.Key_1)
    session.set_filter(CandidateFilter(verdict=Verdict.CONFIRMED))
    assert [row.candidate.id for row in grid._rows] == [ids[0], ids[1]]  # the confirmed one, and the selected one
    session.set_filter(CandidateFilter())
    session.set_order("chainage")
    chainages = [row.candidate.chainage_m for row in grid._rows]
    assert chainages == sorted(chainages)
    assert len(chainages) == len(ids)


def test_what_concerns_a_place_that_nobody_sees_is_off(window, grid):
    for name in ("tie", "mark", "class", "zoom_in", "select_here"):
        assert not window.actions_by_id[name].isEnabled(), name
    for name in ("confirm", "reject", "unsure", "clear", "undecided", "loop", "gallery"):
        assert window.actions_by_id[name].isEnabled(), name
    press(window, KEY.Key_O)
    assert window.actions_by_id["tie"].isEnabled()


def test_shift_space_listens_and_the_selection_stays(window, session, grid):
    before = session.selected
    press(window, KEY.Key_Space, Qt.KeyboardModifier.ShiftModifier)
    assert window.player.looping
    assert session.selected == before
    press(window, KEY.Key_Space, Qt.KeyboardModifier.ShiftModifier)
    assert not window.player.playing


def test_closing_the_survey_leaves_nothing_to_read(qtbot, window, session, grid):
    session.close()
    assert grid._rows == () or window.page == "start"
    assert grid._sound is None
    qtbot.waitUntil(lambda: not grid._loader.busy)


def test_the_selected_candidate_is_told_to_screen_readers(window, session, grid):
    row = session.row(session.selected)
    assert row.name in grid.accessibleDescription()
    assert "undecided" in grid.accessibleDescription()
    press(window, KEY.Key_1)
    press(window, KEY.Key_Home)
    assert "confirmed" in grid.accessibleDescription()
