"""The sound card's clock from when its blocks were digitised: lost frames, drift, and the map to the motion's clock."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from processing.live.arrival_fit import ArrivalFit
from processing.live.device_timeline import DeviceTimeline

_NEAR_S = 300.0  # of the past, beside which a loss is looked for: over hours a crystal wanders
_CONFIRMED_S = 0.5  # what a loss without a flag must last: the times a sound server gives are coarse
_CONFIRMED_BLOCKS = 8
_LEAST_LOSS_S = 0.010
_LEAST_FLAGGED_S = 0.002
_SIGMAS = 6.0
_SCATTERS = 4.0
_MOST_LOST_S = 3600.0
_LEAST_DRIFT_SIGMA_PPM = 0.05  # what two crystals wander against each other within a survey
_BACK_S = 0.5  # so much too early: the host's clock was set, not ours


@dataclass(frozen=True)
class ClockGuess:
    """``survey_s = start_time_s + audio_s / (1 + drift_ppm·1e-6)``, each with its one sigma; fields of AudioInfo."""

    start_time_s: float
    drift_ppm: float
    start_sigma_s: float
    drift_sigma_ppm: float


class SoundTimeline:
    """Counts frames, those that were lost too, so that frame / rate is a time on the sound card's clock.

    ``frames`` is that count since the stream began, ``begin`` sets the frame that is a file's first. The times of
    blocks may err either way (a sound server's by 10 ms), so single blocks say nothing; a loss that nobody flagged
    is believed when all blocks of a while come later than the line by more than these times scatter.

    Args:
        rate_hz: what the device says.
        delay_sigma_s: 1 sigma of the moment at which a sound was in the air against what the driver says of it.
        confirmed_s: how long blocks must come late until a loss is believed that nobody flagged. What a sound server
            tells is late by up to 0.14 s, for up to 10 s, while it waits for a busy processor.
    """

    def __init__(self, rate_hz: float, delay_sigma_s: float = 0.010, confirmed_s: float = _CONFIRMED_S) -> None:
        self.rate_hz = rate_hz
        self._confirmed_s = confirmed_s
        self.frames = 0
        self.lost_frames = 0
        self.gaps = 0
        self._fit = ArrivalFit(one_sided=False, delay_sigma_s=delay_sigma_s)
        self._near = ArrivalFit(one_sided=False, delay_sigma_s=0.0, memory_s=_NEAR_S, most_windows=512)
        self._origin = 0
        self._recent: deque[tuple[float, float]] = deque()  # block's length, how late it was
        self._length_s = 0.0  # of these

    # --- what comes in

    def begin(self) -> None:
        """Let the next block be the first of a file."""
        self._origin = self.frames

    def place(self, frames: int, adc_host_s: float, *, overflowed: bool = False, reopened: bool = False) -> int:
        """Count a block and return how many frames were lost just before it.

        Args:
            frames: in the block.
            adc_host_s: when its first frame was digitised, host time; NaN where the driver does not say.
            overflowed: the driver says that something was lost before it.
            reopened: it is the first since the device was opened again.
        """
        lost = 0
        if np.isfinite(adc_host_s):
            late_s = self._late_s(adc_host_s)
            if reopened or overflowed:
                self._forget()
                least_s = _LEAST_FLAGGED_S if reopened else max(_LEAST_FLAGGED_S, 2.0 * self._near.jitter_s)
                lost = self._as_frames(late_s) if late_s > least_s else 0
            else:
                self._remember(frames / self.rate_hz, late_s)
                lost = self._confirmed() if abs(late_s) > _LEAST_LOSS_S else 0
        if lost:
            self.frames += lost
            self.lost_frames += lost
            self.gaps += 1
        if np.isfinite(adc_host_s):
            at = np.array([self.frames / self.rate_hz])
            for fit in (self._fit, self._near):
                fit.add(at, np.array([adc_host_s]))
        self.frames += frames
        return lost

    # --- what is known

    @property
    def fit(self) -> ArrivalFit:
        """How the stream's time relates to the host's."""
        return self._fit

    @property
    def clock_ppm(self) -> float | None:
        """By how much the card's clock is fast against the host's; None before that is known."""
        return self._fit.drift_ppm if self._fit.is_settled else None

    @property
    def clock_sigma_ppm(self) -> float | None:
        """One sigma of it."""
        return self._fit.drift_sigma_ppm if self._fit.is_settled else None

    @property
    def jitter_s(self) -> float:
        """By how much the times of blocks scatter, root mean square."""
        return self._near.jitter_s

    @property
    def audio_s(self) -> float:
        """Seconds of the file so far, on the card's clock."""
        return (self.frames - self._origin) / self.rate_hz

    def host_of(self, audio_s: float) -> tuple[float, float]:
        """Return host time and its one sigma at a moment of the file; raises ValueError before the first block."""
        stream_s = audio_s + self._origin / self.rate_hz
        return float(self._fit.host_of(stream_s)), float(self._fit.sigma_s_at(stream_s))

    @property
    def is_empty(self) -> bool:
        """Whether no block with a time was there yet."""
        return self._fit.is_empty

    # --- inside

    def _late_s(self, adc_host_s: float) -> float:
        if self._near.is_empty:
            return 0.0
        late_s = adc_host_s - float(self._near.host_of(self.frames / self.rate_hz))
        return float(late_s)

    def _as_frames(self, late_s: float) -> int:
        return round(min(late_s, _MOST_LOST_S) * self.rate_hz)

    def _confirmed(self) -> int:
        """Return how many frames the blocks of the last while say are missing."""
        if not self._near.is_settled or len(self._recent) < _CONFIRMED_BLOCKS or self._length_s < self._confirmed_s:
            return 0
        if -_BACK_S <= self._recent[-1][1] <= _LEAST_LOSS_S:  # most often; what follows costs as much as all else here
            return 0
        late = np.array([late_s for _, late_s in self._recent])
        middle = float(np.median(late))
        if middle < -_BACK_S:
            self._forget()
            self._fit.begin_block()
            self._near.begin_block()
            return 0
        of_middle = 1.25 * self._near.jitter_s / np.sqrt(len(late))
        doubt_s = float(self._near.sigma_s_at(self.frames / self.rate_hz))
        least_s = max(_LEAST_LOSS_S, _SIGMAS * of_middle, _SCATTERS * (self._near.scatter_s + doubt_s))
        if middle <= least_s or float(np.percentile(late, 10.0)) < max(0.6 * middle, least_s):
            return 0
        self._forget()
        return self._as_frames(middle)

    def _remember(self, length_s: float, late_s: float) -> None:
        self._recent.append((length_s, late_s))
        self._length_s += length_s
        while len(self._recent) > _CONFIRMED_BLOCKS and self._length_s - self._recent[0][0] >= self._confirmed_s:
            self._length_s -= self._recent.popleft()[0]

    def _forget(self) -> None:
        self._recent.clear()
        self._length_s = 0.0


def sound_to_survey(sound: SoundTimeline, device: DeviceTimeline) -> ClockGuess | None:
    """Return how the file's clock relates to survey time; None before both have begun.

    Each clock's line against the host's is taken at the file's beginning and now; what both are in doubt by there is
    the doubt of the start and, over the time between, of the drift.
    """
    if sound.is_empty:
        return None
    ends_s = (0.0, max(sound.audio_s, 1.0))
    survey_s, sigma_s = [], []
    for audio_s in ends_s:
        host_s, sound_sigma_s = sound.host_of(audio_s)
        told = device.survey_s(host_s)
        if told is None:
            return None
        survey_s.append(told[0])
        sigma_s.append(float(np.hypot(sound_sigma_s, told[1])))
    drift = (ends_s[1] - ends_s[0]) / (survey_s[1] - survey_s[0]) - 1.0
    drift_sigma_ppm = float(np.hypot(sound.fit.drift_sigma_ppm, device.fit.drift_sigma_ppm))
    drift_sigma_ppm = float(np.hypot(drift_sigma_ppm, _LEAST_DRIFT_SIGMA_PPM))
    return ClockGuess(survey_s[0], 1e6 * drift, sigma_s[0], drift_sigma_ppm)
