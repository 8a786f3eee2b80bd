"""Scenarios: the published numbers, the table of names, files and what is wrong with them."""

import copy
import dataclasses
import json

import numpy as np
import pytest
import tomli_w
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.messages import error_sentence
from processing.simulation.papers import P1_LOOPS
from processing.simulation.route import centre_line
from processing.simulation.run import simulate
from processing.simulation.scenario import Scenario
from processing.simulation.scenario_file import from_mapping, read_scenario, to_mapping
from processing.simulation.scenarios import SCENARIOS, load_scenario
from processing.simulation.sound import sound_blocks
from processing.simulation.surveys import random_scenario
from processing.survey import LeakClass, Motion


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_named_scenario_loads_survives_a_file_and_has_a_route(name, tmp_path):
    scenario = load_scenario(name)
    assert scenario.name == name
    assert "(simulated)" in scenario.paperwork.title
    path = tmp_path / "scenario.toml"
    path.write_text(tomli_w.dumps(to_mapping(scenario)), encoding="utf-8")
    assert load_scenario(path) == scenario
    length = centre_line(scenario.route).length_m
    assert all(0 < x.chainage_m < length for x in scenario.sound.local)


@pytest.mark.parametrize(
    ("name", "length", "leak"), [("p0-straight", 23.45, 13.4), ("p0-closed", 45.77, 25.23), ("p0-50m", 50.0, 35.165)]
)
def test_p0s_scenarios_have_the_published_lengths_and_leaks(name, length, leak):
    scenario = load_scenario(name)
    route = centre_line(scenario.route)
    assert scenario.motion is Motion.CARRIED
    assert route.length_m == pytest.approx(length, abs=1e-6)
    assert [x.chainage_m for x in scenario.sound.local if x.kind is LeakClass.LEAK] == [leak]
    if name == "p0-straight":
        np.testing.assert_allclose(route.points(np.array([5.0])).tangent_w[0], [0.5**0.5, 0.5**0.5, 0], atol=1e-12)
    ends = route.points(np.array([0.0, route.length_m])).position_w_m
    assert (np.linalg.norm(ends[1] - ends[0]) < 1e-6) == (name == "p0-closed")


def test_p1s_loops_close_and_have_the_published_mean_length():
    lengths = []
    for number in P1_LOOPS:
        route = centre_line(load_scenario(f"p1-{number:02d}").route)
        ends = route.points(np.array([0.0, route.length_m]))
        np.testing.assert_allclose(ends.position_w_m[1], ends.position_w_m[0], atol=1e-6)
        np.testing.assert_allclose(ends.tangent_w[1], ends.tangent_w[0], atol=1e-9)  # they end as they began
        lengths.append(route.length_m)
    assert np.mean(lengths) == pytest.approx(48.2, abs=0.05)


