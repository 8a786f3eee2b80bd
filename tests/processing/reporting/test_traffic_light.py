"""The traffic light follows its written rule: what allows a dig, what asks for a pinpoint, what forbids it."""

from dataclasses import replace

import pytest

from processing.position.tie_checks import TieCheck
from processing.reporting.content import make_content
from processing.reporting.dig_sheet import cause_sentence, opinions, rule
from processing.reporting.options import ReportOptions
from processing.reporting.references import Reference, Tape, tape
from processing.reporting.traffic_light import BELL_HOLE_M, TAPE_REACH_M, Light, assess
from processing.reporting.words import Words
from processing.review_facts import DigFinding, DigHistory, DigResult, Opinion, ReviewRecord
from processing.survey import Channel, ClockMap, Decision, Finding, LeakClass, Severity, Stretch, Verdict

NEAR = (Tape("valve 12", onward=True, along_m=12.0, along_95_m=1.4),)
CONFIRMED = Decision(Verdict.CONFIRMED, LeakClass.LEAK)


def judged(results, decision=CONFIRMED, record=None, tapes=NEAR, **changes):
    candidate = replace(results.candidates[0], **changes)
    return assess(candidate, decision, results, record or ReviewRecord(), tapes)


def codes(assessment):
    return [cause.code for cause in assessment.causes]


def window(metres):
    return {"chainage_low95_m": 42.0 - metres / 2, "chainage_high95_m": 42.0 + metres / 2}


def test_a_confirmed_leak_with_a_short_window_near_a_reference_may_be_dug(results):
    found = judged(results)
    assert found.light is Light.GREEN
    assert codes(found) == ["confirmed", "window_fits", "reference_near"]


@pytest.mark.parametrize(("metres", "light"), [(4.5, Light.GREEN), (4.7, Light.YELLOW)])
def test_the_window_has_to_fit_into_the_largest_bell_hole(results, metres, light):
    assert BELL_HOLE_M == (0.9, 4.6)  # findings §6
    assert judged(results, **window(metres)).light is light


@pytest.mark.parametrize(("away", "light"), [(TAPE_REACH_M - 1, Light.GREEN), (TAPE_REACH_M + 1, Light.YELLOW)])
def test_a_reference_has_to_be_within_reach_of_a_tape(results, away, light):
    far = replace(NEAR[0], along_m=away)
    assert judged(results, tapes=(far, replace(far, along_m=away + 500.0))).light is light


def test_without_a_reference_a_crew_pinpoints_first(results):
    assert judged(results, tapes=()).light is Light.YELLOW


@pytest.mark.parametrize(
    ("verdict", "light"),
    [(Verdict.NONE, Light.RED), (Verdict.REJECTED, Light.RED), (Verdict.UNSURE, Light.YELLOW)],
)
def test_only_a_confirmed_leak_may_be_dug(results, verdict, light):
    assert judged(results, Decision(verdict, LeakClass.LEAK)).light is light


def test_what_is_taken_for_a_valve_is_looked_at_first(results):
    found = judged(results, Decision(Verdict.CONFIRMED, LeakClass.VALVE))
    assert (found.light, codes(found)) == (Light.YELLOW, ["class"])


def test_nobody_digs_for_simulated_data(results):
    simulated = replace(results, survey=replace(results.survey, info=replace(results.survey.info, simulated=True)))
    assert judged(simulated).light is Light.RED


@pytest.mark.parametrize("finding", DigFinding)
def test_nobody_digs_twice(results, finding):
    record = ReviewRecord(digs={1: DigResult(1, finding, "2026-05-09")})
    assert judged(results, record=record).light is Light.RED


def test_a_place_without_a_path_is_not_dug(results):
    nan = float("nan")
    assert judged(results, tapes=(), chainage_low95_m=nan, chainage_high95_m=nan).light is Light.RED


def test_a_second_reviewer_who_disagrees_asks_for_a_pinpoint(results):
    other = Opinion(1, "Mehmet", Decision(Verdict.REJECTED))
    assert judged(results, record=ReviewRecord(opinions=(other,))).light is Light.YELLOW
    agrees = replace(other, decision=Decision(Verdict.CONFIRMED))
    elsewhere = replace(other, number=2)
    assert judged(results, record=ReviewRecord(opinions=(agrees, elsewhere))).light is Light.GREEN


def test_digs_that_missed_their_windows_widen_them_unless_the_report_has_done_so(results):
    history = DigHistory("rolling/*/*/*", 12, 7, 0.9, 4.0, 1, widen=3.0)
    record = ReviewRecord(history=history)
    assert judged(results, record=record, **window(2.0)).light is Light.YELLOW
    stated = replace(results.survey.stated, widen=3.0)
    told = replace(results, survey=replace(results.survey, stated=stated))
    assert judged(told, record=record, **window(2.0)).light is Light.GREEN


