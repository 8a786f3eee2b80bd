"""The fit: exact on exact knowledge, honest about the rest, and deaf to the order in which it is told."""

import dataclasses

import numpy as np
import pytest
from closed_form import ErrorModel, Sigmas, Walks
from hypothesis import given, settings
from hypothesis import strategies as st
from odometry_runs import odometry, realistic

from processing.position.evidence import Evidence
from processing.position.fitting import fit, prepare
from processing.progress import silent
from processing.settings import PositionSettings
from processing.survey import DeviceInfo, Launch, PipeInfo, Route, Survey, TiePoint

SETTINGS = PositionSettings()
EXACT = dataclasses.replace(SETTINGS, tie_time_sigma_s=0.0)
SURVEY = Survey(launch=Launch(heading_deg=90.0), device=DeviceInfo(radius_m=0.05))


def track_of(reckoned, survey, options=SETTINGS):
    return fitted(reckoned, survey, options).track


def fitted(reckoned, survey, options=SETTINGS):
    return fit(prepare(reckoned, survey, Evidence(), options), survey, options, silent())


def codes(track):
    return [finding.code for finding in track.findings]


def with_ties(*ties, **more):
    return dataclasses.replace(SURVEY, tie_points=ties, **more)


def straight(length_m=1000.0, speed_mps=1.0):
    time_s = np.arange(0.0, length_m / speed_mps + 0.05, 0.05)
    return odometry(time_s, np.full(len(time_s), speed_mps), np.zeros(len(time_s)))


def slip_variance(length_m, speed_mps=1.0, options=SETTINGS):
    """Of the way that slip and walk may have taken: the integral of a Gauss–Markov process over t seconds."""
    t, tau = length_m / speed_mps, options.slip_tau_s
    wander = 2.0 * (options.slip_sigma_pct / 100.0 * speed_mps) ** 2 * tau * (t - tau * (1.0 - np.exp(-t / tau)))
    return wander + options.slip_walk**2 * length_m


