"""The ``leakline`` command: start-up reads the words, and loads only what they need."""

import logging
import sys

from app.cli import run


def main() -> int:
    """Run the command line and return its exit status."""
    logging.captureWarnings(True)  # standard error holds one line that a person can use, or nothing; --debug shows them
    return run(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
