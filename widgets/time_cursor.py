"""The linked cursor: one moment, one visible range, one selection, in seconds and in metres, that all views follow."""

import math

import numpy as np
from PySide6.QtCore import QObject, Signal

from processing.survey import FloatArray, Track
from widgets.frame_turns import FrameTurns
from widgets.ruler import Ruler
from widgets.time_axis import AxisMode, DistanceMap

LEAST_SPAN_S = 0.002
LEAST_SPAN_M = 0.01


class TimeCursor(QObject):
    """Holds what all views share. Setting what is already set emits nothing, so views may follow each other freely.

    The range is kept in both units: the one that was set is exact, the other is derived from it, and a mere change of
    the axis mode touches neither. So nothing drifts, however often one switches.
    """

    moved = Signal(float)  # survey seconds
    range_changed = Signal(float, float)  # survey seconds
    axis_changed = Signal()  # mode, track or extent: whatever was drawn along the axis is void
    selection_changed = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.turns = FrameTurns(self)  # of the views that follow
        self.ruler = Ruler(self)
        self.moved.connect(self.ruler.follow)
        self._map: DistanceMap | None = None
        self._track: Track | None = None
        self._mode = AxisMode.TIME
        self._extent_s = (0.0, 1.0)
        self._range_s = (0.0, 1.0)
        self._range_m = (0.0, 1.0)
        self._time_s = 0.0
        self._selection_s: tuple[float, float] | None = None

    # --- what is ------------------------------------------------------------------------------------------------

    @property
    def time_s(self) -> float:
        """The moment, in survey seconds."""
        return self._time_s

    @property
    def chainage_m(self) -> float | None:
        """The moment, in metres along the pipe; None without a track."""
        return self.chainage_at(self._time_s)

    @property
    def range_s(self) -> tuple[float, float]:
        """The visible range in survey seconds."""
        return self._range_s

    @property
    def range_m(self) -> tuple[float, float] | None:
        """The visible range in metres; None without a track."""
        return self._range_m if self._map is not None else None

    @property
    def extent_s(self) -> tuple[float, float]:
        """From where to where there is anything to see, in survey seconds."""
        return self._extent_s

    @property
    def axis_mode(self) -> AxisMode:
        """What the common axis counts."""
        return self._mode

    @property
    def has_distance(self) -> bool:
        """Whether the axis can count metres."""
        return self._map is not None

    @property
    def x_range(self) -> tuple[float, float]:
        """The visible range in the unit of the axis."""
        return self._range_m if self._mode is AxisMode.DISTANCE else self._range_s

    @property
    def x_extent(self) -> tuple[float, float]:
        """The whole extent in the unit of the axis."""
        return self._extent_m() if self._mode is AxisMode.DISTANCE else self._extent_s

    @property
    def selection_s(self) -> tuple[float, float] | None:
        """The selected span in survey seconds."""
        return self._selection_s

    def chainage_at(self, time_s: float) -> float | None:
        """Return metres at survey seconds; None without a track."""
        return float(self._map.chainage_at(time_s)) if self._map is not None else None

    def position_at(self, time_s: float) -> tuple[float, float, float] | None:
        """Return east, north, up in metres at survey seconds; None without a track."""
        if self._track is None or len(self._track.time_s) == 0:
            return None
        axes = self._track.position_w_m.T
        east, north, up = (float(np.interp(time_s, self._track.time_s, axis)) for axis in axes)
        return east, north, up

    def x_of_time(self, time_s: FloatArray | float) -> FloatArray:
        """Return places on the axis of moments."""
        if self._mode is AxisMode.DISTANCE and self._map is not None:
            return self._map.chainage_at(time_s)
        return np.asarray(time_s, dtype=np.float64)

    def time_of_x(self, x: FloatArray | float) -> FloatArray:
        """Return the moments of places on the axis; where the device stood still, when it arrived."""
        if self._mode is AxisMode.DISTANCE and self._map is not None:
            return self._map.first_time_at(x)
        return np.asarray(x, dtype=np.float64)

    def x_of_chainage(self, chainage_m: FloatArray | float) -> FloatArray:
        """Return places on the axis of metres; NaN where the axis counts time and there is no track."""
        if self._mode is AxisMode.DISTANCE:
            return np.asarray(chainage_m, dtype=np.float64)
        if self._map is None:
            return np.full(np.shape(chainage_m), np.nan)
        metres = np.asarray(chainage_m, dtype=np.float64)
        return np.where(np.isfinite(metres), self._map.first_time_at(np.nan_to_num(metres)), np.nan)

    def column_edges_s(self, columns: int, *, whole: bool = False) -> FloatArray:
        """Return ``columns + 1`` moments, never falling, that bound the pixel columns of the visible or whole range.

        A stretch without movement belongs, when the axis counts metres, to the one column it happened in.
        """
        low, high = self.x_extent if whole else self.x_range
        edges = np.linspace(low, high, columns + 1)
        if self._mode is AxisMode.TIME or self._map is None:
            return edges
        times = self._map.first_time_at(edges)
        times[0], times[-1] = self._extent_s if whole else self._range_s
        return np.maximum.accumulate(times)

    def edges_s(self, low: float, high: float, columns: int) -> FloatArray:
        """Return ``columns + 1`` moments as :meth:`column_edges_s` does, of any span of the axis in its own unit."""
        if (low, high) == self.x_range:
            return self.column_edges_s(columns)
        edges = np.linspace(low, high, columns + 1)
        if self._mode is AxisMode.TIME or self._map is None:
            return edges
        first, last = self.x_extent
        times = self._map.first_time_at(edges)
        # what was heard while it stood at the end of the span, or at an end of the pipe, belongs to it
        times[-1] = self._extent_s[1] if high >= last else float(self._map.last_time_at(high))
        times[0] = self._extent_s[0] if low <= first else times[0]
        return np.maximum.accumulate(times)

    # --- what it shows ------------------------------------------------------------------------------------------

    def set_extent(self, start_s: float, end_s: float) -> None:
        """Say from where to where there is data, and show all of it."""
        if not (math.isfinite(start_s) and math.isfinite(end_s)):
            return
        self._extent_s = (start_s, max(end_s, start_s + LEAST_SPAN_S))
        self._selection_s = None
        self.ruler.remove()
        self._time_s = min(max(self._time_s, self._extent_s[0]), self._extent_s[1])
        self._range_s, self._range_m = self._extent_s, self._extent_m()
        self.axis_changed.emit()
        self.range_changed.emit(*self._range_s)
        self.moved.emit(self._time_s)
        self.selection_changed.emit()

    def set_track(self, track: Track | None) -> None:
        """Take the map between time and metres from a track; the visible seconds stay where they are."""
        self._track = track
        self._map = DistanceMap.from_track(track)
        if self._map is None:
            self._mode = AxisMode.TIME
        self._derive_metres()
        if self._mode is AxisMode.DISTANCE:
            self._apply_x(*self._range_m)
        self.axis_changed.emit()
        self.range_changed.emit(*self._range_s)

    def set_axis_mode(self, mode: AxisMode | str) -> bool:
        """Let the axis count time or metres; False where there is no track to count metres by."""
        wanted = AxisMode(mode)
        if wanted is AxisMode.DISTANCE and self._map is None:
            return False
        if wanted is self._mode:
            return True
        self._mode = wanted
        low, high = self.x_range
        if high - low < self._least_span():  # it stood still all along: metres need some width to be drawn
            self._apply_x(low, high)
        self.axis_changed.emit()
        self.range_changed.emit(*self._range_s)
        return True

    def set_range(self, start_s: float, end_s: float) -> None:
        """Show these survey seconds, as far as there is data."""
        if self._mode is AxisMode.DISTANCE and self._map is not None:
            self.set_x_range(float(self._map.chainage_at(start_s)), float(self._map.chainage_at(end_s)))
        else:
            self.set_x_range(start_s, end_s)

    def set_x_range(self, low: float, high: float) -> None:
        """Show this span of the axis, in its own unit, as far as there is data."""
        if not (math.isfinite(low) and math.isfinite(high)):
            return
        before = (self._range_s, self._range_m)
        self._apply_x(min(low, high), max(low, high))
        if (self._range_s, self._range_m) != before:
            self.range_changed.emit(*self._range_s)

    def pan(self, dx: float) -> None:
        """Move the visible range along the axis by ``dx`` in its own unit, without changing its width."""
        low, high = self.x_range
        first, last = self.x_extent
        dx = min(max(dx, first - low), last - high)
        self.set_x_range(low + dx, high + dx)

    def zoom(self, factor: float, about_x: float | None = None) -> None:
        """Multiply the visible span by ``factor``; ``about_x`` (else the cursor, if visible) stays where it is."""
        low, high = self.x_range
        fixed = float(self.x_of_time(self._time_s)) if about_x is None else about_x
        if not low <= fixed <= high:
            fixed = (low + high) / 2.0
        first, last = self.x_extent
        span = min(max((high - low) * factor, self._least_span()), last - first)
        part = (fixed - low) / (high - low)
        start = min(max(fixed - part * span, first), last - span)
        self.set_x_range(start, start + span)

    def fit(self) -> None:
        """Show everything."""
        self.set_x_range(*self.x_extent)

    def reveal(self, time_s: float | None = None) -> None:
        """Scroll so that a moment (else the cursor) is visible; nothing moves where it already is."""
        x = float(self.x_of_time(self._time_s if time_s is None else time_s))
        low, high = self.x_range
        if math.isfinite(x) and not low <= x <= high:
            # it enters at a fifth of the width: what follows is what one wants to see
            ahead = 0.2 if x > high else 0.8
            self.pan(x - low - ahead * (high - low))

    # --- where it stands ----------------------------------------------------------------------------------------

    def set_time(self, time_s: float, *, reveal: bool = True) -> None:
        """Move the cursor to a moment, within the extent; what is not a number moves nothing."""
        if not math.isfinite(time_s):
            return
        time_s = min(max(float(time_s), self._extent_s[0]), self._extent_s[1])
        if time_s != self._time_s:
            self._time_s = time_s
            self.moved.emit(time_s)
        if reveal:
            self.reveal()

    def move_by(self, seconds: float) -> None:
        """Move the cursor by seconds."""
        self.set_time(self._time_s + seconds)

    def set_selection(self, start_s: float, end_s: float) -> None:
        """Select a span of survey seconds, in either order, within the extent."""
        first, last = self._extent_s
        ends = sorted((min(max(start_s, first), last), min(max(end_s, first), last)))
        if all(map(math.isfinite, ends)) and self._selection_s != (ends[0], ends[1]):
            self._selection_s = (ends[0], ends[1])
            self.selection_changed.emit()

    def clear_selection(self) -> None:
        """Select nothing."""
        if self._selection_s is not None:
            self._selection_s = None
            self.selection_changed.emit()

    # --- the two units ------------------------------------------------------------------------------------------

    def _extent_m(self) -> tuple[float, float]:
        if self._map is None:
            return (0.0, 1.0)
        first, last = self._map.chainage_at(self._extent_s[0]), self._map.chainage_at(self._extent_s[1])
        return float(first), float(max(last, first + LEAST_SPAN_M))

    def _least_span(self) -> float:
        first, last = self.x_extent
        return min(LEAST_SPAN_M if self._mode is AxisMode.DISTANCE else LEAST_SPAN_S, last - first)

    def _apply_x(self, low: float, high: float) -> None:
        """Clamp a range in the unit of the axis and keep it, with what it is in the other unit."""
        first, last = self.x_extent
        least = self._least_span()
        if high - low < least:
            low, high = (low + high - least) / 2.0, (low + high + least) / 2.0
        if high - low >= last - first:
            low, high = first, last
        elif low < first:
            low, high = first, first + (high - low)
        elif high > last:
            low, high = last - (high - low), last
        if self._mode is AxisMode.TIME or self._map is None:
            self._range_s = (low, high)
            self._derive_metres()
        else:
            start_s, end_s = float(self._map.first_time_at(low)), float(self._map.last_time_at(high))
            # sound before the launch and after the retrieval belongs to the ends of the pipe
            start_s = self._extent_s[0] if low <= first else start_s
            end_s = self._extent_s[1] if high >= last else end_s
            self._range_m, self._range_s = (low, high), (start_s, max(end_s, start_s + LEAST_SPAN_S))

    def _derive_metres(self) -> None:
        if self._map is not None:
            start_m, end_m = self._map.chainage_at(np.asarray(self._range_s))
            self._range_m = (float(start_m), float(end_m))
