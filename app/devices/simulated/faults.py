"""The faults a simulated ball can be told to have, and how its samples suffer from them.

Times are seconds of the run, from when sending began. Words are parted by commas: ``kind@when`` or ``kind@when+length``
(both in seconds), and ``drift=ppm``, ``audio-drift=ppm`` for clocks that run fast against this computer's:

============== =====================================================================================================
garbage        noise on the wire: random bytes before about half of the samples
stall          the device does nothing: no sample, no count, but its clock runs on
unplug         the wire is gone: pseudo-terminal closed, connections cut and refused; the device runs on
burst          samples are held back and then come all at once
repeat         samples are sent twice (without a length: one)
lost           samples are counted, but not sent (without a length: one)
restart        the device boots: nothing for the length, then its counter and its clock begin anew
absurd-time    one sample with an impossible device time
audio-unplug   the sound source vanishes
============== =====================================================================================================
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum

import numpy as np
import numpy.typing as npt

from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import Frames

ABSURD_US = 1 << 40  # added to the device's time: twelve days
_MOST_PPM = 100_000.0
_WORD = re.compile(r"([a-z-]+)@(\d+(?:\.\d*)?)(?:\+(\d+(?:\.\d*)?))?")
_NUMBER = re.compile(r"[-+]?\d+(?:\.\d*)?")
_GARBAGE_SHARE = 0.5
_GARBAGE_BYTES = 40


class FaultKind(StrEnum):
    """What goes wrong; the module's text explains each."""

    GARBAGE = "garbage"
    STALL = "stall"
    UNPLUG = "unplug"
    BURST = "burst"
    REPEAT = "repeat"
    LOST = "lost"
    RESTART = "restart"
    ABSURD_TIME = "absurd-time"
    AUDIO_UNPLUG = "audio-unplug"


_USUAL_S = {
    FaultKind.GARBAGE: 1.0,
    FaultKind.STALL: 1.0,
    FaultKind.UNPLUG: 3.0,
    FaultKind.BURST: 0.5,
    FaultKind.RESTART: 1.0,
    FaultKind.AUDIO_UNPLUG: 3.0,
}


@dataclass(frozen=True)
class Fault:
    """One fault; a length of 0 concerns one sample."""

    kind: FaultKind
    at_s: float
    length_s: float

    @property
    def end_s(self) -> float:
        """When it is over."""
        return self.at_s + self.length_s


@dataclass(frozen=True)
class FaultPlan:
    """All that will go wrong, in order of time."""

    faults: tuple[Fault, ...] = ()
    drift_ppm: float = 0.0
    audio_drift_ppm: float = 0.0

    def of(self, *kinds: FaultKind) -> tuple[Fault, ...]:
        """Return the faults of these kinds."""
        return tuple(fault for fault in self.faults if fault.kind in kinds)


def parse_faults(words: str) -> FaultPlan:
    """Return the plan in ``words``, such as ``garbage@10+2,repeat@45,drift=80``.

    Raises:
        LeaklineError: SIMULATED_FAULT_UNKNOWN.
    """
    faults: list[Fault] = []
    drifts = {"drift": 0.0, "audio-drift": 0.0}
    for word in filter(None, (word.strip() for word in words.split(","))):
        name, is_number, number = word.partition("=")
        if is_number and name in drifts and _NUMBER.fullmatch(number) and abs(float(number)) <= _MOST_PPM:
            drifts[name] = float(number)
            continue
        found = _WORD.fullmatch(word)
        if found is None or found[1] not in set(FaultKind):
            known = ", ".join([*FaultKind, *drifts])
            raise LeaklineError(ErrorCode.SIMULATED_FAULT_UNKNOWN, word=word[:60], known=known)
        kind = FaultKind(found[1])
        faults.append(Fault(kind, float(found[2]), float(found[3] or _USUAL_S.get(kind, 0.0))))
    faults.sort(key=lambda fault: fault.at_s)
    return FaultPlan(tuple(faults), drifts["drift"], drifts["audio-drift"])


class Fate(StrEnum):
    """What becomes of a sample."""

    SENT = "sent"
    TWICE = "twice"  # this is the second sending
    LOST = "lost"  # counted, never sent
    UNPLUGGED = "unplugged"  # the wire was gone
    SPOILT = "spoilt"  # sent behind noise, in a protocol where that may cost it
    UNHEARD = "unheard"  # nobody listened, or did not read fast enough


@dataclass(frozen=True)
class Rows:
    """Samples on their way: when each is due (seconds of the run), what becomes of it, and the noise before it."""

    frames: Frames
    due_s: npt.NDArray[np.float64]
    fates: list[Fate]
    noise: list[bytes]


