"""Height from pressure: true within what it says of itself, deaf to pumps, silent where there is nothing to read."""

import numpy as np
import pytest
from odometry_runs import odometry

from processing.position.pressure import KPA_PER_M, find_heights
from processing.progress import silent
from processing.survey import ImuSamples

RATE_HZ = 10.0


def surges(rng, time_s, sigma_m, tau_s=20.0):
    keep = np.exp(-1.0 / (RATE_HZ * tau_s))
    out = np.empty(len(time_s))
    out[0] = rng.standard_normal()
    for k, draw in enumerate(rng.standard_normal(len(time_s) - 1)):
        out[k + 1] = keep * out[k] + np.sqrt(1.0 - keep**2) * draw
    return sigma_m * out


def run(seed=0, surge_m=0.04, friction=0.0002, steps=(), seconds=1500.0):
    """A ball at 0.6 m/s after 15 s of rest, in a pipe whose slope changes each 80 m."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(0.0, seconds, 1.0 / RATE_HZ)
    speed = np.where(time_s < 15.0, 0.0, 0.6)
    reckoned = odometry(time_s, speed, np.zeros(len(time_s)))
    way = reckoned.chainage_m
    corners = np.arange(0.0, way[-1] + 80.0, 80.0)
    up = np.interp(way, corners, np.concatenate([[0.0], np.cumsum(80.0 * rng.normal(0.0, 0.015, len(corners) - 1))]))
    head = 40.0 - up - friction * way + surges(rng, time_s, surge_m) + 0.005 * rng.standard_normal(len(time_s))
    for at, size in steps:
        head += size * (time_s > at)
    nothing = np.zeros((len(time_s), 3))
    imu = ImuSamples(time_s, nothing, nothing, np.ones(len(time_s), dtype=bool), pressure_kpa=head * KPA_PER_M)
    return imu, reckoned, up


def misses(series, imu, reckoned, up, friction=0.0002):
    """Error of the heights, less the friction slope, which the series leaves to the fit."""
    way = np.interp(series.time_s, reckoned.time_s, reckoned.chainage_m)
    return series.up_m - np.interp(series.time_s, imu.time_s, up) - friction * way


def test_heights_are_true_within_their_own_sigma():
    shares, means = [], []
    for seed in range(20):
        imu, reckoned, up = run(seed)
        (series,) = find_heights(imu, reckoned, silent()).heights
        miss = misses(series, imu, reckoned, up)
        shares.append(np.mean(np.abs(miss - miss.mean()) < 1.96 * series.sigma_m))
        means.append(miss.mean() / np.hypot(series.offset_sigma_m, series.sigma_m / np.sqrt(len(miss))))
        assert 0.03 < series.sigma_m < 0.2
        assert series.gradient_sigma > 0.0002
    assert np.mean(shares) >= 0.95
    assert np.mean(np.abs(means) < 1.96) >= 0.9


def test_as_independent_rows_the_sigma_covers_means_over_minutes():
    # surges of 20 s make neighbours agree: the sigma of a row must make good what the fit will average
    scores = []
    for seed in range(15):
        imu, reckoned, up = run(seed)
        (series,) = find_heights(imu, reckoned, silent()).heights
        miss = misses(series, imu, reckoned, up)
        miss -= miss.mean()
        blocks = miss[: len(miss) // 12 * 12].reshape(-1, 12).mean(axis=1)
        scores += list(blocks / (series.sigma_m / np.sqrt(12.0)))
    assert np.std(scores) < 1.25


def test_the_friction_slope_that_is_left_open_is_darcys():
    imu, reckoned, _ = run(0)
    wide, narrow = (find_heights(imu, reckoned, silent(), d).heights[0].gradient_sigma for d in (0.6, 0.2))
    # 0.02 · 0.6² / (2 · 9.81 · 0.2): 1.8 m a kilometre
    assert narrow == pytest.approx(0.00183, abs=1e-5)
    assert narrow == pytest.approx(3.0 * wide, rel=1e-6)


def test_louder_surges_make_a_larger_sigma():
    quiet = find_heights(*run(0, surge_m=0.04)[:2], silent()).heights[0].sigma_m
    loud = find_heights(*run(0, surge_m=0.4)[:2], silent()).heights[0].sigma_m
    assert loud == pytest.approx(10.0 * quiet, rel=0.35)


def test_a_pump_that_switches_is_not_taken_for_a_climb():
    imu, reckoned, up = run(2, steps=((500.0, -6.0), (1000.0, 4.0)))
    found = find_heights(imu, reckoned, silent())
    assert [f.code for f in found.findings] == ["pressure_used", "pressure_steps"]
    assert found.findings[1].params["count"] == 2
    assert len(found.heights) == 3
    offsets = [s.offset_sigma_m for s in found.heights]
    assert offsets == sorted(offsets)
    assert offsets[0] < offsets[1] < offsets[2]
    for series in found.heights:
        miss = misses(series, imu, reckoned, up)
        assert abs(miss.mean()) < 3.0 * np.hypot(series.offset_sigma_m, 0.02)


def test_a_jump_that_a_hump_of_the_pipe_could_make_is_doubted_and_stays():
    imu, reckoned, _ = run(6, steps=((700.0, -0.8),))
    first, second = find_heights(imu, reckoned, silent()).heights
    assert first.offset_sigma_m < 0.2
    assert second.offset_sigma_m == pytest.approx(0.8, abs=0.2)
    same = find_heights(*run(6)[:2], silent()).heights[0]
    assert second.up_m[-1] - same.up_m[-1] == pytest.approx(0.8, abs=0.05)


def test_a_pipe_that_really_climbs_is_no_pump():
    imu, reckoned, _ = run(3)
    steep = np.interp(reckoned.chainage_m, [0.0, 200.0, 220.0, 1e4], [0.0, 0.0, 8.0, 8.0])  # 40 %
    climbing = ImuSamples(
        imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, imu.valid, pressure_kpa=imu.pressure_kpa - KPA_PER_M * steep
    )
    found = find_heights(climbing, reckoned, silent())
    assert len(found.heights) == 1
    after = found.heights[0].up_m[found.heights[0].time_s > 500.0]
    before = find_heights(imu, reckoned, silent()).heights[0]
    assert after - before.up_m[before.time_s > 500.0] == pytest.approx(8.0, abs=0.05)


@pytest.mark.parametrize("kind", ["none", "constant", "air", "short"])
def test_what_tells_no_height_is_not_used(kind):
    imu, reckoned, _ = run(4, seconds=30.0 if kind == "short" else 600.0)
    pressure = {
        "none": None,
        "constant": np.full(len(imu.time_s), 400.0),
        "air": 101.3 + 0.02 * np.sin(imu.time_s / 100.0),
        "short": imu.pressure_kpa,
    }[kind]
    silent_imu = ImuSamples(imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, imu.valid, pressure_kpa=pressure)
    found = find_heights(silent_imu, reckoned, silent())
    assert found.heights == ()
    assert [f.code for f in found.findings] == ([] if kind == "none" else ["pressure_unusable"])


def test_rows_without_a_number_are_passed_over():
    imu, reckoned, up = run(5)
    pressure = imu.pressure_kpa.copy()
    pressure[3000:3400] = np.nan
    holed = ImuSamples(imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, imu.valid, pressure_kpa=pressure)
    (series,) = find_heights(holed, reckoned, silent()).heights
    assert np.all(np.isfinite(series.up_m))
    assert np.all(np.diff(series.time_s) > 0)
    assert np.std(misses(series, holed, reckoned, up)) < 0.1
