"""The figures by which leak detectors are compared, and their ceiling, against small cases that can be done by hand."""

import importlib.util
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from processing.simulation.scenario import Local
from processing.simulation.sources import Heard, Source, passing
from processing.survey import LeakClass

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def loaded(name):
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def figures():
    return loaded("leak_figures")


@pytest.fixture(scope="module")
def ceiling(figures):
    loaded("leak_runs")
    return loaded("leak_ceiling")


@dataclass(frozen=True)
class Found:
    chainage_m: float
    score: float
    half_m: float = 1.0
    evidence: dict = field(default_factory=lambda: {"sigma_sound_m": 0.2})

    @property
    def chainage_low95_m(self):
        return self.chainage_m - self.half_m

    @property
    def chainage_high95_m(self):
        return self.chainage_m + self.half_m


@dataclass(frozen=True)
class Leak:
    told_m: float
    chainage_m: float
    half_width_m: float = 1.0


def outcome_of(figures, rows, snr_db=((6.0, -2.0),), length_m=(1000.0,)):
    return figures.Outcome(tuple(rows), tuple(snr_db), tuple(length_m))


def test_a_leak_is_hit_once_by_its_best_candidate_and_a_second_one_there_is_a_false_alarm(figures):
    leaks = [Leak(100.0, 100.5), Leak(120.0, 120.0, half_width_m=4.0)]
    rows = figures.matched_rows(3, leaks, [Found(101.0, 0.6), Found(99.8, 0.9), Found(127.9, 0.5), Found(134.0, 0.8)])
    assert [(r.score, r.leak) for r in rows] == [(0.9, 0), (0.8, -1), (0.6, -1), (0.5, 1)]
    assert rows[0].own_error_m == pytest.approx(-0.2)
    assert rows[0].error_m == pytest.approx(-0.7)
    assert all(r.run == 3 for r in rows)


def test_the_threshold_lets_just_so_many_false_alarms_a_kilometre_through(figures):
    rows = [figures.Row(0, s, -1) for s in (0.9, 0.7, 0.5, 0.3)]
    outcome = outcome_of(figures, rows, length_m=(2000.0,))
    for per_km, rate in [(0.4, 0.0), (0.5, 0.5), (1.0, 1.0), (1.9, 1.5), (5.0, 2.0)]:
        assert figures.false_per_km(outcome, figures.threshold_at(outcome, per_km)) == rate


def test_recall_is_counted_by_snr_and_average_precision_punishes_what_is_ranked_above(figures):
    rows = [figures.Row(0, 0.9, 0, 0, 0, 1, 1), figures.Row(0, 0.8, -1), figures.Row(0, 0.4, 1, 0, 0, 1, 1)]
    outcome = outcome_of(figures, rows)
    assert figures.recall(outcome, 0.5) == {6: (1, 1), -2: (0, 1), None: (1, 2)}
    assert figures.average_precision(outcome) == pytest.approx((1 + 2 / 3) / 2)
    missed = outcome_of(figures, rows[:1])
    assert figures.average_precision(missed) == pytest.approx(0.5)


def test_calibration_compares_what_is_stated_with_what_is_true_and_weighs_by_number(figures):
    rng = np.random.default_rng(0)
    score = rng.uniform(0.2, 1.0, 20000)
    honest = [figures.Row(0, s, 0 if rng.random() < s else -1) for s in score]
    assert figures.calibration(outcome_of(figures, honest))[1] < 0.015
    boasting = [figures.Row(0, s, 0 if rng.random() < s - 0.2 else -1) for s in score]
    assert figures.calibration(outcome_of(figures, boasting))[1] == pytest.approx(0.2, abs=0.015)


def test_apex_figures_count_what_lies_in_the_intervals_at_the_asked_snr(figures):
    rng = np.random.default_rng(1)
    errors = rng.normal(0, 0.3, 4000)
    rows = [figures.Row(0, 0.9, 0, e, e, 0.3, 1.959964 * 0.3) for e in errors]
    rows += [figures.Row(0, 0.9, 1, 50.0, 50.0, 0.1, 0.1)]
    got = figures.apex(outcome_of(figures, rows, ((6.0, -6.0),)), 0.5)
    assert got["hits"] == 4000
    assert got["own_inside"] == pytest.approx(95.0, abs=1.2)
    assert got["own"][2] == pytest.approx(0.3, abs=0.01)
    assert got["own"][0] == pytest.approx(0.3 * 0.6745, abs=0.01)


