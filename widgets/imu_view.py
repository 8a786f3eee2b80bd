"""Strips of what the IMU felt: specific force, turn rate, and the speed that follows; drawn from envelopes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from processing.survey import FloatArray, ImuSamples, Track
from widgets.curve_plot import Curve
from widgets.envelope import EnvelopePyramid
from widgets.latest_loader import LatestLoader
from widgets.plot_theme import LIGHT, Theme
from widgets.strips_view import StripsView, strip_of
from widgets.time_cursor import TimeCursor
from widgets.units import quantities


@dataclass(frozen=True)
class Signals:
    """The envelopes of one IMU log: norms, and the three axes of the turn rate; speed where there is a track."""

    acc_mps2: Curve
    gyr_dps: Curve
    gyr_axes_dps: tuple[Curve, Curve, Curve]
    speed: Curve | None  # m/s or ft/s, as lengths are shown


def build_signals(imu: ImuSamples, track: Track | None, factor: float = 1.0) -> Signals:
    """Return the envelopes, with speeds times ``factor``; takes a second or so for hours of samples: for a worker."""

    def curve(samples: Callable[[slice], FloatArray]) -> Curve:
        def read(start: int, stop: int) -> FloatArray:
            part = slice(start, stop)
            return np.where(imu.valid[part], samples(part), np.nan)

        return Curve(EnvelopePyramid.build(imu.time_s, read))

    def axis(number: int) -> Curve:
        return curve(lambda part: np.degrees(imu.gyr_s_radps[part, number]))

    speed = None
    if track is not None and len(track.time_s):
        speed = Curve(EnvelopePyramid.build(track.time_s, factor * track.speed_mps))
    return Signals(
        curve(lambda part: np.linalg.norm(imu.acc_s_mps2[part], axis=1)),
        curve(lambda part: np.degrees(np.linalg.norm(imu.gyr_s_radps[part], axis=1))),
        (axis(0), axis(1), axis(2)),
        speed,
    )


class ImuView(StripsView):
    """Force, turn rate and speed; the envelopes are built by a worker after :meth:`set_imu`."""

    ready = Signal()

    def __init__(
        self, cursor: TimeCursor, theme: Theme = LIGHT, parent: QWidget | None = None, *, show_x_axis: bool = True
    ) -> None:
        super().__init__(cursor, theme, parent, show_x_axis=show_x_axis)
        self.setAccessibleName(self.tr("Motion sensor"))
        self._signals: Signals | None = None
        self._axes = False
        self._loader = LatestLoader(self)
        self._loader.loaded.connect(self._take)

    def set_imu(self, imu: ImuSamples | None, track: Track | None = None) -> None:
        """Show these samples, and the speed of a track; None shows none. Waits for a build in work."""
        self._loader.stop()
        self._signals = None
        self._set_strips(())
        if imu is not None and len(imu.time_s):
            factor = quantities().length_factor
            self._loader.request(lambda: build_signals(imu, track, factor))

    def set_gyro_axes(self, shown: bool) -> None:
        """Show the turn rate about the three axes of the sensor instead of its norm."""
        self._axes = shown
        self._arrange()

    def _hint(self) -> str:
        return self.tr("Reading …") if self._loader.busy else self.tr("No motion data: the data page says why")

    def _take(self, signals: Signals) -> None:
        self._signals = signals
        self._arrange()
        self.ready.emit()

    def _arrange(self) -> None:
        if self._signals is None:
            return
        theme, signals = self._theme, self._signals
        gyr = (
            tuple(zip(signals.gyr_axes_dps, (theme.curve, theme.curve_second, theme.curve_third), strict=True))
            if self._axes
            else ((signals.gyr_dps, theme.curve),)
        )
        strips = [
            strip_of(self.tr("force"), self.tr("m/s²"), ((signals.acc_mps2, theme.curve),), 1.0),
            strip_of(self.tr("turn rate"), self.tr("°/s"), gyr, 1.0),
        ]
        if signals.speed is not None:
            unit = f"{quantities().length_unit}/s"
            strips.append(strip_of(self.tr("speed"), unit, ((signals.speed, theme.curve),), 0.1))
        self._set_strips(strips)
