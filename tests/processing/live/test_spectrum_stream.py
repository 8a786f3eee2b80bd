"""The live spectrogram against the offline one of the same sound, and against closed forms."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from processing.live.spectrum_stream import SpectrumStream
from processing.live.stream import SoundBlock
from processing.sound.bands import Grid
from processing.sound.tile_values import TILE_POWER, tile_db
from processing.sound.tiles import spectrogram_detail
from processing.survey import AudioPart, AudioSource

RATE = 16_000.0


def noise(seconds, rate=RATE, seed=0):
    rng = np.random.default_rng(seed)
    return (rng.normal(0.0, 0.02, int(seconds * rate)) * 2.0**31).astype(np.int32)[:, None]


def sine(hz, seconds, rate=RATE, size=0.5):
    t = np.arange(int(seconds * rate)) / rate
    return (size * np.sin(2 * np.pi * hz * t) * (2.0**31 - 1)).astype(np.int32)[:, None]


def feed(stream, frames, cuts=(), host_s=50.0):
    edges = [0, *cuts, len(frames)]
    for a, b in pairwise(edges):
        stream.add(SoundBlock(frames[a:b], a, host_s + a / stream.sample_rate_hz))


def test_live_columns_are_those_of_the_review_of_the_same_sound(tmp_path):
    import soundfile

    frames = noise(4.0)
    soundfile.write(tmp_path / "a.wav", frames, int(RATE), subtype="PCM_32")
    stream = SpectrumStream(RATE)
    feed(stream, frames, range(320, len(frames), 320))
    live = stream.columns()
    source = AudioSource((AudioPart(tmp_path / "a.wav", len(frames)),), RATE, 1)
    count = len(live.tiles)
    review = spectrogram_detail(source, 0.0, count * live.column_s, count).T
    # the review may look at windows elsewhere within the column where a pixel is no whole number of hops; here it is
    assert np.mean(np.abs(tile_db(live.tiles[1:-1]) - tile_db(review[1:-1])) <= 0.5) > 0.999
    np.testing.assert_array_equal(live.frequency_hz, Grid(RATE, 1).picture_hz())


@pytest.mark.parametrize("rate", [8_000.0, 48_000.0, 192_000.0])
def test_a_sine_stands_at_its_frequency_with_its_level(rate):
    hz, stream = 0.11 * rate, SpectrumStream(rate)
    feed(stream, sine(hz, 1.0, rate))
    columns = stream.columns()
    row = int(np.argmax(columns.tiles[5]))
    assert abs(columns.frequency_hz[row] - hz) <= np.diff(columns.frequency_hz)[0]
    assert tile_db(columns.tiles[5, row : row + 1])[0] == pytest.approx(-6.02, abs=1.5)  # scalloping of a Hann window
    inside = [k for k, (low, high) in enumerate(columns.bands_hz[:-1]) if low < hz < high]
    assert columns.levels_db[5, inside[0]] == pytest.approx(-6.02, abs=0.05)


def test_bands_of_white_noise_hold_their_share_of_its_power():
    stream = SpectrumStream(48_000.0)
    feed(stream, noise(20.0, 48_000.0))
    columns = stream.columns()
    width = np.diff(columns.bands_hz, axis=1)[:, 0]
    power = 10.0 ** (columns.levels_db[2:] / 10.0)
    expected = 2.0 * 0.02**2 * width / 24_000.0  # 0 dB is a full-scale sine, whose variance is one half
    np.testing.assert_allclose(power.mean(axis=0), expected, rtol=0.04)


@hypothesis_settings(max_examples=25, deadline=None)
@given(st.lists(st.integers(1, 15_999), max_size=12, unique=True))
def test_however_the_sound_is_cut_the_columns_are_the_same(cuts):
    frames = noise(1.0)
    whole, cut = SpectrumStream(RATE), SpectrumStream(RATE)
    feed(whole, frames)
    feed(cut, frames, sorted(cuts))
    np.testing.assert_array_equal(whole.columns().tiles, cut.columns().tiles)
    np.testing.assert_allclose(whole.columns().levels_db, cut.columns().levels_db, atol=1e-3)


def test_a_column_is_there_within_a_tenth_of_a_second_and_knows_when_it_was_heard():
    for rate in (16_000.0, 48_000.0, 96_000.0):
        stream, block = SpectrumStream(rate), int(0.02 * rate)
        frames = noise(1.0, rate)
        for a in range(0, len(frames) - block, block):
            stream.add(SoundBlock(frames[a : a + block], a, 7.0 + a / rate))
            columns = stream.columns()
            if len(columns.tiles):
                end_s = (columns.first + len(columns.tiles)) * columns.column_s
                assert columns.host_s[-1] == pytest.approx(7.0 + end_s)
                # from the newest sample of a column to its being there
                assert (a + block) / rate - end_s < 0.1


def test_lost_sound_is_a_gap_of_its_length_and_the_rest_stays_in_its_place():
    frames = noise(6.0)
    whole, holed = SpectrumStream(RATE), SpectrumStream(RATE)
    feed(whole, frames)
    lost = slice(32_000, 48_000)
    holed.add(SoundBlock(frames[: lost.start], 0, 50.0))
    holed.add(SoundBlock(frames[lost.stop :], lost.stop, 53.0, lost_before=16_000, reason="sound_input_lost"))
    a, b = whole.columns(), holed.columns()
    inside = np.arange(len(b.tiles))
    middle_s = (inside + 0.5) * b.column_s
    np.testing.assert_array_equal(b.is_gap, ((inside + 1) * b.column_s > 2.0) & (inside * b.column_s < 3.0))
    away = np.abs(middle_s - 2.5) > 0.6
    np.testing.assert_array_equal(a.tiles[away], b.tiles[away])
    assert b.tiles[np.abs(middle_s - 2.5) < 0.4].max() == 0


def test_a_gap_longer_than_the_picture_costs_no_memory_and_leaves_an_empty_picture():
    stream = SpectrumStream(RATE, span_s=5.0)
    stream.add(SoundBlock(noise(1.0), 0, 50.0))
    hours = int(3 * 3600 * RATE)
    stream.add(SoundBlock(noise(1.0), hours, 50.0 + 3 * 3600))
    columns = stream.columns()
    assert len(columns.tiles) <= stream.capacity
    assert columns.first + len(columns.tiles) == pytest.approx(
        3 * 3600 / columns.column_s + 1.0 / columns.column_s, abs=2
    )
    assert columns.is_gap[:-25].all()
    assert not columns.is_gap[-15:].any()


def test_only_the_last_seconds_are_kept_and_only_new_columns_are_handed_out():
    stream = SpectrumStream(RATE, span_s=2.0)
    feed(stream, noise(5.0), range(800, 80_000, 800))
    columns = stream.columns()
    assert len(columns.tiles) == stream.capacity
    assert columns.first > 0
    assert len(stream.columns(columns.first + len(columns.tiles) - 3).tiles) == 3
    assert len(stream.columns(columns.first + len(columns.tiles)).tiles) == 0


def test_a_short_click_is_seen_whatever_its_place_in_the_column():
    for at in range(16_000, 17_000, 90):
        frames = np.zeros((32_000, 1), np.int32)
        frames[at] = 2**30
        stream = SpectrumStream(RATE)
        feed(stream, frames)
        columns = stream.columns()
        loudest = int(np.argmax(TILE_POWER[columns.tiles].sum(axis=1)))
        assert abs(loudest - at / (columns.column_s * RATE)) <= 1.5


def test_the_chosen_channel_is_looked_at():
    frames = np.hstack([np.zeros((16_000, 1), np.int32), sine(2000.0, 1.0)])
    silent, loud = SpectrumStream(RATE, channel=0), SpectrumStream(RATE, channel=1)
    feed(silent, frames)
    feed(loud, frames)
    assert silent.columns().tiles.max() == 0
    assert loud.columns().tiles.max() > 200
