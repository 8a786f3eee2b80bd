"""Which serial ports there are, under names that survive replugging, and which port a name means now.

A name is what stands between ``serial:`` and ``@`` in a choice: ``auto`` for the only USB port, a path
(``/dev/serial/by-id/…``, ``/dev/ttyUSB0``), a Windows name (``COM3``), or ``usb:VID:PID[:SERIAL]`` in hexadecimal.
"""

import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

AUTO = "auto"
_BY_ID = Path("/dev/serial/by-id")
_USB = re.compile(r"usb:([0-9a-f]{1,4}):([0-9a-f]{1,4})(?::(.+))?", re.IGNORECASE | re.DOTALL)
_UNSAFE = re.compile(r"[@,\s]")  # in a serial number: they part the words of a choice


@dataclass(frozen=True)
class SerialPort:
    """One port: ``name`` finds it again after replugging, ``device`` is what it is called now."""

    name: str
    device: str
    title: str = ""
    usb: tuple[int, int, str] | None = None  # vendor, product, serial number; None where it is no USB port

    def __str__(self) -> str:
        """The choice of this port, as :func:`app.devices.imu_spec.parse_imu_spec` reads it."""
        return f"serial:{self.name}"


def list_serial_ports() -> tuple[SerialPort, ...]:
    """Return the ports that this computer has now, those on USB first."""
    from serial.tools import list_ports

    links = _lasting_links()
    found = []
    for port in list_ports.comports():
        usb = None if port.vid is None or port.pid is None else (port.vid, port.pid, port.serial_number or "")
        title = port.description if port.description and port.description != "n/a" else ""
        found.append(SerialPort(links.get(os.path.realpath(port.device), ""), port.device, title, usb))
    return named_ports(found)


def named_ports(found: Iterable[SerialPort]) -> tuple[SerialPort, ...]:
    """Return the ports with a name each, those on USB first.

    One that the system has no lasting name for is named after its USB numbers where no other port has the same.
    """
    found = list(found)
    all_usb = [port.usb for port in found]
    named = [
        port if port.name else SerialPort(_usb_name(port, all_usb) or port.device, port.device, port.title, port.usb)
        for port in found
    ]
    return tuple(sorted(named, key=lambda port: (port.usb is None, port.device)))


def port_named(
    name: str, ports: Iterable[SerialPort], known_usb: tuple[int, int, str] | None = None
) -> SerialPort | None:
    """Return the port that ``name`` means now, None where it is not there.

    ``known_usb`` is what was found under this name before: a stick that comes back as ``/dev/ttyUSB1``, or as another
    COM port, is still the one that was chosen as ``/dev/ttyUSB0``. ``auto`` means the only USB port.
    """
    ports = tuple(ports)
    usb_ports = [port for port in ports if port.usb is not None]
    if match := _USB.fullmatch(name):
        vendor, product, serial = int(match[1], 16), int(match[2], 16), match[3]
        same = [p for p in usb_ports if p.usb and p.usb[:2] == (vendor, product) and serial in {None, p.usb[2]}]
        return same[0] if len(same) == 1 else None
    if name == AUTO and known_usb is None:
        return usb_ports[0] if len(usb_ports) == 1 else None
    named = next((p for p in ports if name in {p.device, p.name}), None)
    if known_usb is None or (named is not None and named.usb == known_usb):
        return named
    again = [p for p in usb_ports if p.usb == known_usb]
    return again[0] if len(again) == 1 else None


def _usb_name(port: SerialPort, all_usb: list[tuple[int, int, str] | None]) -> str:
    if port.usb is None or not port.usb[2] or _UNSAFE.search(port.usb[2]) or all_usb.count(port.usb) > 1:
        return ""
    vendor, product, serial = port.usb
    return f"usb:{vendor:04x}:{product:04x}:{serial}"


def _lasting_links() -> dict[str, str]:
    """Return device → the link that udev makes from what the device says of itself."""
    try:
        return {os.path.realpath(link): str(link) for link in sorted(_BY_ID.iterdir())}
    except OSError:  # no such folder: no USB port, or not Linux
        return {}
