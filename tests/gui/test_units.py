"""In US units everything that people read and type is in feet, inches and psi; what is stored stays metric."""

import re
from dataclasses import replace

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QLabel, QLineEdit, QTableView
from whole_window import whole_window

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.quantities import METRES_PER_US_FOOT, Places, Quantities, Units
from processing.survey import Finding, PipeInfo, Severity, Survey, TiePoint
from widgets import units
from widgets.optional_number import OptionalNumber
from widgets.recording_form import parse_places, with_units
from widgets.survey_form import SurveyForm
from widgets.tie_point_panel import TiePointModel
from widgets.vocabulary import chance_text, place_and_width, place_title

FOOT = METRES_PER_US_FOOT
METRIC_LENGTH = re.compile(r"(\d|\(| |±) ?(m|mm|bar|km)\b(?!/)")


@pytest.fixture
def written(qapp):
    """Return a function that sets how quantities are written, until the test is over."""
    before = qapp.property("leakline_quantities")
    yield lambda *args: units.use(Quantities(*args))
    qapp.setProperty("leakline_quantities", before)


def said(widget):
    for name in ("text", "toolTip", "placeholderText", "accessibleName"):
        read = getattr(widget, name, None)
        if callable(read):
            yield read()
    if isinstance(widget, QComboBox):
        yield from (widget.itemText(i) for i in range(widget.count()))
    if isinstance(widget, QTableView):
        model = widget.model()
        for column in range(model.columnCount()):
            yield model.headerData(column, Qt.Orientation.Horizontal)
            yield from (model.data(model.index(row, column)) for row in range(model.rowCount()))


def texts(page):
    return {text for widget in page.findChildren(object) for text in said(widget) if isinstance(text, str) and text}


@pytest.mark.parametrize(("wanted", "metric"), [("us", False), ("metric", True)])
def test_no_widget_of_the_review_page_tells_metres_in_us_units(qapp, tmp_path, wanted, metric):
    with whole_window(qapp, tmp_path, units=wanted) as application:
        page = application.window.review_page
        found = {text for text in texts(page) if METRIC_LENGTH.search(text)}
        title = page.findChild(QLabel, "candidate_title").text()
    assert bool(found) is metric, found
    assert (" ft ± " in title) is not metric


# --- what is typed ---


def typed(field, text):
    field.setText(text)
    field.textEdited.emit(text)
    field.editingFinished.emit()


@pytest.mark.parametrize("text", ["12.5", "12,5", " 12.5 "])
def test_a_length_typed_in_feet_is_stored_in_metres(qtbot, written, text):
    written("tr", Units.US)
    form = SurveyForm({"orientation": (), "position": (), "detector": ()})
    qtbot.addWidget(form)
    typed(form.findChild(QLineEdit, "length"), text)
    assert form.survey().pipe.length_m == pytest.approx(12.5 * FOOT, rel=1e-12)
    typed(form.findChild(QLineEdit, "diameter"), "8")
    assert form.survey().pipe.diameter_m == pytest.approx(0.2032, rel=1e-12)
    typed(form.findChild(QLineEdit, "pressure"), "60")
    assert form.survey().pipe.pressure_bar == pytest.approx(4.13685, rel=1e-5)


def test_who_types_nothing_changes_nothing_though_feet_are_shown_rounded(qtbot, written):
    written("en", Units.US)
    form = SurveyForm({"orientation": (), "position": (), "detector": ()})
    qtbot.addWidget(form)
    survey = replace(Survey(), pipe=PipeInfo(length_m=123.456789))
    form.set_survey(survey)
    seen = []
    form.survey_changed.connect(seen.append)
    field = form.findChild(QLineEdit, "length")
    assert field.text() == "405.0411"
    field.editingFinished.emit()
    assert seen == []
    assert form.survey() == survey


def test_limits_are_told_in_the_unit_of_the_field(qtbot, written):
    written("en", Units.US)
    field = OptionalNumber(0.0, 100.0, factor=units.length_unit().factor)
    qtbot.addWidget(field)
    typed(field, "12")
    field.setText("400")
    field.textEdited.emit("400")
    assert "328.08" in field.toolTip()
    field.editingFinished.emit()
    assert field.value == pytest.approx(12 * FOOT)


