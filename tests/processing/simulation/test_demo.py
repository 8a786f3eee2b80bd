"""The demonstration survey appears whole, once, and says what it is."""

import pytest

from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.importing.survey_toml import read_survey_toml
from processing.progress import Progress
from processing.simulation.demo import demo_folder
from processing.simulation.route import centre_line
from processing.simulation.scenarios import demo_scenario
from processing.survey import LeakClass


def test_the_demo_is_made_once_and_says_on_its_face_that_it_is_simulated(tmp_path):
    folder = demo_folder(tmp_path)
    names = {f.name for f in folder.iterdir()}
    assert {"imu.csv", "audio.flac", "survey.toml", "truth.json"} <= names
    survey = read_survey_toml(folder / "survey.toml")
    assert survey.info.name == "Demonstration (simulated)"
    assert survey.info.simulated
    assert survey.launch.latitude == 40.9012
    assert len(survey.tie_points) >= 4
    assert survey.route is not None
    made = {f: f.stat().st_mtime_ns for f in folder.iterdir()}
    assert demo_folder(tmp_path) == folder
    assert {f: f.stat().st_mtime_ns for f in folder.iterdir()} == made
    assert [f.name for f in tmp_path.iterdir()] == [folder.name]  # nothing is left aside


def test_the_demo_shows_everything():
    scenario = demo_scenario()
    kinds = [x.kind for x in scenario.sound.local]
    assert kinds.count(LeakClass.LEAK) == 3
    assert {LeakClass.VALVE, LeakClass.AIR} <= set(kinds)
    assert {x.kind for x in scenario.sound.timed} == {LeakClass.TRAFFIC}
    assert scenario.sound.pumps
    assert scenario.drive.stops
    route = centre_line(scenario.route)
    assert 150 < route.length_m < 250
    assert len(route.bends_m) >= 3


def test_a_cancelled_demo_leaves_nothing_behind(tmp_path):
    calls = []
    progress = Progress(is_cancelled=lambda: calls.append(1) or len(calls) > 12)
    with pytest.raises(Cancelled):
        demo_folder(tmp_path, progress)
    assert list(tmp_path.iterdir()) == []


def test_a_place_that_cannot_be_written_is_an_error_the_user_can_mend(tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(LeaklineError) as caught:
        demo_folder(tmp_path / "file")
    assert caught.value.code is ErrorCode.CANNOT_WRITE
