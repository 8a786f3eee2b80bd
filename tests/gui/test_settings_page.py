"""The settings page: each choice is remembered and effective at once."""

import json

import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent, QLocale
from PySide6.QtGui import QImage
from PySide6.QtWidgets import QApplication, QComboBox, QLineEdit, QPushButton, QStackedWidget, QWidget

from app import company_logo, text_scale
from app.application import Application
from app.company_logo import LogoFault
from app.page_host import PageHost
from app.report_choices import report_options
from app.settings import Preferences, PreferencesStore
from app.settings_control import SettingsControl
from processing.quantities import Units
from widgets import units


@pytest.fixture
def application(qapp, qtbot, tmp_path):
    before = qapp.styleSheet(), qapp.font(), qapp.palette(), QLocale(), qapp.property("leakline_quantities")
    preferences = PreferencesStore(tmp_path / "c" / "preferences.json")
    preferences.change(language="en")
    made = Application(qapp, preferences, None, lambda _rate_hz: CountingSink(), lambda: None)
    made.window.boxes = AnsweringBoxes()
    made.window.show()
    qtbot.waitUntil(lambda: not made.services.jobs.running)
    made.window.work.settings.show()
    yield made
    made.window.close()
    made.shut_down()
    made.window.deleteLater()
    made._translation.use("en")
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)
    qapp.setStyleSheet(before[0])
    qapp.setFont(before[1])
    qapp.setPalette(before[2])
    QLocale.setDefault(before[3])
    qapp.setProperty("leakline_quantities", before[4])


@pytest.fixture
def control(qtbot, tmp_path):
    """The control with its page alone, in a stack of two; what it asks for is noted in ``asked``."""
    stack = QStackedWidget()
    qtbot.addWidget(stack)
    pages = {"start": QWidget()}
    stack.addWidget(pages["start"])
    at = ["start"]
    boxes, busy = AnsweringBoxes(), [False]
    made = SettingsControl(
        PageHost(pages, stack, lambda page: at.__setitem__(0, page), lambda: at[0]),
        PreferencesStore(tmp_path / "c" / "preferences.json"),
        "en",
        stack,
        lambda: boxes,
        lambda: busy[0],
    )
    made.boxes, made.busy, made.at, made.asked = boxes, busy, at, []
    for signal in (made.language_asked, made.theme_asked):
        signal.connect(made.asked.append)
    made.show()
    return made


def choose(control, name, value):
    combo = control.panel.findChild(QComboBox, f"setting_{name}")
    combo.setCurrentIndex(combo.findData(value))
    combo.activated.emit(combo.currentIndex())


def on_disc(control):
    return json.loads(control._preferences.file.read_text(encoding="utf-8"))


def test_language_units_and_theme_are_switched_at_once_and_the_page_stays_in_front(application, qtbot, qapp):
    application.window.work.settings.came_from = "data"
    for name, value in (("language", "tr"), ("units", "us"), ("theme", "dark")):
        choose(application.window.work.settings, name, value)
        qtbot.waitUntil(lambda: not application.services.jobs.running)
        assert application.window.page == "settings"
    settings = application.window.work.settings
    assert settings.panel.findChild(QPushButton, "settings_done").text().startswith("Geri")
    assert settings.came_from == "data"
    assert units.quantities().length(1200.0 / 3937.0) == "1,0 ft"
    assert qapp.palette().window().color().lightness() < 80
    kept = on_disc(settings)
    assert (kept["language"], kept["units"], kept["theme"]) == ("tr", "us", "dark")
    assert report_options(application.services.preferences.values, "en").units is Units.US


def test_the_theme_needs_no_other_window(control):
    choose(control, "theme", "dark")
    assert control.asked == ["dark"]


def test_a_new_size_waits_for_the_next_start_and_offers_it(control):
    restart = control.panel.findChild(QPushButton, "restart")
    assert not restart.isVisibleTo(control.panel)
    choose(control, "text_scale", 150)
    assert restart.isVisibleTo(control.panel)
    choose(control, "text_scale", 100)
    assert not restart.isVisibleTo(control.panel)


