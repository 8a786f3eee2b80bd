"""Tie points by mouse: dragged on the plan and on the strips, edited, switched off; the path follows, undo works."""

from dataclasses import replace

import numpy as np
import pytest
from PySide6.QtCore import QPoint, QPointF, QRectF, Qt
from PySide6.QtGui import QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton
from small_survey import DURATION_S, SPEED_MPS, SURVEY, make_folder, make_results, make_track

from app.review_page import ReviewPage
from app.survey_session import SurveySession
from app.tie_control import TieControl, numbered_checks
from processing.position.evidence import Evidence
from processing.position.fitting import fit
from processing.position.odometry import Odometry
from processing.position.registry import Reckoned, problem_of
from processing.position.tie_checks import TieCheck
from processing.progress import silent
from processing.settings import PositionSettings
from processing.survey import TiePoint
from widgets.path_paint import Labels, keep_furniture_free
from widgets.plan_geometry import PlanScale
from widgets.plot_theme import LIGHT
from widgets.tie_point_panel import TiePointModel

LEFT = Qt.MouseButton.LeftButton
MIDDLE_S = 25.0
END = TiePoint("retrieval", DURATION_S, chainage_m=SPEED_MPS * DURATION_S)
VALVE = TiePoint("valve", MIDDLE_S, chainage_m=50.0, sigma_m=0.1)
HYDRANT = TiePoint("hydrant", 45.0, east_m=90.0, north_m=0.0, sigma_m=0.1)


def odometry():
    """Return the straight path as reckoned: right, and known to one per cent."""
    track = make_track()
    way = track.chainage_m
    return Odometry(
        time_s=track.time_s,
        position_w_m=track.position_w_m,
        chainage_m=way,
        speed_mps=track.speed_mps,
        quat_ws=track.quat_ws,
        along_var_m2=0.1**2 * way,
        cross_var_m2=0.05**2 * way,
        up_var_m2=0.01 * way,
        heading_var_rad2=1e-5 * track.time_s,
        scale_sigma=0.02,
        slope_sigma=0.01,
    )


@pytest.fixture
def opened(qtbot, tmp_path):
    session = SurveySession()
    page = ReviewPage(session.cursor, LIGHT)
    qtbot.addWidget(page)
    page.resize(1300, 700)
    control = TieControl(session, page, page.markers)
    folder = make_folder(tmp_path)
    survey = replace(SURVEY, tie_points=(VALVE, HYDRANT, END))
    folder.write_survey(survey, "test")
    session.open(folder)
    reckoned = Reckoned(odometry(), Evidence())
    fitted = fit(problem_of(reckoned, survey, PositionSettings()), survey, PositionSettings(), silent())
    results = replace(
        make_results(folder), survey=survey, track=fitted.track, reckoned=reckoned, tie_checks=fitted.checks
    )
    session.set_results(results)
    page.show_results(session.results)
    page.show_tie_points(survey.tie_points)
    page.show_candidates(session.rows())
    page.arrange("path")
    page.tools.choose("markers")
    page.show()
    qtbot.waitExposed(page)
    yield session, page, control
    control._loader.stop()
    session.close()


def drag(widget, start, end, steps=6):
    """Drag as a hand does: press, several moves, release."""
    QTest.mousePress(widget, LEFT, pos=start)
    for k in range(1, steps + 1):
        QTest.mouseMove(widget, start + (end - start) * (k / steps))
        QTest.qWait(15)
    QTest.mouseRelease(widget, LEFT, pos=end)


def pixel_of(plan, east_m, north_m):
    x, y = plan.plan_scale.pixel(east_m, north_m)
    return QPoint(round(x), round(y))


def settled(qtbot, control):
    qtbot.waitUntil(lambda: not control._loader.busy)


def test_the_table_tells_how_each_tie_point_fits_and_what_it_is_worth(opened):
    _, page, _ = opened
    model = page.markers.model
    rows = [[model.data(model.index(r, c)) for c in (1, 5, 6)] for r in range(3)]
    assert [row[0] for row in rows] == ["valve", "hydrant", "retrieval"]
    assert rows[0][1] == "0.00"
    assert all("±" in row[2] for row in rows)