def test_a_known_length_sets_the_scale():
    track = track_of(straight(1000.0), with_ties(pipe=PipeInfo(length_m=1020.0)))
    # slip and the length's own sigma take their share of the 20 m; slip by what the level of noise makes of it
    level = track.quality["interval_inflation"] ** 2
    share = 20.0**2 / (20.0**2 + level * slip_variance(1000.0) + 2.14**2 + 0.02**2)
    assert track.quality["scale"] == pytest.approx(1.0 + 0.02 * share, abs=2e-4)  # the levels are mixed
    assert track.chainage_m[-1] == pytest.approx(1020.0, abs=0.3)
    assert track.chainage_m[len(track.chainage_m) // 2] == pytest.approx(510.0, abs=0.2)


def test_the_interval_between_two_ties_is_the_bridge_of_the_books():
    # sigma(s)² = sigma_w² (s − a)(b − s)/(b − a) between exact ties (navigation §6.5), once the scale is no question
    options = dataclasses.replace(EXACT, scale_sigma_pct=50.0, tie_clock_sigma_s=0.0)
    walk = 0.05
    reckoned = dataclasses.replace(
        straight(1000.0),
        scale_sigma=1e-9,
        start_sigma_m=0.0,
        slip_sigma=0.0,
        along_var_m2=walk**2 * straight().chainage_m,
    )
    tie = TiePoint("end", 1000.0, chainage_m=1000.0, sigma_m=0.01)
    track = track_of(reckoned, with_ties(tie), options)
    s = np.interp(track.time_s, [0, 1000], [0, 1000])
    bridge = walk * np.sqrt(s * (1000.0 - s) / 1000.0)
    # the mixture of levels has one factor everywhere
    middle = len(s) // 2
    factor = track.sigma_along_m[middle] / bridge[middle]
    assert 0.5 < factor < 1.5
    assert np.allclose(track.sigma_along_m, factor * bridge, atol=0.02)


def test_beyond_the_last_tie_the_interval_grows_by_scale_and_slip():
    track = track_of(straight(1000.0), SURVEY)
    expected = np.hypot(0.02 * 1000.0, np.sqrt(slip_variance(1000.0)))
    assert track.sigma_along_m[-1] == pytest.approx(expected, rel=0.01)


def test_the_interval_shrinks_towards_each_tie_and_grows_away_from_it():
    ties = [TiePoint(f"valve {k}", t, chainage_m=t, sigma_m=0.5) for k, t in enumerate((250.0, 500.0, 750.0))]
    track = track_of(straight(1000.0), with_ties(*ties), EXACT)
    at = np.interp([250, 375, 500, 625, 750, 1000], track.time_s, track.sigma_along_m)
    assert at[0] < at[1] > at[2] < at[3] > at[4] < at[5]
    assert at[0] < 0.5


def test_a_closed_loop_is_a_tie_with_the_launchs_coordinates():
    def rms(track, truth):
        return np.sqrt(np.mean(np.sum((track.position_w_m[:, :2] - truth.position_w_m[:, :2]) ** 2, axis=1)))

    rng = np.random.default_rng(4)
    free_rms, closed_rms = [], []
    for _ in range(8):
        truth, reckoned = realistic(rng, 400.0, bends=4, loop=True)
        tie = TiePoint("back", float(truth.time_s[-1]), east_m=0.0, north_m=0.0, sigma_m=0.05)
        free, closed = track_of(reckoned, SURVEY), track_of(reckoned, with_ties(tie), EXACT)
        assert np.hypot(*closed.position_w_m[-1, :2]) < 0.1
        free_rms.append(rms(free, truth))
        closed_rms.append(rms(closed, truth))
    assert np.mean(closed_rms) < 0.9 * np.mean(free_rms)


def test_two_places_find_the_heading_and_the_scale_of_a_path_that_knows_neither():
    time_s = np.arange(0.0, 600.05, 0.05)
    yaw = np.where(time_s < 300, 1.0, 2.3)
    reckoned = dataclasses.replace(odometry(time_s, np.ones(len(time_s)), yaw), heading_from="launch")
    truth = odometry(time_s, np.full(len(time_s), 1.01), yaw - 2.0)
    ties = [
        TiePoint(n, t, east_m=float(e), north_m=float(m), sigma_m=0.02)
        for n, t in (("a", 300.0), ("b", 600.0))
        for e, m in [truth.position_w_m[np.searchsorted(time_s, t), :2]]
    ]
    survey = dataclasses.replace(with_ties(*ties), launch=Launch())
    track = track_of(reckoned, survey, EXACT)
    assert track.quality["heading_basis"] == "tie_points"
    assert np.abs(track.position_w_m - truth.position_w_m)[:, :2].max() < 0.3
    assert track.quality["scale"] == pytest.approx(1.01, abs=1e-3)


def test_heading_drift_is_taken_off_between_places():
    time_s = np.arange(0.0, 1800.05, 0.1)
    drift = np.radians(200.0) / 3600.0
    truth = odometry(time_s, np.ones(len(time_s)), 0.4 * np.sin(time_s / 150.0))
    reckoned = odometry(time_s, np.ones(len(time_s)), 0.4 * np.sin(time_s / 150.0) + drift * time_s)
    ties = [
        TiePoint(str(t), t, east_m=float(e), north_m=float(n), sigma_m=0.1)
        for t in (450.0, 900.0, 1350.0, 1800.0)
        for e, n in [truth.position_w_m[np.searchsorted(time_s, t), :2]]
    ]
    free, tied = track_of(reckoned, SURVEY), track_of(reckoned, with_ties(*ties), EXACT)
    worst_free = np.hypot(*(free.position_w_m - truth.position_w_m)[:, :2].T).max()
    worst = np.hypot(*(tied.position_w_m - truth.position_w_m)[:, :2].T).max()
    assert worst_free > 50.0
    assert worst < 1.0


def test_up_of_a_tie_gives_the_path_its_height():
    tie = TiePoint("end", 1000.0, east_m=998.0, north_m=0.0, up_m=-20.0, sigma_m=0.1)
    track = track_of(straight(1000.0), with_ties(tie), EXACT)
    assert track.position_w_m[-1, 2] == pytest.approx(-20.0, abs=0.1)
    assert track.position_w_m[len(track.time_s) // 2, 2] == pytest.approx(-10.0, abs=0.5)
    assert track.sigma_up_m[-1] < 0.15 < track.sigma_up_m[len(track.time_s) // 2]


def test_a_route_leads_the_path_and_turns_places_into_chainages():
    route = Route(((0.0, 0.0, 0.0), (500.0, 0.0, 0.0), (500.0, 600.0, -6.0)), sigma_m=0.3)
    tie = TiePoint("corner", 505.0, east_m=500.0, north_m=0.2, sigma_m=0.2)
    track = track_of(straight(1000.0), with_ties(tie, route=route), EXACT)
    corner = np.searchsorted(track.time_s, 505.0)
    assert track.chainage_m[corner] == pytest.approx(500.0, abs=0.5)
    off = np.minimum(np.abs(track.position_w_m[:, 1]), np.abs(track.position_w_m[:, 0] - 500.0))
    assert off.max() < 1e-9
    assert np.all(track.sigma_cross_m == 0.3)
    assert track.quality["heading_basis"] == "launch"


def test_a_route_drawn_backwards_is_turned_round():
    route = Route(((0.0, 900.0, 0.0), (0.0, 0.0, 0.0)))
    track = track_of(straight(800.0), with_ties(route=route))
    assert "route_reversed" in codes(track)
    assert np.allclose(track.position_w_m[-1], [0.0, 800.0, 0.0], atol=0.1)


def test_one_wrong_tie_among_good_ones_is_held_down_and_named():
    rng = np.random.default_rng(7)
    truth, reckoned = realistic(rng, 1000.0)
    times = np.quantile(truth.time_s, [0.2, 0.4, 0.6, 0.8, 1.0])
    ties = [
        TiePoint(f"valve {k}", float(t), chainage_m=float(np.interp(t, truth.time_s, truth.chainage_m)))
        for k, t in enumerate(times)
    ]
    wrong = [dataclasses.replace(t, chainage_m=t.chainage_m + 40.0) if t.name == "valve 2" else t for t in ties]
    track = track_of(reckoned, with_ties(*wrong))
    (finding,) = [f for f in track.findings if f.code == "tie_disagrees"]
    assert finding.params["name"] == "valve 2"
    assert finding.params["metres"] == pytest.approx(40.0, abs=8.0)
    clean = track_of(reckoned, with_ties(*[t for t in ties if t.name != "valve 2"]))
    assert np.abs(track.chainage_m - clean.chainage_m).max() < 1.5


def test_leave_one_out_is_what_leaving_one_out_gives():
    rng = np.random.default_rng(9)
    truth, reckoned = realistic(rng, 800.0)
    ties = [
        TiePoint(f"t{k}", float(t), chainage_m=float(np.interp(t, truth.time_s, truth.chainage_m)))
        for k, t in enumerate(np.quantile(truth.time_s, [0.25, 0.5, 0.75, 0.97]))
    ]
    checks = fitted(reckoned, with_ties(*ties)).checks
    for check, left in zip(checks, ties):
        without = track_of(reckoned, with_ties(*[t for t in ties if t is not left]))
        missed = left.chainage_m - np.interp(left.time_s, without.time_s, without.chainage_m)
        assert check.left_out_m == pytest.approx(missed, abs=0.12)  # the level of noise is weighed again without it
        assert not check.held_down


def test_ties_that_contradict_each_other_are_named():
    ties = (TiePoint("a", 300.0, chainage_m=600.0), TiePoint("b", 600.0, chainage_m=300.0))
    track = track_of(straight(1000.0), with_ties(*ties))
    (finding,) = [f for f in track.findings if f.code == "tie_contradiction"]
    assert {finding.params["name"], finding.params["other"]} == {"a", "b"}
    assert np.all(np.diff(track.chainage_m) >= 0.0)


@pytest.mark.parametrize(
    ("tie", "code"),
    [
        (TiePoint("late", 5000.0, chainage_m=1.0), "tie_outside"),
        (TiePoint("early", -30.0, chainage_m=1.0), "tie_outside"),
        (TiePoint("nothing", 30.0), "tie_empty"),
        (TiePoint("world", 30.0, latitude=41.0, longitude=29.0), "tie_without_launch"),
        (TiePoint("long", 500.0, chainage_m=1500.0), "tie_beyond_length"),
    ],
)
def test_a_tie_that_cannot_be_used_leaves_a_finding(tie, code):
    survey = with_ties(tie, pipe=PipeInfo(length_m=1000.0))
    assert code in codes(track_of(straight(1000.0), survey))


def test_a_tie_at_chainage_0_is_the_launch_and_handling_before_it_does_not_count():
    tie = TiePoint("launch", 100.0, chainage_m=0.0, sigma_m=0.1)
    track = track_of(straight(1000.0), with_ties(tie))
    assert track.chainage_m[-1] == pytest.approx(900.0, abs=0.1)
    assert np.all(track.chainage_m[track.time_s < 99.9] == 0.0)
    assert np.allclose(track.position_w_m[track.time_s < 99.9], 0.0)


def test_switching_a_tie_off_is_the_same_as_removing_it():
    reckoned = straight(500.0)
    kept, off = TiePoint("a", 250.0, chainage_m=255.0), TiePoint("b", 400.0, chainage_m=380.0)
    disabled = track_of(reckoned, with_ties(kept, dataclasses.replace(off, enabled=False)))
    removed = track_of(reckoned, with_ties(kept))
    assert np.array_equal(disabled.chainage_m, removed.chainage_m)
    assert np.array_equal(disabled.sigma_along_m, removed.sigma_along_m)


ties_strategy = st.lists(
    st.builds(
        TiePoint,
        name=st.sampled_from(["a", "b", "c", "d"]),
        time_s=st.floats(0.0, 200.0),
        chainage_m=st.one_of(st.none(), st.floats(0.0, 300.0)),
        east_m=st.one_of(st.none(), st.floats(-300.0, 300.0)),
        north_m=st.floats(-300.0, 300.0),
        up_m=st.one_of(st.none(), st.floats(-20.0, 20.0)),
        sigma_m=st.floats(0.01, 20.0),
    ),
    max_size=4,
)


@settings(max_examples=12, deadline=None)
@given(ties_strategy, st.randoms())
def test_any_ties_give_a_finite_monotone_track_whatever_their_order(ties, random):
    reckoned, few = straight(200.0), dataclasses.replace(SETTINGS, keyframes=60.0)
    track = track_of(reckoned, with_ties(*ties), few)
    for array in (track.chainage_m, track.position_w_m, track.sigma_along_m, track.sigma_cross_m, track.sigma_up_m):
        assert np.all(np.isfinite(array))
    assert np.all(np.diff(track.chainage_m) >= 0.0)
    assert track.chainage_m[0] >= 0.0
    assert np.allclose(np.linalg.norm(track.quat_ws, axis=1), 1.0)
    shuffled = list(ties)
    random.shuffle(shuffled)
    assert np.array_equal(track.chainage_m, track_of(reckoned, with_ties(*shuffled), few).chainage_m)


def test_the_closed_covariances_are_those_of_sampled_errors():
    # draw the errors by their definition and integrate them; no formula of the model is used
    rng = np.random.default_rng(0)
    time_s = np.arange(0.0, 100.0, 0.5)
    made = odometry(time_s, np.ones(len(time_s)), 0.03 * time_s)
    level = made.position_w_m[:, :2]
    step, dt = np.diff(level, axis=0), 0.5
    sigmas = Sigmas(0.02, 0.03, 0.0004, 0.0, 0.0)
    q, along, cross = 2e-5, 0.01, 0.003
    walks = Walks(along * time_s, cross * time_s, 0 * time_s, q * time_s)
    model = ErrorModel(time_s, level, level, made.chainage_m, sigmas, walks)
    count = 20_000
    heading = 0.03 * rng.standard_normal((count, 1)) + 0.0004 * rng.standard_normal((count, 1)) * (time_s[1:] - 0.25)
    walk = np.cumsum(np.sqrt(q * dt) * rng.standard_normal((count, len(step))), axis=1)
    heading = heading + walk - 0.5 * np.diff(walk, axis=1, prepend=0.0)
    ahead = step / np.linalg.norm(step, axis=1, keepdims=True)
    slip = np.sqrt(along * dt) * rng.standard_normal((count, len(step)))
    side = np.sqrt(cross * dt) * rng.standard_normal((count, len(step)))
    scale = 0.02 * rng.standard_normal((count, 1))
    east = np.cumsum(scale * step[:, 0] - heading * step[:, 1] + slip * ahead[:, 0] - side * ahead[:, 1], axis=1)
    north = np.cumsum(scale * step[:, 1] + heading * step[:, 0] + slip * ahead[:, 1] + side * ahead[:, 0], axis=1)
    i, j = 150, 80
    sampled = [[np.mean(a[:, i - 1] * b[:, j - 1]) for b in (east, north)] for a in (east, north)]
    closed = model.place_place(np.array([i]), j)[0]
    own = np.sqrt(
        np.diag(model.place_place(np.array([i]), i)[0])[:, None] * np.diag(model.place_place(np.array([j]), j)[0])
    )
    assert np.abs(closed - sampled).max() < 0.04 * own.max()
    chainage = np.cumsum(scale + slip / dt * dt, axis=1) - scale + scale  # a metre in two steps of half a second each
    sampled_c = np.mean((scale[:, 0] * made.chainage_m[i] + np.sum(slip[:, :i], axis=1)) * east[:, j - 1])
    assert model.chainage_place(np.array([i]), j)[0, 0] == pytest.approx(sampled_c, abs=0.04 * own.max())
    assert chainage.shape == east.shape


@pytest.mark.parametrize(
    ("known", "walk", "least"),
    [
        ("nothing", 0.042, 0.90),
        ("length", 0.042, 0.90),
        ("ties", 0.042, 0.90),
        ("ties", 0.084, 0.86),  # as slippery as the wheels of navigation §4.4: three ties tell most of it
    ],
)
def test_ninety_five_percent_intervals_hold_in_ninety_to_ninety_nine_percent(known, walk, least):
    rng = np.random.default_rng(11)
    options = dataclasses.replace(SETTINGS, keyframes=150.0)
    inside_along, inside_cross = [], []
    for _ in range(60 if known == "ties" else 100):
        truth, reckoned = realistic(rng, 600.0, slip_walk=walk)
        length = truth.chainage_m[-1]
        survey = SURVEY
        if known == "length":
            told = length + (0.1 + 0.002 * length) * rng.standard_normal()
            survey = with_ties(pipe=PipeInfo(length_m=float(told)))
        if known == "ties":
            ties = []
            for k, t in enumerate(np.quantile(truth.time_s, [0.3, 0.65, 1.0])):
                heard = t + 0.3 * rng.standard_normal()
                east, north = (
                    np.interp(t, truth.time_s, c) + 0.5 * rng.standard_normal() for c in truth.position_w_m[:, :2].T
                )
                ties.append(
                    TiePoint(str(k), float(min(heard, truth.time_s[-1])), east_m=float(east), north_m=float(north))
                )
            survey = with_ties(*ties)
        track = track_of(reckoned, survey, options)
        rows = slice(100, None, 50)
        inside_along.append(np.abs(track.chainage_m - truth.chainage_m)[rows] < 1.96 * track.sigma_along_m[rows])
        ahead = np.gradient(truth.position_w_m[:, :2], axis=0)
        side = np.column_stack([-ahead[:, 1], ahead[:, 0]]) / np.maximum(np.linalg.norm(ahead, axis=1), 1e-9)[:, None]
        off = np.abs(np.sum((track.position_w_m - truth.position_w_m)[:, :2] * side, axis=1))
        inside_cross.append((off < 1.96 * track.sigma_cross_m)[rows])
    along, cross = np.mean(np.concatenate(inside_along)), np.mean(np.concatenate(inside_cross))
    print(f"{known}: along {along:.3f}, cross {cross:.3f}")
    assert least <= along <= 0.99
    assert 0.90 <= cross <= 0.995
