"""Spectral kurtosis and kurtogram: against closed forms, and against scipy's kurtosis of the band cut out directly."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from processing.sound.band_choice import tree_of_bands
from processing.sound.kurtogram import fast_kurtogram, kurtosis_band, kurtosis_of_levels, spectral_kurtosis

RATE = 8000.0


def noise(seconds, seed=0):
    return np.random.default_rng(seed).standard_normal(int(seconds * RATE))


def bursts(seconds, low, high, seed=1, every_s=0.5, gain=6.0):
    """Noise, and ringings of a few milliseconds in one band."""
    rng = np.random.default_rng(seed)
    count = int(seconds * RATE)
    inside = signal.sosfilt(
        signal.butter(4, [low, high], "bandpass", fs=RATE, output="sos"), rng.standard_normal(count)
    )
    envelope = np.zeros(count)
    for start in range(0, count, int(every_s * RATE)):
        fade = np.exp(-np.arange(400) / 80.0)[: count - start]
        envelope[start : start + len(fade)] += fade
    return noise(seconds, seed + 100) + gain * envelope * inside / inside.std()


def row_of(table, low, high):
    return int(np.argmin(np.abs(table.bands_hz - [low, high]).sum(axis=1)))


def test_steady_noise_has_no_kurtosis_at_any_frequency_within_its_sigma():
    found = spectral_kurtosis(noise(60), RATE, 256)
    assert abs(found.value.mean()) < 3 * found.sigma / np.sqrt(len(found.value) / 2)
    assert found.value.std() == pytest.approx(found.sigma, rel=0.3)


def test_a_tone_has_a_kurtosis_of_minus_one():
    time = np.arange(int(20 * RATE)) / RATE
    found = spectral_kurtosis(100 * np.sin(2 * np.pi * 1000 * time) + noise(20), RATE, 256)
    at = int(np.argmin(np.abs(found.frequency_hz - 1000)))
    assert found.value[at] == pytest.approx(-1.0, abs=0.01)


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_noise_that_is_switched_has_the_kurtosis_of_its_share(share):
    """Gaussian noise of power 1 for a share p of the time and 0 else: <a⁴>/<a²>² = 1/p, K = 2/p − 2 (Antoni 2006)."""
    rng, block = np.random.default_rng(2), 4096
    on = rng.permutation(np.arange(100) < 100 * share)
    samples = noise(100 * block / RATE)[: 100 * block] * np.repeat(on, block)
    expected = 2 / share - 2
    table = fast_kurtogram(samples, RATE, levels=3)
    np.testing.assert_allclose(table.value, expected, rtol=0.12)
    assert np.median(spectral_kurtosis(samples, RATE, 256).value) == pytest.approx(expected, rel=0.08)


def test_the_kurtogram_is_zero_for_noise_and_its_sigma_is_true():
    table = fast_kurtogram(noise(60, 3), RATE)
    ratio = table.value[1:] / table.sigma[1:]
    assert abs(ratio.mean()) < 0.2
    assert ratio.std() == pytest.approx(1.0, abs=0.25)


def test_the_tree_halves_and_thirds_and_covers_all_frequencies():
    table = fast_kurtogram(noise(10), RATE, levels=4)
    assert sorted(set(np.round(2**table.level).astype(int))) == [1, 2, 3, 4, 6, 8, 12, 16]
    for level in np.unique(table.level):
        bands = table.bands_hz[table.level == level]
        assert bands[0, 0] == 0
        assert bands[-1, 1] == RATE / 2
        np.testing.assert_allclose(bands[1:, 0], bands[:-1, 1])


def test_a_bands_kurtosis_is_that_of_the_same_band_cut_out_by_an_ordinary_filter():
    samples = bursts(20, 1500, 2000)
    table = fast_kurtogram(samples, RATE, levels=4)
    row = row_of(table, 1500, 2000)
    band = signal.sosfiltfilt(signal.butter(6, [1500, 2000], "bandpass", fs=RATE, output="sos"), samples)
    power = np.abs(signal.hilbert(band)) ** 2
    direct = np.mean(power**2) / np.mean(power) ** 2 - 2
    assert direct > 3
    assert table.value[row] == pytest.approx(direct, rel=0.25)


def test_the_band_of_ringing_bumps_is_found_and_steady_noise_has_none():
    quiet = fast_kurtogram(noise(20, 9), RATE)
    assert kurtosis_band(quiet) is None
    choice = kurtosis_band(fast_kurtogram(bursts(20, 1500, 2000), RATE), quiet)
    assert choice is not None
    assert 1200 <= choice.band_hz[0] < choice.band_hz[1] <= 2300
    loud_but_steady = fast_kurtogram(30 * noise(20, 10), RATE)
    assert kurtosis_band(loud_but_steady, quiet) is None


def test_bumps_that_the_background_has_too_do_not_stand_out():
    both = fast_kurtogram(bursts(20, 1500, 2000, seed=1), RATE), fast_kurtogram(bursts(20, 1500, 2000, seed=2), RATE)
    alone = kurtosis_band(both[0])
    beside = kurtosis_band(*both)
    assert alone is not None
    assert beside is None or beside.excess < 0.5 * alone.excess


def test_in_blocks_the_kurtogram_is_the_mean_over_the_stretch(monkeypatch):
    samples = bursts(30, 1500, 2000)
    whole = fast_kurtogram(samples, RATE, levels=3)
    monkeypatch.setattr("processing.sound.kurtogram._BLOCK", 50_000)
    blocks = fast_kurtogram(samples, RATE, levels=3)
    np.testing.assert_allclose(blocks.value, whole.value, rtol=0.03, atol=0.02)


def test_the_kurtosis_from_levels_alone_is_that_of_the_envelope_itself():
    """Frames of 64 ms of a band of 500 Hz, its power rising tenfold for a while as past a leak."""
    rng = np.random.default_rng(4)
    gain = 1 + 9 / (1 + ((np.arange(4000) - 2000) / 150.0) ** 2)
    envelope = (rng.standard_normal((4000, 32)) + 1j * rng.standard_normal((4000, 32))) * np.sqrt(gain)[:, None]
    power = np.abs(envelope) ** 2
    direct = np.mean(power**2) / np.mean(power) ** 2 - 2
    found = kurtosis_of_levels(power.mean(axis=1)[:, None], np.array([32.0]))
    assert found[0] == pytest.approx(direct, rel=0.05)
    assert found[0] == pytest.approx(2 * np.mean(gain**2) / np.mean(gain) ** 2 - 2, rel=0.05)


def test_a_stretch_too_short_is_refused():
    with pytest.raises(ValueError, match="short"):
        fast_kurtogram(np.zeros(20), RATE)
    with pytest.raises(ValueError, match="short"):
        spectral_kurtosis(np.zeros(2000), RATE)


@settings(deadline=None)
@given(st.integers(1, 60), st.booleans())
def test_the_tree_over_measured_bands_lies_within_them_and_holds_each_band_alone(count, thirds):
    nodes = tree_of_bands(count, thirds=thirds)
    assert len(set(nodes)) == len(nodes)
    assert all(0 <= first < end <= count for first, end in nodes)
    assert {(k, k + 1) for k in range(count)} | {(0, count)} <= set(nodes)
