"""Takes an IMU's bytes from its link: decoded, placed on survey time, written, shown, counted, on a thread of its own.

The link's thread only puts bytes into a queue: a serial port's buffer overflows within a tenth of a second, so neither
the decoder nor the disc may ever hold it up.
"""

import logging
import queue
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

from app.devices.imu_spec import ImuChoice
from app.devices.live_feed import LiveFeed
from app.devices.recorder_events import Happenings
from processing.importing.frames import Frames
from processing.live.decoders import DecoderCounts, ImuDecoder
from processing.live.device_timeline import DeviceTimeline, Placed
from processing.live.stream import LinkState, MotionBlock, MotionStatus
from processing.storage.journal import JournalEvent
from processing.survey import Severity, Stretch

log = logging.getLogger(__name__)

SILENT_S = 1.0  # connected, and no sample for this long
UNKNOWN_BYTES = 4096  # without a sample in them
GARBAGE_TOLD = 100  # bytes: less is the torn end of a message, at most
RATE_OVER_S = 2.0
RATE_WRONG_PPM = (
    2000.0  # crystals are within 100 ppm, the RC oscillators of cheap sensors within 1 %: told, not refused
)
MOST_WAITING = 64 << 20  # bytes
HOLES_AT_ONCE = 1000  # lines of the journal; a link that stutters has one a second from there on
SHORT_HOLE_S = 1.0
_BATCH_BYTES = 1 << 16
_BATCH_S = 0.02  # what comes within it is taken at once: a tenth of the work, and no picture is faster
_FIT_EVERY_S = 0.5
_LOOK_S = 0.005
_END = (b"", -1.0)


class Link(Protocol):
    """Where bytes come from; reconnects by itself."""

    def start(self) -> None:
        """Begin; returns at once."""

    def stop(self, timeout: float = ..., /) -> object:
        """End."""

    @property
    def device(self) -> str:
        """What is open, or was last."""

    @property
    def detail(self) -> str:
        """The system's words about the reason."""


OnBytes = Callable[[bytes, float], None]
OnState = Callable[[LinkState, str], None]
LinkMaker = Callable[[ImuChoice, OnBytes, OnState], Link]


class MotionSink(Protocol):
    """What a recording does with samples."""

    def write_motion(self, frames: Frames) -> None:
        """Take samples; never waits, never raises for the disc's sake."""


@dataclass(frozen=True)
class _Axis:
    """Survey time near one moment, for whoever may not wait for the intake's thread."""

    host_s: float
    survey_s: float
    rate: float  # survey seconds a host second


