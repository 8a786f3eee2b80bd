"""Measuring between two moments in all views: what the ruler's keys do, and the figures that it tells."""

import math
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.survey_session import SurveySession
from processing.position.differences import Difference, difference_between
from widgets.units import quantities
from widgets.vocabulary import number

if TYPE_CHECKING:
    from app.review_page import ReviewPage


class MeasureControl(QObject):
    """Public methods without arguments are actions' handlers; the ruler itself belongs to the common cursor."""

    def __init__(self, session: SurveySession, page: "ReviewPage", parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._page = session, page
        self._ruler = session.cursor.ruler
        self._ruler.changed.connect(self._show)
        self._ruler.tool_changed.connect(self._on_tool)
        page.view_tools.measure_toggled.connect(self._ruler.set_tool)
        page.spectrogram_tools.select_toggled.connect(self._on_select)
        session.opened.connect(self._ruler.remove)
        session.results_changed.connect(self._ruler.remove)

    def press(self) -> None:
        """Begin measuring at the cursor, end it there, and the third time remove it."""
        self._ruler.press(self._session.cursor.time_s)

    def other_end(self) -> None:
        """Let the cursor move the ruler's other end."""
        end_s = self._ruler.take_other_end()
        if end_s is not None:
            self._session.cursor.set_time(end_s)

    def toggle_tool(self) -> None:
        """Let a drag measure, or pan again."""
        self._ruler.set_tool(not self._ruler.tool)

    def escape(self) -> bool:
        """Remove the ruler, or put its tool away; returns whether there was either."""
        if self._ruler.ends_s is not None:
            self._ruler.remove()
            return True
        if self._ruler.tool:
            self._ruler.set_tool(False)
            return True
        return False

    # --- telling ------------------------------------------------------------------------------------------------

    def difference(self) -> Difference | None:
        """Return what is measured; None without a ruler or a path."""
        results, ends = self._session.results, self._ruler.ends_s
        if results is None or results.track is None or ends is None:
            return None
        return difference_between(results.track, *ends)

    def level_step_db(self) -> float | None:
        """Return by how much it is louder at the second end than at the first; None where a level is not known."""
        if self._ruler.ends_s is None:
            return None
        first, second = (self._page.level.level_at(t) for t in self._ruler.ends_s)
        return None if first is None or second is None else second - first

    def texts(self) -> tuple[str, str]:
        """Return what stands at the ruler, and the whole of it for the line at the foot; empty without one."""
        ends, found, write = self._ruler.ends_s, self.difference(), quantities()
        if ends is None:
            return "", ""
        seconds = self.tr("{seconds} s").format(seconds=number(abs(ends[1] - ends[0]), 1))
        if found is None:
            return seconds, seconds
        short = f"{write.number(found.metres * write.length_factor, 1)} ± {write.length(found.half95_m, 1)}"
        parts = [f"Δ {short}", seconds]
        if math.isfinite(found.speed_mps):
            parts.append(f"{write.number(found.speed_mps * write.length_factor, 2)} {write.length_unit}/s")
        louder = self.level_step_db()
        if louder is not None:
            sign = "+" if louder > 0.0 else ""
            parts.append(f"{sign}{number(louder, 1)} dB")
        return f"{short}   {seconds}", "   ".join(parts)

    def _show(self) -> None:
        label, whole = self.texts()
        self._ruler.label = label
        hint = self.tr(
            "Length with its 95 % interval, time, mean speed and step in level from the first end to the second. The "
            "errors of the two ends are taken as independent, so the true interval is at most this wide: close to each "
            "other, both ends are off by nearly the same."
        )
        self._page.show_measured(whole, hint if whole else "")

    def _on_tool(self, on: bool) -> None:
        self._page.view_tools.set_measuring(on=on)
        if on:
            self._page.spectrogram_tools.set_selecting(on=False)

    def _on_select(self, on: bool) -> None:
        if on:
            self._ruler.set_tool(False)
