"""Lines locked to the turning: found where they are, taken out, and nothing else taken; the same however one reads."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rolling_sound import ORDERS, RATE_HZ, Memory, level_db, noise, over_between_db, roll

from processing.progress import Progress
from processing.sound.orders import OrderWindows, Turning, cubic
from processing.sound.orders_lines import NO_LINES, LineRemover, RollingLines, learn_lines

RUN = roll()
COUNT = len(RUN.time_s)
LEAK = noise(COUNT, 0.02)
LINES = RUN.lines(0.006)
INNER = slice(6 * RATE_HZ, -6 * RATE_HZ)


def windows_of(sound, turning=None):
    return OrderWindows(Memory(sound), len(sound), RATE_HZ, turning or RUN.turning())


def remover_of(sound, turning=None):
    return LineRemover(windows_of(sound, turning), learn_lines(windows_of(sound, turning)))


@pytest.mark.parametrize("scale", [1.0, 0.98, 1.02])
def test_lines_are_found_and_gone_and_the_leak_stays_although_the_gyro_s_scale_is_off(scale):
    mixture = LINES + LEAK
    turning = RUN.turning(scale)
    lines = learn_lines(windows_of(mixture, turning))
    assert lines.orders == pytest.approx(np.array(ORDERS) / scale, rel=2e-3, abs=0.06)
    assert lines.scale == pytest.approx(scale, abs=0.003)
    taken = LineRemover(windows_of(mixture, turning), lines).read(0, COUNT)
    assert over_between_db((mixture)[INNER], RUN.angle_rad[INNER], ORDERS) > 25
    assert over_between_db((mixture - taken)[INNER], RUN.angle_rad[INNER], ORDERS) < 6
    # what was taken is the lines: what it differs by is far weaker than they are
    assert level_db((taken - LINES)[INNER]) < level_db(LINES[INNER]) - 15
    assert level_db((mixture - taken)[INNER]) > level_db(LEAK[INNER]) - 0.3


def test_of_a_leak_alone_nothing_is_taken():
    assert not len(learn_lines(windows_of(LEAK)).orders)
    none = LineRemover(windows_of(LEAK), NO_LINES)
    assert not none.read(1000, 500).any()
    assert not none.gains(windows_of(LEAK).spectrum(2)).any()
    # nor where lines are expected that do not sound
    silent = LineRemover(windows_of(LEAK), RollingLines(np.array(ORDERS, float), np.full(len(ORDERS), 20.0)))
    assert level_db(silent.read(0, COUNT)) < level_db(LEAK) - 20


def test_a_pump_is_no_line_of_the_ball():
    pump = (0.02 * np.cos(2 * np.pi * 49.4 * RUN.time_s) + 0.01 * np.cos(2 * np.pi * 98.8 * RUN.time_s)).astype("f4")
    taken = remover_of(pump + LINES + LEAK).read(0, COUNT)
    left = (pump + LINES + LEAK - taken)[INNER]
    wave = np.exp(-2j * np.pi * 49.4 * RUN.time_s[INNER])
    before, after = (abs(np.mean(x * wave)) for x in (pump[INNER], left))
    assert after == pytest.approx(before, rel=0.06)
    assert over_between_db(left, RUN.angle_rad[INNER], ORDERS) < 10


def test_a_scale_that_drifts_along_the_way_is_followed():
    knots = np.arange(0.0, RUN.time_s[-1] + 0.06, 0.02)
    true = np.interp(knots, RUN.time_s, RUN.angle_rad)
    drifting = 1.0 + 0.002 * np.sin(2 * np.pi * knots / 70.0)
    turning = Turning(0.02, np.concatenate([[0.0], np.cumsum(drifting[1:] * np.diff(true))]))
    taken = remover_of(LINES + LEAK, turning).read(0, COUNT)
    assert level_db((taken - LINES)[INNER]) < level_db(LINES[INNER]) - 10


@settings(max_examples=4, deadline=None)
@given(st.lists(st.integers(1, COUNT - 1), max_size=6, unique=True), st.integers(0, COUNT - 4000))
def test_however_reading_is_cut_and_wherever_it_begins_the_samples_are_the_same(cuts, start):
    sound = LINES + LEAK
    lines = RollingLines(np.array(ORDERS, float), np.full(len(ORDERS), 30.0))
    remover = LineRemover(windows_of(sound), lines)
    whole = np.concatenate([remover.read(a, b - a) for a, b in pairwise([0, *sorted(cuts), COUNT])])
    np.testing.assert_array_equal(whole[start : start + 4000], LineRemover(windows_of(sound), lines).read(start, 4000))


def test_a_ball_that_lies_still_has_no_lines():
    still = Turning(0.02, np.zeros(int(20 / 0.02) + 3))
    sound = noise(20 * RATE_HZ, 0.01)
    windows = windows_of(sound, still)
    assert all(windows.spectrum(j) is None for j in range(windows.count))
    assert not len(learn_lines(windows).orders)


def test_learning_tells_how_far_it_is():
    told = []
    learn_lines(windows_of(LINES + LEAK), Progress(lambda fraction, phrase: told.append((fraction, phrase))))
    assert {phrase for _, phrase in told} == {"cleaning_listening"}
    assert [f for f, _ in told] == sorted(f for f, _ in told)
    assert told[-1][0] == 1.0


def test_between_samples_a_slow_tone_is_read_rightly_and_far_outside_is_silence():
    time = np.arange(2000.0)
    at = np.linspace(2.0, 1997.0, 5001)
    read = cubic(np.sin(0.3 * time).astype(np.float32), at)
    np.testing.assert_allclose(read, np.sin(0.3 * at), atol=2e-3)
    assert not cubic(np.ones(10, np.float32), np.array([-50.0, 60.0])).any()
