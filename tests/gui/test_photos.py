"""Photos come by dialog, drop and paste, are undone and redone, and say how far from the leak they were taken."""

from dataclasses import replace

import pytest
from kept_window import kept_fixture, window_fixture
from PIL import Image
from PySide6.QtCore import QEvent, QMimeData, QPoint, QPointF, Qt, QUrl
from PySide6.QtGui import QDragEnterEvent, QDropEvent, QGuiApplication, QImage
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication, QFileDialog, QLabel, QLineEdit, QPushButton
from small_survey import make_folder, make_results

from app import photo_control
from app.dig_commands import RecordDig
from app.main_window import MainWindow
from app.photo_commands import RemovePhoto
from app.photo_control import picture_paths, read_photo
from processing.errors import ErrorCode
from processing.review_facts import DigFinding, DigResult
from processing.storage.folder import SurveyFolder
from processing.survey import Launch
from widgets.photo_panel import PhotoDialog

KEY, MODIFIER = Qt.Key, Qt.KeyboardModifier
LEFT = Qt.MouseButton.LeftButton


kept = kept_fixture()
window = window_fixture()


@pytest.fixture
def services(kept, window):
    return kept.services


@pytest.fixture
def session(services):
    return services.session


def picture(path, colour=(200, 30, 40), place=None):
    exif = Image.Exif()
    if place is not None:
        exif.get_ifd(0x8825).update({1: "N", 2: (place[0], 0.0, 0.0), 3: "E", 4: (place[1], 0.0, 0.0)})
        exif.get_ifd(0x8769)[0x9003] = "2026:05:04 10:11:12"
    Image.new("RGB", (80, 60), colour).save(path, exif=exif)
    return path


@pytest.fixture
def bring(qtbot, window, services):
    def call(*paths):
        window.work.photos.bring(paths)
        qtbot.waitUntil(lambda: not services.jobs.running)

    return call


def on_disc(session):
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        return [(photo.number, photo.caption) for photo in other.photos.photos()]


def label(window, name):
    return window.work.photos.panel.findChild(QLabel, name).text()


def test_pictures_of_the_dialog_are_attached_to_the_leak_that_was_selected_then(
    qtbot, window, session, services, tmp_path, monkeypatch
):
    chosen = [str(picture(tmp_path / "a.jpg")), str(picture(tmp_path / "b.png", (10, 200, 30)))]
    monkeypatch.setattr(QFileDialog, "getOpenFileNames", lambda *_args: (chosen, ""))
    first = session.row(session.selected).candidate
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_P, MODIFIER.ShiftModifier)
    session.select(session.ordered_ids()[2])  # the hand is quicker than the copying
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert on_disc(session) == [(first.label, ""), (first.label, "")]
    session.select(first.id)
    assert window.review_page.tools.is_in_front("photos")
    panel = window.work.photos.panel
    qtbot.waitUntil(lambda: all(photo.image is not None for photo in panel._photos) and len(panel._photos) == 2)
    assert panel._photos[1].image.pixelColor(40, 30).green() > 150


