"""A survey of a minute in 23 m, small enough to be processed in half a second, and the check of what comes out."""

import csv
import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pypdf
import pytest

from app import cli
from processing.simulation.run import simulate
from processing.simulation.scenario import PipeRoute
from processing.simulation.scenarios import load_scenario
from processing.simulation.writing import write_run

FILES = {"leaks.csv", "track.csv", "leaks.geojson", "summary.json", "report.pdf"}


@pytest.fixture(scope="session")
def device_folder(tmp_path_factory) -> Path:
    """The `rolling` scenario shortened to 23 m, at 100 Hz and 8 kHz."""
    long = load_scenario("rolling")
    scenario = replace(
        long,
        route=PipeRoute(((0.0, 0.0, 0.0), (0.0, 14.0, 0.0), (10.0, 14.0, 0.2)), bend_radius_m=0.9),
        imu=replace(long.imu, rate_hz=100.0),
        sound=replace(long.sound, rate_hz=8000, local=(replace(long.sound.local[0], chainage_m=9.0),)),
        markers=(replace(long.markers[0], chainage_m=12.0), long.markers[1]),
    )
    folder = tmp_path_factory.mktemp("short") / "device"
    write_run(simulate(scenario, 1), folder)
    return folder


@pytest.fixture
def copied(device_folder, tmp_path) -> Callable[..., Path]:
    """Return a function that copies the survey, with ``survey.toml`` changed by pairs of old and new text."""

    def copy(*changes: tuple[str, str], more: str = "", without: str = "") -> Path:
        folder = tmp_path / "device"
        shutil.copytree(device_folder, folder)
        told = folder / "survey.toml"
        text = told.read_text(encoding="utf-8")
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        told.write_text(text + more, encoding="utf-8")
        if without:
            (folder / without).unlink()
        return folder

    return copy


@pytest.fixture
def processed(tmp_path, capsys) -> Callable[..., tuple[int, list[str], Path]]:
    """Return a function that runs `leakline process` and gives the status, the lines of the error, and the files."""

    def process(path: Path, *words: str) -> tuple[int, list[str], Path]:
        out = tmp_path / "out"
        status = cli.run(["process", str(path), "--out", str(out), *words])
        errors = capsys.readouterr().err.splitlines()
        if status == 0:
            assert errors == []
            assert_complete(out)
        else:
            assert status == 2, errors
            assert len(errors) == 1, errors
        return status, errors, out

    return process


def assert_complete(out: Path) -> None:
    """All files of the contract, finite, in order, and nothing else."""
    assert {path.name for path in out.iterdir()} == FILES

    def refuse(word: str) -> None:
        raise AssertionError(f"{word} is no JSON")

    for name in ("summary.json", "leaks.geojson"):
        json.loads((out / name).read_text(encoding="utf-8"), parse_constant=refuse)
    with (out / "leaks.csv").open(encoding="utf-8", newline="") as file:
        leaks = list(csv.DictReader(file))
    scores = [float(leak["score"]) for leak in leaks]
    assert scores == sorted(scores, reverse=True)
    for leak in leaks:
        if leak["chainage_m"]:
            low, at, high = (float(leak[k]) for k in ("chainage_low95_m", "chainage_m", "chainage_high95_m"))
            assert low <= at <= high
    rows = (out / "track.csv").read_text(encoding="utf-8").splitlines()[1:]
    if rows:
        track = np.array([[float(cell) for cell in row.split(",")] for row in rows])
        assert np.isfinite(track).all()
        assert np.all(np.diff(track[:, 1]) >= 0)
        assert np.diff(track[:, 0]).min() > 0
        assert np.diff(track[:, 0]).max() <= 0.1001
    assert len(pypdf.PdfReader(out / "report.pdf").pages) >= 1
