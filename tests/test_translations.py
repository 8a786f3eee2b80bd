"""The window speaks Turkish: every text is translated and compiled, and none that is shown stays English."""

import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QLocale, Qt, QTranslator
from PySide6.QtGui import QAction, QKeySequence
from PySide6.QtWidgets import (
    QApplication,
    QComboBox,
    QMessageBox,
    QPlainTextEdit,
    QPushButton,
    QTableView,
    QTabWidget,
    QTextEdit,
    QWidget,
)
from small_survey import make_folder, make_results

from app.actions import ACTIONS
from app.application import Application
from app.settings import PreferencesStore
from processing.importing.column_mapping import ColumnMapping
from widgets.import_preview import PreviewedFile
from widgets.message_boxes import MessageBoxes
from widgets.tie_point_panel import TiePointModel

ROOT = Path(__file__).resolve().parent.parent
CASES = """
class Panel:
    def title(self):
        return f"<b>{escape(self.tr('inside an f-string'))}</b>"

    class Inner:
        label = self.tr("in a class of a class")

WORDS = N("Words", "in a table"), QCoreApplication.translate("Words", "named at once")
def look_up(text):
    return QCoreApplication.translate("Words", text)
"""


@pytest.fixture(scope="module")
def translate():
    """The script that collects and compiles, loaded by its path: ``packaging`` is no package."""
    spec = importlib.util.spec_from_file_location("leakline_translate", ROOT / "packaging" / "translate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def messages(translate):
    return translate.read_ts(translate.TS)


def write_source(root, text):
    for package in ("app", "widgets"):
        (root / package).mkdir(exist_ok=True)
    (root / "app" / "some.py").write_text(text, encoding="utf-8")
    return root


# --- collecting ---


def test_texts_are_found_wherever_they_stand(translate, tmp_path):
    found = translate.collect(write_source(tmp_path, CASES)) - translate.QT_TEXTS
    assert found == {
        ("Panel", "inside an f-string"),
        ("Inner", "in a class of a class"),
        ("Words", "in a table"),
        ("Words", "named at once"),
    }


@pytest.mark.parametrize(
    "line",
    [
        'self.tr(f"{count} leaks")',
        "self.tr(text)",
        'self.tr("{n} leaks", "", n)',
        'other.tr("OK")',
        'QCoreApplication.translate("Words", f"{count} leaks")',
        'QCoreApplication.translate(context, "leaks")',
        'N("Words", word)',
    ],
)
def test_a_text_that_no_translation_reaches_is_refused_with_its_line(translate, tmp_path, line):
    source = f"class A:\n    def b(self):\n        return {line}\n"
    with pytest.raises(translate.NotTranslatableError, match=r"app/some\.py:3"):
        translate.collect(write_source(tmp_path, source))


def test_what_is_written_is_read_again(translate, tmp_path):
    wanted = {("B", "a < b & c"): "a < b & c'dir", ("A", "{n} m"): "{n} m", ("A", "later"): ""}
    path = tmp_path / "x.ts"
    translate.write_ts(path, wanted)
    assert translate.read_ts(path) == wanted


@pytest.mark.parametrize(
    ("text", "turkish", "fault"),
    [
        ("Open {name}", "{name} aç", ""),
        ("Open {name}", "{isim} aç", "placeholders differ"),
        ("%1 of %2", "%2 içinde %1", ""),
        ("%1 of %2", "%1", "placeholders differ"),
        ("95 % sure", "%95 kesin", ""),
        ("Open", " ", "not translated"),
    ],
)
def test_lost_placeholders_are_noticed(translate, text, turkish, fault):
    assert translate.faults(text, turkish) == fault


# --- the files that are shipped ---


def test_nothing_of_lupdate_is_missing(translate, tmp_path):
    """Qt's own collector overlooks some texts, but must not find one that ours does not."""
    program = shutil.which("pyside6-lupdate", path=str(Path(sys.executable).parent))
    files = [str(path) for package in translate.SOURCES for path in sorted((ROOT / package).rglob("*.py"))]
    subprocess.run(
        [program, "-silent", "-locations", "none", *files, "-ts", str(tmp_path / "qt.ts")], timeout=120, check=True
    )
    found = set(translate.read_ts(tmp_path / "qt.ts"))
    assert len(found) > 200
    assert found <= translate.collect(ROOT)


def test_every_text_of_the_sources_is_translated(translate, messages):
    wanted = translate.collect(ROOT)
    assert len(wanted) > 300
    assert set(messages) == wanted, "run packaging/translate.py"
    assert [key for key, turkish in messages.items() if translate.faults(key[1], turkish)] == []


def test_the_file_names_no_machine_and_no_lines(translate):
    text = translate.TS.read_text(encoding="utf-8")
    assert "location" not in text
    assert str(ROOT) not in text


def test_the_compiled_file_says_what_the_text_file_says(translate, messages, qapp, tmp_path):
    shipped, fresh = QTranslator(), QTranslator()
    assert shipped.load(str(translate.QM))
    translate.compile_ts(translate.TS, tmp_path / "fresh.qm")
    assert fresh.load(str(tmp_path / "fresh.qm"))
    for (context, text), turkish in messages.items():
        assert shipped.translate(context, text) == fresh.translate(context, text) == turkish


def test_a_stale_compiled_file_would_be_noticed(translate, messages, qapp, tmp_path):
    key = ("Actions", "Confirm")
    translate.write_ts(tmp_path / "old.ts", messages | {key: "Eski"})
    translate.compile_ts(tmp_path / "old.ts", tmp_path / "old.qm")
    old = QTranslator()
    assert old.load(str(tmp_path / "old.qm"))
    assert old.translate(*key) == "Eski" != messages[key]


def test_menu_letters_differ(messages):
    menus = [turkish for (context, text), turkish in messages.items() if context == "Actions" and text.startswith("&")]
    letters = [turkish[turkish.index("&") + 1].casefold() for turkish in menus]
    assert len(letters) == len(set(letters)) == 6


# --- the window ---


@pytest.fixture
def open_window(qapp, qtbot, tmp_path):
    """Return a function that opens a window in a language, with every page filled and shown once."""
    before = qapp.styleSheet(), qapp.font(), qapp.palette(), QLocale()
    opened = []

    def build(language):
        preferences = PreferencesStore(tmp_path / "preferences.json")
        preferences.change(language=language)
        application = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
        opened.append(application)
        window = application.window
        window.boxes = AnsweringBoxes()
        window.show()
        session = application.services.session
        session.open(make_folder(tmp_path))
        session.set_results(make_results(session.folder))
        window.files._show_survey()
        window.show_page("leaks")
        for verdict in (window.review.confirm, window.review.reject, window.review.unsure, window.review.mark_here):
            verdict()
        columns = PreviewedFile("log.txt", "", 10, ("a", "b"), (("1", "2"),), ColumnMapping(()))
        for file in (PreviewedFile("sound.raw", "", 10, needs_raw_form=True), columns):
            window.data_page.preview.set_files([file])
        window.show_page("report")
        window.help.show_guide()
        qtbot.waitUntil(lambda: not application.services.jobs.running)
        return window

    yield build
    for application in opened:
        application.window.help.shown.close()
        application.window.close()
        application.shut_down()
        application.window.deleteLater()
        application._translation.use("en")
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])
    QLocale.setDefault(before[3])