def test_outcomes_survive_a_file_and_are_joined_run_after_run(figures):
    one = outcome_of(figures, [figures.Row(0, 0.9, 1, 0.1, 0.2, 0.3, 0.4)])
    both = figures.joined([one, figures.from_plain(figures.plain(one))])
    assert [r.run for r in both.rows] == [0, 1]
    assert both.length_m == (1000.0, 1000.0)
    assert figures.recall(both, 0.5)[None] == (2, 4)


def test_resampled_runs_keep_their_own_rows(figures):
    rows = [figures.Row(0, 0.9, -1), figures.Row(1, 0.8, 0, 0, 0, 1, 1)]
    outcome = outcome_of(figures, rows, ((6.0,), (2.0,)), (500.0, 700.0))
    again = figures.resampled(outcome, [1, 1, 0])
    assert again.length_m == (700.0, 700.0, 500.0)
    assert sorted((r.run, r.leak) for r in again.rows) == [(0, 0), (1, 0), (2, -1)]


def small_truth(ceiling, rng, with_leak):
    """A straight run past one weak leak in two sources of noise, in four bands."""
    local = Local(LeakClass.LEAK, 30.0, 1.5)
    truth = ceiling.Truth.__new__(ceiling.Truth)
    t = np.arange(0.0, 120.0, ceiling.FRAME_S)
    truth.heard = Heard(t, 0.5 * t, np.full(len(t), 0.5), 10.0 * t)
    truth.shapes = np.array([[0.4, 0.3, 0.2, 0.1], [0.1, 0.4, 0.4, 0.1]])
    truth.pairs = np.array([3.0, 6.0, 12.0, 24.0])
    flow = Source("flow", truth.shapes[0], lambda h: np.ones(len(h.time_s)))
    leak = Source("leak", truth.shapes[1], lambda h: 0.25 * passing(local, h.chainage_m))
    truth.sources = [flow, leak]
    truth.mean = np.outer(flow.power(truth.heard), truth.shapes[0])
    heard = truth.mean + with_leak * np.outer(leak.power(truth.heard), truth.shapes[1])
    truth.power = heard * rng.gamma(truth.pairs, 1.0, heard.shape) / truth.pairs
    return truth, local


def test_the_ceilings_likelihood_ratio_is_one_in_the_mean_where_there_is_no_leak(ceiling):
    rng = np.random.default_rng(2)
    ratios, present = [], []
    for _ in range(700):
        truth, local = small_truth(ceiling, rng, 0.0)
        ratios.append(truth.ratios(1, local, [30.0], truth.mean)[0])
        truth, local = small_truth(ceiling, rng, 1.0)
        present.append(truth.ratios(1, local, [30.0], truth.mean)[0])
    # the mean of the likelihood ratio under the null hypothesis is one; under the other, so is that of its inverse
    share = 0.5  # E[√ratio] is the same from both sides: less scattered than the mean itself
    assert np.mean(np.exp(share * np.array(ratios))) == pytest.approx(
        np.mean(np.exp(-(1 - share) * np.array(present))), rel=0.1
    )
    assert np.mean(ratios) < 0 < np.mean(present)


def test_the_ceiling_that_knows_no_levels_has_unit_variance_and_is_not_fooled_by_them(ceiling):
    rng = np.random.default_rng(3)
    values, fooled = [], []
    for _ in range(400):
        truth, local = small_truth(ceiling, rng, 0.0)
        values.append(truth.without_levels(1, local, [30.0], truth.mean)[0])
        away = (truth.heard.chainage_m - 30.0) / ceiling.AROUND_M
        truth.power = truth.power * (1 + 0.3 * away + 0.4 * away**2)[:, None]
        fooled.append(truth.without_levels(1, local, [30.0], truth.mean)[0])
    assert np.mean(values) == pytest.approx(0.0, abs=0.15)
    assert np.std(values) == pytest.approx(1.0, abs=0.1)
    assert np.mean(fooled) == pytest.approx(0.0, abs=0.2)
