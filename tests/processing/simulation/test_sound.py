"""The sound: powers by place, by time and by turn, tones, blows on two clocks, and bounded blocks."""

from dataclasses import replace

import numpy as np
import pytest

from processing.simulation import spectra
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
    Pump,
    Scenario,
    Sound,
    Stop,
    Timed,
)
from processing.simulation.sound import frame_length, frequencies, sound_blocks
from processing.survey import LeakClass

RATE = 8000
NOTHING = Sound(
    rate_hz=RATE, flow_dbfs=-150, flow_drift_db=0, rolling_dbfs=-150, rolling_drift_db=0, hiss_dbfs=-150,
    bends_rumble=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False),
)  # fmt: skip
PLAIN = Scenario(
    "plain",
    route=PipeRoute(((0.0, 0, 0), (60.0, 0, 0))),
    drive=Drive(0.5, variation=0.0, rest_start_s=3.0, rest_end_s=3.0),
    imu=replace(Imu.perfect(100.0), pressure=False),
    sound=NOTHING,
    clock=Clock(start_s=-2.0, drift_ppm=0.0),
)


def heard(run):
    return np.concatenate(list(sound_blocks(run.sound))).astype(np.float64)


def power_db(x):
    return 10 * np.log10(np.mean(x**2))


def with_sound(**changes):
    return replace(PLAIN, sound=replace(NOTHING, **changes))


