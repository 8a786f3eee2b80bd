"""The start page shows recent surveys from what is remembered of them, and those whose folder is gone as such."""

import json
import shutil
from dataclasses import replace
from itertools import pairwise

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QPushButton, QToolButton
from small_survey import make_folder, make_results, make_track

from app.application import Application
from app.settings import PreferencesStore
from app.survey_cards import OUTLINE_POINTS, CardStore, SurveyCard, outline
from widgets.folding import folded, has_all_words
from widgets.recent_surveys import BETWEEN, MANY, Presence, RecentRow, RecentSurveys

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "config" / "preferences.json")
    preferences.change(language="en", tour_seen=True)
    application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    application.window.boxes = AnsweringBoxes()
    application.window.show()
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    yield application
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    application.window.close()
    application.shut_down()
    application.window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])


def shown(window):
    return {row.row.path: row for row in window.start_page.recent.shown}


def lines(window):
    return {path: row.lines() for path, row in shown(window).items()}


def test_a_closed_survey_is_listed_with_its_review_and_its_path(application, tmp_path, qtbot):
    window, session = application.window, application.services.session
    folder = make_folder(tmp_path)
    path = str(folder.path)
    session.open(folder)
    session.set_results(make_results(folder))
    application.services.preferences.remember_recent(folder.path)
    window.show_page("leaks")
    window.review.confirm()
    window.review.reject()
    assert window.start_page.recent.shown == ()
    window.files.close_survey()
    qtbot.waitUntil(lambda: not application.services.jobs.running)
    assert window.page == "start"
    assert not any(window.findChild(QToolButton, f"page_{page}").isChecked() for page in ("data", "leaks", "report"))
    name, _where, state = lines(window)[path]
    assert name == f"Station Road{BETWEEN}4 May 2026"
    assert state == f"2 of 4 decided{BETWEEN}1 confirmed"
    row = shown(window)[path].row
    assert row.length_m == pytest.approx(100.0)
    assert row.presence is Presence.THERE
    assert (row.outline[0], row.outline[-1]) == ((0.0, 0.0), (100.0, 0.0))


def test_the_list_knows_remembered_unknown_pinned_and_missing_surveys(application, tmp_path, qtbot, monkeypatch):
    window, preferences = application.window, application.services.preferences

    def refresh():
        window.work.start.refresh()
        qtbot.waitUntil(lambda: not application.services.jobs.running)

    # one that is remembered is not opened to be shown
    known = tmp_path / "a.leakline"
    known.mkdir()
    (known / "survey.db").write_bytes(b"no database at all")
    window.work.start._cards.write(str(known), SurveyCard(name="A", candidates=23, decided=7))
    preferences.remember_recent(known)
    asked = []
    with monkeypatch.context() as patch:
        patch.setattr("app.start_control.peeked", asked.append)
        refresh()
    assert asked == []
    assert [line[2] for line in lines(window).values()] == ["7 of 23 decided"]
    # one that nobody remembers is asked from its database
    with make_folder(tmp_path) as folder:
        path = folder.path
    preferences.remember_recent(path)
    refresh()
    assert lines(window)[str(path)][0] == f"Station Road{BETWEEN}4 May 2026"
    assert lines(window)[str(path)][2] == "Not processed yet"
    # pinned ones stand on top
    assert list(shown(window)) == [str(path), str(known)]
    QTest.mouseClick(shown(window)[str(known)].findChild(QToolButton, "recent_pin"), LEFT)
    assert list(shown(window)) == [str(known), str(path)]
    assert PreferencesStore(preferences.file).values.pinned == [str(known)]
    QTest.mouseClick(shown(window)[str(known)].findChild(QToolButton, "recent_pin"), LEFT)
    assert list(shown(window)) == [str(path), str(known)]
    # a pulled stick is told, and its survey can be taken off the list
    shutil.rmtree(path)
    refresh()
    row = shown(window)[str(path)]
    assert row.lines()[0].startswith("Station Road")  # what was known of it stays
    assert row.lines()[2].startswith("Not there now")
    QTest.mouseClick(row.findChild(QToolButton, "recent_remove"), LEFT)
    assert list(shown(window)) == [str(known)]
    assert preferences.values.recent == [str(known)]
    # the large buttons lead to settings and manual, and the start page is found again
    QTest.mouseClick(window.findChild(QPushButton, "start_settings"), LEFT)
    assert window.page == "settings"
    window.work.start.show()
    assert window.page == "start"
    QTest.mouseClick(window.findChild(QPushButton, "start_manual"), LEFT)
    assert window.help.shown.isVisible()
    window.help.shown.close()
    qtbot.waitUntil(lambda: not application.services.jobs.running)


