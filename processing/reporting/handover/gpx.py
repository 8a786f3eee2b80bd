"""Writes ``survey.gpx`` (GPX 1.1): what a handheld receiver shows a digging crew: leaks, reference points, the path.

Places that are no leak are left out: nobody shall walk to them. There are no times: the recording knows no hour of the
day, and receivers believe what they read. Elements stand in the order of the schema, which readers insist on.
"""

from pathlib import Path

from processing.reporting.files import whole_file
from processing.reporting.handover.layers import Feature, Layer, Layers
from processing.reporting.handover.system import wgs84
from processing.reporting.handover.words import HandoverWords
from processing.reporting.handover.xml_writing import element
from processing.survey import FloatArray

FILE_NAME = "survey.gpx"
_SYMBOLS = {"leak": "Flag, Red", "suspected": "Flag, Blue"}
REFERENCE_SYMBOL = "Navaid, Green"


def write_gpx(path: Path, layers: Layers, title: str, words: HandoverWords, *, elevations: bool) -> None:
    """Write waypoints and the path in WGS 84; heights where they are elevations. Raises OSError."""
    system = wgs84(layers.system.frame)
    with whole_file(path) as file:
        file.write(
            '<?xml version="1.0" encoding="UTF-8"?>\n<gpx version="1.1" creator="Leakline" '
            'xmlns="http://www.topografix.com/GPX/1/1" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" '
            'xsi:schemaLocation="http://www.topografix.com/GPX/1/1 http://www.topografix.com/GPX/1/1/gpx.xsd">\n'
        )
        file.write(f"<metadata>{element('name', title)}{element('desc', words.about_files())}</metadata>\n")
        for layer in (layers.leaks, layers.references):
            for feature, points in zip(layer.features, layer.coordinates(system), strict=True):
                result = layer.cell(feature, "result")
                if result != "no_leak_found":
                    symbol = _SYMBOLS.get(str(result), REFERENCE_SYMBOL)
                    file.write(_waypoint(layer, feature, points, words, symbol, elevations=elevations))
        lines = layers.track.coordinates(system)
        if lines:
            file.write(f"<trk>{element('name', words.layer('track'))}<trkseg>\n")
            for i, points in enumerate(lines):
                own = points if i == 0 else points[1:]  # neighbours share their end
                file.writelines(_point("trkpt", row, elevations=elevations) + "</trkpt>\n" for row in own)
            file.write("</trkseg></trk>\n")
        file.write("</gpx>\n")


def _waypoint(
    layer: Layer, feature: Feature, points: FloatArray, words: HandoverWords, symbol: str, *, elevations: bool
) -> str:
    key = "id" if layer.name == "leaks" else "reference_name"
    name, about = words.title(layer, feature, key), words.lines(layer, feature)
    return (
        _point("wpt", points[0], elevations=elevations)
        + element("name", name)
        + element("desc", about)
        + element("sym", symbol)
        + element("type", layer.name)
        + "</wpt>\n"
    )


def _point(name: str, place: FloatArray, *, elevations: bool) -> str:
    longitude, latitude, height = (float(v) for v in place)
    told = f'<{name} lat="{latitude:.8f}" lon="{longitude:.8f}">'
    return told + (f"<ele>{height:.3f}</ele>" if elevations else "")
