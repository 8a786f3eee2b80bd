"""The report as a reader meets it: text taken out of the finished PDF, its pages, its fonts, its tags."""

import re
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

import pypdf
import pyproj
import pytest
from PIL import Image

from processing.progress import silent
from processing.quantities import Places, Units
from processing.reporting.content import make_content
from processing.reporting.options import Company, ReportOptions
from processing.reporting.pdf import write_pdf
from processing.reporting.plan_figure import overview
from processing.reporting.references import references
from processing.reporting.sheets import page_data
from processing.reporting.words import Words
from processing.review_facts import DigFinding, DigHistory, DigResult, LoggedDecision, Opinion, Photo, ReviewRecord
from processing.survey import Decision, Finding, Launch, LeakClass, Severity, Verdict

CONFIRMED = Decision(Verdict.CONFIRMED, LeakClass.LEAK)
DECIDED = {1: CONFIRMED, 2: CONFIRMED, 3: Decision(Verdict.REJECTED)}
METRES_PER_FOOT = 1200 / 3937


class Report:
    """A finished report: its reader, the text of each page, and that of the dig sheets (found by the bookmarks)."""

    def __init__(self, path):
        self.reader = pypdf.PdfReader(path)
        titles = [entry if isinstance(entry, list) else entry.title for entry in self.reader.outline]
        under = {before: entry for before, entry in pairwise(titles) if isinstance(before, str)}
        found = next((under[title] for title in ("Dig sheets", "Kazı föyleri") if title in under), [])
        self.sheet_numbers = [self.reader.get_destination_page_number(entry) for entry in found]

    @cached_property
    def pages(self):
        return [self.page(number) for number in range(len(self.reader.pages))]

    @cached_property
    def sheets(self):
        return [self.page(number) for number in self.sheet_numbers]

    def sheet(self, words):
        return next(text for text in self.sheets if words in text)

    def page(self, number):
        return " ".join(self.reader.pages[number].extract_text().split())


def written(path, results, decisions, record=None, options=None):
    write_pdf(path, make_content(results, decisions, record, options), silent())
    return Report(path)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("report")


@pytest.fixture(scope="module")
def record(place):
    Image.new("RGB", (400, 300), (120, 130, 90)).save(place / "wet.jpg")
    photo = Photo(1, 1, "leak-1-wet.jpg", "cd" * 32, 1000, "Wet kerb", "2026-05-04T09:00:00+00:00", "Ayşe")
    said = LoggedDecision("2026-05-04T10:11:12+00:00", "Ayşe", "decide", 1, Decision(), CONFIRMED)
    return ReviewRecord(
        log=(said,),
        photos=((photo, str(place / "wet.jpg")),),
        digs={2: DigResult(2, DigFinding.LEAK, "2026-05-09", 0.4, depth_m=1.35, cause="corroded joint", dug_by="Can")},
        opinions=(Opinion(1, "Mehmet", Decision(Verdict.REJECTED, None, "pump?")),),
        history=DigHistory("rolling/ductile_iron/300/tied", 12, 11, 0.6, 1.4, 1, dug=13),
    )


@pytest.fixture(scope="module")
def report(results, record, place):
    extra = (("PO", "47-B"),)
    company = Company("Su İşleri A.Ş.", "Işık Sok. 7", "+90 212 0", "TR-17", footer="Confidential", extra=extra)
    return written(place / "report.pdf", results, DECIDED, record, ReportOptions(company=company))


def test_the_cover_says_who_what_and_the_result_in_one_glance(report):
    cover = report.pages[0]
    for words in ("Su İşleri A.Ş.", "Işık Sok. 7", "TR-17", "PO 47-B", "Confidential", "Decided by Ayşe, Mehmet"):
        assert words in cover, words
    assert "2 confirmed" in cover
    assert "90 m assessed of 100 m" in cover  # 100 m of path, of which the fixture leaves 50 to 60 m out
    assert "10 m not assessed of 100 m" in cover


def test_the_accuracy_statement_tells_its_basis_and_what_digs_showed(report):
    page = report.pages[1]
    for words in ("in 19 of 20 cases", "within 0.20 m (root mean square)", "off there by 0.70 m", "to ±2 ms"):
        assert words in page, words
    assert "Of 12 measured digs" in page
    assert "11 lay within the stated interval" in page


def test_each_leak_has_exactly_one_sheet_of_one_page(report):
    pages = report.sheets
    assert [("Leak 1" in page, "Leak 2" in page) for page in pages] == [(True, False), (False, True)]
    assert ["Locate ticket no." in page for page in report.pages].count(True) == 2


