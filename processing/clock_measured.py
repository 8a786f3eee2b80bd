"""The map between sound and motion as it was measured while recording, from when each arrived: where to look first."""

from dataclasses import dataclass

import numpy as np

from processing.clock_fit import ClockFit
from processing.survey import AudioInfo, ClockMap, Finding, Severity

_SIGMAS = 4.0
_LEAST_ROOM_S = 0.02


@dataclass(frozen=True)
class Measured:
    """``survey_s = start_s + audio_s / (1 + drift)``, each with its one sigma."""

    start_s: float
    drift: float
    start_sigma_s: float
    drift_sigma: float

    @property
    def drift_room(self) -> float:
        """How far around the drift to look."""
        return _SIGMAS * self.drift_sigma

    def room_s(self, survey_s: float) -> float:
        """Return how far around the expected shift to look at a moment of the survey."""
        after_s = max(0.0, survey_s - self.start_s)
        return _SIGMAS * float(np.hypot(self.start_sigma_s, self.drift_sigma * after_s)) + _LEAST_ROOM_S

    def fit(self, audio_s: float) -> ClockFit:
        """Return the map itself, where both sensors felt nothing that makes it better."""
        sigma_s = float(np.hypot(self.start_sigma_s, self.drift_sigma * audio_s / 2))
        ppm, sigma_ppm = 1e6 * self.drift, 1e6 * self.drift_sigma
        clock = ClockMap(self.start_s, ppm, sigma_s, "measured", sigma_ppm, self.start_s, self.start_sigma_s)
        params: dict[str, str | float] = {"drift_ppm": ppm, "sigma_ms": 1000 * sigma_s}
        return ClockFit(clock, (Finding("clock_measured", Severity.INFO, params),))


def measured_in(told: AudioInfo) -> Measured | None:
    """Return what was measured; None where start and drift, or their sigmas, are missing: then they are told."""
    start_s, drift_ppm, start_sigma_s = told.start_time_s, told.drift_ppm, told.start_sigma_s
    if start_s is None or drift_ppm is None or start_sigma_s is None or told.drift_sigma_ppm is None:
        return None
    return Measured(start_s, 1e-6 * drift_ppm, start_sigma_s, 1e-6 * told.drift_sigma_ppm)
