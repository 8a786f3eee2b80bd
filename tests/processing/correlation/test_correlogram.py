"""Correlation and peaks agree with scipy; chance is as rare as it says; a peak that is taken out is gone."""

import numpy as np
import pytest
from correlator_runs import source_of
from scipy import signal

from processing.correlation.correlogram import Dispersion, Suppressed, correlate, peaks, suppression, without
from processing.correlation.reading import measure
from processing.correlation.recordings import Pair
from processing.correlation.weighting import Band, Weighting, auto_band, band_gain, hum_lines, weights
from processing.progress import silent

RATE = 4000
SECONDS = 30


def noise(seed, seconds=SECONDS):
    return np.random.default_rng(seed).standard_normal(seconds * RATE)


def delayed(samples, seconds):
    lines = np.fft.rfft(samples)
    return np.fft.irfft(lines * np.exp(-2j * np.pi * np.fft.rfftfreq(len(samples), 1 / RATE) * seconds), len(samples))


def spectra_of(folder, a, b, segment_s=1.0):
    scale = 0.1 / max(np.std(a), np.std(b))
    pair = Pair(source_of(folder / "a.wav", scale * a, RATE), source_of(folder / "b.wav", scale * b, RATE))
    return measure(pair, segment_s, silent())


def top_of(spectra, weighting, band, longest_s=0.3, cross=None):
    weight = weights(spectra, weighting, band)
    gram = correlate(spectra, spectra.s_ab if cross is None else cross, weight, longest_s)
    return peaks(gram)[0]


def test_the_plain_correlation_is_that_of_scipy(tmp_path):
    """Against scipy.signal.correlate of the zero-phase band-passed recordings themselves."""
    shared = noise(1)
    a, b = shared + noise(2), delayed(shared, 0.0513) + noise(3)
    band = Band(100.0, 600.0, without_hum=False)
    spectra = spectra_of(tmp_path, a, b, 2.0)
    lines = np.sqrt(band_gain(np.fft.rfftfreq(len(a), 1 / RATE), band))
    passed = [np.fft.irfft(np.fft.rfft(x) * lines, len(a)) for x in (a, b)]
    direct = signal.correlate(passed[1], passed[0], mode="full", method="fft")
    direct /= np.sqrt(np.sum(passed[0] ** 2) * np.sum(passed[1] ** 2))
    lags = signal.correlation_lags(len(a), len(a)) / RATE
    gram = correlate(spectra, spectra.s_ab, weights(spectra, Weighting.NONE, band), 0.2, classical=True)
    near = (lags >= -0.15) & (lags <= 0.15)
    ours = np.interp(lags[near], gram.delay_s, gram.value)
    assert np.corrcoef(ours, direct[near])[0, 1] > 0.99
    assert peaks(gram)[0].height == pytest.approx(direct[near].max(), abs=0.03)
    assert peaks(gram)[0].delay_s == pytest.approx(lags[near][np.argmax(direct[near])], abs=0.5 / RATE)


