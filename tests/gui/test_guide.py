"""The lights beside the steps say what is missing, and lead to where it is mended."""

import os
from dataclasses import replace

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QPoint, QRect, QSize, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QPushButton, QToolButton
from small_survey import make_folder, make_results

from app.application import Application
from app.readiness_facts import facts_of_session
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.readiness import Lead, Light, Step
from processing.survey import PipeInfo, TiePoint, Verdict
from widgets.bubble import place_beside
from widgets.lights import LIGHT_SIGNS, light_icon
from widgets.plot_theme import THEMES
from widgets.readiness_bubble import ReadinessBubble

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en", tour_seen=True)
    application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    application.window.boxes = AnsweringBoxes()
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
def opened(application, tmp_path):
    session = application.services.session
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder))
    application.window.show_page("leaks")
    return session


def lights(window):
    window.work.guide.refresh()
    return {step.value: window.step_bar.light(step.value) for step in Step}


def bubble(window):
    return window.findChild(ReadinessBubble)


def test_without_results_lights_are_grey_and_the_tie_points_stand_beside_the_form(application, tmp_path):
    window, session = application.window, application.services.session
    assert set(lights(window).values()) == {Light.GREY}
    session.open(make_folder(tmp_path))
    window.show_page("data")
    QTest.mouseClick(window.findChild(QToolButton, "step_ties"), LEFT)
    assert window.page == "data"
    assert window.data_page.tie_points.isVisible()


def test_the_lights_follow_form_verdicts_and_exports(application, opened, qtbot):
    window, guide = application.window, application.window.work.guide
    # one tie point is yellow, a second piece of knowledge makes it green, none at all red
    told = opened.survey
    assert lights(window)["ties"] is Light.YELLOW
    assert opened.write_survey(replace(told, pipe=PipeInfo(length_m=100.0)))
    assert lights(window)["ties"] is Light.GREEN
    assert lights(window)["data"] is Light.YELLOW  # the form has changed since it was processed
    assert opened.write_survey(replace(told, pipe=PipeInfo(), tie_points=()))
    assert lights(window)["ties"] is Light.RED
    assert opened.write_survey(told)
    # the light of the leaks counts down with the verdicts, and comes back with undo
    for left in (4, 3, 2, 1):
        assert lights(window)["leaks"] is Light.YELLOW
        assert f"{left} of 4" in window.step_bar.light_button("leaks").toolTip()
        window.review.confirm()
    qtbot.waitUntil(lambda: window.step_bar.light("leaks") is Light.GREEN)  # by itself
    window.review.undo()
    assert lights(window)["leaks"] is Light.YELLOW
    window.review.redo()
    # a verdict after the export makes the report old
    assert lights(window)["report"] is Light.YELLOW
    export = opened.folder.new_export("leakline", "", opened.run)
    export.mkdir()
    guide._on_exported()
    assert lights(window)["report"] is Light.GREEN
    os.utime(export, (1.0, 1.0))
    guide._on_exported()
    assert guide.facts().changed_since
    assert lights(window)["report"] is Light.YELLOW


def test_pressing_a_light_tells_why_and_leads_there_by_mouse_and_by_keyboard(application, opened):
    window = application.window
    window.activateWindow()
    QTest.mouseClick(window.findChild(QToolButton, "light_leaks"), LEFT)
    shown = bubble(window)
    assert shown.isVisible()
    assert any("4 of 4" in row.text for row in shown.rows)
    QTest.mouseClick(shown.findChild(QPushButton, "lead_undecided"), LEFT)
    assert (window.page, shown.isVisible()) == ("leaks", False)
    assert opened.decision(opened.selected).verdict is Verdict.NONE
    # by keyboard all of them are shown, and left again
    window.actions_by_id["missing"].trigger()
    assert len(shown.rows) == len(Step)
    assert window.rect().contains(shown.geometry())
    assert shown.isAncestorOf(window.focusWidget())
    QTest.keyClick(window.focusWidget(), Qt.Key.Key_Escape)
    assert not shown.isVisible()
    window.actions_by_id["missing"].trigger()
    window.actions_by_id["missing"].trigger()
    assert not shown.isVisible()
    # every lead goes somewhere
    elsewhere = {Lead.FORM: "data", Lead.TIES: "path", Lead.UNDECIDED: "leaks", Lead.EXPORT: "report"}
    for lead in Lead:
        if lead not in (Lead.OPEN, Lead.PROCESS):  # these ask for a folder, or begin to work
            window.show_page("start")
            window.work.guide.go(lead.value)
            assert window.page == elsewhere.get(lead, lead.value)
    # and a light is told to who cannot see it
    button = window.findChild(QToolButton, "light_leaks")
    assert button.accessibleName() == "Leaks: mind"
    assert button.accessibleDescription() == button.toolTip() != ""
    assert button.height() >= 40 <= button.width()


def test_a_tie_point_that_is_switched_off_does_not_count(qapp, tmp_path):
    session = SurveySession()
    assert not facts_of_session(session, None, None, "").is_open
    session.open(make_folder(tmp_path))
    point = TiePoint("valve", 20.0, chainage_m=40.0, enabled=False)
    assert session.write_survey(replace(session.survey, tie_points=(*session.survey.tie_points, point)))
    assert facts_of_session(session, None, None, "length").ties == 1
    session.close()


@pytest.mark.parametrize("theme", THEMES.values(), ids=lambda theme: theme.name)
def test_lights_differ_without_colour(qapp, theme):
    """In shades of grey no two lights look alike, and each has its own sign."""
    pictures = set()
    for light in Light:
        image = light_icon(light, theme, 26).pixmap(26, 26).toImage()
        pictures.add(bytes(int(image.pixelColor(x, y).alpha() > 128) for y in range(26) for x in range(26)))
    assert len(pictures) == len(set(LIGHT_SIGNS.values())) == len(Light)


def test_a_bubble_never_leaves_the_window_and_covers_its_anchor_only_for_want_of_room():
    room = QRect(0, 0, 1366, 700)
    size = QSize(420, 180)
    for x in range(0, 1330, 95):
        for y in range(0, 660, 60):
            target = QRect(QPoint(x, y), QSize(36, 40))
            place = place_beside(target, size, room)
            assert room.contains(place)
            assert not place.intersects(target)
    assert room.contains(place_beside(QRect(100, 50, 1200, 600), size, room))
