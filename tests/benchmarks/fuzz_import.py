"""Damages recordings of every kind thousands of times and imports them: each must end in a message or a result.

    python tests/benchmarks/fuzz_import.py [COUNT] [FIRST]

Each runs under a time limit and all under a memory limit of 1 GB (RLIMIT_AS, where the system has it), in a child
process that is started again where it dies. Prints the faults with the number that makes them again, and a summary.
"""

import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

HELPERS = Path(__file__).resolve().parent.parent / "helpers"
LIMIT_BYTES = 1 << 30
SECONDS_EACH = 20


class TookTooLong(BaseException):
    """Raised by the alarm; not an Exception, so that nothing swallows it."""


def _alarm(_signal, _frame):
    raise TookTooLong


def import_one(folder):
    """Preview and import a folder as the app does, then read all sound; returns how it ended."""
    from processing import messages
    from processing.errors import LeaklineError
    from processing.importing.folder import import_folder, preview_folder
    from processing.sound.source import blocks

    try:
        preview_folder(folder)
        recording = import_folder(folder)
        for finding in recording.findings:
            for language in messages.LANGUAGES:
                messages.finding_sentence(finding, language)
        if recording.audio is not None:
            for block in blocks(recording.audio, 65536):
                assert len(block) > 0
    except LeaklineError as error:
        messages.error_sentence(error)
        return f"message {error.code}"
    return "result"


def child(first, count):
    """Import the damaged recordings ``first`` …, one JSON line each."""
    sys.path.insert(0, str(HELPERS))
    from damaged_recordings import mutated, seeds

    kinds = seeds()
    resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))
    signal.signal(signal.SIGALRM, _alarm)
    warnings.simplefilter("error")
    for number in range(first, first + count):
        name, files = mutated(number, kinds)
        folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
        begun = time.monotonic()
        try:
            for file, data in files.items():
                (folder / file).write_bytes(data)
            signal.alarm(SECONDS_EACH)
            how = import_one(folder)
            signal.alarm(0)
        except TookTooLong:
            how = "HANG " + "".join(traceback.format_exc()[-1500:])
        except BaseException:  # noqa: BLE001  # that is what is looked for
            signal.alarm(0)
            how = "FAULT " + traceback.format_exc()[-1500:]
        finally:
            shutil.rmtree(folder, ignore_errors=True)
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        print(json.dumps([number, name, how, round(time.monotonic() - begun, 3), peak]), flush=True)


def main():
    """Run them all and say how they ended."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    number, end = first, first + count
    ends, kinds, faults, slowest, peak = Counter(), Counter(), [], 0.0, 0
    environment = dict(os.environ, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1")
    while number < end:
        command = [sys.executable, __file__, "--child", str(number), str(min(500, end - number))]
        run = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        for line in run.stdout.splitlines():
            number, name, how, seconds, used = json.loads(line)
            ends[how.split("\n")[0][:60]] += 1
            kinds[name] += 1
            slowest, peak = max(slowest, seconds), max(peak, used)
            if how.startswith(("FAULT", "HANG")):
                faults.append((number, name, how))
                print(number, name, how, flush=True)
            number += 1
        if run.returncode:
            print(f"the child died at {number} with {run.returncode}: {run.stderr[-500:]}", flush=True)
            faults.append((number, "", "DIED"))
            number += 1
    print(json.dumps({"count": count, "faults": len(faults), "slowest_s": slowest, "peak_mb": peak}))
    print(json.dumps(dict(ends.most_common()), indent=1))
    return 1 if faults else 0


if __name__ == "__main__":
    if "--child" in sys.argv:
        child(int(sys.argv[2]), int(sys.argv[3]))
    else:
        sys.exit(main())
