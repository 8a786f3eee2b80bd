"""Lines in well-known binary (OGC 06-103r4, with ISO and extended codes of height and measure)."""

import struct
from collections.abc import Iterator

import numpy as np

from processing.importing.route_files.curves import circular_string
from processing.survey import FloatArray

LINE, POLYGON, MULTI_LINE, COLLECTION, CIRCULAR, COMPOUND, MULTI_CURVE = 2, 3, 5, 7, 8, 9, 11
_HOLDERS = (MULTI_LINE, COLLECTION, MULTI_CURVE)
MAX_DEPTH = 8


class WkbError(ValueError):
    """The bytes are no geometry."""


def lines_of_wkb(data: bytes) -> Iterator[FloatArray]:
    """Yield the lines (n, 2 or 3) of a geometry; points and areas in it are passed over.

    Raises:
        WkbError: for bytes that are no geometry.
    """
    yield from _Reader(data).geometry(0)


class _Reader:
    """Walks through the bytes; every count is checked against what is left before anything is made of it."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def geometry(self, depth: int) -> Iterator[FloatArray]:
        order, kind, has_z, width = self._head(depth)
        if kind in (LINE, CIRCULAR):
            points = self._points(order, width)[:, : 3 if has_z else 2]
            yield circular_string(points) if kind == CIRCULAR and len(points) > 2 else points
        elif kind in _HOLDERS:
            for _ in range(self._count(order, 5)):
                yield from self.geometry(depth + 1)
        elif kind == COMPOUND:
            parts = [part for _ in range(self._count(order, 5)) for part in self.geometry(depth + 1)]
            parts = [part for part in parts if len(part)]
            if parts:
                yield np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
        else:
            self._pass_over(order, kind, width, depth)

    def _head(self, depth: int) -> tuple[str, int, bool, int]:
        if depth > MAX_DEPTH:
            raise WkbError("nested too deeply")
        order = {0: ">", 1: "<"}.get(self._take(1)[0])
        if order is None:
            raise WkbError("byte order")
        code = self._integer(order)
        extended, code = code >> 28, code & 0x0FFFFFFF
        if extended & 0x2:
            self._integer(order)  # a reference system of its own
        dimensions, kind = divmod(code, 1000)
        if dimensions > 3:
            raise WkbError("geometry type")
        has_z = bool(extended & 0x8) or dimensions in (1, 3)
        has_m = bool(extended & 0x4) or dimensions in (2, 3)
        return order, kind, has_z, 2 + has_z + has_m

    def _pass_over(self, order: str, kind: int, width: int, depth: int) -> None:
        if kind == 1:
            self._take(8 * width)
        elif kind == POLYGON:
            for _ in range(self._count(order, 4)):
                self._points(order, width)
        elif kind in (4, 6):  # several points, several areas
            for _ in range(self._count(order, 5)):
                for _line in self.geometry(depth + 1):
                    pass
        else:
            raise WkbError("geometry type")

    def _points(self, order: str, width: int) -> FloatArray:
        count = self._count(order, 8 * width)
        return np.frombuffer(self._take(8 * width * count), dtype=f"{order}f8").reshape(count, width).astype(np.float64)

    def _count(self, order: str, smallest: int) -> int:
        count = self._integer(order)
        if count * smallest > len(self._data) - self._at:
            raise WkbError("cut short")
        return count

    def _integer(self, order: str) -> int:
        return int(struct.unpack(f"{order}I", self._take(4))[0])

    def _take(self, size: int) -> bytes:
        if size > len(self._data) - self._at:
            raise WkbError("cut short")
        taken = self._data[self._at : self._at + size]
        self._at += size
        return taken
