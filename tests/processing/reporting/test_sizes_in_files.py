"""Sizes in the files: their class and what it rests on, for leaks only, and litres only beside a known leak."""

import csv
import json
from dataclasses import replace

import pytest

from processing.reporting.content import make_content
from processing.reporting.dig_sheet import sheet
from processing.reporting.gis import write_geojson
from processing.reporting.listing import table_row
from processing.reporting.options import ReportOptions
from processing.reporting.tables import write_leaks
from processing.reporting.words import Words
from processing.survey import CalibrationLeak, Decision, LeakClass

FIGURES = {"size_over_db": 12.0, "size_background_db": -60.0, "size_low_hz": 800.0, "size_high_hz": 3200.0}


@pytest.fixture
def measured(results):
    candidates = tuple(
        replace(c, leak_class=LeakClass.LEAK, evidence={**FIGURES, "speed_mps": 0.5}) for c in results.candidates
    )
    return replace(results, candidates=candidates)


def written(results, decisions, folder):
    content = make_content(results, decisions)
    write_leaks(folder / "leaks.csv", content)
    write_geojson(folder / "leaks.geojson", content)
    with (folder / "leaks.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["id"]: row for row in csv.DictReader(file)}
    features = json.loads((folder / "leaks.geojson").read_text(encoding="utf-8"))["features"]
    return rows, {str(f["properties"]["id"]): f["properties"] for f in features if f["properties"]["kind"] == "leak"}


def test_a_size_stands_with_its_basis_in_table_and_map(measured, tmp_path):
    rows, features = written(measured, {}, tmp_path)
    for number, row in rows.items():
        assert row["size"] == "medium-large"
        assert "800-3200 Hz" in row["size_basis"]
        assert "not calibrated" in row["size_basis"]
        assert (features[number]["size"], features[number]["size_basis"]) == (row["size"], row["size_basis"])


def test_what_the_operator_calls_a_valve_has_no_size(measured, tmp_path):
    first = measured.candidates[0].id
    rows, features = written(measured, {first: Decision(leak_class=LeakClass.VALVE)}, tmp_path)
    assert rows[str(first)]["size"] == rows[str(first)]["size_basis"] == ""
    assert features[str(first)]["size"] is None


def test_litres_stand_only_beside_a_known_leak(measured, tmp_path):
    reference = measured.candidates[0]
    known = CalibrationLeak(reference.chainage_m, 20.0, 3.0, "tap")
    told = replace(measured, survey=replace(measured.survey, calibration_leak=known))
    rows, _ = written(told, {}, tmp_path)
    assert rows[str(reference.id)]["size_basis"].startswith("known leak: 20 L/min")
    others = [row for number, row in rows.items() if number != str(reference.id)]
    assert others
    assert all("L/min" in row["size_basis"] and "known leak" in row["size_basis"] for row in others)


@pytest.mark.parametrize(("language", "word"), [("en", "medium or large"), ("tr", "orta veya büyük")])
def test_the_report_says_the_size_in_its_language(measured, language, word):
    content = make_content(measured, {})
    words = Words(ReportOptions(language))
    assert word in table_row(content.rows[0], content, words)["class"]
    assert any(value.startswith(word) for _, value in sheet(content.rows[0], content, words)["facts"])


def test_what_was_stored_before_sizes_were_known_reads_as_unknown(results, tmp_path):
    rows, _ = written(results, {}, tmp_path)
    assert {row["size"] for row in rows.values()} <= {"unknown", ""}
    assert {row["size_basis"] for row in rows.values()} == {""}
