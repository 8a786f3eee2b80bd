"""The linked views in the whole window: measuring by keys, menus, panels, full screen, and where one left off."""

import pytest
from kept_window import kept_fixture, window_fixture
from PySide6.QtCore import QEvent, QPoint, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QMenu, QToolButton
from review_window import press, review_window
from small_survey import SPEED_MPS

from app.actions import ACTIONS
from app.page_panels import OF_PAGE, TITLES
from app.settings import PreferencesStore
from app.view_menus import PLAN, SOUND, STRIP
from processing.storage.folder import SurveyFolder
from widgets.time_axis import AxisMode

KEY, MODIFIER = Qt.Key, Qt.KeyboardModifier


kept = kept_fixture(size=(1366, 768))
window = window_fixture()


@pytest.fixture
def services(kept):
    return kept.services


@pytest.fixture
def open_window(window, services):
    """Opens the kept window on a page, all in its place."""

    def opened(page="sound"):
        window.work.views.reset_layout()
        window.show_page(page)
        window.review_page.focus_views()
        return window

    return opened


def test_a_length_is_measured_by_keys_told_and_removed_by_escape(open_window, services):
    window, cursor = open_window(), services.session.cursor
    cursor.set_time(10.0)
    press(window, KEY.Key_R)
    for _ in range(5):
        press(window, KEY.Key_Right, MODIFIER.ShiftModifier)
    press(window, KEY.Key_R)
    found = window.work.views.measure.difference()
    assert found.metres == pytest.approx(5.0 * SPEED_MPS)
    assert found.speed_mps == pytest.approx(SPEED_MPS)
    assert found.half95_m == pytest.approx(1.96 * 0.4 * 2**0.5, abs=0.01)
    label, whole = window.work.views.measure.texts()
    assert label == cursor.ruler.label == "10.0 ± 1.1 m   5.0 s"
    assert whole.startswith(f"Δ {label.split('   ')[0]}")
    assert "2.00 m/s" in whole
    press(window, KEY.Key_R, MODIFIER.ShiftModifier)
    assert cursor.time_s == 10.0
    press(window, KEY.Key_Left, MODIFIER.ShiftModifier)
    assert sorted(cursor.ruler.ends_s) == [9.0, 15.0]
    press(window, KEY.Key_Escape)
    assert cursor.ruler.ends_s is None
    QTest.mouseClick(window.findChild(QToolButton, "measure_tool"), Qt.MouseButton.LeftButton)
    assert cursor.ruler.tool
    window.review_page.spectrogram_tools.set_selecting(on=True)  # a drag is one thing at a time
    assert not cursor.ruler.tool


def test_another_start_has_the_range_that_keys_moved_and_the_tab_of_each_page(qtbot, tmp_path):
    file = tmp_path / "preferences.json"
    for place in ("first", "second"):
        (tmp_path / place).mkdir()
    with review_window(tmp_path / "first", 4, preferences=PreferencesStore(file)) as (window, _session):
        spectrogram, tools = window.review_page.spectrogram, window.review_page.tools
        window.show_page("sound")
        window.activateWindow()
        qtbot.waitUntil(window.isActiveWindow)
        window.review_page.focus_views()
        low, high = spectrogram.fixed_range
        press(window, KEY.Key_Down, MODIFIER.ControlModifier)
        press(window, KEY.Key_PageUp, MODIFIER.ControlModifier)
        assert spectrogram.fixed_range == (low - 3.0, high + 3.0)
        kept = PreferencesStore(file).values.sound_view["levels_db"]
        assert kept == f"{low - 3.0:.1f} {high + 3.0:.1f}"
        tools.choose("bands")
        window.show_page("leaks")
        tools.choose("why")
    with review_window(tmp_path / "second", 4, preferences=PreferencesStore(file)) as (window, _session):
        page = window.review_page
        assert page.spectrogram.db_range == (low - 3.0, high + 3.0)
        assert page.tools.is_in_front("why")
        page.arrange("sound")
        assert page.tools.is_in_front("bands")


def test_every_row_of_a_menu_is_an_action_of_the_table(open_window, monkeypatch):
    window, opened = open_window(), []
    monkeypatch.setattr(QMenu, "popup", lambda menu, place: opened.append((menu, place)))
    known = {row.id for row in ACTIONS}
    parts = [part for first, groups in (PLAN, STRIP, SOUND) for part in (first, *(names for _, names in groups))]
    named = {name for part in parts for name in part}
    assert named - {""} <= known
    assert {"contrast_fixed", "measure", "follow", "full_sound", "mark"} <= named
    for view in window.review_page.views:
        view.customContextMenuRequested.emit(QPoint(40, 40))
        menu, place = opened[-1]
        assert place == view.mapToGlobal(QPoint(40, 40))
        rows = [a for m in (menu, *menu.findChildren(QMenu)) for a in m.actions() if not a.isSeparator()]
        own = [action for action in rows if action in window.actions_by_id.values()]
        assert len(own) > 8
        assert menu.sizeHint().height() < 560  # it fits on a field laptop
    window.work.views.panels.open_menu()
    assert [action.text()[3:] for action in opened[-1][0].actions()] == [TITLES[n] for n in OF_PAGE["sound"]]


