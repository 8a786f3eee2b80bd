"""What a fit gives: the track, the table of its ties, and the course of its unknowns."""

from dataclasses import dataclass

from processing.position.tie_checks import TieCheck
from processing.survey import FloatArray, Track


@dataclass(frozen=True)
class Innovation:
    """How far one piece of knowledge was off what all before it let expect, in sigmas (normal if the model is right).

    ``kind``: tie | fix | increment | revisit; ``source`` is the tie's name or what the evidence came from.
    """

    time_s: float
    kind: str
    source: str
    sigmas: float
    held_down: bool


@dataclass(frozen=True)
class FitSeries:
    """The unknowns of the fit at k keyframes with their 1-sigmas, for the quality plots.

    ``slip_share`` is slip as a share of the way (positive: the device went further than its odometry says), beside the
    constant ``scale`` of the run (1: the odometry's own).
    """

    time_s: FloatArray  # (k,)
    chainage_m: FloatArray  # (k,)
    slip_share: FloatArray  # (k,)
    slip_sigma: FloatArray  # (k,)
    heading_correction_rad: FloatArray  # (k,)
    heading_sigma_rad: FloatArray  # (k,)
    heading_drift_radps: FloatArray  # (k,)
    heading_drift_sigma_radps: FloatArray  # (k,)
    scale: float
    scale_sigma: float
    slip_level: float  # factor on the model's slip that this run's knowledge speaks for
    heading_level: float
    innovations: tuple[Innovation, ...] = ()


@dataclass(frozen=True)
class Fitted:
    """The track, the table of its ties, and the course of the unknowns."""

    track: Track
    checks: tuple[TieCheck, ...]
    series: FitSeries


@dataclass(frozen=True)
class FitPreview:
    """The fitted path at k keyframes, to be drawn while a tie point is dragged; sigmas as in :class:`Track`.

    ``cov_level_m2`` (k, 3) holds the variances east-east, east-north, north-north of the place.
    """

    time_s: FloatArray  # (k,)
    chainage_m: FloatArray  # (k,)
    position_w_m: FloatArray  # (k, 3)
    sigma_along_m: FloatArray  # (k,)
    sigma_cross_m: FloatArray  # (k,)
    cov_level_m2: FloatArray  # (k, 3)
    checks: tuple[TieCheck, ...]
