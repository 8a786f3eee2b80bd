from itertools import pairwise

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from processing.errors import ErrorCode, LeaklineError
from processing.sound import spectrum as module
from processing.sound.source import open_audio
from processing.sound.spectrum import around, compare, power_spectrum, speed_note, third_octaves

RATE = 8000


def recording(tmp_path, samples, rate=RATE):
    path = tmp_path / "sound.wav"
    soundfile.write(path, samples.astype(np.float32), rate, subtype="FLOAT")
    return open_audio([path])[0]


@pytest.mark.parametrize("average", ["mean", "median"])
@pytest.mark.parametrize("seconds", [3.0, 90.0])
def test_it_is_scipys_welch_on_the_scale_of_a_full_scale_sine(tmp_path, average, seconds):
    samples = np.random.default_rng(1).normal(0.0, 0.1, round(seconds * RATE)).astype(np.float32)
    audio = recording(tmp_path, samples)
    found = power_spectrum(audio, [(0.5, seconds - 0.5)], average=average)
    window = 2 * (len(found.frequency_hz) - 1)
    piece = samples[round(0.5 * RATE) : round((seconds - 0.5) * RATE)].astype(float)
    hz, density = signal.welch(piece, RATE, "hann", window, average=average, detrend="constant")
    assert found.frequency_hz == pytest.approx(hz)
    assert found.power == pytest.approx(2.0 * density, rel=2e-4)  # a full-scale sine has the power one half


def test_a_full_scale_sine_is_zero_decibels_in_the_band_that_holds_it(tmp_path):
    time_s = np.arange(20 * RATE) / RATE
    audio = recording(tmp_path, 0.1 * np.sin(2 * np.pi * 440.0 * time_s))
    found = power_spectrum(audio, [(0.0, 20.0)], average="mean")
    assert found.band_db(400.0, 480.0) == pytest.approx(-20.0, abs=0.01)
    assert found.band_db(1000.0, 3000.0) < -100.0


@pytest.mark.parametrize(("average", "seconds"), [("mean", 2.0), ("median", 2.0), ("mean", 20.0), ("median", 20.0)])
def test_the_interval_holds_the_true_density_in_95_of_100_cases(tmp_path, average, seconds):
    inside = []
    for seed in range(12):
        samples = np.random.default_rng(seed).normal(0.0, 0.1, round(seconds * RATE))
        audio = recording(tmp_path, samples)
        found = power_spectrum(audio, [(0.0, seconds)], average=average)
        truth = 2.0 * 0.1**2 / (RATE / 2)
        used = slice(3, -3)
        inside.append(np.mean((found.low95[used] <= truth) & (truth <= found.high95[used])))
    assert 0.92 <= np.mean(inside) <= 0.98


def test_the_interval_of_a_median_over_grouped_windows_holds_too(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "_MOST_ROWS", 64)
    inside, bias = [], []
    for seed in range(10):
        audio = recording(tmp_path, np.random.default_rng(seed).normal(0.0, 0.1, 60 * RATE))
        found = power_spectrum(audio, [(0.0, 60.0)])
        truth = 2.0 * 0.1**2 / (RATE / 2)
        inside.append(np.mean((found.low95[3:-3] <= truth) & (truth <= found.high95[3:-3])))
        bias.append(np.mean(found.power[3:-3]) / truth)
    assert np.mean(bias) == pytest.approx(1.0, abs=0.01)
    assert 0.90 <= np.mean(inside) <= 0.98


def test_the_median_passes_over_a_knock_that_the_mean_contains(tmp_path):
    samples = np.random.default_rng(5).normal(0.0, 0.01, 10 * RATE)
    samples[40_000:40_100] += 0.9
    audio = recording(tmp_path, samples)
    quiet = 10 * np.log10(2.0 * 0.01**2 / (RATE / 2))
    mean, median = (
        np.median(power_spectrum(audio, [(0.0, 10.0)], average=a).level_db[5:20]) for a in ("mean", "median")
    )
    assert median == pytest.approx(quiet, abs=0.6)
    assert mean > quiet + 6.0


def test_stretches_are_taken_together_and_never_across_the_gap(tmp_path):
    samples = np.concatenate([np.random.default_rng(k).normal(0, s, 4 * RATE) for k, s in enumerate((0.1, 0.9, 0.1))])
    found = power_spectrum(recording(tmp_path, samples), [(0.0, 4.0), (8.0, 12.0)], average="mean")
    assert np.mean(found.power) == pytest.approx(2.0 * 0.1**2 / (RATE / 2), rel=0.05)
    assert found.duration_s == 8.0


def test_a_short_stretch_gets_wider_bins_and_too_short_a_one_is_refused_with_a_sentence(tmp_path):
    audio = recording(tmp_path, np.random.default_rng(2).normal(0, 0.1, 5 * RATE))
    short, long = power_spectrum(audio, [(1.0, 1.2)]), power_spectrum(audio, [(0.0, 5.0)])
    assert short.windows >= 8
    assert short.bin_hz > long.bin_hz
    for spans in ([(1.0, 1.001)], [(9.0, 10.0)], []):
        with pytest.raises(LeaklineError) as caught:
            power_spectrum(audio, spans)
        assert caught.value.code is ErrorCode.TOO_FEW_SAMPLES


