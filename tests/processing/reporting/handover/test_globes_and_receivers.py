"""KML and GPX: well-formed, in the order of their schemas, in WGS 84, with Turkish letters."""

from dataclasses import replace
from xml.etree import ElementTree as ET

import pytest
from handover_reading import expected_place, features
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from processing.progress import silent
from processing.reporting.content import make_content
from processing.reporting.handover.writing import write_handover
from processing.reporting.options import FileKind, HandoverOptions, ReportOptions
from processing.survey import Decision, Launch, SurveyInfo, TiePoint, Verdict

KML = {"k": "http://www.opengis.net/kml/2.2"}
GPX = {"g": "http://www.topografix.com/GPX/1/1"}
# gpx.xsd, wptType
WAYPOINT_ORDER = ["ele", "time", "magvar", "geoidheight", "name", "cmt", "desc", "src", "link", "sym", "type"]
CENTIMETRE = 0.01 / 84_000.0  # degrees of longitude at 41°


def waypoints(folder):
    root = ET.parse(folder / "survey.gpx").getroot()
    return {w.findtext("g:name", namespaces=GPX): w for w in root.findall("g:wpt", GPX)}


def test_the_receiver_gets_leaks_and_references_and_no_place_that_is_no_leak(hand_over):
    folder, written = hand_over(FileKind.GPX)
    assert not written.findings
    found = waypoints(folder)
    assert set(found) == {"Leak 2", "Place 17", "launch", "valve 12", "hydrant"}  # 2 was dug up, 1 is a valve
    leak = found["Leak 2"]
    place = float(leak.get("lon")), float(leak.get("lat"))
    assert place == pytest.approx(expected_place(70.0, "EPSG:4326"), abs=CENTIMETRE)
    assert leak.findtext("g:sym", namespaces=GPX) == "Flag, Red"


def test_elements_stand_in_the_order_of_the_schema_and_there_are_no_made_up_times(hand_over):
    folder, _ = hand_over(FileKind.GPX)
    root = ET.parse(folder / "survey.gpx").getroot()
    assert [child.tag.split("}")[1] for child in root] == ["metadata", *["wpt"] * 5, "trk"]
    for waypoint in root.findall("g:wpt", GPX):
        order = [WAYPOINT_ORDER.index(child.tag.split("}")[1]) for child in waypoint]
        assert order == sorted(order)
    assert not list(root.iter("{http://www.topografix.com/GPX/1/1}time"))


def test_gdal_reads_the_whole_path_from_the_gpx(hand_over):
    folder, _ = hand_over(FileKind.GPX)
    _, (track,) = features(folder / "survey.gpx", "tracks")
    assert track["xyz"][0][:2] == pytest.approx(expected_place(0.0, "EPSG:4326"), abs=CENTIMETRE)
    assert track["xyz"][-1][:2] == pytest.approx(expected_place(100.0, "EPSG:4326"), abs=CENTIMETRE)
    assert len(track["xyz"]) == len(set(track["xyz"]))


def test_without_a_known_elevation_no_height_is_told(hand_over, surveyed):
    launch = Launch(latitude=40.9012, longitude=29.1)
    folder, _ = hand_over(
        FileKind.GPX, FileKind.KML, changed=replace(surveyed, survey=replace(surveyed.survey, launch=launch))
    )
    assert "<ele>" not in (folder / "survey.gpx").read_text(encoding="utf-8")
    point = ET.parse(folder / "survey.kml").getroot().find(".//k:Point/k:coordinates", KML)
    assert len(point.text.split(",")) == 2


def test_gdal_reads_the_kml_with_all_attributes(hand_over, surveyed, decisions):
    folder, _ = hand_over(FileKind.KML)
    meta, table = features(folder / "survey.kml", "Leaks and places to look at")
    assert meta["crs"] == "EPSG:4326"
    assert len(table) == len(surveyed.candidates)
    by_id = {row["leak_id"]: row for row in table}
    for row in table:
        assert row["xyz"][0][:2] == pytest.approx(expected_place(row["chainage_m"], "EPSG:4326"), abs=CENTIMETRE)
    assert by_id[1]["note"] == decisions[1].note
    assert by_id[1]["Name"] == "Place 1"
    _, stretches = features(folder / "survey.kml", "Pipe by status")
    assert [row["status"] for row in stretches].count("not_assessed") == 1


def test_pins_are_coloured_hidden_and_dated_by_the_day(hand_over):
    folder, _ = hand_over(FileKind.KML, language="tr")
    root = ET.parse(folder / "survey.kml").getroot()
    styles = {style.get("id") for style in root.iter("{http://www.opengis.net/kml/2.2}Style")}
    marks = {m.findtext("k:name", namespaces=KML): m for m in root.findall(".//k:Placemark", KML)}
    for mark in marks.values():
        assert mark.findtext("k:styleUrl", namespaces=KML)[1:] in styles
    assert marks["Yer 1"].findtext("k:visibility", namespaces=KML) == "0"
    assert marks["Kaçak 2"].findtext("k:visibility", namespaces=KML) == "1"
    assert marks["Kaçak 2"].findtext("k:TimeStamp/k:when", namespaces=KML) == "2026-05-04"
    balloon = marks["Yer 1"].findtext("k:description", namespaces=KML)
    assert '<b>ıslak zemin; "İŞĞÜÖÇ", =2+2</b>' in balloon
    assert "<b>42,00</b>" in balloon


def test_the_kmls_elements_stand_in_the_order_of_its_schema(hand_over):
    # ogckml22.xsd, the type of a feature
    order = ["name", "visibility", "description", "TimeStamp", "styleUrl", "ExtendedData", "Point", "LineString"]
    folder, _ = hand_over(FileKind.KML)
    root = ET.parse(folder / "survey.kml").getroot()
    for mark in root.findall(".//k:Placemark", KML):
        places = [order.index(child.tag.split("}")[1]) for child in mark]
        assert places == sorted(places)


def test_a_simulated_survey_says_so_on_every_pin(hand_over, surveyed):
    info = replace(surveyed.survey.info, simulated=True)
    changed = replace(surveyed, survey=replace(surveyed.survey, info=info))
    folder, _ = hand_over(FileKind.GPX, FileKind.KML, changed=changed)
    assert "SIMULATED Leak 2" in waypoints(folder)
    assert "do not dig" in (folder / "survey.kml").read_text(encoding="utf-8")


ODD = st.text(st.characters(), max_size=40)


@settings(max_examples=8, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(name=ODD, tie=ODD, note=ODD, pipe=ODD)
def test_odd_characters_in_names_break_no_file(results, tmp_path_factory, name, tie, note, pipe):
    survey = replace(results.survey, info=SurveyInfo(name, date="2026-05-04"), tie_points=(TiePoint(tie, 60.0, 30.0),))
    content = make_content(
        replace(results, survey=survey), {1: Decision(Verdict.CONFIRMED, None, note)}, None, ReportOptions()
    )
    folder = tmp_path_factory.mktemp("odd")
    kinds = frozenset(FileKind) - {FileKind.DXF}
    written = write_handover(content, HandoverOptions(kinds, pipe_id=pipe), folder, (), silent())
    assert not [finding for finding in written.findings if finding.code == "handover_format_failed"]
    names = set(waypoints(folder))
    assert len(names) >= 3
    assert len(features(folder / "survey.kml", "Leaks and places to look at")[1]) == 3
    _, table = features(folder / "survey.gpkg", "leaks")
    assert len(table) == 3
    for path in written.files:
        assert path.resolve().is_relative_to(folder.resolve())
