"""The streamed pass against tones, noise and damage of known size."""

import itertools
import json

import numpy as np
import pytest
import soundfile
from scipy import signal

from processing import messages
from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.progress import Progress
from processing.settings import SoundSettings
from processing.sound.analysis import CLIPPED, DROPOUT, SILENT
from processing.sound.bands import Grid
from processing.sound.scan import SoundScan, scan
from processing.sound.source import open_audio
from processing.sound.tiles import spectrogram_detail, tile_db
from processing.survey import Channel, ClockMap

RATE = 44100
SETTINGS = SoundSettings()


def scanned(folder, samples, rate=RATE, subtype="FLOAT", settings=SETTINGS, **kwargs):
    path = folder / "a.wav"
    soundfile.write(path, samples, rate, subtype=subtype)
    source, _ = open_audio([path])
    result = scan(source, settings, out_dir=folder / "scan", **kwargs)
    for finding, language in itertools.product(result.findings, messages.LANGUAGES):
        assert messages.finding_sentence(finding, language)
    return source, result


def sine(seconds, hz, level_db, rate=RATE):
    return 10 ** (level_db / 20) * np.sin(2 * np.pi * hz * np.arange(int(seconds * rate)) / rate)


def band_of(result, hz):
    low, high = result.bands_hz[:-1].T
    return int(np.flatnonzero((low <= hz) & (hz < high))[0])


@pytest.mark.parametrize("rate", [8000, 16000, 44100, 48000, 96000])
def test_a_tone_of_known_level_reads_that_level_in_its_band_and_in_the_picture(tmp_path, rate):
    _, result = scanned(tmp_path, sine(4, 1620, -30, rate), rate)
    assert result.duration_s == pytest.approx(4)
    assert 0.05 < result.frame_s < 0.08
    inside = np.asarray(result.level_db[2:-2], float)
    assert inside[:, -1] == pytest.approx(-30, abs=0.1)
    assert inside[:, band_of(result, 1620)] == pytest.approx(-30, abs=0.3)
    picture = tile_db(result.tiles.columns(1, 3, 10, "mean"))
    row = np.argmin(abs(result.tiles.frequency_hz - 1620))
    assert picture.max(axis=1).argmax() in (row - 1, row, row + 1)
    # between two bins a tone loses up to 1.4 dB, and a row may average it with an empty bin: 3 dB
    assert -34.6 <= picture.max() <= -29.7
    assert tile_db(result.tiles.columns(1, 3, 10, "max")).max() == pytest.approx(-30, abs=1.5)


@pytest.mark.parametrize("rate", [8000, 44100, 96000])
def test_white_noise_reads_its_power_density_in_every_band(tmp_path, rate):
    sigma = 0.05
    noise = sigma * np.random.default_rng(3).standard_normal(30 * rate)
    _, result = scanned(tmp_path, noise, rate)
    width = result.bands_hz[:, 1] - result.bands_hz[:, 0]
    expected = 10 * np.log10(2 * sigma**2 * width / (rate / 2))
    measured = 10 * np.log10((10 ** (np.asarray(result.level_db[2:-2], float) / 10)).mean(axis=0))
    # the narrowest low bands rest on three neighbouring bins, whose median the window draws towards the mean
    assert abs(measured - expected).max() < 0.8
    assert abs(measured - expected)[-8:].max() < 0.1


def test_levels_agree_with_welch_of_scipy(tmp_path):
    coloured = signal.lfilter([0.1], [1, -0.9], np.random.default_rng(5).standard_normal(20 * RATE)) * 0.1
    _, result = scanned(tmp_path, coloured)
    hz, density = signal.welch(coloured, RATE, nperseg=8192)
    low, high = result.bands_hz[-1]
    power = np.trapezoid(np.interp(np.linspace(low, high, 4000), hz, density), np.linspace(low, high, 4000))
    measured = (10 ** (np.asarray(result.level_db[2:-2, -1], float) / 10)).mean()
    assert 10 * np.log10(measured / (2 * power)) == pytest.approx(0, abs=0.1)


def test_pump_tones_do_not_lift_the_low_bands_but_noise_does(tmp_path):
    noise = 0.01 * np.random.default_rng(1).standard_normal(20 * RATE)
    comb = sum(sine(20, 49.4 * k, -50) for k in range(2, 20))
    (tmp_path / "tones").mkdir()
    (tmp_path / "louder").mkdir()
    _, quiet = scanned(tmp_path, noise)
    _, pumped = scanned(tmp_path / "tones", noise + comb)
    _, louder = scanned(tmp_path / "louder", 2 * noise)
    bands = slice(band_of(quiet, 400), band_of(quiet, 950))
    level = [np.median(np.asarray(r.level_db[:, bands], float), axis=0) for r in (quiet, pumped, louder)]
    assert (level[1] - level[0]).max() < 3.5
    assert level[2] - level[0] == pytest.approx(6.02, abs=0.4)
    crest = [np.median(np.asarray(r.crest_db[:, bands], float)) for r in (quiet, pumped)]
    assert crest[1] > crest[0] + 10  # and the tones are seen as such