def test_undo_withdraws_and_redo_brings_back_the_same_photo(window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    (before,) = session.folder.photos.photos()
    session.undo_stack.undo()
    assert on_disc(session) == []
    assert session.folder.photos.path(before).is_file()
    session.undo_stack.redo()
    assert session.folder.photos.photos() == (before,)


def test_a_caption_is_on_disc_when_enter_is_pressed_and_is_undone(qtbot, window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    number = session.row(session.selected).candidate.label
    field = window.work.photos.panel.findChild(QLineEdit, "photo_caption")
    field.setFocus()
    QTest.keyClicks(field, "Valve lid p1")
    assert session.decisions == {}  # the digit was text
    QTest.keyClick(field, KEY.Key_Return)
    assert on_disc(session) == [(number, "Valve lid p1")]
    assert not field.hasFocus()
    session.undo_stack.undo()
    assert on_disc(session) == [(number, "")]
    assert field.text() == ""


def test_a_caption_that_is_being_typed_is_kept_when_the_window_closes(window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    field = window.work.photos.panel.findChild(QLineEdit, "photo_caption")
    field.setFocus()
    QTest.keyClicks(field, "half a")
    window.work.photos.stop()  # what closing the window does
    assert on_disc(session)[0][1] == "half a"


def test_removing_is_undone(window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"), picture(tmp_path / "b.jpg", (1, 2, 3)))
    window.work.photos.panel.findChild(QPushButton, "photo_remove").click()
    assert len(on_disc(session)) == 1
    session.undo_stack.undo()
    assert len(on_disc(session)) == 2


def test_the_same_picture_is_not_attached_twice(window, session, bring, tmp_path):
    told = []
    window.work.photos.told.connect(told.append)
    bring(picture(tmp_path / "a.jpg"))
    bring(tmp_path / "a.jpg")
    assert len(on_disc(session)) == 1
    assert "already" in told[0]


def test_a_file_that_is_no_picture_is_told_and_the_others_come(window, session, bring, tmp_path):
    (tmp_path / "broken.jpg").write_bytes(b"nothing")
    bring(tmp_path / "broken.jpg", picture(tmp_path / "a.jpg"))
    assert len(on_disc(session)) == 1
    assert window.boxes.told == [ErrorCode.PHOTO_UNKNOWN]


def dropped(window, paths):
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(path)) for path in paths])
    enter = QDragEnterEvent(QPoint(5, 5), Qt.DropAction.CopyAction, mime, LEFT, MODIFIER.NoModifier)
    QApplication.sendEvent(window.review_page, enter)
    event = QDropEvent(QPointF(5, 5), Qt.DropAction.CopyAction, mime, LEFT, MODIFIER.NoModifier)
    if enter.isAccepted():
        QApplication.sendEvent(window.review_page, event)
    return enter.isAccepted()


def test_pictures_can_be_dropped_on_the_page_and_folders_are_left_to_the_window(
    qtbot, window, session, services, tmp_path
):
    assert dropped(window, [picture(tmp_path / "a.jpg"), picture(tmp_path / "b.png", (0, 0, 9))])
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert len(on_disc(session)) == 2
    mime = QMimeData()
    mime.setUrls([QUrl.fromLocalFile(str(tmp_path))])
    assert picture_paths(mime) == []
    mime.setUrls([QUrl.fromLocalFile(str(tmp_path / "a.jpg")), QUrl.fromLocalFile(str(tmp_path / "route.kml"))])
    assert picture_paths(mime) == []


def test_a_picture_in_the_clipboard_is_pasted(qtbot, window, session, services):
    image = QImage(40, 30, QImage.Format.Format_RGB32)
    image.fill(Qt.GlobalColor.darkGreen)
    QGuiApplication.clipboard().setImage(image)
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_V, MODIFIER.ControlModifier)
    qtbot.waitUntil(lambda: not services.jobs.running)
    (photo,) = session.folder.photos.photos()
    with Image.open(session.folder.photos.path(photo)) as stored:
        assert stored.size == (40, 30)
        assert stored.convert("RGB").getpixel((3, 3)) == (0, 128, 0)
    QGuiApplication.clipboard().clear()
    told = []
    window.work.photos.told.connect(told.append)
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_V, MODIFIER.ControlModifier)
    assert len(told) == 1
    assert len(on_disc(session)) == 1


def test_the_distance_to_the_stated_place_is_told(qtbot, window, session, bring, tmp_path):
    session.write_survey(replace(session.survey, launch=Launch(latitude=41.0, longitude=29.0)))
    at = session.row(session.selected).candidate.position_w_m  # due east of the launch
    bring(picture(tmp_path / "a.jpg", place=(41.0, 29.0)))  # taken at the launch itself
    qtbot.waitUntil(lambda: label(window, "photo_told") != "")
    assert f"taken {at[0]:.0f} m from the stated place" in label(window, "photo_told")
    assert "4 May 2026, 10:11" in label(window, "photo_told")
    assert "this leak?" not in label(window, "photo_told")
    bring(picture(tmp_path / "b.jpg", (9, 9, 9), place=(42.0, 29.0)))
    # a degree of latitude is 111.1 km there (WGS 84): another leak's photo, if not another town's
    qtbot.waitUntil(lambda: "111," in label(window, "photo_told"))
    assert "this leak?" in label(window, "photo_told")


def test_a_photo_without_a_place_says_so_and_one_of_a_local_survey_tells_its_own(qtbot, window, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    qtbot.waitUntil(lambda: "does not say" in label(window, "photo_told"))
    bring(picture(tmp_path / "b.jpg", (5, 5, 5), place=(41.0, 29.0)))
    qtbot.waitUntil(lambda: "41.00000" in label(window, "photo_told"))


def test_p_shows_the_photos_and_leads_back_and_the_tab_counts_them(window, session, bring, tmp_path):
    tools = window.review_page.tools
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_P)
    assert tools.is_in_front("photos")
    QTest.keyClick(QApplication.focusWidget(), KEY.Key_P)
    assert not tools.is_in_front("photos")
    bring(picture(tmp_path / "a.jpg"))
    tabs = window.review_page.findChild(object, "side_tools")
    assert "Photos (1)" in [tabs.tabText(row) for row in range(tabs.count())]


