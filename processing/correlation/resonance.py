"""Resonances of a sensor or its fitting, found in one recording only, and divided out of the cross-spectrum.

After Gao, Brennan, Liu, Almeida and Joseph, Applied Acoustics 127 (2017) 24: a resonance beside one sensor narrows the
usable band, makes the correlation ring and turns the phase by 180° across it; dividing by the resonator's response
brings both back. A hill that stands in both recordings is left alone: it may be the leak's own.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from scipy import optimize, signal

from processing.correlation.spectra import ComplexArray, CrossSpectra, smoothed
from processing.correlation.weighting import Band
from processing.survey import FloatArray

_LEAST_DB = 6.0
_MOST = 3
_DAMPING = (0.005, 0.35)
_GROUND_OCTAVES = 1.5


class Sensor(StrEnum):
    """Which of the two."""

    A = "a"
    B = "b"


@dataclass(frozen=True)
class Resonance:
    """A single resonator: frequency, damping as a part of the critical, and beside which sensor."""

    frequency_hz: float
    damping: float
    sensor: Sensor

    def response(self, frequency_hz: FloatArray) -> ComplexArray:
        """Return its response (k,), 1 far below the resonance."""
        ratio = frequency_hz / self.frequency_hz
        return np.asarray(1.0 / (1.0 - ratio**2 + 2j * self.damping * ratio))


def find_resonances(spectra: CrossSpectra, band: Band) -> tuple[Resonance, ...]:
    """Return up to three resonances within the band that one recording has and the other has not."""
    frequency = spectra.frequency_hz
    inside = (frequency >= band.low_hz) & (frequency <= band.high_hz)
    if np.count_nonzero(inside) < 40:
        return ()
    places = frequency[inside]
    ratio_db = 10.0 * np.log10(np.maximum(spectra.smooth_aa, 1e-300) / np.maximum(spectra.smooth_bb, 1e-300))[inside]
    found: list[tuple[float, Resonance]] = []
    for sensor, sign in ((Sensor.A, 1.0), (Sensor.B, -1.0)):
        hill = sign * (ratio_db - _ground(places, ratio_db))
        tops, facts = signal.find_peaks(hill, height=_LEAST_DB, prominence=_LEAST_DB)
        for top, height in zip(tops.tolist(), facts["peak_heights"].tolist(), strict=True):
            resonance = _fit(places, sign * ratio_db, top, sensor)
            if resonance is not None:
                found.append((height, resonance))
    found.sort(key=lambda pair: -pair[0])
    return tuple(resonance for _, resonance in found[:_MOST])


def _ground(frequency_hz: FloatArray, level_db: FloatArray) -> FloatArray:
    """Return the broad course of a level over log frequency, without hills narrower than an octave and a half."""
    octave = np.log2(frequency_hz)
    even = np.linspace(octave[0], octave[-1], 400)
    course = np.interp(even, octave, level_db)
    window = max(3, round(_GROUND_OCTAVES * 400 / max(octave[-1] - octave[0], 1e-6)) | 1)
    kept = signal.medfilt(np.pad(course, window, mode="edge"), min(window, 399))[window:-window]
    return np.asarray(np.interp(octave, even, smoothed(kept, 21)))


def _fit(frequency_hz: FloatArray, level_db: FloatArray, top: int, sensor: Sensor) -> Resonance | None:
    """Fit resonator, constant and slope to a level about a hill; None where no resonator looks like it."""
    centre = float(frequency_hz[top])
    near = (frequency_hz > centre / 1.6) & (frequency_hz < centre * 1.6)
    if np.count_nonzero(near) < 8:
        return None
    places, levels = frequency_hz[near], level_db[near]

    def off(parameters: FloatArray) -> FloatArray:
        resonator = Resonance(math.exp(parameters[0]), math.exp(parameters[1]), sensor)
        model = 20.0 * np.log10(np.abs(resonator.response(places)))
        return np.asarray(model + parameters[2] + parameters[3] * np.log2(places / centre) - levels)

    start = np.array([math.log(centre), math.log(0.05), float(np.min(levels)), 0.0])
    low = [math.log(centre / 1.15), math.log(_DAMPING[0]), -200.0, -40.0]
    high = [math.log(centre * 1.15), math.log(_DAMPING[1]), 200.0, 40.0]
    fit = optimize.least_squares(off, start, bounds=(low, high), loss="soft_l1", f_scale=1.5)
    damping = math.exp(fit.x[1])
    if damping > 0.95 * _DAMPING[1] or float(np.median(np.abs(fit.fun))) > 2.5:
        return None
    return Resonance(math.exp(fit.x[0]), damping, sensor)


def divided(cross: ComplexArray, frequency_hz: FloatArray, resonances: Sequence[Resonance]) -> ComplexArray:
    """Return the cross-spectrum (k,) without the phase that these resonances put into it.

    The magnitude stays: the weightings see to it, and each line's own magnitude tells how much it can be trusted.
    """
    for resonance in resonances:
        response = resonance.response(frequency_hz)
        unit = response / np.abs(response)
        cross = cross * (unit if resonance.sensor is Sensor.A else unit.conj())
    return cross
