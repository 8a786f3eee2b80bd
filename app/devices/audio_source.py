"""What stands behind a sound input on Linux, where a sound server may resample, or put another device in its place.

PortAudio knows neither: through ALSA's plugins every rate opens, and when a microphone is unplugged the server hands
the stream to whatever else it has, without a word. PulseAudio and PipeWire both tell by ``pactl``; the kernel tells of
a card that is opened directly.
"""

import os
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from app.devices.audio_devices import AudioDevice, plain_name

_CALL_S = 2.0
_DIRECT = re.compile(r"\(hw:(?P<card>\d+),(?P<device>\d+)\)")
_CARDS = Path("/proc/asound")
_RATE = re.compile(r"(?P<rate>\d+)\s*Hz")


@dataclass(frozen=True)
class Source:
    """A source of a sound server, or a card; ``rate_hz`` is what it runs at, None where that is not told."""

    name: str
    rate_hz: float | None


def source_behind(device: AudioDevice) -> Source | None:
    """Return what a stream that this process has open on ``device`` is fed from; None where nobody tells."""
    if not sys.platform.startswith("linux") or device.host_api != "ALSA":
        return None
    direct = _DIRECT.search(device.name)
    if direct is not None:
        return Source(device.name, card_rate(int(direct["card"]), int(direct["device"]), _CARDS))
    outputs, sources = _pactl("list", "source-outputs"), _pactl("list", "short", "sources")
    if outputs is None or sources is None:
        return None
    number = source_of(outputs, os.getpid())
    return None if number is None else source_numbered(sources, number)


def is_same(source: Source, other: Source) -> bool:
    """Tell whether two are one device, perhaps in another socket or with other channels."""
    return _device_of(source.name) == _device_of(other.name)


def _device_of(name: str) -> str:
    # a server's names: alsa_input.usb-Maker_Device-00.analog-stereo, and .2 after it where a name was still taken
    stem = re.sub(r"\.\d+$", "", name)
    return plain_name(stem) if " " in stem else stem.rpartition(".")[0] or stem


def card_rate(card: int, device: int, folder: Path) -> float | None:
    """Return the rate at which the kernel runs a card's input, None while it is closed."""
    path = folder / f"card{card}" / f"pcm{device}c" / "sub0" / "hw_params"
    try:
        lines = path.read_text(encoding="ascii", errors="replace").splitlines()
    except OSError:
        return None
    for line in lines:
        key, _, value = line.partition(":")
        if key == "rate":
            return float(value.split()[0])
    return None


def source_of(listing: str, process: int) -> int | None:
    """Return the number of the source that feeds a process, from ``pactl list source-outputs``."""
    for part in re.split(r"^Source Output #", listing, flags=re.MULTILINE)[1:]:
        owner = re.search(r'application\.process\.id = "(\d+)"', part)
        source = re.search(r"^\s*Source: (\d+)$", part, flags=re.MULTILINE)
        if owner is not None and source is not None and int(owner[1]) == process:
            return int(source[1])
    return None


def source_numbered(listing: str, number: int) -> Source | None:
    """Return a source by its number, from ``pactl list short sources``."""
    for line in listing.splitlines():
        cells = line.split("\t")
        if len(cells) >= 4 and cells[0] == str(number):
            rate = _RATE.search(cells[3])
            return Source(cells[1], None if rate is None else float(rate["rate"]))
    return None


def _pactl(*words: str) -> str | None:
    program = shutil.which("pactl")
    if program is None:
        return None
    try:
        done = subprocess.run(
            [program, *words],
            env={**os.environ, "LC_ALL": "C"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=_CALL_S,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout
