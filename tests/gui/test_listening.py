"""Listening: modes change while it plays and the place is kept, equally loud, slowed without changing the pitch."""

import numpy as np
import pytest
import soundfile
from rolling_sound import RATE_HZ, noise, recorded, roll

from app.devices.slow_sound import SlowSound
from app.listening import Hearing, Listening, Loudness
from processing.settings import CleaningSettings
from processing.sound.cleaning import CleanReader, learn_cleaning
from processing.sound.loudness import a_weight
from processing.sound.source import AudioReader

BAND = (600.0, 1800.0)
RUN = roll(24.0, seed=6)
COUNT = len(RUN.time_s)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    rumble = np.cumsum(noise(COUNT, 0.004, seed=9)).astype(np.float32)
    rumble -= np.convolve(rumble, np.ones(400) / 400, mode="same").astype(np.float32)
    sound = noise(COUNT, 0.004) + RUN.swelling(0.01) + RUN.lines(0.01) + rumble
    return recorded(tmp_path_factory.mktemp("listening"), RUN, sound)


@pytest.fixture(scope="module")
def context(made):
    return learn_cleaning(made.audio, made.imu, made.scan, made.frames, made.clock, CleaningSettings())


def listening(made, hearing, context=None, *, matched=True):
    loudness = Loudness(made.audio.sample_rate_hz, made.audio.frames)
    return Listening(made.audio, hearing, context, loudness, matched=matched)


def heard(source, first, end, size=400):
    return np.concatenate([source(at, min(size, end - at)) for at in range(first, end, size)])


def loudness_of(sound):
    power = np.square(np.abs(np.fft.rfft(sound * np.hanning(len(sound)))))
    return 10 * np.log10(np.sum(power * a_weight(np.fft.rfftfreq(len(sound), 1 / RATE_HZ))))


def test_raw_is_exactly_what_was_recorded(made):
    source = listening(made, Hearing())
    with AudioReader(made.audio) as reader:
        np.testing.assert_array_equal(heard(source, 1000, 9000), reader.read(1000, 8000))
    source.close()


def test_cleaned_is_what_the_cleaner_reads(made, context):
    source = listening(made, Hearing(cleaned=True), context, matched=False)
    with CleanReader(made.audio, context) as reader:
        np.testing.assert_array_equal(heard(source, 50_000, 58_000), reader.read(50_000, 8000))
    source.close()


@pytest.mark.parametrize(
    "hearing", [Hearing(cleaned=True), Hearing(band_hz=BAND), Hearing(cleaned=True, band_hz=BAND)], ids=str
)
def test_every_mode_is_as_loud_as_the_raw_sound(made, context, hearing):
    raw, other = listening(made, Hearing()), listening(made, hearing, context)
    span = 40_000, 150_000
    assert loudness_of(heard(other, *span)) == pytest.approx(loudness_of(heard(raw, *span)), abs=1.5)
    raw.close()
    other.close()


def test_the_a_weighting_is_that_of_the_standard():
    # IEC 61672-1, table 3: at 10^(n/10) Hz, for nominal 31.5, 63 … 8000 Hz
    told = {15: -39.4, 18: -26.2, 21: -16.1, 24: -8.6, 27: -3.2, 30: 0.0, 33: 1.2, 36: 1.0, 39: -1.1}
    for n, db in told.items():
        assert 10 * np.log10(a_weight(np.array([10 ** (n / 10)]))[0]) == pytest.approx(db, abs=0.06)


def test_a_change_while_it_plays_goes_on_from_the_same_place_without_a_click(made, context):
    source = listening(made, Hearing(), matched=False)
    before = heard(source, 40_000, 44_000)
    source.context, source.hearing = context, Hearing(cleaned=True)
    fade, after = source(44_000, 400), heard(source, 44_400, 48_000)
    with AudioReader(made.audio) as raw, CleanReader(made.audio, context) as clean:
        np.testing.assert_array_equal(before, raw.read(40_000, 4000))
        np.testing.assert_array_equal(after, clean.read(44_400, 3600))
        first, last = raw.read(44_000, 400), clean.read(44_000, 400)
    assert fade[0] == pytest.approx(first[0], abs=1e-6)
    assert fade[-1] == pytest.approx(last[-1], abs=1e-6)
    source.hearing = Hearing()
    source(48_000, 400)
    with AudioReader(made.audio) as raw:
        np.testing.assert_array_equal(source(48_400, 400), raw.read(48_400, 400))
    source.close()


