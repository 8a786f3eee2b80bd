"""Map files that GDAL wrote come in to the millimetre; files from elsewhere say what is wrong with them."""

import struct
import zipfile

import numpy as np
import pytest
from route_files import GRID, in_degrees, main_pipe, write

from processing.errors import ErrorCode, LeaklineError
from processing.importing.route_files import archive, lines
from processing.importing.route_files.curves import circular_string
from processing.importing.route_files.lines import CrsSource
from processing.importing.route_files.registry import ROUTE_FORMATS, looks_like_route, read_route_file
from processing.importing.route_files.wkb import WkbError, lines_of_wkb

PIPE = main_pipe()
PARTS = [PIPE[:20], PIPE[19:]]
DEGREES = [in_degrees(part) for part in PARTS]


def text_file(path, text, encoding="utf-8"):
    path.write_bytes(text.encode(encoding))
    return path


def code_of(path):
    with pytest.raises(LeaklineError) as caught:
        read_route_file(path)
    return caught.value.code


@pytest.mark.parametrize(
    ("name", "driver", "crs"),
    [
        ("main.gpkg", "GPKG", GRID),
        ("main.shp", "ESRI Shapefile", GRID),
        ("main.geojson", "GeoJSON", GRID),
        ("main.geojson", "GeoJSON", "EPSG:4326"),
        ("main.gpkg", "GPKG", "EPSG:4326"),
        ("main.shp", "ESRI Shapefile", "EPSG:2263"),
        ("main.shp", "ESRI Shapefile", "EPSG:4258"),
    ],
)
def test_what_gdal_writes_is_read_to_the_last_digit(tmp_path, name, driver, crs):
    written = DEGREES if crs in ("EPSG:4326", "EPSG:4258") else PARTS
    file = read_route_file(write(tmp_path / name, driver, written, crs, ["ana hat", "ek"]))
    assert [line.name for line in file.lines] == ["ana hat", "ek"]
    assert file.crs == crs
    for line, points in zip(file.lines, written, strict=True):
        assert line.has_z
        np.testing.assert_allclose(line.points, points, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("driver", ["KML", "LIBKML"])
def test_kml_of_gdal_is_read_to_a_tenth_of_a_millimetre(tmp_path, driver):
    file = read_route_file(write(tmp_path / "main.kml", driver, DEGREES, "EPSG:4326", ["ana hat", "ek"]))
    assert (file.crs, file.crs_source) == ("EPSG:4326", CrsSource.FORMAT)
    assert [line.name for line in file.lines] == ["ana hat", "ek"]
    for line, points in zip(file.lines, DEGREES, strict=True):
        np.testing.assert_allclose(line.points[:, :2], points[:, :2], rtol=0.0, atol=1e-9)


def test_a_drawing_of_gdal_is_read_and_its_coordinate_system_asked(tmp_path):
    file = read_route_file(write(tmp_path / "main.dxf", "DXF", PARTS, None))
    assert (file.crs, file.crs_source) == (None, CrsSource.ASK)
    for line, points in zip(file.lines, PARTS, strict=True):
        np.testing.assert_allclose(line.points, points, rtol=0.0, atol=1e-6)


def test_a_shapefile_in_a_zip_is_read_with_its_system_and_names(tmp_path):
    write(tmp_path / "main.shp", "ESRI Shapefile", PARTS, GRID, ["ana hat", "ek"])
    with zipfile.ZipFile(tmp_path / "main.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        for part in tmp_path.glob("main.*"):
            if part.suffix != ".zip":
                packed.write(part, f"Hat/{part.name}")
    file = read_route_file(tmp_path / "main.zip")
    assert (file.crs, [line.name for line in file.lines]) == (GRID, ["ana hat", "ek"])


def test_any_part_of_a_shapefile_leads_to_it(tmp_path):
    write(tmp_path / "main.shp", "ESRI Shapefile", PARTS, GRID)
    assert len(read_route_file(tmp_path / "main.dbf").lines) == 2


def test_layers_of_a_geopackage_in_two_systems_come_in_one(tmp_path):
    path = write(tmp_path / "main.gpkg", "GPKG", [PARTS[0]], GRID, layer="a")
    write(path, "GPKG", [DEGREES[1]], "EPSG:4326", layer="b", append=True)
    file = read_route_file(path)
    assert [line.layer for line in file.lines] == ["a", "b"]
    np.testing.assert_allclose(file.lines[1].points, PARTS[1], rtol=0.0, atol=1e-3)


def test_a_geopackage_with_a_view_in_place_of_a_layer_is_not_run(tmp_path):
    import sqlite3

    path = write(tmp_path / "main.gpkg", "GPKG", PARTS, GRID)
    with sqlite3.connect(path) as connection:
        connection.execute("ALTER TABLE main RENAME TO hidden")
        connection.execute("UPDATE gpkg_geometry_columns SET table_name = 'main'")
        connection.execute("CREATE VIEW main AS SELECT * FROM hidden")
    connection.close()
    assert code_of(path) is ErrorCode.ROUTE_DAMAGED


def test_a_bulge_becomes_an_arc_within_two_millimetres(tmp_path):
    import ezdxf

    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 6
    # a half circle of radius 10 m about (10, 0), then straight on
    drawing.modelspace().add_lwpolyline([(0, 0, 1.0), (20, 0, 0), (40, 0, 0)], format="xyb")
    drawing.modelspace().add_polyline3d([(0, 0, 1), (3, 4, 2)])
    drawing.modelspace().add_line((0, 0), (7, 0))
    drawing.saveas(tmp_path / "bend.dxf")
    bend, other, line = read_route_file(tmp_path / "bend.dxf").lines
    away = np.hypot(bend.points[:, 0] - 10.0, bend.points[:, 1])
    middles = 0.5 * (bend.points[1:] + bend.points[:-1])[bend.points[1:, 0] <= 20.0 + 1e-9]
    assert np.abs(away[bend.points[:, 0] <= 20.0] - 10.0).max() < 1e-6
    assert np.abs(np.hypot(middles[:, 0] - 10.0, middles[:, 1]) - 10.0).max() < 0.0021
    length = np.hypot(*np.diff(bend.points[:, :2], axis=0).T).sum()
    assert length == pytest.approx(10.0 * np.pi + 20.0, abs=0.02)
    np.testing.assert_allclose(other.points, [[0, 0, 1], [3, 4, 2]])
    assert len(line.points) == 2


@pytest.mark.parametrize(("unit", "metres", "told"), [(4, 0.001, 0), (6, 1.0, 0), (2, 0.3048, 0)])
def test_the_unit_of_a_drawing_is_believed(tmp_path, unit, metres, told):
    import ezdxf

    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = unit
    drawing.modelspace().add_line((0, 0), (400.0 / metres, 0))
    drawing.saveas(tmp_path / "main.dxf")
    file = read_route_file(tmp_path / "main.dxf")
    assert (file.unit_m, len(file.findings)) == (metres, told)


def test_a_drawing_of_millimetres_that_would_be_tiny_is_taken_for_metres(tmp_path):
    import ezdxf

    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = 4
    drawing.modelspace().add_line((0, 0), (400.0, 0))
    drawing.saveas(tmp_path / "main.dxf")
    file = read_route_file(tmp_path / "main.dxf")
    assert (file.unit_m, file.findings[0].code) == (1.0, "route_unit_doubtful")


def test_geojson_of_too_large_numbers_is_asked_about(tmp_path):
    text = '{"type": "LineString", "coordinates": [[424000, 4528000], [424100, 4528000]]}'
    file = read_route_file(text_file(tmp_path / "a.geojson", text))
    assert (file.crs, file.findings[0].code) == (None, "route_not_degrees")


def test_kml_heights_count_only_where_they_are_absolute(tmp_path):
    text = """<kml xmlns="http://www.opengis.net/kml/2.2"><Document><name>Su</name><Placemark><name>p</name>
      <MultiGeometry><LineString><coordinates>29,40,7 29.1,40,8</coordinates></LineString><LineString>
      <altitudeMode>absolute</altitudeMode><coordinates>29,40,7 29.1,40,8</coordinates></LineString></MultiGeometry>
      </Placemark></Document></kml>"""
    flat, high = read_route_file(text_file(tmp_path / "a.kml", text)).lines
    assert (flat.has_z, high.has_z, flat.layer, high.points[1, 2]) == (False, True, "Su", 8.0)


def test_gpx_tracks_and_routes_are_read(tmp_path):
    text = """<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><rte><name>r</name><rtept lat="40" lon="29"/>
      <rtept lat="41" lon="29"/></rte><trk><name>t</name><trkseg><trkpt lat="40" lon="29"><ele>5</ele></trkpt>
      <trkpt lat="40.1" lon="29"><ele>6</ele></trkpt></trkseg></trk></gpx>"""
    track, route = read_route_file(text_file(tmp_path / "a.gpx", text)).lines
    np.testing.assert_allclose(track.points, [[29, 40, 5], [29, 40.1, 6]])
    np.testing.assert_allclose(route.points[:, :2], [[29, 40], [29, 41]])


@pytest.mark.parametrize(
    ("text", "crs"),
    [
        ("East (m),North (m),Up\n1.5,2.5,3\n4,5,6\n", None),
        ("north_m;east_m;up_m\n2,5;1,5;3\n5;4;6,0\n", None),
        ("X\tY\tZ\n1.5\t2.5\t3\n4\t5\t6\n", None),
        ("DOĞU;KUZEY;KOT\n1,5;2,5;3,0\n4,0;5,0;6,0\n", None),
        ("latitude,longitude,elevation\n2.5,1.5,3\n5,4,6\n", "EPSG:4326"),
        ("chainage_m,east,north,up\n9,4,5,6\n0,1.5,2.5,3\n", None),
        ("1.5 2.5 3\n4 5 6\n", None),
        ('name,geom\nhat,"LINESTRING Z (1.5 2.5 3, 4 5 6)"\n', None),
        ("SRID=5254;LINESTRING Z (1.5 2.5 3, 4 5 6)\n", GRID),
    ],
)
def test_tables_are_read_as_they_are_written(tmp_path, text, crs):
    file = read_route_file(text_file(tmp_path / "main.csv", text))
    assert file.crs == crs
    np.testing.assert_allclose(file.lines[0].points, [[1.5, 2.5, 3.0], [4.0, 5.0, 6.0]])


def test_another_name_or_an_empty_row_begins_another_line(tmp_path):
    text = "line,e,n\na,0,0\na,1,0\nb,5,5\nb,6,6\n\nb,9,9\nb,8,8\n"
    assert [line.name for line in read_route_file(text_file(tmp_path / "l.csv", text)).lines] == ["a", "b", "b"]


def test_a_table_names_the_line_of_what_is_no_number(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        read_route_file(text_file(tmp_path / "main.csv", "e,n\n1,2\n3,4\n5,six\n7,8\n9,9\n"))
    assert caught.value.code is ErrorCode.VALUE_NOT_A_NUMBER
    assert (caught.value.place.line, caught.value.place.column) == (4, 2)


def test_a_table_without_a_north_says_so(tmp_path):
    assert code_of(text_file(tmp_path / "main.csv", "time,east\n1,2\n3,4\n")) is ErrorCode.COLUMN_MISSING


def test_three_points_of_a_circle_become_its_arc():
    arc = circular_string(np.array([[15.0, 7.0], [5.0, 17.0], [-5.0, 7.0]]))
    np.testing.assert_allclose(np.hypot(*(arc - [5.0, 7.0]).T), 10.0)
    assert np.hypot(*np.diff(arc, axis=0).T).sum() == pytest.approx(10.0 * np.pi, rel=1e-3)
    turn = circular_string(np.array([[0.0, 0.0], [5.0, -5.0], [10.0, 0.0]]))
    assert turn[:, 1].min() == pytest.approx(-5.0, abs=0.003)
    assert (turn[:, 1] <= 1e-9).all()


def test_a_geometry_that_claims_more_than_it_holds_is_refused_before_memory_is_taken():
    for claimed in (struct.pack("<BII", 1, 2, 2**31), struct.pack("<BII", 1, 5, 2**31) * 2):
        with pytest.raises(WkbError):
            list(lines_of_wkb(claimed + b"\0" * 32))


def test_a_zip_bomb_is_not_unpacked(tmp_path):
    path = tmp_path / "bomb.kmz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("doc.kml", b"<kml>" + b" " * 30_000_000 + b"</kml>")
    assert path.stat().st_size < 100_000
    assert code_of(path) is ErrorCode.FILE_TOO_LARGE
    with pytest.raises(LeaklineError):
        archive.read_member(path, archive.members_of(path)[0], 1000)


def test_entities_are_refused(tmp_path):
    laughs = '<!DOCTYPE k [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;">]><kml><Placemark><name>&b;</name></Placemark></kml>'
    assert code_of(text_file(tmp_path / "a.kml", laughs)) is ErrorCode.ROUTE_DAMAGED
    outside = '<!DOCTYPE k [<!ENTITY a SYSTEM "file:///etc/passwd">]><kml>&a;</kml>'
    assert code_of(text_file(tmp_path / "b.kml", outside, "utf-16")) is ErrorCode.ROUTE_DAMAGED


@pytest.mark.parametrize(
    "text", ["[" * 100_000, '{"type": "FeatureCollection", "features": 7}', "{", '{"a": 1' + "0" * 5000]
)
def test_broken_geojson_is_an_error_of_the_file(tmp_path, text):
    assert code_of(text_file(tmp_path / "a.geojson", text)) is ErrorCode.ROUTE_DAMAGED


def test_too_many_points_are_refused_while_reading(tmp_path, monkeypatch):
    monkeypatch.setattr(lines, "MAX_POINTS", 30)
    assert code_of(write(tmp_path / "main.gpkg", "GPKG", PARTS, GRID)) is ErrorCode.ROUTE_TOO_MANY


def test_what_is_no_map_is_named(tmp_path):
    assert code_of(text_file(tmp_path / "photo.jpg", "\x01\x02 abc")) is ErrorCode.ROUTE_FORMAT_UNKNOWN
    assert code_of(tmp_path / "none.kml") is ErrorCode.FILE_MISSING
    assert (
        code_of(text_file(tmp_path / "p.geojson", '{"type": "Point", "coordinates": [1, 2]}')) is ErrorCode.ROUTE_EMPTY
    )


def test_only_a_map_is_taken_for_one_by_its_name(tmp_path):
    assert {entry.name for entry in ROUTE_FORMATS if looks_like_route(tmp_path / f"a{entry.suffixes[0]}")} == {
        entry.name for entry in ROUTE_FORMATS if entry.name != "table"
    }


@pytest.mark.parametrize(
    "name", ["main.gpkg", "main.shp", "main.geojson", "main.kml", "main.dxf", "main.csv", "main.kmz"]
)
def test_a_damaged_file_is_read_or_refused_but_never_a_fault_of_ours(tmp_path, name):
    drivers = {".gpkg": "GPKG", ".shp": "ESRI Shapefile", ".geojson": "GeoJSON", ".kml": "KML", ".dxf": "DXF"}
    path = tmp_path / name
    if path.suffix == ".csv":
        text_file(path, "e;n;z\n" + "".join(f"{x:.2f};{y:.2f};{z:.2f}\n" for x, y, z in PIPE))
    elif path.suffix == ".kmz":
        inner = write(tmp_path / "doc.kml", "KML", DEGREES, "EPSG:4326")
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as packed:
            packed.write(inner, "doc.kml")
    else:
        crs = None if path.suffix == ".dxf" else "EPSG:4326" if path.suffix == ".kml" else GRID
        write(path, drivers[path.suffix], DEGREES if crs == "EPSG:4326" else PARTS, crs)
    whole = path.read_bytes()
    rng = np.random.default_rng(5)
    for turn in range(6 if path.suffix == ".dxf" else 30):
        data = bytearray(whole)
        if turn % 4 == 0:
            del data[rng.integers(1, len(data)) :]
        for at in rng.integers(0, len(data), rng.integers(1, 30)):
            data[at] = rng.integers(0, 256)
        path.write_bytes(data)
        try:
            file = read_route_file(path)
        except LeaklineError:
            continue
        assert all(np.isfinite(line.points).all() and len(line.points) > 1 for line in file.lines)
