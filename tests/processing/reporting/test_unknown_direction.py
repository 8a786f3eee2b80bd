"""Of a path that may be turned as a whole about its launch nothing is told that would lead a crew to a wrong place."""

import csv
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from processing.reporting.content import make_content
from processing.reporting.exports import write_exports
from processing.reporting.options import HandoverOptions, ReportOptions
from processing.reporting.sheets import page_data
from processing.survey import Finding, Launch, Severity

TURNED = (Finding("heading_unknown", Severity.WARNING),)


@pytest.fixture(params=[None, "EPSG:5254"])
def turned(request, results):
    survey = results.survey
    if request.param:
        launch = Launch(east_m=500_000.0, north_m=4_528_000.0, crs=request.param, elevation_m=31.0)
        survey = replace(survey, launch=launch)
    return replace(results, survey=survey, findings=TURNED)


@pytest.mark.parametrize(("language", "told"), [("en", "direction is not known"), ("tr", "yönü bilinmiyor")])
def test_a_dig_sheet_has_neither_coordinates_nor_a_code_and_says_why(turned, language, told):
    for page in page_data(make_content(turned, {}, options=ReportOptions(language)))["sheets"]:
        assert page["geo"] == ""
        assert told in page["no_geo"]
        assert len(page["coordinates"]) == 1
        assert told in page["coordinates"][0]
        assert page["place"]  # the pipe itself is as well known as ever
        assert page["tapes"]


def test_no_file_places_it_on_a_map_of_the_world(turned, tmp_path):
    written = write_exports(turned, {}, tmp_path, handover=HandoverOptions(as_zip=False))
    with (tmp_path / "leaks.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(row["latitude"], row["longitude"]) for row in rows} == {("", "")}
    assert max(abs(float(row["north_m"])) for row in rows) <= 100.0  # from the launch, not in the grid
    collection = json.loads((tmp_path / "leaks.geojson").read_text(encoding="utf-8"))
    assert "not WGS 84" in collection["frame"]
    assert "turned" in collection["frame"]
    names = {path.name for path in written.files}
    assert "survey.gpkg" in names
    assert not names & {"survey.kml", "survey.gpx", "survey.prj", "leaks.prj"}
    codes = {finding.code for finding in written.findings}
    assert {"handover_no_direction", "handover_turned"} <= codes
    assert not codes & {"handover_local", "handover_no_place"}  # typing the launch's coordinates would not help
    readme = (tmp_path / "README.txt").read_text(encoding="utf-8-sig")
    assert "Do not place them on a map" in readme
    assert not re.search(r"leaks\.geojson: .*WGS 84", readme)


def test_a_leak_without_a_place_on_the_map_does_not_blame_the_launch(results):
    nan = float("nan")
    lost = replace(results, candidates=(replace(results.candidates[0], position_w_m=(nan, nan, nan)),))
    (page,) = page_data(make_content(lost, {}))["sheets"]
    assert page["no_geo"] == "No QR code: the place on the map is not known."
    (nowhere,) = page_data(
        make_content(
            replace(results, survey=replace(results.survey, launch=Launch()), candidates=results.candidates[:1]), {}
        )
    )["sheets"]
    assert "the launch has no coordinates" in nowhere["no_geo"]


def test_coordinates_are_told_with_how_far_off_they_may_be(results):
    count = results.track.time_s.size
    known = replace(results, track=replace(results.track, cov_level_m2=np.tile([4.0, 0.0, 9.0], (count, 1))))
    thin = tuple(replace(c, chainage_low95_m=c.chainage_m, chainage_high95_m=c.chainage_m) for c in known.candidates)
    for page in page_data(make_content(replace(known, candidates=thin), {}))["sheets"]:
        assert "± 7.3 m (95 %)" in page["coordinates"][-1]  # 2.4477 times 3 m, by chi-squared of two
