"""The sheet of a check before the launch or at the end: lights with their figures, as it is stored and printed."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

Params = Mapping[str, str | float]  # as in the vocabulary, which has a place for sheets

MAX_ITEMS = 60
_LONGEST_TEXT = 200
_LARGEST = 1e300


class Light(StrEnum):
    """What a check says: go, mind it, or do not launch; ``open`` where it was not made."""

    GREEN = "green"
    YELLOW = "yellow"
    RED = "red"
    OPEN = "open"


_ORDER = (Light.OPEN, Light.GREEN, Light.YELLOW, Light.RED)


@dataclass(frozen=True)
class CheckItem:
    """One thing that was looked at: ``key`` is one of ``[check_items]``, ``verdict`` one of ``[check_verdicts]``."""

    key: str
    light: Light
    verdict: str
    params: Params


@dataclass(frozen=True)
class CheckSheet:
    """All lights of one check; ``kind`` is ``launch`` or ``end``."""

    kind: str
    utc: str  # ISO 8601
    items: tuple[CheckItem, ...]

    @property
    def light(self) -> Light:
        """The worst of them."""
        return max((item.light for item in self.items), key=_ORDER.index, default=Light.OPEN)

    def to_json(self) -> dict[str, Any]:
        """Return it as it is stored in the recording's journal."""
        items = [
            {"key": item.key, "light": item.light.value, "verdict": item.verdict, "params": dict(item.params)}
            for item in self.items
        ]
        return {"kind": self.kind, "utc": self.utc, "items": items}

    @classmethod
    def from_json(cls, stored: object) -> "CheckSheet | None":
        """Return the stored sheet; None where it is no such thing: the file may have been edited."""
        if not isinstance(stored, Mapping) or not isinstance(stored.get("items"), list):
            return None
        found = [_item(entry) for entry in stored["items"][:MAX_ITEMS]]
        items = tuple(item for item in found if item is not None)
        kind = "end" if stored.get("kind") == "end" else "launch"
        return cls(kind, str(stored.get("utc", ""))[:40], items) if items else None


def _item(entry: object) -> CheckItem | None:
    if not isinstance(entry, Mapping):
        return None
    key, light, verdict, params = (entry.get(name) for name in ("key", "light", "verdict", "params"))
    if not (isinstance(key, str) and isinstance(verdict, str) and isinstance(light, str) and light in {*Light}):
        return None
    told: dict[str, str | float] = {}
    for name, value in params.items() if isinstance(params, Mapping) else ():
        if isinstance(value, str):
            told[str(name)] = value[:_LONGEST_TEXT]
        elif isinstance(value, int | float) and abs(value) <= _LARGEST:  # neither NaN nor a number that is no float
            told[str(name)] = float(value)
    return CheckItem(key[:40], Light(light), verdict[:40], told)


# --- while it is made


class Phase(StrEnum):
    """What the operator is asked to do."""

    LISTEN = "listen"  # nothing: the devices are heard
    REST = "rest"  # lay it down and keep it still
    KNOCK = "knock"  # knock five times, irregularly
    DONE = "done"


@dataclass(frozen=True)
class CheckView:
    """How far the check is: the phase, how much of it is done (0..1), knocks that both sensors had so far."""

    phase: Phase
    fraction: float
    heard: int = 0
    felt: int = 0
    both: int = 0
    moved: bool = False  # it did not lie still: the rest begins anew
