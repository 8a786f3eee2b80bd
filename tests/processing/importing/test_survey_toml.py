"""survey.toml: read, written, and overridden from the command line."""

import dataclasses

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.importing.survey_toml import (
    apply_override,
    read_survey_toml,
    read_survey_with_findings,
    write_survey_toml,
)
from processing.settings import Settings
from processing.survey import (
    AudioInfo,
    DeviceInfo,
    Launch,
    Motion,
    PipeInfo,
    ProcessingChoice,
    Route,
    Survey,
    SurveyInfo,
    TiePoint,
)

FULL = """
[survey]
name = "Station Road main"
operator = "Ayşe Yılmaz"
date = 2026-05-04
client = "İSKİ"

[pipe]
material = "ductile iron"
diameter_m = 0.30
length_m = 1204

[device]
motion = "carried"
radius_m = 0.0475

[audio]
file = "audio.wav"
channel = 1
start_time_s = -2.5
drift_ppm = 12.0

[launch]
latitude = 40.9012
longitude = 29.1
elevation_m = 31.0
heading_deg = 45.0

[[tie_points]]
name = "retrieval"
time_s = 2411.5
chainage_m = 1204.0
sigma_m = 0.25

[[tie_points]]
time_s = 100
east_m = 3.0
north_m = 4.0

[route]
crs = "EPSG:5254"
points = [[0.0, 0.0, 0.0], [120, 4.0]]
sigma_m = 0.4

[processing]
orientation = "madgwick"
"""


def written(tmp_path, text, encoding="utf-8"):
    path = tmp_path / "survey.toml"
    path.write_bytes(text.encode(encoding))
    return path


def refused(path):
    with pytest.raises(LeaklineError) as caught:
        read_survey_toml(path)
    return caught.value


def test_every_key_of_the_contract_arrives(tmp_path):
    survey = read_survey_toml(written(tmp_path, FULL))
    assert survey.info == SurveyInfo("Station Road main", "Ayşe Yılmaz", "2026-05-04", "İSKİ")
    assert survey.pipe == PipeInfo("ductile iron", 0.3, 1204.0)
    assert survey.device == DeviceInfo(Motion.CARRIED, 0.0475)
    assert survey.audio == AudioInfo("audio.wav", 1, -2.5, 12.0)
    assert survey.launch == Launch(40.9012, 29.1, elevation_m=31.0, heading_deg=45.0)
    assert survey.tie_points[0] == TiePoint("retrieval", 2411.5, chainage_m=1204.0, sigma_m=0.25)
    assert (survey.tie_points[1].name, survey.tie_points[1].east_m) == ("2", 3.0)
    assert survey.route == Route(((0.0, 0.0, 0.0), (120.0, 4.0, 0.0)), "EPSG:5254", 0.4)
    assert survey.processing == ProcessingChoice(orientation="madgwick")


def test_an_empty_file_is_all_defaults(tmp_path):
    assert read_survey_toml(written(tmp_path, "")) == Survey()


def test_a_date_may_be_a_string(tmp_path):
    assert read_survey_toml(written(tmp_path, '[survey]\ndate = "2026-05-04"')).info.date == "2026-05-04"


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1254"])
def test_notepad_s_encodings_are_understood(tmp_path, encoding):
    assert read_survey_toml(written(tmp_path, '[survey]\nclient = "Şişli"', encoding)).info.client == "Şişli"


def test_unknown_keys_are_tolerated_and_named(tmp_path):
    survey, findings = read_survey_with_findings(written(tmp_path, "[pipe]\nlenght_m = 3\n[colour]\nx = 1"))
    assert survey == Survey()
    assert [f.code for f in findings] == ["survey_keys_unknown"]
    assert findings[0].params["names"] == "colour, pipe.lenght_m"


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("[pipe]\n\nlength_m = -3", "pipe.length_m"),
        ("[pipe]\n\nlength_m = nan", "pipe.length_m"),
        ("[pipe]\n\ndiameter_m = inf", "pipe.diameter_m"),
        ("[pipe]\n\ndiameter_m = true", "pipe.diameter_m"),
        ("[device]\n\nradius_m = 0", "device.radius_m"),
        ("[device]\n\nradius_m = 1" + "0" * 400, "device.radius_m"),
        ("[device]\n\nmotion = 'flying'", "device.motion"),
        ("[audio]\n\nchannel = -1", "audio.channel"),
        ("[survey]\n\ndate = 'yesterday'", "survey.date"),
        ("[launch]\n\nlatitude = 91.0", "launch.latitude"),
        ("[survey]\n\nname = [1]", "survey.name"),
    ],
)
def test_an_impossible_value_is_named_with_its_line(tmp_path, line, name):
    error = refused(written(tmp_path, line))
    assert (error.code, error.params["name"]) == (ErrorCode.SETTING_INVALID, name)
    assert error.place.line == 3


def test_the_line_of_a_wrong_tie_point_is_that_of_its_own_table(tmp_path):
    text = "[[tie_points]]\ntime_s = 1\nchainage_m = 2\n[[tie_points]]\ntime_s = 1\nchainage_m = -2\n"
    assert refused(written(tmp_path, text)).place.line == 6


@pytest.mark.parametrize(
    "text",
    [
        "[[tie_points]]\nchainage_m = 1",
        "[[tie_points]]\ntime_s = 1",
        "[[tie_points]]\ntime_s = 1\nlatitude = 2",
        "[launch]\neast_m = 2",
        "[route]\ncrs = 'local'",
    ],
)
def test_half_a_place_is_no_place(tmp_path, text):
    error = refused(written(tmp_path, text))
    assert (error.code, error.place.line) == (ErrorCode.KEY_MISSING, 1)


