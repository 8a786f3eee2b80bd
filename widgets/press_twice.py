"""Lets one press of a glove do nothing: what must not happen by mistake needs a second press soon after the first."""

from collections.abc import Callable

WITHIN_S = 3.0
BOUNCE_S = 0.35  # two presses closer than this are one hand's: a double click, or a switch that bounces


class PressTwice:
    """Counts presses against a clock; :meth:`press` tells when the second one came."""

    def __init__(self, monotonic: Callable[[], float], within_s: float = WITHIN_S, bounce_s: float = BOUNCE_S) -> None:
        self._monotonic, self._within_s, self._bounce_s = monotonic, within_s, bounce_s
        self._first_s: float | None = None
        self._deaf_until_s = -1e9

    def press(self) -> bool:
        """Take a press; returns True for a second one, neither too soon after the first nor too late."""
        now = self._monotonic()
        if now < self._deaf_until_s:
            return False
        if self._first_s is None or now - self._first_s > self._within_s:
            self._first_s = now
            return False
        if now - self._first_s < self._bounce_s:
            return False
        self._first_s = None
        return True

    @property
    def armed(self) -> bool:
        """Whether a second press would count now."""
        return self._first_s is not None and self._monotonic() - self._first_s <= self._within_s

    def reset(self, deaf_s: float = 0.0) -> None:
        """Forget a first press; take none for ``deaf_s``: a double click on *record* must not begin to stop it."""
        self._first_s = None
        self._deaf_until_s = self._monotonic() + deaf_s
