"""Bends of the map in the turns of the ball: right where they are sure, silent where they are not."""

import dataclasses

import numpy as np
import pytest
from odometry_runs import odometry, realistic

from processing.position.bends import find_bends
from processing.position.profile_matching import Prior, Profile, match, table_grid
from processing.position.route import RouteLine
from processing.progress import silent
from processing.settings import PositionSettings

SETTINGS = PositionSettings()


def mapped(truth, every_m=0.5, mirror=False, along_m=0.0):
    """The true way as a map of its own, east and north swapped about so that no heading is shared."""
    s = np.arange(0.0, truth.chainage_m[-1], every_m)
    distinct, first = np.unique(truth.chainage_m, return_index=True)
    east, north = (np.interp(s, distinct, truth.position_w_m[first, k]) for k in (0, 1))
    points = np.column_stack([-north, east, 0.0 * east])
    if mirror:
        points = points * [1.0, -1.0, 1.0]
    return RouteLine(points, s + along_m, 0.5)


def misses(fixes, truth):
    true = np.interp([f.time_s for f in fixes], truth.time_s, truth.chainage_m)
    return np.array([f.chainage_m for f in fixes]) - true, np.array([f.sigma_m for f in fixes])


def test_bends_tell_the_chainage_within_their_sigma_whatever_scale_slip_and_heading_do():
    away, sigma, found, wanted = [], [], 0, 0
    for seed in range(6):
        truth, ball = realistic(np.random.default_rng(seed), 400.0)
        bends = find_bends(ball, mapped(truth), SETTINGS, silent())
        if bends.fixes:
            miss, own = misses(bends.fixes, truth)
            away.append(miss)
            sigma.append(own)
        found += len(bends.fixes)
        wanted += bends.mapped
    away, sigma = np.concatenate(away), np.concatenate(sigma)
    assert found >= 0.75 * wanted
    assert np.max(np.abs(away) / sigma) < 3.0
    assert np.sqrt(np.mean(away**2)) < 0.35  # the odometer alone is off by 2 % of some 250 m
    assert np.all(sigma >= 0.3)


def test_the_odometers_own_error_does_not_enter_the_fix():
    truth, ball = realistic(np.random.default_rng(3), 400.0, scale_sigma=0.0)
    longer = dataclasses.replace(ball, chainage_m=ball.chainage_m * 1.02, position_w_m=ball.position_w_m * 1.02)
    before = find_bends(ball, mapped(truth), SETTINGS, silent()).fixes
    after = find_bends(longer, mapped(truth), SETTINGS, silent()).fixes
    assert len(before) == len(after) >= 4
    # 2 % of 200 m are 4 m; the fixes stay where the map has the bends
    assert misses(after, truth)[0] == pytest.approx(misses(before, truth)[0], abs=0.15)


def test_a_straight_route_says_nothing():
    time_s = np.arange(0.0, 600.0, 0.1)
    ball = odometry(time_s, np.full(len(time_s), 0.5), np.zeros(len(time_s)))
    line = RouteLine(np.array([[0.0, 0, 0], [300.0, 0, 0]]), np.array([0.0, 300.0]), 0.5)
    bends = find_bends(ball, line, SETTINGS, silent())
    assert bends.fixes == ()
    assert bends.findings == ()


def test_a_mirrored_map_is_refused_and_named():
    for seed in range(4):
        truth, ball = realistic(np.random.default_rng(seed), 400.0)
        bends = find_bends(ball, mapped(truth, mirror=True), SETTINGS, silent())
        assert bends.fixes == ()
        assert [f.code for f in bends.findings] == ["bends_mirrored"]


def test_the_map_of_another_street_is_refused():
    wrong = 0
    for seed in range(8):
        _, ball = realistic(np.random.default_rng(seed), 400.0)
        other, _ = realistic(np.random.default_rng(seed + 100), 400.0)
        # bends a little elsewhere along, as everywhere in a town
        line = mapped(other)
        line = dataclasses.replace(line, chainage_m=line.chainage_m * (1.0 + 0.2 * np.sin(seed + 1.0)))
        wrong += bool(find_bends(ball, line, SETTINGS, silent()).fixes)
    assert wrong == 0


def test_a_map_that_begins_elsewhere_is_refused():
    for seed in range(4):
        truth, ball = realistic(np.random.default_rng(seed), 400.0, scale_sigma=0.005)
        assert find_bends(ball, mapped(truth, along_m=25.0), SETTINGS, silent()).fixes == ()


def test_equal_bends_at_equal_distances_far_away_are_no_proof_of_the_place():
    # after 600 m the odometer is good to 12 m (2 %), and the next equal bend is 14 m further
    time_s = np.arange(0.0, 1400.0, 0.1)
    chainage = 0.5 * time_s
    turns = sum(
        sign * np.clip((chainage - at) / 2.0, 0.0, 1.0)
        for k, at in enumerate(np.arange(600.0, 900.0, 7.0))
        for sign in [1.0 if k % 2 else -1.0]
    )
    truth_ball = odometry(time_s, np.full(len(time_s), 0.5), 0.5 * turns)
    longer = np.arange(0.0, 1900.0, 0.1)
    far = 0.5 * longer
    yaw = sum(
        (1.0 if k % 2 else -1.0) * np.clip((far - at) / 2.0, 0.0, 1.0)
        for k, at in enumerate(np.arange(600.0, 900.0, 7.0))
    )
    drawn = odometry(longer, np.full(len(longer), 0.5), 0.5 * yaw)
    line = RouteLine(drawn.position_w_m[::5], drawn.chainage_m[::5], 0.5)
    late = dataclasses.replace(
        truth_ball, chainage_m=truth_ball.chainage_m * 1.01, position_w_m=truth_ball.position_w_m * 1.01
    )
    for fix in find_bends(late, line, SETTINGS, silent()).fixes:
        true = np.interp(fix.time_s, time_s, chainage)
        assert abs(fix.chainage_m - true) < 3.0 * fix.sigma_m


def test_the_posterior_without_features_is_the_odometers_own_prior():
    # nothing to be seen: the place is the odometer's, spread by scale, start and walk
    odometer = np.arange(0.0, 400.0, 0.5)
    table = table_grid(-50.0, 500.0)
    flat = Profile(odometer, np.zeros(len(odometer)), np.zeros(len(table)), -50.0, 0.1, 10.0)
    found = match((flat,), np.array([300.0]), Prior(0.02, 1.0, 0.13), silent())
    assert found.gain == pytest.approx(0.0, abs=1e-2)
    assert found.placed[0].place_m == pytest.approx(300.0, abs=1.0)
    # ±2 m of a normal with sigma² = 6² + 1² + 0.13²·300: 2·Φ(2/6.5) − 1, the grid's edges aside
    assert found.placed[0].share == pytest.approx(0.25, abs=0.03)