@pytest.mark.parametrize(
    "change",
    [
        {"clock": ClockMap(sigma_s=1.0, basis="assumed")},
        {"tie_checks": (TieCheck("valve 12", 60.0, "chainage", 5.0, 9.0, 0.5, held_down=True),)},
        {"tie_checks": (TieCheck("valve 12", 60.0, "chainage", 0.1, 1.4, 0.5, held_down=False),)},
        {"findings": (Finding("fit_not_settled", Severity.WARNING),)},
        {"findings": (Finding("radius_unknown", Severity.WARNING, {"radius_m": 0.05}),)},
        {"not_assessed": (Stretch(80.0, 90.0, Channel.PATH, "imu_gap"),)},
    ],
)
def test_each_flag_on_the_quality_asks_for_a_pinpoint(results, change):
    assert judged(replace(results, **change)).light is Light.YELLOW


def test_a_tie_point_that_is_missed_within_its_interval_is_no_flag(results):
    check = TieCheck("valve 12", 60.0, "chainage", 0.1, 1.2, 0.5, held_down=False)
    assert judged(replace(results, tie_checks=(check,))).light is Light.GREEN


def test_only_the_tie_points_next_to_a_leak_speak_of_it(results):
    good = TieCheck("valve 12", 60.0, "chainage", 0.1, 0.2, 0.5, held_down=False)
    far = TieCheck("launch side", 20.0, "chainage", 0.1, 1.9, 0.5, held_down=False)
    assert judged(replace(results, tie_checks=(far, good))).light is Light.GREEN
    assert judged(replace(results, tie_checks=(far,))).light is Light.YELLOW


@pytest.mark.parametrize("language", ["en", "tr"])
def test_every_reason_has_its_sentence_and_the_rule_names_its_limits(results, language):
    words = Words(ReportOptions(language))
    history = DigHistory("rolling/*/*/*", 12, 7, 0.9, 4.0, 1, widen=3.0)
    other = Opinion(1, "Mehmet", Decision(Verdict.REJECTED))
    digs = {2: DigResult(2, DigFinding.OTHER, "2026-05-09")}
    record = ReviewRecord(digs=digs, opinions=(other,), history=history)
    content = make_content(results, {}, record)
    for decision in (CONFIRMED, Decision(), Decision(Verdict.UNSURE, LeakClass.PUMP)):
        for row in content.rows:
            for cause in assess(row.candidate, decision, results, record, NEAR).causes:
                assert "{" not in cause_sentence(cause, words)
    point = "," if language == "tr" else "."
    assert f"0{point}9" in rule(words)
    assert f"4{point}6 m" in rule(words)
    assert "100 m" in rule(words)


@pytest.mark.parametrize(("sigma_m", "light"), [(0.5, Light.GREEN), (1.1, Light.GREEN), (1.2, Light.YELLOW)])
def test_a_reference_that_is_itself_vague_allows_no_dig(results, sigma_m, light):
    vague = Reference("valve 12", 30.0, sigma_m)
    taped = tape(results.candidates[0], results, vague)
    found = judged(results, tapes=(taped,))
    assert found.light is light  # 1.96 times 1.17 m is half of the largest bell-hole
    assert ("reference_vague" in codes(found)) is (light is Light.YELLOW)


def test_a_sure_reference_counts_where_a_nearer_one_is_vague(results):
    tapes = tuple(
        tape(results.candidates[0], results, r) for r in (Reference("a", 40.0, 9.0), Reference("b", 60.0, 0.2))
    )
    found = judged(results, tapes=tapes)
    assert found.light is Light.GREEN
    assert found.causes[-1].texts == {"name": "b"}


@pytest.mark.parametrize(
    ("said", "light"),
    [(LeakClass.VALVE, Light.YELLOW), (LeakClass.LEAK, Light.GREEN), (None, Light.GREEN)],
)
def test_a_second_reviewer_who_takes_it_for_something_else_holds_up_the_dig(results, said, light):
    opinion = Opinion(results.candidates[0].label, "Mehmet", Decision(Verdict.CONFIRMED, said))
    record = ReviewRecord(opinions=(opinion,))
    assert judged(results, record=record).light is light
    by_machine = Decision(Verdict.CONFIRMED)  # the first one left the machine's class, a leak
    (row, *_) = make_content(results, {results.candidates[0].id: by_machine}, record).rows[1:]
    told = opinions(row, make_content(results, {}, record), Words(ReportOptions()))
    assert ("DIFFERS: confirmed, valve" in told) is (light is Light.YELLOW)