def test_without_what_the_cleaner_needs_the_raw_sound_is_heard(made):
    source = listening(made, Hearing(cleaned=True))
    with AudioReader(made.audio) as reader:
        np.testing.assert_array_equal(source(0, 500), reader.read(0, 500))
    source.close()


def test_after_a_jump_a_band_begins_without_swelling_up(made):
    whole, jumped = (listening(made, Hearing(band_hz=BAND), matched=False) for _ in range(2))
    expected = heard(whole, 0, 60_000)[50_000:]
    np.testing.assert_allclose(heard(jumped, 50_000, 60_000), expected, atol=1e-5)
    whole.close()
    jumped.close()


def slowed(sound, factor, size=400):
    slow = SlowSound(lambda start, count: sound[start : start + count], RATE_HZ)
    slow.factor = factor
    return np.concatenate([slow(at, min(size, len(sound) - at)) for at in range(0, len(sound), size)])


@pytest.mark.parametrize("factor", [2, 4])
def test_slowed_sound_lasts_longer_at_the_same_pitch_and_power(factor):
    time_s = np.arange(3 * RATE_HZ) / RATE_HZ
    tones = (0.2 * np.sin(2 * np.pi * 437.0 * time_s) + 0.2 * np.sin(2 * np.pi * 1511.0 * time_s)).astype(np.float32)
    out = slowed(tones, factor)
    assert len(out) == pytest.approx(factor * len(tones), rel=0.03)
    spectrum = np.abs(np.fft.rfft(out * np.hanning(len(out))))
    hz = np.fft.rfftfreq(len(out), 1 / RATE_HZ)
    for tone in (437.0, 1511.0):
        near = np.abs(hz - tone) < 100
        assert hz[near][np.argmax(spectrum[near])] == pytest.approx(tone, abs=2.0)
    assert np.std(out) == pytest.approx(np.std(tones), rel=0.05)
    hiss = noise(3 * RATE_HZ, 0.1)
    assert 20 * np.log10(np.std(slowed(hiss, factor)) / np.std(hiss)) == pytest.approx(0.0, abs=1.0)


def test_at_its_own_speed_nothing_is_changed_and_a_jump_begins_anew():
    hiss = noise(2 * RATE_HZ, 0.1)
    np.testing.assert_array_equal(slowed(hiss, 1), hiss)
    slow = SlowSound(lambda start, count: hiss[start : start + count], RATE_HZ)
    slow.factor = 2
    first = slow(4000, 400)
    slow(4400, 400)
    np.testing.assert_array_equal(slow(4000, 400), first)
    np.testing.assert_allclose(first[:50], hiss[4000:4050])  # it begins where it shall


def test_bumps_keep_their_order_and_their_spacing_is_stretched():
    clicks = np.zeros(4 * RATE_HZ, np.float32)
    places = np.arange(4000, 28_000, 4000)
    clicks[places] = 1.0
    out = slowed(clicks + noise(4 * RATE_HZ, 0.001), 2)
    peaks = np.flatnonzero(out > 0.4)
    groups = np.split(peaks, np.flatnonzero(np.diff(peaks) > 1000) + 1)
    assert [np.mean(g) for g in groups] == pytest.approx(2 * places, abs=0.03 * RATE_HZ)


def test_a_recording_that_cannot_be_read_is_an_error_of_the_thread(made, tmp_path):
    from processing.errors import LeaklineError
    from processing.sound.source import open_audio

    file = tmp_path / "gone.wav"
    soundfile.write(file, noise(8000, 0.1), RATE_HZ)
    audio, _ = open_audio([file])
    file.unlink()
    source = Listening(audio, Hearing(), None, Loudness(RATE_HZ, audio.frames))
    with pytest.raises(LeaklineError):
        source(0, 100)
