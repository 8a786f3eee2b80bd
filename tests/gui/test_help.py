"""The manual window, the key sheet and the tour, by mouse and by keyboard."""

import unicodedata

import pytest
from answering import AnsweringBoxes, CountingSink
from pypdf import PdfReader
from PySide6.QtCore import QEvent, QPoint, QRect, Qt, QUrl
from PySide6.QtGui import QTextDocument
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QLineEdit, QPushButton, QTextBrowser

from app import manual
from app.actions import ACTIONS
from app.application import Application
from app.help_control import key_rows
from app.settings import PreferencesStore
from widgets.key_sheet import LARGEST, STEP, USUAL, KeySheetWindow, write_pdf
from widgets.manual_window import ManualWindow, ShownPage

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en")
    application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    application.window.boxes = AnsweringBoxes()
    application.window.resize(1366, 728)
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


# --- manual ---


@pytest.fixture
def window(qtbot):
    pages = [ShownPage(p.name, p.title, p.markdown, p.text) for p in manual.pages("en")]
    window = ManualWindow(pages, manual.folder("en"))
    qtbot.addWidget(window)
    window.show()
    window.show_page("quick-start")
    return window


def test_links_are_followed_and_gone_back_from(window):
    window._browser.anchorClicked.emit(QUrl("lights.md"))
    window._browser.anchorClicked.emit(QUrl("https://example.org/lights.md"))
    window._browser.anchorClicked.emit(QUrl("no-such-page.md"))
    assert window.page == "lights"
    window.show_page("path")
    QTest.mouseClick(window.findChild(QPushButton, "manual_back"), LEFT)
    QTest.mouseClick(window.findChild(QPushButton, "manual_back"), LEFT)
    assert window.page == "quick-start"
    assert not window.findChild(QPushButton, "manual_back").isEnabled()
    QTest.mouseClick(window.findChild(QPushButton, "manual_forward"), LEFT)
    assert window.page == "lights"
    window.activateWindow()
    window.show_page("path")
    QTest.keyClick(window._browser, Qt.Key.Key_Backspace)
    assert window.page == "lights"
    window.show_page("report")  # a new way: what lay ahead is forgotten
    assert not window.findChild(QPushButton, "manual_forward").isEnabled()


def test_the_search_looks_through_all_text_and_puts_titles_first(window):
    field = window.findChild(QLineEdit, "manual_search")
    field.setText("dry hole")
    with_it = {p.name for p in manual.pages("en") if "dry" in p.text.lower() and "hole" in p.text.lower()}
    assert set(window.found()) == with_it != set()
    field.setText("tie points")
    assert window.found()[0] == "tie-points"
    QTest.keyClick(field, Qt.Key.Key_Return)
    assert window.page == "tie-points"
    assert window._browser.extraSelections()
    field.setText("xyzzy")
    assert window.found() == []
    field.clear()
    assert window.found() == list(manual.PAGES)


def test_pictures_of_the_pages_are_shown(window):
    window.show_page("review")
    picture = manual.PICTURE.findall(manual.raw("review", "en"))[0]
    for width in (1100, 700):
        window.resize(width, 600)
        window._fit()
        image = window._browser.loadResource(QTextDocument.ResourceType.ImageResource.value, QUrl(picture))
        assert 200 < image.width() <= window._browser.viewport().width()
        assert not window._browser.horizontalScrollBar().isVisible()
    assert window.page == "review"


# --- keys ---


@pytest.fixture
def sheet(qtbot):
    sheet = KeySheetWindow(key_rows())
    qtbot.addWidget(sheet)
    sheet.show()
    return sheet


def test_the_sheet_has_every_key_of_the_table_and_the_gestures(sheet):
    text = sheet.findChild(QTextBrowser).toPlainText()
    for row in ACTIONS:
        assert not row.keys or row.text in text, row.id
    assert "two fingers" in text


def test_the_sheet_is_searched_by_what_a_key_does(sheet):
    sheet.findChild(QLineEdit).setText("next undecided")
    assert {row.text for row in sheet.shown()} >= {"Confirm", "Next undecided"}
    assert all("undecided" in row.tip.lower() + row.text.lower() for row in sheet.shown())
    assert "Zoom in" not in sheet.findChild(QTextBrowser).toPlainText()


