"""What columns, values and layers are called in words: for balloons, spreadsheets, drawings and the README."""

from processing import messages
from processing.quantities import Quantities
from processing.reporting.handover.columns import Column, ColumnKind
from processing.reporting.handover.layers import Cell, Feature, Layer
from processing.reporting.handover.xml_writing import escaped

UNIT_WORDS = {"m": "m", "ft": "ft", "ftus": "ftUS", "deg": "°", "unit": ""}
_SHORT = {
    "leaks": ("result", "verdict", "class", "chainage", "half95", "before", "before_away", "after", "after_away",
              "level", "size", "score", "dig", "note"),
    "stretches": ("stretch_status", "start", "end", "length", "border95", "leaks", "reasons"),
    "reference_points": ("reference_kind", "chainage", "sigma95"),
}  # fmt: skip


class HandoverWords:
    """The ``[handover]`` and ``[columns]`` tables of one language; ``simulated`` surveys say so on every file."""

    def __init__(self, language: str, *, simulated: bool = False) -> None:
        self.language, self.simulated = language, simulated
        self._quantities = Quantities(language)

    def __call__(self, key: str, **params: object) -> str:
        """Return one phrase of ``[handover]``."""
        return messages.text("handover", key, self.language, **params)

    def about_files(self) -> str:
        """Return the line that each file with a place for it begins with."""
        about = self("about_files")
        return f"{self('simulated')} {about}" if self.simulated else about

    def layer(self, name: str) -> str:
        """Return what a layer is called."""
        return self(f"layer_{name}")

    def heading(self, column: Column) -> str:
        """Return what a column is called, with its unit: ``Distance along the pipe (m)``."""
        text, unit = messages.text("columns", column.key, self.language), self.unit(column)
        return f"{text} ({unit})" if unit else text

    def unit(self, column: Column) -> str:
        """Return the sign of a column's unit, empty for none."""
        return UNIT_WORDS.get(column.unit, "")

    def value(self, column: Column, cell: Cell) -> str:
        """Return a cell as people read it: numbers by the language, the words of a known value; empty for none."""
        if cell is None:
            return ""
        if column.kind is ColumnKind.REAL:
            return self._quantities.number(float(cell), min(column.digits, 2) if column.unit != "deg" else 8)
        if column.key in ("used", "simulated"):
            return self("yes" if cell else "no")
        if column.key == "reasons":
            return "; ".join(messages.text("reasons", key, self.language) for key in str(cell).split("; "))
        return self.known(column.key, str(cell))

    def known(self, key: str, value: str) -> str:
        """Return the words of a value that is one of a few, such as a verdict; any other as it is."""
        return messages.table("handover", self.language).get(f"{key}_{value}", value)

    def title(self, layer: Layer, feature: Feature, key: str) -> str:
        """Return what a feature is called on a map: ``Leak 3``, ``launch``, ``no leak found``."""
        value = layer.cell(feature, key)
        if layer.name == "leaks":
            is_leak = layer.cell(feature, "result") == "leak"
            called = self("leak_title" if is_leak else "place_title", id=value)
            return f"{self('simulated_short')} {called}" if self.simulated else called
        if key == "reference_name" and layer.cell(feature, "reference_kind") == "launch":
            return self("launch")
        return self.known(key, str(value))

    def pairs(self, layer: Layer, feature: Feature) -> list[tuple[str, str]]:
        """Return what is worth reading of a feature in the field: heading and value, empty ones left out."""
        wanted = _SHORT.get(layer.name, ())
        cells = {column.key: (column, cell) for column, cell in zip(layer.columns, feature.cells, strict=True)}
        told = [(self.heading(cells[key][0]), self.value(*cells[key])) for key in wanted if key in cells]
        return [(heading, value) for heading, value in told if value]

    def lines(self, layer: Layer, feature: Feature) -> str:
        """Return the same, a line each."""
        return "\n".join(f"{heading}: {value}" for heading, value in self.pairs(layer, feature))

    def balloon(self, layer: Layer, feature: Feature) -> str:
        """Return the same as HTML, for a balloon on a map."""
        rows = "".join(
            f"<tr><td>{escaped(heading)}</td><td><b>{escaped(value)}</b></td></tr>"
            for heading, value in self.pairs(layer, feature)
        )
        warning = f"<p><b>{escaped(self('simulated'))}</b></p>" if self.simulated else ""
        return f"{warning}<table>{rows}</table>"
