"""The facts that Leakline works with, as frozen dataclasses. Arrays inside them are never written to.

What the operator tells (:class:`Survey` and its parts), what the device recorded (:class:`ImuSamples`,
:class:`AudioSource`), what is derived (:class:`Track`, :class:`Candidate`), what a human decided (:class:`Decision`).
Longer than 400 lines because it is the one vocabulary of all packages.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

import numpy as np
import numpy.typing as npt

from processing.live.check_sheet import CheckSheet

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]
Params = Mapping[str, str | float]


# --- what the operator tells -------------------------------------------------------------------------------------


class Motion(StrEnum):
    """How the device moves; decides which physics gives the path."""

    ROLLING = "rolling"
    CARRIED = "carried"
    FOOT = "foot"


@dataclass(frozen=True)
class SurveyInfo:
    """Free text that heads the report; ``date`` is ISO 8601 (``2026-05-04``) or empty.

    ``simulated`` is said on the face of every view and page, so that nobody digs for a simulated leak.
    """

    name: str = ""
    operator: str = ""
    date: str = ""
    client: str = ""
    simulated: bool = False


@dataclass(frozen=True)
class PipeInfo:
    """The pipe; ``length_m`` is the surveyed length from launch to retrieval, None where unknown."""

    material: str = ""
    diameter_m: float | None = None
    length_m: float | None = None
    joint_spacing_m: float | None = None  # from joint to joint: what one pipe adds to the length
    pressure_bar: float | None = None  # in the pipe during the run, above the air's


@dataclass(frozen=True)
class DeviceInfo:
    """The device; ``radius_m`` is the rolling radius of the shell, None where unknown or not rolling."""

    motion: Motion = Motion.ROLLING
    radius_m: float | None = None


@dataclass(frozen=True)
class AudioInfo:
    """Which sound, and how its clock relates to the IMU's; None means: estimate it, else 0.

    With ``start_sigma_s`` and ``drift_sigma_ppm`` (1 sigma) the start and the drift were measured while recording: what
    both sensors felt makes them better. Without, they are taken as they are.
    """

    file: str | None = None
    channel: int = 0
    start_time_s: float | None = None
    drift_ppm: float | None = None
    raw_sample_rate_hz: float | None = None  # the form of headerless PCM; None where the file has a header
    raw_bits: int | None = None
    raw_channels: int | None = None
    raw_encoding: str | None = None  # signed | unsigned | float | ulaw | alaw; None: signed
    raw_endian: str | None = None  # little | big; None: little
    start_sigma_s: float | None = None
    drift_sigma_ppm: float | None = None


@dataclass(frozen=True)
class Launch:
    """Where the run began: WGS 84 degrees, or east/north in ``crs``; all None is the local origin (0, 0, 0)."""

    latitude: float | None = None
    longitude: float | None = None
    east_m: float | None = None
    north_m: float | None = None
    crs: str | None = None
    elevation_m: float | None = None
    heading_deg: float | None = None


@dataclass(frozen=True)
class TiePoint:
    """A moment at which the place of the device is known, by chainage and/or coordinates, ±``sigma_m`` (1 sigma).

    A closed loop is a tie point with the launch's coordinates, declared by the operator, never assumed.
    A tie point that is not ``enabled`` is shown but does not pull.
    """

    name: str
    time_s: float
    chainage_m: float | None = None
    latitude: float | None = None
    longitude: float | None = None
    east_m: float | None = None
    north_m: float | None = None
    up_m: float | None = None
    sigma_m: float = 0.5
    enabled: bool = True


@dataclass(frozen=True)
class Route:
    """The pipe as the utility's map has it: ``points`` (n, 3) in ``crs``, ±``sigma_m``."""

    points: tuple[tuple[float, float, float], ...]
    crs: str = "local"
    sigma_m: float = 0.5


@dataclass(frozen=True)
class CalibrationLeak:
    """A leak of known flow at ``chainage_m``, such as a tap opened near the launch: others are sized beside it."""

    chainage_m: float
    flow_lpm: float  # litres a minute, measured
    pressure_bar: float | None = None  # in the pipe there
    name: str = ""


@dataclass(frozen=True)
class ProcessingChoice:
    """Which method each step uses; ``auto`` lets the step choose by the data and say why.

    ``preset`` names a row of the table of pipes (:mod:`processing.sound.presets`); ``auto`` takes the one for the
    pipe's material and diameter, ``none`` leaves the settings as they are.
    """

    orientation: str = "auto"
    position: str = "auto"
    detector: str = "auto"
    preset: str = "auto"


@dataclass(frozen=True)
class StatedIntervals:
    """By what the report widens all 95 % intervals along the pipe: the operator's choice after digs, never made alone.

    ``digs`` is how many measured digs it rests on, ``kind`` which: as in :class:`processing.review_facts.DigHistory`.
    """

    widen: float = 1.0
    digs: int = 0
    kind: str = ""


