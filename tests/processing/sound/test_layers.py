"""The statistics of the search in layers against closed forms, and its behaviour on small runs made in memory."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sound_runs import Leak, drift

from processing.settings import DetectorSettings
from processing.sound.cells import CELL_M, Cells, cells_of, frames_of
from processing.sound.layers import confidence, find_in_layers
from processing.sound.passed_source import Source, fit_source
from processing.sound.sound_field import OVERLAP, amplitudes, flattened, passing, sound_field
from processing.sound.source_spectra import leak_spectra, rumble_spectra
from processing.sound.spots import Listening
from processing.sound.whitening import Whitened, likelihood_ratio, spiked

SETTINGS = DetectorSettings(min_score=0.0)
BANDS = np.column_stack([np.geomspace(90, 7200, 29)[:-1], np.geomspace(90, 7200, 29)[1:]])


def spots(run, settings=SETTINGS):
    frames = frames_of(run.scan, run.clock, run.track, (), settings)
    return find_in_layers(Listening(run.scan, frames, cells_of(run.scan, frames), settings))


def cells_from(log_power, frames=1.0, speed=0.6):
    count = len(log_power)
    return Cells(
        chainage_m=(np.arange(count) + 0.5) * CELL_M,
        time_s=np.arange(count) / speed,
        speed_mps=np.full(count, speed),
        heard=np.ones(count, np.bool_),
        log_power=np.column_stack([log_power, log_power[:, 0]]),
        removed_share=np.zeros((count, log_power.shape[1] + 1), np.float32),
        frames=np.full(count, frames),
    )


@pytest.mark.parametrize("looks", [4, 20, 100])
def test_the_variance_of_log_power_is_that_of_the_mean_of_so_many_exponentials(looks):
    # Var(ln of a gamma variate of shape N) is the trigamma function: 1/N + 1/(2N²) + …
    power = np.random.default_rng(looks).gamma(looks, 1.0 / looks, (8000, 2))
    field = sound_field(cells_from(np.log(power)))
    assert field.variance == pytest.approx(1 / looks + 1 / (2 * looks**2), rel=0.12)


@pytest.mark.parametrize("width", [0.8, 3.6])
def test_heights_of_white_noise_have_the_variance_that_their_information_says(width):
    noise = np.random.default_rng(3).normal(0, 1, (6000, 3))
    height, information = amplitudes(noise, np.ones(6000), width)
    inner = slice(200, -200)
    # independent cells here: the allowance for overlapping ones is taken off
    assert height[inner].var() * information[inner].mean() * OVERLAP == pytest.approx(1.0, rel=0.1)


def test_a_shape_that_was_drawn_has_its_height_and_a_level_has_none():
    place = np.arange(800) * CELL_M
    drawn = 0.7 * passing(place - 100.0, 2.2)[:, None] + 5.0
    height, _ = amplitudes(drawn, np.ones(800), 2.2)
    assert height[400, 0] == pytest.approx(0.7, rel=1e-6)
    assert abs(amplitudes(np.full((800, 1), 5.0), np.ones(800), 2.2)[0]).max() < 1e-9


def test_speed_that_rolling_and_flow_follow_leaves_nothing_behind():
    rng = np.random.default_rng(0)
    count = 2400
    speed = 0.6 * np.exp(0.3 * np.interp(np.arange(count), np.arange(0, count + 40, 40), rng.normal(0, 1, 61)))
    power = 0.3 + 0.7 * (speed / 0.6) ** 2 + 2 * (speed / 0.6) ** 3
    cells = replace(cells_from(np.log(power)[:, None] * np.ones(3)), speed_mps=speed)
    field = sound_field(cells)
    assert flattened(field, field.log_power, 24.0).std() < 0.05 * np.log(power).std()


def test_few_strong_factors_are_found_among_even_noise():
    rng = np.random.default_rng(1)
    loads = rng.normal(0, 1, (2, 28))
    values = rng.normal(0, 1, (4000, 28)) + rng.normal(0, 5, (4000, 2)) @ loads
    precision, noise = spiked(values, 4000.0)
    truth = np.linalg.inv(np.eye(28) + 25 * loads.T @ loads)
    assert noise == pytest.approx(1.0, rel=0.05)
    assert np.linalg.norm(precision - truth) < 0.12 * np.linalg.norm(truth)


def test_the_likelihood_ratio_of_one_spectrum_follows_its_law_where_nothing_is():
    # one spectrum of strength ≥ 0 in white noise: half a point mass at 0, half a normal distribution's upper half
    direction = np.ones((28, 1)) / np.sqrt(28)
    layer = Whitened(1.0, np.eye(28), np.zeros((0, 28)), direction, np.zeros((28, 1)) + np.eye(28, 1), 1.0)
    rng = np.random.default_rng(2)
    ratios = np.array([likelihood_ratio(layer, rng.normal(0, 1, 28))[0] for _ in range(3000)])
    assert np.mean(ratios > 0) == pytest.approx(0.5, abs=0.04)
    assert np.mean(ratios > 1.645) == pytest.approx(0.05, abs=0.02)


def test_a_rumble_of_any_strength_is_no_leak_and_a_leak_beside_it_is():
    leaks, rivals = leak_spectra(BANDS), rumble_spectra(BANDS)
    layer = Whitened(1.0, np.eye(28), np.zeros((0, 28)), leaks, rivals, 1.0)
    assert likelihood_ratio(layer, 40 * rivals[:, 3] + 15 * rivals[:, 10])[0] < 0.5
    assert likelihood_ratio(layer, 40 * rivals[:, 3] + 15 * leaks[:, 70])[0] > 8


@pytest.mark.parametrize(("before", "after", "is_exponential"), [(1.5, 1.5, False), (1.2, 2.4, True)])
def test_a_source_is_fitted_with_its_place_its_sides_and_its_spectrum(before, after, is_exponential):
    rng = np.random.default_rng(5)
    place = (np.arange(600) + 0.5) * CELL_M
    strength = np.linspace(0.5, 8.0, 12)
    source = Source(75.3, before, after, is_exponential, strength)
    excess = source.log_rise(place) + rng.normal(0, 0.05, (600, 12))
    field = sound_field(cells_from(excess))
    fitted = fit_source(field, excess, field.weight, 302, 2.2)
    assert fitted is not None
    assert fitted.place_m == pytest.approx(75.3, abs=0.1)
    assert (fitted.before_m, fitted.after_m) == pytest.approx((before, after), rel=0.2)
    assert fitted.is_exponential == is_exponential
    assert fitted.strength == pytest.approx(strength, rel=0.3)
    assert abs(excess - fitted.log_rise(place)).std() < 0.06


def test_a_weak_leak_beside_a_strong_one_is_found():
    pair = (Leak(100, 1.2, 14), Leak(112, 1.5, 2), Leak(180, 1.5, 6))
    found = {round(s.place) for s in spots(drift(pair, seed=2, seconds=700.0)) if s.score > 0.5}
    assert {100, 112, 180} <= found
    assert len(found) <= 4


@settings(max_examples=3, deadline=None)
@given(st.floats(0.01, 100.0))
def test_the_gain_of_the_recorder_does_not_matter(gain):
    run = drift((Leak(60), Leak(130, 2.0, 3)), seed=4, seconds=300.0)
    louder = replace(run.scan, level_db=run.scan.level_db.astype(np.float64) + 10 * np.log10(gain))
    exact = replace(run.scan, level_db=run.scan.level_db.astype(np.float64))
    before, after = (spots(replace(run, scan=scan)) for scan in (exact, louder))
    assert [round(s.place, 3) for s in before[:2]] == [round(s.place, 3) for s in after[:2]]


def test_stops_hide_no_leak():
    leaks = (Leak(50), Leak(110, 1.5, 4))
    for stops in ((), ((60, 10), (150, 8))):
        found = {round(s.place / 2) for s in spots(drift(leaks, seed=6, stops=stops, seconds=700.0)) if s.score > 0.5}
        assert {25, 55} <= found


def test_a_burst_that_is_shorter_than_any_leak_sounds_is_none():
    def scraping(time, place, hz):
        return ((hz > 1200) & (hz < 4800)) * 20.0 * (np.abs(time - 150.0) < 0.4)[:, None]

    run = drift((Leak(60),), seed=3, seconds=700.0, extra=scraping)
    scraped = float(np.interp(150.0, run.time_s, run.chainage_m))
    assert not [s for s in spots(run) if s.score > 0.3 and abs(s.place - scraped) < 3]


def test_confidence_grows_with_the_likelihood_ratio():
    values = [confidence(x) for x in (-1.0, 0.0, 2.0, 6.0, 10.0, 100.0)]
    assert values == sorted(values)
    assert values[0] < 1e-3
    assert values[-1] > 0.99
