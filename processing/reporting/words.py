"""The report's words in one language, and its quantities in the chosen units."""

import math
from collections.abc import Mapping

from processing import messages
from processing.quantities import Quantities
from processing.reporting.options import ReportOptions

_POINTS = 16  # of the compass rose
_STRETCHED = "\N{HORIZONTAL ELLIPSIS}"


class Words:
    """The ``[report]`` table of a language, with the quantities of the options. Numbers go in as finished texts."""

    def __init__(self, options: ReportOptions) -> None:
        self.language = options.language
        self.quantities = Quantities(options.language, options.units, options.places)
        self.table: Mapping[str, str] = messages.table("report", options.language)

    def __call__(self, key: str, **params: str | int) -> str:
        """Return one phrase, filled in; raises KeyError for an unknown key."""
        return messages.text("report", key, self.language, **params)

    def __contains__(self, key: str) -> bool:
        return key in self.table

    def length(self, metres: float | None, digits: int = 1) -> str:
        """Return a length with its unit."""
        return self.quantities.length(metres, digits)

    def place(self, chainage_m: float | None) -> str:
        """Return a place along the pipe."""
        return self.quantities.place(chainage_m)

    def span(self, start_m: float, end_m: float, digits: int = 1) -> str:
        """Return a stretch of the pipe, ``50.0 – 60.0 m``, or both stations."""
        q = self.quantities
        first, last = q.place(start_m, digits), q.place(end_m, digits)
        unit = f" {q.length_unit}"
        return f"{first.removesuffix(unit)} – {last}"

    def plus_minus(self, metres: float | None, digits: int = 1) -> str:
        """Return ``± 1.2 m``; never ± 0: what rounds to nothing is written as less than the last digit."""
        if metres is None or not math.isfinite(metres):
            return "± –"
        shown = metres * self.quantities.length_factor
        least = 10.0**-digits
        if shown < least / 2:
            return f"± < {self.quantities.number(least, digits)} {self.quantities.length_unit}"
        return f"± {self.length(metres, digits)}"

    def number(self, value: float | None, digits: int) -> str:
        """Return a number by the language."""
        return self.quantities.number(value, digits)

    def signed(self, value: float, digits: int) -> str:
        """Return a number with its sign, none for zero."""
        text = self.number(value, digits)
        return f"+{text}" if round(value, digits) > 0 else text

    def share(self, probability: float) -> str:
        """Return a probability as people write it; 0 and 100 % are never certain, so they are said as limits."""
        percent = round(100.0 * probability)
        if percent < 1:
            return self("percent_below", percent=1)
        if percent > 99:
            return self("percent_above", percent=99)
        return self("percent", percent=percent)

    def seconds(self, value: float) -> str:
        """Return a moment of the recording."""
        return f"{self.number(value, 1)} s"

    def elevation(self, metres: float) -> str:
        """Return an elevation with its unit."""
        return self.length(metres, 1)

    def bearing(self, degrees: float) -> str:
        """Return a direction as point of the compass and degrees from north."""
        names = self("compass").split()
        point = names[round(degrees / (360.0 / _POINTS)) % _POINTS]
        return f"{point} ({self.number(degrees % 360.0, 0)}°)"

    def moment(self, iso: str) -> str:
        """Return an ISO moment (UTC) to the minute: ``4 May 2026 09:30``."""
        clock = iso[11:16]
        return f"{self.quantities.day(iso)} {clock}".strip()

    def shortened(self, text: str, characters: int) -> str:
        """Return the text on one line, cut where it is too long for its box."""
        line = _one_line(text)
        return line if len(line) <= characters else line[: characters - 1].rstrip() + _STRETCHED

    def name(self, text: str, characters: int) -> str:
        """Return a name on one line; one too long loses its middle, as names of a street differ at their ends."""
        line = _one_line(text)
        if len(line) <= characters:
            return line
        tail = characters // 3
        return f"{line[: characters - tail - 1].rstrip()}{_STRETCHED}{line[-tail:].lstrip()}"


def _one_line(text: str) -> str:
    """Return the text without line ends and without characters that no page can show."""
    return "".join(c for c in " ".join(text.split()) if c.isprintable())
