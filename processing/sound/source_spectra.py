"""What leaks and what rumbling things sound like: spectra of log excess, each of unit length, over a table of bands."""

import numpy as np

from processing.survey import FloatArray

_LEAK_HZ = 420.0 * 2.0 ** (0.25 * np.arange(15))  # to 4.75 kHz
_LEAK_OCTAVES = (0.82, 1.41, 2.36)  # full width at half power
_LEAK_STRENGTHS = (0.3, 4.0, 16.0)  # over the background: a strong source's logarithm is broader than a weak one's
_RUMBLE_HZ = (70.0, 100.0, 140.0, 190.0, 260.0)  # bends, valves and traffic rumble so low
_RUMBLE_OCTAVES = 1.8
_RUMBLE_STRENGTHS = (0.5, 3.0, 15.0)
_ROLL_OFF_HZ = (120.0, 200.0, 300.0)


def middles(bands_hz: FloatArray) -> FloatArray:
    """Return the geometric middle (b,) of each band (b, 2)."""
    return np.asarray(np.sqrt(bands_hz[:, 0] * bands_hz[:, 1]), np.float64)


def bell(hz: FloatArray, middle_hz: float, octaves: float) -> FloatArray:
    """Return a Gaussian over log frequency of height 1, ``octaves`` wide at half its height."""
    return np.asarray(np.exp(-0.5 * (np.log2(hz / middle_hz) * 2.3548 / octaves) ** 2), np.float64)


def leak_spectra(bands_hz: FloatArray) -> FloatArray:
    """Return (b, k) what a leak adds to the log power: ln(1 + strength · bell)."""
    hz = middles(bands_hz)
    columns = [
        np.log1p(strength * bell(hz, middle, octaves))
        for middle in _LEAK_HZ
        if middle <= hz[-1]
        for octaves in _LEAK_OCTAVES
        for strength in _LEAK_STRENGTHS
    ]
    return _unit(np.column_stack(columns or [np.ones(len(hz))]))


def rumble_spectra(bands_hz: FloatArray) -> FloatArray:
    """Return (b, m) what the rivals add: low bells from weak to strong, and rumbles that fall off above."""
    hz = middles(bands_hz)
    bells = [
        np.log1p(strength * bell(hz, middle, _RUMBLE_OCTAVES))
        for middle in _RUMBLE_HZ
        for strength in _RUMBLE_STRENGTHS
    ]
    return _unit(np.column_stack([*bells, *(1.0 / (1.0 + (hz / edge) ** 4) for edge in _ROLL_OFF_HZ)]))


def _unit(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.linalg.norm(columns, axis=0), np.float64)
