"""Moves a mark of the operator's own: a step at a time, or to the cursor; everything can be undone."""

from dataclasses import replace

from PySide6.QtCore import QObject, Signal

from app.marking import candidate_at
from app.player import Player
from app.review_commands import MoveMark
from app.review_control import STEPS_A_VIEW
from app.survey_session import SurveySession
from widgets.candidate_row import CandidateRow


class MarkControl(QObject):
    """Each public method without arguments is an action's handler; they need a mark made by hand as the selection."""

    told = Signal(str)

    def __init__(self, session: SurveySession, player: Player, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._session, self._player = session, player

    def nudge_back(self) -> None:
        """Move the mark a fiftieth of what is shown towards the launch."""
        self._nudge(-1)

    def nudge_forward(self) -> None:
        """Move the mark a fiftieth of what is shown away from the launch."""
        self._nudge(+1)

    def place_at_cursor(self) -> None:
        """Put the mark where the cursor is."""
        row = self._mark()
        if row is not None:
            self._move(row, self._session.cursor.time_s, nudge=False)

    def _nudge(self, sign: int) -> None:
        row = self._mark()
        if row is None:
            return
        cursor = self._session.cursor
        low, high = cursor.x_range
        x = float(cursor.x_of_time(row.candidate.time_s)) + sign * (high - low) / STEPS_A_VIEW
        time_s = float(cursor.time_of_x(x))
        if time_s == row.candidate.time_s:  # it stood still here: metres lead nowhere, seconds do
            time_s += sign * 1.0
        first, last = cursor.extent_s
        self._move(row, min(max(time_s, first), last), nudge=True)

    def _mark(self) -> CandidateRow | None:
        row = self._session.row(self._session.selected)
        if row is None or not row.manual:
            self.told.emit(self.tr("Only a mark made by hand can be moved: select one, or press M for a new one."))
            return None
        return row

    def _move(self, row: CandidateRow, time_s: float, *, nudge: bool) -> None:
        results = self._session.results
        if results is None or time_s == row.candidate.time_s:
            return
        listening = self._player.looping
        moved = replace(candidate_at(results, time_s), leak_class=row.candidate.leak_class)
        text = self.tr("move {name}").format(name=row.name)
        self._session.push(MoveMark(self._session, text, row.candidate, moved, nudge=nudge))
        if listening:
            self._player.loop_selected()  # where it is now
