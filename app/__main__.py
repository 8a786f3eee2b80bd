"""The ``leakline`` command: start-up reads the words, and loads only what they need."""

import sys

from app.cli import run


def main() -> int:
    """Run the command line and return its exit status."""
    return run(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())
