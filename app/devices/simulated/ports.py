"""The wires of a simulated ball: a pseudo-terminal as of a serial adapter, a TCP server, UDP datagrams.

A port never blocks: who does not read fast enough loses whole samples, as behind a real UART. Not for several threads.
"""

import os
import select
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Protocol

from processing.errors import ErrorCode, LeaklineError

_DATAGRAM_BYTES = 1400  # fits an Ethernet frame
_SETTLE_S = 0.1  # who opens a serial port throws away what is in it


class Port(Protocol):
    """One wire to whoever listens."""

    spec: str  # what `leakline record --imu` is told
    is_fresh: bool  # somebody began to listen since it was last made False

    def is_heard(self) -> bool:
        """Return whether somebody listens; lets new listeners in."""
        ...

    def write(self, pieces: Sequence[bytes]) -> int:
        """Send pieces, whole or not at all; return how many of them, from the first on, went out."""
        ...

    def unplug(self) -> None:
        """Take the wire away."""
        ...

    def replug(self) -> None:
        """Bring it back."""
        ...

    def close(self) -> None:
        """End it for good."""
        ...


class PtyPort:
    """A pseudo-terminal, with a link to it that stays the same; unplugged and plugged in again it is a new one."""

    def __init__(self, link: Path | None = None) -> None:
        if sys.platform == "win32":
            raise _cannot("pty", "Windows has no pseudo-terminals; use tcp:PORT")
        self._link = link
        self._master = -1
        self._rest = b""
        self.is_fresh = False
        self._open_since: float | None = None
        self.replug()
        self.spec = f"serial:{link or self.path}"

    def replug(self) -> None:
        """Open a new pseudo-terminal, raw, so that nothing comes back as an echo."""
        import tty

        try:
            self._master, slave = os.openpty()
            tty.setraw(slave)
            self.path = os.ttyname(slave)
            os.close(slave)
            os.set_blocking(self._master, False)
            self._point_link()
        except OSError as error:
            raise _cannot(str(self._link or "pty"), error.strerror or str(error)) from error

    def _point_link(self) -> None:
        if self._link is None:
            return
        if self._link.exists() and not self._link.is_symlink():
            raise _cannot(str(self._link), "there is a file of this name")
        aside = self._link.with_name(f".{self._link.name}.{os.getpid()}")
        aside.unlink(missing_ok=True)
        aside.symlink_to(self.path)
        aside.replace(self._link)

    def unplug(self) -> None:
        """Close the terminal and take its link away, as the system does with a serial adapter's."""
        if self._link is not None and self._link.is_symlink():
            self._link.unlink()
        if self._master >= 0:
            os.close(self._master)
        self._master, self._rest, self._open_since = -1, b"", None

    close = unplug

    def is_heard(self) -> bool:
        """Return whether the other side is open, for a moment already."""
        is_open = False
        if self._master >= 0:
            poll = select.poll()
            poll.register(self._master, select.POLLIN)
            events = dict(poll.poll(0)).get(self._master, 0)
            is_open = not events & select.POLLHUP
            if events & select.POLLIN:
                with suppress(OSError):
                    os.read(self._master, 4096)  # what the host says to the device
        if not is_open:
            self._rest, self._open_since = b"", None
        elif self._open_since is None:
            self._open_since, self.is_fresh = time.monotonic(), True
        return self._open_since is not None and time.monotonic() - self._open_since >= _SETTLE_S

    def write(self, pieces: Sequence[bytes]) -> int:
        """Write what fits; the end of a piece that did not is kept and goes first."""
        try:
            if self._rest:
                self._rest = self._rest[os.write(self._master, self._rest) :]
            if self._rest:
                return 0
            total = os.write(self._master, b"".join(pieces))
        except OSError:  # BlockingIOError too: nobody reads
            return 0
        sent, self._rest = taken(pieces, total)
        return sent


def taken(pieces: Sequence[bytes], total: int) -> tuple[int, bytes]:
    """Return how many pieces were begun when ``total`` bytes of them went out, and what is left of the last one."""
    begun, rest = 0, b""
    for piece in pieces:
        if total <= 0:
            break
        rest = piece[total:]
        total -= len(piece)
        begun += 1
    return begun, rest


