"""Pictures of others for a report, made small and safe: the company's logo and the photos of a leak.

Whatever is wrong with a picture, the report is written without it, and the report says so.
"""

from pathlib import Path

from processing.errors import LeaklineError
from processing.photo_facts import photo_kind, small_photo

SVG_AT_MOST = 2_000_000  # bytes
_LOGO_PX, _PHOTO_PX = 900, 840  # a photo is 58 mm wide on paper


def photo_into(source: Path, target: Path) -> bool:
    """Write a photo as a small JPEG, the right way up and without its metadata; False where it cannot be read."""
    try:
        target.write_bytes(small_photo(source, _PHOTO_PX))
    except LeaklineError:
        return False
    return True


def logo_into(source: Path, folder: Path) -> str | None:
    """Put a PNG, JPEG or SVG into ``folder`` and return its name there; None where it is no logo.

    A PNG keeps what is see-through in it, so a logo lies on the page without a box of its own.
    """
    if source.suffix.lower() == ".svg":
        return "logo.svg" if _svg_into(source, folder) else None
    try:
        if photo_kind(source) == "png":
            return "logo.png" if _png_into(source, folder / "logo.png") else None
        (folder / "logo.jpg").write_bytes(small_photo(source, _LOGO_PX))
    except LeaklineError:
        return None
    return "logo.jpg"


def _png_into(source: Path, target: Path) -> bool:
    """Write a PNG made small, as a plain one: no metadata, eight bits, transparency kept."""
    from PIL import Image

    small_photo(source, 16)  # refuses what is too large or damaged, with all of its care
    with Image.open(source, formats=("PNG",)) as picture:
        picture.thumbnail((_LOGO_PX, _LOGO_PX))
        plain = picture.convert("RGBA")
        plain.info = {}
        plain.save(target, "PNG", optimize=True)
    return True


def _svg_into(source: Path, folder: Path) -> bool:
    """Copy an SVG that the page setter can draw: tried on a page of its own, as its faults are the setter's to find."""
    import typst  # large: loaded when a report is asked for

    try:
        if source.stat().st_size > SVG_AT_MOST:
            return False
        drawing = source.read_bytes()
    except OSError:
        return False
    if b"<!ENTITY" in drawing or b"<svg" not in drawing:  # entities can be made to grow without end
        return False
    (folder / "logo.svg").write_bytes(drawing)
    (folder / "logo.typ").write_text('#image("logo.svg", width: 30mm)', encoding="utf-8")
    try:
        typst.compile(str(folder / "logo.typ"), ignore_system_fonts=True, root=str(folder))
    except RuntimeError:
        return False
    return True
