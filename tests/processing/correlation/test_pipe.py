"""Speeds follow the published formula; a delay becomes the place that gives it, with an interval that holds."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing import messages
from processing.correlation.pipe import (
    MATERIALS,
    Pipe,
    PipeSection,
    Where,
    delay_of_place,
    locate,
    place_of_delay,
    places_of_delays,
    sound_speed_mps,
)
from processing.correlation.speed import Tap, speed_of_both_ends, speed_of_tap
from processing.errors import ErrorCode, LeaklineError

sections = st.lists(
    st.builds(PipeSection, st.floats(1.0, 300.0), speed_mps=st.floats(250.0, 1400.0)), min_size=1, max_size=5
)


def one(length_m=100.0, speed_mps=400.0, sigma=0.0, **more):
    return Pipe((PipeSection(length_m, speed_mps=speed_mps, speed_sigma_mps=sigma, **more),))


def test_one_section_is_the_papers_formula():
    assert place_of_delay(one(), 0.1) == pytest.approx((100.0 - 400.0 * 0.1) / 2.0)
    assert locate(one(), 0.1, 0.0).from_b_m == pytest.approx(70.0)


@given(sections, st.floats(0.001, 0.999))
def test_a_place_gives_a_delay_that_gives_the_place(parts, at):
    pipe = Pipe(tuple(parts))
    place = at * pipe.length_m
    assert place_of_delay(pipe, delay_of_place(pipe, place)) == pytest.approx(place, rel=1e-9, abs=1e-9)


@given(sections, st.floats(-1.0, 1.0))
def test_many_delays_at_once_are_the_same_as_one_by_one(parts, delay_s):
    pipe = Pipe(tuple(parts))
    assert places_of_delays(pipe, np.array([delay_s]))[0] == pytest.approx(place_of_delay(pipe, delay_s), abs=1e-6)


@given(sections, st.floats(0.0, 1.0))
def test_turning_the_pipe_round_turns_the_delay_round(parts, at):
    pipe, back = Pipe(tuple(parts)), Pipe(tuple(parts[::-1]))
    place = at * pipe.length_m
    assert delay_of_place(back, pipe.length_m - place) == pytest.approx(-delay_of_place(pipe, place), abs=1e-9)


@pytest.mark.parametrize(
    ("material", "diameter_mm", "wall_mm", "low", "high"),
    [
        # ranges that textbooks and makers of correlators give for such pipes
        ("ductile_iron", 150, 6.0, 1200, 1330),
        ("cast_iron", 150, 10.0, 1230, 1350),
        ("steel", 200, 5.0, 1150, 1330),
        ("asbestos_cement", 150, 15.0, 950, 1120),
        ("pvc", 160, 7.0, 300, 480),
        ("pe100", 110, 10.0, 240, 340),
        ("pe50", 63, 5.8, 120, 230),
    ],
)
def test_speeds_are_those_of_the_trade(material, diameter_mm, wall_mm, low, high):
    assert low < sound_speed_mps(material, diameter_mm * 1e-3, wall_mm * 1e-3) < high


def test_the_formula_in_numbers():
    # √(2.2e9/1000) = 1483.24; 0.91·(2.2/157)·(150/6) = 0.31879
    assert sound_speed_mps("ductile_iron", 0.150, 0.006) == pytest.approx(1483.2397 / math.sqrt(1.3187898), rel=1e-6)


def test_the_interval_is_that_of_random_trials():
    """Linear propagation against drawing every length, speed, delay and clock at random."""
    rng = np.random.default_rng(4)
    told = Pipe(
        (
            PipeSection(40.0, speed_mps=1200.0, speed_sigma_mps=20.0, length_sigma_m=0.1),
            PipeSection(30.0, speed_mps=400.0, speed_sigma_mps=12.0, length_sigma_m=0.2),
            PipeSection(50.0, speed_mps=1000.0, speed_sigma_mps=25.0, length_sigma_m=0.1),
        )
    )
    delay_s = delay_of_place(told, 62.0)
    found = locate(told, delay_s, 2e-4, 1e-4)
    places = []
    for _ in range(4000):
        drawn = Pipe(
            tuple(
                PipeSection(
                    rng.normal(s.length_m, s.length_sigma_m), speed_mps=rng.normal(s.speed_mps, s.speed_sigma_mps)
                )
                for s in told.sections
            )
        )
        places.append(place_of_delay(drawn, delay_s + rng.normal(0, 2e-4) + rng.normal(0, 1e-4)))
    assert found.from_a_m == pytest.approx(62.0)
    assert found.sigma_m == pytest.approx(np.std(places), rel=0.06)
    assert found.low95_m == pytest.approx(np.percentile(places, 2.5), abs=0.12)
    assert found.high95_m == pytest.approx(np.percentile(places, 97.5), abs=0.12)
    assert math.sqrt(sum(s.sigma_m**2 for s in found.shares)) == pytest.approx(found.sigma_m)


def test_sections_of_one_kind_are_wrong_together():
    """Two halves of the same pipe are no better known than the whole."""
    whole = locate(one(100.0, 400.0, 20.0), 0.1, 0.0)
    halves = Pipe(tuple(PipeSection(50.0, speed_mps=400.0, speed_sigma_mps=20.0) for _ in range(2)))
    assert locate(halves, 0.1, 0.0).sigma_m == pytest.approx(whole.sigma_m)
    assert whole.sigma_m == pytest.approx(0.1 * 20.0 / 2.0)


def test_an_error_that_all_speeds_share_is_that_of_the_whole_delay():
    pipe = Pipe(
        (
            PipeSection(40.0, speed_mps=1200.0, speed_sigma_mps=0.0),
            PipeSection(60.0, speed_mps=400.0, speed_sigma_mps=0.0),
        )
    )
    wrong = Pipe(tuple(PipeSection(s.length_m, speed_mps=1.001 * s.speed_mps) for s in pipe.sections))
    delay_s = delay_of_place(pipe, 70.0)
    moved = abs(place_of_delay(wrong, delay_s) - 70.0)
    assert locate(pipe, delay_s, 0.0, speeds_part_sigma=0.001).sigma_m == pytest.approx(moved, rel=0.01)


@pytest.mark.parametrize(
    ("delay_s", "where"),
    [(0.0, Where.BETWEEN), (0.25, Where.AT_A), (-0.25, Where.AT_B), (0.2495, Where.AT_A), (0.4, Where.IMPOSSIBLE)],
)
def test_a_source_at_or_beyond_a_sensor_is_said_to_be_so(delay_s, where):
    assert locate(one(), delay_s, 2e-4).where is where


@pytest.mark.parametrize(
    ("pipe", "code"),
    [
        (Pipe(()), ErrorCode.CORRELATION_SECTIONS),
        (one(0.0), ErrorCode.CORRELATION_LENGTH),
        (one(-5.0), ErrorCode.CORRELATION_LENGTH),
        (one(speed_mps=1.2), ErrorCode.CORRELATION_SPEED),  # km/s
        (Pipe((PipeSection(10.0),)), ErrorCode.CORRELATION_NEEDS_SPEED),
        (Pipe((PipeSection(10.0, "pvc"),)), ErrorCode.CORRELATION_NEEDS_SPEED),
        (Pipe((PipeSection(10.0, "pvc", 0.1, 0.06),)), ErrorCode.CORRELATION_WALL),
        (Pipe((PipeSection(40.0, speed_mps=400.0),), distance_m=100.0), ErrorCode.CORRELATION_SUM),
    ],
)
def test_a_pipe_that_cannot_be_is_refused(pipe, code):
    with pytest.raises(LeaklineError) as caught:
        pipe.checked()
    assert caught.value.code is code
    assert all(messages.error_sentence(caught.value, language) for language in messages.LANGUAGES)


def test_sections_may_miss_the_whole_by_their_uncertainty():
    pipe = Pipe((PipeSection(99.0, speed_mps=400.0, length_sigma_m=0.5),), distance_m=100.0)
    assert pipe.checked() is pipe


def test_every_material_has_its_speed_with_the_usual_wall():
    for material in MATERIALS:
        speed, sigma = PipeSection(10.0, material, 0.15).speed()
        assert 100.0 < speed < 1483.0
        assert 0.0 < sigma < 0.2 * speed


# --- the speed measured on site ---


def test_a_tap_beyond_a_sensor_tells_the_speed():
    pipe = one(100.0, 350.0)
    measured = speed_of_tap(pipe, Tap(-3.0, 100.0 / 412.0, 1e-4))
    assert measured.mean_mps == pytest.approx(412.0)
    assert measured.mean_sigma_mps == pytest.approx(412.0 * 1e-4 / (100.0 / 412.0))
    scaled = pipe.scaled(measured.factor, measured.part_sigma)
    assert scaled.sections[0].speed() == pytest.approx((412.0, measured.mean_sigma_mps))


def test_a_tap_at_a_known_place_between_tells_the_speed_and_its_place_counts():
    measured = speed_of_tap(one(100.0, 350.0), Tap(20.0, 60.0 / 412.0, 0.0, place_sigma_m=0.3))
    assert measured.mean_mps == pytest.approx(412.0)
    assert measured.mean_sigma_mps == pytest.approx(412.0 * 2 * 0.3 / 60.0, rel=1e-3)


def test_taps_beyond_both_ends_tell_speed_and_clock():
    """With the offset in use 3 ms too large, both delays are 3 ms too large."""
    travel = 100.0 / 412.0
    measured = speed_of_both_ends(one(100.0, 350.0), Tap(-1.0, travel + 0.003, 1e-4), Tap(101.0, -travel + 0.003, 1e-4))
    assert measured.mean_mps == pytest.approx(412.0)
    assert measured.offset_s == pytest.approx(-0.003)
    assert measured.offset_sigma_s == pytest.approx(1e-4 / math.sqrt(2.0))


@pytest.mark.parametrize(
    ("tap", "code"),
    [
        (Tap(49.0, 0.005, 1e-4), ErrorCode.CORRELATION_TAP_MIDDLE),
        (Tap(0.0, -0.25, 1e-4), ErrorCode.CORRELATION_TAP_SIGN),
        (Tap(100.0, 0.25, 1e-4), ErrorCode.CORRELATION_TAP_SIGN),
    ],
)
def test_a_tap_that_tells_nothing_is_refused(tap, code):
    with pytest.raises(LeaklineError) as caught:
        speed_of_tap(one(), tap)
    assert caught.value.code is code
    assert all(messages.error_sentence(caught.value, language) for language in messages.LANGUAGES)