@dataclass(frozen=True)
class Survey:
    """All that the operator told about one run: the content of ``survey.toml``, but for ``stated``, found by digs."""

    info: SurveyInfo = field(default_factory=SurveyInfo)
    pipe: PipeInfo = field(default_factory=PipeInfo)
    device: DeviceInfo = field(default_factory=DeviceInfo)
    audio: AudioInfo = field(default_factory=AudioInfo)
    launch: Launch = field(default_factory=Launch)
    tie_points: tuple[TiePoint, ...] = ()
    route: Route | None = None
    processing: ProcessingChoice = field(default_factory=ProcessingChoice)
    calibration_leak: CalibrationLeak | None = None
    stated: StatedIntervals = field(default_factory=StatedIntervals)


# --- what the device recorded, and what is wrong with it -----------------------------------------------------------


class Severity(StrEnum):
    """How much a finding matters: told, mended, masked (not assessed), or the operator must look."""

    INFO = "info"
    REPAIRED = "repaired"
    MASKED = "masked"
    WARNING = "warning"


@dataclass(frozen=True)
class Finding:
    """One thing that a step noticed, for the operator's eyes.

    ``code`` is a key of the ``[findings]`` table in ``resources/messages``; ``params`` fill its placeholders.
    """

    code: str
    severity: Severity
    params: Params = field(default_factory=dict)


class Channel(StrEnum):
    """What a stretch that cannot be assessed concerns."""

    PATH = "path"
    SOUND = "sound"


@dataclass(frozen=True)
class Stretch:
    """A span of survey time in which ``channel`` cannot be assessed; ``reason`` is a key of ``[reasons]``."""

    start_s: float
    end_s: float
    channel: Channel
    reason: str


@dataclass(frozen=True)
class ImuSamples:
    """Clean IMU samples, structure of arrays (may be memory-mapped): n rows, time strictly increasing.

    Rows that cannot be trusted stay in place with ``valid`` False and finite values, so that nothing downstream meets
    a NaN; gaps in time are left as gaps. Optional channels that a file lacks are None.
    """

    time_s: FloatArray  # (n,)
    acc_s_mps2: FloatArray  # (n, 3) specific force
    gyr_s_radps: FloatArray  # (n, 3)
    valid: BoolArray  # (n,)
    mag_s_ut: FloatArray | None = None  # (n, 3)
    quat_ws: FloatArray | None = None  # (n, 4) the device's own orientation
    pressure_kpa: FloatArray | None = None  # (n,)
    temperature_c: FloatArray | None = None  # (n,)

    @property
    def sample_rate_hz(self) -> float:
        """The median sample rate."""
        return float(1.0 / np.median(np.diff(self.time_s), overwrite_input=True))

    @property
    def duration_s(self) -> float:
        """From the first to the last sample."""
        return float(self.time_s[-1] - self.time_s[0])


@dataclass(frozen=True)
class AudioPart:
    """A file, or a piece of one, that holds ``frames`` frames of a recording.

    With ``raw_subtype`` None soundfile reads it; else it is headerless (or its header lies): PCM of that soundfile
    subtype (``PCM_16``, ``PCM_24``, ``PCM_32``, ``FLOAT``) with ``endian`` from ``data_offset`` bytes on.
    """

    path: Path
    frames: int
    raw_subtype: str | None = None
    endian: str = "LITTLE"
    data_offset: int = 0


@dataclass(frozen=True)
class AudioGap:
    """A span on the audio clock in which nothing was heard, though the file has zeros; ``reason``: key of [reasons]."""

    start_s: float
    end_s: float
    reason: str


@dataclass(frozen=True)
class AudioSource:
    """One recording on the audio clock, in one or more parts that follow each other without a gap."""

    parts: tuple[AudioPart, ...]
    sample_rate_hz: float
    channels: int
    channel: int = 0
    gaps: tuple[AudioGap, ...] = ()

    @property
    def frames(self) -> int:
        """Frames in all parts."""
        return sum(part.frames for part in self.parts)

    @property
    def duration_s(self) -> float:
        """Length on the audio clock."""
        return self.frames / self.sample_rate_hz


