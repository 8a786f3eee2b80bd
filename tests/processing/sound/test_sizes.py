"""Leak sizes against the law they state, in closed form, and against simulated leaks of known power."""

import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sound_runs import Leak, drift

from processing import messages
from processing.settings import DetectorSettings, SizeSettings
from processing.sound.candidates import find_candidates
from processing.sound.size_words import size_name, size_sentence
from processing.sound.sizes import SizeClass, known_candidate, size_of
from processing.survey import (
    CalibrationLeak,
    Candidate,
    DeviceInfo,
    LeakClass,
    Motion,
    PipeInfo,
    ProcessingChoice,
    Survey,
)

SETTINGS = SizeSettings()


def candidate(number, at_m, over_db=None, background_db=-60.0, speed=0.5):
    evidence = {"speed_mps": speed}
    if over_db is not None:
        evidence |= {"size_over_db": over_db, "size_background_db": background_db}
        evidence |= {"size_low_hz": 800.0, "size_high_hz": 3200.0}
    return Candidate(
        number, 1.0, at_m, at_m - 1, at_m + 1, (at_m, 0.0, 0.0), 0.9, 10.0, LeakClass.LEAK, (500, 4000), 1.0, evidence
    )  # fmt: skip


def surveyed(known=None, pressure_bar=None, motion=Motion.ROLLING):
    return Survey(pipe=PipeInfo(pressure_bar=pressure_bar), device=DeviceInfo(motion), calibration_leak=known)


def middle(size):
    return math.sqrt(size.flow_lpm[0] * size.flow_lpm[1])


def test_without_a_known_leak_there_are_never_litres():
    for over in (-10.0, 5.0, 30.0):
        size = size_of(candidate(1, 50.0, over), surveyed(), SETTINGS)
        assert size.flow_lpm is None
        assert size.basis == "excess"
        assert "L/min" not in size.basis_text
        assert "not calibrated" in size.basis_text


def test_louder_is_never_smaller_and_borders_are_called_by_both_names():
    order = list(SizeClass)
    sizes = [size_of(candidate(1, 50.0, db / 2), surveyed(), SETTINGS) for db in range(-60, 100)]
    assert [order.index(s.size) for s in sizes] == sorted(order.index(s.size) for s in sizes)
    assert {s.name for s in sizes} == {"small", "small-medium", "medium", "medium-large", "large"} - (
        {"medium"} if SETTINGS.large_above_db - SETTINGS.small_below_db <= 12 else set()
    )
    assert size_of(candidate(1, 50.0, SETTINGS.small_below_db - 7), surveyed(), SETTINGS).name == "small"
    assert size_of(candidate(1, 50.0, SETTINGS.small_below_db - 5), surveyed(), SETTINGS).name == "small-medium"
    assert size_of(candidate(1, 50.0, SETTINGS.large_above_db + 7), surveyed(), SETTINGS).name == "large"


def test_a_leak_passed_twice_as_fast_stands_out_by_nine_decibels_less():
    # rolling noise grows with the cube of the speed: 30·log10(2) dB
    slow = size_of(candidate(1, 50.0, 12.0, speed=0.4), surveyed(), SETTINGS)
    fast = size_of(candidate(1, 50.0, 12.0 - 30 * math.log10(2), speed=0.8), surveyed(), SETTINGS)
    assert fast.level_db == pytest.approx(slow.level_db)
    carried = size_of(candidate(1, 50.0, 12.0, speed=0.8), surveyed(motion=Motion.CARRIED), SETTINGS)
    assert carried.level_db == 12.0


@settings(max_examples=40, deadline=None)
@given(over=st.floats(4, 30), louder=st.floats(-20, 20), flow=st.floats(0.5, 500), background=st.floats(-20, 20))
def test_ten_decibels_are_ten_times_the_flow_whatever_the_noise_at_either_place(over, louder, flow, background):
    known = CalibrationLeak(20.0, flow, 3.0)
    reference = candidate(1, 20.5, over, -60.0)
    other = candidate(2, 90.0, over + louder - background, -60.0 + background)
    size = size_of(other, surveyed(known, 3.0), SETTINGS, (reference, other))
    assert middle(size) == pytest.approx(flow * 10 ** (louder / 10), rel=1e-6)
    assert size.flow_lpm[0] < middle(size) / 4
    assert size.flow_lpm[1] > 4 * middle(size)


