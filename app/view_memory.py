"""Remembers where the operator left off in a survey, in its folder, and which tabs were in front."""

import logging
import math
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.errors import LeaklineError
from widgets.time_axis import AxisMode

if TYPE_CHECKING:
    from app.review_page import ReviewPage

log = logging.getLogger(__name__)
KEY = "views"  # of the folder's state
TAB = "views.tab."  # of the preferences' layout: + side + page


class ViewMemory(QObject):
    """Writes when a survey is left or the window closes; mere comfort: what cannot be read or written is let go."""

    def __init__(
        self,
        session: SurveySession,
        page: "ReviewPage",
        preferences: PreferencesStore,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._page, self._preferences = session, page, preferences
        self._awaited = session.results is None  # the first results of a survey are shown where one left off
        self._restore_tabs()
        page.tools.chosen.connect(self._note_tabs)
        session.closing.connect(self.save)
        session.opened.connect(self._on_opened)
        session.settled.connect(self._on_settled)

    def save(self) -> None:
        """Write down what is shown of the open survey."""
        session, cursor = self._session, self._session.cursor
        if session.folder is None or not session.writable or session.results is None:
            return
        row = session.row(session.selected)
        shown = {
            "time_s": cursor.time_s,
            "range_s": list(cursor.range_s),
            "range_m": list(cursor.range_m) if cursor.range_m is not None else None,
            "axis": cursor.axis_mode.value,
            "hz": list(self._page.spectrogram.frequency_range),
            "leak": row.candidate.label if row is not None else None,
        }
        try:
            state = session.folder.read_state()
            if state.get(KEY) != shown:
                session.folder.write_state({**state, KEY: shown})
        except LeaklineError as error:
            log.warning("where one left off was not written: %s", error)

    def _on_opened(self) -> None:
        self._awaited = True

    def _on_settled(self) -> None:
        folder = self._session.folder
        if not self._awaited or folder is None:
            return
        self._awaited = False
        try:
            found = folder.read_state().get(KEY)
        except LeaklineError as error:
            log.warning("where one left off was not read: %s", error)
            return
        if isinstance(found, dict):
            self._show(found)

    def _show(self, found: dict[str, Any]) -> None:
        """Show the moment, the range and the leak that were shown, each as far as it is still there."""
        session, cursor = self._session, self._session.cursor
        label = found.get("leak")
        for row in session.rows():
            if row.candidate.label == label:
                session.select(row.candidate.id, move_cursor=False)
        hz, time_s = _span(found.get("hz")), found.get("time_s")
        if hz is not None:
            self._page.spectrogram.set_frequency_range(*hz)
        axis = found.get("axis")
        if axis in {mode.value for mode in AxisMode}:
            cursor.set_axis_mode(axis)
        in_metres = cursor.axis_mode is AxisMode.DISTANCE
        span = _span(found.get("range_m" if in_metres else "range_s"))
        if span is not None:
            cursor.set_x_range(*span)
        if isinstance(time_s, int | float):
            cursor.set_time(float(time_s), reveal=False)

    def _restore_tabs(self) -> None:
        layout = self._preferences.values.layout
        self._page.tools.restore({k.removeprefix(TAB): v for k, v in layout.items() if k.startswith(TAB)})

    def _note_tabs(self) -> None:
        layout = self._preferences.values.layout
        now = {TAB + key: name for key, name in self._page.tools.in_front().items()}
        if any(layout.get(key, "") != name for key, name in now.items()):
            self._preferences.change(layout={**layout, **now})


def _span(found: object) -> tuple[float, float] | None:
    """Return two finite numbers that rise; None for anything else."""
    if not isinstance(found, list) or len(found) != 2 or not all(isinstance(v, int | float) for v in found):
        return None
    low, high = float(found[0]), float(found[1])
    return (low, high) if math.isfinite(low) and math.isfinite(high) and high > low else None
