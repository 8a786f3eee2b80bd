"""The sound card's clock against blocks whose true times are known."""

import numpy as np
import pytest
from arrivals import frames_at, sent, told_by
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.live.device_timeline import DeviceTimeline
from processing.live.sound_timeline import SoundTimeline, sound_to_survey

RATE, BLOCK = 48_000, 4_800


def errors(kind, count, jitter_s, seed=1):
    """How wrong the times of blocks are: at random, or as a sound server's, which run off and are set back."""
    if kind == "sawtooth":
        return ((np.arange(count) * 0.037) % 1 - 0.5) * 2 * jitter_s
    return np.random.default_rng(seed).uniform(-jitter_s, jitter_s, count)


def played(timeline, seconds, off_s, ppm=40.0, losses=(), late=(), flagged=False, begin_s=1000.0):
    """Blocks of a card with a drift; ``losses``: (block, frames); ``late``: blocks whose time is 2 s late."""
    lost, found, missing = dict(losses), [], 0
    for block in range(round(seconds * RATE / BLOCK)):
        missing += lost.get(block, 0)
        true_s = begin_s + (block * BLOCK + missing) / (RATE * (1 + 1e-6 * ppm))
        told_s = true_s + off_s[block] + (2.0 if block in late else 0.0)
        now = timeline.place(BLOCK, told_s, overflowed=flagged and block in lost)
        found += [(block, now)] if now else []
    return found


@pytest.mark.parametrize("kind", ["random", "sawtooth"])
@pytest.mark.parametrize("jitter_s", [0.0001, 0.010])
def test_coarse_times_and_late_callbacks_are_no_loss(kind, jitter_s):
    timeline = SoundTimeline(RATE)
    off_s = errors(kind, 6000, jitter_s)
    assert played(timeline, 600, off_s, late=(500, 501, 502, 3000)) == []
    assert timeline.frames == 600 * RATE
    assert timeline.clock_ppm == pytest.approx(40.0, abs=4 * timeline.clock_sigma_ppm)


@pytest.mark.parametrize(("jitter_s", "off_frames"), [(0.0001, 60), (0.010, 480)])
def test_what_is_lost_without_a_flag_is_found_within_a_second_in_whole_frames(jitter_s, off_frames):
    timeline = SoundTimeline(RATE)
    found = played(timeline, 400, errors("random", 4000, jitter_s), losses=((1000, 2400), (3000, 96_000)))
    (first, at_first), (second, at_second) = found
    assert 1000 <= first <= 1010
    assert 3000 <= second <= 3010
    assert isinstance(at_first, int)
    assert at_first == pytest.approx(2400, abs=off_frames)
    assert at_first + at_second == pytest.approx(98_400, abs=off_frames)
    assert (timeline.lost_frames, timeline.gaps) == (at_first + at_second, 2)


def test_what_the_driver_flags_is_filled_at_once():
    timeline = SoundTimeline(RATE)
    found = played(timeline, 100, errors("random", 1000, 0.0002), losses=((500, 480),), flagged=True)
    assert found == [(500, pytest.approx(480, abs=15))]


def test_a_flag_without_a_loss_fills_nothing():
    timeline = SoundTimeline(RATE)
    played(timeline, 30, errors("random", 300, 0.001))
    assert timeline.place(BLOCK, 1030.0 / (1 + 40e-6) + 40e-6 * 1000, overflowed=True) == 0


@pytest.mark.parametrize("away_s", [0.3, 120.0])
def test_an_input_that_comes_back_goes_on_where_it_should_be(away_s):
    timeline = SoundTimeline(RATE)
    played(timeline, 60, np.zeros(600), ppm=0.0)
    assert timeline.place(BLOCK, 1060.0 + away_s, reopened=True) == round(away_s * RATE)


@given(st.integers(8, 280), st.integers(1000, 400_000))
@settings(max_examples=8, deadline=None)
def test_no_loss_is_ever_filled_twice(block, frames):
    timeline = SoundTimeline(RATE)
    played(timeline, 40, errors("random", 400, 0.0005), losses=((block + 60, frames),))
    assert timeline.lost_frames == pytest.approx(frames, abs=50)
    assert timeline.gaps == 1


def test_times_that_are_no_numbers_are_passed_over():
    timeline = SoundTimeline(RATE)
    assert timeline.place(BLOCK, float("nan")) == 0
    assert timeline.is_empty
    assert timeline.place(BLOCK, 5.0) == 0
    assert (timeline.frames, timeline.is_empty) == (2 * BLOCK, False)


def test_the_map_to_survey_time_holds_within_what_it_says():
    off = []
    for seed in range(3):
        sound, device = SoundTimeline(RATE, delay_sigma_s=0.001), DeviceTimeline(delay_sigma_s=0.001)
        played(sound, 10, errors("random", 100, 0.005, seed), begin_s=990.0)
        sound.begin()
        stream = sent(60, 50, -70.0, 0.003, 0.064, seed=seed)
        told_by(device, frames_at(np.round(1e6 * stream.device_s)), stream.host_s)
        played(sound, 60, errors("random", 600, 0.005, seed + 10), begin_s=1000.0)
        guess = sound_to_survey(sound, device)
        # the device's second is 70 ppm long, the card's 40 ppm short
        off.append((guess.drift_ppm - 110.0) / guess.drift_sigma_ppm)
        assert abs(guess.start_time_s) < 3 * guess.start_sigma_s < 0.02
        assert guess.drift_sigma_ppm < 30.0
    assert np.abs(off).max() < 3.5


def test_without_both_clocks_there_is_no_map():
    sound, device = SoundTimeline(RATE), DeviceTimeline()
    assert sound_to_survey(sound, device) is None
    sound.place(BLOCK, 1000.0)
    assert sound_to_survey(sound, device) is None