def test_steady_noise_has_its_stated_level_and_the_recording_its_stated_length():
    run = simulate(with_sound(hiss_dbfs=-40.0), 1)
    x = heard(run)
    assert len(x) == run.sound.frames
    assert len(x) / RATE == pytest.approx(run.motion.time_s[-1] + 1.5 + 2.0, abs=1e-3)
    assert power_db(x) == pytest.approx(-40.0, abs=0.1)
    # no seam between frames: the level is the same at every place within a hop
    hop = frame_length(RATE) // 2
    by_place = np.mean(x[: len(x) // hop * hop].reshape(-1, hop) ** 2, axis=0)
    middle, seam = by_place[hop // 2 - 40 : hop // 2 + 40].mean(), by_place[:40].mean() + by_place[-40:].mean()
    assert seam / 2 == pytest.approx(middle, rel=0.1)


def test_a_leaks_power_falls_with_distance_as_one_over_one_plus_the_square():
    leak = Local(LeakClass.LEAK, 30.0, 2.0, 1200.0, 1.8, 110.0)
    run = simulate(with_sound(local=(leak,)), 2)
    x = heard(run)
    t = run.clock.to_survey((np.arange(len(x)) + 0.5) / RATE)
    away = np.interp(t, run.motion.time_s, run.motion.chainage_m) - 30.0
    peak = run.leaks[0].power_dbfs
    for low, high in [(-0.3, 0.3), (1.7, 2.3), (-4.4, -3.6), (7.0, 9.0), (-18.0, -14.0)]:
        inside = (away >= low) & (away < high)
        expected = np.mean(1 / (1 + (away[inside] / 2.0) ** 2))
        assert power_db(x[inside]) == pytest.approx(peak + 10 * np.log10(expected), abs=0.6)


def test_snr_is_that_in_the_leaks_band_at_closest_approach():
    from scipy.signal import welch

    at_leak = replace(PLAIN, drive=replace(PLAIN.drive, stops=()))
    base = replace(NOTHING, flow_dbfs=-40.0, rolling_dbfs=-42.0, rolling_modulation=(0.0, 0.0))
    leak = Local(LeakClass.LEAK, 30.0, 1e4, 1200.0, 1.5, 6.0)  # so wide that it is the same everywhere
    levels = []
    for local in ((), (leak,)):
        run = simulate(replace(at_leak, sound=replace(base, local=local)), 3)
        f, p = welch(heard(run)[12 * RATE : 110 * RATE], RATE, nperseg=2048)
        levels.append(np.sum(p * spectra.in_band(f, 1200.0, 1.5)))
    excess = 10 * np.log10(levels[1] / levels[0] - 1)
    assert excess == pytest.approx(6.0, abs=0.3)


def test_rolling_noise_swells_with_the_turn_of_the_ball():
    run = simulate(
        replace(with_sound(rolling_dbfs=-40.0, rolling_modulation=(0.5, 0.2)), ball=Ball(0.08, slip=0.05)), 4
    )
    x = heard(run)
    t = run.clock.to_survey((np.arange(len(x)) + 0.5) / RATE)
    cruising = (t > 10) & (t < 110)
    phase = np.interp(t[cruising], run.motion.time_s, run.motion.rotation_rad)
    power = x[cruising] ** 2
    for order, depth in ((1, 0.5), (2, 0.2), (3, 0.0)):
        found = 2 * np.abs(np.mean(power * np.exp(-1j * order * phase))) / np.mean(power)
        assert found == pytest.approx(depth, abs=0.04)


def test_rolling_noise_grows_with_the_cube_of_speed_and_is_gone_at_a_stop():
    scenario = replace(
        with_sound(rolling_dbfs=-40.0), drive=replace(PLAIN.drive, variation=0.25, stops=(Stop(30.0, 8.0),))
    )
    run = simulate(scenario, 4)
    x = heard(run)
    frames = np.mean(x[: len(x) // 4000 * 4000].reshape(-1, 4000) ** 2, axis=1)
    t = run.clock.to_survey((np.arange(len(frames)) + 0.5) * 0.5)
    speed = np.interp(t, run.motion.time_s, run.motion.speed_mps)
    fast = speed > 0.3
    slope = np.polyfit(np.log(speed[fast]), np.log(frames[fast]), 1)[0]
    assert slope == pytest.approx(3.0, abs=0.4)
    assert frames[speed == 0].max() < 1e-6 * frames[fast].mean()


def test_a_pump_is_a_comb_of_its_frequency():
    run = simulate(with_sound(pumps=(Pump(49.4, 15, -30.0),)), 5)
    x = heard(run)
    spectrum = np.abs(np.fft.rfft(x * np.hanning(len(x)))) ** 2
    f = np.fft.rfftfreq(len(x), 1 / RATE)
    comb = np.min(np.abs(f[:, None] - 49.4 * np.arange(1, 16)), axis=1) < 0.5
    assert spectrum[comb].sum() / spectrum.sum() > 0.999
    assert power_db(x[20 * RATE : -20 * RATE]) == pytest.approx(-30.0, abs=0.6)


def test_traffic_belongs_to_its_time():
    run = simulate(with_sound(timed=(Timed(LeakClass.TRAFFIC, 60.0, 10.0, 100.0, 1.8, 110.0),)), 6)
    x = heard(run)
    seconds = np.mean(x[: len(x) // RATE * RATE].reshape(-1, RATE) ** 2, axis=1)
    t = run.clock.to_survey(np.arange(len(seconds)) + 0.5)
    assert np.sum(t * seconds) / seconds.sum() == pytest.approx(60.0, abs=0.7)
    assert np.sum(seconds[np.abs(t - 60) < 5]) / seconds.sum() == pytest.approx(0.76, abs=0.06)  # of a bell, ±1.18 σ


def test_blows_are_felt_and_heard_at_the_same_moment_on_both_clocks():
    scenario = replace(
        PLAIN,
        clock=Clock(start_s=3.2, drift_ppm=4000.0),  # so strong that a forgotten drift would show
        drive=replace(PLAIN.drive, rest_start_s=14.0, rest_end_s=14.0),
        imu=replace(Imu.perfect(400.0), pressure=False),
        ball=Ball(lever_arm_s_m=(0.0, 0.0, 0.0)),
        sound=replace(NOTHING, joints=Joints(), knocks=Knocks()),
    )
    run = simulate(scenario, 7)
    x = np.abs(heard(run))
    assert [b.kind for b in run.blows].count("knock") == 10
    assert [b.kind for b in run.blows].count("joint") >= 9
    felt = np.abs(np.linalg.norm(run.imu.acc_s_mps2, axis=1) - 9.81)
    cruising = [b for b in run.blows if b.kind == "knock" or 20 < b.time_s < run.motion.time_s[-1] - 20]
    for blow in cruising:
        onset = float(run.clock.to_audio(blow.time_s)) * RATE
        near = slice(int(onset) - 400, int(onset) + 400)
        heard_at = near.start + int(np.argmax(x[near] > 0.2 * x[near].max()))
        assert heard_at == pytest.approx(onset, abs=8)  # one millisecond
        rows = np.flatnonzero(np.abs(run.imu.time_s - blow.time_s) < 0.06)
        felt_at = run.imu.time_s[rows[np.argmax(felt[rows])]]
        assert felt_at == pytest.approx(blow.time_s, abs=0.010)
        assert felt[rows].max() > 0.5


def test_joints_stand_a_pipe_length_apart():
    run = simulate(replace(PLAIN, sound=replace(NOTHING, joints=Joints(5.5, 0.1))), 1)
    places = np.array([b.chainage_m for b in run.blows])
    np.testing.assert_allclose(np.diff(places), 5.5, atol=0.5)
    times = np.array([b.time_s for b in run.blows])
    np.testing.assert_allclose(np.interp(times, run.motion.time_s, run.motion.chainage_m), places, atol=1e-6)


def test_sound_is_made_in_small_blocks_of_finite_samples_within_full_scale():
    run = simulate(with_sound(hiss_dbfs=0.0), 1)
    for block in sound_blocks(run.sound):
        assert len(block) <= 32 * frame_length(RATE)
        assert block.dtype == np.float32
        assert np.all(np.abs(block) <= 1.0)


def test_a_leak_changes_nothing_but_the_sound():
    without = simulate(PLAIN, 9)
    leaky = simulate(with_sound(local=(Local(LeakClass.LEAK, 20.0),)), 9)
    np.testing.assert_array_equal(without.imu.gyr_s_radps, leaky.imu.gyr_s_radps)
    np.testing.assert_array_equal(without.imu.acc_s_mps2, leaky.imu.acc_s_mps2)


def test_every_shape_sums_to_one_and_a_bell_has_its_half_power_width():
    f = frequencies(44100)
    for shape in (spectra.pink(f), spectra.white(f), spectra.band(f, 250, 2500), spectra.bell(f, 1300, 1.8)):
        assert shape.sum() == pytest.approx(1.0)
    bell = spectra.bell(f, 2000.0, 2.0)
    at = np.interp([1000.0, 2000.0, 4000.0], f, bell / bell.max())
    np.testing.assert_allclose(at, [0.5, 1.0, 0.5], atol=0.01)
