"""The report page: what is chosen, what an export makes of it, its pages as pictures, the way to what is undecided."""

from dataclasses import replace

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, Qt
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QAbstractButton, QApplication, QCheckBox, QComboBox, QLineEdit, QListWidget, QPushButton
from small_survey import make_folder, make_results

from app.application import Application
from app.handover_choices import handover_options
from app.settings import PreferencesStore
from processing.quantities import Units
from processing.reporting.options import ColumnScheme, FileKind, HandoverOptions
from processing.survey import Decision, Launch, Verdict
from widgets.handover_form import HandoverForm
from widgets.report_panel import PastExport, ReportPanel

LEFT = Qt.MouseButton.LeftButton
A_DEADLINE = 20_000


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette()
    preferences = PreferencesStore(tmp_path / "preferences.json")
    preferences.change(language="en", tour_seen=True)
    application = Application(qapp, preferences, None, lambda _rate: CountingSink(), lambda: None)
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
def opened(application, tmp_path, qtbot):
    session = application.services.session
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder, (20.0, 60.0)))
    application.window.show_page("report")
    yield session
    qtbot.waitUntil(lambda: not application.services.jobs.running, timeout=A_DEADLINE)


def click(window, name):
    QTest.mouseClick(window.report_panel.findChild(QPushButton, name), LEFT)


@pytest.fixture
def form(qtbot):
    form = HandoverForm()
    qtbot.addWidget(form)
    form.show()
    return form


@pytest.mark.parametrize(
    "options",
    [
        HandoverOptions(),
        HandoverOptions(frozenset(), as_zip=False),
        HandoverOptions(frozenset({FileKind.KML}), "EPSG:2263", Units.US, ColumnScheme.ASSET, "Çınar 12"),
    ],
)
def test_the_form_shows_what_was_chosen_and_gives_it_back(form, options, qtbot):
    with qtbot.assertNotEmitted(form.changed):
        form.set_options(options)
    assert form.options == options


def test_every_choice_is_told_and_all_and_none_are_one_press(form, qtbot):
    form.set_options(HandoverOptions())
    with qtbot.waitSignal(form.changed):
        QTest.keyClick(form.findChild(QCheckBox, "file_kml"), Qt.Key.Key_Space)
    assert form.options.files == frozenset(FileKind) - {FileKind.KML}
    with qtbot.waitSignal(form.changed):
        QTest.mouseClick(form.findChild(QPushButton, "no_files"), LEFT)
    assert (form.options.files, form.options.as_zip) == (frozenset(), False)
    with qtbot.waitSignal(form.changed):
        QTest.mouseClick(form.findChild(QPushButton, "all_files"), LEFT)
    assert (form.options.files, form.options.as_zip) == (frozenset(FileKind), True)


def test_a_system_is_searched_and_chosen_by_key(form, qtbot):
    from processing.importing.route_files.crs import all_systems

    form.set_systems(all_systems(), (), (29.1, 40.9), "EPSG:32635 WGS 84 / UTM zone 35N")
    QTest.mouseClick(form.crs.findChild(QPushButton, "crs_change"), LEFT)
    search = form.crs.findChild(QLineEdit, "crs_search")
    QTest.keyClicks(search, "5254")
    with qtbot.waitSignal(form.changed):
        QTest.keyClick(search, Qt.Key.Key_Return)
    assert form.options.crs == "EPSG:5254"


def test_gloves_hit_everything(qtbot):
    panel = ReportPanel("en")
    qtbot.addWidget(panel)
    panel.show()
    found = [w for kind in (QAbstractButton, QComboBox, QLineEdit) for w in panel.findChildren(kind)]
    targets = [w for w in found if w.isVisible() and w.objectName() and not w.objectName().startswith("qt_")]
    assert len(targets) > 12
    assert not [(w.objectName(), w.height()) for w in targets if w.height() < 40]