def test_a_chainage_dragged_along_the_path_takes_the_path_with_it_and_undo_puts_it_back(opened, qtbot):
    session, page, control = opened
    plan = page.path
    drag(plan, pixel_of(plan, 50.0, 0.0), pixel_of(plan, 53.0, 0.4))
    moved = session.survey.tie_points[0]
    assert moved.chainage_m == pytest.approx(53.0, abs=0.3)
    assert moved.time_s == MIDDLE_S
    settled(qtbot, control)
    found = float(np.interp(MIDDLE_S, control._shown.time_s, control._shown.chainage_m))
    assert 50.5 < found < 53.5  # the other two hold against it, but 0.1 m is a firm word
    assert page.markers._process.isVisible()
    session.undo_stack.undo()
    assert session.survey.tie_points[0] == VALVE
    assert control._shown is session.results.track
    assert not page.markers._process.isVisible()


def test_a_place_dragged_on_the_plan_keeps_its_moment_and_gets_new_coordinates(opened):
    session, page, _ = opened
    plan = page.path
    drag(plan, pixel_of(plan, 90.0, 0.0), pixel_of(plan, 90.0, 6.0))
    moved = session.survey.tie_points[1]
    assert (moved.east_m, moved.north_m) == pytest.approx((90.0, 6.0), abs=0.3)
    assert (moved.time_s, moved.chainage_m) == (HYDRANT.time_s, None)


def test_a_flag_dragged_on_a_strip_moves_its_moment_alone(opened):
    session, page, _ = opened
    profile = page.profile
    rect = profile.plot_rect()
    start = QPoint(round(profile.pixel_of_time(MIDDLE_S)), round(rect.bottom()) - 5)
    drag(profile, start, QPoint(round(profile.pixel_of_time(30.0)), start.y()))
    moved = session.survey.tie_points[0]
    assert moved.time_s == pytest.approx(30.0, abs=0.3)
    assert moved.chainage_m == VALVE.chainage_m


def test_escape_puts_a_dragged_tie_point_back(opened):
    session, page, control = opened
    plan = page.path
    start = pixel_of(plan, 50.0, 0.0)
    QTest.mousePress(plan, LEFT, pos=start)
    QTest.mouseMove(plan, start + QPoint(30, 0))
    QTest.qWait(15)
    assert control._dragging is not None
    QTest.keyClick(plan, Qt.Key.Key_Escape)
    QTest.mouseRelease(plan, LEFT, pos=start + QPoint(30, 0))
    assert control._dragging is None
    assert session.survey.tie_points[0] == VALVE
    assert session.undo_stack.count() == 0
    assert page.markers.model.points[0] == VALVE


def test_the_path_follows_while_the_hand_still_holds(opened, qtbot):
    session, page, control = opened
    plan = page.path
    start = pixel_of(plan, 90.0, 0.0)
    QTest.mousePress(plan, LEFT, pos=start)
    end = pixel_of(plan, 90.0, 5.0)
    QTest.mouseMove(plan, end)
    QTest.qWait(15)
    settled(qtbot, control)
    assert control._shown is not session.results.track
    assert np.interp(45.0, control._shown.time_s, control._shown.position_w_m[:, 1]) > 1.0
    assert session.survey.tie_points[1] == HYDRANT  # nothing is written before the hand lets go
    QTest.mouseRelease(plan, LEFT, pos=end)


def test_switching_one_off_leaves_it_there_without_a_pull(opened, qtbot):
    session, page, control = opened
    model = page.markers.model
    assert model.setData(model.index(0, 0), Qt.CheckState.Unchecked, Qt.ItemDataRole.CheckStateRole)
    settled(qtbot, control)
    assert not session.survey.tie_points[0].enabled
    assert model.data(model.index(0, 5)) == "–"
    assert page.path._pins.pins[0].kind == "unused"


def test_a_wrong_one_is_marked_in_the_table_and_on_the_plan(opened, qtbot):
    _, page, control = opened
    model = page.markers.model
    assert model.setData(model.index(0, 3), "70")  # 20 m off
    settled(qtbot, control)
    assert model.data(model.index(0, 5)).startswith("✗")
    assert page.path._pins.pins[0].kind == "doubted"