def test_f7_leads_back_to_where_one_was(control):
    assert control.at == ["settings"]
    control.show()
    assert control.at == ["start"]


def test_names_and_company_are_remembered(control):
    for name, text in (("setting_operator", "A. Şahin"), ("setting_reviewer", "B"), ("company_name", "Su İşleri")):
        field = control.panel.findChild(QLineEdit, name)
        field.setText(text)
        field.editingFinished.emit()
    kept = on_disc(control)
    assert (kept["operator"], kept["reviewer"], kept["company"]["name"]) == ("A. Şahin", "B", "Su İşleri")


def test_nothing_is_made_anew_while_work_is_in_progress(control):
    control.busy[0] = True
    choose(control, "units", "us")
    assert control._preferences.values.units == "metric"
    assert control.panel.findChild(QComboBox, "setting_units").currentData() == "metric"
    assert (len(control.boxes.told), control.asked) == (1, [])


def test_reset_keeps_names_and_surveys(control):
    control._preferences.change(
        operator="A", recent=["/a"], pinned=["/b"], units="us", company={"name": "C"}, layout={"a": "b"}
    )
    control.panel.reset_asked.emit()
    assert control._preferences.values.units == "us"  # Escape
    control.boxes.answer = "reset"
    control.panel.reset_asked.emit()
    values = control._preferences.values
    assert (values.operator, values.recent, values.pinned) == ("A", ["/a"], ["/b"])
    assert values.company == {"name": "C"}
    assert (values.units, values.layout) == (Preferences().units, {})
    assert control.asked == ["light", "en"]


# --- logo ---


def picture(path, width, height=100):
    image = QImage(width, height, QImage.Format.Format_RGB32)
    image.fill(0)
    assert image.save(str(path))
    return path


@pytest.mark.parametrize(
    ("width", "fault"), [(120, LogoFault.COARSE), (400, LogoFault.NONE), (6100, LogoFault.TOO_LARGE)]
)
def test_a_logo_is_measured_before_it_is_taken(qapp, tmp_path, width, fault):
    assert company_logo.look_at(picture(tmp_path / "a.png", width)).fault is fault


def test_what_is_no_picture_is_refused(qapp, tmp_path):
    (tmp_path / "a.png").write_text("no picture", encoding="utf-8")
    assert company_logo.look_at(tmp_path / "a.png").fault is LogoFault.NO_PICTURE
    assert company_logo.look_at(tmp_path / "missing.png").fault is LogoFault.MISSING
    with (tmp_path / "big.png").open("wb") as file:
        file.truncate(company_logo.MOST_BYTES + 1)
    assert company_logo.look_at(tmp_path / "big.png").fault is LogoFault.TOO_LARGE


def test_a_taken_logo_survives_the_loss_of_its_original(control, tmp_path):
    original = picture(tmp_path / "logo.jpg", 500)
    control.take_logo(original)
    original.unlink()
    kept = report_options(control._preferences.values, "en").company.logo
    assert company_logo.look_at(type(original)(kept)).size == (500, 100)


# --- size ---


def test_the_size_is_on_top_of_what_the_user_has_set():
    environment = {"QT_SCALE_FACTOR": "1.5"}
    text_scale.prepare(200, environment)
    assert float(environment["QT_SCALE_FACTOR"]) == 3.0
    assert text_scale.in_force(environment) == 200
    text_scale.prepare(125, environment)  # of a program that this one started
    assert float(environment["QT_SCALE_FACTOR"]) == 1.875


def test_full_size_leaves_the_environment_as_it_was():
    environment = {}
    text_scale.prepare(100, environment)
    assert "QT_SCALE_FACTOR" not in environment
    assert text_scale.in_force(environment) == 100


def test_the_program_that_is_started_again_opens_the_same_survey(tmp_path):
    assert list(text_scale.command(tmp_path, "python", frozen=False)) == ["python", "-m", "app", "open", str(tmp_path)]
    assert list(text_scale.command(None, "leakline", frozen=True)) == ["leakline"]
