"""The choices of method of each processing step, for the form: names from the steps' own tables."""


def methods() -> dict[str, tuple[str, ...]]:
    """Return the names of each step's methods, ``auto`` first."""
    from processing.orientation.registry import ESTIMATORS
    from processing.position.registry import METHODS
    from processing.sound.detector_names import DETECTOR_NAMES

    return {
        "orientation": ("auto", *(row.name for row in ESTIMATORS)),
        "position": ("auto", *METHODS),
        "detector": ("auto", *DETECTOR_NAMES),
    }