def test_a_lost_file_is_told_not_shown(qtbot, window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    (photo,) = session.folder.photos.photos()
    session.folder.photos.path(photo).unlink()
    window.work.photos._forget()
    panel = window.work.photos.panel
    qtbot.waitUntil(lambda: panel._photos[0].image is not None)
    assert panel._photos[0].image.isNull()
    assert photo.file in panel._photos[0].told


def test_a_read_only_survey_shows_photos_and_takes_none(qtbot, window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    path = session.folder.path
    session.close()
    session.open(SurveyFolder.open(path, read_only=True))
    session.set_results(make_results(session.folder))
    window.show_page("leaks")
    window.work.photos.toggle()
    assert not window.work.photos.panel.findChild(QPushButton, "photo_attach").isEnabled()
    bring(picture(tmp_path / "b.jpg", (3, 3, 3)))
    assert window.boxes.told[-1] is ErrorCode.SURVEY_READ_ONLY
    assert len(on_disc(session)) == 1


def test_large_shows_the_photos_one_by_one(qtbot, window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"), picture(tmp_path / "b.jpg", (1, 2, 3)))
    panel = window.work.photos.panel
    qtbot.waitUntil(lambda: all(photo.image is not None for photo in panel._photos))
    dialog = PhotoDialog(panel._photos, 0, window)
    qtbot.addWidget(dialog)
    dialog.show()
    QTest.keyClick(dialog, KEY.Key_Right)
    assert dialog.shown == panel._photos[1]
    QTest.keyClick(dialog, KEY.Key_Right)
    assert dialog.shown == panel._photos[1]
    QTest.keyClick(dialog, KEY.Key_Space)
    assert not dialog.isVisible()


def test_a_leak_with_more_photos_than_are_kept_shows_all_of_them_and_then_reads_no_more(
    qtbot, window, bring, tmp_path, monkeypatch
):
    read = []
    monkeypatch.setattr(
        photo_control, "read_photo", lambda sha256, *rest: (read.append(sha256), read_photo(sha256, *rest))[1]
    )
    count = photo_control.KEPT + 2
    bring(*(picture(tmp_path / f"{k}.jpg", (10 * k, 99, 0)) for k in range(count)))
    panel = window.work.photos.panel
    qtbot.waitUntil(lambda: len(panel._photos) == count and all(photo.image is not None for photo in panel._photos))
    qtbot.wait(150)  # one that pushes out another would be read again at once
    assert len(read) == len(set(read)) == count


def test_a_caption_belongs_to_the_photo_it_was_typed_below_wherever_the_selection_goes(
    window, session, bring, tmp_path
):
    first, second = session.ordered_ids()[:2]
    bring(picture(tmp_path / "a.jpg"))
    session.select(second)
    bring(picture(tmp_path / "b.jpg", (1, 2, 3)))
    session.select(first)
    field = window.work.photos.panel.findChild(QLineEdit, "photo_caption")
    field.setFocus()
    QTest.keyClicks(field, "of the first")
    session.select(second)  # by a button or a menu, which take no focus
    assert field.text() == ""
    QTest.keyClick(field, KEY.Key_Return)
    numbers = [session.row(i).candidate.label for i in (first, second)]
    assert sorted(on_disc(session)) == sorted(zip(numbers, ("of the first", ""), strict=True))
    session.undo_stack.undo()
    assert sorted(on_disc(session)) == sorted(zip(numbers, ("", ""), strict=True))


def test_a_caption_that_is_being_typed_is_kept_when_the_survey_is_closed(window, session, bring, tmp_path):
    bring(picture(tmp_path / "a.jpg"))
    field = window.work.photos.panel.findChild(QLineEdit, "photo_caption")
    field.setFocus()
    QTest.keyClicks(field, "half a")
    path = session.folder.path
    session.close()
    with SurveyFolder.open(path, read_only=True) as other:
        assert [photo.caption for photo in other.photos.photos()] == ["half a"]


def test_photos_never_go_to_another_survey_that_was_opened_while_they_were_copied(
    qtbot, window, session, services, tmp_path
):
    told = []
    window.work.photos.told.connect(told.append)
    results = session.results
    window.work.photos.bring([picture(tmp_path / "a.jpg")])
    session.open(make_folder(tmp_path / "other"))
    session.set_results(make_results(session.folder))
    qtbot.waitUntil(lambda: not services.jobs.running)
    assert results is not session.results
    assert on_disc(session) == []
    assert not session.undo_stack.canUndo()
    assert len(told) == 1
    assert "Attach them again" in told[0]


def test_photos_and_digs_are_undone_after_the_window_was_made_again_in_another_language(
    qtbot, window, session, services, bring, tmp_path
):
    bring(picture(tmp_path / "a.jpg"))
    number = session.row(session.selected).candidate.label
    gone = MainWindow(services, "tr")
    session.push(RecordDig(gone.work.digs.ledger, "dig", number, DigResult(number, DigFinding.LEAK)))
    session.push(RemovePhoto(gone.work.photos.desk, "photo", session.folder.photos.photos()[0]))
    qtbot.waitUntil(lambda: not services.jobs.running)  # the language changes only when no work is in progress
    gone.close()
    gone.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    assert on_disc(session) == []
    session.undo_stack.undo()
    assert len(on_disc(session)) == 1
    assert set(window.work.digs.ledger.results) == {number}
    session.undo_stack.undo()
    assert window.work.digs.ledger.results == {}
    assert session.folder.digs.results() == {}
