"""A leak's size in plain words, for window and report."""

import math

from processing import messages
from processing.quantities import Units
from processing.sound.sizes import LeakSize, SizeClass


def size_name(size: LeakSize, language: str) -> str:
    """Return ``small`` or ``small or medium``; empty where the size is unknown."""
    if size.size is SizeClass.UNKNOWN:
        return ""
    names = [messages.text("sizes", part, language) for part in size.name.split("-")]
    if len(names) == 1:
        return names[0]
    return messages.text("sizes", "either", language, first=names[0], second=names[1])


def size_sentence(size: LeakSize, language: str, units: Units = Units.METRIC) -> str:
    """Return the size with what it rests on; empty where it is unknown."""
    if size.size is SizeClass.UNKNOWN or size.basis == "none":
        return ""
    conditions = []
    if math.isfinite(size.speed_mps) and size.basis != "itself":
        conditions.append(messages.text_in(units, "sizes", "at_speed", language, speed=size.speed_mps))
    if size.pressure_bar is not None:
        conditions.append(messages.text_in(units, "sizes", "at_pressure", language, pressure=size.pressure_bar))
    else:
        conditions.append(messages.text_in(units, "sizes", "no_pressure", language))
    key = {"excess": "by_excess", "known_leak": "by_known", "itself": "itself"}[size.basis]
    flow = size.flow_lpm or (math.nan, math.nan)
    return messages.text_in(
        units,
        "sizes",
        key,
        language,
        size=size_name(size, language),
        level=size.level_db,
        sigma=size.sigma_db,
        low=size.band_hz[0],
        high=size.band_hz[1],
        conditions=", ".join(conditions),
        flow_low=flow[0],
        flow_high=flow[1],
    )
