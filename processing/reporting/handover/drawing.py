"""Writes ``survey.dxf`` (AutoCAD 2000): the pipe by status, leaks and reference points as blocks with attributes.

Drawing units are those of the coordinate system (metres or feet), told in the header; a drawing knows no degrees, so
that beside such a system the UTM zone of the launch is taken. ``survey.prj`` beside it names the system, as map
programs look for it there.

The old version is meant: its text has the code page that its header names (Turkish; other letters as ``\\U+XXXX``).
Newer ones are UTF-8 under a header that still names a code page, which GDAL, and so QGIS, believes.
"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from processing.reporting.files import whole_path
from processing.reporting.handover.layers import Feature, Layer, Layers
from processing.reporting.handover.outcome import Written
from processing.reporting.handover.system import for_drawing
from processing.reporting.handover.thinning import thinned
from processing.reporting.handover.words import HandoverWords
from processing.survey import FloatArray

if TYPE_CHECKING:
    from ezdxf.document import Drawing
    from ezdxf.layouts.blocklayout import BlockLayout
    from ezdxf.layouts.layout import Modelspace

FILE_NAME = "survey.dxf"
TEXT_M = 1.25  # 2.5 mm on paper at 1:500
UNITS = {"m": 6, "ft": 2, "ftus": 21}  # $INSUNITS
LEAKS, NO_LEAKS, REFERENCES, PATH, CHAINAGE, ABOUT = (
    f"LEAKLINE_{name}" for name in ("LEAKS", "NO_LEAKS", "REFERENCE_POINTS", "PATH", "CHAINAGE", "ABOUT")
)
STRETCH_LAYERS = {
    "leak": ("LEAKLINE_STRETCH_LEAK", 1, 70),
    "suspected": ("LEAKLINE_STRETCH_SUSPECTED", 30, 70),
    "no_leak_found": ("LEAKLINE_STRETCH_NO_LEAK_FOUND", 3, 35),
    "not_assessed": ("LEAKLINE_STRETCH_NOT_ASSESSED", 8, 70),
}  # layer, AutoCAD colour, line weight in 1/100 mm
POINT_LAYERS = {LEAKS: 1, NO_LEAKS: 8, REFERENCES: 94, PATH: 5, CHAINAGE: 250, ABOUT: 7}
LEAK_BLOCK, REFERENCE_BLOCK = "LEAKLINE_LEAK", "LEAKLINE_REFERENCE"
SHOWN = {"id": 0, "reference_name": 0, "chainage": 1}  # column key: line; the others are there to be asked for
LABELLED_EVERY_M = 50.0
PATH_TOLERANCE_M = 0.01  # a vertex each half metre makes a drawing slow


def write_drawing(path: Path, layers: Layers, title: str, words: HandoverWords) -> Written:
    """Write the drawing, and its ``.prj`` where the place in the world is known.

    Raises OSError and ezdxf.DXFError.
    """
    from ezdxf.filemanagement import new

    system = for_drawing(layers.system, layers.options)
    text = TEXT_M / system.unit_m
    drawing = new("R2000")
    drawing.encoding = "cp1254"
    drawing.header["$INSUNITS"] = UNITS.get(system.unit, 0)
    drawing.header["$MEASUREMENT"] = 1 if system.unit == "m" else 0
    drawing.header["$PDMODE"] = 3
    drawing.styles.add("LEAKLINE", font="arial.ttf")  # the strokes of the standard font lack Turkish letters
    _add_layers(drawing)
    space = drawing.modelspace()
    places = {layer.name: layer.coordinates(system) for layer in layers.all}
    _add_path(space, layers.track, places["track"], text, words)
    for feature, points in zip(layers.stretches.features, places["stretches"], strict=True):
        name = STRETCH_LAYERS[str(layers.stretches.cell(feature, "stretch_status"))][0]
        space.add_lwpolyline(points[:, :2].tolist(), dxfattribs={"layer": name})
    _add_blocks(drawing, layers.leaks, places["leaks"], LEAK_BLOCK, text)
    _add_blocks(drawing, layers.references, places["reference_points"], REFERENCE_BLOCK, text)
    about = f"{title}\n{words.about_files()}\n{system.label}"
    corner = _corner(list(places.values()))
    space.add_mtext(about, dxfattribs={"layer": ABOUT, "char_height": 2 * text, "style": "LEAKLINE", "insert": corner})
    with whole_path(path) as aside:
        drawing.saveas(aside)
    files = [path]
    if not system.is_local:
        files.append(path.with_suffix(".prj"))
        with whole_path(files[-1]) as aside:
            aside.write_text(system.wkt("WKT1_ESRI"), encoding="ascii", errors="replace")
    return Written(tuple(files))


def _add_layers(drawing: "Drawing") -> None:
    for name, colour, weight in STRETCH_LAYERS.values():
        drawing.layers.add(name, color=colour, lineweight=weight)
    for name, colour in POINT_LAYERS.items():
        drawing.layers.add(name, color=colour)
    drawing.layers.get(NO_LEAKS).off()


def _add_path(space: "Modelspace", layer: Layer, lines: list[FloatArray], text: float, words: HandoverWords) -> None:
    """The whole path as one line in space, and its interval written along it."""
    if not lines:
        return
    whole = np.concatenate([lines[0], *(line[1:] for line in lines[1:])])
    space.add_polyline3d(thinned(whole, PATH_TOLERANCE_M * text / TEXT_M).tolist(), dxfattribs={"layer": PATH})
    every = max(1, round(LABELLED_EVERY_M * len(lines) / max(_metres(layer), 1.0)))
    columns = {column.key: column for column in layer.columns}
    for feature, points in list(zip(layer.features, lines, strict=True))[every - 1 :: every]:
        start, end = points[-2, :2], points[-1, :2]
        angle = float(np.degrees(np.arctan2(*(end - start)[::-1])))
        upright = angle - 180.0 if abs(angle) > 90.0 else angle
        told = words.value(columns["end"], layer.cell(feature, "end"))
        half = words.value(columns["half95"], layer.cell(feature, "half95"))
        label = space.add_text(
            f"{told} ± {half} {words.unit(columns['end'])}",
            height=text,
            rotation=upright,
            dxfattribs={"layer": CHAINAGE, "style": "LEAKLINE"},
        )
        label.set_placement((float(end[0]), float(end[1])))


def _metres(layer: Layer) -> float:
    """How long the path is, in the unit of its table: near enough to space labels by."""
    return float(layer.cell(layer.features[-1], "end") or 0.0)


def _add_blocks(drawing: "Drawing", layer: Layer, places: list[FloatArray], name: str, text: float) -> None:
    block = drawing.blocks.new(name)
    _draw_mark(block, text, leak=name == LEAK_BLOCK)
    for i, column in enumerate(layer.columns):
        tag = column.name.upper()
        shown = SHOWN.get(column.key)
        row = shown if shown is not None else 2 + i
        attribute = block.add_attdef(
            tag,
            (1.2 * text, -1.4 * text * row),
            height=text,
            dxfattribs={"style": "LEAKLINE", "prompt": column.key},
        )
        attribute.is_invisible = shown is None
    for feature, points in zip(layer.features, places, strict=True):
        told = {c.name.upper(): _text(feature, i) for i, c in enumerate(layer.columns)}
        on = REFERENCES if name == REFERENCE_BLOCK else NO_LEAKS if _is_no_leak(layer, feature) else LEAKS
        place = tuple(float(v) for v in points[0])
        mark = drawing.modelspace().add_blockref(name, place, dxfattribs={"layer": on}).add_auto_attribs(told)
        for written in mark.attribs:
            written.dxf.layer = on  # else its words stay when the layer is switched off


def _draw_mark(block: "BlockLayout", text: float, *, leak: bool) -> None:
    if leak:
        block.add_circle((0, 0), 0.8 * text)
        block.add_line((-1.2 * text, 0), (1.2 * text, 0))
        block.add_line((0, -1.2 * text), (0, 1.2 * text))
    else:
        half = 0.7 * text
        block.add_lwpolyline([(-half, -half), (half, -half), (0, half)], close=True)


def _text(feature: Feature, at: int) -> str:
    """A cell as attributes hold it: a point in numbers, one line."""
    value = feature.cells[at]
    return "" if value is None else " ".join(str(value).split())


def _is_no_leak(layer: Layer, feature: Feature) -> bool:
    return layer.cell(feature, "result") == "no_leak_found"


def _corner(places: list[list[FloatArray]]) -> tuple[float, float]:
    """Below all that is drawn, at its left."""
    drawn = [points for group in places for points in group]
    if not drawn:
        return 0.0, 0.0
    points = np.concatenate(drawn)[:, :2]
    low, high = points.min(axis=0), points.max(axis=0)
    return float(low[0]), float(low[1] - 0.02 * max(*(high - low), 1.0))
