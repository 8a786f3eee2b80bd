"""Reads map files with GDAL, as plain rows."""

import struct

import numpy as np
import pyogrio.raw
import pyproj

LAUNCH = (29.1, 40.9012)  # longitude, latitude of the small survey


def expected_place(chainage_m, crs, launch=LAUNCH):
    """Where a place of the straight run to the north-east lies, by geodesic and projection, not by our frame."""
    longitude, latitude, _ = pyproj.Geod(ellps="WGS84").fwd(*launch, 45.0, chainage_m)
    return pyproj.Transformer.from_crs("EPSG:4326", crs, always_xy=True).transform(longitude, latitude)


def features(path, layer=None):
    """Return what GDAL says of a layer, and its rows as dictionaries with the points of each as ``xyz``."""
    meta, _, geometry, columns = pyogrio.raw.read(path, layer=layer)
    names = list(meta["fields"])
    rows = []
    for i, wkb in enumerate(geometry):
        row = {name: _plain(columns[j][i]) for j, name in enumerate(names)}
        row["xyz"] = [tuple(point) for point in points_of(wkb)]
        rows.append(row)
    return meta, rows


def coordinates(path, layer=None):
    """Return the points of each feature of a layer."""
    return [points_of(wkb) for wkb in pyogrio.raw.read(path, layer=layer)[2]]


def points_of(wkb):
    """Return the points (n, 2 or 3) of a point or line in little-endian well-known binary."""
    order, kind = struct.unpack_from("<BI", wkb)
    assert order == 1
    width = 3 if kind // 1000 == 1 or kind & 0x80000000 else 2
    plain = kind & 0xFF if kind & 0x80000000 else kind % 1000
    if plain == 5:  # several lines: the only one of them
        assert struct.unpack_from("<I", wkb, 5) == (1,)
        return points_of(wkb[9:])
    start = 5 if plain == 1 else 9
    assert plain in (1, 2), plain
    return np.frombuffer(wkb, dtype="<f8", offset=start).reshape(-1, width)


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value