def test_a_sheet_tells_where_to_tape_and_what_the_second_reviewer_says(report):
    page = report.sheet("Leak 1")
    assert "42.0 m" in page
    assert "95 % window: 41.0 – 43.0 m" in page
    # valve 12 at 30 m ± 0.5 m (1 sigma), the leak's own interval ± 1 m: the root of the squares of 1.0 and 0.98
    assert "valve 12 12.0 m ± 1.4 m onward" in page
    assert "NE (45°)" in page
    assert "PINPOINT FIRST" in page
    assert "The second reviewer, Mehmet, disagrees." in page
    assert "Mehmet DIFFERS: rejected (pump?)" in page
    assert "Rule. Green, dig here" in page
    assert "Wet kerb" in page


def test_a_sheet_of_a_leak_that_was_dug_says_so_in_its_boxes(report):
    page = report.sheet("Leak 2")
    found = ("0.40 m onward", "1.35 m", "corroded joint", "9 May 2026", "Can")
    for words in ("DO NOT DIG", "Dug on 9 May 2026: a leak was found.", *found):
        assert words in page, words


def test_the_appendix_tells_who_decided_and_how_to_make_the_run_again(report, results):
    page = report.pages[-1]
    for words in ("4 May 2026 10:11 Ayşe 1 decided to decide → confirmed", "leak-1-wet.jpg", "cd" * 32, "ab" * 32):
        assert words in page, words
    assert f'"run": "{results.run_hash}"' in page


@pytest.mark.parametrize(("off_m", "words"), [(0.9, "yes"), (-1.2, "NO")])
def test_the_appendix_says_whether_the_window_of_then_held_the_leak(results, off_m, words):
    stated = {"stated_chainage_m": 42.0, "stated_low95_m": 41.0, "stated_high95_m": 43.0}
    dug = DigResult(1, DigFinding.LEAK, "2026-05-09", off_m, **stated)
    data = page_data(make_content(results, DECIDED, ReviewRecord(digs={1: dug})))
    way = "onward" if off_m > 0 else "back to the launch"
    (row,) = data["appendix"]["digs"]
    assert row == ["1", "9 May 2026", "leak", f"{abs(off_m):.2f} m {way}", "41.0 – 43.0 m", words, ""]


def test_nothing_stands_across_the_pages_of_a_finished_report(report):
    assert not any("DRAFT" in text for text in report.pages)


def test_a_draft_says_so_across_each_page(results, tmp_path):
    report = written(tmp_path / "r.pdf", results, {1: CONFIRMED, 2: Decision(Verdict.UNSURE), 3: CONFIRMED})
    assert all(text.endswith("DRAFT") for text in report.pages)
    assert "DRAFT: places undecided or unsure: 1" in report.pages[0]


def test_simulated_data_are_said_across_each_page_even_when_all_is_decided(results):
    info = replace(results.survey.info, simulated=True)
    simulated = replace(results, survey=replace(results.survey, info=info))
    data = page_data(make_content(simulated, DECIDED))
    assert data["watermark"] == "SIMULATED"
    assert [page["light"]["word"] for page in data["sheets"]] == ["DO NOT DIG", "DO NOT DIG"]


def test_turkish_reads_exactly_with_its_decimal_comma(results, record, tmp_path):
    note = "ığüşiöç İĞÜŞIÖÇ; su sesi"
    decisions = {**DECIDED, 1: replace(CONFIRMED, note=note)}
    report = written(tmp_path / "r.pdf", results, decisions, record, ReportOptions("tr"))
    text = report.page(1) + report.page(-1) + report.page(report.sheet_numbers[0])
    page = report.sheet("Kaçak 1")
    assert note in page
    for words in ("42,0 m", "%95 aralığı: 41,0 – 43,0 m", "ÖNCE NOKTASAL TESPİT", "12,0 m ± 1,4 m ileri", "KD (45°)"):
        assert words in page, words
    assert "04.05.2026 10:11" in text
    assert "WGS 84: 40.9" in text  # degrees are typed into phones: always with a point


def test_feet_and_stations_stand_everywhere(results, tmp_path):
    options = ReportOptions(units=Units.US, places=Places.STATIONING)
    report = written(tmp_path / "r.pdf", results, DECIDED, None, options)
    page = report.sheet("Leak 1")
    feet = 42.0 / METRES_PER_FOOT
    assert f"1+{feet - 100:04.1f}" in page
    assert f"valve 12 {12.0 / METRES_PER_FOOT:.1f} ft" in page
    assert "300 mm" not in page
    assert "11.8 in" in page


