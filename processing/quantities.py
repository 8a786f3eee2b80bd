"""Numbers, lengths, places and dates as people read them: language, metric or US units, chainage or stationing.

For windows and reports only: files always have a point and the unit that their column names.
"""

import math
from dataclasses import dataclass
from datetime import date
from enum import StrEnum

METRES_PER_US_FOOT = 1200.0 / 3937.0  # the US survey foot; the international one differs by 2 ppm, 2 mm in a kilometre
PSI_PER_BAR = 14.503774
GALLONS_PER_LITRE = 1.0 / 3.785411784
MINUS = "\N{MINUS SIGN}"


class Units(StrEnum):
    """What lengths are told in."""

    METRIC = "metric"
    US = "us"


class Places(StrEnum):
    """How a place along the pipe is told: ``123.4 m``, or as on plans ``0+123.4`` (US: hundreds of feet)."""

    CHAINAGE = "chainage"
    STATIONING = "stationing"


@dataclass(frozen=True)
class Quantities:
    """How to write quantities; unknown ones (None, NaN) are a dash."""

    language: str = "en"
    units: Units = Units.METRIC
    places: Places = Places.CHAINAGE

    @property
    def length_unit(self) -> str:
        """``m`` or ``ft``."""
        return "ft" if self.units is Units.US else "m"

    @property
    def length_factor(self) -> float:
        """By which metres are multiplied to be shown: for axes."""
        return 1.0 / METRES_PER_US_FOOT if self.units is Units.US else 1.0

    def to_metres(self, shown: float) -> float:
        """Return metres of a length as it is shown and typed."""
        return shown / self.length_factor

    def number(self, value: float | None, digits: int) -> str:
        """Return a number by the language, with a true minus and never a minus zero."""
        if value is None or not math.isfinite(value):
            return "–"
        text = f"{round(float(value), digits) + 0.0:,.{digits}f}".replace("-", MINUS)
        if self.language == "tr":
            text = text.translate(str.maketrans(",.", ".,"))
        return text

    def length(self, metres: float | None, digits: int = 1) -> str:
        """Return a length with its unit; ``digits`` are those of metres (feet get as many)."""
        if metres is None or not math.isfinite(metres):
            return "–"
        return f"{self.number(metres * self.length_factor, digits)} {self.length_unit}"

    def small_length(self, metres: float | None) -> str:
        """Return a diameter or radius: millimetres, or inches."""
        if metres is None or not math.isfinite(metres):
            return "–"
        if self.units is Units.US:
            return f"{self.number(metres / 0.0254, 1)} in"
        return f"{self.number(metres * 1000.0, 0)} mm"

    def place(self, chainage_m: float | None, digits: int = 1) -> str:
        """Return a place along the pipe: ``1,234.5 m``, or a station, ``1+234.5``."""
        if chainage_m is None or not math.isfinite(chainage_m):
            return "–"
        if self.places is Places.CHAINAGE:
            return self.length(chainage_m, digits)
        step = 100 if self.units is Units.US else 1000
        value = round(abs(chainage_m) * self.length_factor, digits)
        whole, rest = divmod(value, step)
        width = len(str(step - 1)) + (digits + 1 if digits else 0)
        point = "," if self.language == "tr" else "."
        sign = MINUS if chainage_m < 0.0 and value > 0.0 else ""
        return f"{sign}{int(whole)}+{rest:0{width}.{digits}f}".replace(".", point)

    def pressure(self, bar: float | None) -> str:
        """Return a pressure with its unit."""
        if bar is None or not math.isfinite(bar):
            return "–"
        return f"{self.number(bar * PSI_PER_BAR, 0)} psi" if self.units is Units.US else f"{self.number(bar, 1)} bar"

    def flow(self, litres_per_minute: float | None) -> str:
        """Return a flow with its unit."""
        if litres_per_minute is None or not math.isfinite(litres_per_minute):
            return "–"
        a_minute = "dak" if self.language == "tr" else "min"
        if self.units is Units.US:
            return f"{self.number(litres_per_minute * GALLONS_PER_LITRE, 1)} gal/{a_minute}"
        return f"{self.number(litres_per_minute, 1)} L/{a_minute}"

    def day(self, iso: str) -> str:
        """Return an ISO day as people write it: 04.05.2026 in Turkish, 4 May 2026 in English; else as it is."""
        try:
            when = date.fromisoformat(iso[:10])
        except ValueError:
            return iso
        if self.language == "tr":
            return f"{when.day:02d}.{when.month:02d}.{when.year}"
        months = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
        return f"{when.day} {months[when.month - 1]} {when.year}"
