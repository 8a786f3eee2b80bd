"""The words of a live recording: blocks of sound and motion as they come, and what is said about their streams.

Host time is ``time.monotonic()`` of this computer, in seconds. Survey time is seconds on the IMU's clock since the
recording's first sample, as the import of the finished recording will have it.
"""

from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from processing.survey import Finding, ImuSamples

SoundFrames = npt.NDArray[np.int32]  # (n, channels), full scale is 2³¹


class LinkState(StrEnum):
    """How a device is at this moment."""

    OFF = "off"  # none was chosen
    WAITING = "waiting"  # being opened, or not there yet
    LIVE = "live"
    SILENT = "silent"  # open, but nothing comes
    LOST = "lost"  # it was there and went; it is tried again
    ENDED = "ended"  # closed by us, or by a fault that trying again cannot mend


class RecordingState(StrEnum):
    """How far a recording is."""

    MONITORING = "monitoring"  # devices are heard, nothing is written
    RECORDING = "recording"
    STOPPING = "stopping"
    STOPPED = "stopped"
    FAILED = "failed"  # it ended by itself; what was written is safe


@dataclass(frozen=True)
class SoundBlock:
    """Sound as it came. ``lost_before`` frames are missing between the block before and this one.

    ``first_frame`` counts all frames since the stream began, lost ones too, so that it is a time on the audio clock.
    """

    frames: SoundFrames
    first_frame: int
    adc_host_s: float  # when the first frame was digitised, host time
    lost_before: int = 0
    reason: str = ""  # why they are missing: key of [reasons]


@dataclass(frozen=True)
class MotionBlock:
    """IMU samples as they came, on survey time; rows that cannot be trusted have ``valid`` False."""

    imu: ImuSamples
    arrived_host_s: float


@dataclass(frozen=True)
class SoundStatus:
    """One look at the sound's stream; levels in dB below full scale, one a channel."""

    state: LinkState = LinkState.OFF
    device: str = ""
    sample_rate_hz: float = 0.0
    channels: int = 0
    frames: int = 0  # that came, lost ones not counted
    lost_frames: int = 0
    gaps: int = 0
    rms_db: tuple[float, ...] = ()
    peak_db: tuple[float, ...] = ()
    held_peak_db: tuple[float, ...] = ()
    clipped: tuple[bool, ...] = ()  # since it was last cleared
    is_digital_silence: bool = False
    clock_ppm: float | None = None  # against the host's clock
    clock_sigma_ppm: float | None = None
    offset: tuple[float, ...] = ()  # steady voltage, full scale is 1
    overflows: int = 0  # times the system said that it lost sound before we got it
    waiting_s: float = 0.0  # of sound that came and has not been taken yet
    source: str = ""  # what stands behind a device of the system's sound server, where that can be known
    source_rate_hz: float | None = None  # what that itself runs at; another rate means the system resamples


@dataclass(frozen=True)
class MotionStatus:
    """One look at the IMU's stream."""

    state: LinkState = LinkState.OFF
    device: str = ""
    protocol: str = ""
    rate_hz: float | None = None
    samples: int = 0
    lost: int = 0  # by the device's counter, or by its time where it has none
    repeated: int = 0
    garbage_bytes: int = 0
    bad_sums: int = 0
    gaps: int = 0
    restarts: int = 0  # times the device's clock began anew
    clock_ppm: float | None = None  # against the host's clock
    clock_sigma_ppm: float | None = None
    jitter_ms: float | None = None  # of the arrivals about the fitted line, rms
    reason: str = ""  # why it is not alive: key of [reasons]
    detail: str = ""  # the system's words about that


@dataclass(frozen=True)
class DiscStatus:
    """What the disc still takes."""

    free_bytes: int = 0
    bytes_per_s: float = 0.0
    seconds_left: float | None = None
    synced_host_s: float | None = None  # up to when all that came is on the disc for sure


@dataclass(frozen=True)
class RecordingStatus:
    """One look at the whole recording, safe to hand to another thread."""

    state: RecordingState = RecordingState.MONITORING
    elapsed_s: float = 0.0
    survey_s: float | None = None  # the present moment on survey time
    folder: Path | None = None
    sound: SoundStatus = field(default_factory=SoundStatus)
    motion: MotionStatus = field(default_factory=MotionStatus)
    disc: DiscStatus = field(default_factory=DiscStatus)
    markers: int = 0
    feed_dropped: int = 0  # blocks the live views were too slow for; the recording has them
    findings: tuple[Finding, ...] = ()  # what happened, in order: gaps, reconnections, warnings


@dataclass(frozen=True)
class JournalLine:
    """One line of a recording's journal: what happened when."""

    event: str
    utc: str  # ISO 8601
    host_s: float
    values: dict[str, Any] = field(default_factory=dict)