@dataclass(frozen=True)
class ClockMap:
    """Survey time of audio time: ``survey_s = start_s + audio_s / (1 + drift_ppm·1e-6)``, ± ``sigma_s`` (1 sigma).

    ``sigma_s`` holds in the middle of the recording; :meth:`sigma_at` tells it anywhere. The two clocks are related
    best at ``settled_s`` (survey time, ± ``settled_sigma_s``), and their doubt grows from there by ``drift_sigma_ppm``.
    """

    start_s: float = 0.0
    drift_ppm: float = 0.0
    sigma_s: float = 0.0
    basis: str = "assumed"  # given | knocks | bumps | measured | assumed
    drift_sigma_ppm: float = 0.0
    settled_s: float = 0.0
    settled_sigma_s: float | None = None  # None: as sigma_s, everywhere

    def sigma_at(self, survey_s: FloatArray | float) -> FloatArray:
        """Return how well survey time is known, 1 sigma in seconds, at moments of the survey."""
        settled = self.sigma_s if self.settled_sigma_s is None else self.settled_sigma_s
        away = np.asarray(survey_s, dtype=np.float64) - self.settled_s
        return np.asarray(np.hypot(settled, self.drift_sigma_ppm * 1e-6 * away), dtype=np.float64)

    def to_survey(self, audio_s: FloatArray | float) -> FloatArray:
        """Return survey seconds of seconds on the audio clock."""
        return np.asarray(self.start_s + np.asarray(audio_s) / (1.0 + self.drift_ppm * 1e-6), dtype=np.float64)

    def to_audio(self, survey_s: FloatArray | float) -> FloatArray:
        """Return audio seconds of survey seconds."""
        return np.asarray((np.asarray(survey_s) - self.start_s) * (1.0 + self.drift_ppm * 1e-6), dtype=np.float64)


@dataclass(frozen=True)
class ImportedFile:
    """A file that was read: ``role`` is ``imu``, ``audio``, ``survey`` or ``journal`` (of a live recording)."""

    path: Path
    role: str
    size: int
    sha256: str


@dataclass(frozen=True)
class Recording:
    """All that import gives: samples, sound, what is wrong with them, and where they came from."""

    imu: ImuSamples | None
    audio: AudioSource | None
    findings: tuple[Finding, ...] = ()
    not_assessed: tuple[Stretch, ...] = ()
    files: tuple[ImportedFile, ...] = ()
    sheets: tuple[CheckSheet, ...] = ()  # of the checks before the launch and at the end


# --- what is derived ----------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Attitude:
    """Orientation at each IMU sample: ``quat_ws`` (n, 4); ``bias_radps`` (3,) or (n, 3) is what was taken off."""

    quat_ws: FloatArray
    bias_radps: FloatArray
    method: str
    reason: str = ""  # key of [reasons]: why auto chose it
    heading_from: str = "launch"  # launch | magnetometer | device: what the heading rests on


@dataclass(frozen=True)
class Track:
    """The path with its interval, at 10 Hz or more: m rows, time strictly increasing.

    ``sigma_*`` are 1 sigma, calibrated so that ±1.96 sigma holds 95 %.
    """

    time_s: FloatArray  # (m,)
    chainage_m: FloatArray  # (m,)
    position_w_m: FloatArray  # (m, 3)
    sigma_along_m: FloatArray  # (m,)
    sigma_cross_m: FloatArray  # (m,)
    sigma_up_m: FloatArray  # (m,)
    quat_ws: FloatArray  # (m, 4)
    speed_mps: FloatArray  # (m,)
    method: str
    reason: str = ""
    findings: tuple[Finding, ...] = ()
    not_assessed: tuple[Stretch, ...] = ()
    quality: Params = field(default_factory=dict)  # figures for summary.json and the accuracy statement
    cov_level_m2: FloatArray | None = None  # (m, 3) variances of the place east-east, east-north, north-north


class LeakClass(StrEnum):
    """What a candidate is taken for."""

    LEAK = "leak"
    VALVE = "valve"
    BEND = "bend"
    PUMP = "pump"
    BUMP = "bump"
    AIR = "air"
    TRAFFIC = "traffic"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class Candidate:
    """A place where the machine proposes a leak: derived, never edited.

    ``level_db`` is above the local background; ``score`` is the probability (0..1) that it is a leak.
    ``chainage_low95_m``/``high95`` enclose the true place in 95 of 100 cases.
    """

    id: int
    time_s: float
    chainage_m: float
    chainage_low95_m: float
    chainage_high95_m: float
    position_w_m: tuple[float, float, float]
    score: float
    level_db: float
    leak_class: LeakClass
    band_hz: tuple[float, float]
    width_m: float
    evidence: Params = field(default_factory=dict)
    number: int = 0  # what people call it by, the same from run to run; 0: by its id

    @property
    def label(self) -> int:
        """The number that lists, maps and reports show."""
        return self.number or self.id


# --- what a human decided -----------------------------------------------------------------------------------------


class Verdict(StrEnum):
    """The operator's word on a candidate."""

    NONE = "none"
    CONFIRMED = "confirmed"
    REJECTED = "rejected"
    UNSURE = "unsure"


@dataclass(frozen=True)
class Decision:
    """A verdict with its class and note; ``leak_class`` None keeps the machine's."""

    verdict: Verdict = Verdict.NONE
    leak_class: LeakClass | None = None
    note: str = ""


@dataclass(frozen=True)
class Run:
    """One pass of the pipeline over a recording: ``settings_hash`` names what made it."""

    id: int
    created_utc: str
    settings_hash: str
    versions: Params = field(default_factory=dict)
