"""Arcs as polylines: circular strings of three points, as GIS files hold the bends of pipes."""

import numpy as np

from processing.survey import FloatArray

SAGITTA = 0.002  # how far a chord may leave its arc: 2 mm in a file of metres
MAX_STEPS = 256


def circular_string(points: FloatArray, sagitta: float = SAGITTA) -> FloatArray:
    """Return the polyline (m, k) of arcs given by start, a point on the arc, end, and so on: (n, k), n odd, k ≥ 2.

    Columns beyond x and y go linearly along each half. Points on one line give that line (ISO 19125 / SQL-MM).
    """
    parts = [points[:1], *(_arc(points[i : i + 3], sagitta)[1:] for i in range(0, len(points) - 2, 2))]
    if len(points) % 2 == 0:
        parts.append(points[-1:])
    return np.concatenate(parts)


def _arc(three: FloatArray, sagitta: float) -> FloatArray:
    (ax, ay), (bx, by), (cx, cy) = three[:, :2] - three[0, :2]
    if np.array_equal(three[0, :2], three[2, :2]):  # by SQL-MM a full circle: the middle is opposite
        centre, turn = np.array([bx, by]) / 2.0, 2.0 * np.pi
    else:
        twice_area = 2.0 * (bx * cy - by * cx)
        if abs(twice_area) < 1e-9 * max(bx * bx + by * by, cx * cx + cy * cy):
            return three
        b2, c2 = bx * bx + by * by, cx * cx + cy * cy
        centre = np.array([cy * b2 - by * c2, bx * c2 - cx * b2]) / twice_area
        first, last = np.arctan2(ay - centre[1], ax - centre[0]), np.arctan2(cy - centre[1], cx - centre[0])
        turn = float(np.mod(last - first, 2.0 * np.pi)) - (2.0 * np.pi if twice_area < 0.0 else 0.0)
    radius = float(np.hypot(*centre))
    start = float(np.arctan2(-centre[1], -centre[0]))
    step = 2.0 * np.arccos(max(1.0 - sagitta / radius, 0.0)) if radius > 0.0 else np.pi
    count = int(np.clip(np.ceil(abs(turn) / max(step, 1e-6)), 2, MAX_STEPS))
    part = np.linspace(0.0, 1.0, count + 1)
    angle = start + part * turn
    middle = _part_of_middle(three, centre, start, turn)
    rest = [np.interp(part, [0.0, middle, 1.0], three[:, k]) for k in range(2, three.shape[1])]
    x = three[0, 0] + centre[0] + radius * np.cos(angle)
    y = three[0, 1] + centre[1] + radius * np.sin(angle)
    arc = np.column_stack([x, y, *rest])
    arc[0], arc[-1] = three[0], three[2]
    return np.asarray(arc)


def _part_of_middle(three: FloatArray, centre: FloatArray, start: float, turn: float) -> float:
    bx, by = three[1, :2] - three[0, :2]
    at = np.arctan2(by - centre[1], bx - centre[0])
    part = np.mod((at - start) * np.sign(turn), 2.0 * np.pi) / abs(turn)
    return float(np.clip(part, 1e-6, 1.0 - 1e-6))
