"""The files of the contract, read back by other libraries."""

import csv
import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pyogrio.raw
import pypdf
import pyproj
import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.reporting.exports import write_exports
from processing.reporting.files import whole_file
from processing.survey import Launch

COLUMNS = (
    "id,status,class,time_s,chainage_m,chainage_low95_m,chainage_high95_m,east_m,north_m,up_m,latitude,longitude,"
    "score,level_dB,note"
)


@pytest.fixture
def folder(results, decisions, tmp_path):
    write_exports(results, decisions, tmp_path)
    return tmp_path


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_the_leak_table_has_the_contracts_columns_best_score_first(folder):
    table = rows(folder / "leaks.csv")
    assert ",".join(table[0]).startswith(COLUMNS)
    assert [row["id"] for row in table] == ["2", "1", "3"]
    assert [row["status"] for row in table] == ["candidate", "confirmed", "rejected"]


def test_a_confirmed_leak_carries_the_operators_class_and_note_unchanged(folder, decisions):
    row = next(row for row in rows(folder / "leaks.csv") if row["id"] == "1")
    assert row["class"] == "valve"
    assert row["note"] == decisions[1].note
    assert (float(row["chainage_low95_m"]), float(row["chainage_high95_m"])) == (41.0, 43.0)


def test_coordinates_agree_with_pyproj_to_a_millimetre(folder):
    row = next(row for row in rows(folder / "leaks.csv") if row["id"] == "2")
    geod = pyproj.Geod(ellps="WGS84")
    azimuth, _, metres = geod.inv(29.1, 40.9012, float(row["longitude"]), float(row["latitude"]))
    assert azimuth == pytest.approx(45.0, abs=0.01)
    assert metres == pytest.approx(70.0, abs=0.002)


def test_without_launch_coordinates_the_degrees_are_empty(results, decisions, tmp_path):
    local = replace(results, survey=replace(results.survey, launch=Launch()))
    write_exports(local, decisions, tmp_path)
    assert {row["latitude"] for row in rows(tmp_path / "leaks.csv")} == {""}
    assert "not WGS 84" in json.loads((tmp_path / "leaks.geojson").read_text(encoding="utf-8"))["frame"]


def test_in_a_coordinate_system_the_places_are_in_that_system(results, decisions, tmp_path):
    launch = Launch(east_m=500_000.0, north_m=4_528_000.0, crs="EPSG:5254", elevation_m=31.0)
    write_exports(replace(results, survey=replace(results.survey, launch=launch)), decisions, tmp_path)
    row = next(row for row in rows(tmp_path / "leaks.csv") if row["id"] == "2")
    assert float(row["east_m"]) == pytest.approx(500_000 + 70 / np.sqrt(2), abs=0.2)  # the grid's scale and turn
    assert float(row["up_m"]) == pytest.approx(31.0 - 0.7, abs=0.01)


def test_the_track_has_ten_rows_a_second_and_the_contracts_columns(folder):
    table = rows(folder / "track.csv")
    expected = "time_s chainage_m east_m north_m up_m sigma_along_m sigma_cross_m sigma_up_m roll_deg pitch_deg yaw_deg"
    assert list(table[0]) == expected.split()
    times = np.array([float(row["time_s"]) for row in table])
    assert np.diff(times).max() <= 0.1001


def test_gdal_reads_the_geojson_with_every_leak_where_the_table_has_it(folder):
    meta, _, geometry, fields = pyogrio.raw.read(folder / "leaks.geojson")
    assert meta["crs"] == "EPSG:4326"
    names = list(meta["fields"])
    kinds = fields[names.index("kind")]
    assert sorted(set(kinds)) == ["launch", "leak", "not_assessed", "path", "tie_point"]
    assert len(geometry) == len(kinds)
    features = json.loads((folder / "leaks.geojson").read_text(encoding="utf-8"))["features"]
    by_id = {f["properties"]["id"]: f for f in features if f["properties"]["kind"] == "leak"}
    for row in rows(folder / "leaks.csv"):
        longitude, latitude, _ = by_id[int(row["id"])]["geometry"]["coordinates"]
        assert (longitude, latitude) == (float(row["longitude"]), float(row["latitude"]))


