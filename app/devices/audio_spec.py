"""Which sound to record, as people write it: ``default``, ``NAME[@RATE][,channels=2]`` or ``none``."""

import re
from dataclasses import dataclass

from processing.errors import ErrorCode, LeaklineError

LOWEST_RATE_HZ, HIGHEST_RATE_HZ = 8_000, 192_000
MOST_CHANNELS = 32
DEFAULT = "default"
NONE = "none"
# read from the end, because the names of devices hold commas and signs: "USB Audio: - (hw:1,0)"
_SPEC = re.compile(r"(?P<name>.*?)(?:@(?P<rate>\d+))?(?:,\s*channels=(?P<channels>\d+))?", re.DOTALL)


@dataclass(frozen=True)
class AudioChoice:
    """A sound input by the name of its device, ``default`` for the system's; without a rate, one that suits it."""

    name: str = DEFAULT
    rate_hz: int | None = None
    channels: int = 1

    @property
    def is_default(self) -> bool:
        """Whether the system says which device that is."""
        return self.name.casefold() == DEFAULT

    def __str__(self) -> str:
        rate = "" if self.rate_hz is None else f"@{self.rate_hz}"
        channels = "" if self.channels == 1 else f",channels={self.channels}"
        return f"{self.name}{rate}{channels}"


def parse_audio_spec(text: str) -> AudioChoice | None:
    """Return the choice that ``text`` names, None for ``none``; raises LeaklineError (SOUND_SPEC_INVALID)."""
    if text.strip().casefold() == NONE:
        return None
    match = _SPEC.fullmatch(text.strip())
    name = "" if match is None else match["name"].strip()
    if match is None or not name:
        raise LeaklineError(ErrorCode.SOUND_SPEC_INVALID, text=text)
    rate_hz = None if match["rate"] is None else int(match["rate"])
    channels = int(match["channels"] or 1)
    if rate_hz is not None and not LOWEST_RATE_HZ <= rate_hz <= HIGHEST_RATE_HZ:
        raise LeaklineError(ErrorCode.SOUND_SPEC_INVALID, text=text)
    if not 1 <= channels <= MOST_CHANNELS:
        raise LeaklineError(ErrorCode.SOUND_SPEC_INVALID, text=text)
    return AudioChoice(DEFAULT if name.casefold() == DEFAULT else name, rate_hz, channels)
