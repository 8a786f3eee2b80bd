"""The gallery of all candidates: what its page shows, what its keys and buttons do; built when it is first asked for.

It shows the rows of the list, through the list's filter and in its order, and judges as the leaks page does.
"""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal

from app import view_data
from app.actions import ACTIONS, Needs
from app.page_host import PageHost
from app.services import Services
from processing.survey import Channel, Verdict
from widgets.gallery_panel import GalleryPanel
from widgets.gallery_pictures import GallerySound
from widgets.plot_theme import Theme
from widgets.time_axis import DistanceMap

if TYPE_CHECKING:
    from collections.abc import Mapping

    from PySide6.QtGui import QAction

    from app.main_window import MainWindow

PAGE = "gallery"
# what can be done here; all else is about one place, which the leaks page shows
REVIEWING_HERE = frozenset({
    "gallery", "confirm", "reject", "unsure", "clear", "next", "previous", "undecided", "undecided_up", "filter",
    "play", "loop", "cleaned", "band", "slow",
})  # fmt: skip
_REMEMBERED = "gallery.width"


class GalleryControl(QObject):
    """Public methods without arguments are actions' handlers."""

    failed = Signal(object)  # LeaklineError or OSError

    def __init__(self, window: "MainWindow", services: Services, host: PageHost, theme: Theme) -> None:
        super().__init__(window)
        self._session, self._preferences = services.session, services.preferences
        self._review, self._page, self._player = window.review, window.review_page, window.player
        self._host, self._theme = host, theme
        session, review_page = self._session, self._page
        self.failed.connect(window.notices.tell_error)
        self.panel: GalleryPanel | None = None
        self._version = 0
        host.openers[PAGE] = self.show
        session.results_changed.connect(self._on_results)
        session.opened.connect(self._on_results)
        for changed in (session.candidates_changed, session.filter_changed, session.decision_changed):
            changed.connect(self._show_rows)
        session.selection_changed.connect(self._show_rows)  # the selected one is shown whatever the filter says
        for changed in (review_page.spectrogram.db_range_changed, review_page.spectrogram.looks_changed):
            changed.connect(self._show_sound)

    def show(self) -> None:
        """Show the gallery, or the leaks page where it is in front already."""
        if self.in_front:
            self._host.show("leaks")
        elif self._session.results is not None:
            first, panel = self.panel is None, self.panel or self._build()
            self._host.show(PAGE)
            self._show_sound()
            self._show_rows()
            if first:
                self._choose_width(panel)
            panel.grid.setFocus()
            panel.grid.reveal()

    @property
    def in_front(self) -> bool:
        """Whether the gallery is what the window shows."""
        return self._host.current() == PAGE

    def show_enabled(self, actions_by_id: "Mapping[str, QAction]") -> None:
        """Switch off, while the gallery is in front, what is about one place that nobody sees there."""
        if not self.in_front:
            return
        for row in ACTIONS:
            if row.needs in (Needs.RESULTS, Needs.CANDIDATE) and row.id not in REVIEWING_HERE:
                actions_by_id[row.id].setEnabled(False)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        self._theme = theme
        if self.panel is not None:
            self.panel.apply_theme(theme)
            self._show_sound()

    def stop(self) -> None:
        """Read nothing more: the window closes."""
        if self.panel is not None:
            self.panel.grid.stop()

    # --- building and showing -----------------------------------------------------------------------------------

    def _build(self) -> GalleryPanel:
        panel = self.panel = GalleryPanel(self._theme)
        self._host.add(PAGE, panel)
        panel.grid.candidate_chosen.connect(self._session.select)
        panel.grid.read_failed.connect(self.failed)
        panel.open_asked.connect(self._open_candidate)
        panel.verdict_chosen.connect(self._decide)
        panel.order_chosen.connect(self._session.set_order)
        panel.filter_asked.connect(lambda: self._session.set_filter(self._session.filter.next_verdict()))
        panel.loop_asked.connect(self._player.toggle_loop)
        panel.back_asked.connect(self.show)
        return panel

    def _on_results(self) -> None:
        self._version += 1
        if self.panel is None:
            return
        self.panel.show_sound(None, (0.0, 1.0))  # what it reads from may be closed after this
        self._show_rows()
        self._show_sound()

    def _show_rows(self) -> None:
        panel, session = self.panel, self._session
        if panel is None or not self.in_front:
            return
        rows = session.rows()
        decided = sum(row.decision.verdict is not Verdict.NONE for row in rows)
        panel.show_order(session.list.order)
        panel.show_rows(session.list.shown(), len(rows), decided, filtered=session.filter.is_on)
        panel.show_selected(session.row(session.selected), writable=session.writable)

    def _show_sound(self) -> None:
        if self.panel is not None and self.in_front:
            self.panel.show_sound(self._sound(), self._page.spectrogram.db_range)

    def _sound(self) -> GallerySound | None:
        """Return what the pictures are made of: the stored tiles as the spectrogram shows them, in metres."""
        results, view = self._session.results, self._page.spectrogram
        if results is None or results.scan is None:
            return None
        source = view_data.ScanTiles(results.scan, results.clock, None)  # stored tiles only: nothing is computed afresh
        distances = DistanceMap.from_track(results.track)
        spans = [(s.start_s, s.end_s) for s in results.not_assessed if s.channel is Channel.SOUND]
        if distances is not None:
            spans = [(float(distances.chainage_at(a)), float(distances.chainage_at(b))) for a, b in spans]
        return GallerySound(
            source,
            distances,
            view_data.level_curves(results),
            tuple(spans),
            view.whole_frequency(),
            view.plane,
            view.colours,
            self._version,
        )

    # --- what the operator does ---------------------------------------------------------------------------------

    def _decide(self, verdict: Verdict) -> None:
        self._review.decide(verdict)
        if self.panel is not None:
            self.panel.grid.setFocus()

    def _open_candidate(self, candidate_id: int) -> None:
        self._session.select(candidate_id)
        self._host.show("leaks")
        self._review.go_to_candidate()

    def _choose_width(self, panel: GalleryPanel) -> None:
        """Take the size that was liked last; before anything was liked, the largest with which all are in view."""
        width = self._preferences.values.layout.get(_REMEMBERED, "")
        if width.isdecimal():
            panel.grid.set_width_index(int(width))
        else:
            panel.fit_all()
        panel.grid.width_changed.connect(self._remember)

    def _remember(self, index: int) -> None:
        layout = self._preferences.values.layout
        self._preferences.change(layout={**layout, _REMEMBERED: str(index)})
