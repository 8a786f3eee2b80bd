"""Sends a ball's samples over a port, each at its time: one thread, paced by this computer's clock."""

import logging
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.devices.simulated.faults import Fate, Fault, FaultKind, FaultPlan, FaultyRows, Rows
from app.devices.simulated.ports import Port
from app.devices.simulated.protocols import Encoder
from app.devices.simulated.source import RowReel
from app.devices.simulated.truth import TruthFile
from processing.importing.frames import Frames

log = logging.getLogger(__name__)

_BLOCK_S = 0.25  # encoded at once
_LOOK_S = 0.02  # at least so often it is looked who listens
_LINGER_S = 0.2  # what was written last is read before the port goes
_HEADER_EVERY_S = 1.0


@dataclass(frozen=True)
class Pace:
    """How the run's seconds (on the device's clock) follow the host's."""

    drift_ppm: float = 0.0
    speed: float = 1.0
    rate_hz: float = 100.0

    def host_of(self, run_s: float) -> float:
        """Return host seconds since the start of a moment of the run."""
        return run_s / (1.0 + 1e-6 * self.drift_ppm) / self.speed

    def run_of(self, host_s: float) -> float:
        """Return the moment of the run at host seconds since the start."""
        return host_s * (1.0 + 1e-6 * self.drift_ppm) * self.speed


class RowSender:
    """Runs once from :meth:`start` until the run ends, :meth:`stop`, or a fault of ours, kept in ``error``.

    With ``wait`` it begins when somebody listens; ``on_start`` is called then, with the host time.
    """

    def __init__(
        self,
        reel: RowReel,
        make_encoder: Callable[[Frames], Encoder],
        port: Port,
        pace: Pace,
        plan: FaultPlan,
        *,
        seed: int = 0,
        wait: bool = True,
        truth: TruthFile | None = None,
        on_start: Callable[[float], None] = lambda _: None,
        on_fault: Callable[[Fault], None] = lambda _: None,
    ) -> None:
        self._reel, self._port, self._pace, self._plan = reel, port, pace, plan
        self._make_encoder, self._truth = make_encoder, truth
        self._faulty = FaultyRows(plan, seed)
        self._wait, self._on_start, self._on_fault = wait, on_start, on_fault
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="simulated ball", daemon=True)
        self._begun = 0.0
        self._header_due = 0.0
        self._looked_s, self._is_heard = 0.0, False
        self._events = _events(plan)
        self.error: Exception | None = None
        self.sent = 0

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def stop(self, timeout_s: float = 5.0) -> None:
        """End; returns when the thread has ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(timeout_s)

    def wait(self, timeout_s: float) -> bool:
        """Return whether it has ended within so many seconds."""
        self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def is_over(self, seconds: float | None) -> bool:
        """Return whether it has been sending for so many seconds."""
        return seconds is not None and self._begun > 0.0 and time.monotonic() - self._begun >= seconds

    def _run(self) -> None:
        try:
            self._send_all()
        except Exception as error:  # noqa: BLE001  # told by whoever waits
            log.warning("the simulated ball ended: %s", error)
            self.error = error
        finally:
            self._port.close()

    def _send_all(self) -> None:
        size = max(1, round(_BLOCK_S * self._pace.rate_hz * self._pace.speed))
        frames, run_s = self._reel.take(size)
        encoder = self._make_encoder(frames)
        while self._wait and not self._port.is_heard():
            if self._stop.wait(_LOOK_S):
                return
        self._begun = time.monotonic()
        self._on_start(self._begun)
        while len(frames) and not self._stop.is_set():
            self._send_block(self._faulty.apply(frames, run_s), encoder)
            frames, run_s = self._reel.take(size)
        self._stop.wait(_LINGER_S)

    def _send_block(self, rows: Rows, encoder: Encoder) -> None:
        data = encoder.encode(rows.frames)
        wired = [noise + bytes_ if noise else bytes_ for noise, bytes_ in zip(rows.noise, data)]
        host_due = (self._begun + self._pace.host_of(1.0) * rows.due_s).tolist()
        sent_s = np.zeros(len(data))
        fates = list(rows.fates)
        at = 0
        while at < len(data) and self._sleep_until(host_due[at]):
            now = time.monotonic()
            end = at + 1
            while end < len(data) and host_due[end] <= now:
                end += 1
            self._happen(now)
            self._write_rows(range(at, end), wired, fates, rows, encoder)
            sent_s[at:end] = time.monotonic()
            at = end
        if self._truth is not None and at:
            self._truth.rows(_first(rows, at), sent_s[:at], fates[:at])

    def _write_rows(self, which: range, wired: list[bytes], fates: list[Fate], rows: Rows, encoder: Encoder) -> None:
        """Send samples that are due, and write into ``fates`` what became of them."""
        going = [row for row in which if fates[row] in {Fate.SENT, Fate.TWICE}]
        heard = self._look()
        pieces = [wired[row] for row in going]
        extra = 0
        if heard and going and self._header_is_due() and (header := encoder.header()):
            pieces.insert(0, header)
            extra = 1
        sent = max(0, self._port.write(pieces) - extra) if heard and pieces else 0
        self.sent += sent
        for number, row in enumerate(going):
            if number >= sent:
                fates[row] = Fate.UNHEARD
            elif rows.noise[row] and not encoder.is_checked:
                fates[row] = Fate.SPOILT

    def _look(self) -> bool:
        """Return whether somebody listens, as of a moment ago: asking before each sample costs more than sending it."""
        now = time.monotonic()
        if now - self._looked_s >= _LOOK_S:
            self._looked_s, self._is_heard = now, self._port.is_heard()
        return self._is_heard

    def _header_is_due(self) -> bool:
        now = time.monotonic()
        if not self._port.is_fresh and now < self._header_due:
            return False
        self._port.is_fresh, self._header_due = False, now + _HEADER_EVERY_S
        return True

    def _sleep_until(self, host_s: float) -> bool:
        """Wait, looking after listeners and faults meanwhile; return False when it shall end."""
        while (left := host_s - time.monotonic()) > 0:
            time.sleep(
                min(left, _LOOK_S)
            )  # waiting for the event takes more of the processor, a thousand times a second
            if self._stop.is_set():
                return False
            if left > _LOOK_S:
                self._look()
                self._happen(time.monotonic())
        return not self._stop.is_set()

    def _happen(self, host_s: float) -> None:
        """Let faults begin and end whose time has come."""
        while self._events and self._begun + self._pace.host_of(self._events[0][0]) <= host_s:
            _, fault, begins = self._events.pop(0)
            if fault.kind is FaultKind.UNPLUG:
                (self._port.unplug if begins else self._port.replug)()
                self._looked_s = 0.0
            if begins:
                self._on_fault(fault)
                if self._truth is not None:
                    self._truth.note(
                        "fault", kind=fault.kind, at_s=fault.at_s, length_s=fault.length_s, host_s=host_s
                    )  # fmt: skip


def _events(plan: FaultPlan) -> list[tuple[float, Fault, bool]]:
    """Return when faults begin and end."""
    events = [(fault.at_s, fault, True) for fault in plan.faults]
    events += [(fault.end_s, fault, False) for fault in plan.faults]
    return sorted(events, key=lambda event: event[0])


def _first(rows: Rows, count: int) -> Rows:
    if count == len(rows.fates):
        return rows
    columns = {name: getattr(rows.frames, name)[:count] for name in Frames.__dataclass_fields__}
    return Rows(Frames(**columns), rows.due_s[:count], rows.fates[:count], rows.noise[:count])
