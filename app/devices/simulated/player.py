"""Plays a ball's sound beside its samples: one thread, paced by this computer's clock with the sound card's drift."""

import logging
import threading
import time

import numpy as np

from app.devices.simulated.faults import Fault
from app.devices.simulated.sound_out import SoundOut
from app.devices.simulated.source import SoundArray, Tape
from app.devices.simulated.truth import TruthFile

log = logging.getLogger(__name__)

_BLOCK_S = 0.01
_AHEAD_S = 2.0  # read from the tape at once, so that making it does not disturb the pace


class TapePlayer:
    """Runs once from :meth:`start` to the tape's end, :meth:`stop`, or a fault of ours, kept in ``error``.

    With ``lap_s`` the tape begins anew each so many seconds, after silence where it is shorter. While the source is
    unplugged by one of ``faults`` time goes on, and what would have been heard is lost.
    """

    def __init__(
        self,
        tape: Tape,
        out: SoundOut,
        *,
        drift_ppm: float = 0.0,
        lap_s: float | None = None,
        faults: tuple[Fault, ...] = (),
        truth: TruthFile | None = None,
    ) -> None:
        self._tape, self._out, self._truth = tape, out, truth
        self._rate_hz = tape.rate_hz * (1.0 + 1e-6 * drift_ppm)
        self._lap = None if lap_s is None else max(1, round(lap_s * self._rate_hz))
        self._faults = sorted(faults, key=lambda fault: fault.at_s)
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="simulated sound", daemon=True)
        self._ahead: SoundArray = np.zeros((0, tape.channels), np.float32)
        self._in_lap = 0  # frames taken of this lap
        self._begun = 0.0
        self.frames = 0
        self.heard = 0
        self.error: Exception | None = None

    def start(self, host_s: float) -> None:
        """Begin: the first frame belongs to ``host_s``."""
        self._begun = host_s
        self._thread.start()

    def stop(self, timeout_s: float = 5.0) -> None:
        """End and let the sound source go."""
        self._stop.set()
        if self._out.sets_pace:
            self._out.close()  # a write that waits ends
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        if not self._out.sets_pace:
            self._out.close()
        self._tape.close()

    def _run(self) -> None:
        try:
            if self._out.sets_pace:
                self._play_as_taken()
            else:
                self._play_in_time()
        except Exception as error:  # noqa: BLE001  # told by whoever waits
            if not self._stop.is_set():
                log.warning("the simulated sound ended: %s", error)
                self.error = error

    def _play_as_taken(self) -> None:
        block = max(1, round(0.1 * self._rate_hz))
        while not self._stop.is_set() and len(sound := self._next(block)):
            self._put(sound)

    def _play_in_time(self) -> None:
        size = max(1, round(_BLOCK_S * self._rate_hz))
        while not self._stop.is_set():
            if self._plug():
                continue
            due_s = self._begun + (self.frames + size) / self._rate_hz
            if (left := due_s - time.monotonic()) > 0 and self._stop.wait(left):
                return
            if not len(sound := self._next(size)):
                return
            self._put(sound)

    def _put(self, sound: SoundArray) -> None:
        self.heard += self._out.write(sound)
        self.frames += len(sound)
        if self._truth is not None:
            self._truth.sound(sound, self._tape.rate_hz)

    def _plug(self) -> bool:
        """Let the next fault happen when it is time; the sound meanwhile is passed over. Return whether it was."""
        if not self._faults or self.frames < self._faults[0].at_s * self._rate_hz:
            return False
        fault = self._faults.pop(0)
        self._out.unplug()
        end = self._begun + fault.end_s
        while (left := end - time.monotonic()) > 0:
            if self._stop.wait(min(left, 0.5)):
                return True
        self._out.replug()
        missed = max(0, round((time.monotonic() - self._begun) * self._rate_hz) - self.frames)
        while missed > 0 and len(sound := self._next(min(missed, self._tape.rate_hz))):
            missed -= len(sound)
            self.frames += len(sound)
            if self._truth is not None:
                self._truth.sound(sound, self._tape.rate_hz)
        return True

    def _next(self, count: int) -> SoundArray:
        """Return the next frames; none at the end of the run."""
        if self._lap is not None:
            if self._in_lap >= self._lap:
                self._tape.rewind()
                self._ahead, self._in_lap = self._ahead[:0], 0
            count = min(count, self._lap - self._in_lap)
        if len(self._ahead) < count:
            more = self._tape.read(max(count, round(_AHEAD_S * self._rate_hz)))
            self._ahead = np.concatenate([self._ahead, more]) if len(self._ahead) else more
        sound, self._ahead = self._ahead[:count], self._ahead[count:]
        if self._lap is not None and len(sound) < count:
            sound = np.concatenate([sound, np.zeros((count - len(sound), self._tape.channels), np.float32)])
        self._in_lap += len(sound)
        return sound