def test_the_stretch_that_was_not_assessed_is_told_in_metres(folder):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    (stretch,) = summary["not_assessed"]
    assert (stretch["start_m"], stretch["end_m"]) == (50.0, 60.0)
    assert summary["quality"]["not_assessed_m"] == pytest.approx(10.0)


def test_the_summary_names_versions_inputs_and_settings(folder):
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    assert summary["inputs"][0]["sha256"] == "ab" * 32
    assert summary["versions"]["numpy"] == np.__version__
    assert summary["settings"]["sound"]["band_low_hz"] == 500.0


def test_the_reports_text_can_be_selected_in_turkish(results, decisions, tmp_path):
    write_exports(results, decisions, tmp_path, language="tr")
    reader = pypdf.PdfReader(tmp_path / "report.pdf")
    text = "\n".join(page.extract_text() for page in reader.pages)
    for words in ("Çınar Sokağı", "ıslak zemin", "İŞĞÜÖÇ", "Değerlendirilemeyen", "50,0 – 60,0 m", "41,0 – 43,0 m"):
        assert words in text, words
    fonts = {font.get_object()["/BaseFont"] for page in reader.pages for font in page["/Resources"]["/Font"].values()}
    assert all("Inter" in name or "Mono" in name for name in fonts), fonts


def test_the_report_has_a_sheet_for_each_place_that_was_not_rejected(folder):
    text = "\n".join(page.extract_text() for page in pypdf.PdfReader(folder / "report.pdf").pages)
    assert "Leak 1" in text
    assert "Place 2" in text
    assert "Place 3" not in text
    assert "DRAFT: places undecided or unsure: 1" in text


def test_figures_are_vectors(folder):
    """The map and the level are drawn, not photographed: the only pictures are a sheet's spectrogram and its bar."""
    pages = pypdf.PdfReader(folder / "report.pdf").pages
    assert len(pages[0].images) == 0
    assert all(len(page.images) <= 2 for page in pages)


def test_a_survey_without_a_path_still_gives_a_report_that_says_so(results, tmp_path):
    bare = replace(results, track=None, level_along=None, candidates=())
    write_exports(bare, {}, tmp_path)
    text = "\n".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "report.pdf").pages)
    assert "There is no path" in text
    assert len((tmp_path / "track.csv").read_text(encoding="utf-8").splitlines()) == 1


def test_a_name_full_of_markup_is_shown_as_it_is(results, tmp_path):
    odd = '#let x = 1 <b> *bold* $x$ "quoted" \\ &amp;'
    survey = replace(results.survey, info=replace(results.survey.info, name=odd))
    write_exports(replace(results, survey=survey), {}, tmp_path)
    text = pypdf.PdfReader(tmp_path / "report.pdf").pages[0].extract_text()
    assert "*bold*" in text
    assert "#let x" in text


def test_a_folder_that_cannot_be_written_is_said(results, tmp_path):
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    with pytest.raises(LeaklineError) as caught:
        write_exports(results, {}, tmp_path / "file")
    assert caught.value.code is ErrorCode.CANNOT_WRITE


def test_a_place_that_the_operator_marked_has_no_probability_and_comes_last(results, tmp_path):
    marked = replace(results.candidates[0], id=9, score=float("nan"), level_db=float("nan"))
    write_exports(replace(results, candidates=(marked, *results.candidates)), {}, tmp_path)
    table = rows(tmp_path / "leaks.csv")
    assert [row["id"] for row in table] == ["2", "1", "3", "9"]
    assert (table[-1]["score"], table[-1]["level_dB"]) == ("", "")
    text = "\n".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "report.pdf").pages)
    assert "marked by the operator" in text
    assert "nan" not in text


def test_two_exports_of_one_program_into_one_folder_cost_each_other_nothing(tmp_path):
    path = tmp_path / "leaks.csv"
    with whole_file(path) as ours:
        ours.write("ours")
        with ThreadPoolExecutor(1) as other:
            other.submit(_write_whole, path, "theirs").result(timeout=10)
        assert path.read_text(encoding="utf-8") == "theirs"
    assert path.read_text(encoding="utf-8") == "ours"
    assert [file.name for file in tmp_path.iterdir()] == ["leaks.csv"]


def _write_whole(path, text):
    with whole_file(path) as file:
        file.write(text)
