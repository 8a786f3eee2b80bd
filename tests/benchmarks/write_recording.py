"""How much of a processor writing a recording takes, at the pace of the devices, and how long ending it takes.

    python tests/benchmarks/write_recording.py [SECONDS] [RATE_HZ] [CHANNELS] [IMU_HZ] [FOLDER]

Blocks are made beforehand; what is counted is the process's own time less that of the same loop without a writer.
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "helpers"))

BLOCK_S = 0.02


def fed(writer, seconds, sound, motion):
    """Hand over blocks at their pace; return the processor's seconds and the longest call."""
    began, cpu, longest = time.monotonic(), time.process_time(), 0.0
    for i in range(round(seconds / BLOCK_S)):
        time.sleep(max(0.0, began + BLOCK_S * i - time.monotonic()))
        at = time.perf_counter()
        if writer is not None:
            writer.write_sound(sound)
            writer.write_motion(motion[i % len(motion)])
            longest = max(longest, time.perf_counter() - at)
    return time.process_time() - cpu, longest


def main() -> None:
    """Report it."""
    from killed_recording import known_motion

    from processing.storage.recording_writer import RecordingWriter, SoundForm
    from processing.survey import Survey

    given = [int(word) for word in sys.argv[1:5]]
    seconds, rate_hz, channels, imu_hz = given + [60, 96_000, 2, 1000][len(given) :]
    rng = np.random.default_rng(1)
    sound = rng.integers(-(2**31), 2**31, (round(BLOCK_S * rate_hz), channels), dtype=np.int32)
    rows = round(BLOCK_S * imu_hz)
    motion = [known_motion(rows * i, rows) for i in range(round(seconds / BLOCK_S))]
    idle, _ = fed(None, seconds, sound, motion)
    with tempfile.TemporaryDirectory(dir=sys.argv[5] if len(sys.argv) > 5 else None) as folder:
        writer = RecordingWriter.create(Path(folder), Survey(), SoundForm(rate_hz, channels), motion=True)
        busy, longest = fed(writer, seconds, sound, motion)
        began = time.perf_counter()
        writer.close()
        ending = time.perf_counter() - began
        assert writer.fault is None
        size = sum(path.stat().st_size for path in writer.path.rglob("*") if path.is_file())
    print(f"{rate_hz} Hz x {channels} in 24 bits and {imu_hz} Hz of motion for {seconds} s: {size / 1e6:.1f} MB")
    print(f"{100 * (busy - idle) / seconds:.2f} % of a processor, longest call {1e3 * longest:.2f} ms")
    print(f"ended in {ending:.2f} s")


if __name__ == "__main__":
    main()
