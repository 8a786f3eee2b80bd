"""Fewer vertices on a line, within a tolerance (Douglas and Peucker 1973)."""

import numpy as np

from processing.survey import FloatArray


def thinned(points: FloatArray, tolerance: float) -> FloatArray:
    """Return those of ``points`` (n, 2 or 3) from which the line is nowhere further than ``tolerance``; ends stay."""
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    open_spans = [(0, len(points) - 1)]
    while open_spans:
        first, last = open_spans.pop()
        if last - first < 2:
            continue
        away = _distances(points[first + 1 : last], points[first], points[last])
        worst = int(np.argmax(away))
        if away[worst] > tolerance:
            middle = first + 1 + worst
            kept[middle] = True
            open_spans += [(first, middle), (middle, last)]
    return points[kept]


def _distances(points: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
    """How far points are from the piece between ``start`` and ``end``."""
    along = end - start
    square = float(along @ along)
    part = np.clip((points - start) @ along / square, 0.0, 1.0) if square > 0.0 else np.zeros(len(points))
    return np.asarray(np.linalg.norm(points - start - part[:, None] * along, axis=1))
