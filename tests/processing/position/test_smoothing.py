"""The smoother: the same as its closed-form peer, deaf to wrong knowledge, and led by what the recording says."""

import dataclasses

import closed_form
import numpy as np
import pytest
from odometry_runs import odometry, realistic

from processing.position.chain import smooth
from processing.position.evidence import ChainageFix, ChainageIncrement, Evidence, HeightSeries, Revisit, SlipSpan
from processing.position.factors import collect, readings_of
from processing.position.fitting import fit, prepare, refit
from processing.position.keyframes import keyframes_at, moments_of
from processing.position.motion_model import (
    EAST,
    LEVEL_SIZE,
    NORTH,
    TURN,
    WAY,
    Levels,
    Prior,
    level_model,
    next_nominal,
    start_nominal,
)
from processing.position.noise_levels import mixed_sigma, weigh
from processing.position.odometry import thinned
from processing.position.ties import Observation
from processing.progress import silent
from processing.settings import PositionSettings
from processing.survey import DeviceInfo, Launch, PipeInfo, Survey, TiePoint

SETTINGS = dataclasses.replace(PositionSettings(), keyframes=150.0)
SURVEY = Survey(launch=Launch(heading_deg=90.0), device=DeviceInfo(radius_m=0.05))


def straight(length_m=1000.0, turn=0.0):
    time_s = np.arange(0.0, length_m + 0.1, 0.2)
    return odometry(time_s, np.ones(len(time_s)), np.full(len(time_s), turn))


def fitted(reckoned, evidence=Evidence(), survey=SURVEY, options=SETTINGS):  # noqa: B008  # frozen
    return fit(prepare(reckoned, survey, evidence, options), survey, options, silent())


def at(track, time_s):
    return float(np.interp(time_s, track.time_s, track.chainage_m))


def tied(truth, times, sigma_m=0.5, rng=None, kind="chainage"):
    out = []
    for k, t in enumerate(times):
        where = [float(np.interp(t, truth.time_s, c)) for c in (truth.chainage_m, *truth.position_w_m[:, :2].T)]
        if rng is not None:
            where = [w + sigma_m * rng.standard_normal() for w in where]
        told = {"chainage_m": where[0]} if kind == "chainage" else {"east_m": where[1], "north_m": where[2]}
        out.append(TiePoint(f"valve {k}", float(t), sigma_m=sigma_m, **told))
    return tuple(out)


