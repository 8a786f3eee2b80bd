"""The two cascades of P2: Kalman → FIR and FIR → Kalman.

With one and the same gain the two are the same filter, for linear time-invariant filters commute. What sets them apart
is what the Kalman filter is told: behind the FIR it meets less noise, trusts its readings more and lags less.
"""

from dataclasses import replace

import numpy as np

from processing.conditioning.channel import Conditioned, readings
from processing.conditioning.fir import bridged, convolve, end_inflation, low_pass_taps, spread
from processing.conditioning.kalman import noise_figures, run
from processing.conditioning.noise import Noise, channel_noise, model_variance, steady_weights
from processing.conditioning.settings import ConditioningSettings
from processing.survey import BoolArray, FloatArray


def kalman_fir(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by Kalman, which bridges the holes, then smooth its estimate by the FIR (P2 fig. 4.10).

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, SETTING_INVALID.
    """
    data = readings(values, sample_rate_hz, valid)
    noise, taps = channel_noise(data, settings), low_pass_taps(sample_rate_hz, settings)
    zero_phase = settings.phase == "zero"
    mean, variance = run(data, noise, zero_phase=zero_phase)
    steady = noise.smoothed if zero_phase else noise.filtered
    excess = spread(np.sqrt(np.maximum(variance - steady, 0.0)), taps)
    sigma = np.sqrt(_steady_variance(taps, noise, noise, len(mean), zero_phase) + excess**2)
    return Conditioned(convolve(mean, taps), sigma, figures=noise_figures(noise, sample_rate_hz) | {"taps": len(taps)})


def fir_kalman(
    values: FloatArray, sample_rate_hz: float, settings: ConditioningSettings, valid: BoolArray | None = None
) -> Conditioned:
    """Filter ``values`` (n,) by the FIR, then by a Kalman filter told of the noise that is left (P2 fig. 4.9).

    That noise is ``r Σ taps²``. Holes are bridged before the FIR and predicted again behind it.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES, SETTING_INVALID.
    """
    data = readings(values, sample_rate_hz, valid)
    noise, taps = channel_noise(data, settings), low_pass_taps(sample_rate_hz, settings)
    filled, fill_sigma = bridged(data, noise)
    behind = Noise(noise.q, noise.r * float(taps @ taps))
    zero_phase = settings.phase == "zero"
    mean, variance = run(replace(data, values=convolve(filled, taps)), behind, zero_phase=zero_phase)
    steady = behind.smoothed if zero_phase else behind.filtered
    excess = np.maximum(variance - steady, 0.0) + spread(fill_sigma, taps) ** 2
    sigma = np.sqrt(_steady_variance(taps, behind, noise, len(mean), zero_phase) + excess)
    return Conditioned(mean, sigma, figures=noise_figures(noise, sample_rate_hz) | {"taps": len(taps)})


def _steady_variance(taps: FloatArray, told: Noise, true: Noise, rows: int, zero_phase: bool) -> FloatArray:
    """Error variance (rows,) of the whole cascade, the Kalman filter having been ``told`` other noise than is true."""
    whole = steady_weights(told, taps, zero_phase=zero_phase)
    return model_variance(whole, true) * end_inflation(taps, true, rows)
