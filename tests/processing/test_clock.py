"""Two clocks aligned by what both sensors felt, against clocks of known offset and drift."""

import numpy as np
import pytest
import soundfile
from scipy import signal

from processing import messages
from processing.clock import align
from processing.clock_fit import ClockFit, Line, PairKind, Pairs, doubt_of, wander_s
from processing.clock_picture import clock_picture
from processing.settings import ClockSettings, SoundSettings
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import AudioGap, AudioInfo, ClockMap, ImuSamples

RATE, IMU_RATE = 8000, 200.0
SETTINGS = ClockSettings(imu_delay_periods=0.0, contact_s=0.0)  # the simulated sensor below delays nothing
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
    fit = align(imu, sound_with(folder, heard, seconds, seed), told, SETTINGS)
    for finding in fit.findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    return fit.clock, [f.code for f in fit.findings]


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
    clock = align(imu, heard, AudioInfo(), SETTINGS).clock
    assert clock.basis == "assumed"


def test_given_values_win_over_everything(tmp_path):
    told = AudioInfo(start_time_s=4.0, drift_ppm=11.0)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(270.1 + TAPS)]]
    clock, codes = aligned(tmp_path, ClockMap(-3.0, 50.0), blows, 300, 7, told)
    assert (clock.start_s, clock.drift_ppm, clock.basis, codes) == (4.0, 11.0, "given", ["clock_told_contradicted"])


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
    fit = align(imu_with([], 30, 0), None, AudioInfo(), SETTINGS)
    clock, findings = fit.clock, fit.findings
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
    clock = align(imu, heard, AudioInfo(), SETTINGS).clock
    assert clock.basis == "knocks"
    assert error_s(clock, truth, 300) < 0.008


def test_a_start_that_contradicts_what_both_felt_is_used_and_told(tmp_path):
    truth = ClockMap(-3.0, 50.0)
    blows = [(t, 25.0) for t in [*(22.3 + TAPS), *(270.1 + TAPS)]]
    for told in (AudioInfo(start_time_s=4.0), AudioInfo(start_time_s=4.0, drift_ppm=0.0)):
        clock, codes = aligned(tmp_path, truth, blows, 300, 7, told)
        assert clock.start_s == 4.0
        assert "clock_told_contradicted" in codes
    clock, codes = aligned(tmp_path, truth, blows, 300, 7, AudioInfo(start_time_s=-3.0))
    assert "clock_told_contradicted" not in codes


def test_the_doubt_of_a_line_is_that_of_least_squares():
    rng = np.random.default_rng(1)
    survey = np.sort(rng.uniform(0, 3600, 200))
    offsets, drifts, stated = [], [], None
    for _ in range(400):
        shift = 0.3 + 50e-6 * (survey - 1800) + rng.normal(0, 0.004, 200)
        drift, offset = np.polyfit(survey - 1800, shift, 1)
        line = Line(float(offset), float(drift), 1800.0, survey, shift)
        stated = doubt_of(line, 0.0, 1.0, 0.0)
        offsets.append(offset + drift * (stated.settled_s - 1800) - 0.3 - 50e-6 * (stated.settled_s - 1800))
        drifts.append(drift - 50e-6)
    assert stated.settled_sigma_s == pytest.approx(np.std(offsets), rel=0.15)
    assert stated.drift_sigma == pytest.approx(np.std(drifts), rel=0.15)
    assert stated.wander_s == 0.0


def test_a_slope_that_a_few_seconds_hardly_tell_is_held_by_what_crystals_do():
    survey = np.array([20.0, 21, 22, 25, 26, 28])
    line = Line(0.0, 0.0, 23.0, survey, np.array([1, -1, 1, -1, 1, -1]) * 0.002)
    assert doubt_of(line, 0.0, 30e-6, 0.001).drift_sigma == pytest.approx(30e-6, rel=0.01)


