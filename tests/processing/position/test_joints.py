"""Joints as an odometer: pipes are counted although some blows are missed or extra, and random blows never lock."""

import numpy as np
import pytest
from odometry_runs import odometry

from processing.position.joint_chain import find_chain
from processing.position.joints import MAGNETIC, SHOCKS, find_joints
from processing.progress import silent
from processing.survey import ImuSamples


def blows(rng, length_m=500.0, spacing_m=6.0, spread_m=0.03, missed=0.1, strays_pm=0.03, slip=0.05):
    """Where the odometer puts blows of which some are joints: places, and the true number of pipes between them."""
    joints = np.cumsum(rng.normal(spacing_m, spread_m, int(length_m / spacing_m)))
    seen = rng.random(len(joints)) > missed
    stray = rng.uniform(0.0, length_m, rng.poisson(strays_pm * length_m))
    true = np.concatenate([joints[seen], stray])
    index = np.concatenate([np.flatnonzero(seen), np.full(len(stray), -1)])
    order = np.argsort(true)
    grid = np.arange(0.0, length_m + spacing_m, 0.1)
    walked = np.concatenate([[0.0], np.cumsum(slip * np.sqrt(0.1) * rng.standard_normal(len(grid) - 1))])
    return np.interp(true[order], grid, 0.98 * grid + walked), index[order]


def test_pipes_are_counted_with_every_tenth_blow_missing_and_strays_between():
    for seed in range(5):
        rng = np.random.default_rng(seed)
        place, index = blows(rng)
        chain = find_chain(place)
        assert chain is not None
        assert chain.spacing_m == pytest.approx(0.98 * 6.0, rel=0.01)
        joints = index[chain.rows]
        assert np.mean(joints >= 0) > 0.95
        true = joints >= 0
        # what is counted between two true joints is what lies between them
        counted = np.concatenate([[0], np.cumsum(chain.pipes)])[true]
        assert np.array_equal(counted - counted[0], joints[true] - joints[true][0])


def test_the_scatter_of_a_pipe_is_found_and_slow_slip_is_not_taken_for_it():
    rng = np.random.default_rng(1)
    joints = np.cumsum(rng.normal(6.0, 0.05, 400))
    # the odometer's scale wanders by 1 % over some 60 m
    slow = 0.01 * np.sin(joints / 60.0)
    place = np.cumsum(np.diff(joints, prepend=0.0) * (1.0 + slow))
    chain = find_chain(place)
    assert chain is not None
    assert chain.sigma_m == pytest.approx(0.05, rel=0.25)


@pytest.mark.parametrize("density_pm", [0.1, 0.2, 0.5])
def test_random_blows_do_not_lock(density_pm):
    rng = np.random.default_rng(int(1000 * density_pm))
    locked = 0
    for _ in range(30):
        place = np.sort(rng.uniform(0.0, 250.0, rng.poisson(250.0 * density_pm)))
        locked += find_chain(place) is not None
    assert locked == 0


def test_blows_that_come_in_clusters_do_not_lock():
    rng = np.random.default_rng(5)
    for _ in range(25):
        starts = rng.uniform(0.0, 250.0, 12)
        place = np.sort(np.concatenate([starts + rng.exponential(2.0, 12) for _ in range(4)]))
        assert find_chain(place) is None


def test_a_spacing_is_looked_for_only_where_it_was_told():
    place, _ = blows(np.random.default_rng(2), spacing_m=6.0)
    assert find_chain(place, (5.5, 6.5)) is not None
    assert find_chain(place, (8.5, 9.5)) is None


def rolled(length_m=300.0, speed_mps=0.5):
    time_s = np.arange(0.0, length_m / speed_mps, 0.1)
    return odometry(time_s, np.full(len(time_s), speed_mps), np.zeros(len(time_s)))


def recording(reckoned, blow_m, field_m=None, rate_hz=100.0, seed=0):
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, reckoned.time_s[-1], 1.0 / rate_hz)
    acc = np.array([0.0, 0.0, 9.81]) + 0.02 * rng.standard_normal((len(time_s), 3))
    rows = np.searchsorted(time_s, np.interp(blow_m, reckoned.chainage_m, reckoned.time_s))
    acc[rows, 2] += 4.0
    mag = None
    if field_m is not None:
        place = np.interp(time_s, reckoned.time_s, reckoned.chainage_m)
        size = 45.0 + 0.3 * rng.standard_normal(len(time_s))
        for at in field_m:
            size += 8.0 / (1.0 + ((place - at) / 0.25) ** 2)
        way = rng.standard_normal((len(time_s), 3))
        mag = way / np.linalg.norm(way, axis=1, keepdims=True) * size[:, None]
    return ImuSamples(time_s, acc, np.zeros((len(time_s), 3)), np.ones(len(time_s), dtype=bool), mag_s_ut=mag)


def test_blows_become_increments_of_the_told_length():
    reckoned = rolled()
    at = np.cumsum(np.random.default_rng(0).normal(6.0, 0.03, 48))
    found = find_joints(recording(reckoned, at), reckoned, 6.05, silent())
    assert len(found.increments) == 47
    assert {i.source for i in found.increments} == {SHOCKS}
    assert all(i.length_m == 6.05 and 0.0 < i.scale_sigma <= 0.01 for i in found.increments)
    start = np.interp([i.start_s for i in found.increments], reckoned.time_s, reckoned.chainage_m)
    assert start == pytest.approx(at[:-1], abs=0.03)
    assert [f.code for f in found.findings] == ["joints_counted"]
    assert found.findings[0].params["count"] == 48


def test_an_untold_length_says_only_that_it_is_constant_and_suggests_the_standard():
    reckoned = rolled()
    found = find_joints(recording(reckoned, np.arange(3.0, 297.0, 6.0)), reckoned, None, silent())
    assert all(i.scale_sigma >= 0.05 for i in found.increments)
    assert [f.code for f in found.findings] == ["joints_counted", "joints_standard"]
    assert found.findings[1].params["standard_m"] == 6.0


def test_told_joints_that_nobody_felt_are_reported():
    reckoned = rolled()
    rng = np.random.default_rng(3)
    found = find_joints(recording(reckoned, np.sort(rng.uniform(0, 300, 30))), reckoned, 6.0, silent())
    assert found.increments == ()
    assert [f.code for f in found.findings] == ["joints_not_found"]


def test_knocks_on_a_device_that_rests_are_no_joints():
    time_s = np.arange(0.0, 400.0, 0.1)
    reckoned = odometry(time_s, np.where(time_s > 300.0, 0.5, 0.0), np.zeros(len(time_s)))
    imu = recording(rolled(200.0), np.arange(5.0, 140.0, 3.0))  # every 6 s, all but the last while at rest
    assert find_joints(imu, reckoned, None, silent()).increments == ()


def test_the_field_of_the_joints_counts_them_where_no_blow_is_felt():
    reckoned = rolled()
    at = np.cumsum(np.random.default_rng(4).normal(5.5, 0.04, 53))
    found = find_joints(recording(reckoned, at[:0], at), reckoned, 5.5, silent())
    assert len(found.increments) >= 48
    assert {i.source for i in found.increments} == {MAGNETIC}
    start = np.interp([i.start_s for i in found.increments], reckoned.time_s, reckoned.chainage_m)
    nearest = np.min(np.abs(start[:, None] - at), axis=1)
    assert np.sqrt(np.mean(nearest**2)) < 0.1
