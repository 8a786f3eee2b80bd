"""The form and the tie points: whole new values come out, nonsense is refused, nothing is changed in place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from PySide6.QtCore import QLocale, QPoint, QPointF, Qt
from PySide6.QtGui import QWheelEvent
from PySide6.QtWidgets import QApplication, QComboBox, QLineEdit, QPushButton

from processing.survey import AudioInfo, Launch, Motion, PipeInfo, Survey, SurveyInfo, TiePoint
from widgets.method_panel import MethodRow
from widgets.optional_number import OptionalNumber, number_text, parse_number
from widgets.survey_form import SurveyForm
from widgets.tie_point_panel import FIELDS, TiePointPanel

METHODS = {
    step: tuple(MethodRow(name, name.title(), f"All about {name}.") for name in names)
    for step, names in {"orientation": ("auto", "vqf"), "position": ("auto", "rolling"), "detector": ("auto",)}.items()
}
FULL = Survey(
    info=SurveyInfo("Station Road", "A. Şahin", "2026-05-04", "İSKİ", simulated=True),
    pipe=PipeInfo("ductile iron", 0.30, 1204.0, joint_spacing_m=6.0),
    audio=AudioInfo("audio.wav", 1, 0.25, -12.5, raw_sample_rate_hz=48000.0, raw_bits=32),
    launch=Launch(latitude=40.9012, longitude=29.1, elevation_m=31.0, heading_deg=45.0),
    tie_points=(TiePoint("retrieval", 2411.5, chainage_m=1204.0),),
)


@pytest.fixture
def form(qtbot):
    form = SurveyForm(METHODS)
    qtbot.addWidget(form)
    form.show()
    return form


@pytest.fixture
def panel(qtbot):
    panel = TiePointPanel()
    qtbot.addWidget(panel)
    panel.set_tie_points(FULL.tie_points, FULL.launch, writable=True)
    return panel


def edit(qtbot, form, name, text):
    line = form.findChild(QLineEdit, name)
    line.setFocus()
    line.selectAll()
    qtbot.keyClicks(line, text)
    qtbot.keyClick(line, Qt.Key.Key_Return)


def test_what_goes_in_comes_out_unchanged(form):
    form.set_survey(FULL)
    assert form.survey() == FULL


def test_an_empty_form_is_the_default_survey(form):
    form.set_survey(Survey())
    assert form.survey() == Survey()


def test_an_edit_comes_out_as_a_new_survey(form, qtbot):
    form.set_survey(FULL)
    told = []
    form.survey_changed.connect(told.append)
    edit(qtbot, form, "operator", "B. Öz")
    edit(qtbot, form, "diameter", "250")
    assert told[0].info.operator == "B. Öz"
    assert told[-1].pipe.diameter_m == pytest.approx(0.25)
    assert told[-1].audio == FULL.audio
    assert FULL.pipe.diameter_m == 0.30


def test_a_clock_that_was_measured_stays_one_until_it_is_typed(form, qtbot):
    told = AudioInfo(start_time_s=-0.123456789, drift_ppm=12.3456789, start_sigma_s=0.01, drift_sigma_ppm=0.5)
    form.set_survey(Survey(audio=told))
    edit(qtbot, form, "name", "Main")
    assert form.survey().audio == told
    edit(qtbot, form, "drift", "12")
    assert form.survey().audio == AudioInfo(start_time_s=-0.123456789, drift_ppm=12.0)


def test_the_radius_matters_only_to_a_rolling_ball(form, qtbot):
    form.set_survey(Survey())
    radius = form.findChild(OptionalNumber, "radius")
    assert radius.isEnabled()
    motion = form.findChild(QComboBox, "motion")
    motion.setCurrentIndex(motion.findData(Motion.CARRIED))
    motion.activated.emit(motion.currentIndex())
    assert form.survey().device.motion is Motion.CARRIED
    assert not radius.isEnabled()


def test_a_method_of_another_version_is_kept(form):
    survey = Survey(processing=Survey().processing.__class__(orientation="of the future"))
    form.set_survey(survey)
    assert form.survey() == survey


def test_the_wheel_does_not_change_a_choice_that_it_passes_over(form):
    motion = form.findChild(QComboBox, "motion")
    at = QPointF(5, 5)
    wheel = QWheelEvent(
        at, at, QPoint(), QPoint(0, -120), Qt.MouseButton.NoButton, Qt.KeyboardModifier.NoModifier,
        Qt.ScrollPhase.NoScrollPhase, False,
    )  # fmt: skip
    QApplication.sendEvent(motion, wheel)
    assert motion.currentData() == Motion.ROLLING


@pytest.mark.parametrize("text", ["0,3", "0.3", " 0.3 ", "3e-1"])
def test_comma_and_point_are_the_same_number(text):
    assert parse_number(text) == 0.3


@pytest.mark.parametrize("text", ["a", "1,2,3", "nan", "inf", "1 m"])
def test_what_is_no_number_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011
        parse_number(text)


@given(st.floats(min_value=-1e6, max_value=1e6, allow_nan=False))
def test_a_number_survives_being_shown(value):
    assert parse_number(number_text(value)) == pytest.approx(value, rel=1e-9, abs=1e-12)


def test_a_number_out_of_range_goes_back_to_what_was_there(qtbot):
    field = OptionalNumber(0.005, 2.0, factor=0.001)
    qtbot.addWidget(field)
    field.set_value(0.0475)
    told = []
    field.value_changed.connect(lambda: told.append(field.value))
    for wrong in ("99999", "abc", "-3"):
        field.selectAll()
        qtbot.keyClicks(field, wrong)
        assert "border" in field.styleSheet()
        qtbot.keyClick(field, Qt.Key.Key_Return)
        assert field.text() == "47.5".replace(".", QLocale().decimalPoint())
    field.clear()
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert told == [None]


def test_a_tie_point_edit_comes_out_as_a_new_tuple(panel):
    told = []
    panel.tie_points_changed.connect(told.append)
    index = panel.model.index(0, FIELDS.index("chainage_m"))
    assert panel.model.setData(index, "1205,5")
    assert told[0][0].chainage_m == 1205.5
    assert panel.model.points == FULL.tie_points  # shown when the session says so


@pytest.mark.parametrize(("field", "text"), [("time_s", ""), ("sigma_m", "0"), ("sigma_m", "-1"), ("time_s", "x")])
def test_a_tie_point_without_time_or_sigma_is_refused(panel, field, text):
    told = []
    panel.tie_points_changed.connect(told.append)
    assert not panel.model.setData(panel.model.index(0, FIELDS.index(field)), text)
    assert told == []


def test_a_tie_point_can_be_switched_off(panel):
    told = []
    panel.tie_points_changed.connect(told.append)
    unchecked = Qt.CheckState.Unchecked.value
    assert panel.model.setData(panel.model.index(0, 0), unchecked, Qt.ItemDataRole.CheckStateRole)
    assert told[0][0].enabled is False


@pytest.mark.parametrize(
    ("launch", "place"),
    [
        (Launch(), (None, None, 0.0, 0.0)),
        (Launch(latitude=40.9, longitude=29.1), (40.9, 29.1, None, None)),
        (Launch(east_m=5e5, north_m=4.5e6, crs="EPSG:5254"), (None, None, 5e5, 4.5e6)),
    ],
)
def test_a_closed_loop_is_a_tie_point_at_the_launch_at_the_end(panel, qtbot, launch, place):
    panel.set_tie_points((), launch, writable=True)
    panel.set_moments(3.0, 812.25)
    with qtbot.waitSignal(panel.tie_points_changed) as told:
        qtbot.mouseClick(panel.findChild(QPushButton, "closed_loop"), Qt.MouseButton.LeftButton)
    (point,) = told.args[0]
    assert point.time_s == 812.25
    assert (point.latitude, point.longitude, point.east_m, point.north_m) == place


def test_a_closed_loop_cannot_be_declared_before_the_end_is_known(panel):
    panel.set_moments(0.0, None)
    assert not panel.findChild(QPushButton, "closed_loop").isEnabled()


def test_a_tie_point_is_added_at_the_cursor(panel, qtbot):
    panel.set_moments(17.5, 100.0)
    with qtbot.waitSignal(panel.tie_points_changed) as told:
        qtbot.mouseClick(panel.findChild(QPushButton, "add_tie_point"), Qt.MouseButton.LeftButton)
    assert [p.time_s for p in told.args[0]] == [2411.5, 17.5]


def test_nothing_can_be_edited_in_a_read_only_survey(panel):
    panel.set_tie_points(FULL.tie_points, FULL.launch, writable=False)
    assert not any(button.isEnabled() for button in panel.findChildren(QPushButton))
    assert not panel.model.flags(panel.model.index(0, 1)) & Qt.ItemFlag.ItemIsEditable
