"""The report's pages as pictures, to be looked at before anything is written."""

import struct
from dataclasses import replace
from io import BytesIO

import pypdf

from processing.progress import silent
from processing.reporting.content import make_content
from processing.reporting.pdf import page_pictures, write_pdf


def test_there_is_a_picture_of_each_page_of_the_report(results, decisions, tmp_path):
    content = make_content(replace(results, candidates=results.candidates[:1]), decisions)
    pictures = page_pictures(content, 36.0, silent())
    write_pdf(tmp_path / "report.pdf", content, silent())
    pages = pypdf.PdfReader(BytesIO((tmp_path / "report.pdf").read_bytes())).pages
    assert len(pictures) == len(pages)
    for picture, page in zip(pictures, pages, strict=True):
        assert picture.startswith(b"\x89PNG")
        wide, high = struct.unpack(">II", picture[16:24])
        assert abs(wide - float(page.mediabox.width) / 2) <= 1  # 36 pixels an inch are half a pixel a point
        assert abs(high - float(page.mediabox.height) / 2) <= 1
