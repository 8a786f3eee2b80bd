"""What keys and tools do to the spectrogram, and the memory of how the operator likes to see it."""

from typing import TYPE_CHECKING, TypeVar

from PySide6.QtCore import QObject

from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.settings import SoundSettings
from widgets.color_maps import COLOR_MAPS
from widgets.plot_scale import ScaleKind
from widgets.sound_selection import SoundSelection
from widgets.spectrogram_picture import Plane
from widgets.time_axis import AxisMode

if TYPE_CHECKING:
    from app.review_page import ReviewPage

Kind = TypeVar("Kind")
RANGE_STEP_DB = 3.0  # by which a key moves an end of the colours' range
RANGES = (("levels_db", Plane.SHORT), ("excess_db", Plane.EXCESS))


class SpectrogramControl(QObject):
    """Connects the spectrogram with its row of tools; public methods without arguments are actions' handlers."""

    def __init__(
        self, session: SurveySession, page: "ReviewPage", preferences: PreferencesStore, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._session, self._page, self._preferences = session, page, preferences
        self._view, self._tools = page.spectrogram, page.spectrogram_tools
        self._from_s: float | None = None  # where a selection by keys began
        self._restore()
        view, tools, cursor = self._view, self._tools, session.cursor
        tools.plane_chosen.connect(view.set_plane)
        tools.scale_chosen.connect(view.set_frequency_scale)
        tools.colours_chosen.connect(view.set_color_map)
        tools.contrast_asked.connect(self.contrast)
        tools.select_toggled.connect(self._set_select_tool)
        tools.axis_asked.connect(self.toggle_axis)
        tools.band_chosen.connect(page.band_changed)
        tools.band_reset_asked.connect(self.reset_band)
        view.looks_changed.connect(self._remember)
        view.fixed_range_chosen.connect(self._remember_range)
        view.band_shown.connect(tools.show_band)
        cursor.axis_changed.connect(self._on_axis)
        session.results_changed.connect(self._on_results)
        self._on_results()
        self._on_axis()

    # --- actions ------------------------------------------------------------------------------------------------

    def next_plane(self) -> None:
        """Short events, steady sounds, over the background."""
        self._view.set_plane(_after(list(Plane), self._view.plane))

    def next_scale(self) -> None:
        """Octaves, even, mel."""
        kinds = [ScaleKind.LOG, ScaleKind.LINEAR, ScaleKind.MEL]
        self._view.set_frequency_scale(_after(kinds, self._view.frequency_scale))

    def next_colours(self) -> None:
        """Change to the next colour table."""
        self._view.set_color_map(_after(list(COLOR_MAPS), self._view.color_map))

    def contrast(self) -> None:
        """Let the colours fit what is visible, once."""
        self._view.auto_db_range()

    def fixed_contrast(self) -> None:
        """Let the colours span the fixed range again."""
        self._view.fixed_db_range()

    def quiet_end_up(self) -> None:
        """Let the colours begin louder."""
        self._move_range("low", +RANGE_STEP_DB)

    def quiet_end_down(self) -> None:
        """Let the colours begin quieter."""
        self._move_range("low", -RANGE_STEP_DB)

    def loud_end_up(self) -> None:
        """Let the colours end louder."""
        self._move_range("high", +RANGE_STEP_DB)

    def loud_end_down(self) -> None:
        """Let the colours end quieter."""
        self._move_range("high", -RANGE_STEP_DB)

    def _move_range(self, end: str, by_db: float) -> None:
        self._view.move_db_range(end, by_db)
        self._remember_range()

    def toggle_axis(self) -> None:
        """Switch between metres and seconds, and keep that for the next time."""
        cursor = self._session.cursor
        metres = cursor.axis_mode is AxisMode.DISTANCE
        cursor.set_axis_mode(AxisMode.TIME if metres else AxisMode.DISTANCE)
        self._like(axis=cursor.axis_mode.value)
        self._on_axis()

    def toggle_select(self) -> None:
        """Let a plain drag select, or pan again."""
        self._tools.set_selecting(on=not self._view.select_tool)

    def select_here(self) -> None:
        """Begin a selection at the cursor; the second time, end it there. It holds the leak band."""
        here, start = self._session.cursor.time_s, self._from_s
        if start is None or start == here:
            self._from_s = here
            self._session.cursor.clear_selection()
            return
        self._from_s = None
        band = self._view.band_hz or self._view.frequency_range
        self._view.select(SoundSelection(min(start, here), max(start, here), band[0], band[1]))

    def reset_band(self) -> None:
        """Ask for the usual band."""
        usual = SoundSettings()
        self._page.band_changed.emit(usual.band_low_hz, usual.band_high_hz)

    # --- showing and remembering --------------------------------------------------------------------------------

    def _restore(self) -> None:
        liked, view = self._preferences.values.sound_view, self._view
        for name, kinds, setter in (
            ("scale", ScaleKind, view.set_frequency_scale),
            ("plane", Plane, view.set_plane),
        ):
            if liked.get(name) in {kind.value for kind in kinds}:
                setter(liked[name])
        view.set_color_map(liked.get("colours", view.color_map))
        plane = view.plane
        for name, of in RANGES:
            low, _, high = liked.get(name, "").partition(" ")
            try:
                ends = float(low), float(high)
            except ValueError:
                continue  # the first time, or by somebody's hand
            view.set_plane(of)
            view.set_db_range(*ends)
        view.set_plane(plane)
        self._show_looks()

    def _remember(self) -> None:
        view = self._view
        self._like(scale=view.frequency_scale.value, plane=view.plane.value, colours=view.color_map)
        self._show_looks()

    def _remember_range(self) -> None:
        name = next(name for name, of in RANGES if (of is Plane.EXCESS) == (self._view.plane is Plane.EXCESS))
        low, high = self._view.fixed_range
        self._like(**{name: f"{low:.1f} {high:.1f}"})

    def _like(self, **liked: str) -> None:
        before = self._preferences.values.sound_view
        if {**before, **liked} != before:
            self._preferences.change(sound_view={**before, **liked})

    def _show_looks(self) -> None:
        view = self._view
        self._tools.show_looks(view.plane.value, view.frequency_scale.value, view.color_map)

    def _on_results(self) -> None:
        cursor, results = self._session.cursor, self._session.results
        self._from_s = None
        self._tools.set_band_able(able=results is not None and self._session.writable)
        if results is not None:
            self._tools.show_band(results.settings.sound.band_low_hz, results.settings.sound.band_high_hz)
        liked = self._preferences.values.sound_view.get("axis")
        if results is not None and liked in {mode.value for mode in AxisMode}:
            cursor.set_axis_mode(liked)  # refused where there is no path

    def _on_axis(self) -> None:
        cursor = self._session.cursor
        self._tools.show_axis(metres=cursor.axis_mode is AxisMode.DISTANCE, able=cursor.has_distance)

    def _set_select_tool(self, on: bool) -> None:
        self._view.select_tool = on


def _after(kinds: list[Kind], present: Kind) -> Kind:
    """Return the one that follows, the first after the last."""
    return kinds[(kinds.index(present) + 1) % len(kinds)]