def test_a_click_on_a_pin_goes_to_its_moment_and_a_new_one_is_put_at_the_cursor(opened, qtbot):
    session, page, control = opened
    QTest.mouseClick(page.path, LEFT, pos=pixel_of(page.path, 90.0, 0.0))
    assert session.cursor.time_s == HYDRANT.time_s
    session.cursor.set_time(10.0)
    QTest.mouseClick(page.markers.findChild(QPushButton, "add_marker"), LEFT)
    added = session.survey.tie_points[-1]
    assert (added.time_s, added.chainage_m) == (10.0, pytest.approx(20.0, abs=0.2))
    settled(qtbot, control)
    QTest.mouseClick(page.markers.findChild(QPushButton, "remove_marker"), LEFT)
    assert len(session.survey.tie_points) == 3


def test_checks_find_their_tie_points_even_where_two_have_one_name():
    points = (TiePoint("mark", 1.0), TiePoint("mark", 2.0), TiePoint("off", 3.0, enabled=False))
    checks = (
        TieCheck("mark", 2.0, "chainage", 0.2, 1.0, 0.5, held_down=False),
        TieCheck("", 9.0, "chainage", 0.0, 0.0, 1.0, held_down=False),
        TieCheck("mark", 1.0, "chainage", 0.1, 1.0, 0.5, held_down=True),
    )
    found = numbered_checks(checks, points)
    assert {n: (c.residual_m, c.doubted) for n, c in found.items()} == {0: (0.1, True), 1: (0.2, False)}


def test_the_list_of_leaks_says_that_its_places_are_of_the_path_before_and_offers_the_way_on(opened, qtbot):
    session, page, control = opened
    model = page.markers.model
    assert page.table._stale.isHidden()
    model.setData(model.index(0, 3), "50.5")
    settled(qtbot, control)
    assert not page.table._stale.isHidden()
    with qtbot.waitSignal(control.reprocess_asked):
        page.table._stale.click()
    session.undo_stack.undo()
    assert page.table._stale.isHidden()


def test_the_readout_takes_the_interval_of_the_path_that_is_drawn(opened, qtbot):
    session, page, control = opened
    session.cursor.set_time(MIDDLE_S)
    before = page.readout_text()
    model = page.markers.model
    model.setData(model.index(0, 4), "0.4")  # the tie point at the cursor is four times less sure
    settled(qtbot, control)
    assert page.readout_text() != before
    half = 1.959964 * float(np.interp(MIDDLE_S, control._shown.time_s, control._shown.sigma_along_m))
    assert f"± {half:.1f} m" in page.readout_text()


def test_no_name_covers_the_north_arrow(qapp):
    image = QImage(200, 100, QImage.Format.Format_ARGB32)
    painter = QPainter(image)
    labels = Labels(painter, LIGHT, QRectF(0.0, 0.0, 200.0, 100.0))
    keep_furniture_free(labels, LIGHT, PlanScale((0.0, 0.0), 10.0, (200.0, 100.0)))
    assert labels.write("retrieval", QPointF(160.0, 30.0), 8.0)
    left, _, right, _ = labels._taken[-1]
    painter.end()
    assert right <= 166.0 or left >= 200.0


def test_tab_leads_through_the_table_to_its_buttons(opened):
    _, page, _ = opened
    table = page.markers._table
    table.setFocus()
    QTest.keyClick(table, Qt.Key.Key_Tab)
    assert QApplication.focusWidget().objectName() == "add_marker"


def test_a_tie_point_under_a_leaks_mark_is_taken_up_once_it_is_selected(opened):
    session, page, _ = opened
    plan = page.path
    leak = replace(session.results.candidates[0], id=99, position_w_m=(90.0, 0.0, 0.0))
    plan.set_candidates((leak,))
    place = pixel_of(plan, 90.0, 0.0).toPointF()
    plan.set_tie_state(frozenset(), None)
    assert plan.movable_tie_at(place) is None
    plan.set_tie_state(frozenset(), 1)
    assert plan.movable_tie_at(place) == 1


def test_a_length_is_shown_to_a_millimetre_and_edited_whole(qtbot):
    model = TiePointModel()
    model.set_points((TiePoint("a", 1.0, chainage_m=2.0, sigma_m=0.9548928305, latitude=40.90121234),))
    sigma, latitude = model.index(0, 4), model.index(0, 5)
    assert model.data(sigma) == "0.955"
    assert model.data(sigma, Qt.ItemDataRole.EditRole) == "0.9548928305"
    assert model.data(latitude) == "40.90121234"
