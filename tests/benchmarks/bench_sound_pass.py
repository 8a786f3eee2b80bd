"""Speed of the streamed pass beside its yardstick: scipy's FFT alone over the same windows. Not part of the tests.

python tests/benchmarks/bench_sound_pass.py [minutes] [threads]
"""

import resource
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import soundfile
from scipy import fft

from processing.settings import SoundSettings
from processing.sound.bands import Grid
from processing.sound.scan import scan
from processing.sound.source import open_audio

RATE = 44100


def made_sound(path, minutes):
    rng = np.random.default_rng(0)
    with soundfile.SoundFile(path, "w", RATE, 1, "PCM_16") as file:
        for _ in range(int(minutes * 6)):
            file.write(0.1 * rng.standard_normal(10 * RATE).astype(np.float32))


def yardstick(frames):
    """CPU seconds of nothing but the FFTs of the pass, in blocks that fit the cache."""
    grid = Grid(RATE, frames)
    block = np.random.default_rng(0).standard_normal((64, grid.window)).astype(np.float32)
    blocks = frames // grid.hop // len(block)
    fft.rfft(block, axis=1)
    began = time.process_time()
    for _ in range(blocks):
        fft.rfft(block, axis=1)
    return time.process_time() - began


def main():
    minutes = float(sys.argv[1]) if len(sys.argv) > 1 else 10.0
    threads = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "noise.wav"
        made_sound(path, minutes)
        source, _ = open_audio([path])
        before_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        wall, cpu = time.perf_counter(), time.process_time()
        scan(source, SoundSettings(), out_dir=Path(folder) / "scan", threads=threads)
        wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
        peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
        stored_mb = sum(f.stat().st_size for f in (Path(folder) / "scan").iterdir()) / 2**20
        ruler = yardstick(source.frames)
    seconds = source.duration_s
    print(f"{minutes:g} min, {threads} thread(s): {wall:.2f} s = {seconds / wall:.0f} x real time")
    print(f"CPU {cpu:.2f} s = {seconds / cpu:.0f} x real time a core; FFT alone {ruler:.2f} s; ratio {cpu / ruler:.2f}")
    print(f"peak {peak_mb:.0f} MB ({before_mb:.0f} MB before the pass); {stored_mb:.1f} MB on disc")


if __name__ == "__main__":
    main()
