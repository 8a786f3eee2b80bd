"""The ``leakline`` command: start-up reads the words, and loads only what they need."""

import io
import logging
import os
import sys
from pathlib import Path

INTERRUPTED = 130


def main() -> int:
    """Run the command line and return its exit status."""
    stand_in_for_closed_streams()
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a Turkish street in an ASCII terminal is no reason to fail
    logging.captureWarnings(True)  # standard error holds one line that a person can use, or nothing; --debug shows them
    try:
        from app.cli import run  # half a second of imports, in which Ctrl+C is no fault either

        return run(sys.argv[1:])
    except KeyboardInterrupt:
        return INTERRUPTED


def stand_in_for_closed_streams() -> None:
    """Open the null device for each standard stream that the caller has closed.

    Else the next file that is opened gets its number, and whatever a library prints lands in a survey.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # takes the lowest free number: this one
    if sys.stdout is None:
        sys.stdout = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115  # for as long as the program runs
    if sys.stderr is None:
        sys.stderr = Path(os.devnull).open("w", encoding="utf-8")  # noqa: SIM115


if __name__ == "__main__":
    sys.exit(main())
