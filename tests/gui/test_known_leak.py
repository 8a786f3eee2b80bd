"""A known leak is told in a dialog, kept in the survey, undone, and sizes the others at once."""

from dataclasses import replace

import pytest

from processing.survey import CalibrationLeak, LeakClass
from widgets.candidate_row import CandidateRow
from widgets.candidate_table import CandidateModel
from widgets.known_leak_dialog import KnownFlow, KnownLeakDialog
from widgets.plot_theme import THEMES


def dialog(qtbot, known=None):
    made = KnownLeakDialog("L1", known)
    qtbot.addWidget(made)
    return made


def field(made, name):
    from widgets.optional_number import OptionalNumber

    return made.findChild(OptionalNumber, name)


def test_without_a_flow_there_is_no_answer(qtbot):
    made = dialog(qtbot)
    assert made.answer is None
    assert not made._keep.isEnabled()
    field(made, "known_flow").set_value(12.5)
    made._check()
    assert made._keep.isEnabled()
    assert made.answer == KnownFlow(12.5, None)


def test_what_is_known_already_is_shown_and_can_be_taken_back(qtbot):
    made = dialog(qtbot, KnownFlow(8.0, 3.5))
    assert made.answer == KnownFlow(8.0, 3.5)
    made._remove()
    assert made.removed
    assert made.answer is None
    assert not dialog(qtbot).removed


def row(number, at_m, over_db, known=None):
    from processing.settings import SizeSettings
    from processing.sound.sizes import size_of
    from processing.survey import Candidate, Decision, Survey

    figures = {"size_over_db": over_db, "size_background_db": -60.0, "size_low_hz": 800.0, "size_high_hz": 3200.0}
    own = Candidate(
        number, 1.0, at_m, at_m - 1, at_m + 1, (at_m, 0, 0), 0.9, 9.0, LeakClass.LEAK, (500, 4000), 1.0, figures
    )
    first = replace(own, id=1, chainage_m=20.0, evidence={**figures, "size_over_db": 10.0})
    survey = Survey(calibration_leak=known)
    return CandidateRow(own, Decision(), size=size_of(own, survey, SizeSettings(), (first, own)))


@pytest.mark.parametrize("known", [None, CalibrationLeak(20.0, 1.0, 3.0)])
def test_the_table_names_the_size_and_a_known_leak_changes_it(qtbot, known):
    model = CandidateModel(THEMES["light"])
    model.set_rows([row(2, 80.0, 12.0, known)])
    text = model.data(model.index(0, 5))
    # 2 dB over a leak of 1 L/min is 1.6 L/min: small; by its loudness alone it may be medium or large
    assert text == ("leak, small" if known is not None else "leak, medium–large")


def test_what_is_no_leak_has_no_size(qtbot):
    model = CandidateModel(THEMES["light"])
    loud = row(2, 80.0, 12.0)
    model.set_rows([replace(loud, decision=replace(loud.decision, leak_class=LeakClass.VALVE))])
    assert model.data(model.index(0, 5)) == "valve"
