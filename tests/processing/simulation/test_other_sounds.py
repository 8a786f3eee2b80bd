"""Spectra, passings and noises beyond the usual ones, and tones locked to the turning, each measured on its own."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import welch

from processing.simulation.run import simulate
from processing.simulation.scenario import (
    Ball,
    Clock,
    Drive,
    Imu,
    Joints,
    Knocks,
    Local,
    PipeRoute,
    RollingLine,
    Scenario,
    Scraping,
    Sound,
    Stop,
)
from processing.simulation.scenario_file import from_mapping, to_mapping
from processing.simulation.sound import frame_length, sound_blocks
from processing.survey import LeakClass

RATE = 8000
NOTHING = Sound(
    rate_hz=RATE, flow_dbfs=-150, flow_drift_db=0, rolling_dbfs=-150, rolling_drift_db=0, hiss_dbfs=-150,
    bends_rumble=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False),
    lines_fade_db=0.0, lines_wander_rad=0.0,
)  # fmt: skip
PLAIN = Scenario(
    "plain",
    route=PipeRoute(((0.0, 0, 0), (30.0, 0, 0))),
    drive=Drive(0.5, variation=0.0, rest_start_s=3.0, rest_end_s=3.0),
    ball=Ball(0.05),
    imu=replace(Imu.perfect(100.0), pressure=False),
    sound=NOTHING,
    clock=Clock(start_s=-2.0, drift_ppm=0.0),
)


def run_of(seed=1, drive=None, **changes):
    scenario = replace(PLAIN, drive=drive or PLAIN.drive, sound=replace(NOTHING, **changes))
    return simulate(scenario, seed)


def heard(run):
    return np.concatenate(list(sound_blocks(run.sound))).astype(np.float64)


def going(run, count):
    """Survey time, chainage, speed and rolled angle at each sample."""
    t = run.clock.to_survey((np.arange(count)) / RATE)
    m = run.motion
    return (t, *(np.interp(t, m.time_s, x) for x in (m.chainage_m, m.speed_mps, m.rotation_rad)))


def cruise(run, x):
    _, chainage, _, turn = going(run, len(x))
    inside = (chainage > 3.0) & (chainage < 27.0)
    return x[inside], turn[inside], chainage[inside]


def db(power):
    return 10 * np.log10(power)


def test_a_leak_with_its_own_spectrum_sounds_as_the_points_say_and_is_as_loud_as_stated():
    points = ((200.0, -10.0), (500.0, 0.0), (600.0, -12.0), (1600.0, -3.0), (3000.0, -20.0))
    leak = Local(LeakClass.LEAK, 15.0, 1e4, 800.0, 2.0, 110.0, spectrum=points)
    run = run_of(local=(leak,))
    x, _, _ = cruise(run, heard(run))
    assert db(np.mean(x**2)) == pytest.approx(run.leaks[0].power_dbfs, abs=0.2)
    f, p = welch(x, RATE, nperseg=1024)
    level = np.interp([hz for hz, _ in points], f, db(p))
    np.testing.assert_allclose(level - level[1], [y - points[1][1] for _, y in points], atol=1.0)
    beyond = np.interp([100.0, 3500.0], f, db(p)) - level[1]  # 24 dB an octave beyond the ends
    np.testing.assert_allclose(beyond, [-34.0, -20.0 - 24 * np.log2(3500 / 3000)], atol=1.5)


def test_the_snr_of_such_a_leak_is_that_in_the_band_it_names():
    leak = Local(LeakClass.LEAK, 15.0, 1e4, 900.0, 1.0, 4.0, spectrum=((300.0, 0.0), (3000.0, -9.0)))
    noise = {"flow_dbfs": -40.0, "flow_slope": 0.6, "rolling_dbfs": -42.0, "rolling_modulation": (0.0, 0.0)}
    levels = []
    for local in ((), (leak,)):
        run = run_of(3, local=local, **noise)
        f, p = welch(cruise(run, heard(run))[0], RATE, nperseg=1024)
        levels.append(p[(f >= 900 / 2**0.5) & (f <= 900 * 2**0.5)].sum())
    assert db(levels[1] / levels[0] - 1) == pytest.approx(4.0, abs=0.4)


@pytest.mark.parametrize("slope", [0.0, 1.0, 1.7])
def test_flow_noise_falls_with_its_slope_and_is_flat_below_its_corner(slope):
    run = run_of(flow_dbfs=-30.0, flow_slope=slope, flow_corner_hz=200.0)
    x, _, _ = cruise(run, heard(run))
    assert db(np.mean(x**2)) == pytest.approx(-30.0, abs=0.3)
    f, p = welch(x, RATE, nperseg=2048)
    above = (f > 300) & (f < 3600)
    assert np.polyfit(np.log(f[above]), np.log(p[above]), 1)[0] == pytest.approx(-slope, abs=0.06)
    below = (f > 40) & (f < 180)
    assert abs(np.polyfit(np.log(f[below]), np.log(p[below]), 1)[0]) < 0.12


def test_an_exponential_passing_halves_each_half_width_and_dies_away_more_slowly_behind():
    leak = Local(LeakClass.LEAK, 15.0, 1.5, 1200.0, 1.8, 110.0, shape="exponential", skew=2.25)
    run = run_of(2, local=(leak,))
    x = heard(run)
    away = going(run, len(x))[1] - 15.0
    peak = run.leaks[0].power_dbfs
    for metres, halvings in [(-1.0, 1.0), (-3.0, 3.0), (2.25, 1.0), (6.75, 3.0)]:  # half-widths 1 m and 2.25 m
        near = np.abs(away - metres) < 0.25
        assert db(np.mean(x[near] ** 2)) == pytest.approx(peak - 3.0103 * halvings, abs=0.7)


def test_rolling_noise_keeps_to_its_band_and_swells_three_times_a_turn():
    run = run_of(4, rolling_dbfs=-30.0, rolling_band_hz=(900.0, 1800.0), rolling_modulation=(0.3, 0.0),
                 rolling_third=0.4)  # fmt: skip
    x, turn, _ = cruise(run, heard(run))
    assert db(np.mean(x**2)) == pytest.approx(-30.0, abs=0.3)
    f, p = welch(x, RATE, nperseg=1024)
    assert p[(f > 600) & (f < 2700)].sum() > 0.94 * p.sum()  # skirts of a third of an octave
    power = x**2
    for order, depth in ((1, 0.3), (2, 0.0), (3, 0.4)):
        # frames of 64 ms overlap under a Hann window, through which swells pass as through any Hann window
        cycles = order * 10.0 / (2 * np.pi) * frame_length(RATE) / RATE
        passed = np.sinc(cycles) / (1 - cycles**2)
        found = 2 * np.abs(np.mean(power * np.exp(-1j * order * turn))) / np.mean(power)
        assert found == pytest.approx(depth * passed, abs=0.045)


def test_without_a_third_harmonic_the_noise_is_what_it_was_before_there_was_one():
    plain = run_of(4, rolling_dbfs=-30.0)
    third = run_of(4, rolling_dbfs=-30.0, rolling_third=1e-9)
    np.testing.assert_allclose(heard(plain), heard(third), atol=1e-6)


def test_scraping_comes_in_bursts_of_its_level_and_band_and_rests_with_the_ball():
    drive = replace(PLAIN.drive, stops=(Stop(15.0, 20.0),))
    run = run_of(5, drive, scraping=Scraping(20.0, -30.0, 1.5, (1000.0, 2000.0)))
    x = heard(run)
    _, _, speed, _ = going(run, len(x))
    frames = np.mean(x[: len(x) // 400 * 400].reshape(-1, 400) ** 2, axis=1)
    moving = speed[200::400][: len(frames)] > 0.49
    loud = frames > 10**-3.6
    assert db(np.median(frames[loud & moving])) == pytest.approx(-30.0, abs=0.7)
    assert 0.15 < np.mean(loud[moving]) < 0.7  # 20 a minute of 1.5 s: 1 − exp(−0.5) = 0.39 of the time
    assert np.median(frames[~loud]) < 1e-9
    assert frames[speed[200::400][: len(frames)] == 0.0].max() < 1e-9
    f, p = welch(x, RATE, nperseg=1024)
    inside = (f >= 1000) & (f <= 2000)
    assert p[(f > 600) & (f < 3400)].sum() > 0.98 * p.sum()  # skirts of a third of an octave
    assert np.ptp(db(p[inside][5:-5])) < 3.0


def test_a_rolling_line_is_a_tone_locked_to_the_turning_of_its_stated_power():
    drive = replace(PLAIN.drive, variation=0.15)  # the speed changes, and the tone's pitch with it
    lines = (RollingLine(90.0, -40.0), RollingLine(150.5, -46.0))
    run = run_of(6, drive, rolling_lines=lines)
    x, turn, _ = cruise(run, heard(run))
    speed = np.interp(*(going(run, len(heard(run)))[k] for k in (1, 1)), going(run, len(heard(run)))[2])
    chainage = going(run, len(speed))[1]
    cube = np.mean((speed[(chainage > 3.0) & (chainage < 27.0)] / 0.5) ** 3)
    loud = (speed[(chainage > 3.0) & (chainage < 27.0)] / 0.5) ** 1.5
    assert db(np.mean(x**2)) == pytest.approx(db((10**-4.0 + 10**-4.6) * cube), abs=0.1)
    rest = x.copy()
    for line in lines:
        phasor = np.exp(-1j * line.order * turn)
        amplitude = 2 * np.sum(x * loud * phasor) / np.sum(loud**2)
        assert db(np.abs(amplitude) ** 2 / 2) == pytest.approx(line.level_dbfs, abs=0.1)
        rest -= loud * np.real(amplitude * np.conj(phasor))
    assert db(np.mean(rest**2)) < -75.0  # nothing else is there: one phase holds over all 24 m
    off = 2 * np.abs(np.sum(x * loud * np.exp(-1j * 91.0 * turn))) / np.sum(loud**2)
    assert db(off**2 / 2) < -65.0


def test_a_line_stays_coherent_over_metres_and_not_over_the_whole_run():
    long = replace(PLAIN, route=PipeRoute(((0.0, 0, 0), (60.0, 0, 0))))
    sound = replace(NOTHING, rolling_lines=(RollingLine(100.0, -40.0),), lines_stable_m=6.0, lines_wander_rad=1.5)
    run = simulate(replace(long, sound=sound), 7)
    x = heard(run)
    _, chainage, _, turn = going(run, len(x))
    phasor = np.array(
        [np.mean(x[inside] * np.exp(-100j * turn[inside])) for a in np.arange(4.0, 56.0, 0.5)
         for inside in [(chainage >= a) & (chainage < a + 0.5)]]
    )  # fmt: skip
    strength = 2 * np.abs(phasor) ** 2
    assert np.median(db(strength)) == pytest.approx(-40.0, abs=0.3)
    assert db(strength).min() > -42.0
    unit = phasor / np.abs(phasor)
    assert np.abs(np.mean(unit[1:] * np.conj(unit[:-1]))) > 0.9  # half a metre on
    assert np.abs(np.mean(unit)) < 0.75  # over the run: exp(−1.5²/2) = 0.32 in the mean


def test_lines_are_added_to_a_sound_that_is_otherwise_the_same():
    without = run_of(8, flow_dbfs=-40.0)
    run = run_of(8, flow_dbfs=-40.0, rolling_lines=(RollingLine(90.0, -50.0), RollingLine(120.0, -50.0)))
    fewer = run_of(8, flow_dbfs=-40.0, rolling_lines=(RollingLine(90.0, -50.0),))
    added = cruise(run, heard(run) - heard(without))[0]
    assert db(np.mean(added**2)) == pytest.approx(-50.0 + 3.01, abs=0.1)
    second, turn, _ = cruise(run, heard(run) - heard(fewer))
    share = np.abs(np.mean(second * np.exp(-120j * turn))) ** 2 * 2 / np.mean(second**2)
    assert share > 0.99


def test_a_line_beyond_half_the_sample_rate_is_silent_instead_of_folding_back():
    run = run_of(9, rolling_lines=(RollingLine(2400.0, -30.0),))  # 3820 Hz at 0.5 m/s, of 3600 allowed
    x, _, _ = cruise(run, heard(run))
    assert np.max(np.abs(x)) < 1e-5


def test_the_new_sounds_survive_a_file_and_what_cannot_be_is_refused():
    leak = Local(LeakClass.LEAK, 15.0, shape="exponential", skew=1.4, spectrum=((100.0, 0.0), (900.0, -3.5)))
    sound = replace(NOTHING, local=(leak,), rolling_lines=(RollingLine(33.0, -45.0),), scraping=Scraping(2.0))
    scenario = replace(PLAIN, sound=sound)
    assert from_mapping(to_mapping(scenario)) == scenario
    for bad, word in [
        ({"local": (replace(leak, shape="square"),)}, "shape"),
        ({"local": (replace(leak, spectrum=((900.0, 0.0), (100.0, 0.0))),)}, "spectrum"),
        ({"local": (replace(leak, spectrum=((900.0, 0.0),)),)}, "spectrum"),
        ({"local": (replace(leak, skew=0.0),)}, "skew"),
        ({"rolling_band_hz": (2000.0, 900.0)}, "rolling_band_hz"),
        ({"scraping": Scraping(2.0, band_hz=(900.0, 900.0))}, "scraping"),
        ({"rolling_lines": (RollingLine(0.0),)}, "order"),
    ]:
        with pytest.raises(ValueError, match=word):
            from_mapping(to_mapping(replace(scenario, sound=replace(sound, **bad))))
