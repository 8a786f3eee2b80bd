"""Writes ``survey.kml`` (OGC 12-007r2): a folder for each table, coloured by status, with a balloon for each leak.

No picture is fetched from anywhere: pins keep the program's own form and get our colours. Times are days, as the
recording knows no other: a made-up hour would be believed.
"""

from collections.abc import Sequence
from pathlib import Path

from processing.reporting.files import whole_file
from processing.reporting.handover.columns import Column
from processing.reporting.handover.layers import Feature, Layer, Layers, Shape
from processing.reporting.handover.qgis_styles import STYLES
from processing.reporting.handover.system import wgs84
from processing.reporting.handover.words import HandoverWords
from processing.reporting.handover.xml_writing import attribute, element, escaped
from processing.survey import FloatArray

FILE_NAME = "survey.kml"
TRACK_COLOUR = "#1f5fa8"
HIDDEN = {"no_leak_found"}  # of the leaks
_NAMED_BY = {"leaks": "id", "stretches": "stretch_status", "track": "segment", "reference_points": "reference_name"}
_ONE_OF = {"leaks": "leak", "stretches": "stretch", "track": "segment", "reference_points": "reference"}
_TAKEN = {
    "id",
    "name",
    "description",
    "timestamp",
    "begin",
    "end",
    "icon",
    "visibility",
}  # by KML itself
_KINDS = {"integer": "int", "real": "double", "text": "string"}


def write_kml(path: Path, layers: Layers, title: str, day: str, words: HandoverWords, *, elevations: bool) -> None:
    """Write all layers in WGS 84; ``day`` (ISO 8601, may be empty) is when the survey was made.

    Heights are written where they are elevations. Raises OSError.
    """
    with whole_file(path) as file:
        file.write('<?xml version="1.0" encoding="UTF-8"?>\n<kml xmlns="http://www.opengis.net/kml/2.2">\n<Document>\n')
        file.write(element("name", title) + "\n" + element("description", words.about_files()) + "\n")
        if day:
            file.write(f"<TimeStamp>{element('when', day)}</TimeStamp>\n")
        file.write("".join(_styles()))
        file.writelines(_schema(layer) for layer in layers.all)
        system = wgs84(layers.system.frame)
        for layer in layers.all:
            hidden = layer.name == "track"
            file.write(
                f"<Folder>{element('name', words.layer(layer.name))}<visibility>{int(not hidden)}</visibility>\n"
            )
            places = layer.coordinates(system)
            for feature, points in zip(layer.features, places, strict=True):
                file.write(_placemark(layer, feature, points, words, day, elevations=elevations, hidden=hidden))
            file.write("</Folder>\n")
        file.write("</Document>\n</kml>\n")


def _styles() -> Sequence[str]:
    found = []
    for name, look in STYLES.items():
        for one in look.looks:
            colour, scale = _colour(one.colour), f"{one.size_mm / 4.0:.2f}"
            found.append(
                f'<Style id="{name}-{one.value}"><IconStyle><color>{colour}</color><scale>{scale}</scale></IconStyle>'
                f"<LineStyle><color>{colour}</color><width>{max(2.0, 3.0 * one.size_mm):.1f}</width></LineStyle>"
                "<BalloonStyle><text>$[description]</text></BalloonStyle></Style>\n"
            )
    found.append(
        f'<Style id="track"><LineStyle><color>{_colour(TRACK_COLOUR)}</color><width>2</width></LineStyle></Style>\n'
    )
    return found


def _colour(rgb: str) -> str:
    """KML writes opacity, blue, green, red."""
    return f"ff{rgb[5:7]}{rgb[3:5]}{rgb[1:3]}"


def _schema(layer: Layer) -> str:
    fields = "".join(
        f'<SimpleField type="{_KINDS[column.kind.value]}" name="{_field(layer, column)}"/>' for column in layer.columns
    )
    return f'<Schema name="{layer.name}" id="{layer.name}">{fields}</Schema>\n'


def _field(layer: Layer, column: Column) -> str:
    """The name of a column, one that KML has for itself with what it is of."""
    name = f"{_ONE_OF[layer.name]}_{column.name}" if column.name.lower() in _TAKEN else column.name
    return attribute(name)


def _placemark(
    layer: Layer,
    feature: Feature,
    points: FloatArray,
    words: HandoverWords,
    day: str,
    *,
    elevations: bool,
    hidden: bool,
) -> str:
    look = STYLES.get(layer.name)
    value = layer.cell(feature, look.key) if look is not None else None
    hidden = hidden or (layer.name == "leaks" and value in HIDDEN)
    cells = [(column, cell) for column, cell in zip(layer.columns, feature.cells, strict=True) if cell is not None]
    data = "".join(f'<SimpleData name="{_field(layer, c)}">{escaped(str(v))}</SimpleData>' for c, v in cells)
    style = f"{layer.name}-{value}" if look is not None else "track"
    parts = [
        element("name", words.title(layer, feature, _NAMED_BY[layer.name])),
        f"<visibility>{int(not hidden)}</visibility>",
        element("description", words.balloon(layer, feature)) if layer.name != "track" else "",
        f"<TimeStamp>{element('when', day)}</TimeStamp>" if day and layer.name == "leaks" else "",
        f"<styleUrl>#{attribute(style)}</styleUrl>",
        f'<ExtendedData><SchemaData schemaUrl="#{layer.name}">{data}</SchemaData></ExtendedData>',
        _geometry(layer.shape, points, elevations=elevations),
    ]
    return "<Placemark>" + "".join(parts) + "</Placemark>\n"


def _geometry(shape: Shape, points: FloatArray, *, elevations: bool) -> str:
    """Buried pipes lie on the ground of the map: heights are there to be read, not to be drawn."""
    if elevations:
        told = " ".join(f"{x:.8f},{y:.8f},{z:.3f}" for x, y, z in points.tolist())
    else:
        told = " ".join(f"{x:.8f},{y:.8f}" for x, y in points[:, :2].tolist())
    if shape is Shape.POINT:
        return f"<Point><coordinates>{told}</coordinates></Point>"
    return f"<LineString><tessellate>1</tessellate><coordinates>{told}</coordinates></LineString>"
