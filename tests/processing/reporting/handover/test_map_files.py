"""GeoPackage and Shapefile as GDAL reads them: places to a centimetre, attributes whole."""

import itertools
import sqlite3
from dataclasses import replace

import numpy as np
import pyogrio.raw
import pytest
from handover_reading import coordinates, expected_place, features

from processing.quantities import METRES_PER_US_FOOT, Units
from processing.reporting.options import ColumnScheme, FileKind
from processing.survey import Decision, Launch, Verdict

CENTIMETRE = 0.01
NEW_YORK = (-73.99, 40.75)


@pytest.fixture
def in_new_york(surveyed):
    launch = Launch(latitude=NEW_YORK[1], longitude=NEW_YORK[0], elevation_m=10.0)
    return replace(surveyed, survey=replace(surveyed.survey, launch=launch))


@pytest.mark.parametrize("crs", ["", "EPSG:5254", "EPSG:32635", "EPSG:3857", "EPSG:4326", "EPSG:5252"])
def test_gdal_finds_every_leak_where_geodesy_puts_it(hand_over, surveyed, crs):
    folder, written = hand_over(FileKind.GEOPACKAGE, FileKind.SHAPEFILE, crs=crs)
    assert not [finding for finding in written.findings if finding.code != "handover_text_cut"]
    told = crs or "EPSG:32635"  # the zone of the launch
    metres = CENTIMETRE if told not in ("EPSG:4326", "EPSG:5252") else CENTIMETRE / 111_320.0
    for file, layer in ((folder / "survey.gpkg", "leaks"), (folder / "shapefile" / "leaks.shp", "leaks")):
        meta, table = features(file, layer)
        assert meta["crs"] == told
        assert len(table) == len(surveyed.candidates)
        for row in table:
            chainage = row["chainage_m" if file.suffix == ".gpkg" else "chain_m"]
            assert row["xyz"][0][:2] == pytest.approx(expected_place(chainage, told), abs=metres), (file, row)
            assert row["xyz"][0][2] == pytest.approx(31.0 - 0.01 * chainage, abs=CENTIMETRE)


def test_a_system_in_us_survey_feet_gets_feet(hand_over, in_new_york):
    kinds = FileKind.GEOPACKAGE, FileKind.SHAPEFILE
    folder, written = hand_over(*kinds, changed=in_new_york, crs="EPSG:2263", units=Units.US)
    assert not written.findings
    for file, end in ((folder / "survey.gpkg", "chainage_ftus"), (folder / "shapefile" / "leaks.shp", "chain_ftus")):
        meta, table = features(file, "leaks")
        assert meta["crs"] == "EPSG:2263"
        for row in table:
            chainage = row[end] * METRES_PER_US_FOOT
            expected = expected_place(chainage, "EPSG:2263", NEW_YORK)  # pyproj gives the system's own feet
            assert row["xyz"][0][:2] == pytest.approx(expected, abs=CENTIMETRE / METRES_PER_US_FOOT)
            assert (row["east_ftus"], row["north_ftus"]) == pytest.approx(expected, abs=0.03)
            assert row["xyz"][0][2] == pytest.approx((10.0 - 0.01 * chainage) / METRES_PER_US_FOOT, abs=0.03)
    assert sorted(round(row["chain_ftus"] * METRES_PER_US_FOOT, 2) for row in table) == [10.0, 25.0, 42.0, 70.0]


def test_the_attributes_are_those_of_the_review(hand_over, surveyed, decisions):
    folder, _ = hand_over(FileKind.GEOPACKAGE)
    _, table = features(folder / "survey.gpkg", "leaks")
    by_id = {row["id"]: row for row in table}
    assert sorted(by_id) == [1, 2, 3, 17]
    one, two = by_id[1], by_id[2]
    assert (one["status"], one["verdict"], one["class"], one["result"]) == (
        "confirmed", "confirmed", "valve", "no_leak_found",
    )  # fmt: skip
    assert one["note"] == decisions[1].note
    assert (one["chainage_m"], one["chainage_low95_m"], one["chainage_high95_m"], one["half95_m"]) == (42, 41, 43, 1)
    assert one["across95_m"] == pytest.approx(1.959964 * 0.5, abs=1e-3)
    assert (one["before"], one["before_distance_m"], one["after"], one["after_distance_m"]) == (
        "valve 12", 12.0, "hydrant", 38.0,
    )  # fmt: skip
    assert (two["dig"], two["dig_date"], two["dig_off_along_m"]) == ("leak", "2026-05-11", -0.4)
    assert {row["pipe_id"] for row in table} == {"H-12"}
    assert {row["crs"] for row in table} == {"EPSG:32635"}
    candidate = surveyed.candidates[1]
    assert (two["score"], two["level_dB"], two["time_s"]) == (candidate.score, candidate.level_db, candidate.time_s)


