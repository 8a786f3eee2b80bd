"""A device folder becomes a recording: which files, which samples, and what is said about them."""

import hashlib
from dataclasses import replace

import numpy as np
import pytest
import soundfile

from processing import messages
from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.importing.folder import ImportOptions, import_folder, read_survey
from processing.progress import Progress


def codes(recording):
    return [finding.code for finding in recording.findings]


def write_sound(path, seconds=20.0, rate=8000):
    soundfile.write(path, np.random.default_rng(0).normal(0, 0.1, round(seconds * rate)), rate)
    return path


@pytest.fixture
def survey_folder(tmp_path, rows):
    folder = tmp_path / "station-road"
    folder.mkdir()
    rows.write(folder / "imu.csv")
    write_sound(folder / "audio.wav")
    (folder / "survey.toml").write_text("[pipe]\nlength_m = 12.0\n")
    return folder


def test_a_neutral_folder_becomes_a_recording_without_a_complaint(survey_folder, rows):
    recording = import_folder(survey_folder)
    assert codes(recording) == ["mag_absent"]
    assert recording.not_assessed == ()
    np.testing.assert_allclose(recording.imu.time_s, rows.time, atol=1e-6)
    np.testing.assert_allclose(recording.imu.acc_s_mps2, rows.acc, atol=1e-6)
    np.testing.assert_allclose(recording.imu.gyr_s_radps, rows.gyr, atol=1e-6)
    assert recording.imu.valid.all()
    assert recording.audio.frames == 160_000


def test_every_used_file_carries_its_hash(survey_folder):
    files = import_folder(survey_folder).files
    assert {f.role: f.path.name for f in files} == {"imu": "imu.csv", "audio": "audio.wav", "survey": "survey.toml"}
    for file in files:
        assert file.sha256 == hashlib.sha256(file.path.read_bytes()).hexdigest()
        assert file.size == file.path.stat().st_size


def test_columns_may_stand_in_any_order_and_strange_ones_are_ignored(tmp_path, rows, table):
    columns = {"note": np.full(len(rows.time), 7.0)}
    columns |= {f"mag_{a}_uT": rows.mag[:, i] for i, a in enumerate("xyz")}
    columns |= {f"quat_{a}": rows.quat[:, i] for i, a in enumerate("wxyz")}
    columns |= {f"gyr_{a}_radps": rows.gyr[:, i] for i, a in enumerate("xyz")}
    columns |= {f"acc_{a}_mps2": rows.acc[:, i] for i, a in enumerate("zyx"[::-1])}
    columns |= {"pressure_kPa": np.linspace(300, 310, len(rows.time)), "temperature_C": np.full(len(rows.time), 11.5)}
    columns |= {"time_s": rows.time}
    table(tmp_path / "imu.csv", columns)
    imu = import_folder(tmp_path).imu
    np.testing.assert_allclose(imu.mag_s_ut, rows.mag, atol=1e-6)
    np.testing.assert_allclose(imu.acc_s_mps2, rows.acc, atol=1e-6)
    np.testing.assert_allclose(np.abs(np.sum(imu.quat_ws * rows.quat, axis=1)), 1.0, atol=1e-6)
    assert imu.pressure_kpa[-1] == pytest.approx(310.0)
    assert imu.temperature_c[0] == pytest.approx(11.5)


def test_times_of_the_neutral_form_are_kept_as_they_are(tmp_path, rows):
    rows.time = rows.time + 1.7e9
    rows.write(tmp_path / "imu.csv")
    assert import_folder(tmp_path).imu.time_s[0] == 1.7e9


def test_a_missing_column_is_named_as_the_contract_names_it(tmp_path, rows, table):
    table(tmp_path / "imu.csv", {"time_s": rows.time, "acc_x_mps2": rows.acc[:, 0], "acc_y_mps2": rows.acc[:, 1]})
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path, ImportOptions(format="neutral"))
    assert (caught.value.code, caught.value.params["column_name"]) == (ErrorCode.COLUMN_MISSING, "acc_z_mps2")
    assert caught.value.place.line == 1


def test_a_folder_with_neither_log_nor_sound_is_no_survey(tmp_path):
    (tmp_path / "readme.txt").write_text("nothing here")
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path)
    assert caught.value.code is ErrorCode.NOT_A_SURVEY


def test_what_does_not_exist_is_named(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        import_folder(tmp_path / "nowhere")
    assert caught.value.code is ErrorCode.FILE_MISSING


def test_sound_alone_and_log_alone_are_told(survey_folder):
    (survey_folder / "audio.wav").unlink()
    assert "sound_missing" in codes(import_folder(survey_folder))
    (survey_folder / "imu.csv").unlink()
    write_sound(survey_folder / "audio.wav")
    recording = import_folder(survey_folder)
    assert recording.imu is None
    assert codes(recording) == ["imu_missing"]


@pytest.mark.parametrize(("seconds", "code"), [(80.0, "sound_longer"), (1.0, None)])
def test_sound_of_another_length_is_told(survey_folder, seconds, code):
    write_sound(survey_folder / "audio.wav", seconds)
    found = codes(import_folder(survey_folder))
    assert (code in found) if code else not {"sound_longer", "sound_shorter"} & set(found)


def test_sound_much_shorter_than_the_log_is_told(tmp_path, make):
    make(seconds=90.0).write(tmp_path / "imu.csv")
    write_sound(tmp_path / "audio.wav", 20.0)
    assert "sound_shorter" in codes(import_folder(tmp_path))


def test_the_folder_names_the_survey_unless_the_file_does(survey_folder):
    assert read_survey(survey_folder).info.name == "station-road"
    (survey_folder / "survey.toml").write_text('[survey]\nname = "A"')
    assert read_survey(survey_folder).info.name == "A"
    (survey_folder / "survey.toml").unlink()
    assert read_survey(survey_folder).info.name == "station-road"


def test_a_broken_survey_toml_stops_the_import_with_its_line(survey_folder):
    (survey_folder / "survey.toml").write_text("[pipe]\nlength_m = -1")
    with pytest.raises(LeaklineError) as caught:
        import_folder(survey_folder)
    assert caught.value.place.line == 2


def test_imu_csv_alone_brings_its_folder_with_it(survey_folder):
    recording = import_folder(survey_folder / "imu.csv")
    assert recording.audio is not None
    assert {f.role for f in recording.files} == {"imu", "audio", "survey"}


def test_progress_never_falls_and_ends_at_one(survey_folder):
    seen = []
    import_folder(survey_folder, progress=Progress(lambda fraction, phrase: seen.append((fraction, phrase))))
    fractions = [f for f, _ in seen]
    assert fractions == sorted(fractions)
    assert fractions[-1] == pytest.approx(1.0)
    assert {p for _, p in seen} <= set(messages.table("progress"))


def test_import_stops_when_asked(survey_folder):
    with pytest.raises(Cancelled):
        import_folder(survey_folder, progress=Progress(is_cancelled=lambda: True))


def test_every_finding_and_reason_of_import_has_a_sentence_in_both_languages(survey_folder):
    for language in messages.LANGUAGES:
        for finding in import_folder(survey_folder).findings:
            assert messages.finding_sentence(finding, language)


def test_a_file_whose_hash_is_known_is_not_read_for_it_again_unless_its_size_is_another(survey_folder):
    files = import_folder(survey_folder).files
    told = tuple(replace(file, sha256=f"{n:064d}") for n, file in enumerate(files))
    assert import_folder(survey_folder, known=told).files == told
    longer = tuple(replace(file, size=file.size + 1) for file in told)
    assert import_folder(survey_folder, known=longer).files == files
