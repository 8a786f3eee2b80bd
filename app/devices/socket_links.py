"""TCP and UDP as sources of bytes: a client that connects to the device, and a listener for its datagrams."""

import logging
import selectors
import socket
import sys
import time
from collections.abc import Callable
from typing import Any

from app.devices import link_fault
from app.devices.link_fault import LinkFault, fault_of

log = logging.getLogger(__name__)

WAIT_S = 0.1
CONNECT_S = 3.0
_MOST_BYTES = 1 << 16
_MOST_DATAGRAMS = 256  # handed on together
_KERNEL_BYTES = 1 << 20  # kept for us while this computer is busy
# a device that went without a word (out of range, flat) is found out after about eleven seconds
_KEEPALIVE = (("TCP_KEEPIDLE", 5), ("TCP_KEEPALIVE", 5), ("TCP_KEEPINTVL", 2), ("TCP_KEEPCNT", 3))


class TcpSource:
    """Connects to ``host:port``, again and again."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port

    def open(self, is_stopping: Callable[[], bool]) -> "TcpStream":
        """Return the connection; raises LinkFault, within :data:`CONNECT_S` or when ``is_stopping`` says so."""
        fault = LinkFault(link_fault.UNREACHABLE)
        for family, kind, protocol, _, address in _addresses(self._host, self._port, socket.SOCK_STREAM):
            connection = socket.socket(family, kind, protocol)
            try:
                _connect(connection, address, is_stopping)
                _keep_alive(connection)
            except (OSError, LinkFault) as error:
                connection.close()
                fault = error if isinstance(error, LinkFault) else fault_of(error)
                if is_stopping():
                    break
            else:
                return TcpStream(connection, f"{self._host}:{self._port}")
        raise fault


class TcpStream:
    """An open connection."""

    def __init__(self, connection: socket.socket, device: str) -> None:
        self._socket, self.device = connection, device
        connection.settimeout(WAIT_S)

    def read(self) -> bytes:
        """Return what has come, after :data:`WAIT_S` at the latest; raises LinkFault when the other side is gone."""
        try:
            data = self._socket.recv(_MOST_BYTES)
        except TimeoutError as error:
            if error.errno is not None:  # the system's own: the other side no longer answers
                raise LinkFault(link_fault.TIMED_OUT, str(error)) from error
            return b""
        except OSError as error:
            raise fault_of(error) from error
        if not data:
            raise LinkFault(link_fault.CLOSED)
        return data

    def is_stale(self) -> bool:
        """Whether it is known to be gone: the system finds that out by itself here."""
        return False

    def close(self) -> None:
        """End the connection."""
        self._socket.close()


class UdpSource:
    """Listens on ``port``; with a ``host``, only what that one sends is taken."""

    def __init__(self, host: str, port: int) -> None:
        self._host, self._port = host, port

    def open(self, _is_stopping: Callable[[], bool]) -> "UdpStream":
        """Return the listening socket; raises LinkFault."""
        senders = None
        family, own = socket.AF_INET, ""
        if self._host:
            found = _addresses(self._host, 0, socket.SOCK_DGRAM)
            senders = frozenset(str(address[0]) for *_, address in found)
            if all(row[0] == socket.AF_INET6 for row in found):
                family = socket.AF_INET6
            own = self._host if _is_this_computer(senders) else ""  # what comes from here need not be open to others
        listener = socket.socket(family, socket.SOCK_DGRAM)
        try:
            listener.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _KERNEL_BYTES)
            listener.bind((own, self._port))
        except OSError as error:
            listener.close()
            raise fault_of(error) from error
        return UdpStream(listener, f"udp {self._port}", senders)


class UdpStream:
    """A listening socket; what it hears reads as one stream of bytes.

    A device that sends a line a datagram may leave out the line ends: they are put in while none has been seen.
    """

    def __init__(self, listener: socket.socket, device: str, senders: frozenset[str] | None) -> None:
        self._socket, self.device, self._senders = listener, device, senders
        self._has_line_ends = False

    def read(self) -> bytes:
        """Return what has come, after :data:`WAIT_S` at the latest; raises LinkFault when listening ends."""
        parts: list[bytes] = []
        self._socket.settimeout(WAIT_S)
        try:
            for _ in range(_MOST_DATAGRAMS):
                data, sender = self._socket.recvfrom(_MOST_BYTES)
                if self._senders is None or str(sender[0]) in self._senders:
                    parts.append(self._with_end(data))
                self._socket.setblocking(False)
        except (TimeoutError, BlockingIOError):
            pass  # all that has come was read
        except ConnectionResetError as error:  # Windows' way to tell that somebody did not listen to us
            log.debug("%s: %s", self.device, error)
        except OSError as error:
            raise fault_of(error) from error
        return b"".join(parts)

    def is_stale(self) -> bool:
        """Whether it is known to be gone: a listener never is."""
        return False

    def close(self) -> None:
        """Stop listening."""
        self._socket.close()

    def _with_end(self, data: bytes) -> bytes:
        if self._has_line_ends or not data.isascii():
            return data
        self._has_line_ends = b"\n" in data or b"\r" in data
        return data if self._has_line_ends else data + b"\n"


def _addresses(host: str, port: int, kind: int) -> list[tuple[int, int, int, str, tuple[Any, ...]]]:
    try:
        found = socket.getaddrinfo(host, port, type=kind)
    except (OSError, UnicodeError) as error:  # UnicodeError: no name at all ("a..b")
        raise LinkFault(link_fault.UNREACHABLE, str(error)) from error
    return [(int(family), int(kind), protocol, name, address) for family, kind, protocol, name, address in found]


def _is_this_computer(senders: frozenset[str]) -> bool:
    return all(sender.startswith("127.") or sender == "::1" for sender in senders)


def _connect(connection: socket.socket, address: tuple[Any, ...], is_stopping: Callable[[], bool]) -> None:
    connection.setblocking(False)
    try:
        connection.connect(address)
    except BlockingIOError:
        pass
    else:
        return
    deadline = time.monotonic() + CONNECT_S
    with selectors.DefaultSelector() as selector:
        selector.register(connection, selectors.EVENT_WRITE)
        while not selector.select(WAIT_S):
            if is_stopping():
                raise LinkFault(link_fault.CLOSED)
            if time.monotonic() > deadline:
                raise LinkFault(link_fault.TIMED_OUT)
    if code := connection.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
        raise OSError(code, "")


def _keep_alive(connection: socket.socket) -> None:
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    for name, value in _KEEPALIVE:
        if hasattr(socket, name) and not (name == "TCP_KEEPALIVE" and sys.platform == "linux"):
            connection.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
