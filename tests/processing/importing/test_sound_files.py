"""Which sound files belong to a recording, and in which order."""

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.importing.sound_files import natural_key, pick_audio, raw_form_of
from processing.survey import AudioInfo


def picked(folder, names, info=None):
    for name in names:
        (folder / name).write_bytes(b"x")
    files, findings = pick_audio(folder, sorted(folder.iterdir()), info or AudioInfo())
    return [f.name for f in files], [f.code for f in findings]


def test_numbers_sort_by_value(tmp_path):
    names = ["part-10.wav", "part-2.wav", "a.wav", "Part-1.wav"]
    ordered = sorted((tmp_path / n for n in names), key=natural_key)
    assert [p.name for p in ordered] == ["a.wav", "Part-1.wav", "part-2.wav", "part-10.wav"]


def test_no_sound_is_no_error(tmp_path):
    assert picked(tmp_path, ["imu.csv"]) == ([], [])


def test_parts_are_one_recording_in_the_order_of_their_numbers(tmp_path):
    names = [f"rec_{i}.wav" for i in range(1, 12)]
    assert picked(tmp_path, names) == (names, [])


def test_padded_numbers_go_on_too(tmp_path):
    names = [f"audio-{i:03d}.w64" for i in range(1, 4)]
    assert picked(tmp_path, names) == (names, [])


def test_a_missing_number_ends_the_recording_and_the_rest_is_told(tmp_path):
    assert picked(tmp_path, ["rec_1.wav", "rec_2.wav", "rec_4.wav"]) == (
        ["rec_1.wav", "rec_2.wav"],
        ["sound_files_left"],
    )


def test_audio_comes_before_other_names(tmp_path):
    assert picked(tmp_path, ["a.wav", "audio.flac"]) == (["audio.flac"], ["sound_files_left"])


def test_the_named_file_is_taken_alone(tmp_path):
    assert picked(tmp_path, ["rec_1.wav", "rec_2.wav"], AudioInfo(file="rec_2.wav")) == (["rec_2.wav"], [])


def test_a_pattern_names_all_parts(tmp_path):
    names = ["x10.wav", "x2.wav", "y.wav"]
    assert picked(tmp_path, names, AudioInfo(file="x*.wav"))[0] == ["x2.wav", "x10.wav"]


@pytest.mark.parametrize("name", ["gone.wav", "../gone.wav", "gone*.wav"])
def test_a_named_file_that_is_not_there_is_an_error(tmp_path, name):
    with pytest.raises(LeaklineError) as caught:
        pick_audio(tmp_path, [], AudioInfo(file=name))
    assert caught.value.code is ErrorCode.FILE_MISSING


def test_the_form_of_headerless_sound_comes_from_the_survey():
    assert raw_form_of(AudioInfo()) is None
    form = raw_form_of(AudioInfo(raw_sample_rate_hz=96000.0, raw_bits=32, raw_channels=2, raw_encoding="float"))
    assert (form.sample_rate_hz, form.subtype, form.channels) == (96000.0, "FLOAT", 2)
