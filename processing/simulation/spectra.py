"""Shapes of spectra: power per FFT bin, summing to one, so that a level times a shape is a sound of that level."""

import numpy as np

from processing.survey import FloatArray

_LOWEST_HZ = 15.0  # nothing below: the recorder's high-pass


def pink(frequency_hz: FloatArray) -> FloatArray:
    """Return 1/f power above 15 Hz: flow noise."""
    shape = np.where(frequency_hz >= _LOWEST_HZ, 1.0 / np.maximum(frequency_hz, _LOWEST_HZ), 0.0)
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