@dataclass
class FaultyRows:
    """Does to a device's samples what a plan says, block by block; the same seed makes the same noise."""

    plan: FaultPlan
    seed: int = 0
    _count: int = 0  # samples since the device started
    _started_us: int = 0  # what its clock is behind by since it was restarted
    _single: set[Fault] = field(default_factory=set)  # faults of one sample that happened already
    _restarted: set[Fault] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._rng = np.random.default_rng([self.seed, 77])

    def apply(self, frames: Frames, run_s: npt.NDArray[np.float64]) -> Rows:
        """Return what becomes of samples whose times on the device's first clock are ``run_s``, rising."""
        exists = ~self._within(run_s, self.plan.of(FaultKind.STALL, FaultKind.RESTART))
        frames, run_s = taken(frames, exists), run_s[exists]
        frames = self._counted(frames, run_s)
        for fault in self._due_once(FaultKind.ABSURD_TIME, run_s):
            frames.time_us[np.searchsorted(run_s, fault.at_s)] += np.uint64(ABSURD_US)
        fates = np.empty(len(run_s), object)
        fates.fill(Fate.SENT)  # np.full would make plain text of it
        fates[self._hit(run_s, FaultKind.LOST)] = Fate.LOST
        fates[self._within(run_s, self.plan.of(FaultKind.UNPLUG))] = Fate.UNPLUGGED
        due_s = run_s.copy()
        for fault in self.plan.of(FaultKind.BURST):
            held = (run_s >= fault.at_s) & (run_s < fault.end_s)
            due_s[held] = fault.end_s
        noise = self._noise(run_s)
        again = self._hit(run_s, FaultKind.REPEAT) & (fates == Fate.SENT)
        if again.any():
            order = np.repeat(np.arange(len(run_s)), 1 + again)
            second = np.zeros(len(order), np.bool_)
            second[1:] = order[1:] == order[:-1]
            frames, due_s, fates = taken(frames, order), due_s[order], fates[order]
            fates[second] = Fate.TWICE
            noise = [b"" if is_second else noise[k] for k, is_second in zip(order.tolist(), second.tolist())]
        return Rows(frames, due_s, fates.tolist(), noise)

    def _counted(self, frames: Frames, run_s: npt.NDArray[np.float64]) -> Frames:
        """Count the samples, and let counter and clock begin anew where the device does."""
        counter = np.arange(self._count, self._count + len(run_s), dtype=np.uint64)
        time_us = frames.time_us.copy()
        offset_us = np.full(len(run_s), self._started_us, np.uint64)
        for fault in self.plan.of(FaultKind.RESTART):
            if fault not in self._restarted and len(run_s) and run_s[-1] >= fault.end_s:
                self._restarted.add(fault)
                first = int(np.searchsorted(run_s, fault.end_s))
                counter[first:] -= counter[first]
                self._started_us = int(time_us[first])
                offset_us[first:] = self._started_us
        self._count = int(counter[-1]) + 1 if len(counter) else self._count
        columns = {f.name: getattr(frames, f.name) for f in fields(frames)}
        columns["counter"] = (counter & np.uint64(0xFFFFFFFF)).astype(np.uint32)
        columns["time_us"] = time_us - offset_us
        return Frames(**columns)

    def _noise(self, run_s: npt.NDArray[np.float64]) -> list[bytes]:
        noisy = self._within(run_s, self.plan.of(FaultKind.GARBAGE))
        noise = [b""] * len(run_s)
        for row in np.flatnonzero(noisy).tolist():
            if self._rng.random() < _GARBAGE_SHARE:
                # the last byte is no text: a stray digit before a line would make another number of it, which a
                # protocol without a sum cannot notice
                noise[row] = self._rng.bytes(int(self._rng.integers(1, _GARBAGE_BYTES))) + b"\xff"
        return noise

    def _hit(self, run_s: npt.NDArray[np.float64], kind: FaultKind) -> npt.NDArray[np.bool_]:
        """Return which samples faults concern that may last, or concern one sample."""
        hit = self._within(run_s, self.plan.of(kind))
        for fault in self._due_once(kind, run_s):
            hit[np.searchsorted(run_s, fault.at_s)] = True
        return hit

    def _due_once(self, kind: FaultKind, run_s: npt.NDArray[np.float64]) -> list[Fault]:
        """Return the faults of one sample whose turn is in this block."""
        due = [
            fault
            for fault in self.plan.of(kind)
            if fault.length_s == 0 and fault not in self._single and len(run_s) and run_s[-1] >= fault.at_s
        ]
        self._single.update(due)
        return due

    @staticmethod
    def _within(run_s: npt.NDArray[np.float64], faults: Sequence[Fault]) -> npt.NDArray[np.bool_]:
        within = np.zeros(len(run_s), np.bool_)
        for fault in faults:
            within |= (run_s >= fault.at_s) & (run_s < fault.end_s)
        return within


def taken(frames: Frames, which: npt.NDArray[np.bool_] | npt.NDArray[np.intp]) -> Frames:
    """Return some of the samples, as copies."""
    return Frames(**{f.name: getattr(frames, f.name)[which] for f in fields(frames)})
