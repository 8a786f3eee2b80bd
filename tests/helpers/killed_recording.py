"""Kill a recording process at random moments and look what is left: nothing older than moments may be missing.

``tests/benchmarks/kill_recording.py`` kills a hundred, the tests five. The recorder is this file run itself: it writes
known sound and motion at the pace of a device, and tells on standard output what it has handed over.
"""

import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.importing.folder import import_folder
from processing.importing.frames import FrameDecoder, Frames
from processing.sound.source import AudioReader
from processing.storage.folder import SurveyFolder
from processing.storage.recording_writer import RecordingWriter, SoundForm
from processing.survey import Survey, SurveyInfo, TiePoint

RATE_HZ, IMU_HZ = 48_000, 400
FIRST_US, STEP_US = 7_000_000, 1_000_000 // IMU_HZ
SOUND_BLOCK, IMU_BLOCK = 960, 8  # 20 ms, as devices give them
PART_S = 4.0
START_S = 60.0  # an importing child on a loaded machine


def known_sound(start, count):
    """Frames (count, 1) of 24 bits that tell their own place."""
    place = np.arange(start, start + count, dtype=np.uint64)
    return (((place * np.uint64(2654435761)) & np.uint64(0xFFFFFF)).astype(np.uint32) << np.uint32(8)).view(np.int32)[
        :, None
    ]


def known_motion(start, count):
    """A device at rest whose field and force tell their own place."""
    place = np.arange(start, start + count)
    tells = (place % 4096).astype(np.float32)
    acc = np.stack([1e-5 * tells, np.zeros(count), np.full(count, 9.81)], axis=1).astype(np.float32)
    gyr = np.stack([np.zeros(count), 1e-6 * tells, np.zeros(count)], axis=1).astype(np.float32)
    none = np.full(count, np.nan, np.float32)
    time_us = (FIRST_US + STEP_US * place).astype(np.uint64)
    mag = np.full((count, 3), 20.0, np.float32)
    return Frames(
        place.astype(np.uint32),
        time_us,
        acc,
        gyr,
        mag,
        none,
        none,
        np.full((count, 4), np.nan, np.float32),
        100.0 + 1e-6 * time_us,
    )


def record(target, speed=1.0):
    """Record for ever, telling on standard output the frames, samples and marks that were handed over."""
    writer = RecordingWriter.create(
        target, Survey(SurveyInfo("Öldürülen kayıt")), SoundForm(RATE_HZ), motion=True, part_s=PART_S
    )
    print("ready", flush=True)
    began, frames, samples, marks = time.monotonic(), 0, 0, 0
    while True:
        now_s = speed * (time.monotonic() - began)
        while (frames + SOUND_BLOCK) / RATE_HZ < now_s:
            writer.write_sound(known_sound(frames, SOUND_BLOCK))
            frames += SOUND_BLOCK
        while (samples + IMU_BLOCK) / IMU_HZ < now_s:
            writer.write_motion(known_motion(samples, IMU_BLOCK))
            samples += IMU_BLOCK
        if marks < now_s:
            writer.mark(TiePoint(f"vana {marks}", float(marks), chainage_m=float(marks)))
            marks += 1
        print(frames, samples, marks, flush=True)
        time.sleep(0.01)


@dataclass(frozen=True)
class Killed:
    """What one kill cost: seconds of each stream, and marks; ``recorded_s`` is how long it had run."""

    recorded_s: float
    sound_s: float
    motion_s: float
    marks: int


def kill_once(target, moment_s, speed=1.0):
    """Start a recorder in the new folder ``target``, kill it after ``moment_s``, check what is left."""
    command = [sys.executable, __file__, str(target), str(speed)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, encoding="utf-8")
    timer = threading.Timer(START_S, process.kill)
    timer.start()
    try:
        ready = process.stdout.readline()
        timer.cancel()
        timer = threading.Timer(moment_s, process.kill)
        timer.start()
        told = process.stdout.read().splitlines(keepends=True)  # ends with the process
    finally:
        timer.cancel()
        process.kill()
        process.stdout.close()
        process.wait(30)
    assert ready == "ready\n", "the recorder did not start"
    whole = [line for line in told if line.endswith("\n")]
    return check(next(target.glob("*.leakline")), *(int(word) for word in whole[-1].split()))


def check(path, frames, samples, marks, *, was_locked=True):
    """Open what is left as any survey, compare it with what was handed over, and return what is missing."""
    with SurveyFolder.open(path) as folder:
        assert [finding.code for finding in folder.findings] == ["survey_lock_taken_over"] * was_locked
        files = folder.files()
        recording = import_folder(folder.original_dir, known=files)
        assert "recording_unfinished" in [finding.code for finding in recording.findings]
        stored = folder.read_survey().tie_points
        assert [point.name for point in stored] == [f"vana {i}" for i in range(len(stored))]
        # one may be stored that was not yet told as handed over
        assert marks - 1 <= len(stored) <= marks + 1
        folder.complete_recording(recording.files)
        assert folder.verify_originals() == ()
    got_frames, got_samples = sound_in(recording.audio), motion_in(path / "recordings" / "1" / "original")
    assert len(recording.imu.time_s) == got_samples
    return Killed(
        frames / RATE_HZ,
        max(0.0, (frames - got_frames) / RATE_HZ),
        max(0.0, (samples - got_samples) / IMU_HZ),
        max(0, marks - len(stored)),
    )


def sound_in(audio, frames=None):
    """Return how many frames are there, at most ``frames``, each being the right one in its right place."""
    end = audio.frames if frames is None else min(frames, audio.frames)
    with AudioReader(audio) as reader:
        for start in range(0, end, 1 << 16):
            count = min(1 << 16, end - start)
            right = known_sound(start, count)[:, 0].astype(np.float64) / 2**31
            assert np.array_equal(reader.read(start, count), right.astype(np.float32))
    return end


def motion_in(original):
    """Return how many samples are there, each being the right one in its right place."""
    start = 0
    for path in sorted(original.glob("imu-*.lkf")):
        frames = FrameDecoder().feed(path.read_bytes())
        right = known_motion(start, len(frames))
        for name in ("counter", "time_us", "acc_s_mps2", "gyr_s_radps", "mag_s_ut", "host_s"):
            assert np.array_equal(getattr(frames, name), getattr(right, name)), name
        start += len(frames)
    return start


if __name__ == "__main__":
    record(Path(sys.argv[1]), float(sys.argv[2]))
