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
from processing.readiness import Lead, Light, Step
from processing.survey import PipeInfo, Survey, TiePoint, Verdict
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


def test_with_nothing_open_all_lights_are_grey(application):
    assert set(lights(application.window).values()) == {Light.GREY}


def test_one_tie_point_is_yellow_and_a_second_knowledge_makes_it_green(application, opened):
    window = application.window
    assert lights(window)["ties"] is Light.YELLOW
    assert opened.write_survey(replace(opened.survey, pipe=PipeInfo(length_m=100.0)))
    assert lights(window)["ties"] is Light.GREEN
    assert lights(window)["data"] is Light.YELLOW  # the form has changed since it was processed
    assert opened.write_survey(replace(opened.survey, pipe=PipeInfo(), tie_points=()))
    assert lights(window)["ties"] is Light.RED


def test_a_tie_point_that_is_switched_off_does_not_count(opened):
    point = TiePoint("valve", 20.0, chainage_m=40.0, enabled=False)
    assert opened.write_survey(replace(opened.survey, tie_points=(*opened.survey.tie_points, point)))
    assert facts_of_session(opened, None, None, "length").ties == 1


def test_the_light_of_the_leaks_counts_down_with_the_verdicts(application, opened):
    window = application.window
    for left in (4, 3, 2, 1):
        assert lights(window)["leaks"] is Light.YELLOW
        assert f"{left} of 4" in window.step_bar.light_button("leaks").toolTip()
        window.review.confirm()
    assert lights(window)["leaks"] is Light.GREEN
    window.review.undo()
    assert lights(window)["leaks"] is Light.YELLOW


def test_the_lights_follow_a_verdict_by_themselves(application, opened, qtbot):
    window = application.window
    for _ in range(4):
        window.review.reject()
    qtbot.waitUntil(lambda: window.step_bar.light("leaks") is Light.GREEN, timeout=3000)


def test_a_verdict_after_the_export_makes_the_report_yellow_again(application, opened):
    window, guide = application.window, application.window.work.guide
    for candidate in opened.ordered_ids():
        opened.select(candidate)
        window.review.confirm()
    assert lights(window)["report"] is Light.YELLOW
    export = opened.folder.new_export("leakline", "", opened.run)
    export.mkdir()
    guide._on_exported()
    assert lights(window)["report"] is Light.GREEN
    os.utime(export, (1.0, 1.0))
    guide._on_exported()
    assert guide.facts().changed_since
    assert lights(window)["report"] is Light.YELLOW


def test_pressing_a_light_tells_why_and_its_button_leads_there(application, opened):
    window = application.window
    QTest.mouseClick(window.findChild(QToolButton, "light_leaks"), LEFT)
    shown = bubble(window)
    assert shown.isVisible()
    assert any("4 of 4" in row.text for row in shown.rows)
    window.show_page("data")
    QTest.mouseClick(shown.findChild(QPushButton, "lead_undecided"), LEFT)
    assert (window.page, shown.isVisible()) == ("leaks", False)
    assert opened.decision(opened.selected).verdict is Verdict.NONE


def test_by_keyboard_all_that_is_missing_is_shown_and_left_again(application, opened):
    window = application.window
    window.activateWindow()
    window.actions_by_id["missing"].trigger()
    shown = bubble(window)
    assert len(shown.rows) == len(Step)
    assert window.rect().contains(shown.geometry())
    assert shown.isAncestorOf(window.focusWidget())
    QTest.keyClick(window.focusWidget(), Qt.Key.Key_Escape)
    assert not shown.isVisible()
    window.actions_by_id["missing"].trigger()
    window.actions_by_id["missing"].trigger()
    assert not shown.isVisible()


def test_every_lead_goes_somewhere(application, opened):
    window = application.window
    elsewhere = {Lead.FORM: "data", Lead.TIES: "path", Lead.UNDECIDED: "leaks", Lead.EXPORT: "report"}
    for lead in Lead:
        if lead not in (Lead.OPEN, Lead.PROCESS):  # these ask for a folder, or begin to work
            window.show_page("start")
            window.work.guide.go(lead.value)
            assert window.page == elsewhere.get(lead, lead.value)


def test_the_tie_points_step_leads_beside_the_form_while_there_is_no_path(application, tmp_path):
    session = application.services.session
    session.open(make_folder(tmp_path))
    window = application.window
    window.show_page("data")
    QTest.mouseClick(window.findChild(QToolButton, "step_ties"), LEFT)
    assert window.page == "data"
    assert window.data_page.tie_points.isVisible()


def test_a_light_is_told_to_who_cannot_see_it(application, opened):
    window = application.window
    lights(window)
    button = window.findChild(QToolButton, "light_leaks")
    assert button.accessibleName() == "Leaks: mind"
    assert button.accessibleDescription() == button.toolTip() != ""
    assert button.height() >= 40 <= button.width()


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


def test_facts_without_a_survey_are_empty(application):
    assert not facts_of_session(application.services.session, None, None, "").is_open
    assert application.services.session.survey == Survey()
