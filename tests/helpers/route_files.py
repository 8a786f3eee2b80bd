"""Map files of a main, written by GDAL, which shares no line of code with our readers."""

import struct
import warnings
from pathlib import Path

import numpy as np
import pyogrio
import pyproj

GRID = "EPSG:5254"  # TUREF / TM30


def main_pipe(seed=1, count=40):
    """A main of some 600 m near 29° E: east, north, elevation (count, 3) in TM30."""
    rng = np.random.default_rng(seed)
    east = 424_000.0 + np.cumsum(rng.uniform(2.0, 30.0, count))
    north = 4_528_000.0 + np.cumsum(rng.uniform(-10.0, 10.0, count))
    return np.column_stack([east, north, 50.0 + rng.normal(size=count)])


def in_degrees(points, crs=GRID):
    move = pyproj.Transformer.from_crs(crs, "EPSG:4326", always_xy=True)
    longitude, latitude = move.transform(points[:, 0], points[:, 1])
    return np.column_stack([longitude, latitude, points[:, 2:]])


def wkb(points):
    head = struct.pack("<BII", 1, 1002 if points.shape[1] == 3 else 2, len(points))
    return head + np.ascontiguousarray(points, dtype="<f8").tobytes()


def write(path: Path, driver, lines, crs, names=None, append=False, layer=None):
    """Write lines (each (n, 2 or 3)) with GDAL; returns the path."""
    fields = {} if driver == "DXF" else {"Name" if "KML" in driver else "name": names or ["main"] * len(lines)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it tells that a drawing has no coordinate system
        pyogrio.raw.write(
            path,
            geometry=np.array([wkb(line) for line in lines], dtype=object),
            geometry_type="LineString Z" if lines[0].shape[1] == 3 else "LineString",
            field_data=[np.array(values, dtype=object) for values in fields.values()],
            fields=list(fields),
            crs=crs,
            driver=driver,
            append=append,
            layer=layer,
        )
    return path