def test_a_clock_that_bends_with_its_temperature_has_its_course_in_its_doubt():
    rng = np.random.default_rng(2)
    survey = np.sort(rng.uniform(0, 3600, 300))
    course = 0.010 * (1.5 * ((survey - 1800) / 1800) ** 2 - 0.5)  # second Legendre: no offset, no slope
    assert wander_s(survey, rng.normal(0, 0.003, 300), 0.003) == 0.0
    bent = course + rng.normal(0, 0.003, 300)
    assert wander_s(survey, bent, float(bent.std())) == pytest.approx(0.010 / np.sqrt(5), rel=0.15)


def test_the_doubt_grows_away_from_where_the_clocks_were_related():
    clock = ClockMap(0.0, 0.0, 0.05, "knocks", drift_sigma_ppm=30.0, settled_s=20.0, settled_sigma_s=0.002)
    assert clock.sigma_at(20.0) == pytest.approx(0.002)
    assert clock.sigma_at(1020.0) == pytest.approx(0.030, rel=0.01)
    assert ClockMap(sigma_s=0.5).sigma_at(np.array([0.0, 1e4])).tolist() == [0.5, 0.5]


def test_what_the_picture_shows_is_how_far_each_pair_lies_from_the_map():
    truth = ClockMap(-2.0, 100.0)
    survey = np.array([10.0, 500.0, 900.0])
    late = np.array([0.001, -0.002, 0.0])
    pairs = Pairs(survey, truth.to_audio(survey) - survey + late)
    fit = ClockFit(truth, pairs={str(PairKind.BUMPS): pairs})
    assert fit.residual_s(pairs) == pytest.approx(late, abs=1e-12)


def test_the_picture_of_clocks_that_fit_has_one_peak_at_zero_and_shows_the_knocks():
    rng = np.random.default_rng(3)
    truth = ClockMap(-2.0, 100.0, 0.002, "bumps", 1.0, 500.0, 0.002)
    both = np.sort(rng.uniform(0, 1000, 60))
    felt = np.sort(np.concatenate([both, rng.uniform(0, 1000, 40)]))
    heard = np.sort(np.concatenate([truth.to_audio(both), rng.uniform(0, 1000, 40)]))
    pairs = {str(PairKind.BUMPS): Pairs(both, truth.to_audio(both) - both)}
    picture = clock_picture(ClockFit(truth, (), pairs, felt, heard))
    peak = int(np.argmax(picture.counts))
    assert abs(picture.shift_ms[peak]) <= 10.0
    assert picture.counts[peak] + picture.counts[peak - 1] + picture.counts[peak + 1] >= 60
    assert np.delete(picture.counts, [peak - 1, peak, peak + 1]).max() <= 4
    assert picture.residual_ms == pytest.approx(np.zeros(60), abs=1e-9)
    close = picture.close_ups[0]
    assert close.end_s - close.start_s <= 30.0
    assert set(close.both_s) <= set(close.felt_s)
    assert picture.band_ms.min() == pytest.approx(1.96 * 2.0, rel=0.05)


def test_where_nothing_relates_the_clocks_the_picture_is_empty():
    picture = clock_picture(ClockFit(ClockMap()))
    assert picture.close_ups == ()
    assert len(picture.residual_ms) == len(picture.band_ms) == 0
    assert picture.counts.sum() == 0


# --- a clock that was measured while recording

MEASURED = ClockMap(0.8, 35.0)
KNOCKS = [*(22.3 + TAPS), *(270.1 + TAPS)]


def measured(off_s=0.005, off_ppm=0.3, sigma_s=0.010, sigma_ppm=0.5):
    """What a recorder would tell of the clock ``MEASURED``, off by so much."""
    return AudioInfo(
        start_time_s=MEASURED.start_s + off_s,
        drift_ppm=MEASURED.drift_ppm + off_ppm,
        start_sigma_s=sigma_s,
        drift_sigma_ppm=sigma_ppm,
    )


