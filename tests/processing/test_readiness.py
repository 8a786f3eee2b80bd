"""The lights beside the steps: what is missing decides them, and every reason says what to do."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing import messages
from processing.quantities import Quantities, Units
from processing.readiness import DIG_HALF_M, RED_HALF_M, Facts, Lead, Light, Note, Step, next_thing, readiness, sentence

DONE = Facts(
    is_open=True,
    processed=True,
    ties=3,
    worst_miss_m=0.4,
    has_path=True,
    length_m=900.0,
    widest_m=1.2,
    widest_at_m=400.0,
    sound_s=900.0,
    candidates=23,
    confirmed=4,
    exported="2026-05-04",
)


def states(facts):
    return {state.step: state for state in readiness(facts)}


def lights(facts):
    return {step.value: state.light.value for step, state in states(facts).items()}


def codes(facts):
    return {note.code for state in readiness(facts) for note in state.notes}


def test_when_everything_is_done_all_lights_are_green_and_nothing_is_next():
    assert set(lights(DONE).values()) == {"green"}
    assert next_thing(readiness(DONE)) is None


def test_with_nothing_open_every_light_is_grey_and_leads_to_opening():
    found = readiness(Facts())
    assert {state.light for state in found} == {Light.GREY}
    assert {state.notes[0].lead for state in found} == {Lead.OPEN}
    assert next_thing(found) is None


def test_a_folder_that_was_only_looked_at_waits_to_be_processed():
    preview = Facts(previewing=True)
    assert lights(preview) == {
        "data": "yellow", "ties": "red", "path": "grey", "sound": "grey", "leaks": "grey", "report": "grey"
    }  # fmt: skip
    assert states(preview)[Step.DATA].notes[0].lead is Lead.PROCESS
    assert states(replace(preview, readable=False))[Step.DATA].light is Light.RED


@pytest.mark.parametrize(
    ("ties", "has_length", "light", "code"),
    [
        (0, False, "red", "ties_none"),
        (0, True, "yellow", "ties_only_length"),
        (1, False, "yellow", "ties_one"),
        (1, True, "green", "ties_checked"),
        (2, False, "green", "ties_checked"),
    ],
)
def test_tie_points_are_enough_when_one_can_check_the_other(ties, has_length, light, code):
    facts = replace(DONE, ties=ties, has_length=has_length)
    assert lights(facts)["ties"] == light
    assert states(facts)[Step.TIES].notes[0].code == code


def test_a_contradicted_tie_point_stops_and_is_named():
    state = states(replace(DONE, ties_doubted=("valve 7", "bend")))[Step.TIES]
    assert state.light is Light.RED
    assert "valve 7, bend" in sentence(state.notes[0], Quantities())


@pytest.mark.parametrize(
    ("widest_m", "light"),
    [(DIG_HALF_M, "green"), (DIG_HALF_M + 0.01, "yellow"), (RED_HALF_M, "yellow"), (RED_HALF_M + 0.01, "red")],
)
def test_the_path_is_good_where_one_dig_lays_the_whole_interval_open(widest_m, light):
    assert lights(replace(DONE, widest_m=widest_m))["path"] == light


def test_a_run_without_sound_has_no_leaks_to_judge_but_is_not_told_to_be_tight():
    found = lights(replace(DONE, has_sound=False, candidates=0, confirmed=0))
    assert (found["data"], found["sound"], found["leaks"]) == ("red", "red", "grey")


def test_a_run_that_was_mostly_deaf_is_red_and_one_with_a_gap_is_yellow():
    assert lights(replace(DONE, sound_lost_s=500.0))["sound"] == "red"
    assert lights(replace(DONE, sound_lost_s=40.0))["sound"] == "yellow"
    assert lights(replace(DONE, sound_lost_s=0.2))["sound"] == "green"


def test_undecided_candidates_make_the_report_a_draft_and_say_how_many_are_left():
    facts = replace(DONE, undecided=16, exported=None)
    assert (lights(facts)["leaks"], lights(facts)["report"]) == ("yellow", "yellow")
    assert "16 of 23" in sentence(states(facts)[Step.LEAKS].notes[0], Quantities())
    assert {"report_draft", "report_not_written"} <= codes(facts)


def test_a_verdict_after_the_export_makes_the_report_old():
    facts = replace(DONE, changed_since=True)
    assert states(facts)[Step.REPORT].notes[0].code == "report_old"
    assert "4 May 2026" in sentence(states(facts)[Step.REPORT].notes[0], Quantities())


def test_lengths_are_told_in_the_chosen_units_and_language():
    note = Note("ties_none", Light.RED, Lead.TIES, {"metres": 12.0})
    assert "12.0 m" in sentence(note, Quantities())
    assert "39.4 ft" in sentence(note, Quantities(units=Units.US))
    assert "12,0 m" in sentence(note, Quantities("tr"))


def test_what_to_do_first_is_the_gravest_thing_of_the_earliest_step():
    facts = replace(DONE, warnings=2, ties=0, widest_m=12.0, undecided=3)
    first = next_thing(readiness(facts))
    assert first is not None
    assert (first.code, first.lead) == ("ties_none", Lead.TIES)


ANY = st.builds(
    Facts,
    is_open=st.booleans(),
    previewing=st.booleans(),
    readable=st.booleans(),
    processed=st.booleans(),
    stale=st.booleans(),
    has_motion=st.booleans(),
    has_sound=st.booleans(),
    warnings=st.integers(0, 5),
    ties=st.integers(0, 4),
    ties_doubted=st.sampled_from([(), ("valve",)]),
    worst_miss_m=st.sampled_from([None, 0.7]),
    has_length=st.booleans(),
    has_path=st.booleans(),
    widest_m=st.floats(0.1, 100.0),
    path_lost_m=st.floats(0.0, 50.0),
    direction_known=st.booleans(),
    clock_assumed=st.booleans(),
    sound_lost_s=st.floats(0.0, 100.0),
    sound_s=st.just(100.0),
    candidates=st.integers(0, 9),
    undecided=st.integers(0, 3),
    unsure=st.integers(0, 3),
    exported=st.sampled_from([None, "2026-05-04"]),
    changed_since=st.booleans(),
)


@given(ANY, st.sampled_from(messages.LANGUAGES))
def test_every_light_has_a_sentence_and_one_that_is_not_green_says_where_to_go(facts, language):
    for state in readiness(facts):
        assert state.light is min((note.light for note in state.notes), key=list(Light).index)
        for note in state.notes:
            text = sentence(note, Quantities(language))
            assert text.endswith(".")
            assert "{" not in text
            assert note.lead is not None or note.light is Light.GREEN


def test_no_sentence_of_the_lights_is_idle():
    """Each key of the table can be reached by some facts."""
    reached = set()
    base = replace(DONE, undecided=1, unsure=1, warnings=1, stale=True, path_lost_m=5.0, direction_known=False)
    for facts in (
        Facts(), Facts(previewing=True), Facts(previewing=True, readable=False), DONE, base,
        replace(DONE, has_motion=False, has_path=False), replace(DONE, has_sound=False),
        replace(DONE, ties=0), replace(DONE, ties=0, has_length=True), replace(DONE, ties=1),
        replace(DONE, ties_doubted=("a",)), replace(DONE, worst_miss_m=None),
        replace(DONE, widest_m=5.0), replace(DONE, widest_m=50.0), replace(DONE, sound_lost_s=40.0),
        replace(DONE, sound_lost_s=800.0), replace(DONE, clock_assumed=True), replace(DONE, candidates=0),
        replace(DONE, exported=None), replace(DONE, changed_since=True),
    ):  # fmt: skip
        reached |= codes(facts)
    assert reached == set(messages.table("readiness"))
