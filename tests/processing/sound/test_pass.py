"""The streamed pass: compiled loops against plain ones, an interrupted pass against a whole one, recorders' faults."""

import itertools
import json
import os
import signal as signals
import subprocess
import sys
import textwrap

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import signal

from processing import messages
from processing.errors import Cancelled
from processing.pipeline import process
from processing.progress import Progress
from processing.settings import Settings, SoundSettings
from processing.sound import kernels_pass
from processing.sound.analysis import Analyser
from processing.sound.bands import Grid
from processing.sound.rows import Kept, RowFile, load_rows, part_path
from processing.sound.scan import scan
from processing.sound.scan_files import part_count
from processing.sound.soundness import clipped_at
from processing.sound.source import open_audio
from processing.sound.tile_values import to_tile
from processing.storage.cache import Cache
from processing.survey import ImportedFile, Recording, Survey

SETTINGS = SoundSettings()


def written(folder, samples, rate=8000, subtype="PCM_16"):
    path = folder / "a.wav"
    soundfile.write(path, samples, rate, subtype=subtype)
    return open_audio([path])[0]


def codes(result):
    for finding, language in itertools.product(result.findings, messages.LANGUAGES):
        assert messages.finding_sentence(finding, language)
    return {f.code: f.params for f in result.findings}


# --- the loops -------------------------------------------------------------------------------------------------------


