"""Kappa against published tables and a simulation; differences by their definition."""

import random

import pytest

from processing.agreement import agreement, differences, kappa_of
from processing.survey import Decision, LeakClass, Verdict

YES, NO, OPEN = Decision(Verdict.CONFIRMED), Decision(Verdict.REJECTED), Decision(Verdict.UNSURE)


def table(both_yes, yes_no, no_yes, both_no):
    return [("y", "y")] * both_yes + [("y", "n")] * yes_no + [("n", "y")] * no_yes + [("n", "n")] * both_no


@pytest.mark.parametrize(
    ("cells", "kappa"),
    # the worked examples of en.wikipedia.org/wiki/Cohen's_kappa
    [((20, 5, 10, 15), 0.40), ((45, 15, 25, 15), 0.1304), ((25, 35, 5, 35), 0.2593)],
)
def test_kappa_is_that_of_published_tables(cells, kappa):
    found = kappa_of(table(*cells))
    assert found.kappa == pytest.approx(kappa, abs=5e-5)
    assert (found.count, found.alike) == (sum(cells), cells[0] + cells[3])
    assert found.low95 < found.kappa < found.high95


def test_three_verdicts_count_as_three_words():
    # Cohen 1960, table 1: proportions of 200 judgments, kappa 0.492
    cells = {("a", "a"): 88, ("a", "b"): 14, ("a", "c"): 18, ("b", "a"): 10, ("b", "b"): 40, ("b", "c"): 10,
             ("c", "a"): 2, ("c", "b"): 6, ("c", "c"): 12}  # fmt: skip
    found = kappa_of([pair for pair, count in cells.items() for _ in range(count)])
    assert found.kappa == pytest.approx(0.492, abs=5e-4)


def test_few_leaks_that_all_agree_prove_little():
    found = kappa_of(table(3, 0, 0, 2))
    assert found.kappa == 1.0
    assert found.high95 == 1.0
    assert found.low95 < 0.3


def test_where_there_is_no_kappa_there_is_none():
    assert kappa_of([]).kappa is None
    same = kappa_of(table(7, 0, 0, 0))  # nobody could have said anything else
    assert (same.count, same.alike, same.kappa) == (7, 7, None)


def test_the_interval_holds_in_about_nineteen_of_twenty_reviews():
    chance, hits, rounds = random.Random(3), 0, 1500
    # both follow the truth (half yes) with probability 0.85: observed agreement 0.745, chance 0.5
    true_kappa = (0.85**2 + 0.15**2 - 0.5) / 0.5
    for _ in range(rounds):
        pairs = []
        for _ in range(30):
            truth = chance.random() < 0.5
            pairs.append(tuple(truth if chance.random() < 0.85 else not truth for _ in range(2)))
        found = kappa_of(pairs)
        hits += found.low95 <= true_kappa <= found.high95
    assert 0.92 <= hits / rounds <= 0.98


def test_only_leaks_that_both_judged_count():
    first = {1: YES, 2: NO, 3: Decision(note="a note"), 4: YES}
    second = {1: YES, 2: YES, 3: YES, 5: NO}
    assert (agreement(first, second).count, agreement(first, second).alike) == (2, 1)


def test_what_differs_is_a_verdict_a_class_or_a_note_that_says_something():
    valve = Decision(Verdict.CONFIRMED, LeakClass.VALVE)
    first = {1: YES, 2: YES, 3: YES, 4: Decision(Verdict.CONFIRMED, note="wet"), 5: YES, 7: YES}
    second = {1: YES, 2: NO, 3: valve, 4: YES, 5: Decision(Verdict.CONFIRMED, note="dry"), 6: OPEN, 8: Decision()}
    found = differences(first, second)
    assert [d.number for d in found] == [2, 3, 5, 6]
    assert [(d.in_verdict, d.in_class) for d in found] == [(True, False), (False, True), (False, False), (True, False)]
    assert found[3].first == Decision()
