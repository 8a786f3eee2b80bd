"""A vector drawing with a plot frame: data coordinates in, SVG text out; only what the report's figures need."""

import base64
import math
import struct
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from html import escape

import numpy as np
import numpy.typing as npt

from processing.survey import FloatArray

FONT = "Inter"
INK, SOFT, PALE = "#1a1a1a", "#5f6b76", "#d5dbe0"


@dataclass(frozen=True)
class Frame:
    """A rectangle of the drawing (points, y down) that shows ``x_low..x_high`` by ``y_low..y_high`` (y up)."""

    left: float
    top: float
    width: float
    height: float
    x_low: float
    x_high: float
    y_low: float
    y_high: float

    def x(self, value: float) -> float:
        """Return the horizontal place of a value."""
        return self.left + (value - self.x_low) / (self.x_high - self.x_low) * self.width

    def y(self, value: float) -> float:
        """Return the vertical place of a value."""
        return self.top + (self.y_high - value) / (self.y_high - self.y_low) * self.height


@dataclass(frozen=True)
class Scale:
    """How an axis is told: ``factor`` from data to the shown unit, ``text`` of a shown value."""

    factor: float = 1.0
    text: Callable[[float], str] | None = None  # None: :func:`number`

    def ticks(self, low: float, high: float, about: float) -> list[tuple[float, str]]:
        """Return places in data units with their labels."""
        values = ticks(low * self.factor, high * self.factor, about)
        return [(float(value) / self.factor, (self.text or number)(float(value))) for value in values]


