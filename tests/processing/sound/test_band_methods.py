"""The map of bands of a stretch of a file against what lies around it."""

import numpy as np
import pytest
import soundfile
from scipy import signal

from processing.errors import ErrorCode, LeaklineError
from processing.sound.band_methods import BAND_METHODS, LONGEST_S, band_map
from processing.sound.source import open_audio

RATE = 16000


@pytest.fixture
def audio(tmp_path):
    """Two minutes of noise; from 50 to 60 s a hiss from 1 to 2 kHz, from 80 to 90 s bumps that ring at 4.5 kHz."""
    rng = np.random.default_rng(1)
    samples = 0.02 * rng.standard_normal(120 * RATE)
    other = 0.02 * rng.standard_normal(10 * RATE)
    hiss = signal.sosfilt(signal.butter(4, [1000, 2000], "bandpass", fs=RATE, output="sos"), other)
    samples[50 * RATE : 60 * RATE] += 4.0 * hiss
    ring = np.exp(-np.arange(400) / 60.0) * np.sin(2 * np.pi * 4500 * np.arange(400) / RATE)
    for at in np.arange(80.2, 90.0, 0.7):
        samples[int(at * RATE) : int(at * RATE) + 400] += 0.3 * ring
    path = tmp_path / "sound.wav"
    soundfile.write(path, np.clip(samples, -1, 1), RATE)
    return open_audio([path])[0]


AROUND_HISS, AROUND_BUMPS = ((35.0, 49.0), (61.0, 75.0)), ((65.0, 79.0), (91.0, 105.0))


def test_the_band_of_a_hiss_is_told_by_energy_and_not_by_bursts(audio):
    found = band_map("energy", audio, (51.0, 59.0), AROUND_HISS)
    assert found.choice is not None
    assert 900 < found.choice.band_hz[0] < found.choice.band_hz[1] < 2200
    assert found.choice.excess > 6
    assert found.seconds == pytest.approx(8.0)
    assert found.background_s == pytest.approx(28.0)
    assert band_map("kurtogram", audio, (51.0, 59.0), AROUND_HISS).choice is None


@pytest.mark.parametrize("method", ["kurtogram", "kurtosis", "entropy"])
def test_the_band_of_bumps_is_told_by_bursts(audio, method):
    choice = band_map(method, audio, (80.0, 90.0), AROUND_BUMPS).choice
    assert choice is not None
    assert choice.band_hz[0] <= 4500 <= choice.band_hz[1]
    assert choice.band_hz[1] - choice.band_hz[0] <= 2000


@pytest.mark.parametrize("method", BAND_METHODS)
def test_each_map_covers_all_frequencies_in_each_row_once(audio, method):
    found = band_map(method, audio, (20.0, 25.0), ((10.0, 19.0), (26.0, 35.0)))
    assert found.choice is None  # nothing is there but noise
    for row in np.unique(found.row):
        bands = found.bands_hz[found.row == row]
        assert (bands[0, 0], bands[-1, 1]) == (0.0, RATE / 2)
        np.testing.assert_allclose(bands[1:, 0], bands[:-1, 1])
    assert np.isfinite(found.value).all()


def test_of_a_long_stretch_the_middle_minute_is_taken(audio):
    found = band_map("energy", audio, (5.0, 115.0), ((0.0, 5.0),))
    assert found.seconds == pytest.approx(LONGEST_S)


def test_a_stretch_too_short_or_without_surroundings_is_refused(audio):
    for span, background in (((50.0, 50.1), AROUND_HISS), ((50.0, 60.0), ()), ((500.0, 510.0), AROUND_HISS)):
        with pytest.raises(LeaklineError) as caught:
            band_map("energy", audio, span, background)
        assert caught.value.code is ErrorCode.TOO_FEW_SAMPLES
