"""Cut the power of a recording's disc at random moments (30, or as many as the argument says): what is missing?

    python tests/benchmarks/power_cut_recording.py [CUTS]

Linux, as root: the recording goes to a small ext4 in a file; a copy of that file is what a power cut leaves, for
it holds what the file system has sent to its disc and nothing of what it had in memory. The copy is mounted, the kernel
plays its journal back as after a real cut, and the survey is opened from it.
"""

import os
import random
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path

HELPERS = Path(__file__).resolve().parent.parent / "helpers"
sys.path.insert(0, str(HELPERS))


@contextmanager
def mounted(image, place):
    """Mount a file system that is in a file."""
    place.mkdir(exist_ok=True)
    subprocess.run(["mount", "-o", "loop", str(image), str(place)], check=True, timeout=60)
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True, timeout=60)


def handed_over(process, told):
    """Keep the last line that the recorder told."""
    for line in process.stdout:
        told[0] = line


def main() -> None:
    """Report the figures."""
    from killed_recording import check

    cuts, chance = int(sys.argv[1]) if len(sys.argv) > 1 else 30, random.Random(9)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        image, copy = folder / "disc.img", folder / "copy.img"
        with image.open("wb") as file:
            file.truncate(256 << 20)
        subprocess.run(["mkfs.ext4", "-q", str(image)], check=True, timeout=60)
        with mounted(image, folder / "disc") as disc:
            command = [sys.executable, str(HELPERS / "killed_recording.py"), str(disc / "rec"), "1.0"]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
            told = [""]
            threading.Thread(target=handed_over, args=(process, told), daemon=True).start()
            try:
                done = []
                while told[0] in ("", "ready\n"):
                    time.sleep(0.05)
                for _ in range(cuts):
                    time.sleep(chance.uniform(1.5, 3.5))
                    os.kill(process.pid, signal.SIGSTOP)  # or the copy would be of several moments
                    time.sleep(0.01)
                    words = told[0].split()
                    subprocess.run(["cp", "--sparse=auto", str(image), str(copy)], check=True, timeout=60)
                    os.kill(process.pid, signal.SIGCONT)
                    with mounted(copy, folder / "copy") as left:
                        survey = shutil.copytree(next((left / "rec").glob("*.leakline")), folder / "left.leakline")
                    (survey / "survey.lock").unlink(missing_ok=True)
                    done.append(check(survey, *(int(word) for word in words), was_locked=False))
                    shutil.rmtree(survey)
            finally:
                process.kill()
                process.wait(30)
    for name in ("sound_s", "motion_s"):
        missing = [getattr(one, name) for one in done]
        print(f"{name}: missing {statistics.median(missing):.3f} s in the middle, {max(missing):.3f} s at worst")
    print(f"{cuts} cuts within {done[-1].recorded_s:.0f} s; every folder opened, all bits right")


if __name__ == "__main__":
    main()