@pytest.mark.parametrize("off_s", [0.005, -0.005, 0.030])
def test_knocks_make_a_measured_clock_better(tmp_path, off_s):
    clock, codes = aligned(tmp_path, MEASURED, [(t, 25.0) for t in KNOCKS], 300, 11, measured(off_s))
    assert (clock.basis, codes) == ("knocks", ["clock_knocks"])
    assert error_s(clock, MEASURED, 300) < 0.004
    assert clock.sigma_s < 0.005
    assert clock.drift_ppm == pytest.approx(35.0, abs=4 * 0.5)


def test_an_even_rhythm_is_no_riddle_where_the_clock_was_measured(tmp_path):
    blows = [(t, 25.0) for t in [*(25 + np.arange(6.0)), *(270 + np.arange(6.0))]]
    assert aligned(tmp_path, MEASURED, blows, 300, 12)[0].basis == "assumed"
    clock, _ = aligned(tmp_path, MEASURED, blows, 300, 12, measured())
    assert clock.basis == "knocks"
    assert error_s(clock, MEASURED, 300) < 0.005


def test_knocks_at_the_start_alone_take_the_drift_that_was_measured(tmp_path):
    clock, codes = aligned(tmp_path, MEASURED, [(t, 25.0) for t in 22.3 + TAPS], 300, 13, measured(off_ppm=0.2))
    assert (clock.basis, codes) == ("knocks", ["clock_knocks"])
    assert (clock.drift_ppm, clock.drift_sigma_ppm) == (pytest.approx(35.2), pytest.approx(0.5))
    assert error_s(clock, MEASURED, 300) < 0.005


@pytest.mark.parametrize("seed", range(4))
def test_without_anything_felt_a_measured_clock_is_used_with_its_own_doubt(tmp_path, seed):
    clock, codes = aligned(tmp_path, MEASURED, [], 300, seed, measured(), strangers=(0, 15, 40, 120)[seed])
    assert (clock.basis, codes) == ("measured", ["clock_measured"])
    assert (clock.start_s, clock.drift_ppm) == (pytest.approx(0.805), pytest.approx(35.3))
    at = MEASURED.to_survey(np.array([0.0, 150.0, 300.0]))
    sigma_s = clock.sigma_at(at)
    assert sigma_s == pytest.approx([0.010, 0.010, 0.010], rel=0.01)
    assert (np.abs(clock.to_survey(MEASURED.to_audio(at)) - at) < 1.96 * sigma_s).all()


def test_a_measured_clock_that_knocks_contradict_is_told(tmp_path):
    clock, codes = aligned(tmp_path, MEASURED, [(t, 25.0) for t in KNOCKS], 300, 7, measured(off_s=2.0))
    assert clock.basis == "measured"
    assert codes == ["clock_measured", "clock_measured_contradicted"]


def test_one_sigma_alone_makes_no_measurement(tmp_path):
    told = AudioInfo(start_time_s=4.0, drift_ppm=11.0, start_sigma_s=0.01)
    clock, _ = aligned(tmp_path, MEASURED, [], 60, 1, told, strangers=0)
    assert (clock.basis, clock.start_s) == ("given", 4.0)


def test_without_sound_a_measured_clock_is_kept():
    assert align(imu_with([], 30, 0), None, measured(), SETTINGS).clock.basis == "measured"


def test_where_the_sound_breaks_off_nobody_knocked(tmp_path):
    blows = [(t, 0.7) for t in 20 + np.cumsum(np.array([0.0, 1.3, 0.8, 2.1]))]
    heard = sound_with(tmp_path, blows, 60, 1)
    gaps = tuple(AudioGap(t - 0.3, t + 0.05, "live_sound_lost") for t, _ in blows[:2])
    fit = align(imu_with([], 60, 0), heard, AudioInfo(), SETTINGS, gaps=gaps)
    near = np.array([np.abs(fit.heard_s - t).min() < 0.02 for t, _ in blows])
    assert near.tolist() == [False, False, True, True]