def test_coordinates_stand_in_the_chosen_system_too(results, tmp_path):
    survey = replace(results.survey, launch=Launch(latitude=40.70, longitude=-73.95, elevation_m=31.0))
    there = replace(results, survey=survey)
    for crs, unit in (("EPSG:2263", "US ft"), ("", "m")):
        report = written(tmp_path / "r.pdf", there, DECIDED, None, ReportOptions(crs=crs))
        code = crs or "EPSG:32618"  # nobody chose: the UTM zone of New York
        degrees = re.search(r"WGS 84: ([\d.]+), (-[\d.]+)", report.sheet("Leak 1")).groups()
        to_grid = pyproj.Transformer.from_crs("EPSG:4326", code, always_xy=True)
        x, y = to_grid.transform(float(degrees[1]), float(degrees[0]))
        told = re.search(rf"{code}: east ([\d.]+) {unit}, north ([\d.]+) {unit}", report.sheet("Leak 1")).groups()
        assert [float(value) for value in told] == pytest.approx([x, y], abs=0.4)  # the degrees have six digits


def test_the_file_is_tagged_archivable_and_carries_its_fonts_in_parts(report):
    root = report.reader.trailer["/Root"]
    assert root["/MarkInfo"]["/Marked"]
    assert root["/Lang"].startswith("en")
    assert root["/ViewerPreferences"]["/DisplayDocTitle"]
    assert report.reader.metadata.title == "Çınar Sokağı"
    xmp = root["/Metadata"].get_data().decode("utf-8")
    assert "<pdfuaid:part>1</pdfuaid:part>" in xmp
    assert "<pdfaid:part>2</pdfaid:part>" in xmp
    assert "<pdfaid:conformance>A</pdfaid:conformance>" in xmp
    fonts = {
        font["/BaseFont"]: font
        for page in report.reader.pages
        for font in (entry.get_object() for entry in page["/Resources"]["/Font"].values())
    }
    assert fonts
    for font in fonts.values():
        inner = font["/DescendantFonts"][0].get_object() if "/DescendantFonts" in font else font
        descriptor = inner["/FontDescriptor"].get_object()
        assert {"/FontFile2", "/FontFile3"} & set(descriptor), font["/BaseFont"]
        assert font["/BaseFont"][7] == "+", font["/BaseFont"]  # ABCDEF+Name: a subset


def test_tables_over_several_pages_are_tagged_too(results, record, tmp_path):
    many = tuple(replace(results.candidates[0], id=i, score=1.0 - i / 300.0) for i in range(1, 100))
    stretches = tuple(replace(results.not_assessed[0], start_s=float(i)) for i in range(55))
    long = replace(results, candidates=many, not_assessed=stretches)
    rejected = {i: Decision(Verdict.REJECTED) for i in range(2, 100)}
    said = replace(record, log=record.log * 120)
    report = written(tmp_path / "r.pdf", long, {1: Decision(Verdict.UNSURE), **rejected}, said)
    assert len(report.reader.pages) > 8
    assert b"<pdfuaid:part>1" in report.reader.trailer["/Root"]["/Metadata"].get_data()


def test_every_picture_has_words_for_who_cannot_see_it(report):
    figures = list(_figures(report.reader.trailer["/Root"]["/StructTreeRoot"]))
    assert len(figures) > 8
    assert all(figure.get("/Alt") for figure in figures)


def _figures(element):
    element = element.get_object() if hasattr(element, "get_object") else element
    if isinstance(element, list):
        for kid in element:
            yield from _figures(kid)
    elif isinstance(element, dict):
        if element.get("/S") == "/Figure":
            yield element
        if "/K" in element:
            yield from _figures(element["/K"])


def test_bookmarks_and_the_table_lead_to_the_sheets(report):
    def titles(outline):
        for entry in outline:
            if isinstance(entry, list):
                yield from titles(entry)
            else:
                yield entry.title, report.reader.get_destination_page_number(entry)

    found = dict(titles(report.reader.outline))
    pages = report.pages
    assert "Leak 1" in pages[found["Leak 1"]]
    assert "Locate ticket no." in pages[found["Leak 1"]]
    links = [a.get_object() for page in report.reader.pages for a in page.get("/Annots", [])]
    assert any(link.get("/A", {}).get("/URI", "").startswith("geo:40.9") for link in links)


