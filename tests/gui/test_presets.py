"""The preset in the form and its table: what is offered, changed, refused and put back."""

from dataclasses import replace

import pytest

from processing.sound.presets import KINDS, PresetValue, shipped
from processing.survey import PipeInfo, ProcessingChoice, Survey
from widgets.preset_dialog import VALUE, PresetDialog
from widgets.survey_form import SurveyForm


@pytest.fixture
def dialog(qtbot):
    made = PresetDialog(shipped(), shipped(), "pvc", "en")
    qtbot.addWidget(made)
    return made


def put(dialog, name, text):
    dialog._values.item(list(KINDS).index(name), VALUE).setText(text)


def row_of(dialog, key):
    return next((row for row in dialog.rows if row.key == key), None)


def test_it_opens_on_the_preset_in_use_and_changes_nothing_by_itself(dialog):
    assert dialog._choice.currentData() == "pvc"
    assert dialog.rows == shipped()
    assert dialog._keep.isEnabled()


@pytest.mark.parametrize("text", ["44", "44.0", "44,0"])
def test_a_changed_value_makes_the_row_the_users_own(dialog, text):
    put(dialog, "background_m", text)
    changed = row_of(dialog, "pvc")
    assert changed.own
    assert changed.told["background_m"] == PresetValue(44.0, "own", "")
    assert replace(changed, own=False, values=None) == replace(row_of(dialog, "pvc"), own=False, values=None)
    assert [r for r in dialog.rows if r.key != "pvc"] == [r for r in shipped() if r.key != "pvc"]


@pytest.mark.parametrize(("name", "text"), [("background_m", "9999"), ("background_m", "far"), ("band_low_hz", "8000")])
def test_what_cannot_be_is_said_and_not_saved(dialog, name, text):
    put(dialog, name, text)
    assert not dialog._keep.isEnabled()
    assert dialog._wrong.text()
    put(dialog, name, "100")
    assert dialog._keep.isEnabled()
    assert not dialog._wrong.text()


def test_the_speed_of_sound_follows_the_wall(dialog):
    before = dialog._speed.text()
    put(dialog, "diameter_per_wall", "40")
    assert dialog._speed.text() != before
    put(dialog, "modulus_gpa", "")
    assert dialog._speed.text() == "–"


def test_a_copy_is_added_and_reset_takes_it_away(dialog):
    dialog._add()
    assert len(dialog.rows) == len(shipped()) + 1
    assert dialog.rows[-1].own
    assert dialog.rows[-1].told == row_of(dialog, "pvc").told
    dialog._reset()
    assert dialog.rows == shipped()


def test_reset_brings_the_shipped_row_back(dialog):
    put(dialog, "background_m", "44")
    dialog._reset()
    assert dialog.rows == shipped()


def test_the_form_offers_presets_and_keeps_the_choice(qtbot):
    form = SurveyForm(dict.fromkeys(("orientation", "position", "detector"), ()))
    qtbot.addWidget(form)
    survey = Survey(pipe=PipeInfo("PVC", 0.15, pressure_bar=3.5), processing=ProcessingChoice(preset="steel"))
    form.set_survey(survey)
    form.set_presets([("pvc", "PVC", ""), ("steel", "Steel", "")], "PVC")
    assert form.survey().processing.preset == "steel"
    assert form.survey().pipe.pressure_bar == 3.5
    assert "PVC" in form._preset.itemText(0)
    form._preset.setCurrentIndex(form._preset.findData("none"))
    with qtbot.waitSignal(form.survey_changed) as told:
        form._preset.activated.emit(1)
    assert told.args[0].processing.preset == "none"


def test_a_survey_that_names_an_unknown_preset_keeps_its_word(qtbot):
    form = SurveyForm(dict.fromkeys(("orientation", "position", "detector"), ()))
    qtbot.addWidget(form)
    form.set_survey(Survey(processing=ProcessingChoice(preset="copper")))
    assert form.survey().processing.preset == "copper"
