"""Hears a device over any of its wires: one thread that opens, reads, stamps the arrival, and opens again for ever."""

import logging
import threading
import time
from collections.abc import Callable
from typing import Protocol

from app.devices import link_fault
from app.devices.imu_spec import ImuChoice
from app.devices.link_fault import LinkFault
from app.devices.serial_link import SerialSource
from app.devices.socket_links import TcpSource, UdpSource
from processing.live.stream import LinkState

log = logging.getLogger(__name__)

SILENT_S = 1.5  # open, but nothing comes
PACE_S = 0.016  # between reads: what comes meanwhile waits in the system; a read a sample would cost a core's share
_FULL_BYTES = 2048  # after so much the next read follows at once
_RETRY_S = (0.1, 2.0)  # the first wait before opening again, and the longest
_STALE_EVERY_S = 1.0


class OpenLink(Protocol):
    """What is open; ``device`` names it to people."""

    device: str

    def read(self) -> bytes:
        """Return what has come, nothing after a tenth of a second; raises LinkFault when it is gone."""
        ...

    def is_stale(self) -> bool:
        """Whether it is known to be gone although reading does not say so."""
        ...

    def close(self) -> None:
        """Let it go."""
        ...


class Source(Protocol):
    """What can be opened, again and again."""

    def open(self, is_stopping: Callable[[], bool]) -> OpenLink:
        """Return it open; raises LinkFault."""
        ...


def source_of(choice: ImuChoice) -> Source:
    """Return what ``choice`` means; it must not be none."""
    if choice.kind == "serial":
        return SerialSource(choice.address, choice.baud)
    if choice.kind == "tcp":
        return TcpSource(choice.address, choice.port)
    assert choice.kind == "udp", choice
    return UdpSource(choice.address, choice.port)


class ImuLink:
    """Hands on bytes with the host time at which they came, and each change of the link's state; used once.

    Both callbacks run in the link's thread, never at the same time. ``on_state`` gets the state and, where something
    is wrong, a key of ``[reasons]``. After LOST (or WAITING) the next bytes do not continue those before: tell the
    decoder (``restart``). An exception in ``on_bytes`` is our bug: it is kept in ``error`` and ends the link.
    """

    def __init__(
        self,
        choice: ImuChoice,
        on_bytes: Callable[[bytes, float], None],
        on_state: Callable[[LinkState, str], None],
        *,
        source: Source | None = None,
    ) -> None:
        self.choice = choice
        self._source = source or source_of(choice)
        self._on_bytes, self._on_state = on_bytes, on_state
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="imu link", daemon=True)
        self.opened = 0  # how often
        self.state = LinkState.OFF
        self.reason = ""
        self.detail = ""  # the system's words about the reason, or the ports that there are
        self.device = ""  # what is open, or was last
        self.error: Exception | None = None

    def start(self) -> None:
        """Begin; the first state comes at once."""
        self._thread.start()

    def stop(self, timeout: float = 2.0) -> bool:
        """End it, and return whether the thread has ended within ``timeout`` seconds; may be called again."""
        self._stop.set()
        if self._thread.is_alive() and self._thread is not threading.current_thread():
            self._thread.join(timeout)
        return not self._thread.is_alive()

    def _run(self) -> None:
        try:
            self._tell(LinkState.WAITING)
            self._keep_open()
        except Exception as error:
            log.exception("the IMU's link ended")
            self.error = error
            self._tell(LinkState.ENDED, link_fault.OUR_FAULT, str(error))
        else:
            self._tell(LinkState.ENDED)

    def _keep_open(self) -> None:
        wait_s = _RETRY_S[0]
        while not self._stop.is_set():
            try:
                link = self._source.open(self._stop.is_set)
                self.device, self.opened = link.device, self.opened + 1
                try:
                    self._listen(link)
                finally:
                    link.close()
            except LinkFault as fault:
                if self._stop.is_set():
                    return
                if self.state is LinkState.LIVE:
                    wait_s = _RETRY_S[0]
                self._tell(LinkState.LOST if self.opened else LinkState.WAITING, fault.reason, fault.detail)
                self._stop.wait(wait_s)
                wait_s = min(2.0 * wait_s, _RETRY_S[1])

    def _listen(self, link: OpenLink) -> None:
        last_s = checked_s = time.monotonic()
        while not self._stop.is_set():
            data = link.read()
            now_s = time.monotonic()
            if data:
                last_s = now_s
                self._tell(LinkState.LIVE)
                self._on_bytes(data, now_s)
                if len(data) < _FULL_BYTES:
                    self._stop.wait(PACE_S)
            elif now_s - last_s >= SILENT_S:
                self._tell(LinkState.SILENT)
                if now_s - checked_s >= _STALE_EVERY_S:
                    checked_s = now_s
                    if link.is_stale():
                        raise LinkFault(link_fault.UNPLUGGED)

    def _tell(self, state: LinkState, reason: str = "", detail: str = "") -> None:
        self.detail = detail
        if (state, reason) != (self.state, self.reason):
            self.state, self.reason = state, reason
            log.info("IMU %s: %s %s %s", self.choice, state, reason, detail)
            self._on_state(state, reason)
