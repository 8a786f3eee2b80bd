"""The pipe's line from a map comes into the survey by dialog, drop or key, and can be taken back."""

from dataclasses import replace

import numpy as np
import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QPoint, QPointF, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QCheckBox, QComboBox, QLineEdit, QPushButton
from route_files import GRID, in_degrees, main_pipe, write
from small_survey import make_folder, make_results

from app.application import Application
from app.settings import PreferencesStore
from processing.importing.route_files.crs import all_systems
from processing.survey import Launch
from widgets.crs_field import CODE, CrsField
from widgets.route_map import RouteMap

LEFT = Qt.MouseButton.LeftButton
PIPE = main_pipe()
SIDE = PIPE[15] + np.array([[0.0, 0.0, 0.0], [5.0, 200.0, 0.0]])


@pytest.fixture(scope="module")
def systems():
    return all_systems()


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en")
    application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    application.window.boxes = AnsweringBoxes()
    application.window.resize(1366, 768)
    application.window.show()
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    yield application
    application.window.close()
    application.shut_down()
    application.window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])


@pytest.fixture
def opened(application, tmp_path, monkeypatch, systems):
    """A survey launched at the pipe's far end, with results; processing again only notes what it was asked."""
    monkeypatch.setattr("processing.importing.route_files.crs.all_systems", lambda: systems)  # listed once is enough
    session = application.services.session
    session.open(make_folder(tmp_path))
    longitude, latitude = in_degrees(PIPE[-1:])[0, :2]
    launch = Launch(latitude=latitude, longitude=longitude, elevation_m=50.0)
    session.write_survey(replace(session.survey, launch=launch))
    session.set_results(make_results(session.folder))
    application.window.files._show_survey()
    application.window.show_page("data")
    monkeypatch.setattr(
        application.window.files, "_load", lambda _show: session.set_results(make_results(session.folder))
    )
    return session


def network(tmp_path, name="net.gpkg", driver="GPKG", crs=GRID):
    return write(tmp_path / name, driver, [PIPE[:16], PIPE[15:], SIDE], crs, ["a", "b", "service"])


def settle(qtbot, window):
    qtbot.waitUntil(lambda: not window._services.jobs.running, timeout=20_000)


def imported(qtbot, window, path):
    window.route.import_file(path)
    qtbot.waitUntil(lambda: window.route.dialog is not None, timeout=20_000)
    settle(qtbot, window)
    return window.route.dialog


def press(dialog, name):
    QTest.mouseClick(dialog.findChild(QPushButton, name), LEFT)


def test_a_route_is_imported_fitted_and_taken_back_and_again(application, opened, tmp_path, qtbot):
    window = application.window
    dialog = imported(qtbot, window, network(tmp_path))
    dialog.map.section_clicked.emit(next(k for k, s in enumerate(dialog._proposal.sections) if s.name == "a"))
    settle(qtbot, window)
    assert "±" not in dialog._told.text()
    press(dialog, "route_take")
    route = opened.survey.route
    assert route.crs == GRID
    np.testing.assert_allclose(route.points, PIPE[::-1], atol=0.01)  # from the launch on
    assert window.route.dialog is None
    assert "EPSG:5254" in window.data_page.form._route.text()
    window.review.undo()
    assert opened.survey.route is None
    window.review.redo()
    assert opened.survey.route == route
    assert window.actions_by_id["route_remove"].isEnabled()
    window.actions_by_id["route_remove"].trigger()
    assert opened.survey.route is None
    window.review.undo()
    assert opened.survey.route == route