def test_the_printed_sheet_holds_all_keys_on_a_few_pages(qapp, tmp_path):
    file = tmp_path / "keys.pdf"
    write_pdf(key_rows(), "Keys", file)
    reader = PdfReader(file)
    extracted = " ".join(page.extract_text() for page in reader.pages)
    text = " ".join(unicodedata.normalize("NFKC", extracted).split())  # without ligatures
    for row in ACTIONS:
        if row.keys:
            assert unicodedata.normalize("NFKC", row.text) in text, row.id
    assert 1 <= len(reader.pages) <= 8
    with pytest.raises(OSError, match="No such file"):
        write_pdf(key_rows(), "Keys", tmp_path / "nowhere" / "keys.pdf")


# --- in the window ---


def test_manual_and_key_sheet_open_where_one_is_and_once(application):
    window = application.window
    window.actions_by_id["help"].trigger()
    assert window.help.shown.page == "quick-start"
    first = window.help.shown
    window.show_page("data")
    window.actions_by_id["help"].trigger()
    assert window.help.shown is first
    assert first.page == "importing"
    first.close()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    assert window.help.shown is None
    # letters of the key sheet grow, and their size is remembered
    window.actions_by_id["keys"].trigger()
    QTest.mouseClick(window.help.shown.findChild(QPushButton, "keys_larger"), LEFT)
    assert window.help.shown.points == USUAL + STEP
    window.actions_by_id["keys"].trigger()
    assert window.help.shown.points == USUAL + STEP
    for _ in range(20):
        window.help.shown._resize(+STEP)
    assert window.help.shown.points == LARGEST
    assert not window.help.shown.findChild(QPushButton, "keys_larger").isEnabled()
    window.help.shown.close()


def test_the_tour_is_offered_once_takes_no_keyboard_and_is_called_again_by_key(application, qtbot):
    window, preferences = application.window, application.services.preferences
    tour = window.work.tour
    held = window.focusWidget()
    tour.offer()
    assert window.focusWidget() is held
    assert preferences.values.tour_seen
    bubble = tour.shown
    QTest.mouseClick(window.findChild(QPushButton, "tour_close"), LEFT)
    assert tour.shown is None
    tour.offer()
    assert tour.shown is None
    window.work.settings.show()
    QTest.mouseClick(window.findChild(QPushButton, "show_hints"), LEFT)
    assert tour.shown is not None
    bubble.close_bubble()
    window.work.start.show()
    # five hints stand beside visible widgets and cover none of them
    window.activateWindow()
    window.actions_by_id["tour"].trigger()
    said = []
    for _ in range(5):
        anchor = bubble._anchor
        assert anchor is not None
        assert anchor.isVisible()
        target = QRect(anchor.mapTo(window, QPoint()), anchor.size())
        assert window.rect().contains(bubble.geometry())
        assert not bubble.geometry().intersects(target)
        said.append(bubble.words)
        QTest.mouseClick(bubble.next_button, LEFT)
    assert tour.shown is None
    assert len(set(said)) == 5
    assert "Ctrl+O" in said[0]
    assert "Ctrl+E" in said[4]
    # by keyboard
    window.actions_by_id["tour"].trigger()
    bubble.setFocus()
    for key, words in ((Qt.Key.Key_Right, said[1]), (Qt.Key.Key_Left, said[0]), (Qt.Key.Key_Left, said[0])):
        QTest.keyClick(bubble, key)
        assert bubble.words == words
    window.actions_by_id["tour"].trigger()
    assert bubble.words == said[1]
    window.actions_by_id["tour"].trigger()
    QTest.keyClick(bubble, Qt.Key.Key_Escape)
    assert tour.shown is None
    # on another page it points at what is visible there
    tour.show()
    before = bubble._anchor
    window.show_page("data")
    qtbot.waitUntil(lambda: bubble._anchor is not before)
    assert bubble._anchor.objectName() == "tool_open"