def test_what_is_not_known_is_null_not_zero(hand_over):
    folder, _ = hand_over(FileKind.GEOPACKAGE, FileKind.SHAPEFILE)
    with sqlite3.connect(folder / "survey.gpkg") as database:
        cells = database.execute("SELECT score, level_dB, note, dig FROM leaks WHERE id = 17").fetchone()
        shown = database.execute("SELECT typeof(note) FROM leaks WHERE id = 1").fetchone()
    database.close()
    assert cells == (None, None, None, None)
    assert shown == ("text",)
    _, table = features(folder / "shapefile" / "leaks.shp", "leaks")
    marked = next(row for row in table if row["id"] == 17)
    assert np.isnan(marked["score"])
    assert marked["note"] is None


def test_a_long_turkish_note_is_cut_between_letters_in_shapefiles_only_and_that_is_told(hand_over, decisions):
    note = "şğıİöçü" * 60
    decided = decisions | {2: Decision(Verdict.UNSURE, None, note)}
    folder, written = hand_over(FileKind.GEOPACKAGE, FileKind.SHAPEFILE, decided=decided)
    _, whole = features(folder / "survey.gpkg", "leaks")
    assert next(row for row in whole if row["id"] == 2)["note"] == note
    _, short = features(folder / "shapefile" / "leaks.shp", "leaks")
    kept = next(row for row in short if row["id"] == 2)["note"]
    assert note.startswith(kept)
    assert 250 <= len(kept.encode()) <= 254
    (finding,) = written.findings
    assert (finding.code, finding.params["columns"]) == ("handover_text_cut", "note")


def test_shapefiles_say_their_encoding_and_their_system(hand_over):
    folder, _ = hand_over(FileKind.SHAPEFILE, crs="EPSG:5254")
    for name in ("leaks", "stretches", "track", "reference_points"):
        files = {path.suffix for path in (folder / "shapefile").glob(f"{name}.*")}
        assert files == {".shp", ".shx", ".dbf", ".cpg", ".prj"}
        assert (folder / "shapefile" / f"{name}.cpg").read_text() == "UTF-8"
        names = list(pyogrio.raw.read(folder / "shapefile" / f"{name}.shp")[0]["fields"])
        assert max(map(len, names)) <= 10
        assert len({n.upper() for n in names}) == len(names)


def test_an_asset_system_finds_its_columns(hand_over):
    folder, _ = hand_over(FileKind.GEOPACKAGE, FileKind.SHAPEFILE, columns=ColumnScheme.ASSET, crs="EPSG:5254")
    _, table = features(folder / "survey.gpkg", "leaks")
    for row in table:
        assert row["pipe_id"] == "H-12"
        assert (row["x"], row["y"]) == pytest.approx(expected_place(row["leak_distance"], "EPSG:5254"), abs=CENTIMETRE)
        assert row["units"] == "m"
    meta, _ = features(folder / "shapefile" / "leaks.shp", "leaks")
    names = list(meta["fields"])
    assert {"leak_id", "pipe_id", "leak_dist", "x", "y", "accuracy"} <= set(names)
    assert max(map(len, names)) <= 10
    assert len(set(names)) == len(names)


def test_the_stretches_and_the_track_follow_the_pipe_end_to_end(hand_over):
    folder, _ = hand_over(FileKind.GEOPACKAGE, crs="EPSG:32635")
    for layer in ("stretches", "track"):
        _, table = features(folder / "survey.gpkg", layer)
        assert (table[0]["start_m"], table[-1]["end_m"]) == (0.0, 100.0)
        for one, other in itertools.pairwise(table):
            assert one["end_m"] == other["start_m"]
            assert one["xyz"][-1] == pytest.approx(other["xyz"][0], abs=1e-9)
        for row in table:
            for end, place in ((row["start_m"], row["xyz"][0]), (row["end_m"], row["xyz"][-1])):
                assert place[:2] == pytest.approx(expected_place(end, "EPSG:32635"), abs=CENTIMETRE)
    assert [row["half95_m"] for row in table] == pytest.approx([1.959964 * 0.5] * 20, abs=1e-3)
    _, table = features(folder / "survey.gpkg", "stretches")
    assert [row["status"] for row in table].count("not_assessed") == 1
    assert sum(row["length_m"] for row in table) == pytest.approx(100.0)


