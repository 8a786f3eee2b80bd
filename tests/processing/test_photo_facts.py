"""A picture tells its place and time truly, is turned upright, and a hostile file is refused, not decoded."""

import io
import struct
import zlib

import pytest
from PIL import Image

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.photo_facts import PhotoFacts, photo_facts, small_photo

RED, BLUE = (220, 20, 30), (20, 40, 220)


def picture(width=60, height=40):
    """Red on the left, blue on the right."""
    image = Image.new("RGB", (width, height), RED)
    image.paste(BLUE, (width // 2, 0, width, height))
    return image


def with_place(place, exif_time=None, offset=None):
    exif = Image.Exif()
    if place is not None:
        exif.get_ifd(0x8825).update(place)
    if exif_time is not None:
        exif.get_ifd(0x8769)[0x9003] = exif_time
    if offset is not None:
        exif.get_ifd(0x8769)[0x9011] = offset
    return exif


def refused(path, call=photo_facts):
    with pytest.raises(LeaklineError) as caught:
        call(path)
    for language in messages.LANGUAGES:
        assert messages.error_sentence(caught.value, language)
    return caught.value.code


def near(colour, wanted):
    return all(abs(a - b) < 40 for a, b in zip(colour, wanted, strict=True))


def test_place_and_time_are_what_the_camera_wrote(tmp_path):
    # 40° 59' 27.24" N is 40.9909°, 29° 1' 48" E is 29.03°, by hand
    place = {1: "N", 2: (40.0, 59.0, 27.24), 3: "E", 4: (29.0, 1.0, 48.0), 31: 4.5}
    picture().save(tmp_path / "a.jpg", exif=with_place(place, "2026:05:04 10:11:12", "+03:00"))
    facts = photo_facts(tmp_path / "a.jpg")
    assert (facts.kind, facts.width, facts.height) == ("jpg", 60, 40)
    assert facts.taken == "2026-05-04T10:11:12+03:00"
    assert facts.latitude == pytest.approx(40.9909, abs=1e-7)
    assert facts.longitude == pytest.approx(29.03, abs=1e-7)
    assert facts.gps_error_m == pytest.approx(4.5)


def test_south_and_west_are_negative_and_a_time_without_zone_stays_without(tmp_path):
    place = {1: "S", 2: (33.0, 30.0, 0.0), 3: "W", 4: (70.0, 15.0, 0.0)}
    picture().save(tmp_path / "a.jpg", exif=with_place(place, "2026:05:04 10:11:12"))
    facts = photo_facts(tmp_path / "a.jpg")
    assert (facts.latitude, facts.longitude) == (pytest.approx(-33.5), pytest.approx(-70.25))
    assert facts.taken == "2026-05-04T10:11:12"
    assert facts.gps_error_m is None


@pytest.mark.parametrize(
    "place",
    [
        {},
        {1: "N", 2: (0.0, 0.0, 0.0), 3: "E", 4: (0.0, 0.0, 0.0)},  # some phones write zeros for "unknown"
        {1: "N", 2: (95.0, 0.0, 0.0), 3: "E", 4: (29.0, 0.0, 0.0)},
        {2: (40.0, 0.0, 0.0), 4: (29.0, 0.0, 0.0)},  # of which half of the world?
        {1: "N", 2: (40.0, 0.0, 0.0)},
    ],
)
def test_a_place_that_makes_no_sense_is_no_place(tmp_path, place):
    picture().save(tmp_path / "a.jpg", exif=with_place(place, "0000:00:00 00:00:00"))
    assert photo_facts(tmp_path / "a.jpg") == PhotoFacts("jpg", 60, 40)


def test_a_fraction_over_zero_is_no_place(tmp_path):
    exif = with_place({1: "N", 2: (40.0, 59.0, 27.0), 3: "E", 4: (29.0, 1.0, 48.0)}).tobytes()
    whole, zero = struct.pack(">II", 27, 1), struct.pack(">II", 27, 0)
    whole = whole if whole in exif else struct.pack("<II", 27, 1)
    zero = zero if whole.startswith(b"\0") else struct.pack("<II", 27, 0)
    assert exif.count(whole) == 1
    picture().save(tmp_path / "a.jpg", exif=exif.replace(whole, zero))
    assert photo_facts(tmp_path / "a.jpg").latitude is None


@pytest.mark.parametrize("orientation", range(1, 9))
def test_the_small_copy_stands_upright_and_tells_nothing_of_whoever_took_it(tmp_path, orientation):
    # what a camera stores for a picture whose upright form has red on the left: turned back by the tag
    turned = {
        1: None, 2: Image.Transpose.FLIP_LEFT_RIGHT, 3: Image.Transpose.ROTATE_180,
        4: Image.Transpose.FLIP_TOP_BOTTOM, 5: Image.Transpose.TRANSPOSE, 6: Image.Transpose.ROTATE_90,
        7: Image.Transpose.TRANSVERSE, 8: Image.Transpose.ROTATE_270,
    }[orientation]  # fmt: skip
    stored = picture() if turned is None else picture().transpose(turned)
    exif = with_place({1: "N", 2: (40.0, 59.0, 27.0), 3: "E", 4: (29.0, 1.0, 48.0)})
    exif[0x0112], exif[0x010F] = orientation, "A camera"
    stored.save(tmp_path / "a.jpg", exif=exif, comment=b"whose")
    facts = photo_facts(tmp_path / "a.jpg")
    assert (facts.width, facts.height) == (60, 40)
    small = small_photo(tmp_path / "a.jpg", 30)
    with Image.open(io.BytesIO(small)) as image:
        assert image.format == "JPEG"
        assert image.size == (30, 20)
        assert near(image.getpixel((5, 10)), RED)
        assert near(image.getpixel((25, 10)), BLUE)
        assert not image.getexif()
    assert b"A camera" not in small
    assert b"whose" not in small


def test_a_picture_that_is_small_already_keeps_its_size(tmp_path):
    picture().save(tmp_path / "a.png")
    with Image.open(io.BytesIO(small_photo(tmp_path / "a.png"))) as image:
        assert image.size == (60, 40)


def test_what_is_transparent_becomes_white(tmp_path):
    clear = Image.new("RGBA", (40, 40), (0, 0, 0, 0))
    clear.paste((*RED, 255), (0, 0, 20, 40))
    clear.save(tmp_path / "a.png")
    with Image.open(io.BytesIO(small_photo(tmp_path / "a.png"))) as image:
        assert near(image.getpixel((5, 20)), RED)
        assert near(image.getpixel((35, 20)), (255, 255, 255))


def test_sixteen_bits_of_grey_keep_their_middle(tmp_path):
    Image.new("I;16", (40, 40), 32768).save(tmp_path / "a.png")
    with Image.open(io.BytesIO(small_photo(tmp_path / "a.png"))) as image:
        assert near(image.getpixel((20, 20)), (128, 128, 128))


def test_the_name_does_not_decide_what_a_file_is(tmp_path):
    picture().save(tmp_path / "photo", "PNG")
    assert photo_facts(tmp_path / "photo").kind == "png"
    picture().save(tmp_path / "a.jpg", "BMP")
    assert refused(tmp_path / "a.jpg") is ErrorCode.PHOTO_UNKNOWN
    (tmp_path / "b.jpg").write_bytes(b"%!PS-Adobe-3.0\n%%BoundingBox: 0 0 10 10\n")
    assert refused(tmp_path / "b.jpg") is ErrorCode.PHOTO_UNKNOWN
    (tmp_path / "c.jpg").write_bytes(b"\x00\x00\x00\x18ftypheic\x00\x00\x00\x00mif1heic")
    assert refused(tmp_path / "c.jpg") is ErrorCode.PHOTO_HEIC
    (tmp_path / "empty.jpg").write_bytes(b"")
    assert refused(tmp_path / "empty.jpg") is ErrorCode.PHOTO_UNKNOWN
    assert refused(tmp_path / "gone.jpg") is ErrorCode.FILE_MISSING


def test_a_picture_over_forty_megabytes_is_refused_unread(tmp_path):
    picture().save(tmp_path / "a.jpg")
    with (tmp_path / "a.jpg").open("r+b") as file:
        file.truncate(40_000_001)
    assert refused(tmp_path / "a.jpg") is ErrorCode.FILE_TOO_LARGE


def test_a_bomb_of_pixels_is_refused_before_it_is_unpacked(tmp_path):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", 50_000, 50_000, 8, 2, 0, 0, 0)
    data = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(100_000))) + chunk(b"IEND", b"")
    (tmp_path / "a.png").write_bytes(b"\x89PNG\r\n\x1a\n" + data)
    assert refused(tmp_path / "a.png") is ErrorCode.PHOTO_TOO_MANY_PIXELS
    assert refused(tmp_path / "a.png", small_photo) is ErrorCode.PHOTO_TOO_MANY_PIXELS


@pytest.mark.parametrize("kind", ["jpg", "png"])
def test_a_file_cut_off_or_spoilt_anywhere_is_a_sentence_or_a_picture_never_a_crash(tmp_path, kind):
    picture(200, 150).save(tmp_path / f"a.{kind}", exif=with_place({1: "N", 2: (40.0, 59.0, 27.0)}))
    whole = (tmp_path / f"a.{kind}").read_bytes()
    spoilt = [whole[: len(whole) * part // 20] for part in range(1, 20)]
    spoilt += [whole[:at] + bytes([whole[at] ^ 0xFF]) + whole[at + 1 :] for at in range(12, len(whole), 23)]
    told = []
    for data in spoilt:
        (tmp_path / "b").write_bytes(data)
        for call in (photo_facts, small_photo):
            try:
                call(tmp_path / "b")
            except LeaklineError as error:
                told.append(error.code)
    assert set(told) <= {ErrorCode.PHOTO_DAMAGED, ErrorCode.PHOTO_TOO_MANY_PIXELS}
    assert len(told) > 19  # at least each one that was cut off