class Drawing:
    """Collects SVG elements; sizes are points."""

    def __init__(self, width: float, height: float) -> None:
        self.width, self.height = width, height
        self._elements: list[str] = []
        self._clips = 0

    def add(self, element: str) -> None:
        """Append one element."""
        self._elements.append(element)

    def line(self, x1: float, y1: float, x2: float, y2: float, colour: str = INK, width: float = 0.8) -> None:
        """Draw a straight line."""
        self.add(
            f'<line x1="{x1:.2f}" y1="{y1:.2f}" x2="{x2:.2f}" y2="{y2:.2f}" stroke="{colour}" stroke-width="{width}"/>'
        )

    def text(self, x: float, y: float, words: str, **style: str | float) -> None:
        """Write words; ``anchor`` start/middle/end, ``size``, ``colour``, ``weight``, ``turn`` in degrees, ``backed``.

        ``backed`` lays a pale plate behind words that start at ``x``, so that they stay readable on lines.
        """
        words = "".join(c for c in words if c.isprintable())  # XML has no form for control characters
        if style.get("backed"):
            size = float(style.get("size", 7.5))
            self.rectangle(x - 1.5, y - 0.85 * size, 0.58 * size * len(words) + 3, 1.15 * size, "#ffffff", 0.8)
        turn = f' transform="rotate({style["turn"]} {x:.2f} {y:.2f})"' if "turn" in style else ""
        self.add(
            f'<text x="{x:.2f}" y="{y:.2f}" font-family="{FONT}" font-size="{style.get("size", 7.5)}" '
            f'font-weight="{style.get("weight", 400)}" fill="{style.get("colour", INK)}" '
            f'text-anchor="{style.get("anchor", "start")}"{turn}>{escape(words)}</text>'
        )

    def path(self, points: Iterable[tuple[float, float]], colour: str, width: float, **style: str | float) -> None:
        """Draw a polyline through drawing coordinates; ``fill``, ``dash``, ``opacity``, ``cap`` are optional."""
        places = [f"{x:.2f} {y:.2f}" for x, y in points]
        if len(places) < 2:
            return
        dash = f' stroke-dasharray="{style["dash"]}"' if "dash" in style else ""
        self.add(
            f'<path d="M{" L".join(places)}" fill="{style.get("fill", "none")}" stroke="{colour}" '
            f'stroke-width="{width}" opacity="{style.get("opacity", 1)}" stroke-linejoin="round" '
            f'stroke-linecap="{style.get("cap", "round")}"{dash}/>'
        )

    def rectangle(self, left: float, top: float, width: float, height: float, fill: str, opacity: float = 1) -> None:
        """Fill a rectangle."""
        self.add(
            f'<rect x="{left:.2f}" y="{top:.2f}" width="{width:.2f}" height="{height:.2f}" '
            f'fill="{fill}" fill-opacity="{opacity}"/>'
        )

    def image(self, frame: Frame, rgb: npt.NDArray[np.uint8]) -> None:
        """Fill a frame with an image (rows, columns, 3), first row on top."""
        data = base64.b64encode(png(rgb)).decode("ascii")
        self.add(
            f'<image x="{frame.left:.2f}" y="{frame.top:.2f}" width="{frame.width:.2f}" height="{frame.height:.2f}" '
            f'preserveAspectRatio="none" href="data:image/png;base64,{data}"/>'
        )

    def clipped(self, frame: Frame, draw: Callable[[], None]) -> None:
        """Draw with everything outside of the frame cut away."""
        self._clips += 1
        name = f"clip{self._clips}"
        self.add(
            f'<clipPath id="{name}"><rect x="{frame.left:.2f}" y="{frame.top:.2f}" width="{frame.width:.2f}" '
            f'height="{frame.height:.2f}"/></clipPath><g clip-path="url(#{name})">'
        )
        draw()
        self.add("</g>")

    def axes(
        self,
        frame: Frame,
        x_label: str,
        y_label: str,
        grid: bool = True,
        scales: tuple[Scale, Scale] = (Scale(), Scale()),
    ) -> None:
        """Draw a frame with round ticks and labels; ``scales`` tell how x and y are written."""
        for value, label in scales[0].ticks(frame.x_low, frame.x_high, max(frame.width / 55, 4.0)):
            if grid:
                self.line(frame.x(value), frame.top, frame.x(value), frame.top + frame.height, PALE, 0.5)
            self.text(frame.x(value), frame.top + frame.height + 10, label, anchor="middle", colour=SOFT)
        for value, label in scales[1].ticks(frame.y_low, frame.y_high, frame.height / 28):
            if grid:
                self.line(frame.left, frame.y(value), frame.left + frame.width, frame.y(value), PALE, 0.5)
            self.text(frame.left - 4, frame.y(value) + 2.6, label, anchor="end", colour=SOFT)
        self.line(frame.left, frame.top + frame.height, frame.left + frame.width, frame.top + frame.height, SOFT)
        self.line(frame.left, frame.top, frame.left, frame.top + frame.height, SOFT)
        self.text(frame.left + frame.width / 2, frame.top + frame.height + 21, x_label, anchor="middle", colour=SOFT)
        self.text(10, frame.top + frame.height / 2, y_label, anchor="middle", colour=SOFT, turn=-90)

    def svg(self) -> str:
        """Return the whole drawing."""
        size = f'width="{self.width}pt" height="{self.height}pt" viewBox="0 0 {self.width} {self.height}"'
        return f'<svg xmlns="http://www.w3.org/2000/svg" {size}>{"".join(self._elements)}</svg>'


def ticks(low: float, high: float, about: float) -> FloatArray:
    """Return round values in ``low..high``, about as many as asked for (at least two steps where they fit)."""
    step = round_up((high - low) / max(about, 1.5))
    return np.asarray(np.arange(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1) * step, np.float64)


def round_up(value: float) -> float:
    """Return the next of 1, 2, 5 times a power of ten."""
    if not value > 0 or not math.isfinite(value):
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(factor * power for factor in (1, 2, 5, 10) if factor * power >= value * 0.999)


def number(value: float) -> str:
    """Return a tick's label without needless zeros, with a true minus."""
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}") if abs(value) > 1e-12 else "0"


def png(rgb: npt.NDArray[np.uint8]) -> bytes:
    """Return an 8-bit RGB image as PNG."""
    rows, columns, _ = rgb.shape
    lines = np.concatenate([np.zeros((rows, 1), np.uint8), rgb.reshape(rows, columns * 3)], axis=1)

    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", columns, rows, 8, 2, 0, 0, 0)
    body = zlib.compress(lines.tobytes(), 6)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")
