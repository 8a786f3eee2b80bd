"""Sound files, whole, damaged and hostile, as they come off devices."""

import struct
import threading

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.sound.pcm import RawForm, decode
from processing.sound.source import AudioReader, blocks, open_audio, read_frames

RATE = 8000


def noise(frames, channels=1, seed=1):
    samples = 0.2 * np.random.default_rng(seed).standard_normal((frames, channels))
    return np.clip(samples, -0.9, 0.9).astype(np.float32)


def codes_of(findings):
    for finding in findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    return [finding.code for finding in findings]


def error_of(*args, **kwargs):
    with pytest.raises(LeaklineError) as caught:
        open_audio(*args, **kwargs)
    assert caught.value.place is not None
    assert messages.error_sentence(caught.value, "tr")
    return caught.value.code


def whole(source):
    return read_frames(source, 0, source.frames)


@pytest.mark.parametrize(
    ("suffix", "subtype", "tolerance"),
    [
        (".wav", "PCM_16", 3.2e-5),
        (".wav", "PCM_24", 1e-6),
        (".wav", "FLOAT", 0),
        (".wav", "ULAW", 0.03),
        (".wav", "IMA_ADPCM", None),
        (".flac", "PCM_16", 3.2e-5),
        (".w64", "PCM_16", 3.2e-5),
        (".rf64", "PCM_24", 1e-6),
        (".caf", "PCM_16", 3.2e-5),
        (".aiff", "PCM_16", 3.2e-5),
        (".au", "PCM_16", 3.2e-5),
        (".ogg", "VORBIS", None),
        (".mp3", "MPEG_LAYER_III", None),
    ],
)
def test_what_soundfile_wrote_is_read_back(tmp_path, suffix, subtype, tolerance):
    samples = noise(RATE * 2, 2)
    path = tmp_path / f"a{suffix}"
    soundfile.write(path, samples, RATE, subtype=subtype, format="RF64" if suffix == ".rf64" else None)
    source, findings = open_audio([path], channel=1)
    assert codes_of(findings) == []
    assert (source.sample_rate_hz, source.channels) == (RATE, 2)
    read = whole(source)
    assert read.dtype == np.float32
    assert abs(len(read) - len(samples)) <= (2400 if tolerance is None else 0)
    if tolerance is not None:
        np.testing.assert_allclose(read, samples[:, 1], atol=tolerance)
    elif suffix != ".mp3":  # which delays what it stores
        assert np.corrcoef(read[: len(samples)], samples[:, 1])[0, 1] > 0.8


@pytest.mark.parametrize(
    "subtype", ["PCM_S8", "PCM_U8", "PCM_16", "PCM_24", "PCM_32", "FLOAT", "DOUBLE", "ULAW", "ALAW"]
)
@pytest.mark.parametrize("endian", ["LITTLE", "BIG"])
def test_our_decoder_agrees_with_libsndfile(tmp_path, subtype, endian):
    path = tmp_path / "a.raw"
    soundfile.write(path, noise(500, 3), RATE, subtype=subtype, endian=endian, format="RAW")
    theirs = soundfile.read(
        path, samplerate=RATE, channels=3, subtype=subtype, endian=endian, format="RAW", dtype="float32"
    )
    for channel in range(3):
        ours = decode(path.read_bytes() + b"\x01", subtype, endian, 3, channel)
        np.testing.assert_array_equal(ours, theirs[0][:, channel])


def wav_bytes(samples, riff_size=None, data_size=None, tail=b"", rate=RATE, channels=1, bits=16, tag=1):
    data = samples.tobytes() if isinstance(samples, np.ndarray) else samples
    frame = channels * bits // 8 % 65536
    riff = 36 + len(data) + len(tail) if riff_size is None else riff_size
    size = len(data) if data_size is None else data_size
    head = struct.pack(
        "<4sI4s4sIHHIIHH", b"RIFF", riff, b"WAVE", b"fmt ", 16, tag, channels, rate, rate * frame % 2**32, frame, bits
    )
    return head + struct.pack("<4sI", b"data", size) + data + tail


