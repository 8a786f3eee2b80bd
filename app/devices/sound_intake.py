"""Takes a sound input's blocks, silence for what was lost: written, shown, counted, on the input's own worker."""

import logging
import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Protocol

import numpy as np

from app.devices.audio_spec import AudioChoice
from app.devices.live_feed import LiveFeed
from app.devices.recorder_events import Happenings
from processing.errors import LeaklineError
from processing.live.sound_timeline import SoundTimeline
from processing.live.stream import LinkState, SoundBlock, SoundFrames, SoundStatus
from processing.storage.journal import JournalEvent
from processing.storage.sound_parts import SoundForm
from processing.survey import Severity

log = logging.getLogger(__name__)

USUAL_RATE_HZ = 48_000
SILENCE_TOLD_S = 3.0
CLIP_EVERY_S = 10.0
RATE_WRONG_PPM = 1000.0
_LOOK_S = 0.02


class Input(Protocol):
    """Where sound comes from; opens its device again by itself."""

    def start(self) -> None:
        """Begin; returns at once."""

    def stop(self, timeout_s: float = ...) -> bool:
        """End."""

    def status(self) -> SoundStatus:
        """Return one look."""

    def clear_clip(self) -> None:
        """Forget that it was too loud."""

    @property
    def fault(self) -> LeaklineError | None:
        """Why there is no sound now."""


InputMaker = Callable[[AudioChoice, Callable[[SoundBlock], None]], Input]


class SoundSink(Protocol):
    """What a recording does with sound."""

    def write_sound(self, frames: SoundFrames) -> None:
        """Take frames; never waits, never raises for the disc's sake."""

    def write_silence(self, frames: int) -> None:
        """Take as many frames of silence."""


class AudioAxis(SoundTimeline):
    """A recording's audio clock against the host's; the input says which frames were lost, nothing is guessed here."""

    def follow(self, first_frame: int, frames: int, adc_host_s: float) -> None:
        """Take a block whose first frame has this number in the recording."""
        self.frames = first_frame
        if math.isfinite(adc_host_s):
            self._fit.add(np.array([first_frame / self.rate_hz]), np.array([adc_host_s]))
        self.frames += frames