@pytest.mark.skipif(not kernels_pass.COMPILED, reason="no compiler built the kernels")
@pytest.mark.parametrize("rate", [1000, 8000, 44100, 48000, 192000])
def test_the_compiled_loops_measure_what_numpy_measures(rate):
    analyser = Analyser(Grid(rate, 10**9), SoundSettings(band_low_hz=100.0, band_high_hz=400.0), compiled=True)
    plain = Analyser(analyser.grid, SoundSettings(band_low_hz=100.0, band_high_hz=400.0), compiled=False)
    rng = np.random.default_rng(rate)
    samples = rng.normal(0.1, 0.03, analyser.part + 2 * analyser.context).astype(np.float32)
    samples[len(samples) // 3 : len(samples) // 2] *= 20  # clipped
    samples = np.clip(samples, -1, 1)
    samples[-len(samples) // 4 :] = 0
    ours, theirs = analyser.analyse(samples, analyser.part), plain.analyse(samples, analyser.part)
    for name in ("level_db", "crest_db"):
        a, b = (np.asarray(getattr(part, name), float) for part in (ours, theirs))
        np.testing.assert_allclose(a, b, rtol=2e-3, atol=2e-2, err_msg=name)
    np.testing.assert_allclose(np.asarray(ours.wave, float), np.asarray(theirs.wave, float), rtol=2e-3, atol=1e-6)
    np.testing.assert_allclose(ours.facts, theirs.facts, rtol=1e-3, atol=1e-3)
    assert (ours.state == theirs.state).all()
    for a, b in zip((*ours.tile_max, *ours.tile_mean, ours.onset), (*theirs.tile_max, *theirs.tile_mean, theirs.onset)):
        assert a.shape == b.shape
        assert abs(a.astype(int) - b).max() <= 1
        assert np.mean(a != b) < 0.01


def test_a_piece_of_another_length_is_refused_before_the_kernels_run():
    analyser = Analyser(Grid(8000, 8000), SETTINGS)
    with pytest.raises(ValueError, match="samples"):
        analyser.analyse(np.zeros(100, np.float32), 100)


@given(st.floats(0, 2.0**40, width=32))
def test_a_level_as_a_byte_is_right_to_the_half_step(power):
    level = 10 * np.log10(max(power, 1e-30))
    byte = int(to_tile(np.array([power], np.float32))[0])
    assert abs(byte - np.clip((level + 130) / 0.5, 0, 255)) <= 0.5 + 0.012


# --- going on where a pass stopped -----------------------------------------------------------------------------------


def long_noise(folder, rate=8000, seconds=170):
    rng = np.random.default_rng(8)
    samples = (0.1 * rng.standard_normal(seconds * rate)).astype(np.float32)
    samples[70 * rate :: 5 * rate] = np.nan
    return written(folder, samples, rate, "FLOAT")


def stop_after(count):
    calls = itertools.count(1)
    return Progress(is_cancelled=lambda: next(calls) > count)


def assert_same(folder, whole):
    names = sorted(p.name for p in whole.iterdir())
    assert sorted(p.name for p in folder.iterdir()) == names
    for name in names:
        assert (folder / name).read_bytes() == (whole / name).read_bytes(), name


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    source = long_noise(folder)
    result = scan(source, SETTINGS, out_dir=folder / "scan")
    assert "audio_not_finite" in codes(result)
    return source, folder / "scan"


@pytest.mark.parametrize("threads", [1, 2])
def test_a_cancelled_pass_goes_on_to_the_same_bytes_and_reads_nothing_twice(tmp_path, whole, threads):
    source, expected = whole
    shown = []
    for count in (3, 2, 4):
        with pytest.raises(Cancelled):
            scan(source, SETTINGS, stop_after(count), tmp_path, threads, resume=True)
    scan(
        source,
        SETTINGS,
        out_dir=tmp_path,
        threads=threads,
        resume=True,
        grown=lambda _folder, _grid, c: shown.append(c),
    )
    assert_same(tmp_path, expected)
    assert shown[0] == 64 * (4 + 3 + 5 + 1)  # each cancelled one had added the piece after which it was asked


def test_a_killed_pass_goes_on_to_the_same_bytes(tmp_path, whole):
    source, expected = whole
    script = textwrap.dedent(
        f"""
        import os, signal
        from pathlib import Path
        from processing.settings import SoundSettings
        from processing.sound import scan_files
        from processing.sound.scan import scan
        from processing.sound.source import open_audio
        scan_files._NOTE_EVERY_S = 0.0
        def grown(folder, grid, columns):
            if columns >= 64 * 6:
                os.kill(os.getpid(), signal.SIGKILL)
        source = open_audio([Path({str(source.parts[0].path)!r})])[0]
        scan(source, SoundSettings(), out_dir=Path({str(tmp_path)!r}), resume=True, grown=grown)
        """
    )
    env = {**os.environ, "PYTHONPATH": os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run([sys.executable, "-c", script], env=env, check=False, timeout=60)
    assert done.returncode == -signals.SIGKILL
    shown = []
    scan(source, SETTINGS, out_dir=tmp_path, resume=True, grown=lambda _folder, _grid, c: shown.append(c))
    assert shown[0] == 64 * 7
    assert_same(tmp_path, expected)


@pytest.mark.parametrize("spoil", ["torn", "changed", "gone", "note", "longer", "other"])
def test_what_a_crash_left_is_believed_only_as_far_as_its_checksums(tmp_path, whole, spoil):
    source, expected = whole
    with pytest.raises(Cancelled):
        scan(source, SETTINGS, stop_after(5), tmp_path, 1, resume=True)
    part, note = part_path(tmp_path / "tiles_mean_0.npy"), tmp_path / "unfinished.json"
    content = part.read_bytes()
    if spoil == "torn":
        part.write_bytes(content[:-1])
    elif spoil == "changed":
        part.write_bytes(content[:5000] + bytes([content[5000] ^ 1]) + content[5001:])
    elif spoil == "gone":
        part.unlink()
    elif spoil == "note":
        note.write_text(note.read_text()[:200])
    elif spoil == "longer":
        part.write_bytes(content + b"written after the note")
    else:
        note.write_text(json.dumps({**json.loads(note.read_text()), "made_of": "another band"}))
    shown = []
    scan(source, SETTINGS, out_dir=tmp_path, resume=True, grown=lambda _folder, _grid, c: shown.append(c))
    assert shown[0] == 64 * (7 if spoil == "longer" else 1)
    assert_same(tmp_path, expected)


@settings(max_examples=30, deadline=None)
@given(st.lists(st.integers(0, 9), max_size=6), st.lists(st.integers(0, 9), max_size=6))
def test_a_file_of_rows_left_and_gone_on_with_holds_all_rows(tmp_path_factory, first, second):
    path = tmp_path_factory.mktemp("rows") / "a.npy"
    rows = np.arange(sum(first) + sum(second))
    file, at = RowFile(path, np.int64, len(rows)), 0
    for count in first:
        file.add(rows[at : at + count])
        at += count
    kept = file.flush()
    file.leave()
    file = RowFile(path, np.int64, len(rows), kept=kept)
    for count in second:
        file.add(rows[at : at + count])
        at += count
    file.finish()
    assert (load_rows(path) == rows).all()


def test_more_rows_than_the_file_holds_are_not_believed(tmp_path):
    RowFile(tmp_path / "a.npy", np.uint8, 10).leave()
    with pytest.raises(ValueError, match="rows"):
        RowFile(tmp_path / "a.npy", np.uint8, 10, kept=Kept(11, 0))


# --- faults of recorders ---------------------------------------------------------------------------------------------


def rumble(seconds, rate, seed=0):
    """Noise with its energy below some hundred Hz, as hydrophones hear it."""
    noise = np.random.default_rng(seed).standard_normal(seconds * rate)
    low = signal.sosfilt(signal.butter(2, 300, fs=rate, output="sos"), noise)
    return low / low.std()


@pytest.mark.parametrize(("limit", "subtype"), [(0.89, "PCM_16"), (0.3, "PCM_24"), (0.5, "PCM_U8"), (0.7, "FLOAT")])
def test_clipping_below_full_scale_is_found_at_its_level(tmp_path, limit, subtype):
    rate = 8000
    loud = 0.6 * limit * rumble(60, rate)  # cut off at 1.7 sigma: one sample in ten
    loud[20 * rate : 40 * rate] *= 0.3  # but not in the middle
    result = scan(written(tmp_path, np.clip(loud, -limit, limit), rate, subtype), SETTINGS, out_dir=tmp_path / "scan")
    found = codes(result)
    assert found["audio_clipped"]["seconds"] == pytest.approx(40, abs=4)
    assert found["audio_clipped_below"]["level_db"] == pytest.approx(20 * np.log10(limit), abs=0.1)


@pytest.mark.parametrize("subtype", ["PCM_16", "PCM_24", "PCM_U8", "ULAW", "FLOAT"])
@pytest.mark.parametrize("kind", ["rumble", "hiss", "tone", "two tones", "knocks"])
def test_sound_that_no_recorder_cut_off_is_not_called_clipped(tmp_path, kind, subtype):
    rate, seconds = 8000, 30
    t = np.arange(seconds * rate) / rate
    rng = np.random.default_rng(1)
    sound = {
        "rumble": lambda: 0.2 * rumble(seconds, rate),
        "hiss": lambda: 0.2 * rng.standard_normal(len(t)),
        "tone": lambda: 0.8 * np.sin(2 * np.pi * 50.0 * t),
        "two tones": lambda: 0.4 * np.sin(2 * np.pi * 100 * t) + 0.4 * np.sin(2 * np.pi * 313.7 * t),
        "knocks": lambda: 0.9 * signal.lfilter([1], [1, -1.6, 0.8], 0.1 * (rng.random(len(t)) < 1e-4)),
    }[kind]()
    assert abs(sound).max() < 0.999
    assert "audio_clipped" not in codes(scan(written(tmp_path, sound, rate, subtype), SETTINGS, out_dir=tmp_path / "s"))


def test_clipped_samples_are_those_that_stand_at_the_limit():
    wanted = 0.2 * rumble(10, 8000)
    heard = np.clip(wanted, -0.99, 0.3).astype(np.float32)  # on one side only
    blocks = heard.reshape(-1, 100)
    clipped, level = clipped_at(heard, blocks.min(axis=1), blocks.max(axis=1))
    assert level == pytest.approx(0.3)
    cut = wanted >= 0.3
    in_runs = np.convolve(np.convolve(cut, np.ones(3), "valid") == 3, np.ones(3)) > 0
    assert (clipped == in_runs).mean() > 0.9999


def test_a_steady_voltage_is_told_and_does_not_hide_silence(tmp_path):
    offset = np.full(30 * 8000, -0.2) + 1e-7 * np.random.default_rng(0).standard_normal(30 * 8000)
    offset[: 10 * 8000] += 0.01 * rumble(10, 8000)
    found = codes(scan(written(tmp_path, offset, subtype="FLOAT"), SETTINGS, out_dir=tmp_path / "scan"))
    assert found["audio_offset"]["share_pct"] == pytest.approx(-20, abs=0.1)
    assert found["audio_dropouts"]["seconds"] == pytest.approx(20, abs=0.2)


@pytest.mark.parametrize(("hz", "told"), [(50.0, 50), (60.0, 60), (73.0, None), (None, None)])
def test_hum_of_the_mains_is_told_with_its_frequency(tmp_path, hz, told):
    sound = 0.02 * rumble(40, 8000)
    t = np.arange(len(sound)) / 8000
    if hz is not None:
        sound = sound + sum(0.06 / k * np.sin(2 * np.pi * k * hz * t) for k in (1, 2, 3))
    found = codes(scan(written(tmp_path, sound), SETTINGS, out_dir=tmp_path / "scan"))
    assert found.get("audio_hum", {}).get("frequency_hz") == told


def test_processing_that_was_stopped_within_the_pass_goes_on_there(tmp_path, whole):
    source, expected = whole
    recording = Recording(None, source, (), (), (ImportedFile(source.parts[0].path, "audio", 1, "a" * 64),))
    cache, calls = Cache(tmp_path), []

    def stop(_fraction, phrase):
        calls.append(phrase)

    stopping = Progress(stop, lambda: calls.count("sound_scanning") >= 5)
    with pytest.raises(Cancelled):
        process(Survey(), recording, Settings(), cache, stopping)
    again = []
    results = process(Survey(), recording, Settings(), cache, Progress(lambda _, phrase: again.append(phrase)))
    gone_through = part_count(results.scan.grid)
    assert again.count("sound_scanning") <= gone_through - 5 + 2  # and those that say that it begins and ends
    for name in ("level_db.npy", "tiles_max_0.npy", "wave_1.npy"):
        assert (results.scan.folder / name).read_bytes() == (expected / name).read_bytes()
