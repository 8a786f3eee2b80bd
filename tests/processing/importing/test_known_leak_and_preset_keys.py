"""survey.toml and --set know the pressure, the preset and a known leak; files written with them read the same."""

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.importing.survey_toml import apply_override, read_survey_toml, write_survey_toml
from processing.settings import Settings
from processing.survey import CalibrationLeak, Survey


def read(tmp_path, text):
    file = tmp_path / "survey.toml"
    file.write_text(text, encoding="utf-8")
    return read_survey_toml(file)


def test_a_known_leak_pressure_and_preset_are_read_and_written_again(tmp_path):
    survey = read(
        tmp_path,
        "[pipe]\npressure_bar = 3.2\n[processing]\npreset = 'pvc'\n"
        "[calibration_leak]\nchainage_m = 12.5\nflow_lpm = 8\npressure_bar = 3\nname = 'tap'\n",
    )
    assert survey.pipe.pressure_bar == 3.2
    assert survey.processing.preset == "pvc"
    assert survey.calibration_leak == CalibrationLeak(12.5, 8.0, 3.0, "tap")
    write_survey_toml(tmp_path / "again.toml", survey)
    assert read_survey_toml(tmp_path / "again.toml") == survey


def test_files_without_them_read_as_before(tmp_path):
    survey = read(tmp_path, "[pipe]\nmaterial = 'PVC'\n")
    assert survey.calibration_leak is None
    assert survey.pipe.pressure_bar is None
    assert survey.processing.preset == "auto"


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("[calibration_leak]\nflow_lpm = 8\n", ErrorCode.KEY_MISSING),
        ("[calibration_leak]\nchainage_m = 8\n", ErrorCode.KEY_MISSING),
        ("[calibration_leak]\nchainage_m = 8\nflow_lpm = 0\n", ErrorCode.SETTING_INVALID),
        ("calibration_leak = 3\n", ErrorCode.SETTING_INVALID),
        ("[pipe]\npressure_bar = -1\n", ErrorCode.SETTING_INVALID),
    ],
)
def test_what_cannot_be_is_told(tmp_path, text, code):
    with pytest.raises(LeaklineError) as caught:
        read(tmp_path, text)
    assert caught.value.code is code


def test_the_command_line_sets_preset_and_size_settings():
    survey, settings = apply_override(Survey(), Settings(), "processing.preset=steel")
    assert survey.processing.preset == "steel"
    survey, settings = apply_override(survey, settings, "pipe.pressure_bar=4")
    assert survey.pipe.pressure_bar == 4.0
    _, settings = apply_override(survey, settings, "size.large_above_db=20")
    assert settings.size.large_above_db == 20.0