def test_a_cancelled_export_leaves_nothing_the_next_writes_what_is_ticked_and_tells_the_rest(
    application, opened, qtbot
):
    window = application.window
    click(window, "export")
    assert window.report_panel.findChild(QPushButton, "cancel_export").isVisible()
    assert not window.report_panel.findChild(QPushButton, "export").isVisible()
    click(window, "cancel_export")
    qtbot.waitUntil(lambda: not application.services.jobs.running, timeout=A_DEADLINE)
    assert window.report_panel.findChild(QPushButton, "export").isVisible()
    assert list(opened.folder.exports_dir.iterdir()) == []
    assert window.report.last_export is None
    form = window.report_panel.form
    click(window, "no_files")
    for name in ("file_kml", "file_geopackage", "file_as_zip"):
        form.findChild(QCheckBox, name).click()
    click(window, "export")
    qtbot.waitUntil(lambda: window.report.last_export is not None, timeout=A_DEADLINE)
    made = window.report.last_export
    names = {path.name for path in made.iterdir()}
    assert {"report.pdf", "leaks.csv", "survey.gpkg", "README.txt"} <= names
    assert not {"survey.kml", "survey.dxf", "raven"} & names
    assert [name for name in names if name.endswith(".zip")] != []
    told = window.report_panel.plain_text()
    assert "survey.kml was left out" in told  # the small survey has no launch coordinates
    assert "Type the launch coordinates" in told
    again = PreferencesStore(application.services.preferences.file).values
    assert handover_options(again).files == {FileKind.KML, FileKind.GEOPACKAGE}
    exports = window.report_panel.findChild(QListWidget, "exports_so_far")
    assert exports.count() == 1
    assert made.name in exports.item(0).text()
    assert window.report_panel.findChild(QPushButton, "open_report").isVisible()


def test_systems_of_the_launch_are_offered_and_pages_are_shown_and_turned_by_key(application, opened, qtbot):
    window = application.window
    launch = Launch(latitude=40.9012, longitude=29.1)
    opened.results = replace(opened.results, survey=replace(opened.results.survey, launch=launch))
    window.report.preview()
    systems = window.report_panel.form.crs.findChild(QListWidget, "crs_list")
    qtbot.waitUntil(lambda: systems.count() > 20, timeout=A_DEADLINE)
    assert "EPSG:32635" in systems.item(0).text()
    assert any("TUREF" in systems.item(row).text() for row in range(systems.count()))
    pages = window.report_panel.pages
    qtbot.waitUntil(lambda: pages.current == 1, timeout=A_DEADLINE)
    QTest.keyClick(pages, Qt.Key.Key_PageDown)
    assert pages.current == 2
    QTest.keyClick(pages, Qt.Key.Key_End)
    last = pages.current
    assert last >= 4  # cover, accuracy, two sheets
    QTest.keyClick(pages, Qt.Key.Key_PageDown)
    assert pages.current == last
    QTest.keyClick(pages, Qt.Key.Key_Home)
    assert pages.current == 1
    assert list(opened.folder.exports_dir.iterdir() if opened.folder.exports_dir.is_dir() else ()) == []


def test_the_draft_warning_leads_to_what_is_undecided_and_goes_with_the_last(application, opened):
    window = application.window
    button = window.report_panel.findChild(QPushButton, "next_undecided")
    ids = opened.ordered_ids()
    for candidate in ids[:-1]:
        opened.write_decision(candidate, Decision(Verdict.CONFIRMED), "decide")
    opened.select(ids[0])
    window.show_page("report")
    assert button.isVisible()
    QTest.mouseClick(button, LEFT)
    assert (window.page, opened.selected) == ("leaks", ids[-1])
    opened.write_decision(ids[-1], Decision(Verdict.REJECTED), "decide")
    window.show_page("report")
    assert not button.isVisible()


def test_exports_of_a_survey_that_closes_leave_the_list_without_a_stumble(qtbot):
    panel = ReportPanel("en")
    qtbot.addWidget(panel)
    panel.show()
    exports = [PastExport(name, name, has_report=True) for name in "ab"]
    listed = panel.findChild(QListWidget, "exports_so_far")
    for left in ([], exports[:1]):
        panel.set_exports(exports)
        assert listed.currentRow() == 0
        with qtbot.captureExceptions() as stumbled:
            panel.set_exports(left)
        assert not stumbled
        assert listed.count() == len(left)
