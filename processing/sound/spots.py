"""What a detector works on and what it finds, before it is placed on the path with its interval."""

from dataclasses import dataclass, field

from processing.settings import DetectorSettings
from processing.sound.cells import Cells, Frames
from processing.sound.scan import SoundScan

UNCONVINCING = 0.3  # on the score where the fit shows no rise and fall at the place


@dataclass(frozen=True)
class Listening:
    """One run as the detectors get it; ``cells`` is None where there is no path."""

    scan: SoundScan
    frames: Frames
    cells: Cells | None
    settings: DetectorSettings


@dataclass(frozen=True)
class Spot:
    """A place, or a moment where no path is known, that sounds like a passed leak.

    ``place`` is chainage in metres, or survey seconds without a path; ``sigma`` (1 sigma) and ``width`` likewise.
    ``score`` is the probability (0..1) that it is a leak; ``level_db`` stands above the background.
    """

    place: float
    sigma: float
    width: float
    score: float
    level_db: float
    band_hz: tuple[float, float]
    evidence: dict[str, str | float] = field(default_factory=dict)