PCM = (noise(RATE)[:, 0] * 32767).astype("<i2")


@pytest.mark.parametrize(
    ("data_size", "riff_size", "code"),
    [
        (0, 8, "audio_header_unfinished"),
        (0, 36, "audio_header_unfinished"),
        (0xFFFFFFFF, 0xFFFFFFFF, "audio_header_unfinished"),
        (3 * PCM.nbytes, 36 + 3 * PCM.nbytes, "audio_header_wrong"),
        (0x7FFFFFF0, 0x7FFFFFFF, "audio_header_wrong"),
        (PCM.nbytes // 4, 36 + PCM.nbytes // 4, "audio_header_wrong"),  # stale: killed after the last header update
    ],
)
def test_a_header_that_lies_is_not_believed_and_the_file_stays_untouched(tmp_path, data_size, riff_size, code):
    path = tmp_path / "a.wav"
    content = wav_bytes(PCM, riff_size, data_size, tail=b"\x05")  # a torn last frame
    path.write_bytes(content)
    source, findings = open_audio([path])
    assert codes_of(findings) == [code]
    assert findings[0].params["found_s"] == pytest.approx(1.0)
    np.testing.assert_array_equal(whole(source), PCM / np.float32(32768))
    assert path.read_bytes() == content


def test_metadata_behind_the_samples_are_not_read_as_sound(tmp_path):
    path = tmp_path / "a.wav"
    path.write_bytes(wav_bytes(PCM, tail=b"LIST" + struct.pack("<I", 6000) + b"INFO" + b"x" * 5996))
    source, findings = open_audio([path])
    assert (source.frames, codes_of(findings)) == (len(PCM), [])


def test_space_reserved_behind_the_samples_is_not_read_as_sound(tmp_path):
    path = tmp_path / "a.wav"
    path.write_bytes(wav_bytes(PCM, tail=bytes(300_000)))
    source, findings = open_audio([path])
    assert (source.frames, codes_of(findings)) == (len(PCM), [])


@pytest.mark.parametrize("sizes", [(0, 0), (0xFFFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF), (10**12, 10**12)])
def test_an_rf64_file_that_was_not_closed_gives_all_its_sound(tmp_path, sizes):
    ds64 = struct.pack("<4sIQQQI", b"ds64", 28, sizes[0], sizes[1], 0, 0)
    content = wav_bytes(PCM, 0xFFFFFFFF, 0xFFFFFFFF)
    path = tmp_path / "a.rf64"
    path.write_bytes(b"RF64" + content[4:12] + ds64 + content[12:])
    source, findings = open_audio([path])
    assert len(codes_of(findings)) == 1
    np.testing.assert_array_equal(whole(source), PCM / np.float32(32768))


@pytest.mark.parametrize("claimed", [0xFFFFFFFF, 0, (4_600_000_000 - 44) % 2**32])
def test_a_wav_beyond_4_gib_is_read_to_its_end(tmp_path, claimed):
    path = tmp_path / "long.wav"
    size = 4_600_000_000
    mark = np.array([1000, -2000, 3000], "<i2").tobytes()
    with path.open("wb") as file:  # sparse: takes no room
        file.write(wav_bytes(b"\x01\x02", 0xFFFFFFFF, claimed))
        file.seek(size - len(mark))
        file.write(mark)
    source, findings = open_audio([path])
    assert len(codes_of(findings)) == 1
    assert source.frames == (size - 44) // 2
    last = read_frames(source, source.frames - 3, 10)
    np.testing.assert_allclose(last * 32768, [1000, -2000, 3000])


def test_headerless_sound_needs_to_be_described_and_then_is_read(tmp_path):
    samples = (noise(RATE, 2) * 2**31).astype("<i4")
    path = tmp_path / "a.raw"
    path.write_bytes(b"junkjunk" + samples.tobytes())
    assert error_of([path]) == ErrorCode.AUDIO_NEEDS_FORM
    source, findings = open_audio([path], RawForm(RATE, 32, 2, "signed", "little", 8), channel=1)
    assert codes_of(findings) == ["audio_read_as_raw"]
    np.testing.assert_allclose(whole(source), samples[:, 1] / 2**31, rtol=1e-6)
    assert error_of([path], RawForm(RATE, 12)) == ErrorCode.AUDIO_UNREADABLE


@pytest.mark.data
def test_a_real_wav_without_header_asks_for_its_form(tmp_path, shared_data):
    recording = (shared_data / "hydrophone_pvc" / "no-leak.wav").read_bytes()
    path = tmp_path / "no-leak.wav"
    path.write_bytes(recording[1000:])
    assert error_of([path]) == ErrorCode.AUDIO_NEEDS_FORM


def test_several_parts_are_one_recording(tmp_path):
    samples = noise(3 * RATE)
    paths = [tmp_path / "1.wav", tmp_path / "2.flac", tmp_path / "3.wav"]
    for i, path in enumerate(paths):
        soundfile.write(path, samples[i * RATE : (i + 1) * RATE], RATE)
    source, findings = open_audio(paths)
    assert codes_of(findings) == ["audio_parts"]
    np.testing.assert_allclose(
        read_frames(source, RATE - 100, RATE + 200), samples[RATE - 100 : 2 * RATE + 100, 0], atol=3.2e-5
    )
    np.testing.assert_allclose(np.concatenate(list(blocks(source, 999))), samples[:, 0], atol=3.2e-5)
    soundfile.write(paths[2], samples[:RATE], 2 * RATE)
    assert error_of(paths) == ErrorCode.AUDIO_PARTS_DIFFER


@pytest.mark.parametrize("left", [b"", b"RIFF\0\0", bytes(200_000)], ids=["empty", "torn header", "zeros"])
def test_a_last_part_that_a_power_cut_left_without_sound_does_not_cost_the_others(tmp_path, left):
    paths = [tmp_path / f"audio-00{i}.wav" for i in (1, 2, 3)]
    soundfile.write(paths[0], noise(500), RATE)
    soundfile.write(paths[1], noise(300), RATE)
    paths[2].write_bytes(left)
    source, findings = open_audio(paths)
    assert source.frames == 800
    assert codes_of(findings) == ["audio_part_hardly_begun", "audio_parts"]
    assert error_of([paths[0], paths[2], paths[1]]) in (
        ErrorCode.FILE_EMPTY,
        ErrorCode.AUDIO_UNREADABLE,
        ErrorCode.AUDIO_NEEDS_FORM,
    )
    error_of([paths[2]])


def test_reading_beyond_the_end_is_short(tmp_path):
    path = tmp_path / "a.wav"
    path.write_bytes(wav_bytes(PCM))
    source, _ = open_audio([path])
    assert len(read_frames(source, len(PCM) - 5, 100)) == 5
    assert len(read_frames(source, len(PCM) + 5, 100)) == 0


def test_a_missing_channel_becomes_the_first_and_is_told(tmp_path):
    path = tmp_path / "a.wav"
    path.write_bytes(wav_bytes(PCM))
    source, findings = open_audio([path], channel=3)
    assert (source.channel, codes_of(findings)) == (0, ["audio_channel_missing"])


def test_numbers_that_are_not_finite_become_zero_and_are_counted(tmp_path):
    samples = noise(1000)[:, 0]
    samples[[3, 500]] = np.nan, np.inf
    path = tmp_path / "a.wav"
    soundfile.write(path, samples, RATE, subtype="FLOAT")
    source, _ = open_audio([path])
    with AudioReader(source) as reader:
        read = reader.read(0, 1000)
        assert reader.not_finite == 2
    assert np.isfinite(read).all()
    assert read[3] == read[500] == 0
    assert read[4] == samples[4]


@pytest.mark.parametrize("kept", [0.999, 0.5, 0.1])
def test_a_flac_cut_by_a_kill_gives_what_can_be_read(tmp_path, kept):
    samples = noise(20 * RATE)
    path = tmp_path / "a.flac"
    soundfile.write(path, samples, RATE)
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * kept)])
    source, findings = open_audio([path])
    assert codes_of(findings) == ["audio_cut_short"]
    assert kept * 20 - 1.2 < source.duration_s < kept * 20 + 0.6
    np.testing.assert_allclose(whole(source), samples[: source.frames, 0], atol=3.2e-5)
    middle = source.frames // 2
    with AudioReader(source) as reader:  # backwards too
        reader.read(source.frames - 10, 10)
        np.testing.assert_allclose(reader.read(middle, 50), samples[middle : middle + 50, 0], atol=3.2e-5)


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", ErrorCode.FILE_EMPTY),
        (wav_bytes(b""), ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM)[:30], ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM, rate=0), ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM, rate=4_000_000_000), ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM, channels=0), ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM, channels=65535), ErrorCode.AUDIO_UNREADABLE),
        (wav_bytes(PCM, bits=12, tag=77), ErrorCode.AUDIO_UNREADABLE),
        (b"RIFF\x00\x00\x00\x00AVI LIST", ErrorCode.AUDIO_UNREADABLE),
        (b"fLaC" + bytes(200), ErrorCode.AUDIO_UNREADABLE),
        (b"OggS" + b"\xff" * 200, ErrorCode.AUDIO_UNREADABLE),
        (b"time,value\n1,2\n", ErrorCode.AUDIO_NEEDS_FORM),
    ],
)
def test_a_file_without_usable_sound_ends_in_a_sentence(tmp_path, content, code):
    path = tmp_path / "a.wav"
    path.write_bytes(content)
    assert error_of([path]) == code


