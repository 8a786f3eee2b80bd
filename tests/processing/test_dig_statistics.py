"""What digs say of the stated intervals is right on digs whose truth is known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from processing.dig_history import DigKind, HistoryEntry
from processing.dig_statistics import (
    Errors,
    errors_of,
    history_of,
    score_bands,
    share_interval,
    widening,
)
from processing.dig_words import history_sentences, kind_words, widened_sentence
from processing.quantities import Quantities, Units
from processing.review_facts import DigFinding, DigResult

KIND = DigKind("rolling", "ductile_iron", 300, tied=True)


def dig(number=1, off=0.3, half=1.0, **more):
    facts = {"finding": DigFinding.LEAK, "off_along_m": off, "stated_chainage_m": 50.0, "stated_low95_m": 50.0 - half}
    return DigResult(**({"number": number, "stated_high95_m": 50.0 + half} | facts | more))


def entries(digs, kind=KIND, survey="a"):
    return [HistoryEntry(survey, "", i, 1, kind, one) for i, one in enumerate(digs)]


def simulated(true_scale, count, rng):
    """Return digs at intervals that are too narrow by ``true_scale``, measured by tape to 0.2 m."""
    sigma = rng.uniform(0.3, 1.5, count)
    tape = np.full(count, 0.2)
    error = rng.normal(0.0, np.hypot(true_scale * sigma, tape))
    return Errors(error, sigma, tape, np.abs(error) <= 1.96 * np.hypot(sigma, tape))


def coverage(factor, true_scale):
    """Return how often an interval widened by ``factor`` holds, in closed form."""
    return 2.0 * stats.norm.cdf(1.959964 * factor / true_scale) - 1.0


def test_right_intervals_stay_as_they_are():
    rng = np.random.default_rng(1)
    factors = [widening(simulated(1.0, 20, rng)).factor for _ in range(100)]
    assert np.median(factors) == 1.0
    assert np.mean(np.array(factors) > 1.0) < 0.12
    assert np.mean([coverage(f, 1.0) for f in factors]) == pytest.approx(0.95, abs=0.01)


@pytest.mark.parametrize("true_scale", [2.0, 3.0])
def test_intervals_that_were_too_narrow_hold_again_once_they_are_widened(true_scale):
    rng = np.random.default_rng(2)
    factors = [widening(simulated(true_scale, 40, rng)).factor for _ in range(60)]
    assert np.median(factors) == pytest.approx(true_scale, rel=0.1)
    assert coverage(1.0, true_scale) < 0.7
    assert np.mean([coverage(f, true_scale) for f in factors]) > 0.92


def test_with_very_many_digs_the_factor_is_the_root_mean_square_of_the_scaled_errors():
    rng = np.random.default_rng(3)
    sigma = np.full(3000, 1.0)
    error = rng.normal(0.0, 2.5, 3000)
    found = widening(Errors(error, sigma, np.full(3000, 1e-6), np.ones(3000, bool)))
    assert found.factor == pytest.approx(math.sqrt(np.mean(error**2)), rel=0.02)
    assert found.chance_narrow > 0.999


def test_one_or_two_digs_change_nothing_however_wrong_the_places_were():
    for count in (1, 2, 4):
        assert widening(Errors(np.full(count, 4.0), np.ones(count), np.zeros(count), np.zeros(count, bool))).factor == 1


def test_one_gross_error_among_good_digs_does_not_widen_all_intervals():
    error = np.append(np.random.default_rng(4).normal(0.0, 0.5, 14), 60.0)
    assert widening(Errors(error, np.full(15, 0.5), np.full(15, 0.1), np.ones(15, bool))).factor == 1.0


def test_a_factor_below_one_needs_many_digs():
    rng = np.random.default_rng(5)
    few, many = simulated(0.4, 20, rng), simulated(0.4, 120, rng)
    assert widening(few).factor == 1.0
    assert 0.3 < widening(many).factor < 0.6


def test_the_tape_is_not_held_against_the_interval():
    sure, rough = dig(off=1.2, sigma_m=0.01), dig(off=1.2, sigma_m=0.5)
    assert errors_of([sure, rough]).held.tolist() == [False, True]  # √(1² + (1.96·0.5)²) = 1.4 m
    phone = dig(off=2.5, measured="coordinates")
    assert errors_of([phone]).held.tolist() == [True]


def test_each_side_of_an_interval_counts_for_itself_and_one_that_ends_at_the_launch_is_not_taken_for_narrow():
    uneven = dig(stated_low95_m=49.0, stated_high95_m=53.0, sigma_m=0.0)
    assert errors_of([replace(uneven, off_along_m=2.0), replace(uneven, off_along_m=-2.0)]).held.tolist() == [
        True,
        False,
    ]
    launch = dig(off=-0.2, stated_chainage_m=0.3, stated_low95_m=0.0, stated_high95_m=2.3)
    assert errors_of([launch]).sigma_m == pytest.approx(2.0 / 1.959964)


def test_what_had_been_widened_when_it_was_stated_is_not_widened_once_more():
    narrow = errors_of([dig(half=1.0)]).sigma_m
    assert errors_of([dig(half=2.0, stated_widen=2.0)]).sigma_m == pytest.approx(narrow)


def test_dry_holes_unmeasured_digs_and_missed_leaks_are_no_errors_but_are_counted():
    digs = [dig(off=float(i) / 10) for i in range(8)]
    digs += [
        dig(finding=DigFinding.NOTHING, off=None),
        dig(finding=DigFinding.OTHER, off=None),
        dig(off=None),
        DigResult(9, DigFinding.LEAK, missed=True),
    ]
    found = history_of(entries(digs), KIND)
    assert (found.count, found.held, found.dug, found.dry_holes, found.missed) == (8, 8, 11, 2, 1)
    assert found.median_error_m == pytest.approx(0.35)
    assert found.p95_error_m == pytest.approx(0.7)
    assert found.bias_m == pytest.approx(0.35)


def test_shares_have_the_intervals_of_clopper_and_pearson():
    # published: R's binom.test(11, 12) and binom.test(0, 10)
    assert share_interval(11, 12) == pytest.approx((0.6152038, 0.9978924), abs=1e-6)
    assert share_interval(0, 10) == pytest.approx((0.0, 0.3084971), abs=1e-6)
    assert share_interval(0, 0) == (0.0, 1.0)


def test_the_narrowest_pool_with_enough_digs_speaks_and_other_motions_never_do():
    other = replace(KIND, diameter_mm=600)
    some = entries([dig() for _ in range(8)], other) + entries([dig(off=3.0)], KIND, "b")
    assert history_of(some, KIND).kind == "rolling/ductile_iron/*/tied"
    assert history_of(some, other).kind == "rolling/ductile_iron/600/tied"
    assert history_of(some, other).count == 8
    assert history_of(some, replace(KIND, motion="foot")) is None
    assert history_of(some, replace(KIND, material="pvc")).kind == "rolling/*/*/tied"
    assert history_of(some[-1:], KIND).kind == "rolling/ductile_iron/300/tied"


def test_the_hits_of_each_band_of_scores_are_told():
    leak, other = DigFinding.LEAK, DigFinding.OTHER
    pairs = ((0.2, other), (0.95, leak), (1.0, leak), (0.9, DigFinding.NOTHING))
    digs = [dig(stated_score=score, finding=finding) for score, finding in pairs]
    low, high = score_bands(digs)
    assert (low.low, low.high, low.digs, low.leaks) == (0.0, 0.3, 1, 0)
    assert (high.low, high.high, high.digs, high.leaks) == (0.9, 1.0, 3, 2)


def test_the_sentence_is_that_of_the_trade_in_both_languages():
    digs = [dig(off=0.6) for _ in range(11)] + [dig(off=4.0, sigma_m=0.1)]
    found = history_of(entries(digs, replace(KIND, diameter_mm=0)), replace(KIND, diameter_mm=0))
    first = history_sentences(found, Quantities("en"))[0]
    assert first.startswith("Of 12 measured digs on rolling runs in ductile iron, with tie points, 11 lay within")
    assert "median error 0.6 m" in first
    turkish = history_sentences(found, Quantities("tr"))[0]
    assert "12 kazının" in turkish
    assert "0,6 m" in turkish
    assert "2.0 ft" in history_sentences(found, Quantities("en", Units.US))[0]


def test_what_is_too_little_is_said_to_be_too_little():
    one = history_of(entries([dig(off=3.0, sigma_m=0.1)]), KIND)
    sentences = history_sentences(one, Quantities("en"))
    assert "lay outside the stated interval; it was 3.0 m off" in sentences[0]
    assert "can neither confirm nor refute" in sentences[1]
    assert widened_sentence(1.0, one.kind, Quantities()) == ""
    assert "1.6 times" in widened_sentence(1.6, one.kind, Quantities())


@pytest.mark.parametrize("language", ["en", "tr"])
def test_every_pool_of_every_kind_has_words(language):
    for motion in ("rolling", "carried", "foot"):
        for material in ("", "other", "steel", "pe_small"):
            for diameter in (0, 110, 300, 600, 9999):
                for pool in DigKind(motion, material, diameter, tied=False).pools():
                    words = kind_words(pool, language)
                    assert not set("?*/{}_") & set(words), words
