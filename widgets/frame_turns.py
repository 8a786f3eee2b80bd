"""Shares the window's time among the linked views while the range moves: who is not in turn lays down what it has.

One frame paints anew as many views as fit into a few milliseconds, at least one, those first that have waited longest;
the others shift or stretch their last picture, and follow in the next turns of the event loop.
"""

from typing import Protocol

from PySide6.QtCore import QObject, QTimer
from shiboken6 import isValid

BUDGET_MS = 6.0
_FADE = 0.7  # of what a view's painting took before, in the estimate of what it will take


class TurnTaker(Protocol):
    """A view that paints only when it is its turn."""

    def refresh(self) -> None:
        """Have what is there laid down again."""


class FrameTurns(QObject):
    """Kept by what the views have in common; a turn ends when the event loop has nothing left to paint."""

    def __init__(self, parent: QObject | None = None, budget_ms: float = BUDGET_MS) -> None:
        super().__init__(parent)
        self._budget_ms = budget_ms
        self._spent_ms = 0.0
        self._waiting: list[TurnTaker] = []
        self._cost_ms: dict[int, float] = {}
        self._timer = QTimer(self)
        self._timer.setSingleShot(True)
        self._timer.timeout.connect(self._end)

    @property
    def waiting(self) -> int:
        """How many views show an older picture until their turn comes."""
        return len(self._waiting)

    def may_paint(self, view: TurnTaker) -> bool:
        """Return whether a view whose range has moved may paint anew now; if not, it will be told to refresh."""
        self._timer.start(0)
        ahead = self._waiting[: self._waiting.index(view)] if view in self._waiting else self._waiting
        if not ahead and self._spent_ms == 0.0:
            return True
        cost = sum(self._cost_ms.get(id(other), 0.0) for other in (*ahead, view))
        if self._spent_ms + cost <= self._budget_ms:
            return True
        if view not in self._waiting:
            self._waiting.append(view)
        return False

    def cost_ms(self, view: TurnTaker) -> float:
        """Return about how long a view's turn takes; 0 where it has had none."""
        return self._cost_ms.get(id(view), 0.0)

    def took(self, view: TurnTaker, milliseconds: float, *, done: bool = True) -> None:
        """Take note that a view has used its turn; one that is not ``done`` waits for the next, behind the others."""
        self._timer.start(0)
        self._spent_ms += milliseconds
        before = self._cost_ms.get(id(view), milliseconds)
        self._cost_ms[id(view)] = _FADE * before + (1.0 - _FADE) * milliseconds
        if view in self._waiting:
            self._waiting.remove(view)
        if not done:
            self._waiting.append(view)

    def _end(self) -> None:
        if self._spent_ms == 0.0 and self._waiting:
            self._waiting.pop(0)  # it was asked and did not come: hidden, or nothing of it is in sight
        self._spent_ms = 0.0
        self._waiting = [view for view in self._waiting if isValid(view)]
        for view in self._waiting:
            view.refresh()
        if self._waiting:
            self._timer.start(0)
