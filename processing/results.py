"""All that one run of the pipeline derives, in one frozen dataclass."""

from dataclasses import dataclass

from processing.clock_fit import ClockFit
from processing.orientation.calibration import Calibration
from processing.position.fit_results import FitSeries
from processing.position.registry import Reckoned
from processing.position.tie_checks import TieCheck
from processing.settings import Settings
from processing.sound.level_along import LevelAlong
from processing.sound.scan import SoundScan
from processing.survey import Attitude, Candidate, ClockMap, Finding, Recording, Stretch, Survey, Track


@dataclass(frozen=True)
class Results:
    """All that one run derives; ``run_hash`` names it by what made it, ``timings`` are seconds a step (0 if cached)."""

    survey: Survey
    recording: Recording
    settings: Settings
    clock: ClockMap
    attitude_method: str
    calibration: Calibration | None
    track: Track | None
    scan: SoundScan | None
    level_along: LevelAlong | None
    candidates: tuple[Candidate, ...]
    findings: tuple[Finding, ...]
    not_assessed: tuple[Stretch, ...]
    run_hash: str
    timings: dict[str, float]
    reckoned: Reckoned | None = None  # free path and all evidence: `fitting.prepare` makes the live fit of it
    tie_checks: tuple[TieCheck, ...] = ()
    series: FitSeries | None = None  # the course of the fit's unknowns
    attitude: Attitude | None = None  # at the IMU's rate, memory-mapped where it came from the cache
    clock_fit: ClockFit | None = None  # what relates the two clocks
