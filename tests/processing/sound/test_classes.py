"""Classes of candidates: Bayes' rule against itself, figures against what was simulated, names against the truth."""

import json
from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sound_runs import Leak, drift

from processing import messages
from processing.settings import DetectorSettings
from processing.sound.candidates import find_candidates
from processing.sound.cells import frames_of
from processing.sound.classes import CLASSES, ClassModel, checked, judge, load_model
from processing.sound.feature_background import evidence_of
from processing.sound.ground import ground_of
from processing.sound.place_features import FEATURES, features_at, loudness_at
from processing.survey import ImuSamples, LeakClass, ProcessingChoice, Survey, TiePoint

BAND = (700.0, 2800.0)
WIDE = np.log2


def stored():
    return json.loads((files("resources") / "leak_classes" / "model.json").read_text(encoding="utf-8"))


def two_class(p_leak, p_valve):
    """A model of one figure with two bins that only leaks and valves differ in."""
    p = {c.value: [0.5, 0.5] for c in CLASSES} | {"leak": [1 - p_leak, p_leak], "valve": [1 - p_valve, p_valve]}
    feature = {"edges": [0.0], "p": p, "weight": 1.0, "basis": "stated"}
    return checked({"features": {"turn_deg": feature}, "prior": {"valve": 1.0}, "record": {}})


def grounded(run, imu=None, survey=None):
    frames = frames_of(run.scan, run.clock, run.track, (), DetectorSettings())
    return ground_of(run.scan, frames, run.track, imu, survey or Survey(), in_metres=True)


@settings(max_examples=40, deadline=None)
@given(p=st.floats(0.01, 0.94), a=st.floats(0.01, 0.99), b=st.floats(0.01, 0.99))
def test_a_judgement_is_bayes_rule(p, a, b):
    found = judge(p, {"turn_deg": 1.0}, two_class(a, b))
    assert found.score == pytest.approx(p * a / (p * a + (1 - p) * b), rel=1e-9)
    assert found.for_leak["turn_deg"] == pytest.approx(np.log(a / b), rel=1e-9, abs=1e-12)


@settings(max_examples=40, deadline=None)
@given(p=st.floats(0, 1), figures=st.dictionaries(st.sampled_from(FEATURES), st.floats(-1e6, 1e6), max_size=6))
def test_probabilities_sum_to_one_whatever_the_figures(p, figures):
    found = judge(p, figures, load_model())
    assert sum(found.probability.values()) == pytest.approx(1.0)
    assert 0 <= found.score <= 1


@settings(max_examples=40, deadline=None)
@given(low=st.floats(0.0, 0.9), more=st.floats(0.0, 0.1))
def test_a_likelier_sound_of_a_leak_is_never_a_less_likely_leak(low, more):
    figures = {"flutter": 0.1, "rumble_db": -2.0}
    assert judge(low + more, figures, load_model()).score >= judge(low, figures, load_model()).score


def test_what_is_not_known_says_nothing():
    model = load_model()
    assert judge(0.6, {}, model).score == pytest.approx(0.6)
    assert judge(0.6, {name: float("nan") for name in FEATURES}, model).score == pytest.approx(0.6)


def test_a_named_valve_nearby_makes_a_valve_likelier():
    far, near = (judge(0.5, {"valve_m": m}, load_model()).probability[LeakClass.VALVE] for m in (80.0, 1.0))
    assert near > 5 * far


def test_a_sound_that_fades_while_the_device_stands_is_no_leak_whatever_else():
    sure = {"flutter": -0.5, "rumble_db": -8.0, "width_m": 2.0, "peak_hz": 1400.0}
    assert judge(0.98, sure, load_model()).leak_class is LeakClass.LEAK
    faded = judge(0.98, sure | {"faded_share": 0.9}, load_model())
    assert faded.leak_class is LeakClass.TRAFFIC
    assert faded.score < 0.1


