"""The mark of each verdict on paper: shape, sign and colour as in the window, told apart on a grey print, too."""

from processing.reporting.svg import Drawing
from processing.survey import Verdict

# those of the window's light theme, darkened where white letters stand on them
VERDICT_COLOURS = {
    Verdict.CONFIRMED: "#00704f",
    Verdict.REJECTED: "#6b7480",
    Verdict.UNSURE: "#a85f00",
    Verdict.NONE: "#0067a1",
}
_GROUND = "#ffffff"


def draw_mark(drawing: Drawing, x: float, y: float, verdict: Verdict, reach: float) -> None:
    """Draw a mark: confirmed a disc ✓, unsure a triangle ?, rejected a hollow square ✕, else a diamond."""
    colour = VERDICT_COLOURS[verdict]
    r = reach
    if verdict is Verdict.CONFIRMED:
        drawing.add(
            f'<circle cx="{x:.2f}" cy="{y:.2f}" r="{r}" fill="{colour}" stroke="{_GROUND}" stroke-width="0.8"/>'
        )
        drawing.path([(x - 0.5 * r, y), (x - 0.15 * r, y + 0.4 * r), (x + 0.5 * r, y - 0.4 * r)], _GROUND, 0.2 * r)
    elif verdict is Verdict.REJECTED:
        corners = [(x - r, y - r), (x + r, y - r), (x + r, y + r), (x - r, y + r), (x - r, y - r)]
        drawing.path(corners, colour, 0.9, fill=_GROUND)
        for side in (1.0, -1.0):
            drawing.path([(x - 0.5 * r, y - side * 0.5 * r), (x + 0.5 * r, y + side * 0.5 * r)], colour, 0.2 * r)
    elif verdict is Verdict.UNSURE:
        h = 1.25 * r
        drawing.path([(x, y - h), (x + h, y + 0.8 * h), (x - h, y + 0.8 * h), (x, y - h)], _GROUND, 0.8, fill=colour)
        drawing.text(x, y + 0.68 * h, "?", anchor="middle", size=1.25 * r, weight=600, colour=_GROUND)
    else:
        h = 1.15 * r
        drawing.path([(x, y - h), (x + h, y), (x, y + h), (x - h, y), (x, y - h)], _GROUND, 0.8, fill=colour)


def mark_svg(verdict: Verdict) -> str:
    """Return one mark as a drawing of its own, 12 points square, for tables and legends."""
    drawing = Drawing(12, 12)
    draw_mark(drawing, 6.0, 6.0, verdict, 4.4)
    return drawing.svg()