def test_the_row_of_tools_lives_on_after_its_menu_was_shown_within_another(open_window, services, monkeypatch):
    window = open_window()
    monkeypatch.setattr(QMenu, "popup", lambda _menu, _place: None)
    for _ in range(2):
        window.review_page.spectrogram.customContextMenuRequested.emit(QPoint(40, 40))
        window.work.views.menus.stop()
        QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
        for mode in (AxisMode.TIME, AxisMode.DISTANCE):
            press(window, KEY.Key_D)
            assert services.session.cursor.axis_mode is mode
    assert window.review_page.spectrogram_tools.menu.actions()


def test_each_page_hides_panels_of_its_own_and_the_lowest_plot_has_the_axis(open_window, services):
    window = open_window("sound")
    page, panels = window.review_page, window.work.views.panels
    panels.set_shown("motion", shown=False)
    assert not page.imu.isVisible()
    assert page.level._show_x_axis
    window.show_page("path")
    assert page.imu.isVisible()
    panels.set_shown("plan", shown=False)
    panels.set_shown("profile", shown=False)
    assert not page.maps.isVisible()
    window.show_page("sound")
    for name in ("overview", "sound", "level"):
        panels.set_shown(name, shown=False)
    assert page.level.isVisible()  # one always stays
    menu = panels.menu(page)
    assert [action.isChecked() for action in menu.actions()] == [n in ("level", "side") for n in OF_PAGE["sound"]]
    menu.deleteLater()
    again = PreferencesStore(services.preferences.file).values.layout
    assert again["views.hidden.path"] == "plan profile"
    window.work.views.reset_layout()
    assert all(page.panels[name].isVisible() for name in OF_PAGE["sound"])
    assert set(TITLES) == set(page.panels)


def test_full_screen_has_no_menus_keeps_the_keys_and_escape_leaves(open_window, services):
    window = open_window("leaks")
    press(window, KEY.Key_F11)
    assert window.isFullScreen()
    assert not window.menuBar().isVisible()
    assert not window.step_bar.isVisible()
    press(window, KEY.Key_D)
    assert services.session.cursor.axis_mode is AxisMode.TIME
    press(window, KEY.Key_F11, MODIFIER.ShiftModifier)
    page = window.review_page
    assert [view.isVisible() for view in page.views] == [view is page.spectrogram for view in page.views]
    assert not page.table.isVisible()
    press(window, KEY.Key_Escape)
    assert window.isFullScreen()
    assert page.table.isVisible()
    press(window, KEY.Key_Escape)
    assert not window.isFullScreen()
    assert window.menuBar().isVisible()
    assert window.step_bar.isVisible()


def test_a_survey_is_shown_again_where_one_left_off(open_window, services, tmp_path):
    session = services.session
    window = open_window()
    third = session.ordered_ids()[2]
    session.select(third)
    session.cursor.set_time(33.25)
    session.cursor.set_axis_mode("time")
    session.cursor.set_range(31.0, 36.0)
    window.review_page.spectrogram.set_frequency_range(300.0, 2500.0)
    label, path = session.row(session.selected).candidate.label, session.folder.path
    results = session.results
    session.close()
    session.open(SurveyFolder.open(path))
    session.set_results(results)
    assert session.cursor.time_s == 33.25
    assert session.cursor.axis_mode is AxisMode.TIME
    assert session.cursor.range_s == pytest.approx((31.0, 36.0))
    assert window.review_page.spectrogram.frequency_range == pytest.approx((300.0, 2500.0))
    assert session.row(session.selected).candidate.label == label
    session.cursor.fit()
    session.set_results(results)  # processed again: not opened again
    assert session.cursor.range_s == session.cursor.extent_s
    session.close()  # and what cannot be understood is as if nothing had been remembered
    folder = SurveyFolder.open(path)
    folder.write_state({"views": {"time_s": "noon", "range_s": [5], "axis": "furlongs", "hz": [9, 3], "leak": []}})
    session.open(folder)
    session.set_results(results)
    assert session.cursor.range_s == session.cursor.extent_s


def test_keys_zoom_and_pan_the_view_in_front_as_the_wheel_does(open_window, services):
    window, cursor = open_window("path"), services.session.cursor
    plan, spectrogram = window.review_page.path, window.review_page.spectrogram
    whole = cursor.x_range
    before = plan.plan_scale
    press(window, KEY.Key_Z)
    assert plan.plan_scale.pixels_per_m == pytest.approx(2.0 * before.pixels_per_m)
    assert cursor.x_range == whole
    place = plan.plan_scale.centre_m
    press(window, KEY.Key_PageDown, MODIFIER.ShiftModifier)
    press(window, KEY.Key_Up, MODIFIER.ShiftModifier)
    assert plan.plan_scale.centre_m[0] > place[0]
    assert plan.plan_scale.centre_m[1] > place[1]
    window.show_page("sound")
    press(window, KEY.Key_Z)
    low, high = cursor.x_range
    assert high - low == pytest.approx(0.5 * (whole[1] - whole[0]))
    now_s = cursor.time_s
    press(window, KEY.Key_PageDown, MODIFIER.ShiftModifier)
    assert cursor.x_range[0] == pytest.approx(min(low + 0.5 * (high - low), whole[1] - (high - low)))
    assert cursor.time_s == now_s
    hz = spectrogram.frequency_range
    press(window, KEY.Key_Z, MODIFIER.ShiftModifier)
    narrow = spectrogram.frequency_range
    assert hz[0] < narrow[0] < narrow[1] < hz[1]
    press(window, KEY.Key_X, MODIFIER.ShiftModifier)
    assert spectrogram.frequency_range == pytest.approx(hz)