def test_the_correlation_of_scipys_own_cross_spectrum_is_the_same_to_rounding(tmp_path):
    """A direct computation: inverse transform of scipy.signal.csd over signal.coherence, PHAT by its definition."""
    shared = noise(1)
    a, b = 0.05 * (shared + noise(2)), 0.05 * (np.roll(shared, 150) + noise(3))
    pair = Pair(source_of(tmp_path / "a.wav", a, RATE), source_of(tmp_path / "b.wav", b, RATE))
    spectra = measure(pair, 1.0, silent())
    _, cross = signal.csd(a, b, RATE, "hann", RATE, RATE // 2)
    gain = band_gain(np.arange(RATE // 2 + 1.0), Band(50.0, 1900.0))
    direct = np.fft.irfft(cross / np.abs(cross) * gain)
    weight = weights(spectra, Weighting.PHAT, Band(50.0, 1900.0, without_hum=False))
    gram = correlate(spectra, spectra.s_ab, weight, 0.2)
    lags = np.arange(-400, 401)
    ours = np.interp(lags / RATE, gram.delay_s, gram.value)
    theirs = direct[lags % RATE]
    np.testing.assert_allclose(ours / ours.max(), theirs / theirs.max(), atol=5e-3)
    assert lags[np.argmax(theirs)] == 150


@pytest.mark.parametrize("weighting", list(Weighting))
@pytest.mark.parametrize("polarity", [1, -1])
def test_every_weighting_finds_delay_and_polarity(tmp_path, weighting, polarity):
    shared = noise(1)
    spectra = spectra_of(tmp_path, shared + noise(2), polarity * delayed(shared, -0.07142) + noise(3))
    top = top_of(spectra, weighting, Band(50.0, 1500.0))
    assert top.delay_s == pytest.approx(-0.07142, abs=2e-5)
    assert top.polarity == polarity
    assert top.probability < 1e-6


def test_unrelated_recordings_have_no_significant_peak(tmp_path):
    rare = []
    for seed in range(9):
        spectra = spectra_of(tmp_path, noise(100 + seed, 12), noise(200 + seed, 12), 0.5)
        rare.append(top_of(spectra, Weighting.SCOT, Band(50.0, 1500.0), 0.1).probability)
    assert min(rare) > 0.005
    assert 0.2 < np.median(rare) < 0.8


def test_a_source_without_noise_has_height_one(tmp_path):
    shared = noise(1)
    spectra = spectra_of(tmp_path, shared, delayed(shared, 0.01))
    for weighting in Weighting:
        assert top_of(spectra, weighting, Band(50.0, 1500.0)).height == pytest.approx(1.0, abs=0.04)


def test_dispersion_is_brought_back_together(tmp_path):
    """A delay that shrinks with frequency smears the peak; over the effective frequency it is sharp again."""
    shared = noise(1)
    frequency = np.fft.rfftfreq(len(shared), 1 / RATE)
    bend = Dispersion(0.03, 200.0)
    turned = np.fft.rfft(shared) * np.exp(-2j * np.pi * bend.effective_hz(frequency) * 0.12)
    spectra = spectra_of(tmp_path, shared, np.fft.irfft(turned, len(shared)), 2.0)
    weight = weights(spectra, Weighting.SCOT, Band(30.0, 1000.0))
    smeared = peaks(correlate(spectra, spectra.s_ab, weight, 0.2))[0]
    sharp = peaks(correlate(spectra, spectra.s_ab, weight, 0.2, bend))[0]
    assert sharp.delay_s == pytest.approx(0.12, abs=5e-5)
    assert abs(smeared.delay_s - 0.12) > 1e-3
    assert sharp.height > 1.5 * abs(smeared.height)


def test_a_peak_that_is_taken_out_leaves_the_next_where_it_is(tmp_path):
    first, second = noise(1), 0.6 * noise(2)
    a, b = first + second + noise(3), delayed(first, 0.05) + delayed(second, -0.12) + noise(4)
    spectra = spectra_of(tmp_path, a, b)
    band = Band(50.0, 1500.0)
    weight = weights(spectra, Weighting.MAXIMUM_LIKELIHOOD, band)
    gram = correlate(spectra, spectra.s_ab, weight, 0.3)
    loudest = peaks(gram)[0]
    assert loudest.delay_s == pytest.approx(0.05, abs=1e-4)
    left = without(spectra, [suppression(gram, loudest, "pump")])
    again = peaks(correlate(spectra, left, weight, 0.3))[0]
    assert again.delay_s == pytest.approx(-0.12, abs=1e-4)
    assert abs(correlate(spectra, left, weight, 0.3).at(0.05)) < 0.05 * loudest.height


def test_nothing_taken_out_changes_nothing(tmp_path):
    spectra = spectra_of(tmp_path, noise(1), noise(2))
    np.testing.assert_array_equal(without(spectra, []), spectra.s_ab)
    far = without(spectra, [Suppressed(0.4, 0.001)])
    gram = correlate(spectra, far, weights(spectra, Weighting.NONE, Band(50.0, 1500.0)), 0.2)
    same = correlate(spectra, spectra.s_ab, weights(spectra, Weighting.NONE, Band(50.0, 1500.0)), 0.2)
    np.testing.assert_allclose(gram.value, same.value, atol=2e-3)


# --- band and hum ---


def test_the_band_is_where_the_recordings_agree(tmp_path):
    shared = signal.sosfiltfilt(signal.butter(6, [200, 500], "bandpass", fs=RATE, output="sos"), noise(1))
    spectra = spectra_of(tmp_path, 3 * shared + 0.3 * noise(2), 3 * delayed(shared, 0.02) + 0.3 * noise(3))
    band = auto_band(spectra)
    assert band.low_hz == pytest.approx(180, abs=60)
    assert band.high_hz == pytest.approx(520, abs=90)


def test_there_is_no_band_where_nothing_agrees(tmp_path):
    assert auto_band(spectra_of(tmp_path, noise(1), noise(2))) is None


def test_hum_in_both_recordings_does_not_become_the_leak(tmp_path):
    shared, time_s = noise(1), np.arange(SECONDS * RATE) / RATE
    hum = 8.0 * sum(np.sin(2 * np.pi * 50 * k * time_s) for k in range(1, 7))
    spectra = spectra_of(tmp_path, shared + 2 * noise(2) + hum, delayed(shared, 0.0853) + 2 * noise(3) + hum)
    mask = hum_lines(spectra)
    for k in range(1, 7):
        assert mask[np.argmin(np.abs(spectra.frequency_hz - 50 * k))]
    assert mask.mean() < 0.1
    assert top_of(spectra, Weighting.NONE, Band(30.0, 800.0)).delay_s == pytest.approx(0.0853, abs=1e-4)
    with_hum = top_of(spectra, Weighting.NONE, Band(30.0, 800.0, without_hum=False))
    assert abs(with_hum.delay_s - 0.0853) > 1e-3
