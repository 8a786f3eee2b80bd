"""What is left of the laptop's battery."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Battery:
    """``part`` is what is left, 0..1; ``plugged`` whether mains feed it."""

    part: float
    plugged: bool


def battery() -> Battery | None:
    """Return how the battery is; None on a computer without one, or where the system does not tell."""
    import psutil

    try:
        found = psutil.sensors_battery()
    except (AttributeError, OSError, ValueError):  # a system that has no such thing, or tells nonsense
        return None
    if found is None:
        return None
    return Battery(min(max(found.percent / 100.0, 0.0), 1.0), bool(found.power_plugged))
