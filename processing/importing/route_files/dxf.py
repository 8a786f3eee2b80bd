"""Reads lines from a DXF drawing: lines, polylines with their arcs, arcs and splines of the model space, by layer."""

import io
import struct
from dataclasses import replace
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np

from processing.importing.route_files.curves import circular_string
from processing.importing.route_files.lines import (
    MAX_POINTS,
    MAX_TEXT_BYTES,
    CrsSource,
    LineCollector,
    RouteFile,
    RouteLineString,
    damaged,
    read_bytes,
)
from processing.progress import Progress
from processing.survey import Finding, Severity

_KINDS = "LINE LWPOLYLINE POLYLINE SPLINE ARC ELLIPSE"
_UNIT_M = {1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1.0, 7: 1000.0, 14: 0.1, 21: 1200.0 / 3937.0}  # $INSUNITS
SAGITTA_M = 0.002
_ODD_M = 20.0  # a whole drawing of a main that would be smaller is in another unit than it says
_FAULTS = (
    ValueError, KeyError, IndexError, TypeError, AttributeError, ZeroDivisionError, OverflowError, ArithmeticError,
    AssertionError, RecursionError, struct.error, EOFError, StopIteration, MemoryError,
)  # fmt: skip


def read_dxf(path: Path, progress: Progress) -> RouteFile:
    """Return the lines of a drawing; it has no coordinate system, so that is asked.

    Raises:
        LeaklineError: ROUTE_DAMAGED, ROUTE_EMPTY, ROUTE_TOO_MANY; those of reading.
    """
    from ezdxf import recover
    from ezdxf.lldxf.const import DXFError

    data = read_bytes(path, MAX_TEXT_BYTES)
    progress.update(0.05, "route_reading")
    try:
        # the forgiving reader takes bytes: older and damaged drawings too, and it opens no other file
        document, _ = recover.read(io.BytesIO(data))
        progress.update(0.6)
        unit_m = _UNIT_M.get(int(document.header.get("$INSUNITS", 0)), 1.0)
        collector = LineCollector(path)
        for entity in document.modelspace().query(_KINDS):
            _collect(entity, unit_m, collector)
    except (DXFError, *_FAULTS) as fault:
        raise damaged(path, fault) from None
    lines, findings = collector.finish()
    unit_m, odd = _plausible(lines, unit_m)
    return RouteFile(path, "DXF", _flat_ones(lines), None, CrsSource.ASK, findings + odd, unit_m)


def _collect(entity: Any, unit_m: float, collector: LineCollector) -> None:  # noqa: ANN401  # ezdxf's entities
    kind = entity.dxftype()
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        return  # a mesh
    if kind == "LINE":
        points = [entity.dxf.start, entity.dxf.end]
    elif kind == "LWPOLYLINE":
        rows = [(x, y, entity.dxf.elevation, bulge) for x, y, bulge in entity.get_points("xyb")]
        points = _bulged(rows, entity, unit_m)
    elif kind == "POLYLINE" and entity.is_2d_polyline:
        height = entity.dxf.elevation.z if entity.dxf.hasattr("elevation") else 0.0
        rows = [(v.dxf.location.x, v.dxf.location.y, height, v.dxf.bulge) for v in entity.vertices]
        points = _bulged(rows, entity, unit_m)
    elif kind == "POLYLINE":
        points = [*entity.points(), *(entity.points()[:1] if entity.is_closed else ())]
    else:
        points = list(islice(entity.flattening(SAGITTA_M / unit_m), MAX_POINTS + 1))
    collector.add(None, str(entity.dxf.layer), [tuple(point) for point in points], has_z=True)


def _bulged(rows: list[tuple[float, float, float, float]], entity: Any, unit_m: float) -> list[Any]:  # noqa: ANN401
    """Vertices in the world of a flat polyline: x, y, height, bulge (tan of a quarter of the arc's turn)."""
    if entity.is_closed and rows:
        rows = [*rows, rows[0]]
    points = [rows[0][:3]] if rows else []
    for (ax, ay, z, bulge), (bx, by, _, _) in pairwise(rows):
        if bulge:
            middle = (0.5 * (ax + bx + bulge * (by - ay)), 0.5 * (ay + by - bulge * (bx - ax)))
            arc = circular_string(np.array([(ax, ay), middle, (bx, by)]), SAGITTA_M / unit_m)
            points += [(float(x), float(y), z) for x, y in arc[1:]]
        else:
            points.append((bx, by, z))
    return list(entity.ocs().points_to_wcs(points))


def _plausible(lines: tuple[RouteLineString, ...], unit_m: float) -> tuple[float, tuple[Finding, ...]]:
    """A drawing begun from a template of millimetres often holds metres: believe the size, and tell it."""
    spans = [
        max(float(line.points[:, k].max()) for line in lines) - min(float(line.points[:, k].min()) for line in lines)
        for k in (0, 1)
    ]
    size = max(spans)
    if unit_m < 0.1 and size * unit_m < _ODD_M <= size:
        return 1.0, (Finding("route_unit_doubtful", Severity.WARNING, {"unit_m": unit_m}),)
    return unit_m, ()


def _flat_ones(lines: tuple[RouteLineString, ...]) -> tuple[RouteLineString, ...]:
    """A drawing without a single height was drawn flat: its zeros say nothing."""
    if any(line.points[:, 2].any() for line in lines):
        return lines
    return tuple(replace(line, has_z=False) for line in lines)