def test_a_missing_file_and_a_folder_end_in_a_sentence(tmp_path):
    assert error_of([tmp_path / "none.wav"]) == ErrorCode.FILE_MISSING
    assert error_of([tmp_path]) == ErrorCode.FILE_UNREADABLE


def test_a_file_that_shrinks_while_it_is_read_ends_in_a_sentence(tmp_path):
    path = tmp_path / "a.wav"
    path.write_bytes(wav_bytes(PCM, 8, 0))
    source, _ = open_audio([path])
    path.write_bytes(wav_bytes(PCM[:100], 8, 0))
    with pytest.raises(LeaklineError) as caught:
        whole(source)
    assert caught.value.code == ErrorCode.AUDIO_UNREADABLE


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    kind=st.sampled_from(["wav", "flac", "au", "caf", "aiff", "w64"]),
    edits=st.lists(st.tuples(st.integers(0, 400), st.integers(0, 255)), max_size=12),
    kept=st.floats(0.02, 1.0),
)
def test_mutated_files_end_in_sound_or_in_a_sentence(tmp_path, kind, edits, kept):
    path = tmp_path / f"a.{kind}"
    soundfile.write(path, noise(2000), RATE, subtype="PCM_16")
    content = bytearray(path.read_bytes())
    for at, value in edits:
        content[at % len(content)] = value
    path.write_bytes(content[: int(len(content) * kept)])
    try:
        source, _ = open_audio([path])
        for block in blocks(source, 65536):
            assert np.isfinite(block).all()
    except LeaklineError as error:
        messages.error_sentence(error)  # raises where a code has no sentence


def test_readers_in_several_threads_do_not_disturb_each_other(tmp_path):
    samples = noise(20 * RATE)
    path = tmp_path / "a.flac"
    soundfile.write(path, samples, RATE)
    source, _ = open_audio([path])
    errors = []

    def work(seed):
        generator = np.random.default_rng(seed)
        with AudioReader(source) as reader:
            starts = generator.integers(0, 19 * RATE, 40)
            errors.extend(np.abs(reader.read(int(at), 500) - samples[at : at + 500, 0]).max() for at in starts)

    threads = [threading.Thread(target=work, args=(seed,)) for seed in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(errors) == 160
    assert max(errors) < 3.2e-5
