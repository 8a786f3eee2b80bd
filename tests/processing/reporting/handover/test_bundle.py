"""The zip of everything, the README in it, and formats that fail."""

import zipfile
from dataclasses import replace

import pytest

from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.progress import Progress
from processing.reporting.content import make_content
from processing.reporting.handover import drawing, geopackage
from processing.reporting.handover.bundle import bundle_name
from processing.reporting.options import FileKind
from processing.review_facts import Photo, ReviewRecord
from processing.survey import Launch, SurveyInfo


def test_the_zip_holds_every_file_that_was_written_under_a_relative_name(hand_over, tmp_path):
    (tmp_path / "out").mkdir()
    contract = tmp_path / "out" / "report.pdf"
    contract.write_bytes(b"%PDF")
    folder, written = hand_over(contract=(contract,))
    packed = written.files[-1]
    assert packed.name == "Çınar-Sokağı-2026-05-04-run-01234567.zip"
    with zipfile.ZipFile(packed) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        assert names == sorted(names)
        assert not [name for name in names if name.startswith(("/", "\\")) or ".." in name.split("/") or "\\" in name]
        assert set(names) == {f.relative_to(folder).as_posix() for f in (contract, *written.files[:-1])}
        for name in names:
            assert archive.read(name) == (folder / name).read_bytes()
    assert {"report.pdf", "README.txt", "survey.gpkg", "shapefile/leaks.dbf", "raven/audio.selections.txt"} <= set(
        names
    )
    assert not list(folder.rglob("*.part"))


def test_without_the_zip_the_files_are_there_all_the_same(hand_over):
    folder, written = hand_over(FileKind.KML, as_zip=False)
    assert sorted(path.name for path in written.files) == ["README.txt", "survey.kml"]
    assert not list(folder.glob("*.zip"))


@pytest.mark.parametrize("name", ["../../etc", "a/b\\c:d", "", "CON", "x" * 300, "İş\x00\n"])
def test_no_name_of_a_survey_leads_out_of_the_folder(hand_over, surveyed, name):
    info = SurveyInfo(name, date="../4")
    changed = replace(surveyed, survey=replace(surveyed.survey, info=info), run_hash="../..")
    folder, written = hand_over(FileKind.GPX, changed=changed)
    packed = written.files[-1]
    assert packed.parent == folder
    assert packed.suffix == ".zip"
    assert len(packed.name) < 140


def test_the_readme_speaks_both_languages_and_explains_every_column(hand_over):
    folder, written = hand_over(language="tr", crs="EPSG:5254")
    data = (folder / "README.txt").read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")
    text = data.decode("utf-8-sig")
    assert text.index("Koordinat sistemi") < text.index("Coordinate system")
    for words in (
        "EPSG:5254 TUREF / TM30", "chainage_low95_m", "50.0 – 60.0 m: kırpılmış ses", "50.0 – 60.0 m: clipped sound",
        "survey.gpkg", "decisions.csv", "TASLAK", "0123456789ab", "metres (m)",
    ):  # fmt: skip
        assert words in text, words
    assert max(len(line) for line in text.splitlines()) <= 120
    assert not written.findings


def test_the_readme_says_what_was_left_out_and_why(hand_over, surveyed):
    silent = replace(surveyed, recording=replace(surveyed.recording, audio=None))
    folder, _ = hand_over(FileKind.RAVEN, FileKind.KML, changed=silent)
    text = (folder / "README.txt").read_text(encoding="utf-8-sig")
    assert "the survey has no sound" in text
    assert "raven/" not in text.split("What ± means")[0]


def test_a_format_that_fails_costs_no_other_and_is_told(hand_over, monkeypatch, caplog):
    def full_of_holes(*_words, **_more):
        raise RuntimeError("broken")

    monkeypatch.setattr(drawing, "write_drawing", full_of_holes)
    folder, written = hand_over()
    (finding,) = written.findings
    assert (finding.code, finding.params["file"]) == ("handover_format_failed", "survey.dxf")
    assert "RuntimeError: broken" in str(finding.params["reason"])
    assert "survey.dxf was not written" in caplog.text
    with zipfile.ZipFile(written.files[-1]) as archive:
        assert {"survey.gpkg", "survey.kml", "README.txt"} <= set(archive.namelist())
    assert "survey.dxf could not be written" in (folder / "README.txt").read_text(encoding="utf-8-sig").replace(
        "\r", ""
    )


def test_a_full_disc_ends_it_at_once(hand_over, monkeypatch):
    def full(*_words, **_more):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(geopackage, "write_geopackage", full)
    with pytest.raises(OSError, match="No space"):
        hand_over()


def test_cancelling_leaves_no_half_file(hand_over, tmp_path):
    calls = iter(range(1000))
    with pytest.raises(Cancelled):
        hand_over(progress=Progress(None, lambda: next(calls) > 8))
    folder = tmp_path / "out"
    assert not list(folder.rglob("*.part"))
    assert not list(folder.rglob("*.zip"))


def test_photos_come_along_under_the_numbers_of_their_leaks(results, decisions, tmp_path):
    from processing.progress import silent
    from processing.reporting.handover.writing import write_handover
    from processing.reporting.options import HandoverOptions

    (tmp_path / "one.JPG").write_bytes(b"first")
    (tmp_path / "two.exe").write_bytes(b"second")
    photos = (
        (Photo(1, 2, "one.JPG", "", 5), str(tmp_path / "one.JPG")),
        (Photo(2, 2, "../two.exe", "", 6), str(tmp_path / "two.exe")),
        (Photo(3, 1, "gone.png", "", 6), str(tmp_path / "gone.png")),
    )
    content = make_content(results, decisions, ReviewRecord(photos=photos))
    folder = tmp_path / "out"
    folder.mkdir()
    written = write_handover(content, HandoverOptions(frozenset({FileKind.EXCEL_CSV})), folder, (), silent())
    assert [finding.code for finding in written.findings] == ["handover_photo_missing"]
    assert (folder / "photos" / "leak-2-1.jpg").read_bytes() == b"first"
    with zipfile.ZipFile(written.files[-1]) as archive:
        assert archive.read("photos/leak-2-2.jpg") == b"second"
    assert "photos/leak-2-1.jpg; photos/leak-2-2.jpg" in (folder / "leaks-excel.csv").read_text(encoding="utf-8-sig")


def test_a_code_that_does_not_exist_is_refused(hand_over):
    with pytest.raises(LeaklineError) as told:
        hand_over(FileKind.GEOPACKAGE, crs="EPSG:999999")
    assert told.value.code is ErrorCode.CRS_UNKNOWN


def test_the_name_of_the_zip_carries_survey_run_and_date(results, decisions):
    assert bundle_name(make_content(results, decisions)) == "Çınar-Sokağı-2026-05-04-run-01234567.zip"


@pytest.mark.parametrize(
    ("launch", "told"),
    [
        (Launch(latitude=40.9, longitude=29.1), "they are metres east and north of the launch"),
        (Launch(east_m=500_000.0, north_m=4_528_000.0, crs="EPSG:5254"), "are metres in EPSG:5254"),
    ],
)
def test_the_readme_says_in_which_system_the_contracts_tables_are(hand_over, surveyed, launch, told):
    changed = replace(surveyed, survey=replace(surveyed.survey, launch=launch))
    folder, _ = hand_over(FileKind.KML, changed=changed, crs="EPSG:32635")
    assert told in " ".join((folder / "README.txt").read_text(encoding="utf-8-sig").split())
