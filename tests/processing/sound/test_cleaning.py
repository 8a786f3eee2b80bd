"""The whole cleaner on sound from closed forms: what goes, what stays, and that it may be read from anywhere."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from rolling_sound import ORDERS, RATE_HZ, level_db, noise, over_between_db, recorded, roll
from scipy import signal

from processing.settings import CleaningSettings, DetectorSettings
from processing.sound.cleaning import CleanReader, NotCleaned, figures, learn_cleaning
from processing.sound.cleaning_bands import PhaseGains, phase_gain, usual_share

RUN = roll(48.0, seed=4)
COUNT = len(RUN.time_s)
INNER = slice(6 * RATE_HZ, -6 * RATE_HZ)
BUMPS_S = np.arange(10.3, 40.0, 5.1)


def bumps():
    """Return cracks of some 30 ms."""
    out = np.zeros(COUNT, np.float32)
    rng = np.random.default_rng(8)
    for at in BUMPS_S:
        first, length = int(at * RATE_HZ), int(0.03 * RATE_HZ)
        out[first : first + length] += (
            0.3 * rng.standard_normal(length) * np.exp(-np.arange(length) / (0.008 * RATE_HZ))
        )
    return out


def learnt(made, settings=None):
    return learn_cleaning(made.audio, made.imu, made.scan, made.frames, made.clock, settings or CleaningSettings())


def cleaned(made, context, cuts=()):
    with CleanReader(made.audio, context) as reader:
        return np.concatenate([reader.read(a, b - a) for a, b in pairwise([0, *cuts, COUNT])])


@pytest.fixture(scope="module")
def rolling(tmp_path_factory):
    """A recording with everything in it, and the cleaner's context."""
    sound = noise(COUNT, 0.01) + RUN.swelling(0.03) + RUN.lines(0.008) + bumps()
    made = recorded(tmp_path_factory.mktemp("rolling"), RUN, sound, gyro_scale=1.02)
    return sound, made, learnt(made)


def test_lines_go_bumps_are_ducked_and_the_rest_stays(rolling):
    sound, made, context = rolling
    clean = cleaned(made, context)
    assert over_between_db(sound[INNER], RUN.angle_rad[INNER], ORDERS) > 20
    assert over_between_db(clean[INNER], RUN.angle_rad[INNER], ORDERS) < 8
    for at in BUMPS_S[1:-1]:
        struck = slice(int(at * RATE_HZ), int((at + 0.02) * RATE_HZ))
        assert level_db(clean[struck]) < level_db(sound[struck]) - 5  # shorter than a frame, so some is left
    quiet = noise(COUNT, 0.01) + RUN.swelling(0.03)
    between = slice(int(16.2 * RATE_HZ), int(20.2 * RATE_HZ))
    # weighing power by 1/m², m = 1 + a cos, leaves mean(1/m) / mean(1/m²) = 1 − a² of such noise
    swell = 0.7 * 0.03**2 / (0.03**2 + 0.01**2)
    left_db = 10 * np.log10(1 - swell**2)
    assert level_db(clean[between]) == pytest.approx(level_db(quiet[between]) + left_db, abs=0.6)


def test_the_swelling_is_learnt_and_the_loud_part_of_each_turn_is_held_back(rolling):
    sound, made, context = rolling
    clean = cleaned(made, context)

    def swell_db(x):
        power = np.square(signal.sosfilt(signal.butter(4, [600, 2500], "bandpass", fs=RATE_HZ, output="sos"), x))
        keep = np.abs(np.subtract.outer(RUN.time_s[INNER][::8], BUMPS_S)).min(axis=1) > 0.2
        phase = np.angle(np.exp(1j * RUN.angle_rad[INNER][::8]))[keep]
        power = power[INNER][::8][keep]
        return 10 * np.log10(np.mean(power[np.abs(phase) < 0.7]) / np.mean(power[np.abs(phase) > 2.4]))

    assert swell_db(sound) == pytest.approx(10 * np.log10(1.63 * 0.9 + 0.1) - 10 * np.log10(0.35 * 0.9 + 0.1), abs=1.5)
    assert swell_db(clean) < -0.5  # past evenness: power is weighed by 1/m², as the detector weighs it


def test_a_steady_sound_keeps_its_power_over_many_turns():
    step_s = 0.05
    turn = 2 * np.pi * 1.3 * np.arange(0, 120, step_s)
    for depth in (0.5, 1.0):
        gains = phase_gain((1 + 0.6 * np.cos(turn)).astype(np.float32), depth, step_s).astype(float)
        assert 10 * np.log10(np.mean(np.exp(2 * gains[150:-150]))) == pytest.approx(0.0, abs=0.2)