class TcpPort:
    """A server for one listener at a time, the newest; unplugged it refuses them."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port
        self._server: socket.socket | None = None
        self._peer: socket.socket | None = None
        self._rest = b""
        self.is_fresh = False
        self.replug()
        self.spec = f"tcp:{'127.0.0.1' if host in {'', '0.0.0.0'} else host}:{self._port}"  # noqa: S104

    def replug(self) -> None:
        """Listen, at the port that was had before."""
        try:
            self._server = socket.create_server((self._host, self._port), backlog=1)
        except (OSError, OverflowError) as error:
            raise _cannot(f"{self._host}:{self._port}", getattr(error, "strerror", None) or str(error)) from error
        self._server.setblocking(False)
        self._port = self._server.getsockname()[1]

    def unplug(self) -> None:
        """Cut the connection and listen no more."""
        for one in (self._server, self._peer):  # in this order: who is cut off may be quick to come back
            if one is not None:
                one.close()
        self._peer = self._server = None
        self._rest = b""

    close = unplug

    def is_heard(self) -> bool:
        """Return whether somebody is connected."""
        if self._server is not None:
            with suppress(OSError):
                peer, _ = self._server.accept()
                self._drop_peer()
                peer.setblocking(False)
                peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._peer, self.is_fresh = peer, True
        if self._peer is not None:
            try:
                if not self._peer.recv(4096):
                    self._drop_peer()
            except BlockingIOError:
                pass
            except OSError:
                self._drop_peer()
        return self._peer is not None

    def _drop_peer(self) -> None:
        if self._peer is not None:
            self._peer.close()
        self._peer, self._rest = None, b""

    def write(self, pieces: Sequence[bytes]) -> int:
        """Send what the connection takes; the end of a piece that did not fit is kept and goes first."""
        if self._peer is None:
            return 0
        try:
            if self._rest:
                self._rest = self._rest[self._peer.send(self._rest) :]
            if self._rest:
                return 0
            total = self._peer.send(b"".join(pieces))
        except BlockingIOError:
            return 0
        except OSError:
            self._drop_peer()
            return 0
        sent, self._rest = taken(pieces, total)
        return sent


class UdpPort:
    """Datagrams to one address, several samples in one where they are due together."""

    def __init__(self, host: str, port: int) -> None:
        try:
            family, kind, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
            self._to: tuple[Any, ...] = address
            self._socket = socket.socket(family, kind)
        except (OSError, OverflowError) as error:
            raise _cannot(f"{host}:{port}", getattr(error, "strerror", None) or str(error)) from error
        self._socket.setblocking(False)
        self._is_plugged = True
        self.is_fresh = True
        self.spec = f"udp:{port}"

    def is_heard(self) -> bool:
        """Return whether the wire is there; who listens is not known."""
        return self._is_plugged

    def write(self, pieces: Sequence[bytes]) -> int:
        """Send the pieces, as few datagrams as they fit in."""
        sent = 0
        while sent < len(pieces):
            count, size = 0, 0
            while sent + count < len(pieces) and (not count or size + len(pieces[sent + count]) <= _DATAGRAM_BYTES):
                size += len(pieces[sent + count])
                count += 1
            try:
                self._socket.sendto(b"".join(pieces[sent : sent + count]), self._to)
            except ConnectionRefusedError:
                pass  # said of a datagram before: nobody is there yet
            except OSError:
                break
            sent += count
        return sent

    def unplug(self) -> None:
        """Send no more."""
        self._is_plugged = False

    def replug(self) -> None:
        """Send again."""
        self._is_plugged = self.is_fresh = True

    def close(self) -> None:
        """Let the socket go."""
        self._socket.close()


def open_port(words: str) -> Port:
    """Return the port of ``pty[:LINK]``, ``tcp:[HOST:]PORT`` (0: any) or ``udp:HOST:PORT``.

    Raises:
        LeaklineError: SETTING_INVALID for other words, SIMULATED_PORT_FAILED where it cannot be opened.
    """
    kind, _, rest = words.partition(":")
    if kind == "pty":
        return PtyPort(Path(rest).absolute() if rest else None)
    host, _, number = rest.rpartition(":")
    if kind in {"tcp", "udp"} and number.isascii() and number.isdecimal() and int(number) < 1 << 16:
        if kind == "tcp":
            return TcpPort(host or "127.0.0.1", int(number))
        if host:
            return UdpPort(host, int(number))
    allowed = "pty[:LINK], tcp:[HOST:]PORT, udp:HOST:PORT"
    raise LeaklineError(ErrorCode.SETTING_INVALID, name="--imu", value=words[:80], allowed=allowed)


def _cannot(what: str, reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.SIMULATED_PORT_FAILED, what=what, reason=reason)
