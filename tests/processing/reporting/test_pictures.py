"""Logos and photos of others: made small and safe, and never a reason for a report to fail."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from processing.reporting.pictures import SVG_AT_MOST, logo_into, photo_into

SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 20 8"><rect width="20" height="8" fill="#0b3d5c"/></svg>'


def test_a_photo_becomes_small_and_loses_its_metadata(tmp_path):
    exif = Image.Exif()
    exif[0x010E] = "where I live"
    noise = np.random.default_rng(1).integers(0, 255, (1500, 2000, 3), dtype=np.uint8)
    Image.fromarray(noise).save(tmp_path / "phone.jpg", exif=exif)
    assert photo_into(tmp_path / "phone.jpg", tmp_path / "small.jpg")
    with Image.open(tmp_path / "small.jpg") as small:
        assert max(small.size) == 840
        assert not small.getexif()


@pytest.mark.parametrize("data", [b"", b"no picture", b"\xff\xd8\xff\xe0 torn", b"\x89PNG\r\n\x1a\n torn"])
def test_what_is_no_picture_is_left_out(tmp_path, data):
    for name in ("x.jpg", "x.png", "x.svg"):
        (tmp_path / name).write_bytes(data)
        assert logo_into(tmp_path / name, tmp_path) is None
    assert not photo_into(tmp_path / "x.jpg", tmp_path / "out.jpg")
    assert logo_into(tmp_path / "nowhere.svg", tmp_path) is None
    assert logo_into(tmp_path / "nowhere.png", tmp_path) is None


def test_a_logo_keeps_what_is_see_through(tmp_path):
    Image.new("RGBA", (3000, 600), (200, 0, 0, 0)).save(tmp_path / "brand.png")
    name = logo_into(tmp_path / "brand.png", tmp_path)
    with Image.open(tmp_path / name) as logo:
        assert (logo.mode, max(logo.size), logo.getpixel((5, 5))[3]) == ("RGBA", 900, 0)


def test_a_drawing_is_taken_as_it_is(tmp_path):
    source = tmp_path / "brand.svg"
    source.write_text(SVG, encoding="utf-8")
    target = tmp_path / "report"
    target.mkdir()
    assert logo_into(source, target) == "logo.svg"
    assert (target / "logo.svg").read_text(encoding="utf-8") == SVG


@pytest.mark.parametrize(
    "drawing",
    [
        SVG[:60],
        '<!DOCTYPE svg [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;">]>' + SVG,
        f"<svg>{'x' * SVG_AT_MOST}</svg>",
    ],
    ids=["torn", "entities", "huge"],
)
def test_a_drawing_that_cannot_be_drawn_is_left_out(tmp_path, drawing):
    source = Path(tmp_path / "brand.svg")
    source.write_text(drawing, encoding="utf-8")
    assert logo_into(source, tmp_path) is None