def test_very_long_texts_neither_add_a_page_to_a_sheet_nor_get_lost(results, record, tmp_path):
    name = "Büyükşehir İçme Suyu İsale Hattı Rehabilitasyonu 3. Etap Kuzey Kolu " * 5
    note = "\n".join(f"line {i}: wet asphalt, water heard in the cellar next door" for i in range(40))
    ties = tuple(replace(tie, name=name + tie.name) for tie in results.survey.tie_points)
    info = replace(results.survey.info, name=name, operator=name, client=name)
    pipe = replace(results.survey.pipe, material=name)
    survey = replace(results.survey, info=info, pipe=pipe, tie_points=ties)
    numbered = tuple(replace(c, number=12340 + c.id) for c in results.candidates)
    long = replace(results, survey=survey, candidates=numbered)
    opinions = tuple(replace(o, number=12341, reviewer=name) for o in record.opinions)
    photos = tuple((replace(photo, number=12341, caption=note), path) for photo, path in record.photos)
    record = replace(record, opinions=opinions, photos=photos, digs={})
    company = Company(name, f"{name}\n{name}", name, name, footer=name, extra=((name, name),) * 12)
    decisions = {1: replace(CONFIRMED, note=note), 2: replace(CONFIRMED, note=note)}
    report = written(tmp_path / "r.pdf", long, decisions, record, ReportOptions(company=company))
    pages = report.sheets
    assert len(pages) == 3
    numbers = report.sheet_numbers
    assert numbers == list(range(numbers[0], numbers[0] + 3))  # one page each
    assert "Locate ticket no." not in report.pages[numbers[-1] + 1]
    assert all("Cause: joint" in page and "Name" in page for page in pages)
    assert "line 39: wet asphalt" in " ".join(report.pages[numbers[-1] + 1 :])
    assert "hydrant" in pages[0]  # long names keep their ends, where they differ


def test_without_a_path_a_sheet_forbids_to_dig_and_nothing_is_invented(results, tmp_path):
    nan = float("nan")
    lost = {"chainage_m": nan, "chainage_low95_m": nan, "chainage_high95_m": nan, "width_m": nan}
    candidates = tuple(replace(c, position_w_m=(nan,) * 3, **lost) for c in results.candidates)
    bare = replace(results, track=None, level_along=None, candidates=candidates)
    report = written(tmp_path / "r.pdf", bare, DECIDED)
    assert len(report.sheets) == 2
    for page in report.sheets:
        assert "DO NOT DIG" in page
        assert "No QR code" in page
        assert "nan" not in page.lower()


def test_letters_that_no_font_here_has_do_not_stop_the_report(results, tmp_path):
    decisions = {**DECIDED, 1: replace(CONFIRMED, note="漏水 💧 \x07 ok")}
    report = written(tmp_path / "r.pdf", results, decisions)
    assert any("ok" in page for page in report.sheets)


def test_a_broken_logo_or_photo_is_told_and_left_out(results, record, tmp_path):
    (tmp_path / "logo.png").write_bytes(b"\x89PNG\r\n\x1a\n torn")
    (tmp_path / "wet.jpg").write_bytes(b"torn")
    record = replace(record, photos=tuple((photo, str(tmp_path / "wet.jpg")) for photo, _ in record.photos))
    options = ReportOptions(company=Company(logo=str(tmp_path / "logo.png")))
    report = written(tmp_path / "r.pdf", results, DECIDED, record, options)
    assert "The logo logo.png could not be used" in report.page(-1)


@pytest.mark.parametrize(("score", "words"), [(0.0004, "< 1 %"), (0.999, "> 99 %"), (0.5, "50 %")])
def test_a_probability_is_never_told_as_certain(results, score, words):
    one = replace(results, candidates=(replace(results.candidates[0], score=score),))
    (row,) = page_data(make_content(one, {}))["leaks"]
    assert row["score"] == words


def test_the_map_has_a_north_only_where_one_is_known(results):
    words = Words(ReportOptions())
    turned = replace(results, findings=(Finding("heading_unknown", Severity.WARNING),))
    for told, has_north in ((results, True), (turned, False)):
        svg = overview(make_content(told, {}), references(told), words, (500.0, 300.0))
        assert (">N</text>" in svg) is has_north


def test_two_hundred_places_keep_to_forty_sheets_and_say_how_many_are_left(results):
    many = tuple(
        replace(results.candidates[0], id=i, chainage_m=0.5 * i, score=1.0 - i / 300.0, time_s=float(i))
        for i in range(1, 200)
    )
    data = page_data(make_content(replace(results, candidates=many), {}))
    assert len(data["sheets"]) == 40
    assert data["more"].startswith("159 further undecided places")


def test_no_words_of_a_dig_sheet_are_smaller_than_a_wet_page_allows(report):
    small = []

    def note(text, matrix, place, _font, size):
        scales = [abs(m[0] * m[3] - m[1] * m[2]) for m in (matrix, place)]
        points = size * (scales[0] * scales[1]) ** 0.5
        if text.strip() and points < 7.45:
            small.append((round(points, 1), text))

    for number in report.sheet_numbers:
        report.reader.pages[number].extract_text(visitor_text=note)
    assert not small
