"""The status of each metre of the pipe."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.reporting.content import make_content
from processing.reporting.stretches import StretchStatus, metres_by_status, pipe_stretches, tile
from processing.review_facts import DigFinding, DigResult, ReviewRecord
from processing.survey import Channel, Decision, LeakClass, Stretch, Verdict

ENDS = st.floats(-50.0, 150.0, allow_nan=False)


def found(results, decisions, record=None):
    return pipe_stretches(make_content(results, decisions, record))


def at(stretches, metre):
    (inside,) = [s for s in stretches if s.start_m <= metre < s.end_m]
    return inside


def test_each_metre_says_what_is_known_of_it(results, decisions):
    confirmed = decisions | {1: Decision(Verdict.CONFIRMED, LeakClass.LEAK)}
    stretches = found(results, confirmed)
    told = [(s.start_m, s.end_m, s.status.value) for s in stretches]
    assert told == [
        (0.0, 41.0, "no_leak_found"),
        (41.0, 43.0, "leak"),
        (43.0, 50.0, "no_leak_found"),
        (50.0, 60.0, "not_assessed"),
        (60.0, 69.0, "no_leak_found"),
        (69.0, 71.0, "suspected"),
        (71.0, 100.0, "no_leak_found"),
    ]
    assert at(stretches, 55.0).reasons == ("sound_clipped",)
    assert at(stretches, 42.0).leaks == (1,)
    assert at(stretches, 42.0).half95_m == pytest.approx(1.96 * 0.5, abs=1e-3)
    assert metres_by_status(stretches)[StretchStatus.NOT_ASSESSED] == pytest.approx(10.0)


def test_a_confirmed_valve_is_no_leak_but_a_place_nobody_judged_is_suspected(results, decisions):
    stretches = found(results, decisions)  # 1 is confirmed as a valve
    assert at(stretches, 42.0).status is StretchStatus.CLEAR
    assert at(stretches, 70.0).status is StretchStatus.SUSPECTED
    unsure = found(results, {2: Decision(Verdict.UNSURE)})
    assert at(unsure, 70.0).status is StretchStatus.SUSPECTED


@pytest.mark.parametrize(
    ("finding", "status"),
    [
        (DigFinding.LEAK, StretchStatus.LEAK),
        (DigFinding.OTHER, StretchStatus.CLEAR),
        (DigFinding.NOTHING, StretchStatus.SUSPECTED),
    ],
)
def test_the_dig_knows_better_than_the_verdict(results, decisions, finding, status):
    confirmed = decisions | {1: Decision(Verdict.CONFIRMED, LeakClass.LEAK)}
    record = ReviewRecord(digs={1: DigResult(1, finding)})
    assert at(found(results, confirmed, record), 42.0).status is status


def test_a_leak_in_a_stretch_that_was_not_assessed_is_told_and_so_is_the_reason(results):
    poor = replace(results, not_assessed=(Stretch(80.0, 100.0, Channel.SOUND, "sound_clipped"),))
    inside = at(found(poor, {1: Decision(Verdict.CONFIRMED)}), 42.0)
    assert (inside.status, inside.reasons) == (StretchStatus.LEAK, ("sound_clipped",))


def test_without_a_path_nothing_is_said_of_any_metre(results, decisions):
    assert found(replace(results, track=None), decisions) == ()


@given(
    st.lists(st.tuples(ENDS, ENDS), max_size=25),
    st.lists(st.tuples(ENDS, st.floats(0.0, 30.0), st.sampled_from(Verdict)), max_size=12),
)
def test_the_stretches_tile_the_pipe_without_gap_or_overlap(spans, leaks):
    results, decisions = SMALL[0], {}
    candidates = []
    for number, (middle, half, verdict) in enumerate(leaks, start=1):
        ends = {"chainage_low95_m": middle - half, "chainage_high95_m": middle + half}
        candidates.append(replace(results.candidates[0], id=number, chainage_m=middle, **ends))
        decisions[number] = Decision(verdict)
    stretches = tuple(Stretch(2 * min(a, b), 2 * max(a, b), Channel.SOUND, "sound_clipped") for a, b in spans)
    tiles = found(replace(results, candidates=tuple(candidates), not_assessed=stretches), decisions)
    assert tiles[0].start_m == 0.0
    assert tiles[-1].end_m == results.track.chainage_m[-1]
    for one, other in itertools.pairwise(tiles):
        assert one.end_m == other.start_m
        assert (one.status, one.leaks, one.reasons) != (other.status, other.leaks, other.reasons)
    assert all(tile.end_m > tile.start_m for tile in tiles)
    for start, end in spans:  # what was not assessed is never called clear
        middle = (max(0.0, min(start, end)) + min(100.0, max(start, end))) / 2
        if 0.0 < middle < 100.0 and abs(end - start) > 1e-6:
            assert at(tiles, middle).status is not StretchStatus.CLEAR


SMALL = []


@pytest.fixture(autouse=True)
def small(results):
    SMALL[:] = [results]


@given(st.lists(st.tuples(ENDS, ENDS), max_size=40))
def test_each_piece_lies_in_exactly_the_spans_that_cover_it(spans):
    pieces = tile(0.0, 100.0, spans)
    assert sum(end - start for start, end, _ in pieces) == pytest.approx(100.0)
    for start, end, inside in pieces:
        middle = (start + end) / 2
        if start < middle < end:
            assert set(inside) == {i for i, (a, b) in enumerate(spans) if a < middle < b}


def test_the_largest_of_both_borders_intervals_is_told(results, decisions):
    track = replace(results.track, sigma_along_m=0.01 * results.track.chainage_m)
    last = found(replace(results, track=track), decisions)[-1]
    assert last.half95_m == pytest.approx(1.959964 * 0.01 * 100.0, rel=1e-6)
    assert np.isfinite([s.half95_m for s in found(results, decisions)]).all()
