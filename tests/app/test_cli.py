"""The command line's contract: statuses, one line on standard error, the files that process writes."""

import csv
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from app import cli
from processing.simulation.run import simulate
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run


@pytest.fixture(scope="module")
def device_folder(tmp_path_factory) -> Path:
    """A small simulated rolling run with sound, as a technician copies it off the ball."""
    folder = tmp_path_factory.mktemp("device") / "Hürriyet Caddesi"
    write_run(simulate(load_scenario("rolling"), 3), folder)
    return folder


def status_and_errors(capsys, *words: str) -> tuple[int, list[str]]:
    try:
        status = cli.run(list(words))
    except SystemExit as left:  # argparse leaves by itself
        status = int(left.code or 0)
    return status, capsys.readouterr().err.splitlines()


def test_process_writes_every_file_of_the_contract(device_folder, tmp_path, capsys):
    status, errors = status_and_errors(capsys, "process", str(device_folder), "--out", str(tmp_path / "out"))
    assert (status, errors) == (0, [])
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"leaks.csv", "track.csv", "leaks.geojson", "report.pdf", "summary.json"}


def test_the_processed_run_finds_the_simulated_leaks_and_its_length(device_folder, tmp_path, capsys):
    truth = json.loads((device_folder / "truth.json").read_text(encoding="utf-8"))
    status_and_errors(capsys, "process", str(device_folder), "--out", str(tmp_path))
    with (tmp_path / "leaks.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) <= 5, "a short list, not every murmur"
    leaks = [place for place in truth["places"] if place["kind"] == "leak"]
    assert leaks
    for leak in leaks:
        nearest = min(rows, key=lambda row: abs(float(row["chainage_m"]) - leak["chainage_m"]))
        assert (
            float(nearest["chainage_low95_m"]) - 0.5 <= leak["chainage_m"] <= float(nearest["chainage_high95_m"]) + 0.5
        )
    track = np.genfromtxt(tmp_path / "track.csv", delimiter=",", names=True)
    assert np.all(np.diff(track["chainage_m"]) >= 0)
    assert np.median(np.diff(track["time_s"])) <= 0.1


def test_the_same_input_gives_the_same_files(device_folder, tmp_path, capsys):
    for name in ("a", "b"):
        status_and_errors(capsys, "process", str(device_folder), "--out", str(tmp_path / name))
    for file in ("leaks.csv", "track.csv", "leaks.geojson"):
        assert (tmp_path / "a" / file).read_bytes() == (tmp_path / "b" / file).read_bytes()


def test_a_setting_can_be_overridden_and_shows_in_the_summary(device_folder, tmp_path, capsys):
    words = ("process", str(device_folder), "--out", str(tmp_path), "--set", "processing.orientation=madgwick")
    assert status_and_errors(capsys, *words)[0] == 0
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert summary["quality"]["orientation"] == "madgwick"


@pytest.mark.parametrize(
    "words",
    [
        ["process", "nowhere", "--out", "OUT"],
        ["process", "DEVICE"],
        ["process", "DEVICE", "--out", "OUT", "--set", "nonsense"],
        ["process", "DEVICE", "--out", "OUT", "--set", "device.radius_m=huge"],
        ["process", "DEVICE", "--out", "OUT", "--set", "device.no_such_key=1"],
        ["process", "DEVICE", "--out", "DEVICE/imu.csv"],
        ["open", "nowhere"],
        ["frobnicate"],
        ["simulate", "no-such-scenario", "--out", "OUT"],
    ],
    ids=" ".join,
)
def test_bad_words_give_status_2_and_one_line(words, device_folder, tmp_path, capsys):
    filled = [w.replace("DEVICE", str(device_folder)).replace("OUT", str(tmp_path / "out")) for w in words]
    status, errors = status_and_errors(capsys, *filled)
    assert status == 2
    assert len(errors) == 1
    assert "Traceback" not in errors[0]


def test_a_bad_cell_is_named_with_file_line_and_what_to_do(tmp_path, capsys):
    (tmp_path / "imu.csv").write_text("time_s,acc_x_mps2\n0,1\n", encoding="utf-8")
    status, errors = status_and_errors(capsys, "process", str(tmp_path), "--out", str(tmp_path / "out"))
    assert status == 2
    assert len(errors) == 1
    assert "imu.csv" in errors[0]


def test_formats_lists_what_can_be_imported(capsys):
    assert cli.run(["formats"]) == 0
    said = capsys.readouterr().out
    for word in ("neutral", "x-IMU3", "Xsens", "P0/P3", "sound", "GeoPackage", "dxf"):
        assert word.lower() in said.lower(), word


def test_processing_loads_no_window(device_folder, tmp_path):
    script = (
        "import sys\nfrom app.cli import run\n"
        f"assert run(['process', {str(device_folder)!r}, '--out', {str(tmp_path)!r}]) == 0\n"
        "assert not [m for m in sys.modules if m.startswith(('PySide6', 'pyqtgraph'))]"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_the_report_speaks_the_language_that_is_set(device_folder, tmp_path, capsys):
    import pypdf

    words = ("process", str(device_folder), "--out", str(tmp_path), "--set", "report.language=tr")
    assert status_and_errors(capsys, *words)[0] == 0
    assert "Konumlar ne kadar kesin" in pypdf.PdfReader(tmp_path / "report.pdf").pages[0].extract_text()