def texts_of_widget(widget):
    """Return all that this widget says: on it, in tool tips, to screen readers, in lists, tabs and tables."""
    for name in ("text", "toolTip", "statusTip", "accessibleName", "placeholderText", "windowTitle", "title"):
        read = getattr(widget, name, None)
        if callable(read) and not isinstance(widget, QTextEdit):
            yield read()
    if isinstance(widget, QTextEdit | QPlainTextEdit):
        yield widget.toPlainText()
        yield widget.placeholderText()
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(i) for i in range(widget.count()))
    if isinstance(widget, QTabWidget):
        yield from (widget.tabText(i) for i in range(widget.count()))
    if isinstance(widget, QTableView):
        model = widget.model()
        roles = Qt.ItemDataRole.DisplayRole, Qt.ItemDataRole.ToolTipRole
        for column in range(model.columnCount()):
            yield from (model.headerData(column, Qt.Orientation.Horizontal, role) for role in roles)
            if not isinstance(model, TiePointModel):  # its cells hold names that the operator gave
                yield from (model.data(model.index(row, column), roles[0]) for row in range(model.rowCount()))


def shown_texts(window):
    """Return each piece of text that ``window`` shows, without letters and numbers put before or around it."""
    for widget in [window, *window.findChildren(QWidget)]:
        for text in texts_of_widget(widget):
            if isinstance(text, str):
                yield from pieces(text)
    for action in window.findChildren(QAction):
        for text in (action.text(), action.iconText(), action.toolTip(), action.statusTip()):
            yield from pieces(text)


def pieces(text):
    for piece in re.split(r"\n|\s{3,}(?:·\s+)?", text):
        yield piece
        yield re.sub(r"^\d+ +", "", piece)
        yield from piece.split(": ")  # "Undo: mark by hand"


def english_among(texts, translate, messages):
    """Return those of ``texts`` that are English though there is Turkish for them, whatever fills the placeholders."""
    english = {text.replace("&", "") for (_, text), turkish in messages.items() if text != turkish}
    english -= set(messages.values())
    patterns = [re.compile("(.+)".join(map(re.escape, translate.FIELD.split(text)))) for text in english]
    return {text for text in texts if text and any(pattern.fullmatch(text.replace("&", "")) for pattern in patterns)}


def test_nothing_in_the_turkish_window_stays_english(open_window, translate, messages):
    texts = set(shown_texts(open_window("tr")))
    assert english_among(texts, translate, messages) == set()
    assert {"Onayla", "Veri", "karar bekliyor", "İçindekiler", "Anlamı", "16 bit", "Enlem (°)"} <= texts


def test_the_same_search_finds_the_english_of_an_english_window(open_window, translate, messages):
    found = english_among(set(shown_texts(open_window("en"))), translate, messages)
    wanted = {"Confirm", "Data", "undecided", "Contents", "Meaning", "At (m)", "mark by hand"}
    assert wanted <= found
    assert len(found) > 200


def test_keys_work_alike_in_both_languages(open_window):
    open_window("tr")
    for row in ACTIONS:
        for key in row.keys:
            assert QKeySequence(key) == QKeySequence.fromString(key, QKeySequence.SequenceFormat.PortableText)


def test_the_button_of_a_message_is_turkish_too(open_window, monkeypatch):
    shown = []
    monkeypatch.setattr(QMessageBox, "exec", lambda box: shown.extend(b.text() for b in box.findChildren(QPushButton)))
    MessageBoxes(open_window("tr"), "tr").tell("Bir şey oldu.")
    assert shown == ["Tamam"]