# --- against the peer ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("is_place", [False, True])
@pytest.mark.parametrize("seed", [0, 1, 5])
def test_for_random_walks_the_smoother_equals_the_closed_form_of_all_ties_at_once(seed, is_place):
    truth, free = realistic(np.random.default_rng(seed), 120.0)
    # every row a keyframe, no slip but walks, no change of drift: what the peer knows
    free = dataclasses.replace(thinned(free, np.arange(0, len(free.time_s), 4)), slip_sigma=0.0, along_var_m2=0.0)
    way = free.chainage_m
    step = np.hypot(*np.diff(free.position_w_m[:, :2], axis=0).T)
    way = np.concatenate([[0.0], np.cumsum(step)])  # as long as its chords: the peer has no other
    free = dataclasses.replace(free, chainage_m=way, along_var_m2=0.01 * way)
    count = len(free.time_s)
    ties = []
    for row in (count // 4, count // 2, count - 1):
        t = float(free.time_s[row])
        value = [np.interp(t, truth.time_s, c) for c in (truth.chainage_m, *truth.position_w_m[:, :2].T)]
        told, cov = (np.array(value[1:]), 0.25 * np.eye(2)) if is_place else (np.array(value[:1]), np.array([[0.25]]))
        ties.append(Observation(str(row), t, row, is_place, told, cov))
    peer = closed_form.solve(free, tuple(ties), closed_form.Sigmas(0.02, 0.05, 0.001, 0.01, 0.0))
    spread = closed_form.variances(peer)
    frames = keyframes_at(free, moments_of(free), np.arange(count))
    prior = Prior(0.02, 0.05, 0.001, 0.01, 0.0, 0.0, 1e12)
    items = collect(frames, ties, Evidence(), False).items
    flat = np.ones(count - 1)
    nominal = start_nominal(frames, flat)
    for _ in range(12 if is_place else 1):
        model = level_model(frames, nominal, flat, prior, LEVEL_SIZE)
        found = smooth(model.at(Levels()), readings_of(items, LEVEL_SIZE).readings)
        nominal = next_nominal(frames, nominal, flat, model, found.mean)
    chainage = (1.0 + peer.deviation.scale) * way + peer.deviation.along_m
    near = 2e-3 if is_place else 1e-9  # the peer stops when its path moves by a millimetre
    assert np.allclose(found.mean[:, WAY], chainage, atol=near)
    assert np.allclose(found.mean[:, TURN], peer.deviation.heading_rad, atol=1e-4 if is_place else 1e-12)
    assert np.allclose(found.cov[:, WAY, WAY], spread.along_m2, atol=max(near, 2e-6))  # the peer has a floor
    assert np.allclose(found.cov[:, EAST, EAST] + 1e-6, spread.level_m2[:, 0], rtol=1e-3, atol=near)
    assert np.allclose(found.cov[:, EAST, NORTH], spread.level_m2[:, 1], rtol=1e-2, atol=5.0 * near)
    if is_place:
        assert np.allclose(nominal.place_m, peer.path.level_m, atol=near)


def test_slip_that_wanders_grows_as_the_integral_of_a_gauss_markov_process():
    # keyframes of any spacing give the same variance: 2 σ² v² τ (t − τ (1 − e^(−t/τ)))
    free = dataclasses.replace(straight(300.0), scale_sigma=1e-9, start_sigma_m=0.0, along_var_m2=np.zeros(1501))
    prior = Prior(1e-9, 0.05, 0.0, 0.0, 0.0, 0.0, 1e9)
    for spacing in (1, 10, 150):
        rows = np.arange(0, 1501, spacing)
        frames = keyframes_at(free, moments_of(free), rows)
        flat = np.ones(len(rows) - 1)
        model = level_model(frames, start_nominal(frames, flat), flat, prior, LEVEL_SIZE)
        found = smooth(model.at(Levels()), readings_of((), LEVEL_SIZE).readings)
        t, tau = free.time_s[rows], free.slip_tau_s
        expected = 2.0 * free.slip_sigma**2 * tau * (t - tau * -np.expm1(-t / tau))
        assert np.allclose(found.cov[:, WAY, WAY], expected, rtol=1e-6, atol=1e-12)


# --- wrong knowledge -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["chainage", "place"])
def test_one_of_four_ties_wrong_by_twenty_metres_is_found_and_does_not_bend_the_rest(kind):
    rng = np.random.default_rng(21)
    # what a gyro that drifts by 100 °/h can hide within 250 m is near 20 m: places need a better one
    options = dataclasses.replace(SETTINGS, rolling_drift_dph=30.0, heading_walk=0.02)
    found, right = 0, 0
    for _ in range(20):
        truth, free = realistic(rng, 1000.0, drift_dph=20.0, settings=options)
        ties = tied(truth, np.quantile(truth.time_s, [0.25, 0.5, 0.75, 0.99]), rng=rng, kind=kind)
        wrong = int(rng.integers(4))
        angle = rng.uniform(0.0, 2.0 * np.pi)
        tie = ties[wrong]
        if kind == "chainage":
            tie = dataclasses.replace(tie, chainage_m=tie.chainage_m + 20.0 * np.sign(np.cos(angle)))
        else:
            tie = dataclasses.replace(
                tie, east_m=tie.east_m + 20.0 * np.cos(angle), north_m=tie.north_m + 20.0 * np.sin(angle)
            )
        told = (*ties[:wrong], tie, *ties[wrong + 1 :])
        result = fitted(free, survey=dataclasses.replace(SURVEY, tie_points=told), options=options)
        rest = dataclasses.replace(SURVEY, tie_points=(*ties[:wrong], *ties[wrong + 1 :]))
        without = fitted(free, survey=rest, options=options)
        held = [c.name for c in result.checks if c.held_down]
        found += held == [tie.name]
        apart = np.abs(result.track.chainage_m - without.track.chainage_m)
        right += bool(np.all(apart <= 1.5 * without.track.sigma_along_m + 1.0))
    assert found >= 19
    assert right >= 19


def test_wrong_fixes_and_increments_lose_their_weight():
    free = straight(600.0)
    fixes = tuple(ChainageFix(t, t + (15.0 if t == 300.0 else 0.0), 0.3, "bend") for t in (100.0, 200.0, 300.0, 400.0))
    increments = tuple(
        ChainageIncrement(t, t + 6.0, 6.0 if t != 450.0 else 12.0, 0.05, "joint") for t in np.arange(420.0, 540.0, 6.0)
    )
    result = fitted(free, Evidence(fixes=fixes, increments=increments))
    assert abs(at(result.track, 300.0) - 300.0) < 1.0
    assert abs(at(result.track, 540.0) - at(result.track, 420.0) - 120.0) < 0.5
    held = [(i.kind, i.time_s) for i in result.series.innovations if i.held_down]
    assert ("fix", 300.0) in held
    assert ("increment", 456.0) in held
    assert len(held) == 2


# --- what the recording says ---------------------------------------------------------------------------------------


def test_a_fix_pulls_the_chainage_by_its_sigma():
    result = fitted(straight(500.0), Evidence(fixes=(ChainageFix(400.0, 404.0, 0.2, "bend"),)))
    assert at(result.track, 400.0) == pytest.approx(404.0, abs=0.1)
    assert np.interp(400.0, result.track.time_s, result.track.sigma_along_m) == pytest.approx(0.2, rel=0.05)


def test_an_offset_that_all_fixes_share_is_told_by_a_tie():
    # the map is shifted by 3 m as a whole: one tie says so for all bends
    fixes = tuple(ChainageFix(t, t + 3.0, 0.1, "bend", shared_sigma_m=5.0) for t in (100.0, 200.0, 300.0, 400.0))
    tie = TiePoint("valve", 200.0, chainage_m=200.0, sigma_m=0.1)
    options = dataclasses.replace(SETTINGS, tie_time_sigma_s=0.0, tie_clock_sigma_s=0.0)
    survey = dataclasses.replace(SURVEY, tie_points=(tie,))
    track = fitted(straight(500.0), Evidence(fixes=fixes), survey, options).track
    assert at(track, 400.0) == pytest.approx(400.0, abs=0.5)
    assert np.interp(400.0, track.time_s, track.sigma_along_m) < 0.6


def test_joints_are_an_odometer():
    # the ball's radius is told 1 % wrong; pipes of 6 m ± 2 cm say so
    truth = straight(600.0)
    free = dataclasses.replace(truth, chainage_m=1.01 * truth.chainage_m, position_w_m=1.01 * truth.position_w_m)
    joints = tuple(ChainageIncrement(t, t + 6.0, 6.0, 0.02, "joint") for t in np.arange(6.0, 594.0, 6.0))
    alone, led = fitted(free).track, fitted(free, Evidence(increments=joints)).track
    assert abs(at(alone, 594.0) - 600.0) < 0.2  # 1.01 × 594
    assert abs(at(led, 594.0) - 594.0) < 0.4
    assert led.sigma_along_m[-1] < 0.1 * alone.sigma_along_m[-1]


def test_joints_whose_spacing_is_not_known_cannot_tell_the_radius_but_the_slip():
    joints = tuple(
        ChainageIncrement(t, t + 6.0, 6.2, 0.02, "joint", scale_sigma=0.2) for t in np.arange(6.0, 594.0, 6.0)
    )
    track = fitted(straight(600.0), Evidence(increments=joints)).track
    assert abs(at(track, 594.0) - 594.0) < 1.5
    assert track.sigma_along_m[-1] > 0.015 * 600.0


def test_overlapping_increments_are_all_heard():
    increments = tuple(ChainageIncrement(t, t + 150.0, 151.5, 0.1, "cable") for t in (0.0, 50.0, 100.0, 150.0, 200.0))
    track = fitted(straight(500.0), Evidence(increments=increments)).track
    assert at(track, 350.0) == pytest.approx(350.0 * 1.01, abs=0.6)


def test_pressure_gives_the_path_its_height_and_an_outburst_does_not():
    free = straight(1000.0)
    seconds = np.arange(0.0, 1000.0, 1.0)
    rng = np.random.default_rng(0)
    up = -8.0 * np.sin(seconds / 160.0) + 0.05 * rng.standard_normal(len(seconds))
    up[500:504] += 30.0
    series = HeightSeries(seconds, up, 0.05, wander_sigma_m=0.05, offset_sigma_m=0.5)
    track = fitted(free, Evidence(heights=(series,))).track
    missed = track.position_w_m[:, 2] + 8.0 * np.sin(track.time_s / 160.0)
    assert np.abs(missed[200:-200]).max() < 0.8
    assert np.median(track.sigma_up_m) < 0.4
    assert np.mean(np.abs(missed) < 1.96 * track.sigma_up_m) > 0.9


def test_the_same_place_twice_closes_the_path():
    rng = np.random.default_rng(4)
    free_miss, closed_miss = [], []
    for _ in range(4):
        truth, free = realistic(rng, 400.0, bends=4, loop=True)
        again = Revisit(0.0, float(truth.time_s[-1]), 0.05, "declared")
        open_, closed = fitted(free).track, fitted(free, Evidence(revisits=(again,))).track
        free_miss.append(np.hypot(*open_.position_w_m[-1, :2]))
        closed_miss.append(np.hypot(*closed.position_w_m[-1, :2]))
    assert max(closed_miss) < 0.2 < np.mean(free_miss)


def test_a_slip_widens_the_interval_and_is_not_assessed():
    slip = SlipSpan(200.0, 230.0, "imu_gap", sigma_share=0.5, heading_sigma_rad=0.1)
    usual, slipped = fitted(straight(500.0)).track, fitted(straight(500.0), Evidence(slips=(slip,))).track
    before, after = (np.interp(t, usual.time_s, slipped.sigma_along_m - usual.sigma_along_m) for t in (190.0, 400.0))
    assert abs(before) < 0.01
    grown = np.interp(400.0, usual.time_s, slipped.sigma_along_m**2 - usual.sigma_along_m**2)
    assert grown == pytest.approx(15.0**2, rel=0.05)
    assert after > 1.0
    assert slipped.sigma_cross_m[-1] > usual.sigma_cross_m[-1]
    assert [(s.start_s, s.end_s, s.reason) for s in slipped.not_assessed] == [(200.0, 230.0, "imu_gap")]


# --- the live refit ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["chainage", "place"])
def test_the_preview_lies_on_the_track(kind):
    rng = np.random.default_rng(3)
    truth, free = realistic(rng, 900.0)
    survey = dataclasses.replace(
        SURVEY,
        tie_points=tied(truth, np.quantile(truth.time_s, [0.3, 0.6, 0.99]), rng=rng, kind=kind),
        pipe=PipeInfo(length_m=float(truth.chainage_m[-1])),
    )
    problem = prepare(free, survey, Evidence(), SETTINGS)
    preview, whole = refit(problem, survey, SETTINGS), fit(problem, survey, SETTINGS, silent())
    rows = np.searchsorted(whole.track.time_s, preview.time_s)
    assert np.array_equal(whole.track.time_s[rows], preview.time_s)
    assert np.allclose(whole.track.chainage_m[rows], preview.chainage_m, atol=0.02)
    assert np.allclose(whole.track.position_w_m[rows], preview.position_w_m, atol=0.05)
    assert np.allclose(whole.track.sigma_along_m[rows], preview.sigma_along_m, atol=0.02)
    assert whole.checks == preview.checks


def test_keyframes_lose_nothing_but_detail():
    rng = np.random.default_rng(8)
    truth, free = realistic(rng, 600.0)
    ties = tied(truth, np.quantile(truth.time_s, [0.3, 0.6, 0.99]), rng=rng, kind="place")
    survey = dataclasses.replace(SURVEY, tie_points=ties)
    few, many = (
        fitted(free, survey=survey, options=dataclasses.replace(SETTINGS, keyframes=k)).track for k in (100.0, 3000.0)
    )
    assert np.abs(few.chainage_m - many.chainage_m).max() < 0.05
    assert np.hypot(*(few.position_w_m - many.position_w_m)[:, :2].T).max() < 0.1
    assert np.allclose(few.sigma_along_m, many.sigma_along_m, atol=0.03)


# --- the level of noise --------------------------------------------------------------------------------------------


def test_many_ties_tell_how_slippery_the_run_was():
    rng = np.random.default_rng(5)
    told = []
    for walk in (0.02, 0.04, 0.2):
        time_s = np.arange(0.0, 2000.0, 0.2)
        free = odometry(time_s, np.ones(len(time_s)), np.zeros(len(time_s)))
        truth = free.chainage_m + np.concatenate([[0.0], np.cumsum(walk * np.sqrt(0.2) * rng.standard_normal(9999))])
        ties = tuple(
            TiePoint(f"t{k}", float(t), chainage_m=float(np.interp(t, time_s, truth)), sigma_m=0.02)
            for k, t in enumerate(np.linspace(20, 1990, 60))
        )
        options = dataclasses.replace(SETTINGS, tie_time_sigma_s=0.0, tie_clock_sigma_s=0.0)
        survey = dataclasses.replace(SURVEY, tie_points=ties)
        told.append(fitted(free, survey=survey, options=options).series.slip_level)
    apart = 1970.0 / 59.0  # what the model lets slip take between two ties, per √m at 1 m/s
    own = np.sqrt(2.0 * 0.01**2 * 15.0 * (apart - 15.0 * -np.expm1(-apart / 15.0)) / apart)
    assert told[0] < 0.7
    assert told[1] == pytest.approx(0.04 / own, rel=0.15)
    assert told[2] > 2.5


def test_a_mixture_of_normal_errors_has_the_reach_that_sampling_finds():
    rng = np.random.default_rng(0)
    weights, off, sigma = np.array([0.3, 0.5, 0.2]), np.array([[0.2], [0.0], [-0.3]]), np.array([[0.5], [1.0], [3.0]])
    which = rng.choice(3, 400_000, p=weights)
    drawn = off[which, 0] + sigma[which, 0] * rng.standard_normal(len(which))
    expected = np.quantile(np.abs(drawn), 0.95) / 1.959964
    assert mixed_sigma(weights, off, sigma**2)[0] == pytest.approx(expected, rel=0.01)


def test_without_any_likelihood_the_levels_are_the_priors():
    weighed = weigh(lambda levels: 0.0)
    assert sum(w.weight for w in weighed) == pytest.approx(1.0)
    slips = [w.levels.slip for w in weighed]
    assert slips == sorted(slips)
    # the mean of a log-normal variance factor: median² e^(2 spread²), cut at the table's ends
    mean = sum(w.weight * w.levels.slip for w in weighed)
    assert mean == pytest.approx(0.78**2 * np.exp(2.0 * 0.555**2), rel=0.2)
