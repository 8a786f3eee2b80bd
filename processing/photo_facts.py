"""What a picture file is, where and when it was taken by its own word (EXIF), and a small upright copy of it.

Pictures are untrusted: the kind is told by the first bytes, never by the name; only two of Pillow's readers are ever
used; size and pixels are checked before anything is decoded.
"""

import io
import math
import re
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.storage.files import reading

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageFile import ImageFile

MOST_BYTES = 40_000_000
MOST_PIXELS = {"jpg": 120_000_000, "png": 50_000_000}  # a JPEG is decoded small at once, a PNG has to be held whole
SMALL_PX = 1600
_QUALITY = 85
_JPEG, _PNG = b"\xff\xd8\xff", b"\x89PNG\r\n\x1a\n"
_HEIC_BRANDS = frozenset({b"heic", b"heix", b"heim", b"heis", b"hevc", b"hevx", b"mif1", b"msf1"})

# tags of EXIF 2.32
_EXIF_IFD, _GPS_IFD = 0x8769, 0x8825
_ORIENTATION, _DATE_TIME, _DATE_TIME_ORIGINAL, _OFFSET_ORIGINAL = 0x0112, 0x0132, 0x9003, 0x9011
_LATITUDE_REF, _LATITUDE, _LONGITUDE_REF, _LONGITUDE, _ERROR_M = 1, 2, 3, 4, 31
_MOMENT = re.compile(r"(\d{4}):(\d\d):(\d\d) (\d\d:\d\d:\d\d)", re.ASCII)
_SIDEWAYS = (5, 6, 7, 8)  # orientations that swap width and height


@dataclass(frozen=True)
class PhotoFacts:
    """A picture's kind (``jpg`` or ``png``), its upright size in pixels, and what its EXIF tells, if anything.

    ``taken`` is ISO 8601, local time of the camera, with its offset where the camera knew it; empty where unknown.
    ``latitude`` and ``longitude`` are WGS 84 degrees, None where there is no place; ``gps_error_m`` is the camera's own
    word on how well it knew it (1 sigma or so: makers differ), mostly None.
    """

    kind: str
    width: int
    height: int
    taken: str = ""
    latitude: float | None = None
    longitude: float | None = None
    gps_error_m: float | None = None


def photo_kind(path: Path) -> str:
    """Return ``jpg`` or ``png`` by the file's first bytes.

    Raises:
        LeaklineError: FILE_MISSING, FILE_UNREADABLE, FILE_TOO_LARGE (over 40 MB), PHOTO_HEIC, PHOTO_UNKNOWN.
    """
    with reading(path):
        size = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(12)
    if size > MOST_BYTES:
        params = {"size_mb": size / 1e6, "limit_mb": MOST_BYTES / 1e6}
        raise LeaklineError(ErrorCode.FILE_TOO_LARGE, Place(path), **params)
    if head.startswith(_JPEG):
        return "jpg"
    if head.startswith(_PNG):
        return "png"
    if head[4:8] == b"ftyp" and head[8:12] in _HEIC_BRANDS:
        raise LeaklineError(ErrorCode.PHOTO_HEIC, Place(path))
    raise LeaklineError(ErrorCode.PHOTO_UNKNOWN, Place(path))


def photo_facts(path: Path) -> PhotoFacts:
    """Return what a picture is, without decoding it.

    Raises:
        LeaklineError: as :func:`photo_kind`; PHOTO_DAMAGED, PHOTO_TOO_MANY_PIXELS.
    """
    kind = photo_kind(path)
    try:
        with _opened(path, kind) as image:
            exif = image.getexif()
            width, height = image.size
            if exif.get(_ORIENTATION) in _SIDEWAYS:
                width, height = height, width
            latitude, longitude, error_m = _gps(dict(exif.get_ifd(_GPS_IFD)))
            taken = _taken(exif.get(_DATE_TIME), dict(exif.get_ifd(_EXIF_IFD)))
            return PhotoFacts(kind, width, height, taken, latitude, longitude, error_m)
    except LeaklineError:
        raise
    except Exception as error:
        # a hostile file makes Pillow raise almost anything: SyntaxError, struct.error, IndexError …
        raise LeaklineError(ErrorCode.PHOTO_DAMAGED, Place(path)) from error


