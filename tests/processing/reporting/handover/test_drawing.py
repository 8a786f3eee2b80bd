"""The drawing as ezdxf and GDAL read it."""

from dataclasses import replace

import ezdxf
import pyogrio.raw
import pytest
from handover_reading import expected_place

from processing.quantities import METRES_PER_US_FOOT, Units
from processing.reporting.options import ColumnScheme, FileKind
from processing.survey import Launch

NEW_YORK = (-73.99, 40.75)


def drawing(folder):
    read = ezdxf.readfile(folder / "survey.dxf")
    audit = read.audit()
    assert not audit.errors
    assert not audit.fixes
    return read


def leaks(read):
    inserts = [e for e in read.modelspace().query("INSERT") if e.dxf.name == "LEAKLINE_LEAK"]
    return {int(e.get_attrib_text("ID")): e for e in inserts}


def test_leaks_are_blocks_in_their_place_with_all_attributes(hand_over, decisions):
    folder, _ = hand_over(FileKind.DXF, crs="EPSG:5254")
    read = drawing(folder)
    found = leaks(read)
    assert sorted(found) == [1, 2, 3, 17]
    for number, chainage in ((1, 42.0), (2, 70.0), (3, 10.0), (17, 25.0)):
        insert = found[number]
        expected = expected_place(chainage, "EPSG:5254")
        assert (insert.dxf.insert.x, insert.dxf.insert.y) == pytest.approx(expected, abs=0.01)
        assert float(insert.get_attrib_text("CHAINAGE_M")) == chainage
    assert found[1].get_attrib_text("NOTE") == decisions[1].note
    assert found[17].get_attrib_text("SCORE") == ""
    assert [a.dxf.tag for a in found[2].attribs if not a.is_invisible] == ["ID", "CHAINAGE_M"]
    assert found[1].dxf.layer == "LEAKLINE_NO_LEAKS"
    assert read.layers.get("LEAKLINE_NO_LEAKS").is_off()
    assert found[2].dxf.layer == "LEAKLINE_LEAKS"
    assert all({a.dxf.layer for a in insert.attribs} == {insert.dxf.layer} for insert in found.values())


def test_under_the_names_of_asset_systems_number_and_distance_are_shown_too(hand_over):
    folder, _ = hand_over(FileKind.DXF, columns=ColumnScheme.ASSET)
    inserts = [e for e in drawing(folder).modelspace().query("INSERT") if e.dxf.name == "LEAKLINE_LEAK"]
    for insert in inserts:
        assert [a.dxf.tag for a in insert.attribs if not a.is_invisible] == ["LEAK_ID", "LEAK_DISTANCE"]


def test_the_pipe_is_drawn_by_status_from_end_to_end(hand_over):
    folder, _ = hand_over(FileKind.DXF, crs="EPSG:5254")
    lines = drawing(folder).modelspace().query("LWPOLYLINE")
    layers = [line.dxf.layer for line in lines]
    assert layers.count("LEAKLINE_STRETCH_NOT_ASSESSED") == 1
    assert layers.count("LEAKLINE_STRETCH_LEAK") == 1
    ends = [tuple(line[0][:2]) for line in lines] + [tuple(line[-1][:2]) for line in lines]
    assert min(ends) == pytest.approx(expected_place(0.0, "EPSG:5254"), abs=0.01)
    assert max(ends) == pytest.approx(expected_place(100.0, "EPSG:5254"), abs=0.01)


def test_the_unit_of_the_drawing_is_that_of_the_system(hand_over, surveyed):
    launch = Launch(latitude=NEW_YORK[1], longitude=NEW_YORK[0], elevation_m=0.0)
    changed = replace(surveyed, survey=replace(surveyed.survey, launch=launch))
    folder, _ = hand_over(FileKind.DXF, changed=changed, crs="EPSG:2263")
    read = drawing(folder)
    assert read.header["$INSUNITS"] == 21  # US survey feet
    insert = leaks(read)[2].dxf.insert
    assert (insert.x, insert.y) == pytest.approx(expected_place(70.0, "EPSG:2263", NEW_YORK), abs=0.03)
    text = read.modelspace().query("TEXT").first
    assert text.dxf.height == pytest.approx(1.25 / METRES_PER_US_FOOT)


def test_beside_degrees_the_drawing_is_in_metres_and_that_is_told(hand_over):
    folder, written = hand_over(FileKind.DXF, crs="EPSG:4326")
    assert [finding.code for finding in written.findings] == ["handover_drawing_crs"]
    read = drawing(folder)
    assert read.header["$INSUNITS"] == 6
    insert = leaks(read)[2].dxf.insert
    assert (insert.x, insert.y) == pytest.approx(expected_place(70.0, "EPSG:32635"), abs=0.01)
    assert "UTM_Zone_35N" in (folder / "survey.prj").read_text()


def test_a_local_drawing_can_be_in_feet(hand_over, surveyed):
    changed = replace(surveyed, survey=replace(surveyed.survey, launch=Launch()))
    folder, _ = hand_over(FileKind.DXF, changed=changed, units=Units.US)
    insert = leaks(drawing(folder))[2].dxf.insert
    assert insert.x == pytest.approx(70.0 / 2**0.5 / METRES_PER_US_FOOT, abs=0.01)


def test_gdal_reads_the_drawings_texts_in_turkish(hand_over):
    folder, _ = hand_over(FileKind.DXF, language="tr", crs="EPSG:5254")
    meta, _, _, columns = pyogrio.raw.read(folder / "survey.dxf")
    texts = {text for text in columns[list(meta["fields"]).index("Text")] if text}
    assert any("Çınar Sokağı" in text for text in texts)
    assert any("50,00 ± 0,98 m" in text for text in texts)
