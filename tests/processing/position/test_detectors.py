"""Standstill detectors against their textbook formulas, and the networks against PyTorch's own outputs."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.position import detectors as dt
from processing.position import zero_velocity_network as net
from processing.progress import silent
from processing.settings import PositionSettings

REFERENCE = Path(__file__).parent / "reference"
SETTINGS = PositionSettings()
G = 9.8


def shaken(count=300, seed=0):
    rng = np.random.default_rng(seed)
    acc = np.array([0.5, -1.0, 9.7]) + rng.standard_normal((count, 3)) * np.linspace(0.05, 4.0, count)[:, None]
    return acc, rng.standard_normal((count, 3)) * np.linspace(0.01, 3.0, count)[:, None]


def walked(steps=12, rate_hz=200.0, speed=1.0, seed=0):
    """Half a second of standing, half of swinging, over and over; ``speed`` makes both the wilder."""
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(steps * rate_hz)) / rate_hz
    swing = np.maximum(np.sin(2 * np.pi * time_s), 0.0)
    gyr = np.column_stack([0.2 * swing, 5.0 * speed * swing, 0.1 * swing])
    acc = np.column_stack([8.0 * speed * swing * np.sin(40.0 * time_s), 0.0 * swing, G + 6.0 * speed * swing])
    noise = 0.01 * speed
    return (
        time_s,
        acc + noise * rng.standard_normal(acc.shape),
        gyr + noise * rng.standard_normal(gyr.shape),
        swing == 0.0,
    )


def found(name, time_s, acc, gyr, chosen=SETTINGS):
    return dt.find_standing(name, time_s, lambda rows: (acc[rows], gyr[rows]), G, chosen, silent())


@pytest.mark.parametrize("window", [5, 8, 21])
def test_the_threshold_statistics_are_skogs_sums_over_the_window(window):
    acc, gyr = shaken()
    places = range(40, 260, 37)
    got = {
        f: f(acc, gyr, window, G)
        for f in (dt.acceleration_variance, dt.acceleration_magnitude, dt.rate_energy, dt.shoe)
    }
    for k in places:
        rows = range(k - window // 2, k - window // 2 + window)
        a, w = np.array([acc[r] for r in rows]), np.array([gyr[r] for r in rows])
        mean = sum(a) / window
        up = mean / np.sqrt(mean @ mean)
        want = {
            dt.acceleration_variance: sum((x - mean) @ (x - mean) for x in a) / window,
            dt.acceleration_magnitude: sum((np.sqrt(x @ x) - G) ** 2 for x in a) / window,
            dt.rate_energy: sum(x @ x for x in w) / window,
            dt.shoe: sum(
                (x - G * up) @ (x - G * up) / 0.00098**2 + y @ y / np.radians(0.005) ** 2 for x, y in zip(a, w)
            )
            / window,
        }
        for statistic, value in want.items():
            assert got[statistic][k] == pytest.approx(value, rel=1e-9), statistic.__name__


def test_the_butterworth_measure_passes_five_hertz_by_half_each_way():
    time_s = np.arange(4000) / 200.0
    acc = np.zeros((4000, 3))
    acc[:, 2] = G + 1.0 + np.sin(2 * np.pi * 5.0 * time_s)  # never below g: its absolute value is itself
    out = dt.butterworth(acc, np.zeros((4000, 3)), 8, G)  # 8 samples: a cut of 0.4 / 8 of half the rate, 5 Hz
    middle = out[1000:3000]
    assert np.mean(middle) == pytest.approx(1.0, abs=0.01)
    assert np.ptp(middle) / 2.0 == pytest.approx(0.5, abs=0.01)  # −3 dB forwards and −3 dB backwards


@given(seed=st.integers(0, 1000), scale=st.floats(0.3, 3.0))
@settings(max_examples=20, deadline=None)
def test_no_statistic_depends_on_how_the_sensor_is_mounted(seed, scale):
    acc, gyr = shaken(80, seed)
    turn, _ = np.linalg.qr(np.random.default_rng(seed).standard_normal((3, 3)))
    turn *= np.linalg.det(turn)
    for detector in dt.DETECTORS.values():
        if detector.statistic is not None:
            plain = detector.statistic(acc, scale * gyr, 7, G)
            assert np.allclose(
                detector.statistic(acc @ turn.T, scale * gyr @ turn.T, 7, G), plain, rtol=1e-6, atol=1e-9
            )


@pytest.mark.parametrize("name", ["variance", "magnitude", "rate_energy", "shoe", "butterworth"])
@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
def test_an_adaptive_threshold_follows_the_gait(name, speed):
    time_s, acc, gyr, still = walked(speed=speed)
    got = found(name, time_s, acc, gyr)
    assert np.mean(got.still[still]) > 0.75
    assert np.mean(got.still[~still]) < 0.3
    assert np.array_equal(got.still, got.statistic < got.threshold)


def test_a_fixed_threshold_fails_where_the_adaptive_one_holds():
    time_s, acc, gyr, still = walked(speed=4.0)
    acc = acc + 0.7 * np.random.default_rng(1).standard_normal(acc.shape)  # a hard floor
    fixed = found("variance", time_s, acc, gyr, PositionSettings(zero_velocity_threshold="fixed"))
    assert np.mean(fixed.still[still]) < 0.05
    assert np.mean(found("variance", time_s, acc, gyr).still[still]) > 0.6


@pytest.mark.parametrize("name", [n for n in dt.DETECTORS if n != "lstm"])
def test_who_stands_all_the_time_is_still_all_the_time(name):
    rng = np.random.default_rng(2)
    time_s = np.arange(4000) / 200.0
    acc = np.array([0.0, 0.0, G]) + 0.01 * rng.standard_normal((4000, 3))
    assert np.mean(found(name, time_s, acc, 0.003 * rng.standard_normal((4000, 3))).still) > 0.99


@pytest.mark.parametrize("name", net.NAMES)
def test_a_network_gives_what_pytorch_gave(name):
    stored = np.load(REFERENCE / f"{name}.npz", allow_pickle=False)
    imu = stored["imu"]
    standing = net.standing_probability(net.load_network(name), imu[:, :3], imu[:, 3:])
    assert 0.05 < np.mean(stored["standing"] > 0.5) < 0.95
    assert np.max(np.abs(standing - stored["standing"])) < 1e-5


@pytest.mark.parametrize("name", net.NAMES)
def test_a_long_recording_in_pieces_gives_the_same_as_whole(name, monkeypatch):
    stored = np.load(REFERENCE / f"{name}.npz", allow_pickle=False)
    imu = np.tile(stored["imu"], (5, 1))
    network = net.load_network(name)
    whole = net.standing_probability(network, imu[:, :3], imu[:, 3:])
    monkeypatch.setattr(net, "_BLOCK", 400)
    monkeypatch.setattr(net, "_STREAMS", 2)
    parts = net.standing_probability(network, imu[:, :3], imu[:, 3:])
    assert np.max(np.abs(parts - whole)) < 1e-5


def test_a_network_says_what_it_was_trained_on_and_what_it_never_saw():
    for name in net.NAMES:
        record = net.load_network(name).record
        assert not set(record["trained_on"]) & set(record["never_seen"])
        assert record["on_unseen_trials"]["accuracy"] > 0.9


def test_weights_that_do_not_fit_are_refused():
    network = net.load_network("tcn")
    good = {**network.arrays, "record": json.dumps(network.record)}
    assert net.checked(good).layers == 5
    with pytest.raises(ValueError, match="dense"):
        net.checked({**good, "dense": np.zeros((2, 23), np.float32)})
    with pytest.raises(ValueError, match="finite"):
        net.checked({**good, "dense": np.full((2, 24), np.nan, np.float32)})
    with pytest.raises(ValueError, match="kind"):
        net.checked({**good, "record": json.dumps({"kind": "forest", "threshold": 0.5})})
    with pytest.raises(ValueError, match="other"):
        net.load_network("other")


@pytest.mark.parametrize("rate_hz", [60.0, 400.0])
def test_the_convolutions_find_stances_at_other_rates_than_they_learned_at(rate_hz):
    stored = np.load(REFERENCE / "tcn.npz", allow_pickle=False)
    imu = stored["imu"].astype(float)
    at = np.arange(0.0, 1.49, 1.0 / rate_hz)
    other = np.column_stack([np.interp(at, np.arange(300) / 200.0, c) for c in imu.T])
    got = found("tcn", at, other[:, :3], other[:, 3:])
    want = np.interp(at, np.arange(300) / 200.0, stored["standing"]) > 0.5
    assert np.mean(got.still == want) > 0.9
