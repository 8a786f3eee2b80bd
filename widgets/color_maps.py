"""Colour tables of 256 for spectrograms: perceptually uniform, readable by the colour-blind and in grey print.

Viridis and magma: van der Walt and Smith 2015 (CC0). Cividis: Nuñez, Anderton and Renslow 2018. Each is kept as 18
anchors, between which a straight line is at most 7/255 off.
"""

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
import pyqtgraph as pg

_ANCHORS: Mapping[str, str] = {
    "viridis": "440154 481769 472a7a 433d84 3d4e8a 355e8d 2e6d8e 297b8e 23898e 1f978b 21a585 2eb37c 46c06f 65cb5e "
    "89d548 b0dd2f d8e219 fde725",
    "magma": "000004 090720 1a1042 311165 4a1079 621980 792282 912b81 aa337d c23b75 d9466b ec5860 f7725c fc8e64 "
    "feaa74 fec68a fde2a3 fcfdbf",
    "cividis": "00204d 002b67 00356e 28406c 3d4a6b 4d556c 5b606e 696b71 767676 848179 928d78 a19976 b1a573 c1b26d "
    "d1bf66 e2cd5c f3db4f ffea46",
    "grey": "ffffff 000000",
}
COLOR_MAPS = tuple(_ANCHORS)  # for levels
EXCESS_MAP, DARK_EXCESS_MAP = "excess", "excess_dark"
# purple under, white at, orange over the background: PuOr of ColorBrewer (Harrower and Brewer 2003); and turned inside
# out for the dark theme, where white would blind
_EXCESS_ANCHORS: Mapping[str, str] = {
    EXCESS_MAP: "2d004b 542788 8073ac b2abd2 d8daeb f7f7f7 fee0b6 fdb863 e08214 b35806 7f3b08",
    DARK_EXCESS_MAP: "d8daeb b2abd2 8073ac 542788 33205a 12161b 5a3208 a85a0c e08214 fdb863 fee0b6",
}


def color_map(name: str) -> pg.ColorMap:
    """Return a colour map, quiet to loud; ``grey`` runs from white to black."""
    anchors = _EXCESS_ANCHORS[name] if name in _EXCESS_ANCHORS else _ANCHORS[name]
    return pg.ColorMap(None, [f"#{anchor}" for anchor in anchors.split()], name=name)


def color_table(name: str) -> npt.NDArray[np.uint8]:
    """Return the (256, 3) red, green and blue of a colour map."""
    parts = color_map(name).getLookupTable(nPts=256, alpha=False, mode="float")
    return np.rint(255.0 * np.asarray(parts)).astype(np.uint8)


def level_color_index(level_db: npt.ArrayLike, low_db: float, high_db: float) -> npt.NDArray[np.uint8]:
    """Return which of the 256 colours shows a level: 0 at and below ``low_db``, 255 at and above ``high_db``.

    The picture and its colour bar both ask here, so they cannot differ.
    """
    part = (np.asarray(level_db, dtype=np.float64) - low_db) / (high_db - low_db)
    return np.asarray(np.rint(255.0 * np.clip(part, 0.0, 1.0)), dtype=np.uint8)
