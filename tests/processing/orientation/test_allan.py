"""Allan deviation against closed forms, the definition written out, and its own interval over many draws."""

from dataclasses import replace

import numpy as np
import pytest
from made_imu import samples_of, turning

from processing.orientation import quaternions as qt
from processing.orientation.allan import TERMS, allan, allan_findings, curve
from processing.orientation.calibration import calibrate
from processing.orientation.rests import find_rests
from processing.settings import OrientationSettings

RATE_HZ = 100.0
SETTINGS = OrientationSettings()


def white(density, count, seed=0):
    return density * np.sqrt(RATE_HZ) * np.random.default_rng(seed).standard_normal((count, 3))


def walk(density, count, seed=1):
    return np.cumsum(density / np.sqrt(RATE_HZ) * np.random.default_rng(seed).standard_normal((count, 3)), axis=0)


def term(found, name):
    at = TERMS.index(name)
    return found.terms[at], found.terms_sigma[at]


def test_it_is_the_definition_written_out():
    readings = np.random.default_rng(5).standard_normal((60, 3))
    found = curve(readings, 0.5)
    for tau, deviation in zip(found.tau_s, found.deviation, strict=True):
        m = round(tau / 0.5)
        means = np.array([readings[k : k + m].mean(axis=0) for k in range(61 - m)])
        differences = means[m:] - means[:-m]
        np.testing.assert_allclose(deviation, np.sqrt(0.5 * np.mean(differences**2, axis=0)), rtol=1e-9)


def test_white_noise_falls_with_the_root_of_time():
    found = curve(white(2e-3, 200_000), 1.0 / RATE_HZ)
    short = found.tau_s < 20.0
    np.testing.assert_allclose(
        found.deviation[short], np.repeat(2e-3 / np.sqrt(found.tau_s[short])[:, None], 3, axis=1), rtol=0.1
    )
    value, sigma = term(found, "random_walk")
    np.testing.assert_allclose(value, 2e-3, rtol=0.02)
    assert np.all(np.abs(value - 2e-3) < 4.0 * sigma)
    assert np.all(sigma < 1e-4)


def test_a_random_walk_rises_with_the_root_of_a_third_of_time():
    found = curve(walk(1e-4, 200_000), 1.0 / RATE_HZ)
    middle = (found.tau_s > 0.2) & (found.tau_s < 20.0)
    expected = 1e-4 * np.sqrt(found.tau_s[middle] / 3.0)
    np.testing.assert_allclose(found.deviation[middle], np.repeat(expected[:, None], 3, axis=1), rtol=0.15)
    np.testing.assert_allclose(term(found, "rate_random_walk")[0], 1e-4, rtol=0.1)


def test_both_are_told_apart_in_their_sum():
    found = curve(white(1e-3, 400_000) + walk(1e-4, 400_000), 1.0 / RATE_HZ)
    np.testing.assert_allclose(term(found, "random_walk")[0], 1e-3, rtol=0.03)
    np.testing.assert_allclose(term(found, "rate_random_walk")[0], 1e-4, rtol=0.25)
    np.testing.assert_allclose(found.model[:8], found.deviation[:8], rtol=0.1)


def test_flicker_noise_is_flat_at_its_bias_instability():
    # noise of the spectrum B²/(2π f), made in the frequency domain, has the flat variance (2 ln 2/π) B²
    rng = np.random.default_rng(8)
    count, b = 1 << 18, 3e-4
    frequency = np.fft.rfftfreq(count, 1.0 / RATE_HZ)
    density = np.zeros_like(frequency)
    density[1:] = b**2 / (2.0 * np.pi * frequency[1:])  # two-sided
    spectrum = np.sqrt(0.5 * density * count * RATE_HZ)[:, None] * (
        rng.standard_normal((len(frequency), 3)) + 1j * rng.standard_normal((len(frequency), 3))
    )
    found = curve(np.fft.irfft(spectrum, count, axis=0), 1.0 / RATE_HZ)
    middle = (found.tau_s > 0.3) & (found.tau_s < 30.0)
    np.testing.assert_allclose(found.deviation[middle], b * np.sqrt(2.0 * np.log(2.0) / np.pi), rtol=0.12)
    np.testing.assert_allclose(term(found, "bias_instability")[0], b, rtol=0.1)


def test_the_interval_holds_the_truth_in_some_95_of_100_draws():
    inside = []
    for seed in range(150):
        found = curve(white(1.0, 600, seed), 1.0 / RATE_HZ)
        truth = 1.0 / np.sqrt(found.tau_s)[:, None]
        inside.append((found.low < truth) & (truth < found.high))
    share = np.mean(inside, axis=(0, 2))
    assert np.all(share > 0.90)
    assert np.all(share[:-2] < 0.99)


def test_the_longest_quiet_rest_is_taken_and_a_short_one_says_so():
    time_s, quat_ws = turning([1.0, 0.4, 0], 3.0, 20.0, rest_s=30.0)
    imu = samples_of(time_s, quat_ws, noise=1.0)
    later = imu.time_s > 12.0
    cut = replace(
        imu,
        **{n: getattr(imu, n)[later] for n in ("time_s", "acc_s_mps2", "gyr_s_radps", "valid")},
        mag_s_ut=None,
    )
    result = allan(cut, find_rests(cut, SETTINGS))
    assert result.start_s > 49.0
    assert result.end_s - result.start_s == pytest.approx(30.0, abs=1.0)
    np.testing.assert_allclose(term(result.gyr, "random_walk")[0], np.radians(0.1) / np.sqrt(RATE_HZ), rtol=0.1)
    np.testing.assert_allclose(term(result.acc, "random_walk")[0], 0.03 / np.sqrt(RATE_HZ), rtol=0.1)
    assert "rate_random_walk" in result.unseen
    assert [f.code for f in allan_findings(result)] == ["allan_rest_short"]
    assert allan_findings(result)[0].params["longest_s"] == pytest.approx(10.0, abs=0.5)


def test_broken_rows_end_the_stretch():
    imu = samples_of(np.arange(0.0, 60.0, 0.01), np.tile(qt.IDENTITY, (6000, 1)), noise=1.0)
    valid = imu.valid.copy()
    valid[2000:2003] = False
    result = allan(replace(imu, valid=valid), calibrate(imu, SETTINGS).rests)
    assert result.start_s == pytest.approx(20.03, abs=0.02)


def test_without_a_rest_there_is_none():
    imu = samples_of(np.arange(0.0, 5.0, 0.01), np.tile(qt.IDENTITY, (500, 1)))
    assert allan(imu, ()) is None


def test_long_rests_are_averaged_first_and_keep_their_long_times(monkeypatch):
    readings = white(2e-3, 60_000)
    monkeypatch.setattr("processing.orientation.allan._MOST_ROWS", 10_000)
    found = curve(readings, 1.0 / RATE_HZ)
    assert found.tau_s[0] == pytest.approx(0.06)
    np.testing.assert_allclose(term(found, "random_walk")[0], 2e-3, rtol=0.04)