def test_a_loud_leak_is_not_made_to_pulse():
    step_s = 0.064
    time_s = np.arange(0.0, 180.0, step_s)
    turn = 2 * np.pi * 1.3 * time_s
    swell = (1 + 0.6 * np.cos(turn)).astype(np.float32)
    leak = 20.0 * np.exp(-0.5 * ((time_s - 90.0) / 3.0) ** 2)
    share = usual_share(np.log(swell + leak).astype(np.float32), step_s)
    gains = 20 / np.log(10) * phase_gain(swell, 1.0, step_s, share).astype(float)
    there, elsewhere = np.abs(time_s - 90.0) < 1.5, np.abs(time_s - 40.0) < 10.0
    assert np.ptp(gains[there]) < 1.5  # dB
    assert np.ptp(gains[elsewhere]) == pytest.approx(20 * np.log10(1.6 / 0.4), abs=2.5)


def test_however_it_is_cut_and_wherever_it_begins_the_samples_are_the_same(rolling):
    _, made, context = rolling
    whole = cleaned(made, context)
    for cuts in ((1, 2, 7777, 100_001), tuple(range(3001, COUNT, 3001))):
        np.testing.assert_array_equal(cleaned(made, context, cuts), whole)
    for start, count in ((0, 10), (123_456, 5000), (COUNT - 100, 100)):
        with CleanReader(made.audio, context) as reader:
            np.testing.assert_array_equal(reader.read(start, count), whole[start : start + count])


def test_reading_ends_with_the_recording_and_does_not_begin_before_it(rolling):
    _, made, context = rolling
    with CleanReader(made.audio, context) as reader:
        assert len(reader.read(COUNT - 10, 500)) == 10
        assert len(reader.read(COUNT + 10, 500)) == 0
        with pytest.raises(ValueError, match="before"):
            reader.read(-1, 5)


def test_with_everything_off_the_sound_comes_out_as_it_was(rolling):
    sound, made, context = rolling
    off = replace(context.settings, impulse_sigmas=100.0)
    bare = replace(context, lines=replace(context.lines, orders=np.zeros(0)), gains=None, settings=off)
    np.testing.assert_allclose(cleaned(made, bare)[1000:-1000], sound[1000:-1000], atol=2e-6)


def test_the_high_pass_takes_what_is_below_it(rolling):
    _, made, context = rolling
    high = replace(context, settings=replace(context.settings, high_pass_hz=800.0))
    hz, before = signal.welch(cleaned(made, context), RATE_HZ, nperseg=1024)
    _, after = signal.welch(cleaned(made, high), RATE_HZ, nperseg=1024)
    lost = 10 * np.log10(before / after)
    assert lost[(hz > 100) & (hz < 350)].min() > 20
    assert np.abs(lost[hz > 1600]).max() < 1.0


def test_figures_tell_the_turning_and_the_bumps_that_were_felt(rolling):
    _, made, context = rolling
    felt = replace(context, felt_s=BUMPS_S[::2] + 0.01)
    told = figures(made.audio, felt, 9.0, 39.0, (500.0, 3500.0))
    turned = np.interp([9.0, 39.0], RUN.time_s, RUN.angle_rad)
    assert told.turns_hz == pytest.approx(1.02 * (turned[1] - turned[0]) / (2 * np.pi * 30.0), rel=1e-3)
    assert 0.2 < told.removed_db < 10.0
    with CleanReader(made.audio, felt) as reader:
        heard, shared = reader.bumps(9 * RATE_HZ, 32 * RATE_HZ)
    assert len(BUMPS_S) <= heard <= len(BUMPS_S) + 4  # and chance now and then
    assert shared == len(BUMPS_S[::2])


def test_where_no_turning_is_heard_there_is_nothing_to_clean_with(tmp_path):
    made = recorded(tmp_path, RUN, noise(COUNT, 0.02, seed=12))
    assert learnt(made) is NotCleaned.NOT_HEARD


def test_gains_between_frames_are_between_theirs():
    gains = PhaseGains(0.1, np.array([[0.0], [1.0], [0.0]], np.float16))
    np.testing.assert_allclose(gains.at(np.array([0.0, 0.05, 0.1, 0.15, 0.3])).ravel(), [0, 0, 0.5, 1, 0], atol=1e-6)


def test_frames_that_do_not_count_are_not_learnt_from(rolling):
    _, made, _ = rolling
    still = replace(made.frames, counts=np.zeros_like(made.frames.counts))
    found = learn_cleaning(made.audio, made.imu, made.scan, still, made.clock, CleaningSettings(lines="off"))
    assert found is NotCleaned.NOT_HEARD
    assert DetectorSettings().min_speed_mps > 0  # which is why a ball at rest does not count