def test_the_section_at_the_launch_is_chosen_by_itself_and_a_click_in_the_map_adds_another(
    application, opened, tmp_path, qtbot
):
    dialog = imported(qtbot, application.window, network(tmp_path))
    shown = dialog._proposal
    assert [shown.sections[k].name for k in shown.chosen] == ["b"]
    other = next(k for k, section in enumerate(shown.sections) if section.name == "a")
    middle = shown.planes[other][len(shown.planes[other]) // 2]
    x, y = dialog.map._scale.pixel(*middle)
    QTest.mouseClick(dialog.map, LEFT, pos=QPoint(round(x), round(y)))
    settle(qtbot, application.window)
    assert len(dialog._proposal.chosen) == 2
    assert dialog.findChild(QPushButton, "route_take").isEnabled()
    dialog.reject()


def test_a_branch_too_much_says_why_and_offers_no_route(application, opened, tmp_path, qtbot):
    dialog = imported(qtbot, application.window, network(tmp_path))
    names = [section.name for section in dialog._proposal.sections]
    for name in ("a", "service"):
        dialog.table.clicked.emit(dialog.table.sections.index(names.index(name), 1))
        settle(qtbot, application.window)
    assert not dialog.findChild(QPushButton, "route_take").isEnabled()
    assert "do not form one line" in dialog._told.text()
    for name in names:
        if names.index(name) in dialog._proposal.chosen:
            dialog.table.clicked.emit(dialog.table.sections.index(names.index(name), 1))
            settle(qtbot, application.window)
    assert "Tap the line" in dialog._told.text()
    dialog.reject()
    assert opened.survey.route is None


def test_two_taps_in_a_hurry_both_count(application, opened, tmp_path, qtbot):
    dialog = imported(qtbot, application.window, network(tmp_path))
    names = [section.name for section in dialog._proposal.sections]
    dialog.map.section_clicked.emit(names.index("service"))
    dialog.map.section_clicked.emit(names.index("b"))
    settle(qtbot, application.window)
    assert {names[k] for k in dialog._proposal.chosen} == {"service"}
    dialog.reject()


def test_a_drawing_asks_for_its_system_and_names_the_one_that_fits_the_launch(application, opened, tmp_path, qtbot):
    dialog = imported(qtbot, application.window, network(tmp_path, "net.dxf", "DXF", None))
    assert not dialog.findChild(QPushButton, "route_take").isEnabled()
    assert "coordinate system" in dialog._told.text()
    first = dialog.crs._list.item(0)
    assert (first.data(CODE), "0 m from the launch" in first.text()) == (GRID, True)
    dialog.crs._list.itemClicked.emit(first)
    settle(qtbot, application.window)
    assert dialog.findChild(QPushButton, "route_take").isEnabled()
    press(dialog, "route_take")
    assert opened.survey.route.crs == GRID
    assert application.services.preferences.values.recent_crs == [GRID]


def test_the_answers_change_the_route(application, opened, tmp_path, qtbot):
    dialog = imported(qtbot, application.window, network(tmp_path))
    assert dialog._proposal.built.reversed
    press(dialog, "route_reverse")
    settle(qtbot, application.window)
    assert not dialog._proposal.built.reversed
    sigma = dialog.findChild(QLineEdit, "route_sigma")
    sigma.setText("1,5")
    sigma.editingFinished.emit()
    settle(qtbot, application.window)
    assert dialog._proposal.built.route.sigma_m == 1.5
    swap = dialog.findChild(QCheckBox, "route_swap")
    swap.click()
    settle(qtbot, application.window)
    assert not dialog.findChild(QPushButton, "route_take").isEnabled() or "outside" in dialog._told.text()
    swap.click()
    settle(qtbot, application.window)
    assert dialog._proposal.built.route.sigma_m == 1.5
    assert dialog.findChild(QComboBox, "route_unit").isHidden()
    dialog.reject()


def test_a_dropped_map_is_a_route_and_a_dropped_folder_is_not(application, opened, tmp_path, qtbot):
    window = application.window
    window.route.take_dropped(network(tmp_path))
    qtbot.waitUntil(lambda: window.route.dialog is not None, timeout=20_000)
    settle(qtbot, window)
    window.route.dialog.reject()
    opened_paths = []
    window.files.open_path = opened_paths.append
    window.route.take_dropped(tmp_path)
    assert opened_paths == [tmp_path]


def test_a_broken_file_is_told_and_nothing_changes(application, opened, tmp_path, qtbot):
    window = application.window
    (tmp_path / "bad.kml").write_text("<kml><Placemark>", encoding="utf-8")
    window.route.import_file(tmp_path / "bad.kml")
    settle(qtbot, window)
    assert [str(told) for told in window.boxes.told] == ["route_damaged"]
    assert window.route.dialog is None


def test_without_a_recording_a_route_has_no_place(application, tmp_path):
    window = application.window
    assert not window.actions_by_id["route"].isEnabled()
    window.route.take_dropped(network(tmp_path))
    assert "Open a recording first" in window.boxes.told[0]


def test_every_target_of_the_dialog_is_large_enough_for_gloves(application, opened, tmp_path, qtbot):
    dialog = imported(qtbot, application.window, network(tmp_path))
    for widget in dialog.findChildren(QPushButton) + dialog.findChildren(QCheckBox):
        if widget.isVisible():
            assert widget.height() >= 36, widget.objectName()
    dialog.reject()


# --- the parts ---


@pytest.fixture
def crs_field(qtbot, systems):
    field = CrsField()
    qtbot.addWidget(field)
    field.show()
    field.set_choices(systems, [("local", "Metres")], ["EPSG:27700"], (29.1, 40.9))
    field.set_crs(None)
    return field


def test_a_system_is_found_by_typing_and_taken_by_enter(crs_field):
    chosen = []
    crs_field.crs_chosen.connect(chosen.append)
    assert crs_field._list.item(0).data(CODE) == "EPSG:27700"  # used before
    crs_field._search.setText("turef tm30")
    crs_field._search.textEdited.emit("turef tm30")
    crs_field._search.returnPressed.emit()
    assert chosen == [GRID]
    assert "TUREF / TM30" in crs_field._current.text()
    assert crs_field._list.isHidden()
    crs_field._change.click()
    assert not crs_field._list.isHidden()


def test_a_click_beside_all_lines_chooses_nothing(qtbot):
    plan = RouteMap()
    qtbot.addWidget(plan)
    plan.resize(400, 400)
    plan.show()
    plan.set_lines([np.array([[-50.0, 0.0], [50.0, 0.0]]), np.array([[-50.0, 40.0], [50.0, 40.0]])])
    plan.set_route(frozenset([0]), np.array([[-50.0, 0.0], [50.0, 0.0]]), (-50.0, 0.0))
    plan.grab()
    assert plan.section_at(QPointF(*plan._scale.pixel(10.0, 39.0))) == 1
    assert plan.section_at(QPointF(*plan._scale.pixel(10.0, 20.0))) is None
    with qtbot.assertNotEmitted(plan.section_clicked):
        QTest.mouseClick(plan, LEFT, pos=QPoint(5, 5))
