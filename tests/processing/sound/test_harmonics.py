"""The spectrum of a stretch: families of harmonics with known speeds, and a leak that has none."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from processing.sound.harmonics import find_harmonics, spectrum

RATE = 12000.0


def noise(seconds, seed):
    return np.random.default_rng(seed).standard_normal(int(seconds * RATE)) * 0.01


def comb(seconds, fundamental, amplitudes, seed=0):
    time = np.arange(int(seconds * RATE)) / RATE
    phase = np.random.default_rng(seed).uniform(0, 6, len(amplitudes))
    parts = (a * np.sin(2 * np.pi * fundamental * k * time + phase[k - 1]) for k, a in enumerate(amplitudes, 1))
    return sum(parts, np.zeros(len(time)))


def test_a_full_scale_sine_reads_0_dbfs_and_noise_its_density():
    time = np.arange(int(20 * RATE)) / RATE
    found = spectrum(np.sin(2 * np.pi * 1500.0 * time), RATE)
    assert found.level_db.max() == pytest.approx(0.0, abs=0.1)
    hiss = spectrum(noise(60, 1), RATE)
    power = 10 ** (hiss.level_db / 10) / 2 / 1.5  # a bin of a Hann window is one and a half wide
    assert power.sum() == pytest.approx(1e-4, rel=0.02)
    assert np.median(hiss.floor_db - 10 * np.log10(2 * 1.5 * 1e-4 / len(power))) == pytest.approx(0.0, abs=0.1)


def test_a_pumps_speed_is_found_with_its_harmonics_and_their_levels():
    amplitudes = [0.02 / k for k in range(1, 16)]
    found = find_harmonics(noise(30, 2) + comb(30, 49.37, amplitudes), RATE, noise(30, 3))
    assert len(found.families) == 1
    family = found.families[0]
    assert family.fundamental_hz == pytest.approx(49.37, abs=max(4 * family.sigma_hz, 0.02))
    assert family.sigma_hz < 0.1
    assert [h.number for h in family.harmonics][:8] == list(range(1, 9))
    for harmonic in family.harmonics[:5]:
        # between two bins of a Hann window a line loses up to 1.4 dB
        assert harmonic.level_db == pytest.approx(20 * np.log10(amplitudes[harmonic.number - 1]), abs=1.6)
    assert family.over_background_db > 15
    assert abs(found.floor_rise_db) < 0.5


def test_two_machines_are_two_families():
    both = comb(30, 24.6, [0.01] * 8) + comb(30, 61.3, [0.02] * 10, seed=1)
    found = find_harmonics(noise(30, 4) + both, RATE)
    speeds = sorted(family.fundamental_hz for family in found.families)
    assert speeds == pytest.approx([24.6, 61.3], abs=0.05)
    assert np.isnan(found.floor_rise_db)


def test_a_family_without_its_first_line_is_not_taken_for_its_octave():
    found = find_harmonics(noise(30, 5) + comb(30, 40.2, [0.0, 0.02, 0.02, 0.02, 0.02, 0.02]), RATE)
    assert found.families[0].fundamental_hz == pytest.approx(40.2, abs=0.05)
    assert [h.number for h in found.families[0].harmonics] == [2, 3, 4, 5, 6]


@settings(deadline=None, max_examples=8)
@given(st.floats(12.0, 300.0), st.integers(4, 12), st.integers(0, 50))
def test_any_speed_is_found_within_its_own_doubt(fundamental, count, seed):
    found = find_harmonics(noise(20, seed) + comb(20, fundamental, [0.02] * count, seed), RATE)
    family = found.families[0]
    assert family.fundamental_hz == pytest.approx(fundamental, abs=5 * family.sigma_hz + 0.01)


def test_a_leak_raises_the_floor_and_has_no_harmonics():
    band = signal.butter(2, [600, 2400], "bandpass", fs=RATE, output="sos")
    leak = noise(30, 6) + 4 * signal.sosfilt(band, noise(30, 7))
    found = find_harmonics(leak, RATE, noise(30, 8))
    assert found.families == ()
    assert found.floor_rise_db > 3


@pytest.mark.parametrize("seed", range(5))
def test_many_lines_at_random_are_no_family(seed):
    rng, time = np.random.default_rng(seed), np.arange(int(20 * RATE)) / RATE
    lines = sum((0.01 * np.sin(2 * np.pi * hz * time) for hz in rng.uniform(100.0, 5900.0, 150)), np.zeros(len(time)))
    assert len(find_harmonics(noise(20, seed) + lines, RATE).families) <= 1


def test_what_always_runs_does_not_stand_over_the_background():
    pump = [0.02] * 8
    found = find_harmonics(noise(30, 9) + comb(30, 33.0, pump), RATE, noise(30, 10) + comb(30, 33.0, pump, seed=3))
    assert abs(found.families[0].over_background_db) < 2


def test_a_stretch_too_short_is_refused():
    with pytest.raises(ValueError, match="short"):
        find_harmonics(np.zeros(100), RATE)
