"""A serial port as a source of bytes: opened by a name that survives replugging, read without waiting for line ends."""

import logging
import os
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

from app.devices import link_fault
from app.devices.link_fault import LinkFault, fault_of
from app.devices.serial_ports import AUTO, SerialPort, list_serial_ports, port_named

if TYPE_CHECKING:
    import serial

log = logging.getLogger(__name__)

WAIT_S = 0.1  # a read that brings nothing takes so long, and so does stopping
_MOST_BYTES = 1 << 16
_WINDOWS_BUFFER = 1 << 16


class SerialSource:
    """Opens one port, again and again; ``choice_name`` as in :mod:`app.devices.serial_ports`."""

    def __init__(
        self, choice_name: str, baud: int, ports: Callable[[], tuple[SerialPort, ...]] = list_serial_ports
    ) -> None:
        self._name, self._baud, self._ports = choice_name, baud, ports
        self._usb: tuple[int, int, str] | None = None  # of the port that was open last

    def open(self, _is_stopping: Callable[[], bool]) -> "OpenPort":
        """Return the open port; raises LinkFault."""
        import serial

        try:
            device, found = self._device()
            port = serial.Serial(device, self._baud, timeout=WAIT_S, exclusive=True)
        except _terminal_faults() as error:
            raise _opening_fault(error) from error
        if found is not None and found.usb is not None:
            self._usb = found.usb
        _quicken(port)
        return OpenPort(port, device)

    def _device(self) -> tuple[str, SerialPort | None]:
        """Return what to open now."""
        if os.path.islink(self._name):  # noqa: PTH114  # a name, which on Windows is no path
            return self._name, None  # whoever made the link keeps it right
        ports = self._ports()
        found = port_named(self._name, ports, self._usb)
        if found is not None:
            return found.device, found
        if self._name != AUTO and not self._name.startswith("usb:") and self._usb is None:
            return self._name, None  # a port that the system does not list, as a pseudo-terminal
        usb_ports = [port for port in ports if port.usb is not None]
        if self._name == AUTO and self._usb is None and len(usb_ports) > 1:
            raise LinkFault(link_fault.SEVERAL_PORTS, ", ".join(str(port) for port in usb_ports))
        raise LinkFault(link_fault.NO_PORT if self._name == AUTO and self._usb is None else link_fault.NOT_THERE)


class OpenPort:
    """An open port; ``device`` is what the system calls it."""

    def __init__(self, port: "serial.Serial", device: str) -> None:
        self._port, self.device = port, device

    def read(self) -> bytes:
        """Return what has come, after :data:`WAIT_S` at the latest; raises LinkFault when the port is gone."""
        try:
            data = bytes(self._port.read(max(1, min(self._port.in_waiting, _MOST_BYTES))))
            waiting = self._port.in_waiting if len(data) == 1 else 0
            return data + bytes(self._port.read(waiting)) if waiting else data
        except (OSError, TypeError) as error:  # in_waiting raises a bare OSError, a port that is gone also TypeError
            raise LinkFault(link_fault.UNPLUGGED, str(error)) from error

    def is_stale(self) -> bool:
        """Whether the name leads to another port now, or to none: some drivers never tell that theirs is gone."""
        try:
            if sys.platform == "win32":
                return all(port.device != self.device for port in list_serial_ports())
            return os.fstat(self._port.fileno()).st_rdev != os.stat(self.device).st_rdev  # noqa: PTH116
        except OSError:
            return True

    def close(self) -> None:
        """Let the port go, also one that is gone."""
        try:
            self._port.close()
        except OSError as error:
            log.info("closing %s: %s", self.device, error)


def _terminal_faults() -> tuple[type[Exception], ...]:
    """Return what opening may raise; pyserial lets some of the terminal's own errors through."""
    if sys.platform == "win32":
        return OSError, ValueError
    import termios

    return OSError, ValueError, termios.error


def _quicken(port: "serial.Serial") -> None:
    """Ask the driver to hand on what comes at once, where it can be asked: not every driver can."""
    try:
        if sys.platform == "linux":
            port.set_low_latency_mode(True)
        elif sys.platform == "win32":
            port.set_buffer_size(rx_size=_WINDOWS_BUFFER)
    except (OSError, ValueError, AttributeError) as error:
        log.debug("%s stays as it is: %s", port.port, error)


def _opening_fault(error: Exception) -> LinkFault:
    if not isinstance(error, OSError):  # a rate that the port does not know; a port that goes while it is opened
        return LinkFault(link_fault.FAILED, str(error))
    fault = fault_of(error)
    if fault.reason == link_fault.FAILED:  # Windows: the reason stands in the text only
        for word, reason in (("PermissionError", link_fault.BUSY), ("FileNotFoundError", link_fault.NOT_THERE)):
            if word in str(error):
                return LinkFault(reason, str(error))
    return fault
