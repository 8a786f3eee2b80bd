"""Shapes of spectra: power per FFT bin, summing to one, so that a level times a shape is a sound of that level."""

from collections.abc import Sequence

import numpy as np

from processing.survey import FloatArray

_LOWEST_HZ = 15.0  # nothing below: the recorder's high-pass
_BEYOND_DB = 24.0


def pink(frequency_hz: FloatArray) -> FloatArray:
    """Return 1/f power above 15 Hz: flow noise."""
    return coloured(frequency_hz, 1.0, _LOWEST_HZ)


def coloured(frequency_hz: FloatArray, slope: float, corner_hz: float) -> FloatArray:
    """Return 1/f^slope power, flat below ``corner_hz``, nothing below 15 Hz."""
    shape = np.where(frequency_hz >= _LOWEST_HZ, np.maximum(frequency_hz, max(corner_hz, _LOWEST_HZ)) ** -slope, 0.0)
    return np.asarray(shape / shape.sum())


def through(frequency_hz: FloatArray, points: Sequence[tuple[float, float]]) -> FloatArray:
    """Return the spectrum through ``points`` (Hz rising, dB), straight over log frequency; 24 dB an octave beyond."""
    at, level = np.log2([hz for hz, _ in points]), np.array([db for _, db in points])
    octave = np.log2(np.maximum(frequency_hz, 1.0))
    beyond = np.maximum(at[0] - octave, 0.0) + np.maximum(octave - at[-1], 0.0)
    db = np.interp(octave, at, level - level.max()) - _BEYOND_DB * beyond
    shape = np.where(frequency_hz >= _LOWEST_HZ, 10 ** (db / 10), 0.0)
    return np.asarray(shape / shape.sum())


def white(frequency_hz: FloatArray) -> FloatArray:
    """Return flat power: the recorder's own hiss."""
    return np.full(len(frequency_hz), 1.0 / len(frequency_hz))


def band(frequency_hz: FloatArray, low_hz: float, high_hz: float) -> FloatArray:
    """Return a flat band with skirts of a third of an octave: rolling noise."""
    octave = np.log2(np.maximum(frequency_hz, 1.0))
    beyond = np.maximum(np.log2(low_hz) - octave, 0) + np.maximum(octave - np.log2(high_hz), 0)
    shape = np.exp(-0.5 * (beyond / 0.33) ** 2)
    return np.asarray(shape / shape.sum())


def bell(frequency_hz: FloatArray, centre_hz: float, octaves: float) -> FloatArray:
    """Return a Gaussian in log frequency whose half-power width is ``octaves``: leaks, valves, traffic."""
    sigma = octaves / (2 * np.sqrt(2 * np.log(2)))
    away = np.log2(np.maximum(frequency_hz, 1.0) / centre_hz)
    shape = np.where(frequency_hz >= _LOWEST_HZ, np.exp(-0.5 * (away / sigma) ** 2), 0.0)
    return np.asarray(shape / shape.sum())


def in_band(frequency_hz: FloatArray, centre_hz: float, octaves: float) -> FloatArray:
    """Return 1 inside the half-power band of :func:`bell`, 0 outside (at least one bin is inside)."""
    away = np.abs(np.log2(np.maximum(frequency_hz, 1.0) / centre_hz))
    inside = (away <= octaves / 2).astype(np.float64)
    inside[np.argmin(away)] = 1.0
    return inside
