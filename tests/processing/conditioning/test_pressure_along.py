"""The pressure as second witness: a dip or step is seen where it is, p is honest elsewhere, heights are no witness."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from processing import messages
from processing.conditioning.pressure_along import PressureJudge, pressure_along, with_pressure
from processing.conditioning.transients import pressure_rows
from processing.survey import Candidate, ImuSamples, LeakClass, Track

SPEED, SECONDS, RATE = 0.8, 900.0, 20.0


def run(course=lambda s: 0.0 * s, seed=0, hilly=True, surge=0.4, noise=0.05):
    """A pipe of 720 m over hills; its pressure is that of the heights, surges, ``course(chainage)`` and noise."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(SECONDS * RATE)) / RATE
    way = SPEED * time_s
    up = 4.0 * np.sin(way / 40.0) if hilly else 0.0 * way
    knots = rng.standard_normal(int(SECONDS / 20) + 3)
    slow = surge * np.interp(time_s / 20, np.arange(len(knots)), knots)
    pressure = 420.0 - 9.81 * up + slow + course(way) + noise * rng.standard_normal(len(way))
    three, flat = np.zeros((len(way), 3)), np.zeros(len(way))
    imu = ImuSamples(time_s, three, three, np.ones(len(way), bool), pressure_kpa=pressure)
    track = Track(
        time_s, way, np.column_stack([way, flat, up]), flat + 0.1, flat, flat,
        np.tile([1.0, 0, 0, 0], (len(way), 1)), flat + SPEED, "truth",
    )  # fmt: skip
    return imu, track


def along_of(imu, track):
    return pressure_along(pressure_rows(imu), track)


def candidate(place, number=1):
    return Candidate(
        number, place / SPEED, place, place - 1, place + 1, (place, 0.0, 0.0), 0.9, 6.0, LeakClass.LEAK,
        (500.0, 2000.0), 1.5,
    )  # fmt: skip


def test_heights_are_taken_off_to_a_tenth_of_a_metre_of_water():
    along = along_of(*run(surge=0.0))
    assert np.nanstd(along.rest_kpa) < 0.1
    assert along.known.all()


def test_a_dip_is_seen_with_its_size_and_is_rare():
    imu, track = run(lambda s: -2.0 / (1 + ((s - 300.0) / 1.5) ** 2))
    witness = PressureJudge(along_of(imu, track), [300.0]).at(300.0, 1.5)
    assert witness.dip_kpa == pytest.approx(-2.0, abs=0.5)
    assert witness.dip_p < 0.02


def test_a_rise_is_no_dip():
    imu, track = run(lambda s: 2.0 / (1 + ((s - 300.0) / 1.5) ** 2))
    assert PressureJudge(along_of(imu, track), [300.0]).at(300.0, 1.5).dip_p > 0.9


def test_a_step_is_seen_with_its_sign():
    imu, track = run(lambda s: np.where(s > 400.0, 3.0, 0.0))
    witness = PressureJudge(along_of(imu, track), [400.0]).at(400.0, 1.5)
    assert witness.step_kpa == pytest.approx(3.0, abs=0.8)
    assert witness.step_p < 0.05


def test_where_there_is_no_leak_p_is_uniform():
    """So that one place in twenty has p below 0.05, surges of twelve metres' length and all."""
    dips, steps = [], []
    for seed in range(25):
        imu, track = run(seed=seed)
        for place in (150.0, 350.0, 550.0):
            witness = PressureJudge(along_of(imu, track), [place]).at(place, 1.5)
            dips.append(witness.dip_p)
            steps.append(witness.step_p)
    for p in (dips, steps):
        assert stats.kstest(p, "uniform").pvalue > 0.01
        assert np.mean(np.array(p) < 0.05) < 0.12


def test_the_effect_of_a_usual_leak_is_below_what_the_sensor_sees():
    """ρ v q/A of 10 L/min out of a 100 mm main at 0.8 m/s is 17 Pa: honest words, not a figure, must come of it."""
    area = np.pi * 0.05**2
    rise_kpa = 1.0 * 0.8 * (10.0 / 60_000.0) / area
    assert rise_kpa == pytest.approx(0.017, abs=0.001)
    seen = []
    for seed in range(20):
        imu, track = run(lambda s: np.where(s > 300.0, rise_kpa, 0.0), seed=seed)
        seen.append(PressureJudge(along_of(imu, track), [300.0]).at(300.0, 1.5).step_p)
    assert np.median(seen) > 0.1


def test_candidates_get_their_evidence_and_a_transient_near_them_is_told():
    pump_s = 500.0
    imu, track = run(lambda s: np.where(s > SPEED * pump_s, 8.0, 0.0) - 3.0 / (1 + ((s - 200.0) / 1.5) ** 2))
    near, far = candidate(200.0), candidate(SPEED * (pump_s + 2.0), 2)
    (first, second), findings = with_pressure((near, far), imu, track)
    assert first.evidence["pressure_dip_p"] < 0.02
    assert "pressure_transient_s" not in first.evidence
    assert second.evidence["pressure_transient_s"] == pytest.approx(2.0, abs=0.2)
    assert [finding.code for finding in findings] == ["pressure_transients"]
    assert findings[0].params["largest_s"] == pytest.approx(pump_s, abs=0.2)
    for language in messages.LANGUAGES:
        assert messages.finding_sentence(findings[0], language)
        for key in ("pressure_dip", "pressure_step", "pressure_transient_s"):
            assert messages.text("evidence", key, language, value=1.0, p=0.03)


def test_without_pressure_or_with_a_dead_one_nothing_is_said():
    imu, track = run()
    both = (candidate(200.0),)
    for pressure in (None, np.full(len(imu.time_s), 420.0)):
        assert with_pressure(both, replace(imu, pressure_kpa=pressure), track) == (both, ())
    assert with_pressure(both, None, track) == (both, ())


def test_off_the_measured_pipe_there_is_no_witness():
    judge = PressureJudge(along_of(*run()), [])
    assert judge.at(-5.0, 1.0) is None
    assert judge.at(1e4, 1.0) is None
    imu, track = run()
    short = PressureJudge(along_of(imu, track), [float(place) for place in range(0, 720, 15)])
    assert short.at(360.0, 1.0) is None  # every place is near a candidate: nothing to compare with
