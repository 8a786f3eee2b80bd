"""Wavelet packets: published filters, energy kept, frequencies in order, and the band in which a stretch stands out."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal, stats

from processing.sound.wavelet_packets import daubechies, packet_band, split, wavelet_packets

RATE = 16000.0
# I. Daubechies, Ten Lectures on Wavelets, table 6.1: N = 2 (closed form) and N = 4
DB4 = (
    0.2303778133088964, 0.7148465705529154, 0.6308807679298587, -0.0279837694168599,
    -0.1870348117190931, 0.0308413818355607, 0.0328830116668852, -0.0105974017850690,
)  # fmt: skip


def noise(seconds, seed):
    return np.random.default_rng(seed).standard_normal(int(seconds * RATE))


def hiss(seconds, low, high, level, seed):
    """Background noise of power 1, and a steady hiss in one band."""
    band = signal.sosfilt(signal.butter(4, [low, high], "bandpass", fs=RATE, output="sos"), noise(seconds, seed + 50))
    return noise(seconds, seed) + level * band


def test_the_filters_are_the_published_ones():
    root = np.sqrt(3.0)
    two = np.array([1 + root, 3 + root, 3 - root, 1 - root]) / (4 * np.sqrt(2))
    np.testing.assert_allclose(daubechies(1), np.full(2, np.sqrt(0.5)), atol=1e-14)
    np.testing.assert_allclose(daubechies(2), two, atol=1e-12)
    np.testing.assert_allclose(daubechies(4), DB4, atol=1e-12)


@pytest.mark.parametrize("moments", range(1, 13))
def test_every_filter_is_orthogonal_to_its_even_shifts_and_has_its_vanishing_moments(moments):
    taps = np.array(daubechies(moments))
    for shift in range(moments):
        assert taps[2 * shift :] @ taps[: len(taps) - 2 * shift] == pytest.approx(float(shift == 0), abs=1e-7)
    high = taps * (-1.0) ** np.arange(len(taps))
    places = np.arange(len(taps)) / len(taps)
    for power in range(min(moments, 5)):
        assert high @ places**power == pytest.approx(0.0, abs=1e-6)


@settings(deadline=None)
@given(st.integers(1, 10), st.integers(3, 40), st.integers(0, 99))
def test_a_split_keeps_the_energy_to_the_last_digits(moments, halves, seed):
    nodes = np.random.default_rng(seed).standard_normal((3, 2 * halves))
    out = split(nodes, np.array(daubechies(moments)))
    assert out.shape == (6, halves)
    np.testing.assert_allclose((out**2).sum(), (nodes**2).sum(), rtol=1e-6)


@settings(deadline=None, max_examples=25)
@given(st.floats(150.0, 7800.0))
def test_a_tone_lies_in_the_node_that_claims_its_frequency(frequency):
    time = np.arange(1 << 14) / RATE
    found = wavelet_packets(np.sin(2 * np.pi * frequency * time), RATE, levels=4, moments=10)
    deepest = found.level == 4
    power, bands = found.power[deepest], found.bands_hz[deepest]
    off = np.maximum(bands[:, 0] - frequency, frequency - bands[:, 1])
    assert off[np.argmax(power)] < 20  # a filter of 20 taps has flanks
    assert power[off < 500].sum() > 0.75 * power.sum()  # near the edge of an octave its images reach further
    assert power.mean() == pytest.approx(0.5, rel=0.01)


def test_levels_agree_on_the_power_and_white_noise_has_the_same_in_all_nodes():
    found = wavelet_packets(2 * noise(20, 1), RATE)
    for level in range(1, 7):
        assert found.power[found.level == level].mean() == pytest.approx(4.0, rel=0.02)
    np.testing.assert_allclose(found.power, 4.0, rtol=0.12)


def test_blocks_change_nothing_but_the_ends(monkeypatch):
    samples = hiss(12, 1000, 2000, 3, 2)
    whole = wavelet_packets(samples, RATE)
    monkeypatch.setattr("processing.sound.wavelet_packets._BLOCK", 1 << 15)
    parts = wavelet_packets(samples, RATE)
    np.testing.assert_allclose(parts.power, whole.power, rtol=0.03)
    np.testing.assert_allclose(parts.entropy, whole.entropy, atol=0.005)


def test_kurtosis_is_scipys_of_the_coefficients():
    samples = noise(4, 3) ** 3
    found = wavelet_packets(samples, RATE, levels=1)
    nodes = split((samples - samples.mean())[None, :], np.array(daubechies(8)))
    np.testing.assert_allclose(found.kurtosis, stats.kurtosis(nodes, axis=1), rtol=0.01)


def test_a_steady_hiss_stands_out_by_energy_in_its_band_and_not_by_bursts():
    quiet, leak = wavelet_packets(noise(10, 4), RATE), wavelet_packets(hiss(10, 1000, 2000, 3, 5), RATE)
    choice = packet_band(leak, quiet)
    assert choice is not None
    assert choice.band_hz == (1000.0, 2000.0)
    assert choice.excess == pytest.approx(10.0, abs=0.8)  # 9 of hiss on 1 of noise
    assert packet_band(leak, quiet, "kurtosis") is None
    assert packet_band(leak, quiet, "entropy") is None


def test_over_a_steep_background_a_wide_band_does_not_win_by_its_width():
    """Flow noise falls by 12 dB an octave: of 0 to 4 kHz only the lowest part would be heard."""
    red = signal.butter(2, 300, fs=RATE, output="sos")
    quiet, leak = (signal.sosfilt(red, 30 * noise(10, seed)) + 0.1 * noise(10, seed + 9) for seed in (11, 12))
    band = signal.sosfilt(signal.butter(4, [1000, 2000], "bandpass", fs=RATE, output="sos"), noise(10, 13))
    choice = packet_band(wavelet_packets(leak + 2 * band, RATE), wavelet_packets(quiet, RATE))
    assert choice is not None
    assert choice.band_hz[0] >= 1000
    assert choice.band_hz[1] <= 2125


@pytest.mark.parametrize("criterion", ["kurtosis", "entropy"])
def test_bumps_stand_out_by_kurtosis_and_by_entropy_in_their_band(criterion):
    quiet = wavelet_packets(noise(10, 6), RATE)
    gate = (np.arange(int(10 * RATE)) % 8000 < 160).astype(float)
    band = signal.sosfilt(signal.butter(4, [4000, 5000], "bandpass", fs=RATE, output="sos"), noise(10, 7))
    choice = packet_band(wavelet_packets(noise(10, 8) + 10 * gate * band, RATE), quiet, criterion)
    assert choice is not None
    assert 3500 <= choice.band_hz[0] < choice.band_hz[1] <= 5500


@pytest.mark.parametrize("criterion", ["energy", "kurtosis", "entropy"])
def test_two_stretches_of_the_same_noise_do_not_stand_out_of_one_another(criterion):
    for seed in range(10, 15):
        first, second = (wavelet_packets(noise(5, 2 * seed + k), RATE) for k in (0, 1))
        assert packet_band(first, second, criterion) is None


def test_what_cannot_be_compared_is_refused():
    first, second = wavelet_packets(noise(2, 1), RATE), wavelet_packets(noise(2, 1), RATE / 2)
    with pytest.raises(ValueError, match="other bands"):
        packet_band(first, second)
    with pytest.raises(ValueError, match="criterion"):
        packet_band(first, first, "loudness")
    with pytest.raises(ValueError, match="short"):
        wavelet_packets(np.zeros(100), RATE)
    with pytest.raises(ValueError, match="moments"):
        daubechies(13)