def small_photo(path: Path, max_px: int = SMALL_PX) -> bytes:
    """Return an upright JPEG of the picture, at most ``max_px`` wide and high, without a word of EXIF.

    Takes 10–500 ms by size and kind: never on the window's thread.

    Raises:
        LeaklineError: as :func:`photo_facts`.
    """
    from PIL import ImageOps

    kind = photo_kind(path)
    try:
        with _opened(path, kind) as image:
            image.thumbnail((max_px, max_px))  # a JPEG is decoded at an eighth, a quarter or a half where that does
            upright = ImageOps.exif_transpose(image)
            out = io.BytesIO()
            _on_white(upright).save(out, "JPEG", quality=_QUALITY)
            return out.getvalue()
    except LeaklineError:
        raise
    except Exception as error:
        raise LeaklineError(ErrorCode.PHOTO_DAMAGED, Place(path)) from error


def _opened(path: Path, kind: str) -> "ImageFile":
    """Return the picture opened, not decoded, its pixels counted; no reader but the one for ``kind`` sees the bytes."""
    if kind == "jpg":
        from PIL.JpegImagePlugin import JpegImageFile as Reader
    else:
        from PIL.PngImagePlugin import PngImageFile as Reader  # type: ignore[assignment]
    image = Reader(path)
    width, height = image.size
    if width * height > MOST_PIXELS[kind]:
        image.close()
        params = {"megapixels": width * height / 1e6, "limit": MOST_PIXELS[kind] / 1e6}
        raise LeaklineError(ErrorCode.PHOTO_TOO_MANY_PIXELS, Place(path), **params)
    return image


def _on_white(image: "Image") -> "Image":
    """Return the picture in red, green and blue; what is transparent becomes white paper."""
    from PIL import Image as Images

    if image.mode.startswith("I"):  # 16 bits of grey
        image = image.point(lambda level: level / 256).convert("L")
    if image.mode in ("RGBA", "LA", "PA") or "transparency" in image.info:
        layer = image.convert("RGBA")
        paper = Images.new("RGBA", layer.size, "white")
        paper.alpha_composite(layer)
        image = paper
    plain = image.convert("RGB")
    plain.info = {}  # comments and the like would be written into the copy
    return plain


def _gps(tags: dict[int, Any]) -> tuple[float | None, float | None, float | None]:
    latitude = _degrees(tags.get(_LATITUDE), tags.get(_LATITUDE_REF), "S", 90.0)
    longitude = _degrees(tags.get(_LONGITUDE), tags.get(_LONGITUDE_REF), "W", 180.0)
    if (
        latitude is None or longitude is None or (latitude == 0.0 and longitude == 0.0)
    ):  # some write zeros for "unknown"
        return None, None, None
    error_m = _figure(tags.get(_ERROR_M))
    return latitude, longitude, error_m if error_m is not None and error_m > 0.0 else None


def _degrees(parts: object, reference: object, negative: str, most: float) -> float | None:
    """Return decimal degrees of EXIF's degrees, minutes, seconds; None unless all of it makes sense."""
    if not isinstance(parts, tuple) or len(parts) != 3 or not isinstance(reference, str):
        return None
    figures = [_figure(part) for part in parts]
    if any(figure is None or figure < 0.0 for figure in figures):
        return None
    degrees, minutes, seconds = (figure or 0.0 for figure in figures)
    value = degrees + minutes / 60.0 + seconds / 3600.0
    if value > most:
        return None
    return -value if reference.strip("\x00 ").upper() == negative else value


def _figure(value: object) -> float | None:
    """Return a finite number, None for anything else: EXIF's fractions may have a zero below the line."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, ZeroDivisionError):
        return None
    return number if math.isfinite(number) else None


def _taken(date_time: object, tags: dict[int, Any]) -> str:
    offset = tags.get(_OFFSET_ORIGINAL)
    for text in (tags.get(_DATE_TIME_ORIGINAL), date_time):
        match = _MOMENT.fullmatch(text.strip("\x00 ")) if isinstance(text, str) else None
        if match is None:
            continue
        local = "{}-{}-{}T{}".format(*match.groups())
        for told in (f"{local}{offset}", local):
            try:
                return datetime.fromisoformat(told).isoformat()
            except ValueError:
                continue
    return ""
