"""The level meter against closed forms, however the stream was cut into blocks."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.live.levels import CLIP_S, FLOOR_DB, HOLD_S, LevelMeter

RATE_HZ = 48_000
FULL = 2**31


def sine(amplitude, seconds=1.0, hz=997.0, rate_hz=RATE_HZ):
    time_s = np.arange(round(seconds * rate_hz)) / rate_hz
    return as_frames(amplitude * np.sin(2 * np.pi * hz * time_s))


def as_frames(sound):
    sound = np.atleast_2d(sound).T if np.ndim(sound) == 1 else np.asarray(sound)
    return np.clip(np.rint(sound * FULL), -FULL, FULL - 1).astype(np.int32)


def fed(frames, rate_hz=RATE_HZ, block=4_800):
    meter = LevelMeter(rate_hz, frames.shape[1])
    for start in range(0, len(frames), block):
        meter.add(frames[start : start + block])
    return meter


@pytest.mark.parametrize("rate_hz", [8_000, 44_100, 48_000, 96_000, 192_000])
def test_a_sine_has_the_rms_of_a_sine_and_the_peak_of_its_amplitude(rate_hz):
    levels = fed(sine(0.5, hz=1_000.0, rate_hz=rate_hz), rate_hz).levels()
    assert levels.rms_db[0] == pytest.approx(20 * np.log10(0.5) - 3.0103, abs=0.01)
    assert levels.peak_db[0] == pytest.approx(20 * np.log10(0.5), abs=0.35)  # 8 kHz meets the top only nearly


def test_channels_are_measured_apart():
    both = np.hstack([sine(0.5), sine(0.05)])
    levels = fed(both).levels()
    assert levels.rms_db[0] - levels.rms_db[1] == pytest.approx(20.0, abs=0.01)


def test_noise_of_known_power_has_that_level():
    noise = np.random.default_rng(3).normal(0.0, 0.01, RATE_HZ)
    assert fed(as_frames(noise)).levels().rms_db[0] == pytest.approx(-40.0, abs=0.2)


def test_rms_forgets_what_is_older_than_its_window():
    frames = np.vstack([sine(0.5), as_frames(np.zeros(RATE_HZ))[: round(0.3 * RATE_HZ)]])
    assert fed(frames).levels().rms_db == (FLOOR_DB,)


def test_half_a_window_of_silence_takes_three_decibels():
    frames = np.vstack([sine(0.5, hz=1_000.0), np.zeros((round(0.15 * RATE_HZ), 1), np.int32)])
    assert fed(frames).levels().rms_db[0] == pytest.approx(-6.0206 - 3.0103 - 3.0103, abs=0.01)


def test_a_held_peak_stands_for_two_seconds_and_then_falls_by_twenty_decibels_in_1_7_seconds():
    click = np.zeros(10)
    click[0] = -0.9
    frames = [as_frames(click), np.zeros((round(HOLD_S * RATE_HZ), 1), np.int32)]
    meter = fed(np.vstack(frames))
    peak_db = 20 * np.log10(0.9)
    assert meter.levels().held_peak_db[0] == pytest.approx(peak_db, abs=0.15)
    assert meter.levels().peak_db == (FLOOR_DB,)
    meter.add(np.zeros((round(1.7 * RATE_HZ), 1), np.int32))
    assert meter.levels().held_peak_db[0] == pytest.approx(peak_db - 20.0, abs=0.15)


def test_a_higher_peak_is_held_at_once():
    meter = fed(sine(0.1))
    meter.add(sine(0.5, 0.1))
    assert meter.levels().held_peak_db[0] == pytest.approx(20 * np.log10(0.5), abs=0.1)


def test_full_scale_lights_the_clip_lamp_until_it_is_cleared():
    meter = fed(sine(1.3, 0.1))
    meter.add(sine(0.1))
    assert meter.levels().clipped == (True,)
    meter.clear_clip()
    meter.add(sine(0.1))
    assert meter.levels().clipped == (False,)


def test_one_sample_at_full_scale_is_no_clipping():
    frames = sine(0.5)
    frames[1_000] = FULL - 1
    assert fed(frames).levels().clipped == (False,)


@pytest.mark.parametrize("bits", [16, 24])
def test_flat_tops_far_below_full_scale_light_it_too(bits):
    noise = np.random.default_rng(4).normal(0.0, 0.2, 3 * RATE_HZ)
    step = 2.0 ** (1 - bits)
    both = np.column_stack([noise * 0.3, np.clip(noise, -0.31, 0.31)])
    both = np.rint(both / step) * step
    assert fed(as_frames(both)).levels().clipped == (False, True)


def test_loud_tones_and_noise_do_not_light_it():
    rng = np.random.default_rng(6)
    time_s = np.arange(5 * RATE_HZ) / RATE_HZ
    sounds = [0.95 * np.sin(2 * np.pi * hz * time_s) for hz in (50.0, 997.0, 12_000.0)]
    sounds += [rng.normal(0.0, 0.15, len(time_s)), rng.uniform(-0.9, 0.9, len(time_s))]
    assert fed(as_frames(np.column_stack(sounds))).levels().clipped == (False,) * 5


def test_a_steady_voltage_is_told():
    assert fed(sine(0.1, 2.0) + as_frames(np.full(2 * RATE_HZ, 0.02))).levels().offset[0] == pytest.approx(
        0.02, abs=1e-4
    )


def test_a_second_without_a_changing_bit_is_digital_silence_and_one_bit_ends_it():
    meter = fed(np.zeros((round(0.99 * RATE_HZ), 2), np.int32))
    assert not meter.levels().is_digital_silence
    meter.add(np.zeros((480, 2), np.int32))
    assert meter.levels().is_digital_silence
    least = np.zeros((480, 2), np.int32)
    least[100, 1] = 256  # the last bit of 24
    meter.add(least)
    assert not meter.levels().is_digital_silence


def test_a_device_that_sends_one_same_value_for_ever_is_silent_too():
    assert fed(np.full((2 * RATE_HZ, 1), 1 << 20, np.int32)).levels().is_digital_silence


def test_a_meter_that_heard_nothing_shows_the_floor():
    levels = LevelMeter(RATE_HZ, 2).levels()
    assert levels.rms_db == levels.peak_db == levels.held_peak_db == (FLOOR_DB, FLOOR_DB)
    assert not any(levels.clipped)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(0, 9_000), min_size=1, max_size=40), st.integers(0, 2**32 - 1))
def test_what_it_says_does_not_depend_on_how_the_stream_was_cut(cuts, seed):
    sound = np.random.default_rng(seed).normal(0.0, 0.2, (sum(cuts), 2))
    frames = as_frames(sound)
    whole, cut = LevelMeter(RATE_HZ, 2), LevelMeter(RATE_HZ, 2)
    whole.add(frames)
    at = 0
    for count in cuts:
        cut.add(frames[at : at + count])
        at += count
    a, b = whole.levels(), cut.levels()
    np.testing.assert_allclose(a.rms_db, b.rms_db, atol=1e-4)
    assert (a.peak_db, a.held_peak_db, a.is_digital_silence) == (b.peak_db, b.held_peak_db, b.is_digital_silence)
    np.testing.assert_allclose(a.offset, b.offset, atol=1e-6)


def test_flat_tops_are_found_in_a_stretch_as_long_as_is_said():
    noise = np.random.default_rng(8).normal(0.0, 0.2, round(CLIP_S * RATE_HZ) - 480)
    meter = fed(as_frames(np.clip(noise, -0.31, 0.31)))
    assert meter.levels().clipped == (False,)
    meter.add(sine(0.05, 0.01))
    assert meter.levels().clipped == (True,)
