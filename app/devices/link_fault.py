"""Why a connection to a device does not come about, or ended: short codes, keys of ``[reasons]``."""

import errno
import socket
from collections.abc import Mapping

NOT_THERE = "imu_not_there"
NO_PORT = "imu_no_port"
SEVERAL_PORTS = "imu_several_ports"
BUSY = "imu_busy"
DENIED = "imu_denied"
UNPLUGGED = "imu_unplugged"
REFUSED = "imu_refused"
CLOSED = "imu_closed"
TIMED_OUT = "imu_timed_out"
UNREACHABLE = "imu_unreachable"
FAILED = "imu_failed"
OUR_FAULT = "imu_our_fault"

_CODES: Mapping[int, str] = {
    errno.ENOENT: NOT_THERE,
    errno.ENODEV: NOT_THERE,
    errno.ENXIO: NOT_THERE,
    errno.EBUSY: BUSY,
    errno.EAGAIN: BUSY,  # the lock that another program holds
    errno.EADDRINUSE: BUSY,
    errno.EACCES: DENIED,
    errno.EPERM: DENIED,
    errno.ECONNREFUSED: REFUSED,
    errno.ECONNRESET: CLOSED,
    errno.EPIPE: CLOSED,
    errno.ETIMEDOUT: TIMED_OUT,
    errno.EHOSTUNREACH: UNREACHABLE,
    errno.ENETUNREACH: UNREACHABLE,
    errno.EHOSTDOWN: UNREACHABLE,
    errno.ENETDOWN: UNREACHABLE,
    errno.EADDRNOTAVAIL: UNREACHABLE,
}


class LinkFault(Exception):  # noqa: N818  # most often no error: a cable was pulled
    """The connection cannot be made now, or ended; ``reason`` is one of the codes, ``detail`` the system's words."""

    def __init__(self, reason: str, detail: str = "") -> None:
        self.reason = reason
        self.detail = detail
        super().__init__(f"{reason}: {detail}" if detail else reason)


def fault_of(error: OSError) -> LinkFault:
    """Return what an error of a socket, or of opening a port, means."""
    if isinstance(error, socket.gaierror):
        return LinkFault(UNREACHABLE, str(error))
    if isinstance(error, TimeoutError):
        return LinkFault(TIMED_OUT, str(error))
    return LinkFault(_CODES.get(error.errno or 0, FAILED), error.strerror or str(error))
