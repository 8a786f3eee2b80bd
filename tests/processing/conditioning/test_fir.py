"""The FIR by frequency sampling: its response at the samples, its phase, its ends, its holes, its sigma."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.conditioning.channel import readings
from processing.conditioning.fir import Ends, convolve, end_inflation, fir, low_pass_taps, taps_from_samples
from processing.conditioning.noise import Noise
from processing.conditioning.settings import ConditioningSettings
from processing.errors import ErrorCode, LeaklineError

SETTINGS = ConditioningSettings(noise_sigma=1.0, wander_sigma=0.1, cutoff_hz=1.0, transition_hz=1.0)


def response(taps, frequency):
    """H at ``frequency`` (cycles a sample), straight from the definition."""
    return np.exp(-2j * np.pi * np.outer(frequency, np.arange(len(taps)))) @ taps


@settings(deadline=None)
@given(st.lists(st.floats(-2.0, 2.0), min_size=1, max_size=40))
def test_the_response_at_the_sampled_frequencies_is_what_was_asked_for(amplitudes):
    taps = taps_from_samples(np.array(amplitudes))
    frequency = np.arange(len(amplitudes)) / len(taps)
    delay = np.exp(-2j * np.pi * frequency * (len(taps) // 2))
    np.testing.assert_allclose(response(taps, frequency), np.array(amplitudes) * delay, atol=1e-12)


def test_the_phase_is_linear_everywhere_between_the_samples():
    taps = low_pass_taps(50.0, SETTINGS)
    np.testing.assert_allclose(taps, taps[::-1], atol=1e-16)
    frequency = np.linspace(0.0, 0.5, 1001)
    zero_phase = response(taps, frequency) * np.exp(2j * np.pi * frequency * (len(taps) // 2))
    np.testing.assert_allclose(zero_phase.imag, 0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("rate", "cutoff", "width"), [(50, 1.0, 1.0), (200, 0.5, 0.5), (10, 0.5, 0.37), (47, 3.3, 1.1)]
)
def test_the_stop_band_is_45_db_down_and_the_pass_band_true_to_half_a_percent(rate, cutoff, width):
    taps = low_pass_taps(rate, ConditioningSettings(cutoff_hz=cutoff, transition_hz=width))
    frequency_hz = np.linspace(0.0, rate / 2, 4001)
    size = np.abs(response(taps, frequency_hz / rate))
    assert 20.0 * np.log10(size[frequency_hz > cutoff + width].max()) < -45.0
    assert np.abs(size[frequency_hz < cutoff] - 1.0).max() < 0.005
    assert taps.sum() == pytest.approx(1.0)


@settings(deadline=None)
@given(st.integers(300, 700), st.floats(0.4, 3.0))
def test_a_filtered_peak_does_not_move(row, width_s):
    bump = np.exp(-0.5 * ((np.arange(1000) - row) / 50.0 / width_s) ** 2)
    assert np.argmax(fir(bump, 50.0, SETTINGS).values) == row


@settings(deadline=None)
@given(st.floats(-100.0, 100.0), st.floats(-1e5, 1e5))
def test_a_ramp_stays_a_ramp_up_to_both_ends(slope, level):
    ramp = level + slope * np.arange(300) / 50.0
    np.testing.assert_allclose(convolve(ramp, low_pass_taps(50.0, SETTINGS)), ramp, atol=1e-6)


def test_the_weights_at_the_ends_say_what_the_filter_does_there():
    values, taps = np.random.default_rng(0).standard_normal(300), low_pass_taps(50.0, SETTINGS)
    out, ends = convolve(values, taps), Ends.of(len(taps) // 2)
    for back in (0, 1, 30, len(taps) // 2):
        weights = ends.weights(taps, back)
        assert out[-1 - back] == pytest.approx(weights @ values[-len(taps) :])
        assert out[back] == pytest.approx(weights @ values[len(taps) - 1 :: -1])


def test_an_end_is_not_the_last_reading_with_all_its_noise():
    taps, noise = low_pass_taps(50.0, SETTINGS), Noise(0.0, 1.0)
    inflation = end_inflation(taps, noise, 1000)
    assert inflation[500] == 1.0
    rng = np.random.default_rng(1)
    last = [convolve(rng.standard_normal(300), taps)[-1] for _ in range(2000)]
    assert np.var(last) == pytest.approx(inflation[-1] * float(taps @ taps), rel=0.1)
    assert np.var(last) < 0.2


def test_a_hole_is_bridged_and_no_nan_spreads():
    values = 5.0 + 0.1 * np.random.default_rng(2).standard_normal(2000)
    valid = np.ones(2000, dtype=bool)
    valid[900:1000] = False
    values[900:1000] = np.nan
    values[0] = np.inf
    out = fir(values, 50.0, ConditioningSettings(noise_sigma=0.1, wander_sigma=0.05), valid)
    assert np.isfinite(out.values).all()
    assert np.isfinite(out.sigma).all()
    assert np.abs(out.values - 5.0).max() < 0.2
    assert out.sigma[950] > 2.0 * out.sigma[500]


def test_what_stands_in_an_invalid_row_has_no_influence():
    values = np.random.default_rng(3).standard_normal(500)
    valid = np.arange(500) % 7 != 3
    wild = np.where(valid, values, 1e30)
    np.testing.assert_array_equal(fir(values, 50.0, SETTINGS, valid).values, fir(wild, 50.0, SETTINGS, valid).values)


def test_a_filter_that_the_rate_does_not_allow_is_refused_with_its_name():
    for refused in (ConditioningSettings(cutoff_hz=30.0), ConditioningSettings(transition_hz=1e-4)):
        with pytest.raises(LeaklineError) as caught:
            low_pass_taps(50.0, refused)
        assert caught.value.code is ErrorCode.SETTING_INVALID


def test_a_record_shorter_than_half_the_filter_is_refused():
    with pytest.raises(LeaklineError) as caught:
        fir(readings(np.arange(20.0), 50.0).values, 50.0, SETTINGS)
    assert caught.value.code is ErrorCode.TOO_FEW_SAMPLES
