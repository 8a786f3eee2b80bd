"""The review page: plan, profile, spectrogram, level and motion around one cursor, with the list and the verdicts.

Three arrangements of the same widgets: ``path`` (plan and profile large), ``sound`` (the strips large) and ``leaks``
(everything that a verdict needs).
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import Qt, QTimer, Signal
from PySide6.QtGui import QResizeEvent
from PySide6.QtWidgets import QHBoxLayout, QSplitter, QVBoxLayout, QWidget

from app import view_data
from app.page_tools import PageTools, TabTools
from processing.survey import Candidate, Decision, TiePoint, Track
from widgets.band_panel import BandPanel
from widgets.candidate_row import CandidateRow
from widgets.candidate_table import CandidateTable
from widgets.channel_panel import ChannelPanel
from widgets.clock_panel import ClockPanel
from widgets.decision_panel import DecisionPanel
from widgets.evidence_panel import EvidencePanel
from widgets.imu_view import ImuView
from widgets.level_view import LevelView
from widgets.linked_plot import Readout
from widgets.marker_panel import MarkerPanel
from widgets.method_panel import MethodPanel
from widgets.overview_strip import OverviewStrip
from widgets.parts_label import BETWEEN, PartsLabel
from widgets.path_view import PathView
from widgets.playback_bar import PlaybackBar
from widgets.plot_theme import Theme
from widgets.profile_view import ProfileView
from widgets.quality_panel import QualityPanel
from widgets.side_by_side import SideBySide
from widgets.spectrogram_tools import SpectrogramTools
from widgets.spectrogram_view import SpectrogramView
from widgets.spectrum_panel import SpectrumPanel
from widgets.tile_source import TileSource
from widgets.time_cursor import TimeCursor
from widgets.toast import Toast
from widgets.units import length_unit
from widgets.view_tools import ViewTools
from widgets.vocabulary import clock_text, length_cell, number, place_and_width

if TYPE_CHECKING:
    from processing.results import Results

READOUT_LEVEL = "dB"
AFTER_FRAME_MS = 12  # Qt paints what is due within 5 ms: what waits longer is painted after it
NARROW, LOW = 1000, 560  # pixels of the page


class ReviewPage(QWidget):
    """Holds the views and panels; knows how to show, not what to do."""

    candidate_clicked = Signal(int)
    band_changed = Signal(float, float)
    layout_changed = Signal()

    def __init__(self, cursor: TimeCursor, theme: Theme, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._cursor = cursor
        self._results: Results | None = None
        self._track: Track | None = None  # drawn: of the results, or of a newer fit
        self._rows: tuple[CandidateRow, ...] = ()
        self._marked: tuple[Sequence[Candidate], Mapping[int, Decision]] = ((), {})
        self._selected: int | None = None
        self._others_wait = False
        self._pointed: Readout | None = None
        self.path = PathView(cursor, theme)
        self.profile = ProfileView(cursor, theme)
        self.overview = OverviewStrip(cursor, theme, show_x_axis=False)
        self.spectrogram = SpectrogramView(cursor, theme, show_x_axis=False)
        self.spectrogram_tools, self.spectrum = SpectrogramTools(), SpectrumPanel(theme)
        self.level = LevelView(cursor, theme)
        self.imu = ImuView(cursor, theme)
        self.table = CandidateTable(theme)
        self.decision = DecisionPanel(theme)
        self.playback, self.view_tools = PlaybackBar(), ViewTools()
        self.methods, self.markers = MethodPanel(), MarkerPanel()
        self.quality = QualityPanel(cursor, theme)
        self.clock = ClockPanel(theme)
        self.why = EvidencePanel(theme)
        self.channels = ChannelPanel(cursor, theme)
        self.bands = BandPanel(theme)
        self._readout = PartsLabel()
        self._readout.setObjectName("readout")
        self._measured = ""
        self.strips = (self.overview, self.spectrogram, self.level, self.imu, self.profile)
        self.views = (self.path, *self.strips)
        for view in self.views:
            view.candidate_clicked.connect(self.candidate_clicked)
            view.pointed.connect(self._on_pointed)
        self.spectrogram.band_changed.connect(self.band_changed)
        cursor.moved.connect(self._show_readout)
        cursor.axis_changed.connect(self._show_readout)
        self._lay_out()
        self.toast = Toast(self)
        self._small = (False, False)  # narrow, low
        self.arrange("leaks")

    def _lay_out(self) -> None:
        self._maps = _splitter(Qt.Orientation.Vertical, "maps", self.path, self.profile)
        self._sound = QWidget()
        sound = QVBoxLayout(self._sound)
        sound.setContentsMargins(0, 0, 0, 0)
        sound.setSpacing(2)
        sound.addWidget(self.spectrogram_tools)
        sound.addWidget(self.spectrogram, 1)
        self._strips = _splitter(Qt.Orientation.Vertical, "strips", self.overview, self._sound, self.level, self.imu)
        side = QWidget()
        layout = QVBoxLayout(side)
        layout.setContentsMargins(0, 0, 0, 0)
        layout.addWidget(self.table, 1)
        layout.addWidget(self.decision)
        beside = TabTools(self._strips, self.tr("Motion"), "path_tools")
        self._side = TabTools(side, self.tr("Leaks"), "side_tools")
        self.tools = PageTools(beside, self._side, self)
        self.tools.add_tool("markers", self.tr("Tie points"), self.markers)
        self.tools.add_tool("methods", self.tr("Methods"), self.methods)
        self.tools.add_tool("quality", self.tr("Quality"), self.quality)
        self.tools.add_tool("why", self.tr("Why"), self.why, pages=("leaks", "sound"))
        self.tools.add_tool("spectrum", self.tr("Spectrum"), self.spectrum, pages=("sound",))
        self.tools.add_tool("bands", self.tr("Band"), self.bands, pages=("sound",))
        self.tools.add_tool("channels", self.tr("Channels"), self.channels, pages=("sound",))
        self.tools.add_tool("clock", self.tr("Clocks"), self.clock, pages=("sound",))
        self._columns = _splitter(Qt.Orientation.Horizontal, "columns", self._maps, beside, self._side)
        told = QWidget()
        row = QHBoxLayout(told)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.view_tools)
        row.addWidget(self._readout, 1)
        whole = QVBoxLayout(self)
        whole.setContentsMargins(6, 6, 6, 4)
        whole.setSpacing(4)
        whole.addWidget(self._columns, 1)
        whole.addWidget(SideBySide(self.playback, told))

    @property
    def splitters(self) -> dict[str, QSplitter]:
        """The splitters by name, for the memory of their places; the arrangement is part of the name."""
        found = (self._maps, self._strips, self._columns)
        return {f"{self.arrangement}.{s.objectName()}": s for s in found}

    @property
    def panels(self) -> dict[str, QWidget]:
        """What may be hidden, by name; the strips from top to bottom are ``overview`` to ``motion``."""
        views = {"plan": self.path, "profile": self.profile, "overview": self.overview, "level": self.level}
        return {**views, "sound": self._sound, "motion": self.imu, "side": self._side}

    @property
    def maps(self) -> QWidget:
        """What holds plan and profile."""
        return self._maps

    def arrange(self, arrangement: str) -> None:
        """Show ``path``, ``sound`` or ``leaks``."""
        self.arrangement = arrangement
        path, leaks = arrangement == "path", arrangement == "leaks"
        self._maps.setVisible(arrangement != "sound")
        self._side.setVisible(not path)
        self.imu.setVisible(not leaks)
        self._sound.setVisible(not path)
        self.tools.set_page(arrangement)
        self.path.set_compared_visible(path)
        self.spectrogram_tools.setVisible(arrangement == "sound")
        self.level.set_x_axis_visible(leaks)
        width, height = max(self.width(), 1000), max(self.height(), 500)
        shares = {"path": (0.55, 0.45, 0.0), "sound": (0.0, 0.64, 0.36), "leaks": (0.20, 0.47, 0.33)}[arrangement]
        self._columns.setSizes([round(width * s) for s in shares])
        strips = {"path": (0.15, 0.0, 0.3, 0.55), "sound": (0.08, 0.46, 0.19, 0.27), "leaks": (0.12, 0.53, 0.35, 0.0)}
        self._strips.setSizes([round(height * s) for s in strips[arrangement]])
        self._maps.setSizes([round(height * s) for s in ((0.7, 0.3) if path else (0.65, 0.35))])
        self.layout_changed.emit()

    @property
    def is_narrow(self) -> bool:
        """Whether plan, views and list have no room beside one another."""
        return self._small[0]

    @property
    def is_low(self) -> bool:
        """Whether all strips have no room above one another."""
        return self._small[1]

    def resizeEvent(self, event: QResizeEvent) -> None:
        """Qt: a small page shows less."""
        super().resizeEvent(event)
        frame = self.parentWidget()  # the page itself is never smaller than what it shows
        room = self.size() if frame is None else frame.size()
        small = room.width() < NARROW, room.height() < LOW
        if small != self._small:
            self._small = small
            self.layout_changed.emit()

    def focus_views(self) -> None:
        """Give the keyboard back to the views."""
        first = self.path if self.arrangement == "path" else self.spectrogram
        shown = next((view for view in (first, *self.views) if view.isVisibleTo(self)), first)
        shown.setFocus(Qt.FocusReason.OtherFocusReason)

    def fit_path(self) -> None:
        """Show the whole path in the plan."""
        self.path.fit()

    # --- content ---

    def show_results(self, results: "Results | None") -> None:
        """Show everything that a run derived; None shows empty views."""
        self._results = results
        track = self._track = results.track if results is not None else None
        stretches = results.not_assessed if results is not None else ()
        self.path.set_track(track)
        self.profile.set_track(track)
        self.imu.set_imu(results.recording.imu if results is not None else None, track)
        self.spectrogram.set_source(view_data.tiles(results))
        self.level.set_levels(view_data.level_curves(results))
        self.overview.set_level(*view_data.overview(results))
        for view in self.views:
            view.set_not_assessed(stretches)
        if results is not None:
            sound = results.settings.sound
            self.spectrogram.set_band(sound.band_low_hz, sound.band_high_hz)
            self.path.set_route(view_data.route_points(results))
            self.fit_path()
        self._show_readout()

    def show_sound(self, source: TileSource) -> None:
        """Show the sound alone, over its own time: nothing has been derived from it yet."""
        self._cursor.set_extent(source.start_s, source.end_s)
        self._cursor.fit()
        self.spectrogram.set_source(source)

    def show_track(self, track: Track, *, whole: bool) -> None:
        """Draw another path of the same run, with the leaks on it; ``whole`` lets all views and the cursor follow."""
        self._track = track
        if whole:
            self._cursor.set_track(track)
            self.profile.set_track(track)
        self.path.set_track(track)
        self.show_candidates(self._rows)
        self._show_readout()

    def show_tie_points(self, tie_points: Sequence[TiePoint]) -> None:
        """Show the known places."""
        results = self._results
        to_local = partial(view_data.to_local, results) if results is not None else None
        self.path.set_tie_points(tie_points, to_local)
        for strip in (self.imu, self.profile):
            strip.set_tie_points(tie_points)

    def show_candidates(self, rows: Sequence[CandidateRow]) -> None:
        """Mark the candidates in all views."""
        self._rows = tuple(rows)
        track, results = self._track, self._results
        candidates = [row.candidate for row in rows]
        if track is not None and results is not None and track is not results.track:
            candidates = view_data.moved(candidates, track)
        decisions = {row.candidate.id: row.decision for row in rows}
        self._marked = (candidates, decisions)
        self._first_view.set_candidates(candidates, decisions)
        self._mark_the_others()

    def select_candidate(self, candidate_id: int | None) -> None:
        """Ring one candidate in all views."""
        self._selected = candidate_id
        self._first_view.set_selected(candidate_id)
        self._mark_the_others()

    @property
    def _first_view(self) -> PathView | SpectrogramView:
        """The view that one looks at for the next verdict."""
        return self.path if self.arrangement == "path" else self.spectrogram

    def _mark_the_others(self) -> None:
        """Let the other views follow as soon as the first one is drawn: together they take several times as long."""
        if not self._others_wait:
            self._others_wait = True
            QTimer.singleShot(AFTER_FRAME_MS, self, self._mark_views)

    def _mark_views(self) -> None:
        self._others_wait = False
        for view in self.views:
            if view is not self._first_view:
                view.set_candidates(*self._marked)
                view.set_selected(self._selected)

    def apply_theme(self, theme: Theme) -> None:
        """Draw everything in this theme."""
        for view in self.views:
            view.apply_theme(theme)
        self.tools.apply_theme(theme)
        self.view_tools.redraw()
        self.table.set_theme(theme)
        self.decision.set_theme(theme)

    # --- the read-out ---

    def _on_pointed(self, readout: Readout | None) -> None:
        self._pointed = readout
        self._show_readout()

    def show_measured(self, text: str, hint: str) -> None:
        """Say below the read-out what the ruler measures; empty without one."""
        self._measured = text
        self._readout.set_hint(hint)
        self._show_readout()

    def _show_readout(self) -> None:
        self._readout.set_parts(self._readout_parts(), self._measured)

    def readout_text(self) -> str:
        """Return time, chainage ±, east, north, and under the mouse frequency and level."""
        return BETWEEN.join(text for text, _ in self._readout_parts())

    def _readout_parts(self) -> list[tuple[str, int]]:
        """Return the figures with their ranks: what is not needed for a verdict gives way first."""
        if self._results is None:
            return []
        pointed = self._pointed
        time_s = self._cursor.time_s
        if pointed is not None and pointed.time_s is not None:
            time_s = pointed.time_s
        parts = [(clock_text(time_s), 2)]
        chainage_m = self._cursor.chainage_at(time_s)
        if chainage_m is not None:
            parts.append((place_and_width(chainage_m, view_data.plus_minus_m(self._track, time_s)), 0))
        place = self._cursor.position_at(time_s)
        if place is not None:
            east, north, unit = length_cell(place[0]), length_cell(place[1]), length_unit().sign
            parts.append((self.tr("E {east}  N {north} {unit}").format(east=east, north=north, unit=unit), 3))
        if pointed is not None and pointed.frequency_hz is not None:
            parts.append((f"{number(pointed.frequency_hz, 0)} Hz", 1))
        if pointed is not None and pointed.level_db is not None:
            parts.append((f"{number(pointed.level_db, 0)} {READOUT_LEVEL}", 1))
        elif pointed is not None and pointed.value is not None:
            parts.append((f"{number(pointed.value, 1)} {pointed.unit}", 1))
        return parts


def _splitter(orientation: Qt.Orientation, name: str, *widgets: QWidget) -> QSplitter:
    splitter = QSplitter(orientation)
    splitter.setObjectName(name)
    splitter.setHandleWidth(8)
    splitter.setChildrenCollapsible(False)
    for widget in widgets:
        splitter.addWidget(widget)
    return splitter
