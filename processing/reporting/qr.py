"""A QR code that a phone's camera opens as a place on its map (RFC 5870), drawn as vectors."""

import segno

_QUIET = 4  # modules of empty margin, as ISO/IEC 18004 asks for


def geo_link(latitude: float, longitude: float) -> str:
    """Return the geo link of a WGS 84 place, to a tenth of a metre; without further parts, which phones read unlike."""
    return f"geo:{latitude:.6f},{longitude:.6f}"


def qr_svg(text: str) -> str:
    """Return a QR code of ``text`` with error correction M (15 %: mud and rain) as SVG, one unit a module."""
    rows = [
        [bool(module) for module in row] for row in segno.make(text, error="m", micro=False, boost_error=False).matrix
    ]
    size = len(rows) + 2 * _QUIET
    bars = []
    for y, row in enumerate(rows):
        x = 0
        while x < len(row):
            end = x
            while end < len(row) and row[end]:
                end += 1
            if end > x:
                bars.append(f"M{x + _QUIET} {y + _QUIET}h{end - x}v1h-{end - x}z")
            x = max(end, x + 1)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{size}pt" height="{size}pt" viewBox="0 0 {size} {size}">'
        f'<rect width="{size}" height="{size}" fill="#ffffff"/><path d="{"".join(bars)}" fill="#000000"/></svg>'
    )