@pytest.mark.parametrize(
    "spoil",
    [
        lambda m: m["prior"].update(leak=0.5),
        lambda m: m["prior"].update(valve=7.0),
        lambda m: m["features"]["flutter"].update(edges=[1.0, 0.1, 0.25, 0.4, 0.7, 0.0]),
        lambda m: m["features"]["flutter"].update(weight=3.0),
        lambda m: m["features"]["flutter"]["p"].update(air=[0.1]),
        lambda m: m["features"]["flutter"]["p"].update(air=[float("nan")] * 7),
    ],
)
def test_a_spoilt_model_is_refused(spoil):
    model = stored()
    spoil(model)
    with pytest.raises(ValueError, match=r"\w"):
        checked(model)


def test_the_shipped_model_says_what_it_was_trained_on_and_weighs_what_the_figures_mean():
    model = load_model()
    assert isinstance(model, ClassModel)
    assert set(model.names) <= {*FEATURES, "faded_share"}
    assert "simulated" in model.record["trained_on"]

    def shares(name, value):
        table = next(t for t in model.tables if t.name == name)
        return dict(zip(CLASSES, table.ln_p[:, np.searchsorted(table.edges, value)], strict=True))

    assert shares("flutter", 1.2)[LeakClass.AIR] > shares("flutter", 1.2)[LeakClass.LEAK]
    assert shares("turn_deg", 40.0)[LeakClass.BEND] > shares("turn_deg", 40.0)[LeakClass.LEAK]
    assert shares("rumble_db", 4.0)[LeakClass.VALVE] > shares("rumble_db", 4.0)[LeakClass.LEAK]
    assert shares("knock", 5.0)[LeakClass.BUMP] > shares("knock", 5.0)[LeakClass.LEAK]


def test_a_gurgle_is_told_from_a_steady_hiss_of_the_same_spectrum():
    rates = (2.3, 3.1, 4.2, 5.1, 6.0, 6.7)

    def bubbling(time, place, hz):
        wave = sum(np.sin(2 * np.pi * f * time + f**2) for f in rates) / 1.73
        loud = 15 * np.exp(0.9 * wave - 0.4) / (1 + ((place - 150) / 1.5) ** 2)
        return np.exp(-0.5 * (WIDE(hz / 1300) / 0.76) ** 2) * loud[:, None]

    run = drift((Leak(80, 1.5, 8.0),), seed=21, bumps=False, extra=bubbling)
    ground = grounded(run)
    air, leak = (features_at(ground, at, 1.5, BAND)["flutter"] for at in (150.0, 80.0))
    assert air > 0.4 > 0.2 > leak
    found = find_candidates(run.scan, run.clock, run.track, _metres(), DetectorSettings()).candidates
    by_place = {at: min(found, key=lambda c, at=at: abs(c.chainage_m - at)) for at in (80.0, 150.0)}
    assert by_place[80.0].leak_class is LeakClass.LEAK
    assert by_place[150.0].leak_class is LeakClass.AIR
    assert by_place[150.0].score < 0.5 < by_place[80.0].score
    assert by_place[150.0].evidence["heard_score"] > by_place[150.0].score


def _metres():
    return Survey(processing=ProcessingChoice(detector="metres"))


def test_a_rumble_and_a_hiss_are_told_apart_in_decibels():
    def rumbling(time, place, hz):
        return (hz < 250) * (10 / (1 + ((place - 150) / 1.5) ** 2))[:, None]

    ground = grounded(drift((Leak(80, 1.5, 8.0),), seed=22, extra=rumbling))
    assert features_at(ground, 150.0, 1.5, BAND)["rumble_db"] > 4.0
    assert features_at(ground, 80.0, 1.5, BAND)["rumble_db"] < -4.0


def test_a_blow_that_both_sensors_feel_is_a_knock_and_one_that_only_the_sound_has_is_not():
    def blow(time, place, hz):
        return (np.abs(place - 100) < 0.05)[:, None] * 40.0 * np.ones(len(hz))

    run = drift((), seed=23, bumps=False, extra=blow)
    time_s = np.arange(0, 400, 0.01)
    rng = np.random.default_rng(0)
    acc = np.column_stack(
        [0.02 * rng.standard_normal((len(time_s), 2)), 9.81 + 0.02 * rng.standard_normal(len(time_s))]
    )
    quiet = ImuSamples(time_s, acc.copy(), np.zeros_like(acc), np.ones(len(time_s), bool))
    at = int(np.searchsorted(time_s, np.interp(100.0, run.chainage_m, run.time_s)))
    acc[at : at + 2, 2] += 5.0
    knocked = replace(quiet, acc_s_mps2=acc)
    assert features_at(grounded(run, knocked), 100.0, 0.4, BAND)["knock"] > 3.0
    assert features_at(grounded(run, quiet), 100.0, 0.4, BAND)["knock"] < 3.0
    assert np.isnan(features_at(grounded(run), 100.0, 0.4, BAND)["knock"])


