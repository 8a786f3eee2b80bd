"""Aligns the clocks of simulated hours: offset and drift against the truth, the stated sigma against the error.

    python tests/benchmarks/clock_alignment.py --seeds 0-9 --minutes 60 --case knocks --imu-hz 200

Cases: ``knocks`` (five irregular ones at either end, joints on the way), ``start`` (knocks at the start alone, no
joints), ``ends`` (knocks at both ends, no joints), ``bumps`` (joints alone), ``strays`` (joints, and a blow a minute
without one), ``nothing`` (none of them: it must refuse). The drift is ±80 ppm, the sound is started up to 15 s
before the motion.
"""

import argparse
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import soundfile as sf

from processing.clock import align
from processing.settings import ClockSettings, SoundSettings
from processing.simulation.run import simulate
from processing.simulation.scenario import Clock, Drive, Imu, Joints, Knocks, PipeRoute, Scenario, Sound
from processing.simulation.sound import sound_blocks
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import AudioInfo

KNOCKS = {"knocks": (True, True), "start": (True, False), "ends": (True, True)}
WITH_JOINTS = ("knocks", "bumps", "strays")
RATE_HZ = 16000


def scenario(case: str, seed: int, minutes: float, imu_hz: float) -> Scenario:
    """Return a straight main that the ball passes in so many minutes."""
    rng = np.random.default_rng([seed, 5])
    speed = float(rng.uniform(0.3, 0.7))
    at_start, at_end = KNOCKS.get(case, (False, False))
    return Scenario(
        name=f"clock-{case}-{seed}",
        route=PipeRoute(((0.0, 0.0, 0.0), (speed * 60.0 * minutes, 0.0, 0.0))),
        drive=Drive(speed_mps=speed, rest_start_s=20.0, rest_end_s=20.0),
        imu=replace(Imu(), rate_hz=imu_hz),
        sound=Sound(
            rate_hz=RATE_HZ,
            joints=Joints(5.5 if case in WITH_JOINTS else 0.0),
            knocks=Knocks(at_start, at_end, stray_per_minute=1.0 if case == "strays" else 0.0),
        ),
        clock=Clock(float(rng.uniform(-15, 3)), 80.0 * float(rng.choice([-1.0, 1.0]))),
    )


def errors(case: str, seed: int, minutes: float, imu_hz: float) -> tuple[str, float, np.ndarray, np.ndarray]:
    """Return what the map rests on, the drift's error (ppm), and error and sigma at start, middle and end (ms)."""
    run = simulate(scenario(case, seed, minutes, imu_hz), seed)
    assert run.sound is not None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "audio.wav"
        with sf.SoundFile(path, "w", RATE_HZ, 1, "PCM_16") as file:
            for block in sound_blocks(run.sound):
                file.write(block)
        source, _ = open_audio([path])
        listened = scan(source, SoundSettings(), out_dir=Path(folder) / "scan")
        fit = align(run.imu, listened, AudioInfo(), ClockSettings())
    at = np.array([30.0, 30.0 * minutes, 60.0 * minutes])
    off = 1000 * (fit.clock.to_survey(run.clock.to_audio(at)) - at)
    return fit.clock.basis, fit.clock.drift_ppm - run.clock.drift_ppm, off, 1000 * fit.clock.sigma_at(at)


def main() -> None:
    """Print a line a run and the summary."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", default="0-4")
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--case", default="knocks")
    parser.add_argument("--imu-hz", type=float, default=200.0)
    args = parser.parse_args()
    first, last = (int(x) for x in args.seeds.split("-"))
    rows = []
    for seed in range(first, last + 1):
        basis, ppm, off, sigma = errors(args.case, seed, args.minutes, args.imu_hz)
        rows.append((off, sigma))
        shown = "  ".join(f"{o:8.2f} ± {s:6.2f}" for o, s in zip(off, sigma, strict=True))
        print(f"{seed:4d} {basis:8s} drift {ppm:7.3f} ppm   start, middle, end (ms) {shown}", flush=True)
    off, sigma = (np.array(x) for x in zip(*rows, strict=True))
    print(f"{args.case}, {args.imu_hz:g} Hz, {args.minutes:g} min: rms {np.sqrt((off**2).mean(axis=0)).round(2)} ms, "
          f"bias {off.mean(axis=0).round(2)} ms, worst {np.abs(off).max():.2f} ms, "
          f"z rms {np.sqrt(((off / sigma) ** 2).mean(axis=0)).round(2)}")  # fmt: skip


if __name__ == "__main__":
    main()