def test_random_scenarios_are_valid_different_and_repeatable():
    made = [random_scenario(seed) for seed in range(25)]
    for seed, scenario in enumerate(made):
        assert scenario == load_scenario(f"random-{seed}")
        assert from_mapping(json.loads(json.dumps(to_mapping(scenario)))) == scenario
        length = centre_line(scenario.route).length_m
        assert all(-1 < x.chainage_m < length + 5 for x in scenario.sound.local)
    assert len({s.drive.speed_mps for s in made}) == 25
    assert any(s.sound.local for s in made)


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(LeaklineError) as caught:
        load_scenario("p9-flying")
    assert caught.value.code is ErrorCode.SCENARIO_UNKNOWN
    assert "p0-closed" in error_sentence(caught.value)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("[drive]\nspeed = 3", "unknown key 'drive.speed'"),
        ('[drive]\nspeed_mps = "fast"', "'drive.speed_mps' must be a number"),
        ("[drive]\nspeed_mps = 1e9", "outside"),
        ("[drive]\nspeed_mps = nan", "not a usable number"),
        ("drive = 3", "[drive] must be a table"),
        ("[route]\npoints_m = [[0, 0]]", "must hold 3 values"),
        ('[[sound.local]]\nkind = "dragon"\nchainage_m = 3', "'sound.local[0].kind' must be one of"),
        ("[[sound.local]]\nchainage_m = 3", "'sound.local[0].kind' is missing"),
        ('[sound]\nfile = "../../elsewhere.wav"', "plain name"),
        ("[imu]\nrate_hz = true", "must be a number"),
        ("name = 1 2", "line 1"),
    ],
)
def test_a_wrong_scenario_file_is_answered_by_what_and_where(text, says, tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(LeaklineError) as caught:
        read_scenario(path)
    assert caught.value.code is ErrorCode.TOML_INVALID
    assert says in error_sentence(caught.value)


def test_a_missing_file_and_a_file_without_a_name(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        read_scenario(tmp_path / "absent.toml")
    assert caught.value.code is ErrorCode.FILE_MISSING
    (tmp_path / "bare.json").write_text("{}")
    assert read_scenario(tmp_path / "bare.json") == Scenario("bare")


keys = st.sampled_from([*Scenario.__dataclass_fields__, "speed_mps", "points_m", "local", "kind", "rate_hz"])
junk = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=4),
    max_leaves=12,
)


@settings(max_examples=150, deadline=None)
@given(data=junk)
def test_any_values_give_a_scenario_or_a_sentence(data):
    try:
        made = from_mapping(data)
    except (TypeError, ValueError) as error:
        sentence = str(error)
    else:
        sentence = made.name
        assert isinstance(made, Scenario)
    assert isinstance(sentence, str)


TINY = {
    "name": "tiny",
    "route": {"points_m": [[0, 0, 0], [2, 0, 0], [3, 1.5, 0.1]], "bend_radius_m": 0.3},
    "drive": {"ramp_s": 0.5, "rest_start_s": 1.0, "rest_end_s": 1.0, "stops": [{"chainage_m": 1.0, "duration_s": 0.5}]},
    "imu": {"rate_hz": 20.0, "magnetics": {"enabled": True}},
    "sound": {"rate_hz": 4000, "local": [{"kind": "leak", "chainage_m": 1.5, "flutter": 0.5}], "pumps": [{}]},
    "markers": [{"name": "end", "by": "both"}],
    "foot": {"gaits": [{}]},
}


def every_number(scenario):
    """Paths of keys to all numbers of a scenario's full mapping."""
    found = []

    def walk(thing, path):
        if dataclasses.is_dataclass(thing):
            for f in dataclasses.fields(thing):
                walk(getattr(thing, f.name), (*path, f.name))
        elif isinstance(thing, tuple) and thing and dataclasses.is_dataclass(thing[0]):
            walk(thing[0], (*path, 0))
        elif type(thing) in (int, float):
            found.append(path)

    walk(scenario, ())
    return found


NUMBERS = every_number(from_mapping(TINY))


@settings(max_examples=150, deadline=None)
@given(
    path=st.sampled_from(NUMBERS),
    value=st.sampled_from([-1, 0, 1, 2, 7]) | st.floats(-1e3, 1e3) | st.floats(0, 1e-3) | st.floats(allow_nan=False),
    motion=st.sampled_from(["rolling", "carried", "foot"]),
)
def test_whatever_passes_the_check_can_be_simulated(path, value, motion):
    data = copy.deepcopy(TINY) | {"motion": motion}
    table = data
    for key in path[:-1]:
        table = table[key] if isinstance(key, int) else table.setdefault(key, {})
    table[path[-1]] = value
    try:
        scenario = from_mapping(data)
    except (TypeError, ValueError):
        return
    if scenario.drive.speed_mps < 0.1 or scenario.drive.rest_start_s + scenario.drive.rest_end_s > 60:
        return  # valid, but longer than a test may take
    run = simulate(scenario, 1)
    assert np.all(np.isfinite(run.imu.acc_s_mps2))
    assert np.all(np.isfinite(next(iter(sound_blocks(run.sound)))))
