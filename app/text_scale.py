"""The size of letters and controls: Qt's own scale factor, set before Qt starts, on top of the system's."""

import os
import subprocess
import sys
from collections.abc import MutableMapping, Sequence
from pathlib import Path

FACTOR = "QT_SCALE_FACTOR"
OWN = "LEAKLINE_SCALE_BEFORE"  # what the factor was before ours, for a program that is started by this one
LEAST, MOST = 100, 200


def in_bounds(percent: int) -> int:
    """Return a size that the program offers."""
    return min(max(percent, LEAST), MOST)


def prepare(percent: int, environment: MutableMapping[str, str] = os.environ) -> None:
    """Let Qt draw everything this large; must be called before the application is made.

    Qt multiplies it with the screen's own scale. A factor that the user has set is kept, and multiplied too.
    """
    before = environment.get(OWN, environment.get(FACTOR, ""))
    environment[OWN] = before
    factor = _number(before) * in_bounds(percent) / 100.0
    if factor == 1.0 and not before:
        environment.pop(FACTOR, None)
    else:
        environment[FACTOR] = f"{factor:g}"


def in_force(environment: MutableMapping[str, str] = os.environ) -> int:
    """Return the size that the program was started with, per cent."""
    return round(100.0 * _number(environment.get(FACTOR, "")) / _number(environment.get(OWN, "")))


def start_anew(survey: Path | None) -> None:
    """Start the program again beside this one, which has let go of everything and is about to end."""
    subprocess.Popen(command(survey))


def command(survey: Path | None, executable: str = sys.executable, *, frozen: bool | None = None) -> Sequence[str]:
    """Return how this program is started with a survey, or without one."""
    is_frozen = bool(getattr(sys, "frozen", False)) if frozen is None else frozen
    program = [executable] if is_frozen else [executable, "-m", "app"]
    return program if survey is None else [*program, "open", str(survey)]


def _number(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return 1.0
    return value if 0.25 <= value <= 8.0 else 1.0
