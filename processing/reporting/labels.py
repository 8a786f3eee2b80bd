"""Names on a map that do not lie on each other: each goes to the first free side of its mark."""

from dataclasses import dataclass

from processing.reporting.svg import INK, Drawing, Frame

_WIDTH = 0.56  # of a letter of Inter, in font sizes: the mean of running text is 0.53


@dataclass(frozen=True)
class Box:
    """A rectangle of the drawing."""

    left: float
    top: float
    right: float
    bottom: float

    def meets(self, other: "Box") -> bool:
        """Return whether two boxes overlap."""
        return (
            self.left < other.right and other.left < self.right and self.top < other.bottom and other.top < self.bottom
        )


class Labels:
    """Places words beside marks in a frame; what finds no free side is left out unless it must be seen."""

    def __init__(self, drawing: Drawing, frame: Frame) -> None:
        self._drawing, self._frame = drawing, frame
        self._taken: list[Box] = []

    def keep_clear(self, x: float, y: float, reach: float) -> None:
        """Let no later words cover a mark."""
        self._taken.append(Box(x - reach, y - reach, x + reach, y + reach))

    def place(
        self, x: float, y: float, words: str, *, away: float, size: float, must: bool = False, **style: str | float
    ) -> bool:
        """Write ``words`` beside (x, y), ``away`` from it; return whether there was room."""
        width, height = _WIDTH * size * len(words) + 2, 1.15 * size
        sides = (
            (x + away, y - height / 2),
            (x + away, y - height - away / 2),
            (x + away, y + away / 2),
            (x - away - width, y - height / 2),
            (x - width / 2, y - height - away),
            (x - width / 2, y + away),
            (x - away - width, y - height - away / 2),
            (x - away - width, y + away / 2),
        )
        boxes = [Box(left, top, left + width, top + height) for left, top in sides]
        inside = [box for box in boxes if self._fits(box)]
        free = next((box for box in inside if not any(box.meets(other) for other in self._taken)), None)
        box = free or ((inside or boxes)[0] if must else None)
        if box is None:
            return False
        self._taken.append(box)
        self._drawing.rectangle(box.left, box.top, width, height, "#ffffff", 0.8)
        colour = style.pop("colour", INK)
        baseline = box.top + 0.84 * size
        self._drawing.text(box.left + 1, baseline, words, size=size, colour=colour, **style)
        return True

    def _fits(self, box: Box) -> bool:
        frame = self._frame
        return (
            frame.left <= box.left
            and box.right <= frame.left + frame.width
            and frame.top <= box.top
            and box.bottom <= frame.top + frame.height
        )
