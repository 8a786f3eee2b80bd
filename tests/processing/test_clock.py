"""Two clocks aligned by what both sensors felt, against clocks of known offset and drift."""

import numpy as np
import pytest
import soundfile
from scipy import signal

from processing import messages
from processing.clock import align
from processing.settings import ClockSettings, SoundSettings
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import AudioInfo, ClockMap, ImuSamples

RATE, IMU_RATE = 8000, 200.0
SETTINGS = ClockSettings(imu_delay_periods=0.0)  # the simulated sensor below delays nothing
NOTHING_TOLD = AudioInfo()
TAPS = np.array([0.0, 1.0, 2.0, 5.0, 6.0, 8.0])


def imu_with(blows, seconds, seed, rate=IMU_RATE):
    """Noise and blows as an accelerometer with a smooth response sees them."""
    rng = np.random.default_rng(seed)
    time = np.arange(int(seconds * rate)) / rate
    acc = rng.normal(0, 0.05, (len(time), 3)) + np.array([0, 0, 9.81])
    for at, size in blows:
        near = slice(max(0, int((at - 0.1) * rate)), int((at + 0.1) * rate))
        acc[near, 2] += size * np.exp(-0.5 * ((time[near] - at) * rate / 0.7) ** 2)
    return ImuSamples(time, acc, np.zeros_like(acc), np.ones(len(time), bool))


def sound_with(folder, blows, seconds, seed):
    rng = np.random.default_rng(seed)
    samples = signal.lfilter([1], [1, -0.95], rng.normal(0, 0.003, int(seconds * RATE)))
    ring = np.exp(-np.arange(400) / 60) * np.sin(2 * np.pi * 2000 * np.arange(400) / RATE)
    for at, size in blows:
        first = int(np.ceil(at * RATE))
        if 0 <= first < len(samples) - 400:
            samples[first : first + 400] += size * ring
    path = folder / "a.wav"
    soundfile.write(path, samples, RATE, subtype="PCM_16")
    source, _ = open_audio([path])
    return scan(source, SoundSettings(), out_dir=folder / f"scan{seed}", threads=1)


def aligned(folder, truth, blows, seconds, seed=0, told=NOTHING_TOLD, strangers=20):
    """Blows felt by both sensors, and as many strangers as told that only one of them feels."""
    rng = np.random.default_rng(seed + 1000)
    felt = [(t, s) for t, s in blows] + [(t, 5.0) for t in rng.uniform(20, seconds - 20, strangers)]
    heard = [(float(truth.to_audio(t)), 0.3 * s / 10) for t, s in blows]
    heard += [(t, 0.2) for t in rng.uniform(20, seconds - 20, strangers)]
    imu = imu_with(felt, seconds, seed)
    clock, findings = align(imu, sound_with(folder, heard, seconds, seed), told, SETTINGS)
    for finding in findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    return clock, [f.code for f in findings]


def error_s(clock, truth, seconds):
    audio = np.linspace(0, seconds, 20)
    return abs(clock.to_survey(audio) - truth.to_survey(audio)).max()


@pytest.mark.parametrize(("start", "drift", "seed"), [(-1.7, 30, 1), (12.3, -80, 2), (-19.4, 110, 3), (0.0, 0.0, 4)])
def test_knocks_at_both_ends_give_start_and_drift(tmp_path, start, drift, seed):
    truth = ClockMap(start, drift)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(570.1 + TAPS)]]
    clock, codes = aligned(tmp_path, truth, blows, 600, seed)
    assert (clock.basis, codes) == ("knocks", ["clock_knocks"])
    assert error_s(clock, truth, 600) < 0.006
    assert clock.drift_ppm == pytest.approx(drift, abs=6)
    assert clock.sigma_s < 0.005


def test_joint_bumps_alone_give_start_and_drift(tmp_path):
    truth = ClockMap(-7.31, 40.0)
    rng = np.random.default_rng(9)
    blows = [(t, rng.uniform(4, 12)) for t in np.cumsum(rng.normal(9.0, 0.8, 95)) + 25]
    clock, codes = aligned(tmp_path, truth, blows, 900, seed=5, strangers=60)
    assert (clock.basis, codes) == ("bumps", ["clock_bumps"])
    assert error_s(clock, truth, 900) < 0.006
    assert clock.drift_ppm == pytest.approx(40, abs=6)


