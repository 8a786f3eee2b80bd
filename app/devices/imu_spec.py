"""Which IMU to record, as people write it; see :func:`parse_imu_spec`."""

import re
from dataclasses import dataclass

from app.devices.serial_ports import AUTO, SerialPort, list_serial_ports
from processing.errors import ErrorCode, LeaklineError
from processing.live.decoders import PROTOCOLS

__all__ = ["ImuChoice", "SerialPort", "list_serial_ports", "parse_imu_spec"]

BAUD = 115200
_BAUDS = (300, 20_000_000)
_PORTS = (1, 65535)
NONE = "none"
_PROTOCOL = re.compile(r"(?P<rest>.*?)(?:,\s*protocol\s*=\s*(?P<protocol>[a-z0-9]+))?", re.DOTALL | re.IGNORECASE)
_SERIAL = re.compile(r"(?P<name>.*?)(?:@(?P<baud>\d{1,9}))?", re.DOTALL)
# a name, an IPv4 address, or an IPv6 address in brackets
_PLACE = re.compile(r"(?:(?P<host>[^\s:\[\]@,/]+|\[[0-9a-f:.%\w]+\]):)?(?P<port>\d{1,5})", re.IGNORECASE)


@dataclass(frozen=True)
class ImuChoice:
    """``kind`` is serial, tcp, udp or none; ``address`` a serial port's name or a host, ``""`` for any sender."""

    kind: str
    address: str = ""
    port: int = 0
    baud: int = BAUD
    protocol: str = "auto"

    def __str__(self) -> str:
        """The text that :func:`parse_imu_spec` reads."""
        if self.kind == NONE:
            return NONE
        host = f"[{self.address}]" if ":" in self.address else self.address
        where = f"{host}:{self.port}" if host else str(self.port)
        if self.kind == "serial":
            where = self.address if self.baud == BAUD else f"{self.address}@{self.baud}"
        protocol = "" if self.protocol == "auto" else f",protocol={self.protocol}"
        return f"{self.kind}:{where}{protocol}"


def parse_imu_spec(text: str) -> ImuChoice:
    """Return the choice that ``text`` names; raises LeaklineError (IMU_SPEC_INVALID).

    ``serial:NAME[@BAUD]`` (names: :mod:`app.devices.serial_ports`; 115200 baud), ``tcp:HOST:PORT``, ``udp:[HOST:]PORT``
    (with a host, only what it sends is taken) or ``none``; ``,protocol=`` and one of
    :data:`processing.live.decoders.PROTOCOLS` may follow.
    """
    if text.strip().casefold() == NONE:
        return ImuChoice(NONE)
    kind, colon, words = text.strip().partition(":")
    match = _PROTOCOL.fullmatch(words)
    protocol = ((match and match["protocol"]) or "auto").casefold()
    rest = match["rest"].strip() if match else ""
    choice = None
    if colon and protocol in PROTOCOLS:
        kind = kind.strip().casefold()
        choice = _serial(rest, protocol) if kind == "serial" else _socket(kind, rest, protocol)
    if choice is None:
        raise LeaklineError(ErrorCode.IMU_SPEC_INVALID, text=text, protocols=", ".join(PROTOCOLS))
    return choice


def _serial(rest: str, protocol: str) -> ImuChoice | None:
    match = _SERIAL.fullmatch(rest)
    if match is None or not match["name"].strip() or "," in match["name"]:
        return None
    name, baud = match["name"].strip(), int(match["baud"] or BAUD)
    if not _BAUDS[0] <= baud <= _BAUDS[1]:
        return None
    return ImuChoice("serial", AUTO if name.casefold() == AUTO else name, baud=baud, protocol=protocol)


def _socket(kind: str, rest: str, protocol: str) -> ImuChoice | None:
    match = _PLACE.fullmatch(rest)
    if match is None or kind not in {"tcp", "udp"}:
        return None
    host, port = (match["host"] or "").strip("[]"), int(match["port"])
    if not _PORTS[0] <= port <= _PORTS[1] or (kind == "tcp" and not host):
        return None
    return ImuChoice(kind, host, port, protocol=protocol)
