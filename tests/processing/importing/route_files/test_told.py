"""survey.toml may name a map file in its own folder in place of the route's points."""

import numpy as np
import pytest
from route_files import GRID, main_pipe, write

from processing.errors import ErrorCode, LeaklineError
from processing.importing.survey_toml import read_survey_toml, write_survey_toml

PIPE = main_pipe()


def told(folder, text):
    (folder / "survey.toml").write_text(text, encoding="utf-8")
    return folder / "survey.toml"


def test_a_named_file_gives_the_route_and_is_kept_as_points(tmp_path):
    write(tmp_path / "main.gpkg", "GPKG", [PIPE[19:], PIPE[:20]], GRID)
    survey = read_survey_toml(told(tmp_path, '[route]\nfile = "main.gpkg"\nsigma_m = 0.2\n'))
    assert (survey.route.crs, survey.route.sigma_m) == (GRID, 0.2)
    np.testing.assert_allclose(survey.route.points, PIPE, atol=1e-3)
    write_survey_toml(tmp_path / "again.toml", survey)
    assert read_survey_toml(tmp_path / "again.toml") == survey


def test_the_system_of_a_drawing_must_be_told(tmp_path):
    write(tmp_path / "main.dxf", "DXF", [PIPE], None)
    with pytest.raises(LeaklineError) as caught:
        read_survey_toml(told(tmp_path, '[route]\nfile = "main.dxf"\n'))
    assert caught.value.code is ErrorCode.ROUTE_NEEDS_CRS
    survey = read_survey_toml(told(tmp_path, f'[route]\nfile = "main.dxf"\ncrs = "{GRID}"\n'))
    np.testing.assert_allclose(survey.route.points, PIPE, atol=1e-3)


def test_a_file_outside_of_the_folder_is_not_read(tmp_path):
    inside = tmp_path / "survey"
    inside.mkdir()
    write(tmp_path / "main.gpkg", "GPKG", [PIPE], GRID)
    for name in ("../main.gpkg", str(tmp_path / "main.gpkg")):
        with pytest.raises(LeaklineError) as caught:
            read_survey_toml(told(inside, f"[route]\nfile = '{name}'\n"))
        assert caught.value.code is ErrorCode.SETTING_INVALID


def test_several_separate_lines_are_not_guessed_at(tmp_path):
    write(tmp_path / "main.gpkg", "GPKG", [PIPE[:10], PIPE[20:]], GRID)
    with pytest.raises(LeaklineError) as caught:
        read_survey_toml(told(tmp_path, '[route]\nfile = "main.gpkg"\n'))
    assert (caught.value.code, caught.value.place.path.name) == (ErrorCode.ROUTE_NOT_ONE_LINE, "main.gpkg")
