"""The tour: five hints at the widgets themselves, shown once at the first start and again whenever one asks.

Nothing waits for it: the hints take no keyboard, cover nothing that they speak of, and close at a press.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer
from PySide6.QtWidgets import QWidget

from app import actions
from app.actions import ACTIONS
from app.settings import PreferencesStore
from widgets.tour_bubble import TourBubble

if TYPE_CHECKING:
    from app.main_window import MainWindow


@dataclass(frozen=True)
class Hint:
    """What is said, and the widgets that it may point at: the first that is visible."""

    title: str
    words: str
    anchors: tuple[QWidget | None, ...]


class TourControl(QObject):
    """Shows one hint at a time beside its widget."""

    def __init__(self, window: "MainWindow", preferences: PreferencesStore) -> None:
        super().__init__(window)
        self._window, self._preferences = window, preferences
        self._bubble: TourBubble | None = None
        self._at = 0
        self._later = QTimer(self)  # once the page in front has been laid out
        self._later.setSingleShot(True)
        self._later.setInterval(0)
        self._later.timeout.connect(self._place)

    @property
    def shown(self) -> TourBubble | None:
        """The hint that is shown; None while there is none."""
        return self._bubble if self._bubble is not None and self._bubble.isVisible() else None

    def offer(self) -> None:
        """Show the first hint to who has never seen the tour."""
        if not self._preferences.values.tour_seen:
            self._preferences.change(tour_seen=True)
            self._begin()

    def show(self) -> None:
        """Show the first hint; while one is shown, the next."""
        if self.shown is not None:
            self._step(+1)
            return
        self._begin()
        if self._bubble is not None:
            self._bubble.next_button.setFocus()

    def moved(self) -> None:
        """Another page is in front: point at what is visible there."""
        if self.shown is not None:
            self._later.start()

    def stop(self) -> None:
        """Leave nothing behind: the window closes."""
        self._later.stop()

    def _begin(self) -> None:
        if self._bubble is None:
            self._bubble = TourBubble(self._window)
            self._bubble.stepped.connect(self._step)
        self._at = 0
        self._place()

    def _step(self, by: int) -> None:
        self._at += by
        if self._at >= len(self.hints()):
            assert self._bubble is not None  # it is what was pressed
            self._bubble.close_bubble()
            return
        self._at = max(0, self._at)
        self._place()

    def _place(self) -> None:
        hints = self.hints()
        hint = hints[self._at]
        assert self._bubble is not None  # made in _begin
        self._bubble.set_hint(hint.title, hint.words, self._at + 1, len(hints))
        self._bubble.stand_beside(self._anchor(hint.anchors))

    def _anchor(self, widgets: Sequence[QWidget | None]) -> QWidget | None:
        return next((widget for widget in widgets if widget is not None and widget.isVisible()), None)

    def _named(self, name: str) -> QWidget | None:
        return self._window.findChild(QWidget, name)

    def hints(self) -> tuple[Hint, ...]:
        """Return the five hints, with the keys of the action table."""
        keys = {row.id: actions.shown_keys(row) for row in ACTIONS}
        return (
            Hint(
                self.tr("Begin here"),
                self.tr(
                    "Open the folder that you copied off the device ({open}), or drop it on the window. To try it "
                    "first, take the demonstration ({demo}): nothing can be broken there."
                ).format(open=keys["open"], demo=keys["demo"]),
                (self._named("start_demo"), self._named("tool_open")),
            ),
            Hint(
                self.tr("Listen"),
                self.tr(
                    "{play} plays from the cursor. {loop} plays the selected candidate again and again, with two "
                    "seconds of lead-in. What you see is what you hear."
                ).format(play=keys["play"], loop=keys["loop"]),
                (self._window.review_page.playback, self._named("page_leaks")),
            ),
            Hint(
                self.tr("One key is a verdict"),
                self.tr(
                    "{confirm} is a leak, {reject} is none, {unsure} is unsure. Each goes on to the next undecided one "
                    "and is on the disc at once."
                ).format(confirm=keys["confirm"], reject=keys["reject"], unsure=keys["unsure"]),
                (self._window.review_page.decision, self._named("page_leaks")),
            ),
            Hint(
                self.tr("Nothing is final"),
                self.tr(
                    "{undo} takes back whatever you did, one step after the other, and brings you back to where it was."
                ).format(undo=keys["undo"]),
                (self._named("tool_undo"),),
            ),
            Hint(
                self.tr("Hand it over"),
                self.tr(
                    "{export} writes the report with one dig sheet a leak, and the files for maps. The lights beside "
                    "the steps say what is missing ({missing}); {help} opens the manual. These hints: {tour}."
                ).format(export=keys["export"], missing=keys["missing"], help=keys["help"], tour=keys["tour"]),
                (self._named("tool_export"), self._named("page_report")),
            ),
        )
