"""A decision follows its sound to the new run, and never goes to another one."""

from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from processing.storage.carrying import NEAR_S, SAME_SOUND_S, partners


def numbered(candidates, first):
    return [replace(c, id=first + i) for i, c in enumerate(candidates)]


def test_the_same_places_are_found_again_in_any_order(candidate):
    old = numbered([candidate(t) for t in (10, 200, 300)], 1)
    new = numbered([candidate(t + 0.3) for t in (300, 10, 200)], 11)
    assert partners(old, new) == {1: 12, 2: 13, 3: 11}


def test_the_same_sound_is_found_again_however_far_new_tie_points_moved_the_track(candidate):
    assert partners([candidate(100, chainage_m=90, id=1)], [candidate(100.5, chainage_m=160, id=2)]) == {1: 2}


def test_another_sound_nearby_gets_nothing(candidate):
    assert partners([candidate(100, id=1)], [candidate(104, id=2)]) == {}  # 4 m away, known to a metre


def test_a_wide_interval_finds_its_candidate_a_little_farther_away(candidate):
    assert partners([candidate(100, half_m=6, id=1)], [candidate(104, id=2)]) == {1: 2}


def test_the_same_chainage_at_another_time_is_another_sound(candidate):
    assert partners([candidate(100, chainage_m=50, id=1)], [candidate(160, chainage_m=50, id=2)]) == {}


def test_each_new_candidate_is_used_once_and_by_the_nearest(candidate):
    old = numbered([candidate(100), candidate(102)], 1)
    assert partners(old, [candidate(101.6, id=9)]) == {2: 9}


def test_without_a_path_time_alone_decides(candidate):
    lost = {"chainage_m": float("nan"), "half_m": float("nan")}
    assert partners([candidate(100, id=1, **lost)], [candidate(100.4, id=2, **lost)]) == {1: 2}
    assert partners([candidate(100, id=1, **lost)], [candidate(103, id=2, **lost)]) == {}


times = st.lists(st.floats(0, 300), max_size=12)


@given(times, times)
def test_partners_are_one_to_one_near_and_the_same_whichever_run_is_the_older(candidate, before, after):
    old = numbered([candidate(t) for t in before], 1)
    new = numbered([candidate(t) for t in after], 101)
    found = partners(old, new)
    assert len(set(found.values())) == len(found)
    for old_id, new_id in found.items():
        assert abs(before[old_id - 1] - after[new_id - 101]) <= NEAR_S
    # nothing that is plainly the same is left over on both sides
    for old_id in {c.id for c in old} - found.keys():
        for new_id in {c.id for c in new} - set(found.values()):
            assert abs(before[old_id - 1] - after[new_id - 101]) > SAME_SOUND_S


@given(st.lists(st.integers(0, 500), unique=True, max_size=40))
def test_a_run_is_its_own_partner(candidate, seconds):
    old = numbered([candidate(t) for t in seconds], 1)
    new = [replace(c, id=c.id + 1000) for c in old]
    assert partners(old, new) == {c.id: c.id + 1000 for c in old}
