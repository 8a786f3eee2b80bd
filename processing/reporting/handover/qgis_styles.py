"""QGIS styles of the layers, as QGIS keeps them in a GeoPackage: each result has its colour, leaks have their number.

The colours are those of the report's maps.
"""

from collections.abc import Callable
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

from processing.reporting.handover.layers import Layer, Shape


@dataclass(frozen=True)
class Look:
    """How one value is drawn: colour as #rrggbb, width in mm of a line or size of a point, the form of a point."""

    value: str
    colour: str
    size_mm: float
    form: str = "circle"


@dataclass(frozen=True)
class LayerLook:
    """By which column (its key) a layer is coloured, and what is written beside (empty: nothing)."""

    key: str
    label_key: str
    looks: tuple[Look, ...]


STYLES = {
    "leaks": LayerLook(
        "result",
        "id",
        (
            Look("leak", "#b3001b", 5.0),
            Look("suspected", "#7a1fa2", 4.0, "diamond"),
            Look("no_leak_found", "#6b7680", 2.0, "cross2"),
        ),
    ),
    "stretches": LayerLook(
        "stretch_status",
        "",
        (
            Look("leak", "#b3001b", 1.6),
            Look("suspected", "#f2a900", 1.6),
            Look("no_leak_found", "#1b7f3b", 0.8),
            Look("not_assessed", "#9aa4ad", 1.6),
        ),
    ),
    "reference_points": LayerLook(
        "reference_kind",
        "reference_name",
        (
            Look("launch", "#0b3d2e", 4.0, "triangle"),
            Look("chainage", "#0b3d2e", 3.0, "square"),
            Look("coordinates", "#0b3d2e", 3.0, "square"),
        ),
    ),
}


def style(layer: Layer, name_of: Callable[[str, str], str]) -> str:
    """Return the QML of a layer; ``name_of`` (column key, value) gives the words of its legend."""
    look = STYLES[layer.name]
    column = next(column.name for column in layer.columns if column.key == look.key)
    categories, symbols = [], []
    for i, one in enumerate(look.looks):
        label = quoteattr(name_of(look.key, one.value))
        categories.append(f'<category render="true" symbol="{i}" value={quoteattr(one.value)} label={label}/>')
        symbols.append(_symbol(i, one, layer.shape))
    written = next((column.name for column in layer.columns if column.key == look.label_key), None)
    return (
        "<!DOCTYPE qgis PUBLIC 'http://mrcc.com/qgis.dtd' 'SYSTEM'>\n"
        f'<qgis version="3.22" styleCategories="Symbology|Labeling" labelsEnabled="{int(written is not None)}">\n'
        f'<renderer-v2 type="categorizedSymbol" attr={quoteattr(column)} symbollevels="0" enableorderby="0">\n'
        f"<categories>{''.join(categories)}</categories>\n<symbols>{''.join(symbols)}</symbols>\n</renderer-v2>\n"
        f"{_label(written) if written is not None else ''}</qgis>\n"
    )


def _symbol(number: int, look: Look, shape: Shape) -> str:
    red, green, blue = (int(look.colour[i : i + 2], 16) for i in (1, 3, 5))
    colour = f"{red},{green},{blue},255"
    if shape is Shape.POINT:
        options = {
            "color": colour, "name": look.form, "outline_color": "255,255,255,255", "outline_style": "solid",
            "outline_width": "0.4", "outline_width_unit": "MM", "size": f"{look.size_mm}", "size_unit": "MM",
        }  # fmt: skip
        return _symbol_xml(number, "marker", "SimpleMarker", options)
    options = {
        "line_color": colour, "line_style": "solid", "line_width": f"{look.size_mm}", "line_width_unit": "MM",
        "capstyle": "flat", "joinstyle": "round",
    }  # fmt: skip
    return _symbol_xml(number, "line", "SimpleLine", options)


def _symbol_xml(number: int, kind: str, layer_class: str, options: dict[str, str]) -> str:
    told = "".join(f'<Option name="{name}" type="QString" value="{value}"/>' for name, value in options.items())
    return (
        f'<symbol type="{kind}" name="{number}" alpha="1" clip_to_extent="1" force_rhr="0">'
        f'<layer class="{layer_class}" enabled="1" locked="0" pass="0"><Option type="Map">{told}</Option></layer>'
        "</symbol>"
    )


def _label(column: str) -> str:
    return (
        '<labeling type="simple"><settings calloutType="simple">'
        f'<text-style fieldName={quoteattr(column)} isExpression="0" fontSize="10" fontSizeUnit="Point" '
        'fontWeight="75" textColor="20,20,20,255">'
        '<text-buffer bufferDraw="1" bufferSize="1" bufferSizeUnits="MM" bufferColor="255,255,255,255"/></text-style>'
        '<placement placement="6" dist="1" distUnits="MM"/></settings></labeling>\n'
    )
