"""Gathers the evidence on each spot of a run and has it judged: class, probability of a leak, and why."""

from dataclasses import dataclass, replace

import numpy as np

from processing.sound.cells import band_log_power
from processing.sound.classes import ClassModel, judge, load_model
from processing.sound.ground import Ground, ground_of
from processing.sound.place_features import features_at, loudness_at
from processing.sound.spots import Listening, Spot
from processing.survey import ImuSamples, LeakClass, Survey, Track

_STAND_S = 2.0
_SPEAKS_DB = 6.0  # a sound that fades by less while the device stands may be a weak leak in changing noise
_WORTH_TELLING = 0.02
# the papers' methods stand beside ours as they were published: named, but ranked by their own figure alone
_AS_PUBLISHED = ("kurtosis_band", "wavelet_band", "spectrum")


@dataclass(frozen=True)
class Judging:
    """One run's surroundings and the model; :meth:`of` judges a spot of it."""

    listening: Listening
    ground: Ground
    model: ClassModel

    @classmethod
    def on(cls, listening: Listening, track: Track | None, imu: ImuSamples | None, survey: Survey) -> "Judging":
        """Gather what lies along the run; ``track`` is None where the detector works in time."""
        in_metres = track is not None and listening.cells is not None
        ground = ground_of(listening.scan, listening.frames, track, imu, survey, in_metres=in_metres)
        return cls(listening, ground, load_model())

    def of(self, spot: Spot) -> tuple[Spot, LeakClass]:
        """Return the spot with its evidence and the probability that it is a leak, and what it is taken for.

        The evidence holds the figures of :data:`processing.sound.place_features.FEATURES`, ``heard_score`` (the
        detector's own probability), ``stood_s`` and ``faded_db``, and ``p_<class>`` for each class worth telling.
        """
        figures = features_at(self.ground, spot.place, spot.width, spot.band_hz)
        stood = standing(spot, self.listening) if self.ground.in_metres else {}
        if "faded_db" in stood:
            figures["faded_share"] = stood["faded_db"] / max(spot.level_db, _SPEAKS_DB)
        found = judge(spot.score, figures, self.model)
        told: dict[str, str | float] = {name: value for name, value in figures.items() if np.isfinite(value)}
        told |= {"heard_score": spot.score, **stood, **self._loudness(spot)}
        told |= {f"p_{c.value}": round(p, 4) for c, p in found.probability.items() if p >= _WORTH_TELLING}
        score = spot.score if self._as_published(spot) else found.score
        return replace(spot, score=score, evidence={**spot.evidence, **told}), found.leak_class

    def _loudness(self, spot: Spot) -> dict[str, float]:
        """What the size of a leak is told from."""
        settings = self.listening.settings
        band = (settings.size_low_hz, settings.size_high_hz)
        found = loudness_at(self.ground, spot.place, spot.width, band)
        if found is None:
            return {}
        over, background = found
        return {
            "size_over_db": over, "size_background_db": background, "size_low_hz": band[0], "size_high_hz": band[1]
        }  # fmt: skip

    def _as_published(self, spot: Spot) -> bool:
        method = spot.evidence.get("method")
        plain = method == "envelope" and self.listening.settings.envelope_order == "plain"
        return plain or method in _AS_PUBLISHED


def standing(spot: Spot, listening: Listening) -> dict[str, float]:
    """Return how long the device stood at the spot and how much the sound changed meanwhile.

    A leak goes on while the device stands; what comes and goes then belongs to a moment, not to a place.
    """
    frames, scan = listening.frames, listening.scan
    still = (frames.speed_mps < listening.settings.min_speed_mps) & (np.asarray(scan.state) == 0)
    still &= np.abs(frames.chainage_m - spot.place) <= max(spot.width, 0.5)
    seconds = float(np.count_nonzero(still)) * scan.frame_s
    if seconds < _STAND_S:
        return {"stood_s": seconds}
    inside = np.sqrt(scan.bands_hz[:-1, 0] * scan.bands_hz[:-1, 1])
    wins = np.flatnonzero((inside >= spot.band_hz[0]) & (inside <= spot.band_hz[1]))
    power = np.exp([band_log_power(scan, int(b))[still] for b in wins]).sum(axis=0) if len(wins) else np.zeros(0)
    size = max(1, round(1.0 / scan.frame_s))
    seconds_db = 10 * np.log10([chunk.mean() for chunk in np.array_split(power, max(1, len(power) // size))])
    return {"stood_s": seconds, "faded_db": float(np.ptp(seconds_db))}
