"""The code on a dig sheet holds the place: read back by a decoder of our own and from the printed page."""

import re
import subprocess
from dataclasses import replace
from shutil import which

import numpy as np
import pypdf
import pytest
import qr_reading
from PIL import Image

from processing.progress import silent
from processing.reporting.content import make_content
from processing.reporting.pdf import write_pdf
from processing.reporting.qr import geo_link, qr_svg
from processing.reporting.sheets import page_data
from processing.survey import Decision, Launch, Verdict

PLACES = [(40.901467, 29.100352), (-33.856784, 151.215297), (0.0, -0.000001), (64.146582, -21.942637)]


def modules(svg):
    """Return the code in an SVG of ours as rows of booleans, without its margin."""
    size = int(re.search(r'viewBox="0 0 (\d+) \d+"', svg).group(1))
    rows = np.zeros((size, size), dtype=bool)
    for x, y, width in re.findall(r"M(\d+) (\d+)h(\d+)v1h-\d+z", svg):
        rows[int(y), int(x) : int(x) + int(width)] = True
    assert not rows[:4].any()
    assert not rows[:, -4:].any()
    return rows[4:-4, 4:-4].tolist()


@pytest.mark.parametrize("place", PLACES)
def test_the_code_says_the_geo_link_of_the_place(place):
    link = geo_link(*place)
    assert qr_reading.read(modules(qr_svg(link))) == link
    scheme, degrees = link.split(":")
    assert scheme == "geo"
    assert [float(part) for part in degrees.split(",")] == pytest.approx(list(place), abs=5e-7)


def test_the_code_on_the_printed_page_is_that_of_the_leak(results, tmp_path):
    if which("pdftoppm") is None:
        pytest.skip("poppler-utils are not installed")
    alone = replace(results, candidates=results.candidates[:1])
    content = make_content(alone, {1: Decision(Verdict.CONFIRMED)})
    write_pdf(tmp_path / "report.pdf", content, silent())
    reader = pypdf.PdfReader(tmp_path / "report.pdf")
    (leak,) = next(entry for entry in reader.outline if isinstance(entry, list))  # below the bookmark of the sheets
    sheet = str(reader.get_destination_page_number(leak) + 1)
    # the right half of the sheet's upper half, 150 dots an inch
    part = ["-r", "150", "-f", sheet, "-l", sheet, "-x", "750", "-y", "350", "-W", "490", "-H", "700", "-gray", "-png"]
    subprocess.run(["pdftoppm", *part, tmp_path / "report.pdf", tmp_path / "page"], check=True, timeout=60)
    found = [_code_on(page) for page in tmp_path.glob("page*.png")]
    row = content.rows[0]
    assert [qr_reading.read(rows) for rows in found] == [geo_link(row.latitude, row.longitude)]


def _code_on(page):
    """Return the modules of the code on a page's picture: found by the 1:1:3:1:1 of its finders, as a phone does."""
    dark = np.asarray(Image.open(page).convert("L")) < 128
    hits = []
    for y in range(dark.shape[0]):
        edges = np.flatnonzero(np.diff(dark[y].astype(np.int8)))
        runs = np.diff(edges)
        for i in range(len(runs) - 4):
            unit = runs[i : i + 5].sum() / 7.0
            if 2.5 < unit < 12 and dark[y, edges[i] + 1]:
                fits = np.abs(runs[i : i + 5] / unit - [1, 1, 3, 1, 1]) < 0.4
                if fits.all():
                    hits.append((y, edges[i] + 1, edges[i + 5] + 1, unit))
    # a finder shows the same on all lines of its middle, letters do so on one or two
    hits = [hit for hit in hits if sum(abs(hit[1] - other[1]) <= 1 for other in hits) >= 2 * hit[3]]
    if not hits:
        return None
    top = min(y for y, *_ in hits)
    unit = float(np.median([unit for *_, unit in hits]))
    first = [hit for hit in hits if hit[0] < top + 4 * unit]
    left, right = min(hit[1] for hit in first), max(hit[2] for hit in first)
    count = 4 * round(((right - left) / unit - 17) / 4) + 17
    step = (right - left) / count
    upper = top - 2 * step  # the runs begin two modules below the finder's upper edge
    places = [int(left + (i + 0.5) * step) for i in range(count)]
    return [[bool(dark[int(upper + (j + 0.5) * step), x]) for x in places] for j in range(count)]


def test_a_place_only_known_from_the_launch_has_no_code(results, tmp_path):
    local = replace(results, survey=replace(results.survey, launch=Launch()))
    assert [page["geo"] for page in page_data(make_content(local, {}))["sheets"]] == ["", "", ""]
