"""The picture of a sound that has not been gone through, against the picture of the whole pass."""

import threading

import numpy as np
import pytest
import soundfile
from hypothesis import given
from hypothesis import strategies as st

from processing.errors import LeaklineError
from processing.settings import SoundSettings
from processing.sound import coarse
from processing.sound.coarse import CoarseTiles, GrowingPass, open_coarse
from processing.sound.scan import scan
from processing.sound.source import open_audio

RATE, SECONDS = 8000, 600
SETTINGS = SoundSettings()


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """Ten minutes: noise whose level rises by steps of 3 dB a minute, and a tone in the seventh."""
    rng = np.random.default_rng(0)
    t = np.arange(RATE * SECONDS) / RATE
    samples = 0.002 * 10 ** (np.floor(t / 60) * 3 / 20) * rng.standard_normal(len(t))
    samples += 0.2 * np.sin(2 * np.pi * 1500 * t) * ((t >= 360) & (t < 420))
    path = tmp_path_factory.mktemp("sound") / "a.wav"
    soundfile.write(path, samples, RATE)
    return open_audio([path])[0]


@pytest.fixture(scope="module")
def finished(source, tmp_path_factory):
    return scan(source, SETTINGS, out_dir=tmp_path_factory.mktemp("scan"))


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Leave nothing out for want of time: this machine may be busy."""
    monkeypatch.setattr(coarse, "_PATIENCE_S", 60.0)


def test_the_first_look_shows_the_course_of_the_levels_and_a_tone(source, finished):
    tiles = CoarseTiles(source, GrowingPass())
    looked = tiles.columns(0, SECONDS, 200, "mean")
    fine = finished.tiles.columns(0, SECONDS, 200, "mean")
    assert looked.shape == fine.shape
    assert (tiles.start_s, tiles.end_s) == (0, SECONDS)
    middle = slice(20, -20)
    difference = (looked[middle].astype(float) - fine[middle]).mean(axis=0) * tiles.step_db
    assert np.median(difference) == pytest.approx(-2.5, abs=0.5)  # the mean logarithm of noise lies 2.5 dB lower
    assert np.ptp(difference[np.r_[:118, 142:200]]) < 4  # one window a pixel, some two hundred rows
    row = np.argmin(abs(tiles.frequencies_hz - 1500))
    loud = looked[row - 1 : row + 2].max(axis=0).astype(float) - np.median(looked[row - 20 : row - 5], axis=0)
    assert (loud[121:139] > 60).all()
    assert (loud[:118] < 40).all()


def test_what_lies_outside_is_empty_and_what_is_close_is_exact(source, finished):
    tiles = CoarseTiles(source, GrowingPass())
    outside = tiles.columns(-60, SECONDS + 60, 720)
    assert (outside[:, :59] == 0).all()
    assert (outside[:, -59:] == 0).all()
    assert (outside[20:-20, 61:-61] > 0).all()
    close, stored = tiles.columns(100, 130, 100, "mean"), finished.tiles.columns(100, 130, 100, "mean")
    assert abs(close[5:].astype(float) - stored[5:]).mean() < 3


def test_a_slow_disc_gives_a_rough_picture_that_becomes_finer_each_time(source, monkeypatch):
    monkeypatch.setattr(coarse, "_PATIENCE_S", 0.0)  # sixteen windows an answer
    tiles = CoarseTiles(source, GrowingPass())
    known = tiles.known
    kinds = [len(np.unique(tiles.columns(0, SECONDS, 256), axis=1).T) for _ in range(17)]
    assert kinds[0] <= 16
    assert kinds[1] <= 32
    assert kinds[-1] >= 250
    assert kinds == sorted(kinds)
    assert tiles.known > known  # so one asks again
    settled = tiles.known
    tiles.columns(0, SECONDS, 256)
    assert tiles.known == settled


def test_finished_columns_take_the_place_of_the_first_look(source, finished, tmp_path):
    growing, seen = GrowingPass(), []
    tiles = open_coarse(source, growing)
    before = tiles.columns(0, SECONDS, 150)
    fine = finished.tiles.columns(0, SECONDS, 150)
    column_s = finished.grid.column_s

    def grown(folder, grid, columns):
        growing.grown(folder, grid, columns)
        if columns < grid.column_count and columns % 640 == 0:
            picture = tiles.columns(0, SECONDS, 150)
            done = int(columns * column_s / SECONDS * 150)
            assert growing.share == pytest.approx(columns / grid.column_count)
            assert (picture[:, : done - 1] == fine[:, : done - 1]).all()
            assert (picture[:, done + 1 :] == before[:, done + 1 :]).all()
            zoomed = tiles.columns(30, 100, 500, "mean")
            assert (zoomed == finished.tiles.columns(30, 100, 500, "mean")).all()
            seen.append(columns)

    result = scan(source, SETTINGS, out_dir=tmp_path, threads=1, grown=grown)
    assert len(seen) >= 3
    asked = []
    reader = threading.Thread(target=lambda: asked.append(tiles.columns(0, SECONDS, 150)))
    reader.start()  # the files are being renamed: it has to wait
    growing.finished(result)
    reader.join(10)
    assert (asked[0] == fine).all()
    assert growing.share == 1.0


def test_a_pass_that_was_stopped_or_is_of_another_sound_is_not_shown(source, finished, tmp_path):
    growing = GrowingPass()
    tiles = CoarseTiles(source, growing)
    before = tiles.columns(0, SECONDS, 100)
    growing.grown(tmp_path / "gone", finished.grid, 640)
    assert (tiles.columns(0, SECONDS, 100) == before).all()
    growing.grown(tmp_path, type(finished.grid)(44100.0, 10**8), 640)
    assert (tiles.columns(0, SECONDS, 100) == before).all()


def test_a_sound_of_a_moment_and_one_that_went_away_are_told_apart(tmp_path):
    path = tmp_path / "a.wav"
    soundfile.write(path, np.full(100, 0.1), RATE)
    short = open_audio([path])[0]
    assert open_coarse(short, GrowingPass()).columns(0, 0.0125, 5).shape[1] == 5
    soundfile.write(path, np.zeros(RATE * 100), RATE)
    long = open_audio([path])[0]
    path.unlink()
    with pytest.raises(LeaklineError):
        open_coarse(long, GrowingPass())


@given(st.integers(1, 3000))
def test_gaps_are_halved_in_turn(count):
    order = coarse._widest_gaps_first(count)
    assert sorted(order) == list(range(count))
    some = np.sort(order[: max(1, count // 4)])
    assert max(np.diff(np.r_[-1, some, count])) <= 16


@given(st.sets(st.integers(0, 50), min_size=1), st.lists(st.integers(0, 50), min_size=1))
def test_the_nearest_known_window_is_taken(known, wanted):
    found = coarse._nearest(np.array(sorted(known)), np.array(wanted))
    for place, near in zip(wanted, found):
        assert near in known
        assert abs(near - place) == min(abs(k - place) for k in known)
