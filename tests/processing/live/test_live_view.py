"""The composed view: pictures hold what is new, once and in order, whatever the window misses."""

import numpy as np
import pytest

from processing.live.live_view import LiveView
from processing.live.stream import MotionBlock, SoundBlock
from processing.survey import DeviceInfo, ImuSamples, Motion, Survey

SURVEY = Survey(device=DeviceInfo(Motion.ROLLING, 0.05))
RATE = 16_000.0


def motion(start_s, end_s, rate_hz=100.0):
    time_s = np.arange(round(start_s * rate_hz), round(end_s * rate_hz)) / rate_hz
    n = len(time_s)
    imu = ImuSamples(time_s, np.tile([0.0, 0.0, 9.81], (n, 1)), np.zeros((n, 3)), np.ones(n, bool))
    return MotionBlock(imu, 1000.0 + end_s)


def sound(start_s, end_s, seed=0):
    first, last = round(start_s * RATE), round(end_s * RATE)
    frames = np.random.default_rng(seed).integers(-(10**7), 10**7, (last - first, 1)).astype(np.int32)
    return SoundBlock(frames, first, 1000.0 + start_s)


def fill(view, start_s, end_s, step_s=0.05):
    for k in range(round((end_s - start_s) / step_s)):
        at = start_s + k * step_s
        view.add(sound(at, at + step_s, seed=round(at / step_s)))
        view.add(motion(at, at + step_s))


def test_pictures_one_after_the_other_hold_every_column_once():
    view, seen, picture = LiveView(SURVEY, sample_rate_hz=RATE), [], None
    for k in range(40):
        fill(view, 0.1 * k, 0.1 * (k + 1))
        picture = view.picture(picture)
        seen.append(picture.sound)
    numbers = np.concatenate([s.first + np.arange(len(s.tiles)) for s in seen])
    np.testing.assert_array_equal(numbers, np.arange(len(numbers)))
    whole = view.picture().sound
    np.testing.assert_array_equal(np.concatenate([s.tiles for s in seen]), whole.tiles)


def test_a_picture_that_was_never_drawn_takes_nothing_with_it():
    view = LiveView(SURVEY, sample_rate_hz=RATE)
    fill(view, 0.0, 2.0)
    drawn = view.picture()
    fill(view, 2.0, 3.0)
    view.picture(drawn)  # lost on its way
    fill(view, 3.0, 4.0)
    picture = view.picture(drawn)
    assert picture.sound.first == drawn.sound.first + len(drawn.sound.tiles)
    assert picture.strips.first == drawn.strips.first + len(drawn.strips.low) - 1
    assert picture.strips.first + len(picture.strips.low) == 80


def test_a_picture_knows_when_its_newest_samples_came():
    view = LiveView(SURVEY, sample_rate_hz=RATE)
    fill(view, 0.0, 5.0)
    picture = view.picture()
    assert picture.motion_host_s == pytest.approx(1005.0)
    assert picture.motion_survey_s == pytest.approx(4.99)
    assert 1004.8 < picture.sound_host_s <= 1005.0


def test_a_picture_does_not_change_when_more_comes():
    view = LiveView(SURVEY, sample_rate_hz=RATE, sound_span_s=2.0, strip_span_s=2.0)
    fill(view, 0.0, 3.0)
    picture = view.picture()
    before = picture.sound.tiles.copy(), picture.strips.low.copy()
    fill(view, 3.0, 6.0)
    np.testing.assert_array_equal(picture.sound.tiles, before[0])
    np.testing.assert_array_equal(picture.strips.low, before[1])


def test_where_the_recording_begins_path_and_strips_begin_anew():
    view = LiveView(SURVEY, sample_rate_hz=RATE)
    fill(view, 0.0, 6.0)
    monitoring = view.picture()
    assert monitoring.pose is not None
    view.restart_path()
    fill(view, 6.0, 6.5)
    view.add(motion(0.0, 0.5))  # survey time begins anew
    picture = view.picture(monitoring)
    assert picture.epoch != monitoring.epoch
    assert picture.pose is None
    assert picture.strips.first + len(picture.strips.low) in (10, 130)


def test_sound_is_drawn_as_soon_as_its_rate_is_known():
    view = LiveView(SURVEY)
    fill(view, 0.0, 1.0)
    assert view.picture().sound is None
    view.set_sample_rate(RATE)
    fill(view, 1.0, 2.0)
    picture = view.picture()
    assert len(picture.sound.tiles) > 10
    view.set_sample_rate(RATE)  # told again: nothing is lost
    assert len(view.picture(picture).sound.tiles) == 0
