"""Where in frequency the two recordings agree: coherence with the band's handles, the phase left over, the parts."""

from dataclasses import dataclass

import numpy as np
from PySide6.QtCore import QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QColor, QKeyEvent, QPainter, QPen
from PySide6.QtWidgets import QWidget

from processing.correlation.parts import PartDelays
from processing.correlation.phase_fit import PhaseLine
from processing.correlation.weighting import Band
from processing.survey import BoolArray, FloatArray
from widgets.plot_scale import Scale, ScaleKind, hertz_text, number_text
from widgets.plot_theme import LIGHT, Theme
from widgets.xy_plot import XyPlot

_GRAB_PIXELS = 14.0
_KEY_STEP = 1.05
_LOWEST_HZ = 5.0


@dataclass(frozen=True)
class ShownCoherence:
    """Frequencies (k,), coherence without bias (k,), its bound, levels in dB (k,), the tones, and the band in use."""

    frequency_hz: FloatArray
    coherence: FloatArray
    bound: float
    level_a_db: FloatArray
    level_b_db: FloatArray
    hum: BoolArray
    band: Band


class CoherencePlot(XyPlot):
    """Drag the two handles, or the band between them; left and right move it by key, up and down widen it."""

    band_moved = Signal(float, float)  # Hz: while it moves
    band_dropped = Signal(float, float)

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self._shown: ShownCoherence | None = None
        self._band = Band(20.0, 2000.0)
        self._grabbed = ""
        self._band_at_press = self._band
        self.setAccessibleName(self.tr("Coherence and band"))
        self.setToolTip(self.tr("Drag the band or its edges. By key: left and right move it, up and down widen it."))
        self.set_hint(self.tr("Here stands at which frequencies both sensors hear the same."))

    def show_coherence(self, shown: ShownCoherence) -> None:
        """Show this."""
        self._shown = shown
        if not self._grabbed:
            self._band = shown.band
        highest = float(shown.frequency_hz[-1])
        self._set_whole(Scale(min(_LOWEST_HZ, 0.1 * highest), highest, ScaleKind.LOG))
        self._y = Scale(0.0, 1.05)
        self._x_name, self._y_name = self.tr("frequency (Hz)"), self.tr("coherence")
        self.set_hint("")

    @property
    def band(self) -> Band:
        """The band as the handles stand."""
        return self._band

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        shown = self._shown
        if shown is None:
            return
        self._shade(painter, self._band.low_hz, self._band.high_hz, self._theme.band, 90)
        self._paint_level(painter, shown.frequency_hz, shown.level_a_db, shown, self._theme.curve_second)
        self._paint_level(painter, shown.frequency_hz, shown.level_b_db, shown, self._theme.curve_third)
        painter.setPen(QPen(QColor(self._theme.not_assessed), self._theme.line_width, Qt.PenStyle.DashLine))
        y = self.y_pixel(shown.bound)
        painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
        self._curve(painter, shown.frequency_hz[1:], np.maximum(shown.coherence[1:], 0.0), self._theme.curve, 1.2)
        if self._band.without_hum:
            painter.setPen(QPen(QColor(self._theme.cursor), 1.0))
            for hertz in shown.frequency_hz[shown.hum].tolist()[:400]:
                x = self.x_pixel(max(hertz, 1e-3))
                painter.drawLine(QPointF(x, rect.bottom() - 6), QPointF(x, rect.bottom()))

    def _paint_level(
        self, painter: QPainter, frequency: FloatArray, level: FloatArray, shown: ShownCoherence, colour: str
    ) -> None:
        """Draw a level, both recordings scaled alike, as a pale curve behind."""
        both = np.concatenate([shown.level_a_db[1:], shown.level_b_db[1:]])
        low, high = np.percentile(both, [2, 99.9])
        scaled = (level - low) / max(high - low, 10.0)
        pale = QColor(colour)
        pale.setAlpha(120)
        self._curve(painter, frequency[1:], scaled[1:], pale.name(QColor.NameFormat.HexArgb), 0.7)

    def _paint_over(self, painter: QPainter, rect: QRectF) -> None:
        painter.setPen(QPen(QColor(self._theme.accent), 2.0 * self._theme.line_width))
        painter.setBrush(QColor(self._theme.accent))
        for hertz in (self._band.low_hz, self._band.high_hz):
            x = self.x_pixel(hertz)
            if rect.left() - 1 <= x <= rect.right() + 1:
                painter.drawLine(QPointF(x, rect.top()), QPointF(x, rect.bottom()))
                painter.drawRoundedRect(QRectF(x - 6, rect.center().y() - 16, 12, 32), 4, 4)
        entries = [
            (self.tr("coherence"), self._theme.curve),
            (self.tr("level A"), self._theme.curve_second),
            (self.tr("level B"), self._theme.curve_third),
            (self.tr("chance (99 %)"), self._theme.not_assessed),
        ]
        self._legend(painter, rect, entries)

    # --- the handles ---

    def _begin(self, place: QPointF) -> None:
        self._grabbed = ""
        self._band_at_press = self._band
        edges = {"low": self.x_pixel(self._band.low_hz), "high": self.x_pixel(self._band.high_hz)}
        nearest = min(edges, key=lambda name: abs(edges[name] - place.x()))
        if abs(edges[nearest] - place.x()) <= _GRAB_PIXELS:
            self._grabbed = nearest
        elif edges["low"] < place.x() < edges["high"]:
            self._grabbed = "band"

    def _drag(self, place: QPointF) -> bool:
        if not self._grabbed or self._pressed is None:
            return False
        hertz, old = self.x_value(place.x()), self._band_at_press
        if self._grabbed == "low":
            self._set_band(hertz, old.high_hz)
        elif self._grabbed == "high":
            self._set_band(old.low_hz, hertz)
        else:
            factor = hertz / self.x_value(self._pressed.x())
            self._set_band(old.low_hz * factor, old.high_hz * factor)
        self.band_moved.emit(self._band.low_hz, self._band.high_hz)
        return True

    def _drop(self) -> None:
        if self._grabbed:
            self._grabbed = ""
            self.band_dropped.emit(self._band.low_hz, self._band.high_hz)

    def _set_band(self, low: float, high: float) -> None:
        low = min(max(low, self._whole.low), self._whole.high / 1.1)
        high = min(max(high, 1.1 * low), self._whole.high)
        self._band = Band(low, high, self._band.without_hum)
        self.update()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        """Move and widen the band by keys."""
        factors = {
            Qt.Key.Key_Left: (1.0 / _KEY_STEP, 1.0 / _KEY_STEP),
            Qt.Key.Key_Right: (_KEY_STEP, _KEY_STEP),
            Qt.Key.Key_Up: (1.0 / _KEY_STEP, _KEY_STEP),
            Qt.Key.Key_Down: (_KEY_STEP, 1.0 / _KEY_STEP),
        }
        factor = factors.get(Qt.Key(event.key()))
        if factor is None or event.modifiers() != Qt.KeyboardModifier.NoModifier or self._shown is None:
            super().keyPressEvent(event)
            return
        self._set_band(self._band.low_hz * factor[0], self._band.high_hz * factor[1])
        self.band_dropped.emit(self._band.low_hz, self._band.high_hz)

    def _words_at(self, place: QPointF) -> str:
        shown = self._shown
        if shown is None:
            return ""
        hertz = self.x_value(place.x())
        at = min(int(np.searchsorted(shown.frequency_hz, hertz)), len(shown.frequency_hz) - 1)
        return self.tr("{hertz} Hz · coherence {value} · A {a} dB · B {b} dB").format(
            hertz=hertz_text(round(hertz, 1), self.locale()),
            value=number_text(float(shown.coherence[at]), 3, self.locale()),
            a=number_text(float(shown.level_a_db[at]), 1, self.locale()),
            b=number_text(float(shown.level_b_db[at]), 1, self.locale()),
        )


