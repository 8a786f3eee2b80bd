"""Facts survive the way through JSON, and nothing but facts comes out of it."""

import json
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.storage.plain import from_json, from_plain, to_json, to_plain
from processing.survey import Candidate, Decision, Finding, FloatArray, Survey, TiePoint, Track

json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=12,
)


@pytest.mark.parametrize("kind", [Survey, Candidate, Decision, Finding, TiePoint])
def test_facts_are_the_same_after_the_way_through_json(kind):
    params = st.dictionaries(st.text(), st.text() | st.floats())
    special = {Candidate: {"evidence": params}, Finding: {"params": params}}

    @given(st.builds(kind, **special.get(kind, {})))
    def check(fact):
        assert repr(from_json(kind, to_json(fact))) == repr(fact)  # repr, as NaN is no NaN's equal

    check()


@given(json_values)
def test_any_json_gives_facts_or_a_value_error(value):
    for kind in (Survey, Candidate, Decision, Finding):
        try:
            found = from_plain(kind, value)
        except ValueError:
            continue
        assert isinstance(found, kind)


@given(st.text())
def test_any_text_gives_facts_or_a_value_error(text):
    with suppress(ValueError):
        assert isinstance(from_json(Decision, text), Decision)


def test_deep_nesting_is_a_value_error():
    with pytest.raises(ValueError, match="nested"):
        from_json(Decision, "[" * 100_000)


def test_unknown_keys_are_ignored_and_missing_ones_take_the_default():
    assert from_json(Decision, '{"note": "n", "colour_of_the_future": 3}') == Decision(note="n")


@pytest.mark.parametrize("text", ['{"verdict": "perhaps"}', '{"note": 3}', '{"verdict": true}', "[]", "null", "nope"])
def test_what_does_not_fit_is_a_value_error(text):
    with pytest.raises(ValueError):  # noqa: PT011  # each has its own words
        from_json(Decision, text)


def test_an_unknown_number_survives():
    plain = json.loads(to_json(from_json(TiePoint, '{"name": "a", "time_s": NaN}')))
    assert plain["time_s"] != plain["time_s"]


def test_half_a_letter_from_an_undecodable_file_name_survives():
    decision = Decision(note="ölçüm-\udce7.wav")
    text = to_json(decision)
    assert text.encode("utf-8")
    assert from_json(Decision, text) == decision


def test_arrays_are_set_aside_by_name_and_found_again():
    row = np.arange(3.0)
    track = Track(
        row, row, np.ones((3, 3)), row, row, row, np.ones((3, 4)), row, "rolling", findings=(Finding("a", "info"),)
    )
    arrays = {}
    plain = json.loads(json.dumps(to_plain(track, arrays)))
    back = from_plain(Track, plain, arrays)
    assert np.array_equal(back.position_w_m, np.ones((3, 3)))
    assert back.findings == track.findings
    with pytest.raises(ValueError, match="missing"):
        from_plain(Track, plain, {})
    with pytest.raises(ValueError, match="int64"):
        from_plain(Track, plain, {name: array.astype(np.int64) for name, array in arrays.items()})


def test_what_could_not_be_read_back_is_refused_at_once():
    @dataclass(frozen=True)
    class Holder:
        thing: object

    for thing in (b"bytes", 1j, {1, 2}, np.zeros(2)):
        with pytest.raises(TypeError):
            to_plain(Holder(thing))


def test_numbers_of_numpy_and_paths_become_plain():
    assert to_plain((np.float64(1.5), np.int32(2), np.True_, Path("a") / "b")) == [1.5, 2, True, str(Path("a") / "b")]


def test_an_optional_array_may_be_absent():
    assert from_plain(FloatArray | None, None) is None
