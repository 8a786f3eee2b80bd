"""How the views follow the playback: page by page, with the cursor in the middle, or not at all.

A hand that moves the view while it plays is never fought: following waits until the playback comes by what is shown,
or the operator asks for it.
"""

from enum import StrEnum
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.player import Player
from app.settings import PreferencesStore
from widgets.time_cursor import TimeCursor

if TYPE_CHECKING:
    from app.review_page import ReviewPage

KEY = "views.follow"
ENTERS_AT = 0.04  # of the width: a new page begins with what is heard now
_NEAR = 0.02  # of the width: so close to the middle, centring moves nothing that one would see


class Follow(StrEnum):
    """What happens to the visible range while the cursor is moved by the playback."""

    PAGE = "page"
    CENTRE = "centre"
    NONE = "none"


class FollowControl(QObject):
    """Moves the visible range after the playback; the mode outlives the session."""

    def __init__(
        self,
        cursor: TimeCursor,
        player: Player,
        page: "ReviewPage",
        preferences: PreferencesStore,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._cursor, self._player, self._tools, self._preferences = cursor, player, page.view_tools, preferences
        found = preferences.values.layout.get(KEY, Follow.PAGE.value)
        self.mode = Follow(found) if found in {mode.value for mode in Follow} else Follow.PAGE
        self.paused = self._moving = False
        self._span = 0.0
        self._tools.follow_asked.connect(self.next_mode)
        player.played_on.connect(self._played_on)
        player.stopped.connect(self._resume)
        cursor.range_changed.connect(self._on_range)
        cursor.moved.connect(self._on_moved)
        self._show()

    def next_mode(self) -> None:
        """Go on following where a hand has moved the view; else go to the next way of following."""
        if self.paused:
            self._resume()
        else:
            modes = list(Follow)
            self.mode = modes[(modes.index(self.mode) + 1) % len(modes)]
            self._preferences.change(layout={**self._preferences.values.layout, KEY: self.mode.value})
        self._show()
        if self._player.playing:
            self._follow()

    def forget(self) -> None:
        """Go back to the usual way."""
        self.mode, self.paused = Follow.PAGE, False
        self._show()

    def _played_on(self) -> None:
        if self.paused and self._is_met():
            self._resume()
        if not self.paused:
            self._follow()

    def _is_met(self) -> bool:
        """Return whether the playback has come by what is shown, so that following on makes no jump."""
        at = self._part()
        return abs(at - 0.5) < _NEAR if self._mode_now is Follow.CENTRE else 0.0 <= at <= 1.0

    @property
    def _mode_now(self) -> Follow:
        """How the views follow just now: what is heard in a loop is shown whole, and shall not glide to and fro."""
        return Follow.PAGE if self._player.looping and self.mode is Follow.CENTRE else self.mode

    def _part(self) -> float:
        """Return where the cursor stands in the view, 0 at its left edge and 1 at its right one."""
        low, high = self._cursor.x_range
        return (float(self._cursor.x_of_time(self._cursor.time_s)) - low) / (high - low)

    def _follow(self) -> None:
        at = self._part()
        low, high = self._cursor.x_range
        if self._mode_now is Follow.CENTRE:
            by = (at - 0.5) * (high - low)
        elif self._mode_now is Follow.PAGE and not 0.0 <= at <= 1.0:
            by = (at - ENTERS_AT) * (high - low)
        else:
            by = 0.0
        self._span = high - low
        if by:
            self._moving = True
            try:
                self._cursor.pan(by)
            finally:
                self._moving = False

    def _on_range(self) -> None:
        """Take note of a hand that moves the view; one that zooms only wants to see the same closer."""
        low, high = self._cursor.x_range
        zoomed = abs((high - low) - self._span) > 1e-6 * self._span
        self._span = high - low
        if self._moving or not self._player.playing or self.mode is Follow.NONE:
            return
        centred = self._mode_now is Follow.CENTRE
        if not (centred and zoomed):
            pause = centred or not 0.0 <= self._part() <= 1.0
            if pause != self.paused:
                self.paused = pause
                self._show()

    def _on_moved(self) -> None:
        """A cursor that the operator puts somewhere is where the views shall be."""
        if self.paused and not self._player.moves_cursor:
            self._resume()

    def _resume(self) -> None:
        if self.paused:
            self.paused = False
            self._show()

    def _show(self) -> None:
        self._tools.show_follow(self.mode.value, paused=self.paused)
