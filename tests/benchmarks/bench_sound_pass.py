"""The streamed pass beside its yardstick, in turns within one run: time, memory, size on disc. Not part of the tests.

    python tests/benchmarks/bench_sound_pass.py [minutes] [threads] [rounds] [FILE]

The yardstick ("bare") streams the same file with the same reader and the same number of threads, cuts the same windows
and takes one FFT and |·|² of each in blocks that fit the processor's cache, and keeps nothing. Of each the best round
counts: on a busy machine all others measure the neighbours. FILE is any sound file; without it noise is made,
720 minutes of it at 48 kHz as 16 bit RF64 take 4 GB of the temporary folder.
"""

import resource
import sys
import tempfile
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import soundfile
from scipy import fft

from processing.settings import SoundSettings
from processing.sound.analysis import PART_COLUMNS, scaled_hann
from processing.sound.bands import Grid
from processing.sound.scan import scan
from processing.sound.source import AudioReader, open_audio

RATE = 48000
BLOCK = 36  # windows: 300 kB in, 300 kB out


def made_sound(path, minutes):
    """Noise with a knock now and then."""
    rng = np.random.default_rng(0)
    kinds = [0.1 * rng.standard_normal(10 * RATE).astype(np.float32) for _ in range(8)]
    with soundfile.SoundFile(path, "w", RATE, 1, "PCM_16", format="RF64") as file:
        for _ in range(int(minutes * 6)):
            samples = kinds[rng.integers(len(kinds))] * rng.uniform(0.3, 1.5)
            samples[rng.integers(len(samples))] = 0.99
            file.write(samples)


def bare(source, threads):
    """Read, window, FFT and |·|², nothing kept."""
    grid = Grid(source.sample_rate_hz, source.frames)
    window = scaled_hann(grid.window)
    own = threading.local()

    def transform(samples):
        if not hasattr(own, "windows"):
            own.windows = np.empty((BLOCK, grid.window), np.float32)
        view = np.lib.stride_tricks.sliding_window_view(samples, grid.window)[:: grid.hop]
        for first in range(0, len(view), BLOCK):
            windows = own.windows[: min(BLOCK, len(view) - first)]
            np.multiply(view[first : first + BLOCK], window, out=windows)
            parts = fft.rfft(windows, axis=1).view(np.float32)
            parts *= parts
            parts[:, ::2] + parts[:, 1::2]

    size = PART_COLUMNS * grid.column
    with AudioReader(source) as reader, ThreadPoolExecutor(threads) as pool:
        waiting = []
        for start in range(0, source.frames, size):
            samples = reader.read(start, size)
            if len(samples) < grid.window:
                break
            if threads == 1:
                transform(samples)
                continue
            waiting.append(pool.submit(transform, samples))
            if len(waiting) > threads:
                waiting.pop(0).result()
        for job in waiting:
            job.result()


def timed(work):
    """Return wall and CPU seconds."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return np.array([time.perf_counter() - wall, time.process_time() - cpu])


def peak_mb():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def main():
    words = sys.argv[1:]
    minutes, threads, rounds = (
        float(words[0]) if words else 10.0,
        int(words[1]) if words[1:] else 1,
        int(words[2]) if words[2:] else 5,
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(words[3]) if words[3:] else Path(folder) / "noise.rf64"
        if not words[3:]:
            made_sound(path, minutes)
        source, _ = open_audio([path])
        for _ in range(2 if rounds > 1 else 1):  # the first brings the file into memory, for both
            read = timed(lambda: [None for _ in _blocks(source)])
        before_mb = peak_mb()
        yard, passes = [], []
        for turn in range(rounds):
            out = Path(folder) / f"scan{turn}"
            yard.append(timed(lambda: bare(source, threads)))
            passes.append(timed(lambda out=out: scan(source, SoundSettings(), out_dir=out, threads=threads)))
            ratio = passes[-1] / yard[-1]
            print(
                f"  round {turn}: bare {yard[-1].round(2)} pass {passes[-1].round(2)} ratio {ratio.round(2)}",
                flush=True,
            )
        stored = sum(f.stat().st_size for f in out.iterdir()) / 1e6
    bare_best, pass_best = np.min(yard, axis=0), np.min(passes, axis=0)
    seconds = source.duration_s
    print(f"{seconds / 60:.0f} min, {threads} thread(s); wall and CPU seconds, best of {rounds}")
    print(f"read alone  {read[0]:8.2f} {read[1]:8.2f}")
    for name, best in (("bare", bare_best), ("pass", pass_best)):
        print(f"{name:11} {best[0]:8.2f} {best[1]:8.2f}   {seconds / best[0]:.0f} x real time")
    print(f"ratio       {pass_best[0] / bare_best[0]:8.2f} {pass_best[1] / bare_best[1]:8.2f}")
    median = np.median(np.array(passes) / np.array(yard), axis=0)
    print(f"median ratio of neighbours {median[0]:.2f} {median[1]:.2f}")
    print(f"peak {peak_mb():.0f} MB ({before_mb:.0f} MB before); {stored:.1f} MB on disc")


def _blocks(source):
    with AudioReader(source) as reader:
        for start in range(0, source.frames, 1 << 19):
            yield reader.read(start, 1 << 19)


if __name__ == "__main__":
    main()