def test_one_and_two_threads_give_the_same_files(tmp_path):
    noise = 0.1 * np.random.default_rng(2).standard_normal(30 * RATE)
    (tmp_path / "one").mkdir()
    (tmp_path / "two").mkdir()
    _, one = scanned(tmp_path / "one", noise, threads=1)
    _, two = scanned(tmp_path / "two", noise, threads=2)
    for file in sorted(one.folder.iterdir()):
        assert file.read_bytes() == (two.folder / file.name).read_bytes(), file.name


def test_no_seam_shows_between_jobs(tmp_path):
    steady = sine(20, 2000, -20) + sine(20, 200, -20)
    _, result = scanned(tmp_path, steady)
    job = 32 * 3
    level = np.asarray(result.level_db[:, :], float)
    for band in (band_of(result, 2000), len(result.bands_hz) - 1):
        assert np.ptp(level[job - 4 : job + 4, band]) < 0.1
    assert np.ptp(result.tiles.columns(1, 19, 90, "mean")[np.argmax(result.tiles.columns(1, 19, 1, "mean"))]) <= 1


def test_a_click_of_one_sample_stays_visible_at_every_zoom(tmp_path):
    samples = 1e-4 * np.random.default_rng(0).standard_normal(700 * 8000)
    at_s = 345.6
    samples[int(at_s * 8000)] = 0.9
    _, result = scanned(tmp_path, samples, 8000)
    for span, pixels in ((690, 50), (690, 700), (100, 1000), (10, 40)):
        start = at_s - span * 0.49
        picture = result.tiles.columns(start, start + span, pixels, "max").mean(axis=0)
        pixel = int((at_s - start) / span * pixels)
        assert abs(int(picture.argmax()) - pixel) <= max(1, 0.2 * pixels / span)
        assert picture.max() > np.median(picture) + 20
        wave = result.wave.columns(start, start + span, pixels)
        assert wave[1].max() == pytest.approx(0.9, abs=1e-3)
        assert abs(int(wave[1].argmax()) - pixel) <= 1


def test_pixels_pool_exactly_the_columns_that_they_touch(tmp_path):
    noise = 0.1 * np.random.default_rng(4).standard_normal(60 * 8000)
    _, result = scanned(tmp_path, noise, 8000)
    columns = np.asarray(result.tiles.levels["max"][0])
    column_s = result.tiles.finest_column_s
    start, end, pixels = 3.1, 49.7, 37
    picture = result.tiles.columns(start, end, pixels, "max")
    assert picture.shape == (columns.shape[1], pixels)
    step = (end - start) / pixels
    for pixel in range(pixels):
        first = int(np.floor((start + pixel * step) / column_s))
        last = int(np.ceil((start + (pixel + 1) * step) / column_s))
        # a coarser level may add columns at the edges, at most one of its own columns
        assert (picture[:, pixel] >= columns[first:last].max(axis=0)).all()
        assert (picture[:, pixel] <= columns[max(0, first - 3) : last + 3].max(axis=0)).all()
    outside = result.tiles.columns(-20, 80, 100, "mean")
    assert (outside[:, :19] == 0).all()
    assert (outside[:, 81:] == 0).all()
    assert (outside[:, 25:75] > 0).all()


def test_the_mean_plane_keeps_the_power_of_noise_at_every_zoom(tmp_path):
    noise = 0.1 * np.random.default_rng(6).standard_normal(900 * 8000)
    _, result = scanned(tmp_path, noise, 8000)
    assert len(result.tiles.levels["mean"]) > 1
    for pixels in (4000, 1000, 100, 3):
        shown = tile_db(result.tiles.columns(1, 899, pixels, "mean"))[10:-10]
        power = 10 * np.log10((10 ** (shown / 10)).mean())
        assert power == pytest.approx(10 * np.log10(0.01 * 2 * 1.5 / 256), abs=0.25)


def test_the_close_look_agrees_with_the_stored_picture(tmp_path):
    chirp = 0.3 * signal.chirp(np.arange(20 * 8000) / 8000, 200, 20, 3800)
    source, result = scanned(tmp_path, chirp, 8000)
    stored = result.tiles.columns(5, 15, 40)
    close = spectrogram_detail(source, 5, 15, 40)
    assert abs(stored.argmax(axis=0) - close.argmax(axis=0)).max() <= 3
    assert abs(stored.max(axis=0).astype(int) - close.max(axis=0)).max() <= 2
    closer = spectrogram_detail(source, -0.05, 0.05, 200)
    assert closer.shape == (len(result.tiles.frequency_hz), 200)


