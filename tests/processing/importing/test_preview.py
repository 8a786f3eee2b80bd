"""The quick look before the import: roles, columns, estimates, and what will have to be asked."""

import numpy as np
import pytest
import soundfile

from processing.errors import ErrorCode, LeaklineError
from processing.importing.column_mapping import ACC, GYR, ColumnMapping, MappedColumn, MappingStore, Quantity
from processing.importing.folder import ImportOptions, import_folder, preview_folder
from processing.importing.text_layout import find_layout
from processing.sound.pcm import RawForm


@pytest.fixture
def survey_folder(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    soundfile.write(tmp_path / "audio.wav", np.zeros(80_000) + 0.01, 8000)
    (tmp_path / "survey.toml").write_text('[survey]\nname = "A"\n')
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8\xff")
    (tmp_path / "notes.txt").write_text("nothing to see")
    return tmp_path


def test_every_file_gets_its_role(survey_folder):
    preview = preview_folder(survey_folder)
    roles = {f.path.name: f.role for f in preview.files}
    assert roles == {
        "imu.csv": "imu",
        "audio.wav": "audio",
        "survey.toml": "survey",
        "photo.jpg": "ignored",
        "notes.txt": "other",
    }
    assert preview.ready
    assert preview.has_survey_file
    assert preview.survey.info.name == "A"
    assert {p.name for p in preview.paths} == {"imu.csv", "audio.wav", "survey.toml"}


def test_the_log_is_shown_with_its_columns_and_estimates(survey_folder, rows):
    log = preview_folder(survey_folder).of(survey_folder / "imu.csv")
    assert log.matches[0].format.name == "neutral"
    assert len(log.rows) == 20
    assert log.rows[1][0] == "0.0100000"
    assert log.mapping.column_of(Quantity.GYR_Z).name == "gyr_z_radps"
    assert log.sample_rate_hz == pytest.approx(100.0)
    assert log.row_count == len(rows.time)
    assert log.duration_s == pytest.approx(rows.time[-1])
    assert [f.code for f in log.findings] == ["mag_absent"]


def test_sound_is_shown_with_its_facts(survey_folder):
    sound = preview_folder(survey_folder).of(survey_folder / "audio.wav")
    assert (sound.sample_rate_hz, sound.duration_s, sound.audio.channels) == (8000.0, 10.0, 1)


def test_a_long_log_is_estimated_from_its_head(tmp_path, make):
    rows = make(seconds=250.0)
    rows.write(tmp_path / "imu.csv")
    assert (tmp_path / "imu.csv").stat().st_size > 1_500_000
    log = preview_folder(tmp_path).of(tmp_path / "imu.csv")
    assert log.row_count == pytest.approx(len(rows.time), rel=0.03)
    assert log.duration_s == pytest.approx(250.0, rel=0.03)


def test_a_huge_file_is_not_read(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    with (tmp_path / "imu.csv").open("r+b") as file:
        file.truncate(3 << 40)  # sparse: to read it would take an hour
    preview = preview_folder(tmp_path)
    assert preview.imu == tmp_path / "imu.csv"


def test_an_unknown_table_asks_for_its_columns_and_takes_the_answer(tmp_path, rows, table):
    names = ["when", *(f"channel {i}" for i in range(6))]
    table(tmp_path / "log.csv", dict(zip(names, [rows.time, *rows.gyr.T, *rows.acc.T], strict=True)))
    preview = preview_folder(tmp_path)
    assert not preview.ready
    assert preview.error.code is ErrorCode.FORMAT_UNKNOWN
    shown = preview.of(tmp_path / "log.csv")
    assert (shown.role, shown.layout.columns[0]) == ("imu", "when")
    assert Quantity.ACC_X in shown.mapping.missing
    columns = [MappedColumn(0, Quantity.TIME), *(MappedColumn(1 + i, q) for i, q in enumerate((*GYR, *ACC)))]
    told = ImportOptions(mapping=ColumnMapping(tuple(columns)))
    assert preview_folder(tmp_path, told).ready
    recording = import_folder(tmp_path, told)
    np.testing.assert_allclose(recording.imu.acc_s_mps2, rows.acc, atol=1e-6)
    np.testing.assert_allclose(recording.imu.gyr_s_radps, rows.gyr, atol=1e-6)
    assert {"time_unit_found", "acc_unit_found", "gyr_unit_found"} <= {f.code for f in recording.findings}


def test_a_mapping_once_told_is_remembered_for_the_next_file_of_its_kind(tmp_path, rows, table):
    names = ["when", *(f"channel {i}" for i in range(6))]
    for day in ("monday", "tuesday"):
        (tmp_path / day).mkdir()
        table(tmp_path / day / "log.csv", dict(zip(names, [rows.time, *rows.gyr.T, *rows.acc.T], strict=True)))
    columns = [MappedColumn(0, Quantity.TIME, "s"), *(MappedColumn(1 + i, q) for i, q in enumerate((*GYR, *ACC)))]
    store = tmp_path / "settings" / "mappings.json"
    MappingStore(store).remember(find_layout(tmp_path / "monday" / "log.csv"), ColumnMapping(tuple(columns)))
    options = ImportOptions(mapping_store=store)
    assert preview_folder(tmp_path / "tuesday", options).ready
    assert import_folder(tmp_path / "tuesday", options).imu.sample_rate_hz == pytest.approx(100.0)


def test_headerless_sound_asks_for_its_form_and_takes_the_answer(tmp_path, rows):
    rows.write(tmp_path / "imu.csv")
    (tmp_path / "audio.raw").write_bytes(np.zeros(32_000, np.int16).tobytes())
    assert preview_folder(tmp_path).error.code is ErrorCode.AUDIO_NEEDS_FORM
    told = preview_folder(tmp_path, ImportOptions(raw_form=RawForm(8000.0, 16)))
    assert told.ready
    assert told.of(tmp_path / "audio.raw").duration_s == 4.0
    (tmp_path / "survey.toml").write_text("[audio]\nraw_sample_rate_hz = 16000\nraw_bits = 16\n")
    assert preview_folder(tmp_path).of(tmp_path / "audio.raw").duration_s == 2.0
    assert import_folder(tmp_path).audio.duration_s == 2.0


def test_a_broken_form_or_log_is_shown_not_raised(survey_folder):
    (survey_folder / "survey.toml").write_text("[pipe]\nlength_m = -1")
    preview = preview_folder(survey_folder)
    assert preview.error.code is ErrorCode.SETTING_INVALID
    (survey_folder / "survey.toml").unlink()
    (survey_folder / "imu.csv").write_text("time_s\n1\n")
    preview = preview_folder(survey_folder)
    assert preview.error.code is ErrorCode.TEXT_NOT_A_TABLE
    assert preview.of(survey_folder / "imu.csv").error is preview.error


def test_a_folder_that_is_not_there_is_an_error(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        preview_folder(tmp_path / "nowhere")
    assert caught.value.code is ErrorCode.FILE_MISSING