def test_an_unknown_average_is_a_mistake_of_ours(tmp_path):
    with pytest.raises(ValueError, match="average"):
        power_spectrum(recording(tmp_path, np.zeros(RATE)), [(0.0, 1.0)], average="mode")


def leak_like(rng, seconds, gain_db):
    """White noise with so much more between 1 and 2 kHz."""
    noise = rng.normal(0.0, 0.05, round(seconds * RATE))
    extra = signal.sosfilt(
        signal.butter(4, [1000, 2000], "bandpass", fs=RATE, output="sos"), rng.normal(0, 0.05, len(noise))
    )
    return noise + np.sqrt(10 ** (gain_db / 10) - 1) * extra


def test_the_bands_in_which_a_leak_stands_out_are_named_and_no_others(tmp_path):
    rng = np.random.default_rng(11)
    audio = recording(tmp_path, np.concatenate([leak_like(rng, 20, 6.0), leak_like(rng, 20, 0.0)]))
    a, b = power_spectrum(audio, [(0.0, 20.0)]), power_spectrum(audio, [(20.0, 40.0)])
    found = compare(a, b)
    named = [(band.low_hz * band.high_hz) ** 0.5 for band in found.bands if band.stands_out]
    assert named == pytest.approx([1000 * 2 ** (k / 3) for k in range(4)], rel=0.01)
    inner = next(band for band in found.bands if band.low_hz < 1400.0 < band.high_hz)
    assert inner.low95_db <= 6.0 <= inner.high95_db
    flat = (found.frequency_hz > 2600.0) & (found.frequency_hz < 3800.0)
    assert np.mean((found.low95_db[flat] <= 0.0) & (found.high95_db[flat] >= 0.0)) > 0.9


def test_of_two_stretches_of_the_same_sound_no_band_stands_out(tmp_path):
    false = 0
    for seed in range(20):
        audio = recording(tmp_path, np.random.default_rng(seed).normal(0, 0.1, 4 * RATE))
        found = compare(power_spectrum(audio, [(0.0, 2.0)]), power_spectrum(audio, [(2.0, 4.0)]))
        false += any(band.stands_out for band in found.bands)
    assert false <= 3  # one in twenty is the bargain


def test_with_the_loudness_taken_off_a_louder_copy_is_the_same_sound(tmp_path):
    samples = leak_like(np.random.default_rng(3), 10, 0.0)
    audio = recording(tmp_path, np.concatenate([3.0 * samples, samples]))
    a, b = power_spectrum(audio, [(0.0, 10.0)]), power_spectrum(audio, [(10.0, 20.0)])
    assert all(band.stands_out for band in compare(a, b).bands)
    found = compare(a, b, same_loudness=True)
    assert found.louder_db == pytest.approx(20 * np.log10(3.0), abs=0.05)
    assert np.abs(found.difference_db[2:]).max() < 0.2
    assert not any(band.stands_out for band in found.bands)


def test_spectra_of_short_and_long_stretches_can_be_compared(tmp_path):
    audio = recording(tmp_path, np.random.default_rng(7).normal(0, 0.1, 30 * RATE))
    short, long = power_spectrum(audio, [(0.0, 0.2)]), power_spectrum(audio, [(1.0, 30.0)])
    for one, other in ((short, long), (long, short)):
        found = compare(one, other)
        assert len(found.difference_db) == len(short.frequency_hz)
        inside = (found.low95_db[2:-2] <= 0.0) & (found.high95_db[2:-2] >= 0.0)
        assert inside.mean() > 0.85


@settings(max_examples=60, deadline=None)
@given(st.floats(0.0, 1000.0), st.floats(0.01, 300.0), st.floats(0.0, 50.0))
def test_what_lies_around_a_stretch_never_touches_it_and_stays_within(start, length, away):
    end = start + length
    spans = around(start, end, (-5.0, 1500.0), away=away)
    for low, high in spans:
        assert -5.0 <= low < high <= 1500.0
        assert high <= start or low >= end
    assert sum(high - low for low, high in spans) <= 3.0 * length + 1e-6


def test_the_note_on_speeds_follows_the_cube_and_is_silent_where_they_are_alike():
    assert speed_note(1.0, 0.5).explained_db == pytest.approx(9.03, abs=0.01)
    assert speed_note(0.5, 1.0).explained_db == pytest.approx(-9.03, abs=0.01)
    for alike in ((1.0, 1.1), (0.0, 1.0), (float("nan"), 1.0)):
        assert speed_note(*alike) is None


def test_thirds_of_an_octave_follow_each_other_without_a_gap_and_hold_one_kilohertz():
    edges = third_octaves(24_000.0)
    assert all(a[1] == pytest.approx(b[0]) for a, b in pairwise(edges))
    assert any(low < 1000.0 < high and (low * high) ** 0.5 == pytest.approx(1000.0) for low, high in edges)
    assert edges[-1][1] <= 0.95 * 24_000.0