def test_more_pressure_makes_more_noise_of_the_same_flow():
    known = CalibrationLeak(20.0, 10.0, 2.0)
    reference, other = candidate(1, 20.0, 10.0), candidate(2, 90.0, 10.0)
    size = size_of(other, surveyed(known, 4.0), SETTINGS, (reference, other))
    assert middle(size) == pytest.approx(10.0 / 2**2.5)
    same = size_of(other, surveyed(known, 2.0), SETTINGS, (reference, other))
    assert size.sigma_db > same.sigma_db


def test_the_known_leak_is_itself_and_its_class_is_that_of_its_flow():
    for flow, name in ((2.0, "small"), (30.0, "medium"), (300.0, "large")):
        known = CalibrationLeak(20.0, flow, 3.0)
        reference = candidate(1, 20.0, 10.0)
        size = size_of(reference, surveyed(known), SETTINGS, (reference,))
        assert size.basis == "itself"
        assert size.name == name
        assert size.flow_lpm == (flow, flow)


def test_a_known_leak_that_was_not_heard_calibrates_nothing():
    known = CalibrationLeak(20.0, 10.0, 3.0)
    far, silent = candidate(1, 40.0, 10.0), candidate(2, 20.0)
    assert known_candidate(known, (far,)) is None
    assert size_of(far, surveyed(known), SETTINGS, (far,)).basis == "excess"
    assert size_of(far, surveyed(known), SETTINGS, (far, silent)).basis == "excess"


def test_what_was_marked_by_hand_has_no_size():
    size = size_of(candidate(1, 50.0), surveyed(), SETTINGS)
    assert (size.size, size.basis, size.basis_text) == (SizeClass.UNKNOWN, "none", "")
    for language in messages.LANGUAGES:
        assert size_sentence(size, language) == size_name(size, language) == ""


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_every_basis_has_a_sentence_with_its_conditions(language):
    known = CalibrationLeak(20.0, 10.0, 2.0)
    reference, other = candidate(1, 20.0, 10.0), candidate(2, 90.0, 12.0)
    excess = size_sentence(size_of(other, surveyed(), SETTINGS), language)
    assert ("0.50" if language == "en" else "0,50") in excess
    beside = size_sentence(size_of(other, surveyed(known, 4.0), SETTINGS, (reference, other)), language)
    assert ("4.0 bar" if language == "en" else "4,0 bar") in beside
    itself = size_sentence(size_of(reference, surveyed(known), SETTINGS, (reference, other)), language)
    assert "10" in itself


def test_the_loudness_of_simulated_leaks_is_theirs_within_three_decibels():
    # four leaks of one spectrum, 5 dB from each to the next, in the same noise
    leaks = [Leak(40 + 50 * i, 1.5, 4.0 + 5 * i, 1400.0) for i in range(4)]
    run = drift(leaks, seed=8)
    survey = Survey(processing=ProcessingChoice(detector="metres"))
    found = find_candidates(run.scan, run.clock, run.track, survey, DetectorSettings()).candidates
    heard = [min(found, key=lambda c, at=leak.place_m: abs(c.chainage_m - at)) for leak in leaks]
    levels = [c.evidence["size_over_db"] + c.evidence["size_background_db"] for c in heard]
    for i in range(1, 4):
        assert levels[i] - levels[0] == pytest.approx(5.0 * i, abs=3.0)
    known = CalibrationLeak(40.0, 10.0, 3.0)
    told = replace(survey, calibration_leak=known, pipe=PipeInfo(pressure_bar=3.0))
    for i, c in enumerate(heard[1:], 1):
        size = size_of(c, told, SETTINGS, found)
        assert size.flow_lpm[0] < 10.0 * 10 ** (0.5 * i) < size.flow_lpm[1]
