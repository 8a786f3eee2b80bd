"""What a hostile or unlucky technician gives `leakline process`: each of these once broke it."""

import json

import numpy as np
import pytest
import soundfile

from processing import pipeline


def rows_of(folder):
    head, *rows = (folder / "imu.csv").read_text(encoding="utf-8").splitlines()
    return head, np.array([[float(cell) for cell in row.split(",")] for row in rows])


def write_rows(folder, head, table):
    np.savetxt(folder / "imu.csv", table, delimiter=",", fmt="%.6f", header=head, comments="")


@pytest.mark.parametrize(("gap_s", "longest_s"), [(3 * 3600.0, 4 * 3600.0), (30 * 86400.0, 100.0)])
def test_a_clock_that_jumps_by_hours_or_days_neither_fails_nor_fills_the_memory(copied, processed, gap_s, longest_s):
    folder = copied()
    head, table = rows_of(folder)
    table[table[:, 0] > 30.0, 0] += gap_s
    write_rows(folder, head, table)
    status, _, out = processed(folder)
    assert status == 0
    times = np.loadtxt(out / "track.csv", delimiter=",", skiprows=1, usecols=0)
    assert times[-1] - times[0] < longest_s


def test_an_only_tie_point_at_ten_thousand_kilometres_is_refused_with_the_survey_s_name(copied, processed):
    folder = copied(
        ("chainage_m = 11.", "chainage_m = 1e7, up_m = 11."), ('name = "ret', 'enabled = false, name = "ret')
    )
    status, errors, _ = processed(folder)
    assert status == 2
    assert "survey.toml" in errors[0]


def test_no_device_moves_faster_than_the_limit(device_folder, processed, monkeypatch):
    monkeypatch.setattr(pipeline, "FASTEST_MPS", -100.0)
    assert processed(device_folder)[0] == 2


def test_a_thousand_tie_points_are_read_without_looking_for_the_line_of_each(tmp_path, copied, monkeypatch):
    from processing.importing import survey_keys
    from processing.importing.survey_toml import read_survey_toml

    ties = "".join(f'[[tie_points]]\nname = "{i}"\ntime_s = {i}.0\nchainage_m = {i}.0\n' for i in range(1000))
    told = tmp_path / "survey.toml"
    told.write_text(ties, encoding="utf-8")
    looked: list[str] = []
    monkeypatch.setattr(survey_keys, "line_of", lambda *words: looked.append(str(words[1])))
    assert len(read_survey_toml(told).tie_points) == 1000
    assert not looked


@pytest.mark.parametrize(
    "change",
    [
        ("[launch]", '[launch]\ncrs = "EPSG:99999"\neast_m = 1.0\nnorth_m = 1.0'),
        ("[launch]", '[launch]\ncrs = "EPSG:5254"'),
        ("[launch]", '[processing]\norientation = "nope"\n[launch]'),
    ],
)
def test_what_cannot_be_in_survey_toml_is_refused_with_its_name(copied, processed, change):
    status, errors, _ = processed(copied(change))
    assert status == 2
    assert "survey.toml" in errors[0]


def test_a_wrong_word_of_the_command_line_is_not_blamed_on_survey_toml(device_folder, processed):
    status, errors, _ = processed(device_folder, "--set", "processing.orientation=nope")
    assert status == 2
    assert "survey.toml" not in errors[0]


def test_without_sound_the_whole_pipe_is_not_assessed(copied, processed):
    folder = copied(("[audio]", ""), ('file = "audio.wav"', ""), without="audio.wav")
    status, _, out = processed(folder)
    assert status == 0
    summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    (stretch,) = summary["not_assessed"]
    assert (stretch["channel"], stretch["reason"]) == ("sound", "no_sound")
    assert summary["quality"]["not_assessed_m"] == pytest.approx(summary["quality"]["length_m"], abs=0.1)
    features = json.loads((out / "leaks.geojson").read_text(encoding="utf-8"))["features"]
    assert [f["properties"]["reason"] for f in features if f["properties"]["kind"] == "not_assessed"] == ["no_sound"]


def test_the_channel_of_the_command_line_is_the_one_that_is_heard(copied, processed):
    folder = copied()
    samples, rate = soundfile.read(folder / "audio.wav")
    soundfile.write(folder / "audio.wav", np.column_stack([samples, np.zeros_like(samples)]), rate)
    status, _, out = processed(folder, "--set", "audio.channel=1")
    assert status == 0
    reasons = {s["reason"] for s in json.loads((out / "summary.json").read_text(encoding="utf-8"))["not_assessed"]}
    assert "sound_silent" in reasons


def test_a_channel_of_the_command_line_that_does_not_exist_is_told(device_folder, processed):
    _, _, out = processed(device_folder, "--set", "audio.channel=7")
    codes = [f["code"] for f in json.loads((out / "summary.json").read_text(encoding="utf-8"))["findings"]]
    assert codes.count("audio_channel_missing") == 1


def test_the_sound_file_of_the_command_line_is_taken(copied, processed):
    folder = copied()
    (folder / "audio.wav").rename(folder / "other.wav")
    status, _, out = processed(folder, "--set", "audio.file=other.wav")
    assert status == 0
    inputs = json.loads((out / "summary.json").read_text(encoding="utf-8"))["inputs"]
    assert "other.wav" in {file["file"] for file in inputs}


def test_a_simulated_folder_gives_no_doubt_about_its_log_nor_do_the_files_written_into_it(copied, capsys):
    from app import cli

    folder = copied()
    for _ in range(2):
        assert cli.run(["process", str(folder), "--out", str(folder)]) == 0
        said = capsys.readouterr().out
        assert "track.csv" not in said


@pytest.mark.parametrize("orientation", ["ekf7", "gyro"])
def test_rolling_data_told_as_carried_end_in_a_result_or_a_sentence(device_folder, processed, orientation):
    words = ("--set", "device.motion=carried", "--set", f"processing.orientation={orientation}")
    status, errors, _ = processed(device_folder, *words, "--set", "processing.detector=envelope")
    assert status == 0 or "m long in" in errors[0]


@pytest.mark.parametrize(
    "name", ["\\u0000\\u001b[31m", "line\\nbreak", "../../x", "#set page() *x* $y$ @z <w> `q`", "العربية 😀 ]]>"]
)
def test_any_name_can_stand_on_the_report(copied, processed, name):
    folder = copied(
        ('name = "retrieval"', f'name = "{name}"'), ("[survey]\nname =", f'[survey]\nclient = "{name}"\nname =')
    )
    assert processed(folder)[0] == 0
