"""The choices of method of each processing step, for the form and the comparison: names, titles and plain words."""

from processing import messages
from processing.method_names import ORIENTATION_NAMES, POSITION_NAMES
from processing.sound.detector_names import DETECTOR_NAMES
from widgets.method_panel import MethodRow

# (names, table of titles, table of plain words) of each step; the window must not load the methods to name them
_STEPS = {
    "orientation": (ORIENTATION_NAMES, "orientation", "method_words"),
    "position": (POSITION_NAMES, "position_titles", "position_words"),
    "detector": (DETECTOR_NAMES, "detector_titles", "detector_words"),
}


def methods(language: str) -> dict[str, tuple[MethodRow, ...]]:
    """Return each step's methods in the window's language, ``auto`` first (its title is the form's own)."""
    return {step: _rows(step, language) for step in _STEPS}


def _rows(step: str, language: str) -> tuple[MethodRow, ...]:
    names, titles, words = _STEPS[step]
    auto = MethodRow("auto", "", messages.text(words, "auto", language))
    return auto, *(
        MethodRow(name, messages.text(titles, name, language), messages.text(words, name, language)) for name in names
    )