class MotionIntake:
    """One IMU from :meth:`open` to :meth:`close`; between :meth:`begin` and :meth:`end` its samples are written."""

    def __init__(
        self, choice: ImuChoice, make_link: LinkMaker, decoder: ImuDecoder, happenings: Happenings, feed: LiveFeed
    ) -> None:
        self.choice = choice
        self._decoder, self._told, self._feed = decoder, happenings, feed
        self._link = make_link(choice, self._on_bytes, self._on_state)
        self._timeline = DeviceTimeline()
        self._queue: queue.SimpleQueue[tuple[bytes, float]] = queue.SimpleQueue()
        self._ahead: tuple[bytes, float] | None = None  # taken from the queue, and not yet for its turn
        self._put_bytes = self._taken_bytes = 0  # each written by one thread only
        self._refused_bytes = 0
        self._lock = threading.Lock()  # of the timeline, the sink and the counts
        self._sink: MotionSink | None = None
        self._counts = MotionStatus()
        self._seen = DecoderCounts()
        self._untold_garbage = 0
        self._holes_noted = self._unnoted_lost = 0
        self._hole_noted_s = 0.0
        self._link_state, self._reason = LinkState.WAITING, ""
        self._looked = LinkState.WAITING
        self._last_sample_s: float | None = None
        self._was_lost = self._is_again = False
        self._unknown_bytes = 0
        self._arrivals: deque[tuple[float, int]] = deque()  # host time, samples since the beginning
        self._came = 0
        self._axis: _Axis | None = None
        self._fitted_s = 0.0
        self._is_clock_told = self._is_unknown_told = False
        self._final: MotionStatus | None = None  # of the recording that has ended
        self._thread = threading.Thread(target=self._work, name="motion", daemon=True)

    # --- from any thread

    def open(self) -> None:
        """Begin to listen."""
        self._thread.start()
        self._link.start()

    def close(self, timeout_s: float = 3.0) -> None:
        """Let the device go, and take in what came until then."""
        self._link.stop(timeout_s)
        self._queue.put(_END)
        if self._thread.ident is not None:
            self._thread.join(timeout_s)

    def begin(self, sink: MotionSink) -> None:
        """Write from the next sample on: it is survey time 0."""
        with self._lock:
            self._timeline.begin()
            self._sink, self._axis = sink, None
            self._counts = MotionStatus()
            self._untold_garbage = 0
            self._holes_noted = self._unnoted_lost = 0
            self._hole_noted_s = 0.0
            self._is_clock_told, self._final = False, None

    def end(self, patience_s: float = 10.0) -> None:
        """Write no more, after all that came until now is with the sink, if that is so in time."""
        until, give_up_s = self._put_bytes, time.monotonic() + patience_s
        while self._taken_bytes < until and self._thread.is_alive() and time.monotonic() < give_up_s:
            time.sleep(_LOOK_S)
        with self._lock:
            self._sink, self._final = None, self._counts
            lost, self._unnoted_lost = self._unnoted_lost, 0
        if lost:
            self._told.note(JournalEvent.MOTION_GAP, lost=lost)

    def status(self) -> MotionStatus:
        """Return one look; never waits for a sample or the disc."""
        now = time.monotonic()
        return replace(
            self._final or self._counts,
            state=self.state(now),
            device=self._link.device or str(self.choice),
            protocol=self._decoder.name,
            rate_hz=self._rate_hz(now),
            reason=self._reason,
            detail=self._link.detail,
        )

    def state(self, now: float) -> LinkState:
        """Return how the IMU is: alive means that samples come."""
        if self._link_state is not LinkState.LIVE:
            return self._link_state
        last = self._last_sample_s
        if last is None:
            return LinkState.WAITING
        is_live = now - last <= SILENT_S or (self._waiting_bytes > 0 and not self._unknown_bytes)
        return LinkState.LIVE if is_live else LinkState.SILENT

    @property
    def _waiting_bytes(self) -> int:
        return self._put_bytes - self._taken_bytes

    def look(self, now: float) -> None:
        """Notice that samples have ceased to come; to be called a few times a second, by one thread."""
        before, self._looked = self._looked, self.state(now)
        if self._looked is LinkState.SILENT and before is LinkState.LIVE:
            since_s = now - (self._last_sample_s or now)
            self._told.note("motion_silent", since_s=since_s)
            self._told.tell("recorder_imu_silent", Severity.WARNING, since_s=since_s)

    def survey_s(self, host_s: float) -> float | None:
        """Return survey time at a moment of the host's clock, None before the recording's first sample."""
        axis = self._axis
        return None if axis is None else axis.survey_s + axis.rate * (host_s - axis.host_s)

    @property
    def timeline(self) -> DeviceTimeline:
        """The axis; only to be looked at under :attr:`lock`."""
        return self._timeline

    @property
    def lock(self) -> threading.Lock:
        """Guards the timeline."""
        return self._lock

    # --- from the link's thread

    def _on_bytes(self, data: bytes, host_s: float) -> None:
        if self._waiting_bytes > MOST_WAITING:
            self._refused_bytes += len(data)
            return
        self._put_bytes += len(data)
        self._queue.put((data, host_s))

    def _on_state(self, state: LinkState, reason: str) -> None:
        before, now = self._link_state, time.monotonic()
        self._link_state, self._reason = state, reason
        if state is before:
            return
        device = self._link.device or str(self.choice)
        self._told.note(JournalEvent.MOTION_STATE, state=state.value, device=device, reason=reason)
        if state is LinkState.LOST and before in (LinkState.LIVE, LinkState.SILENT):
            self._was_lost = True
            self._told.tell("recorder_imu_lost", Severity.WARNING, device=device)
        if state is LinkState.LIVE and before in (LinkState.LOST, LinkState.WAITING):
            self._queue.put((b"", now))  # in its place among the bytes: what was torn is forgotten

    # --- the thread

    def _work(self) -> None:
        while (batch := self._next_batch()) is not None:
            data, host_s = batch
            try:
                with self._lock:
                    self._take(data, host_s)
            except Exception as error:  # a fault of ours costs one block, not the recording
                log.exception("a block of motion was not taken")
                self._told.tell("recorder_fault", Severity.WARNING, kind=type(error).__name__, detail=str(error)[:200])
            self._taken_bytes += len(data)

    def _next_batch(self) -> tuple[bytes, float] | None:
        """Return bytes and when the last of them came, no bytes where the link began anew, None at the end.

        The earlier ones of a batch count as late, which arrivals are all the time: the earliest tell the clock.
        """
        (data, host_s), self._ahead = self._ahead or self._queue.get(), None
        if not data:
            return None if host_s == _END[1] else (data, host_s)
        if self._waiting_bytes <= _BATCH_BYTES:
            time.sleep(_BATCH_S)
        pieces, size = [data], len(data)
        while size < _BATCH_BYTES and not self._queue.empty():
            self._ahead = self._queue.get()
            if not self._ahead[0]:
                break
            data, host_s = self._ahead
            self._ahead = None
            pieces.append(data)
            size += len(data)
        return b"".join(pieces), host_s

    def _take(self, data: bytes, host_s: float) -> None:
        if not data:
            self._decoder.restart()
            self._is_again = True
            return
        frames = self._decoder.feed(data)
        self._look_at_garbage()
        self._look_at_refused()
        if not len(frames):
            self._unknown_bytes += len(data)
            if self._unknown_bytes > UNKNOWN_BYTES and not self._is_unknown_told:
                self._is_unknown_told = True
                self._told.tell("recorder_imu_unknown", Severity.WARNING)
            return
        self._unknown_bytes, self._is_unknown_told = 0, False
        placed = self._timeline.place(frames, host_s, self._decoder.has_time)
        self._came += len(frames)
        self._note_arrival(host_s)
        self._tell_return(host_s)
        self._last_sample_s = host_s
        self._look_at_clock(host_s)
        if len(placed.frames):
            if self._sink is not None:
                self._sink.write_motion(placed.frames)
            if self._feed.is_open:
                self._feed.add(MotionBlock(self._timeline.to_samples(placed.frames), host_s))
        self._count(placed)

    def _count(self, placed: Placed) -> None:
        counts = self._counts
        self._counts = replace(
            counts,
            samples=counts.samples + len(placed.frames),
            lost=counts.lost + placed.lost,
            repeated=counts.repeated + placed.repeated,
            gaps=counts.gaps + len(placed.holes),
            restarts=counts.restarts + placed.restarted,
        )
        lost = placed.lost  # of all holes of the batch together: there is seldom more than one
        for hole in placed.holes:
            self._note_hole(hole, lost)
            lost = 0
        if placed.holes or placed.lost:
            self._told.add_up("recorder_imu_gap", Severity.MASKED, lost=placed.lost, gaps=max(1, len(placed.holes)))
        if placed.repeated:
            self._told.add_up("recorder_imu_repeated", Severity.REPAIRED, count=placed.repeated)
        if placed.absurd:
            self._told.note("motion_absurd", count=placed.absurd)
            self._told.add_up("recorder_imu_absurd", Severity.MASKED, count=placed.absurd)
        if placed.restarted:
            self._told.note(JournalEvent.MOTION_RESTART, time_us=int(placed.frames.time_us[0]))
            self._told.tell("recorder_imu_restarted", Severity.REPAIRED)

    def _look_at_garbage(self) -> None:
        counts = self._decoder.counts()
        garbage = max(0, counts.garbage_bytes - self._seen.garbage_bytes)
        bad_sums = max(0, counts.bad_sums - self._seen.bad_sums)
        self._seen = counts
        if not garbage and not bad_sums:
            return
        now = self._counts
        self._counts = replace(now, garbage_bytes=now.garbage_bytes + garbage, bad_sums=now.bad_sums + bad_sums)
        self._untold_garbage += garbage
        if self._untold_garbage >= GARBAGE_TOLD:
            self._told.note("motion_garbage", bytes=self._untold_garbage, bad_sums=bad_sums)
            self._told.add_up("recorder_imu_garbage", Severity.MASKED, bytes=self._untold_garbage)
            self._untold_garbage = 0

    def _note_hole(self, hole: Stretch, lost: int) -> None:
        """Keep a hole in the journal; of a link that stutters for hours one a second: the samples tell the others."""
        self._unnoted_lost += lost
        is_short = hole.end_s - hole.start_s < SHORT_HOLE_S
        if is_short and self._holes_noted > HOLES_AT_ONCE and hole.start_s < self._hole_noted_s + 1.0:
            return
        self._holes_noted += 1
        self._hole_noted_s = hole.start_s
        self._told.note(
            JournalEvent.MOTION_GAP,
            start_s=hole.start_s,
            end_s=hole.end_s,
            lost=self._unnoted_lost,
            reason=hole.reason,
        )
        self._unnoted_lost = 0

    def _look_at_refused(self) -> None:
        refused = self._refused_bytes
        if refused and not self._queue.qsize():
            self._refused_bytes -= refused
            self._told.note("motion_refused", bytes=refused)
            self._told.add_up("recorder_imu_refused", Severity.MASKED, bytes=refused)

    def _tell_return(self, host_s: float) -> None:
        if not self._is_again:  # what comes may still be from before the loss
            return
        self._is_again = False
        if self._was_lost and self._last_sample_s is not None:
            self._told.tell("recorder_imu_back", Severity.MASKED, gap_s=host_s - self._last_sample_s)
        self._was_lost = False

    def _look_at_clock(self, host_s: float) -> None:
        """Keep what others may ask at any moment, twice a second."""
        if self._axis is not None and host_s - self._fitted_s < _FIT_EVERY_S:
            return
        self._fitted_s = host_s
        timeline = self._timeline
        at, later = timeline.survey_s(host_s), timeline.survey_s(host_s + 1.0)
        if at is not None and later is not None:
            self._axis = _Axis(host_s, at[0], later[0] - at[0])
        ppm, jitter_s = timeline.clock_ppm, timeline.jitter_s
        self._counts = replace(
            self._counts,
            clock_ppm=ppm,
            clock_sigma_ppm=timeline.clock_sigma_ppm,
            jitter_ms=None if jitter_s is None else 1e3 * jitter_s,
        )
        sigma = timeline.clock_sigma_ppm
        if ppm is None or sigma is None or self._is_clock_told:
            return
        if abs(ppm) > RATE_WRONG_PPM + 3.0 * sigma:
            self._is_clock_told = True
            self._told.note("motion_clock", ppm=ppm, sigma_ppm=sigma)
            self._told.tell("recorder_imu_clock", Severity.WARNING, percent=1e-4 * ppm)

    # --- the rate, by the host's clock: what comes, not what the device says

    def _note_arrival(self, host_s: float) -> None:
        arrivals = self._arrivals
        arrivals.append((host_s, self._came))
        while len(arrivals) > 2 and arrivals[1][0] <= host_s - RATE_OVER_S:
            arrivals.popleft()

    def _rate_hz(self, now: float) -> float | None:
        try:
            (first_s, first), (last_s, last) = self._arrivals[0], self._arrivals[-1]
        except IndexError:
            return None
        if now - last_s > RATE_OVER_S:
            return 0.0
        return (last - first) / (last_s - first_s) if last_s > first_s else None
