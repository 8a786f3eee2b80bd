"""Leaks at known places, and what is not a leak, through both detectors."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import soundfile
from sound_runs import Leak, drift

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.settings import DetectorSettings, SoundSettings
from processing.sound.apex import fit_apex, rise_and_fall
from processing.sound.candidates import DETECTORS, find_candidates
from processing.sound.matching import confidence
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import (
    AudioInfo,
    Channel,
    ClockMap,
    LeakClass,
    ProcessingChoice,
    Stretch,
    Survey,
    Track,
)

SETTINGS = DetectorSettings()
FIVE = (Leak(40), Leak(85, 0.9, 12), Leak(130, 3.0, 8, 900), Leak(170, 2.0, 10, 1800), Leak(205, 1.2, 14))


def heard(run, detector="auto", settings=SETTINGS, track=True, **kwargs):
    survey = Survey(processing=ProcessingChoice(detector=detector))
    result = find_candidates(run.scan, run.clock, run.track if track else None, survey, settings, **kwargs)
    for finding, language in itertools.product(result.findings, messages.LANGUAGES):
        assert messages.finding_sentence(finding, language)
    return result


def near(candidates, place, within=5.0):
    return [c for c in candidates if abs(c.chainage_m - place) <= within]


@pytest.mark.parametrize("detector", DETECTORS)
def test_leaks_that_stand_out_are_found_where_they_are(detector):
    result = heard(drift(FIVE, seed=3), detector)
    for leak in FIVE:
        found = near(result.candidates, leak.place_m)
        assert len(found) == 1, leak
        assert found[0].chainage_m == pytest.approx(leak.place_m, abs=max(0.4, 0.3 * leak.width_m))
        assert found[0].score > 0.5
        assert found[0].leak_class is LeakClass.LEAK
        assert found[0].width_m == pytest.approx(leak.width_m, rel=0.6)
    false = [c for c in result.candidates if not any(abs(c.chainage_m - leak.place_m) < 6 for leak in FIVE)]
    assert len([c for c in false if c.score > 0.5]) <= 1


def test_what_hardly_sounded_like_a_leak_is_not_listed_for_being_known_for_something_else():
    found = heard(drift((Leak(80, 1.5, 8.0),), seed=0), "agreed").candidates
    assert near(found, 80.0)
    for candidate in found:
        assert max(candidate.score, candidate.evidence["heard_score"]) >= SETTINGS.min_score


@pytest.mark.parametrize("detector", DETECTORS)
def test_the_list_is_ordered_numbered_and_placed(detector):
    run = drift(FIVE, seed=4, sigma_m=0.3)
    result = heard(run, detector)
    scores = [c.score for c in result.candidates]
    assert scores == sorted(scores, reverse=True)
    assert [c.id for c in result.candidates] == list(range(1, len(scores) + 1))
    for c in result.candidates:
        assert 0 <= c.score <= 1
        assert c.chainage_low95_m < c.chainage_m < c.chainage_high95_m
        assert c.chainage_high95_m - c.chainage_low95_m > 2 * 1.96 * 0.3
        assert np.interp(c.time_s, run.time_s, run.chainage_m) == pytest.approx(c.chainage_m, abs=0.05)
        assert c.position_w_m[0] == pytest.approx(c.chainage_m, abs=0.05)
        assert 0 < c.band_hz[0] < c.band_hz[1]


def test_stated_intervals_hold_the_truth():
    inside, errors = [], []
    for seed in range(6):
        result = heard(drift(FIVE, seed=seed + 50, sigma_m=0.0), "metres")
        for leak in FIVE:
            for c in near(result.candidates, leak.place_m):
                inside.append(c.chainage_low95_m <= leak.place_m <= c.chainage_high95_m)
                errors.append(c.chainage_m - leak.place_m)
    assert len(inside) >= 28
    assert np.mean(inside) >= 0.85
    assert np.sqrt(np.mean(np.square(errors))) < 0.25


@pytest.mark.parametrize(("detector", "most"), [("metres", 1.5), ("envelope", 3.0)])
def test_without_leaks_there_is_little_to_review(detector, most):
    runs = [drift(seed=seed, seconds=600) for seed in range(4)]
    false = sum(sum(c.score >= 0.5 for c in heard(run, detector).candidates) for run in runs)
    kilometres = sum(run.chainage_m[-1] for run in runs) / 1000
    assert false / kilometres <= most


def test_the_detector_in_metres_ignores_rumbling_bends_and_passing_traffic():
    def rumble(time, place, hz):
        low = 1 / (1 + (hz / 250) ** 4)
        bend = 12 / (1 + ((place - 100) / 1.5) ** 2)
        traffic = 15 * np.exp(-0.5 * ((time - 280) / 4) ** 2)
        return low * (bend + traffic)[:, None]

    run = drift((Leak(60),), seed=8, extra=rumble)
    likely = [c for c in heard(run, "metres").candidates if c.score > 0.5]
    assert [round(c.chainage_m / 3) for c in likely] == [20]


def test_bumps_do_not_make_leaks():
    quiet = heard(drift((Leak(60),), seed=9, bumps=False), "metres")
    bumpy = heard(drift((Leak(60),), seed=9, bumps=True), "metres")
    assert [c.score > 0.5 for c in near(bumpy.candidates, 60)] == [True]
    assert sum(c.score > 0.5 for c in bumpy.candidates) <= sum(c.score > 0.5 for c in quiet.candidates)


@pytest.mark.parametrize("detector", DETECTORS)
def test_no_candidate_lies_where_the_sound_is_not_assessed(detector):
    run = drift(FIVE, seed=3)
    start, end = np.interp([80, 90], run.chainage_m, run.time_s)
    masked = (Stretch(float(start), float(end), Channel.SOUND, "sound_clipped"),)
    result = heard(run, detector, not_assessed=masked)
    assert near(heard(run, detector).candidates, 85)
    assert not near(result.candidates, 85, 4.5)
    assert near(result.candidates, 40)
    inside = (result.along.chainage_m > 81) & (result.along.chainage_m < 89)
    assert np.isnan(result.along.level_db[inside]).all()


@pytest.mark.parametrize("detector", DETECTORS)
def test_frames_that_the_scan_found_bad_do_not_count(detector):
    run = drift(FIVE, seed=3)
    state = run.scan.state.copy()
    state[np.abs(run.chainage_m - 85) < 6] = 4
    run = replace(run, scan=replace(run.scan, state=state))
    assert not near(heard(run, detector).candidates, 85)


def test_sound_that_comes_and_goes_while_the_device_stands_is_traffic():
    def passing(time, place, hz):
        return np.exp(-0.5 * (np.log2(hz / 1300) / 0.7) ** 2) * (25 * np.exp(-0.5 * ((time - 200) / 5) ** 2))[:, None]

    run = drift((Leak(60),), seed=11, stops=((190, 14),), extra=passing)
    stood_at = float(np.interp(196, run.time_s, run.chainage_m))
    for c in near(heard(run, "metres").candidates, stood_at, 4):
        assert c.leak_class is LeakClass.TRAFFIC
        assert c.evidence["stood_s"] > 8


def test_the_clock_s_doubt_widens_the_interval_by_the_speed():
    run = drift((Leak(60),), seed=1, sigma_m=0.0)
    sharp = near(heard(run).candidates, 60)[0]
    vague = near(heard(replace(run, clock=ClockMap(sigma_s=1.0))).candidates, 60)[0]
    half = (vague.chainage_high95_m - vague.chainage_low95_m) / 2
    expected = 1.96 * np.hypot(sharp.evidence["sigma_sound_m"], 1.0 * sharp.evidence["speed_mps"])
    assert half == pytest.approx(expected, rel=0.01)
    assert sharp.evidence["speed_mps"] == pytest.approx(0.6, abs=0.25)


def test_a_wrong_clock_moves_the_leak_by_speed_times_time():
    run = drift((Leak(60),), seed=1)
    moved = near(heard(replace(run, clock=ClockMap(start_s=3.0))).candidates, 61.8)[0]
    speed = np.interp(60, run.chainage_m, run.speed_mps)
    assert moved.chainage_m == pytest.approx(60 + 3 * speed, abs=0.4)


def test_without_a_path_there_are_candidates_in_time_only():
    run = drift(FIVE, seed=3)
    result = heard(run, track=False)
    assert result.along is None
    assert result.findings[0].code == "detector_envelope"
    when = np.interp(205, run.chainage_m, run.time_s)
    best = min(result.candidates, key=lambda c: abs(c.time_s - when))
    assert best.time_s == pytest.approx(when, abs=1.0)
    assert all(
        np.isnan([c.chainage_m, c.chainage_low95_m, c.chainage_high95_m, c.width_m]).all() for c in result.candidates
    )


def test_auto_takes_the_detector_that_the_length_allows_and_says_why():
    long, short = drift(seed=1), drift(seed=1, seconds=100)
    assert [f.code for f in heard(long).findings] == ["detector_metres"]
    assert [f.code for f in heard(short).findings] == ["detector_envelope"]
    tiny = drift(seed=1, seconds=8)
    assert [f.code for f in heard(tiny, "metres").findings] == ["detector_needs_path"]
    with pytest.raises(LeaklineError) as caught:
        heard(long, "magic")
    assert caught.value.code == ErrorCode.SETTING_INVALID


def test_the_papers_order_ranks_by_height_alone():
    def louder_end(time, place, hz):
        return np.where(place > 150, 12.0, 0.0)[:, None] * np.ones(len(hz))

    run = drift((Leak(60, 2.0, 6),), seed=5, extra=louder_end)
    plain = replace(SETTINGS, envelope_order="plain", min_score=0.0)
    ranked = heard(run, "envelope", plain).candidates
    assert ranked[0].chainage_m > 148
    local = heard(run, "envelope", replace(SETTINGS, min_score=0.0)).candidates
    assert local[0].chainage_m == pytest.approx(60, abs=1)


def test_the_list_has_a_greatest_length_and_may_be_empty():
    run = drift(FIVE, seed=3)
    assert len(heard(run, "metres", replace(SETTINGS, max_candidates=2.0, min_score=0.0)).candidates) == 2
    assert heard(run, "metres", replace(SETTINGS, min_score=1.0)).candidates == ()
    deaf = replace(run, scan=replace(run.scan, state=np.ones_like(run.scan.state)))
    result = heard(deaf)
    assert (result.candidates, result.along) == ((), None)
    assert [f.code for f in result.findings] == ["sound_misses_path"]


def test_path_without_sound_is_told_as_stretches():
    run = drift((Leak(60),), seed=1)
    late = heard(replace(run, clock=ClockMap(start_s=30.0)))
    assert [(s.start_s, round(s.end_s), s.reason) for s in late.not_assessed] == [(0.0, 30, "no_sound")]
    early = heard(replace(run, clock=ClockMap(start_s=-30.0)))
    assert [(round(s.start_s), s.reason) for s in early.not_assessed] == [(370, "no_sound")]
    assert all(messages.text("reasons", s.reason, "tr") for s in late.not_assessed)


def test_the_level_along_the_pipe_shows_the_leak_above_its_threshold():
    result = heard(drift((Leak(60, 2.0, 12),), seed=2))
    along = result.along
    above = along.level_db > along.threshold_db
    near_leak = np.abs(along.chainage_m - 60) < 8
    assert above[np.abs(along.chainage_m - 60) < 2].all()
    assert above[~near_leak].mean() < 0.03
    at = np.argmin(abs(along.chainage_m - 60))
    assert along.level_db[at] - along.background_db[at] == pytest.approx(10, abs=4)
    assert (np.diff(along.chainage_m) == 0.25).all()


@pytest.mark.parametrize(("place", "width", "height"), [(50.0, 1.0, 10.0), (52.3, 0.6, 3.0), (48.8, 3.0, 1.0)])
def test_the_fit_returns_the_apex_that_was_drawn(place, width, height):
    s = np.arange(0, 100, 0.25)
    rng = np.random.default_rng(0)
    drawn = rise_and_fall(s, height, place, width, 0.1) + rng.normal(0, 0.03, len(s))
    apex = fit_apex(s, drawn, place + 0.4, 1.3)
    assert apex.chainage_m == pytest.approx(place, abs=3 * apex.sigma_m)
    assert apex.chainage_m == pytest.approx(place, abs=0.12)
    assert apex.width_m == pytest.approx(width, rel=0.2)
    assert apex.height == pytest.approx(height, rel=0.2)


def test_confidence_is_half_at_the_published_score_and_grows_with_it():
    assert confidence(np.array([7.6]))[0] == pytest.approx(0.5, abs=0.01)
    assert (np.diff(confidence(np.linspace(0, 50, 200))) >= 0).all()
    assert confidence(np.array([-np.inf, -3.0, 0.0])).max() < 1e-6


@pytest.mark.data
@pytest.mark.parametrize("name", ["no-leak", "orifice-leak"])
def test_a_leak_laid_over_a_real_pipe_is_placed_within_centimetres(tmp_path, shared_data, name):
    background, rate = soundfile.read(shared_data / "hydrophone_pvc" / f"{name}.wav")
    background = np.tile(background, int(np.ceil(70 * rate / len(background))))[: 70 * rate]
    time = np.arange(len(background)) / rate
    place = 0.5 * time
    rng = np.random.default_rng(0)
    hiss = rng.standard_normal(len(time))
    # noise of the background's own loudness in the chosen band, ten times as strong where the leak is passed
    band = np.fft.rfft(background)
    hz = np.fft.rfftfreq(len(background), 1 / rate)
    inside = (hz > 500) & (hz < 3800)
    in_band = np.sqrt((np.abs(band[inside]) ** 2).sum() * 2) / len(background)
    leak = hiss * in_band * np.sqrt(10 / (1 + ((place - 17.35) / 0.8) ** 2))
    path = tmp_path / "a.wav"
    soundfile.write(path, np.clip(background + leak, -1, 1), rate, subtype="PCM_16")
    source, _ = open_audio([path])
    flat = np.zeros(len(time[::400]))
    track = Track(
        time[::400], place[::400], np.column_stack([place[::400], flat, flat]), flat, flat, flat,
        np.tile([1.0, 0, 0, 0], (len(flat), 1)), flat + 0.5, "truth",
    )  # fmt: skip
    listened = scan(source, SoundSettings(), out_dir=tmp_path / "scan")
    survey = Survey(audio=AudioInfo(), processing=ProcessingChoice(detector="envelope"))
    # real pipes crack and gurgle by 10 dB: the score stays modest, the place is the point here
    found = find_candidates(listened, ClockMap(), track, survey, replace(SETTINGS, min_score=0.0)).candidates
    assert found[0].chainage_m == pytest.approx(17.35, abs=0.1)
    assert found[0].chainage_low95_m <= 17.35 <= found[0].chainage_high95_m


def test_the_names_that_a_form_offers_are_the_detectors_table():
    from processing.sound.candidates import DETECTORS
    from processing.sound.detector_names import DETECTOR_NAMES

    assert tuple(DETECTORS) == DETECTOR_NAMES