# --- the list alone ---


@pytest.fixture
def surveys(qtbot):
    widget = RecentSurveys()
    qtbot.addWidget(widget)
    widget.resize(600, 500)
    widget.show()
    return widget


def some_rows(count):
    return [RecentRow(f"/s/{n}", f"Survey {n}", "/s", candidates=2, decided=1) for n in range(count)]


def test_the_list_by_keyboard_alone(surveys):
    chosen, removed = [], []
    surveys.chosen.connect(chosen.append)
    surveys.removal_asked.connect(removed.append)
    surveys.set_rows(some_rows(3))
    surveys.shown[0].button.setFocus()
    for key in (Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Down, Qt.Key.Key_Up):
        QTest.keyClick(QApplication.focusWidget(), key)
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Return)
    QTest.keyClick(QApplication.focusWidget(), Qt.Key.Key_Delete)
    assert (chosen, removed) == (["/s/1"], ["/s/1"])


def test_a_long_list_is_searched_without_minding_turkish_letters(surveys):
    rows = some_rows(MANY)
    assert not surveys.findChild(QLineEdit).isVisible()
    rows += [RecentRow("/s/x", "Şişli Çarşı", "/s", client="İSKİ"), RecentRow("/s/y", "Kadıköy", "/s")]
    surveys.set_rows(rows)
    field = surveys.findChild(QLineEdit)
    assert field.isVisible()
    field.setText("SISLI iski")
    assert [row.row.path for row in surveys.shown] == ["/s/x"]
    field.setText("kadikoy")
    assert [row.row.path for row in surveys.shown] == ["/s/y"]
    field.setText("nowhere")
    assert surveys.shown == ()


def test_rows_are_large_enough_for_gloves_and_say_all_to_a_screen_reader(surveys):
    surveys.set_rows([replace(some_rows(1)[0], client="Water Works", outline=((0.0, 0.0), (5.0, 5.0)))])
    row = surveys.shown[0]
    assert row.button.height() >= 60
    for tool in row.findChildren(QToolButton):
        assert tool.width() >= 40 <= tool.height()
    assert row.button.accessibleName() == "Survey 0. Water Works. 1 of 2 decided"


def test_folding_makes_spellings_equal():
    assert folded("ŞİŞLİ") == folded("şişli") == "sisli"
    assert folded("Iğdır") == "igdir"
    assert has_all_words("", "anything")
    assert not has_all_words("b", "a")


# --- cards ---


def test_a_card_comes_back_as_it_was_written(tmp_path):
    card = SurveyCard("Name", "2026-05-04", "Client", "steel", 0.3, 900.5, 23, 7, 3, "2026-05-05", True, ((0.0, 1.5),))
    store = CardStore(tmp_path / "cards")
    store.write("/a", card)
    assert store.read("/a") == card
    assert store.read("/b") is None
    store.forget("/a")
    assert store.read("/a") is None


@pytest.mark.parametrize(
    "content", ["", "[]", "{", '{"name": 5, "outline": "x"}', '{"outline": [[1], ["a", 2], null]}']
)
def test_a_damaged_card_is_as_if_less_were_known(tmp_path, content, caplog):
    store = CardStore(tmp_path)
    store.write("/a", SurveyCard(name="A"))
    next(tmp_path.glob("*.json")).write_text(content, encoding="utf-8")
    found = store.read("/a")
    assert found is None or (found.name, found.outline) == ("", ())


def test_a_card_of_a_million_points_is_not_read(tmp_path):
    store = CardStore(tmp_path)
    store.write("/a", SurveyCard())
    next(tmp_path.glob("*.json")).write_text(json.dumps({"outline": [[0, 0]] * 100_000}), encoding="utf-8")
    assert store.read("/a") is None


def test_the_outline_is_even_along_the_pipe_however_long_the_device_rested():
    track = make_track()
    points = outline(track)
    assert len(points) == OUTLINE_POINTS
    steps = [b[0] - a[0] for a, b in pairwise(points)]
    assert max(steps) - min(steps) < 0.5