def test_valves_are_read_from_the_names_of_tie_points_in_both_languages():
    ties = (TiePoint("Vana 3", 50.0, 40.0), TiePoint("gate valve", 90.0, 90.0), TiePoint("Ahmet'in evi", 120.0, 100.0))
    ground = grounded(drift(seed=2, seconds=200.0), survey=Survey(tie_points=ties))
    assert sorted(ground.valve_m.tolist()) == [40.0, 90.0]
    assert features_at(ground, 42.0, 1.0, BAND)["valve_m"] == pytest.approx(2.0)


def test_a_sound_of_a_moment_fits_seconds_better_than_metres_where_the_device_stopped():
    def passing(time, place, hz):
        bell = np.exp(-0.5 * (WIDE(hz / 1300) / 0.7) ** 2)
        return bell * (25 * np.exp(-0.5 * ((time - 200) / 4) ** 2))[:, None]

    leak_at = 190 * 0.6
    moment = drift((), seed=11, stops=((190, 30),), extra=passing)
    at = float(np.interp(200, moment.time_s, moment.chainage_m))
    assert features_at(grounded(moment), at, 1.0, BAND)["place_not_moment"] < -0.05
    place = drift((Leak(leak_at, 1.0, 10.0),), seed=11, stops=((190, 30),))
    assert features_at(grounded(place), leak_at, 1.0, BAND)["place_not_moment"] > -0.05


def test_the_loudness_of_a_place_is_that_of_its_own_sound():
    ground = grounded(drift((Leak(80, 3.0, 10.0),), seed=31, bumps=False))
    over, background = loudness_at(ground, 80.0, 1.0, (950.0, 1750.0))
    assert over == pytest.approx(10.0, abs=2.5)
    assert -80 < background < -30
    assert loudness_at(ground, 20.0, 1.0, (1e5, 2e5)) is None


def test_evidence_shows_a_leak_beside_the_rest_of_the_pipe():
    run = drift((Leak(60, 1.5, 10.0), Leak(150, 2.5, 8.0)), seed=41)
    found = find_candidates(run.scan, run.clock, run.track, _metres(), DetectorSettings()).candidates
    leak = min(found, key=lambda c: abs(c.chainage_m - 60))
    evidence = evidence_of(leak, grounded(run), found, load_model())
    assert evidence.probability[LeakClass.LEAK] == pytest.approx(leak.score, abs=0.02)
    assert evidence.places >= 20
    inside = (evidence.band_hz > 900) & (evidence.band_hz < 1800)
    assert np.all(evidence.excess_db[inside] > evidence.usual_db[1][inside])
    outside = evidence.band_hz > 5000
    assert np.mean(evidence.excess_db[outside] <= evidence.usual_db[1][outside] + 1.0) > 0.7
    apex = evidence.away[np.argmax(evidence.rise_db)]
    assert abs(apex) <= 1.5
    assert evidence.fit_db.max() == pytest.approx(leak.level_db, abs=0.5)
    weights = [abs(f.for_leak) for f in evidence.features]
    assert weights == sorted(weights, reverse=True)
    for feature in evidence.features:
        for language in messages.LANGUAGES:
            for side in ("high", "low"):
                assert messages.text("why", f"{feature.name}_{side}", language, value=feature.value)
        if np.isfinite(feature.quantiles[0]):
            assert list(feature.quantiles) == sorted(feature.quantiles)
            assert 0 <= feature.below <= 1


def test_without_a_path_figures_are_of_seconds_and_the_map_says_nothing():
    run = drift((Leak(60, 1.5, 10.0),), seed=3)
    found = find_candidates(run.scan, run.clock, None, Survey(), DetectorSettings()).candidates
    assert found
    for name in ("turn_deg", "valve_m", "place_not_moment", "width_m"):
        assert name not in found[0].evidence
    assert "flutter" in found[0].evidence