def test_tie_points_are_told_and_typed_in_feet_but_coordinates_stay_in_metres(qapp, written):
    written("en", Units.US)
    model = TiePointModel()
    model.set_points((TiePoint("a", 5.0, chainage_m=30.48, east_m=500000.0),))
    titles = [model.headerData(i, Qt.Orientation.Horizontal) for i in range(model.columnCount())]
    assert "Chainage (ft)" in titles
    assert "East (m)" in titles
    at = model.index(0, titles.index("Chainage (ft)"))
    edited = []
    model.edited.connect(edited.append)
    assert model.data(at) == "100"  # 30.48 m are 99.9998 survey feet
    assert model.setData(at, model.data(at, Qt.ItemDataRole.EditRole))
    assert edited == []
    assert model.setData(at, "200")
    assert edited[0][0].chainage_m == pytest.approx(200 * FOOT)
    assert edited[0][0].east_m == 500000.0


def test_places_on_the_way_keep_their_meaning_when_the_unit_changes(qapp, written):
    written("en", Units.METRIC)
    kept = with_units("valve 12 = 120.5\nhydrant\nvalve 12")
    assert kept == "valve 12 = 120.5 m\nhydrant\nvalve 12"
    written("en", Units.US)
    assert parse_places(kept)[0] == ("valve 12", 120.5)
    assert parse_places("valve 12 = 100")[0][1] == pytest.approx(100 * FOOT)
    assert parse_places("valve 12 100 ft")[0][1] == pytest.approx(100 * FOOT)
    assert with_units("valve = 100 ft") == "valve = 100 ft"


# --- what is told ---


@pytest.mark.parametrize(
    ("how", "text"),
    [
        (("en", Units.METRIC), "1,234.5 m ± 1.2 m"),
        (("tr", Units.METRIC), "1.234,5 m ± 1,2 m"),
        (("en", Units.US), "4,050.2 ft ± 3.9 ft"),
        (("en", Units.METRIC, Places.STATIONING), "1+234.5 ± 1.2 m"),
        (("en", Units.US, Places.STATIONING), "40+50.2 ± 3.9 ft"),
    ],
)
def test_a_place_has_its_interval_in_the_same_unit(qapp, written, how, text):
    written(*how)
    assert place_and_width(1234.5, 1.2) == text
    assert ("(" in place_title()) is (len(how) == 2)


def test_sentences_tell_lengths_speeds_and_pressures_in_us_units():
    finding = Finding("tie_off_route", Severity.WARNING, {"name": "V 1", "metres": 30.48})
    assert "lies 30.5 m off" in messages.finding_sentence(finding, "en")
    assert "lies 100.0 ft off" in messages.finding_sentence(finding, "en", Units.US)
    assert "100,0 ft" in messages.finding_sentence(finding, "tr", Units.US)
    assert messages.text_in(Units.US, "sizes", "at_speed", "en", speed=1.0) == "passed at 3.28 ft/s"
    assert messages.text_in(Units.US, "sizes", "at_pressure", "en", pressure=4.0) == "58.0 psi"


def test_accelerations_and_the_units_of_files_stay_what_they_are():
    finding = Finding("acc_saturated", Severity.WARNING)
    params = {"limit": 160.0, "axes": "x", "count": 3.0, "first_s": 1.0, "masked_s": 2.0}
    told = messages.finding_sentence(replace(finding, params=params), "en", Units.US)
    assert "160 m/s²" in told
    error = LeaklineError(ErrorCode.PATH_IMPOSSIBLE, length_m=3048.0, duration_s=10.0)
    assert "10000 ft" in messages.error_sentence(error, "en", Units.US)


def test_no_chance_is_told_as_certain():
    assert [chance_text(p) for p in (0.0, 0.004, 0.5, 0.994, 0.996, 1.0)] == [
        "< 1 %",
        "< 1 %",
        "50 %",
        "99 %",
        "> 99 %",
        "> 99 %",
    ]