@pytest.mark.parametrize(
    "text",
    ["pipe = 3", "tie_points = 3", "[[tie_points]]\n[route]\npoints = 1", "[route]\npoints = [[1]]", "[[pipe]]\nx = 1"],
)
def test_a_wrong_shape_ends_in_a_message(tmp_path, text):
    assert refused(written(tmp_path, text)).code in (ErrorCode.SETTING_INVALID, ErrorCode.KEY_MISSING)


@pytest.mark.parametrize("text", ["[pipe\n", "x = " + "[" * 5000, "x = " + "9" * 5000, "\0", "[pipe]\n[pipe]"])
def test_what_is_no_toml_ends_in_a_message(tmp_path, text):
    assert refused(written(tmp_path, text)).code is ErrorCode.TOML_INVALID


def test_a_syntax_error_is_placed(tmp_path):
    place = refused(written(tmp_path, "[pipe]\nlength_m = = 3")).place
    assert (place.line, place.column) == (2, 12)


def test_a_missing_file_is_named(tmp_path):
    assert refused(tmp_path / "survey.toml").code is ErrorCode.FILE_MISSING
    assert refused(tmp_path).code is ErrorCode.FILE_UNREADABLE


words = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
positive = st.floats(1e-3, 5.0)
metres = st.floats(-1e6, 1e6)
maybe = lambda strategy: st.none() | strategy  # noqa: E731
tie_points = st.builds(
    TiePoint,
    name=words,
    time_s=st.floats(-1e9, 1e9),
    chainage_m=st.floats(0, 1e6),
    up_m=maybe(st.floats(-100, 100)),
    sigma_m=positive,
    enabled=st.booleans(),
)
surveys = st.builds(
    Survey,
    info=st.builds(SurveyInfo, words, words, st.dates().map(lambda d: d.isoformat()) | st.just(""), words),
    pipe=st.builds(PipeInfo, words, maybe(positive), maybe(positive)),
    device=st.builds(DeviceInfo, st.sampled_from(Motion), maybe(positive)),
    audio=st.builds(
        AudioInfo,
        maybe(words),
        st.integers(0, 255),
        maybe(metres),
        maybe(st.floats(-500, 500)),
        start_sigma_s=maybe(st.floats(1e-6, 10.0)),
        drift_sigma_ppm=maybe(st.floats(1e-6, 100.0)),
    ),
    launch=st.builds(Launch, elevation_m=maybe(st.floats(-100, 100)), crs=maybe(words)),
    tie_points=st.lists(tie_points, max_size=3).map(tuple),
    route=maybe(
        st.builds(
            Route, st.lists(st.tuples(metres, metres, metres), min_size=2, max_size=4).map(tuple), words, positive
        )
    ),
    processing=st.builds(ProcessingChoice, words, words, words),
)


@settings(max_examples=150, deadline=None)
@given(survey=surveys)
def test_what_is_written_reads_back_the_same(tmp_path_factory, survey):
    path = tmp_path_factory.mktemp("survey") / "survey.toml"
    write_survey_toml(path, survey)
    assert read_survey_toml(path) == survey


def test_writing_where_nothing_can_be_written_is_told(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        write_survey_toml(tmp_path / "missing" / "survey.toml", Survey())
    assert caught.value.code is ErrorCode.CANNOT_WRITE


def test_overrides_reach_the_survey_first_and_the_settings_next():
    survey, tuned = apply_override(Survey(), Settings(), "device.radius_m=0.05")
    survey, tuned = apply_override(survey, tuned, "device.motion=foot")
    survey, tuned = apply_override(survey, tuned, "processing.orientation = madgwick")
    survey, tuned = apply_override(survey, tuned, "survey.date=2026-05-04")
    survey, tuned = apply_override(survey, tuned, "audio.channel=1")
    survey, tuned = apply_override(survey, tuned, "sound.band_low_hz=600")
    assert survey.device == DeviceInfo(Motion.FOOT, 0.05)
    assert (survey.processing.orientation, survey.info.date, survey.audio.channel) == ("madgwick", "2026-05-04", 1)
    assert tuned.sound.band_low_hz == 600.0


def test_a_clock_that_is_overridden_is_no_measurement_any_more():
    measured = AudioInfo(start_time_s=1.0, drift_ppm=2.0, start_sigma_s=0.01, drift_sigma_ppm=0.5)
    survey, _ = apply_override(Survey(audio=measured), Settings(), "audio.channel=1")
    assert survey.audio == dataclasses.replace(measured, channel=1)
    survey, _ = apply_override(Survey(audio=measured), Settings(), "audio.start_time_s=1.5")
    assert survey.audio == AudioInfo(start_time_s=1.5, drift_ppm=2.0)


def test_an_empty_override_makes_a_key_unknown_again():
    survey = dataclasses.replace(Survey(), pipe=PipeInfo(length_m=3.0))
    assert apply_override(survey, Settings(), "pipe.length_m=")[0] == Survey()


@pytest.mark.parametrize(
    ("override", "code"),
    [
        ("pipe.length_m=-3", ErrorCode.SETTING_INVALID),
        ("device.motion=flying", ErrorCode.SETTING_INVALID),
        ("audio.channel=1.5", ErrorCode.SETTING_INVALID),
        ("pipe.colour=red", ErrorCode.SETTING_UNKNOWN),
        ("nonsense", ErrorCode.SETTING_UNKNOWN),
        ("pipe=3", ErrorCode.SETTING_UNKNOWN),
        ("tie_points.time_s=3", ErrorCode.SETTING_UNKNOWN),
    ],
)
def test_a_wrong_override_is_refused(override, code):
    with pytest.raises(LeaklineError) as caught:
        apply_override(Survey(), Settings(), override)
    assert caught.value.code is code