class SoundIntake:
    """One input from :meth:`open` to :meth:`close`; between :meth:`begin` and :meth:`end` its sound is written."""

    def __init__(self, choice: AudioChoice, make_input: InputMaker, happenings: Happenings, feed: LiveFeed) -> None:
        self.choice = choice
        self._make_input, self._told, self._feed = make_input, happenings, feed
        self._input = make_input(choice, self._on_block)
        self._lock = threading.Lock()
        self._sink: SoundSink | None = None
        self._axis: AudioAxis | None = None
        self._base: int | None = None  # number of the recording's first frame; None before it came
        self._now: tuple[float, float] | None = None  # when the last frame was digitised, and its audio time
        self._frames = self._lost = self._gaps = 0  # of the recording, or since opening
        self._written = 0  # frames of the file, silence too
        self._final: tuple[int, int, int] | None = None  # frames, lost, gaps of the recording that has ended
        self._end_host_s: float | None = None  # when the last frame was digitised, recording or not
        self._clock: tuple[float, float] | None = None
        self._rate_hz = 0.0
        self._state = LinkState.WAITING
        self._lost_since_s: float | None = None
        self._silent_since_s: float | None = None
        self._clip_told_s = -CLIP_EVERY_S
        self._is_silence_told = self._is_clock_told = False
        self._resampled_told_hz = 0.0

    # --- from any thread

    def open(self) -> None:
        """Begin to listen; raises SOUND_LIBRARY_MISSING."""
        self._input.start()

    def close(self, timeout_s: float = 3.0) -> None:
        """Let the device go."""
        self._input.stop(timeout_s)

    def form(self) -> SoundForm:
        """Return how a recording's sound is to be written.

        A device that was never there is opened with this rate when it comes: a file cannot change its own.
        """
        status = self._input.status()
        if not status.sample_rate_hz and self.choice.rate_hz is None:
            self._input.stop()
            self.choice = replace(self.choice, rate_hz=USUAL_RATE_HZ)
            self._input = self._make_input(self.choice, self._on_block)
            self._input.start()
        rate_hz = status.sample_rate_hz or self.choice.rate_hz or USUAL_RATE_HZ
        return SoundForm(round(rate_hz), status.channels or self.choice.channels)

    def begin(self, sink: SoundSink) -> None:
        """Write from the next block on: its first frame is number 0 of the recording."""
        with self._lock:
            self._sink, self._base, self._axis, self._clock = sink, None, None, None
            self._now = None
            self._frames = self._lost = self._gaps = self._written = 0
            self._is_silence_told = self._is_clock_told = False
            self._resampled_told_hz = 0.0
            self._final = None

    def end(self, until_host_s: float = 0.0, patience_s: float = 0.0) -> None:
        """Write no more, after what was digitised before ``until_host_s`` has come, if it comes in time."""
        give_up_s = time.monotonic() + patience_s
        while time.monotonic() < give_up_s and self._input.status().state is LinkState.LIVE:
            if self._end_host_s is not None and self._end_host_s >= until_host_s:
                break
            time.sleep(_LOOK_S)
        with self._lock:
            self._sink, self._final = None, (self._frames, self._lost, self._gaps)

    def status(self) -> SoundStatus:
        """Return one look: frames and gaps are those of the recording, if there is one."""
        ppm, sigma_ppm = self._clock or (None, None)
        frames, lost, gaps = self._final or (self._frames, self._lost, self._gaps)
        return replace(
            self._input.status(),
            frames=frames,
            lost_frames=lost,
            gaps=gaps,
            clock_ppm=ppm,
            clock_sigma_ppm=sigma_ppm,
        )

    def clear_clip(self) -> None:
        """Forget that it was too loud."""
        self._input.clear_clip()

    @property
    def fault(self) -> LeaklineError | None:
        """Why there is no sound at this moment."""
        return self._input.fault

    @property
    def lock(self) -> threading.Lock:
        """Guards :attr:`axis`."""
        return self._lock

    @property
    def axis(self) -> AudioAxis | None:
        """The recording's audio clock against the host's; only to be looked at under :attr:`lock`."""
        return self._axis

    def audio_s(self, host_s: float) -> float | None:
        """Return seconds on the recording's audio clock at a moment of the host's, None before its first frame."""
        now = self._now
        return None if now is None else now[1] + (host_s - now[0])

    def look(self, now: float) -> None:
        """Notice what happened to the device since the last look; to be called a few times a second."""
        status = self._input.status()
        before, self._state = self._state, status.state
        if status.state is not before:
            self._told.note(JournalEvent.SOUND_STATE, state=status.state.value, device=status.device)
        if status.state is LinkState.LOST and before in (LinkState.LIVE, LinkState.SILENT):
            self._lost_since_s = self._end_host_s or now
            self._told.tell("recorder_sound_lost", Severity.WARNING, device=status.device)
        if status.state is LinkState.SILENT and before is LinkState.LIVE:
            self._told.tell("recorder_sound_silent", Severity.WARNING, since_s=now - (self._end_host_s or now))
        if status.state is not LinkState.LIVE:
            self._silent_since_s = None
            return
        self._look_at_levels(status, now)
        self._look_at_rate(status)
        if status.source_rate_hz and status.source_rate_hz != status.sample_rate_hz != self._resampled_told_hz:
            self._resampled_told_hz = status.sample_rate_hz
            self._told.note("sound_resampled", source=status.source, source_rate_hz=status.source_rate_hz)
            told = {"rate_hz": status.sample_rate_hz, "source_hz": status.source_rate_hz}
            self._told.tell("recorder_sound_resampled", Severity.WARNING, **told)

    def _look_at_levels(self, status: SoundStatus, now: float) -> None:
        if any(status.clipped) and now - self._clip_told_s >= CLIP_EVERY_S:
            self._clip_told_s = now
            channels = ", ".join(str(nth) for nth, clipped in enumerate(status.clipped, 1) if clipped)
            self._told.note("sound_clipped", channels=channels)
            self._told.tell("recorder_clipped", Severity.WARNING, channels=channels)
        if not status.is_digital_silence:
            self._silent_since_s, self._is_silence_told = None, False
            return
        self._silent_since_s = self._silent_since_s or now
        if not self._is_silence_told and now - self._silent_since_s >= SILENCE_TOLD_S:
            self._is_silence_told = True
            self._told.note("sound_digital_silence")
            self._told.tell("recorder_digital_silence", Severity.WARNING)

    def _look_at_rate(self, status: SoundStatus) -> None:
        if self._is_clock_told or self._clock is None:
            return
        ppm, sigma_ppm = self._clock
        if abs(ppm) > RATE_WRONG_PPM + 3.0 * sigma_ppm:
            self._is_clock_told = True
            self._told.note("sound_clock", ppm=ppm, sigma_ppm=sigma_ppm)
            measured_hz = status.sample_rate_hz * (1.0 + 1e-6 * ppm)
            told = {"measured_hz": measured_hz, "rate_hz": status.sample_rate_hz}
            self._told.tell("recorder_sound_clock", Severity.WARNING, **told)

    # --- from the input's worker thread

    def _on_block(self, block: SoundBlock) -> None:
        try:
            with self._lock:
                self._take(block)
        except Exception as error:  # a fault of ours costs one block, not the recording
            log.exception("a block of sound was not taken")
            self._told.tell("recorder_fault", Severity.WARNING, kind=type(error).__name__, detail=str(error)[:200])

    def _take(self, block: SoundBlock) -> None:
        self._rate_hz = rate_hz = self._rate_hz or self._input.status().sample_rate_hz  # it never changes
        count, is_first = len(block.frames), self._base is None
        if self._base is None:
            self._base = block.first_frame
            self._axis = AudioAxis(rate_hz)
        assert self._axis is not None
        first = block.first_frame - self._base
        self._end_host_s = block.adc_host_s + count / rate_hz
        lost = 0 if is_first else block.lost_before  # what was lost before a recording is no gap in it
        if lost:
            self._gap(lost, first - lost, block, rate_hz)
        elif self._lost_since_s is not None and self._state is LinkState.LIVE:  # else it may be from before the loss
            self._tell_return(block)
        if self._sink is not None:
            self._write(self._sink, first, block, lost)
        self._frames += count
        self._axis.follow(first, count, block.adc_host_s)
        self._now = (self._end_host_s, (first + count) / rate_hz)
        ppm, sigma_ppm = self._axis.clock_ppm, self._axis.clock_sigma_ppm
        self._clock = None if ppm is None or sigma_ppm is None else (ppm, sigma_ppm)
        self._feed.add(replace(block, first_frame=first, lost_before=lost))

    def _write(self, sink: SoundSink, first: int, block: SoundBlock, told: int) -> None:
        """Write a block where it belongs: whatever is missing before it, for whatever reason, becomes silence.

        What is missing beyond the frames that were ``told`` to be lost did not get here by a fault of ours.
        """
        missing = first - self._written
        if missing > 0:
            if missing > told:
                note = {"frame": self._written, "frames": missing - told, "reason": "live_sound_lost"}
                self._told.note(JournalEvent.SOUND_GAP, **note)
            sink.write_silence(missing)
            self._written += missing
        sink.write_sound(block.frames)
        self._written += len(block.frames)

    def _gap(self, lost: int, frame: int, block: SoundBlock, rate_hz: float) -> None:
        self._lost += lost
        self._gaps += 1
        self._told.note(JournalEvent.SOUND_GAP, frame=frame, frames=lost, reason=block.reason)
        if self._lost_since_s is not None:
            self._tell_return(block)
        else:
            self._told.add_up("recorder_sound_gap", Severity.MASKED, block.reason, lost_s=lost / rate_hz, gaps=1)

    def _tell_return(self, block: SoundBlock) -> None:
        assert self._lost_since_s is not None
        gap_s, self._lost_since_s = block.adc_host_s - self._lost_since_s, None
        self._told.tell("recorder_sound_back", Severity.MASKED, gap_s=max(0.0, gap_s))