class PhasePlot(XyPlot):
    """What the straight line leaves of the phase: about zero where the model holds; hollow where it was left out."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self._line: PhaseLine | None = None
        self.setAccessibleName(self.tr("Phase beside the fitted line"))
        self.show_line(None)

    def show_line(self, line: PhaseLine | None) -> None:
        """Show a fit; None says that there is none."""
        self._line = line
        if line is None:
            self.set_hint(self.tr("Too few frequencies agree for a fit of the phase."))
            return
        low, high = float(line.frequency_hz[0]), float(line.frequency_hz[-1])
        margin = 0.03 * (high - low)
        self._set_whole(Scale(low - margin, high + margin))
        self._y = Scale(-180.0, 180.0)
        self._x_name, self._y_name = self.tr("frequency (Hz)"), self.tr("phase left (°)")
        self.set_hint("")

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        line = self._line
        if line is None:
            return
        painter.setPen(QPen(QColor(self._theme.text), self._theme.line_width))
        zero = self.y_pixel(0.0)
        painter.drawLine(QPointF(rect.left(), zero), QPointF(rect.right(), zero))
        degrees, sigma = np.degrees(line.phase_rad), np.degrees(line.phase_sigma_rad)
        rows = zip(line.frequency_hz.tolist(), degrees.tolist(), sigma.tolist(), line.weight.tolist(), strict=True)
        for hertz, phase, spread, weight in rows:
            x = self.x_pixel(hertz)
            colour = QColor(self._theme.curve if weight > 0.05 else self._theme.not_assessed)
            painter.setPen(QPen(colour, self._theme.line_width))
            painter.drawLine(QPointF(x, self.y_pixel(phase - spread)), QPointF(x, self.y_pixel(phase + spread)))
            painter.setBrush(colour if weight > 0.05 else QColor(self._theme.canvas))
            painter.drawEllipse(QPointF(x, self.y_pixel(phase)), 3.5, 3.5)


class PartsPlot(XyPlot):
    """The delay in each part of the recording: a leak is there all the time, at one delay."""

    def __init__(self, theme: Theme = LIGHT, parent: QWidget | None = None) -> None:
        super().__init__(theme, parent)
        self._parts: PartDelays | None = None
        self._delay_s = 0.0
        self.setAccessibleName(self.tr("Delay in each part of the recording"))
        self.show_parts(None, 0.0)

    def show_parts(self, parts: PartDelays | None, delay_s: float) -> None:
        """Show the parts beside the delay of the whole."""
        self._parts, self._delay_s = parts, delay_s
        if parts is None or not len(parts.time_s):
            self.set_hint(self.tr("Here stands whether the sound is there all the time."))
            return
        times = parts.time_s
        margin = 0.5 * float(times[-1] - times[0]) / max(len(times) - 1, 1) + 0.5
        self._set_whole(Scale(float(times[0]) - margin, float(times[-1]) + margin))
        away = 1e3 * np.abs(parts.delay_s - delay_s)
        reach = max(float(np.max(away[parts.present], initial=0.0)), 3e3 * float(np.median(parts.sigma_s)), 0.05)
        reach = min(reach, 1e4)
        self._y = Scale(1e3 * delay_s - 1.3 * reach, 1e3 * delay_s + 1.3 * reach)
        self._x_name, self._y_name = self.tr("seconds of the recording"), self.tr("delay (ms)")
        self.set_hint("")

    def _paint_data(self, painter: QPainter, rect: QRectF) -> None:
        parts = self._parts
        if parts is None:
            return
        painter.setPen(QPen(QColor(self._theme.cursor), self._theme.line_width))
        y = self.y_pixel(1e3 * self._delay_s)
        painter.drawLine(QPointF(rect.left(), y), QPointF(rect.right(), y))
        rows = zip(
            parts.time_s.tolist(), parts.delay_s.tolist(), parts.sigma_s.tolist(), parts.present.tolist(), strict=True
        )
        for time_s, delay_s, sigma_s, present in rows:
            x, middle = self.x_pixel(time_s), 1e3 * delay_s
            colour = QColor(self._theme.curve if present else self._theme.not_assessed)
            painter.setPen(QPen(colour, self._theme.line_width))
            spread = min(1e3 * sigma_s, 1e5)
            if present:
                painter.drawLine(QPointF(x, self.y_pixel(middle - spread)), QPointF(x, self.y_pixel(middle + spread)))
            painter.setBrush(colour if present else QColor(self._theme.canvas))
            painter.drawEllipse(QPointF(x, self.y_pixel(middle)), 4.5, 4.5)

    def _paint_over(self, painter: QPainter, rect: QRectF) -> None:
        entries = [
            (self.tr("heard"), self._theme.curve),
            (self.tr("not heard"), self._theme.not_assessed),
        ]
        self._legend(painter, rect, entries)
