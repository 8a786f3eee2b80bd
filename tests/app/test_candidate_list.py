"""What the list shows, and where a key leads: the order, the filter, and the one that is being decided."""

from dataclasses import replace

import pytest
from small_survey import candidate

from app.candidate_list import CandidateList
from processing.survey import Decision, LeakClass, Verdict
from widgets.candidate_row import FILTER_ROUND, CandidateFilter

NAN = float("nan")


@pytest.fixture
def shown():
    """Five candidates, the best first: 1 to 4 by the machine, 5 marked by hand."""
    found = CandidateList(lambda _candidate: None)
    made = [candidate(i, 10.0 * i, 0.9 - 0.2 * (i - 1)) for i in range(1, 5)]
    mark = replace(candidate(5, 5.0, 0.0), score=NAN)
    found.set_candidates([*made, mark], {}, frozenset({5}))
    return found


def decide(shown, candidate_id, verdict, leak_class=None):
    shown.set_decision(candidate_id, Decision(verdict, leak_class))


def test_the_decided_candidate_leaves_a_list_of_undecided_ones_only_after_the_move(shown):
    shown.filter, shown.selected = CandidateFilter(Verdict.NONE), 1
    then = shown.next_to_judge(1)
    decide(shown, 1, Verdict.CONFIRMED)
    assert shown.shown_ids() == [1, 2, 3, 4, 5]
    shown.selected = then
    assert shown.shown_ids() == [2, 3, 4, 5]


def test_arrows_and_undecided_keys_pass_by_what_the_filter_hides(shown):
    decide(shown, 2, Verdict.UNSURE)
    decide(shown, 4, Verdict.UNSURE)
    shown.filter, shown.selected = CandidateFilter(Verdict.UNSURE), 2
    assert shown.neighbour(+1) == 4
    assert shown.neighbour(-1) == 2  # the end is the end
    assert shown.next_undecided(2) is None  # those are hidden
    shown.filter = CandidateFilter()
    assert shown.next_undecided(2) == 3
    assert shown.next_undecided(2, upwards=True) == 1
    assert shown.next_undecided(1, upwards=True) == 5  # round the end


def test_a_verdict_in_a_list_of_unsure_ones_leads_to_the_next_unsure_one(shown):
    for unsure in (1, 3):
        decide(shown, unsure, Verdict.UNSURE)
    shown.filter, shown.selected = CandidateFilter(Verdict.UNSURE), 1
    assert shown.next_to_judge(1) == 3
    decide(shown, 1, Verdict.REJECTED)
    shown.selected = 3
    assert shown.next_to_judge(3) is None


def test_a_filter_by_class_goes_by_what_the_operator_says(shown):
    decide(shown, 2, Verdict.NONE, LeakClass.VALVE)
    assert [r.candidate.id for r in shown.rows() if CandidateFilter(None, LeakClass.VALVE).accepts(r)] == [2]


def test_the_least_score_never_hides_a_mark_made_by_hand(shown):
    shown.filter = CandidateFilter(least_score=0.6)
    assert shown.shown_ids() == [1, 2, 5]  # 0.9, 0.7, and no score


def test_every_candidate_is_in_exactly_one_list_by_verdict(shown):
    for candidate_id, verdict in zip(shown.ids(), [*Verdict, Verdict.NONE], strict=True):
        decide(shown, candidate_id, verdict)
    by_verdict = [r.candidate.id for v in Verdict for r in shown.rows() if CandidateFilter(v).accepts(r)]
    assert sorted(by_verdict) == sorted(shown.ids())


def test_the_key_goes_round_all_lists_and_keeps_class_and_score():
    wanted = CandidateFilter(None, LeakClass.LEAK, 0.3)
    seen = []
    for _ in FILTER_ROUND:
        wanted = wanted.next_verdict()
        seen.append(wanted.verdict)
        assert (wanted.leak_class, wanted.least_score) == (LeakClass.LEAK, 0.3)
    assert sorted(map(str, seen)) == sorted(map(str, FILTER_ROUND))
    assert seen[-1] is None


@pytest.mark.parametrize(
    "texts", [{}, {"list.verdict": "gone", "list.class": "?", "list.least_score": "x"}, {"list.least_score": "9"}]
)
def test_what_was_remembered_and_cannot_be_understood_hides_nothing(texts):
    assert not CandidateFilter.from_texts(texts).is_on


@pytest.mark.parametrize("verdict", FILTER_ROUND)
def test_a_filter_is_the_same_after_it_was_remembered(verdict):
    wanted = CandidateFilter(verdict, LeakClass.PUMP, 0.35)
    assert CandidateFilter.from_texts(wanted.as_texts()) == wanted