def test_clipping_silence_and_dropouts_are_found_where_they_are(tmp_path):
    samples = 0.05 * np.random.default_rng(7).standard_normal(60 * 8000)
    samples[10 * 8000 : 13 * 8000] = np.clip(samples[10 * 8000 : 13 * 8000] * 200, -1, 1)
    samples[30 * 8000 : 34 * 8000] = 0
    samples[50 * 8000 : 51 * 8000] *= 1e-5
    samples[40 * 8000 + np.arange(2)] = 1  # too short to matter
    _, result = scanned(tmp_path, samples, 8000)
    assert [f.code for f in result.findings] == ["audio_dropouts", "audio_clipped"]
    assert result.findings[0].params["seconds"] == pytest.approx(5, abs=0.2)
    assert result.findings[1].params["seconds"] == pytest.approx(3, abs=0.2)
    clock = ClockMap(start_s=100.0, drift_ppm=1e5)
    spans = {s.reason: (s.start_s, s.end_s) for s in result.stretches(clock) if s.reason != "sound_silent"}
    assert {s.channel for s in result.stretches(clock)} == {Channel.SOUND}
    assert spans["sound_clipped"] == pytest.approx((100 + 10 / 1.1, 100 + 13 / 1.1), abs=0.1)
    assert spans["sound_dropout"] == pytest.approx((100 + 30 / 1.1, 100 + 34 / 1.1), abs=0.1)
    silent = [(s.start_s, s.end_s) for s in result.stretches(clock) if s.reason == "sound_silent"]
    assert silent[1] == pytest.approx((100 + 50 / 1.1, 100 + 51 / 1.1), abs=0.1)
    for stretch, language in itertools.product(result.stretches(clock), messages.LANGUAGES):
        assert messages.text("reasons", stretch.reason, language)
    assert set(np.unique(result.state)) <= {0, CLIPPED, SILENT, DROPOUT, SILENT | DROPOUT}


def test_a_dead_microphone_is_told_once(tmp_path):
    _, result = scanned(tmp_path, np.zeros(8000 * 5), 8000, "PCM_16")
    assert [f.code for f in result.findings] == ["audio_dead"]


def test_a_recording_shorter_than_a_frame_is_scanned(tmp_path):
    _, result = scanned(tmp_path, sine(0.01, 1000, -20))
    assert result.level_db.shape[0] == 1
    assert result.tiles.columns(0, 0.01, 5).shape[1] == 5


def test_a_band_above_the_recording_is_refused_with_a_sentence(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        scanned(tmp_path, sine(1, 100, -20, 2000), 2000, settings=SoundSettings(band_low_hz=1500))
    assert caught.value.code == ErrorCode.SETTING_INVALID
    assert messages.error_sentence(caught.value)


def test_a_cancelled_pass_leaves_nothing(tmp_path):
    calls = itertools.count()
    progress = Progress(is_cancelled=lambda: next(calls) >= 2)
    with pytest.raises(Cancelled):
        scanned(tmp_path, np.zeros(RATE * 30), progress=progress)
    assert list((tmp_path / "scan").iterdir()) == []


def test_a_damaged_or_missing_scan_is_refused_with_a_sentence(tmp_path):
    _, result = scanned(tmp_path, sine(2, 1000, -20))
    assert SoundScan.load(result.folder).findings == result.findings
    content = (result.folder / "level_db.npy").read_bytes()
    (result.folder / "level_db.npy").write_bytes(content[:-100])
    for broken in (result.folder, tmp_path / "nowhere"):
        with pytest.raises(LeaklineError) as caught:
            SoundScan.load(broken)
        assert caught.value.code == ErrorCode.FILE_UNREADABLE
    (result.folder / "level_db.npy").write_bytes(content)
    index = json.loads((result.folder / "scan.json").read_text())
    (result.folder / "scan.json").write_text(json.dumps({**index, "version": 0}))
    with pytest.raises(LeaklineError):
        SoundScan.load(result.folder)


def test_frame_sizes_fit_each_other_at_any_rate():
    for rate in (1000, 4000, 8000, 11025, 22050, 44100, 48000, 96000, 192000, 1_000_000):
        grid = Grid(rate, 10 * rate)
        assert grid.column % grid.wave_block == 0
        assert grid.level % grid.onset_step == 0
        assert grid.level % grid.decimation == 0
        assert 0.03 <= grid.window / rate <= 0.07
        assert 0.05 <= grid.level_s <= 0.08
        assert 0.0005 <= grid.onset_step / rate <= 0.0012


@pytest.mark.data
def test_a_real_hydrophone_recording_has_its_energy_below_100_hz(tmp_path, shared_data):
    source, _ = open_audio([shared_data / "hydrophone_pvc" / "no-leak.wav"])
    result = scan(source, SETTINGS, out_dir=tmp_path)
    samples, rate = soundfile.read(shared_data / "hydrophone_pvc" / "no-leak.wav")
    hz, density = signal.welch(samples, rate, nperseg=8192)
    low, high = result.bands_hz[-1]
    inside = (hz >= low) & (hz <= high)
    chosen = 10 * np.log10(2 * density[inside].sum() * (hz[1] - hz[0]))
    measured = 10 * np.log10((10 ** (np.asarray(result.level_db[:, -1], float) / 10)).mean())
    assert measured == pytest.approx(chosen, abs=0.5)