def test_a_segment_tells_the_largest_interval_in_it(hand_over, surveyed):
    sigma = np.full(surveyed.track.time_s.size, 0.1)
    sigma[np.argmin(np.abs(surveyed.track.chainage_m - 33.0))] = 2.0  # a short doubt
    changed = replace(surveyed, track=replace(surveyed.track, sigma_along_m=sigma))
    folder, _ = hand_over(FileKind.GEOPACKAGE, changed=changed)
    _, table = features(folder / "survey.gpkg", "track")
    widest = [row for row in table if row["half95_m"] > 1.0]
    assert [(row["start_m"], row["end_m"]) for row in widest] == [(30.0, 35.0)]
    assert widest[0]["half95_m"] == pytest.approx(1.959964 * 2.0, abs=1e-3)


def test_launch_and_tie_points_are_there(hand_over):
    folder, _ = hand_over(FileKind.GEOPACKAGE, crs="EPSG:5254")
    _, table = features(folder / "survey.gpkg", "reference_points")
    told = [(row["name"], row["kind"], row["chainage_m"]) for row in table]
    assert told == [("launch", "launch", 0.0), ("valve 12", "chainage", 30.0), ("hydrant", "chainage", 80.0)]
    for row in table:
        assert row["xyz"][0][:2] == pytest.approx(expected_place(row["chainage_m"], "EPSG:5254"), abs=CENTIMETRE)


def test_without_a_launch_the_files_are_local_and_say_so(hand_over, surveyed):
    local = replace(surveyed, survey=replace(surveyed.survey, launch=Launch()))
    folder, written = hand_over(changed=local, units=Units.US)
    codes = [finding.code for finding in written.findings]
    assert codes == ["handover_local", "handover_no_place", "handover_no_place"]
    assert not {"survey.kml", "survey.gpx", "survey.prj"} & {path.name for path in folder.iterdir()}
    assert not list((folder / "shapefile").glob("*.prj"))
    meta, table = features(folder / "survey.gpkg", "leaks")
    assert "Undefined" in meta["crs"]
    for row in table:  # metres, as map programs take an unnamed system; the lengths beside are what was asked for
        side = row["chainage_ftus"] * METRES_PER_US_FOOT / np.sqrt(2)
        assert row["xyz"][0] == pytest.approx((side, side, -0.01 * np.sqrt(2) * side), abs=CENTIMETRE)
    assert pyogrio.raw.read(folder / "shapefile" / "leaks.shp")[0]["crs"] is None


def test_the_geopackage_is_one_by_its_marks_and_brings_its_styles(hand_over):
    folder, _ = hand_over(FileKind.GEOPACKAGE)
    with sqlite3.connect(folder / "survey.gpkg") as database:
        assert database.execute("PRAGMA application_id").fetchone() == (0x47504B47,)
        assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        assert database.execute("PRAGMA foreign_key_check").fetchall() == []
        styles = dict(database.execute("SELECT f_table_name, styleQML FROM layer_styles WHERE useAsDefault"))
        boxes = database.execute("SELECT min_x, min_y, max_x, max_y FROM gpkg_contents WHERE table_name = 'leaks'")
        box = boxes.fetchone()
    database.close()
    assert set(styles) == {"leaks", "stretches", "reference_points"}
    points = np.array(coordinates(folder / "survey.gpkg", "leaks"))[:, 0, :2]
    assert box == pytest.approx((*points.min(axis=0), *points.max(axis=0)))


def test_a_system_that_is_not_meant_for_the_place_is_told(hand_over):
    _, written = hand_over(FileKind.GEOPACKAGE, crs="EPSG:27700")
    assert [finding.code for finding in written.findings] == ["handover_elsewhere"]


def test_half_letters_of_an_old_file_name_cost_no_file(hand_over, decisions):
    told = {**decisions, 1: replace(decisions[1], note="photo \udcff.jpg " + "x" * 246 + "  y")}
    _, written = hand_over(decided=told)
    assert [finding.code for finding in written.findings] == ["handover_text_cut"]
