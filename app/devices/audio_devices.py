"""The sound inputs of this computer, by names that survive unplugging and another socket."""

import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from app.devices import portaudio
from app.devices.audio_spec import AudioChoice
from processing.errors import ErrorCode, LeaklineError

# best first: the way to the device with the least between it and us. MME cuts names off and resamples silently; WDM-KS
# takes the device away from everybody else and fails on many
_HOST_APIS: Mapping[str, tuple[str, ...]] = {
    "linux": ("ALSA", "PulseAudio", "JACK Audio Connection Kit", "OSS"),
    "win32": ("Windows WASAPI", "ASIO", "Windows DirectSound", "MME", "Windows WDM-KS"),
    "darwin": ("Core Audio",),
}
_MME_NAME_LENGTH = 31  # MME cuts names off there
_HARDWARE_INDEX = re.compile(r"\s*\(hw:[^)]*\)\s*$")
_COPY_NUMBER = re.compile(r"(?<![\w.])\d+-\s+")  # Windows: "Microphone (2- USB Audio CODEC)" after another socket


@dataclass(frozen=True)
class AudioDevice:
    """A sound input. ``index`` is PortAudio's and holds only until the devices are looked at anew."""

    name: str
    host_api: str
    channels: int
    default_rate_hz: float
    index: int
    is_default: bool = False


def list_inputs(refresh: bool = True) -> tuple[AudioDevice, ...]:
    """Return the inputs, the system's default first, each device once, by its best host API.

    With ``refresh``, devices that came or went since are seen, unless a stream of this process is open. Raises
    LeaklineError (SOUND_LIBRARY_MISSING).
    """
    if refresh:
        portaudio.refresh()
    sounddevice = portaudio.library()
    apis: Sequence[Mapping[str, Any]] = sounddevice.query_hostapis()
    default = _default_index(sounddevice)
    found = [
        AudioDevice(
            str(row["name"]),
            str(apis[row["hostapi"]]["name"]),
            int(row["max_input_channels"]),
            float(row["default_samplerate"]),
            index,
            index == default,
        )
        for index, row in enumerate(sounddevice.query_devices())
        if row["max_input_channels"] > 0
    ]
    return best_of_each(found, sys.platform)


def _default_index(sounddevice: Any) -> int:  # noqa: ANN401  # sounddevice has no types
    try:
        return int(sounddevice.query_devices(kind="input")["index"])
    except Exception as error:  # PortAudioError derives from Exception directly
        if isinstance(error, (sounddevice.PortAudioError, ValueError)):  # there is none
            return -1
        raise


def best_of_each(devices: Sequence[AudioDevice], platform: str) -> tuple[AudioDevice, ...]:
    """Return one row a device: of those that several host APIs show, the best one's; the default first."""
    order = _HOST_APIS.get(platform, ())
    ranked = sorted(devices, key=lambda d: order.index(d.host_api) if d.host_api in order else len(order))
    kept: list[AudioDevice] = []
    for device in ranked:
        twin = next((at for at, k in enumerate(kept) if _is_twin(k, device)), None)
        if twin is None:
            kept.append(device)
        elif device.is_default and not any(k.is_default for k in kept):
            # the default as the system sees it is the same device behind a worse host API
            best = kept[twin]
            kept[twin] = AudioDevice(
                best.name, best.host_api, best.channels, best.default_rate_hz, best.index, is_default=True
            )
    return tuple(sorted(kept, key=lambda d: (not d.is_default, d.index)))


def _is_twin(kept: AudioDevice, other: AudioDevice) -> bool:
    """Tell whether another host API shows the same device; two of one host API are two devices."""
    if kept.host_api == other.host_api:
        return False
    a, b = plain_name(kept.name), plain_name(other.name)
    cut = len(other.name) >= _MME_NAME_LENGTH and other.host_api == "MME"
    return a == b or (cut and a.startswith(b))


def plain_name(name: str) -> str:
    """Return a device's name without what changes when it is plugged in again."""
    return " ".join(_COPY_NUMBER.sub("", _HARDWARE_INDEX.sub("", name)).split()).casefold()


def named(choice: AudioChoice, devices: Sequence[AudioDevice]) -> AudioDevice:
    """Return the device that a choice means: of exactly this name, or of the same but for what replugging changes.

    Raises LeaklineError (SOUND_DEVICE_MISSING, or SOUND_NO_INPUT where there is none at all).
    """
    if not devices:
        raise LeaklineError(ErrorCode.SOUND_NO_INPUT)
    for device in devices:
        if device.name == choice.name:
            return device
    if choice.is_default:
        return next((d for d in devices if d.is_default), devices[0])
    wanted = plain_name(choice.name)
    for device in devices:
        if plain_name(device.name) == wanted:
            return device
    raise LeaklineError(ErrorCode.SOUND_DEVICE_MISSING, name=choice.name, known=", ".join(d.name for d in devices))