def test_knocks_at_the_start_only_leave_the_drift_in_doubt_and_say_so(tmp_path):
    truth = ClockMap(3.0, 0.0)
    clock, codes = aligned(tmp_path, truth, [(t, 25.0) for t in 25 + TAPS], 600, seed=6)
    assert (clock.basis, codes) == ("knocks", ["clock_no_drift"])
    assert clock.start_s == pytest.approx(3.0, abs=0.006)
    assert clock.sigma_s == pytest.approx(30e-6 * 300, rel=0.3)


@pytest.mark.parametrize("seed", range(8))
def test_independent_noise_is_never_aligned(tmp_path, seed):
    clock, codes = aligned(tmp_path, ClockMap(), [], 300, seed=seed, strangers=[0, 15, 40, 120][seed % 4])
    assert (clock.start_s, clock.drift_ppm, clock.basis) == (0.0, 0.0, "assumed")
    assert codes == ["clock_assumed"]
    assert clock.sigma_s >= 1.0


def test_an_even_rhythm_is_ambiguous_and_is_rejected(tmp_path):
    blows = [(t, 25.0) for t in 25 + np.arange(8.0)]
    felt_only_half = blows[:5]
    imu = imu_with(felt_only_half, 200, 1)
    heard = sound_with(tmp_path, [(t, 0.7) for t, _ in blows[3:]], 200, 1)
    clock, _ = align(imu, heard, AudioInfo(), SETTINGS)
    assert clock.basis == "assumed"


def test_given_values_win_over_everything(tmp_path):
    told = AudioInfo(start_time_s=4.0, drift_ppm=11.0)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(270.1 + TAPS)]]
    clock, codes = aligned(tmp_path, ClockMap(-3.0, 50.0), blows, 300, 7, told)
    assert (clock.start_s, clock.drift_ppm, clock.basis, codes) == (4.0, 11.0, "given", [])


def test_a_given_start_is_kept_and_the_drift_estimated(tmp_path):
    truth = ClockMap(-3.0, 50.0)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(570.1 + TAPS)]]
    clock, _ = aligned(tmp_path, truth, blows, 600, 8, AudioInfo(start_time_s=-3.0))
    assert clock.start_s == -3.0
    assert clock.drift_ppm == pytest.approx(50, abs=8)


def test_a_given_drift_is_kept_and_the_start_estimated(tmp_path):
    truth = ClockMap(-3.0, 50.0)
    blows = [(t, 25.0) for t in 22.3 + TAPS]
    clock, codes = aligned(tmp_path, truth, blows, 600, 8, AudioInfo(drift_ppm=50.0))
    assert clock.drift_ppm == pytest.approx(50.0)
    assert clock.start_s == pytest.approx(-3.0, abs=0.006)
    assert codes == ["clock_knocks"]


def test_without_sound_the_clock_is_assumed():
    clock, findings = align(imu_with([], 30, 0), None, AudioInfo(), SETTINGS)
    assert clock.basis == "assumed"
    assert findings[0].params["sigma_ms"] == pytest.approx(1000)


def test_rows_that_are_not_valid_do_not_count_as_knocks(tmp_path):
    truth = ClockMap(2.0, 20.0)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(270.1 + TAPS)]]
    imu = imu_with(blows, 300, 3)
    spoilt = imu.acc_s_mps2.copy()
    valid = imu.valid.copy()
    holes = np.random.default_rng(0).integers(0, len(valid), 300)
    spoilt[holes], valid[holes] = 1e5, False
    imu = ImuSamples(imu.time_s, spoilt, imu.gyr_s_radps, valid)
    heard = sound_with(tmp_path, [(float(truth.to_audio(t)), 0.7) for t, _ in blows], 300, 3)
    clock, _ = align(imu, heard, AudioInfo(), SETTINGS)
    assert clock.basis == "knocks"
    assert error_s(clock, truth, 300) < 0.008
