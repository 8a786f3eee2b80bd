"""How far the correlator is from the truth, for all weightings and noises, and how often its interval holds.

Run: ``python tests/benchmarks/correlator.py [seeds]``. Pairs are simulated by ``processing.correlation.simulation``
(dispersion and attenuation of a lossy pipe, 60 s, sensors 100 m apart, leak anywhere from 8 to 92 m), the speed is
known at its reference frequency with 1 sigma drawn from what the page would state.
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.correlation.analysis import Choice, analyse, read
from processing.correlation.phase_fit import DispersionChoice
from processing.correlation.pipe import Pipe, PipeSection, place_of_delay
from processing.correlation.recordings import Pair
from processing.correlation.simulation import SimulatedPair, simulate, write_wave
from processing.correlation.weighting import Weighting
from processing.progress import silent
from processing.sound.source import open_audio

SETTINGS = {
    "plastic, 400 m/s, loss 0.03": SimulatedPair(),
    "plastic, 330 m/s, loss 0.06": SimulatedPair(speeds_mps=(330.0,), loss=0.06, source_hz=(20.0, 400.0)),
    "iron, 1200 m/s, loss 0.01": SimulatedPair(
        speeds_mps=(1200.0,),
        loss=0.01,
        source_hz=(100.0, 1200.0),
        noise_top_hz=2000.0,
        rate_hz=8000,
        reference_hz=300.0,
    ),
}
SNRS_DB = (0.0, -5.0, -10.0)
SPEED_SIGMA = 0.005


def opened(what: SimulatedPair, folder: Path) -> Pair:
    sources = []
    for name, samples in zip("ab", simulate(what), strict=True):
        path = folder / f"{name}.wav"
        write_wave(path, samples, what.rate_hz)
        sources.append(open_audio([path])[0])
    return Pair(sources[0], sources[1])


def one(what: SimulatedPair, rng: np.random.Generator, folder: Path) -> dict[str, tuple[float, float, bool]]:
    """Return for each method: error with the true speed, error with a wrong one, and whether the interval holds."""
    pair = opened(what, folder)
    true_pipe = Pipe((PipeSection(what.lengths_m[0], speed_mps=what.speeds_mps[0], speed_sigma_mps=0.0),))
    told = what.speeds_mps[0] * (1.0 + SPEED_SIGMA * rng.standard_normal())
    told_pipe = Pipe((PipeSection(what.lengths_m[0], speed_mps=told, speed_sigma_mps=SPEED_SIGMA * told),))
    reading = read(pair, true_pipe, silent())
    rows = {}
    for weighting in Weighting:
        bend = DispersionChoice(sigma=0.03, reference_hz=what.reference_hz)
        result = analyse(reading, true_pipe, pair.sync, Choice(weighting=weighting, dispersion=bend))
        if result.chosen is None:
            continue
        plain = analyse(reading, true_pipe, pair.sync, Choice(weighting=weighting, dispersion=DispersionChoice()))
        assert plain.chosen is not None
        at_peak = place_of_delay(true_pipe, plain.chosen.delay_s) - what.leak_m
        rows[f"{weighting.value}: peak alone"] = (abs(at_peak), result.significant, False)
        if result.position is not None:
            other = analyse(reading, told_pipe, pair.sync, Choice(weighting=weighting, dispersion=bend)).position
            holds = other is not None and other.low95_m <= what.leak_m <= other.high95_m
            rows[f"{weighting.value}: phase fit"] = (abs(result.position.from_a_m - what.leak_m), True, holds)
        if plain.position is not None:
            error = abs(plain.position.from_a_m - what.leak_m)
            holds = plain.position.low95_m <= what.leak_m <= plain.position.high95_m
            rows[f"{weighting.value}: phase fit, no dispersion"] = (error, True, holds)
    return rows


def calibration(seeds: int, folder: Path) -> None:
    """Print how often the delay's own interval holds, and the place's where the speed's frequency is not told."""
    rng = np.random.default_rng(77)
    print("| pipe | SNR dB | delay interval holds | frequency of speed unknown: median m | interval holds |")
    print("|---|---|---|---|---|")
    for title, setting in SETTINGS.items():
        for snr_db in SNRS_DB:
            held, errors, untold = [], [], []
            for seed in range(1000, 1000 + seeds):
                what = replace(setting, snr_db=snr_db, leak_m=float(rng.uniform(8.0, 92.0)), seed=seed, duration_s=30.0)
                pair = opened(what, folder)
                pipe = Pipe((PipeSection(100.0, speed_mps=what.speeds_mps[0], speed_sigma_mps=0.0),))
                reading = read(pair, pipe, silent())
                bend = DispersionChoice(sigma=0.03, reference_hz=what.reference_hz)
                phase = analyse(reading, pipe, pair.sync, Choice(dispersion=bend)).phase
                place = analyse(reading, pipe, pair.sync, Choice()).position
                if phase is not None:
                    low, high = phase.interval_s
                    held.append(low <= (100.0 - 2.0 * what.leak_m) / what.speeds_mps[0] <= high)
                if place is not None:
                    errors.append(abs(place.from_a_m - what.leak_m))
                    untold.append(place.low95_m <= what.leak_m <= place.high95_m)
            print(
                f"| {title} | {snr_db:.0f} | {np.mean(held):.2f} | {np.median(errors):.3f} | {np.mean(untold):.2f} |",
                flush=True,
            )


def main() -> None:
    seeds = int(sys.argv[1]) if len(sys.argv) > 1 else 20
    rng = np.random.default_rng(5)
    print("| pipe | SNR dB | method | found | median m | 95 % m | within 0.2 m | interval holds |")
    print("|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for title, setting in SETTINGS.items():
            for snr_db in SNRS_DB:
                start = time.perf_counter()
                runs = [
                    one(
                        replace(setting, snr_db=snr_db, leak_m=float(rng.uniform(8.0, 92.0)), seed=seed),
                        rng,
                        Path(name),
                    )
                    for seed in range(seeds)
                ]
                for method in dict.fromkeys(key for run in runs for key in run):
                    rows = [run[method] for run in runs if method in run]
                    errors = np.array([row[0] for row in rows])
                    holds = np.mean([row[2] for row in rows]) if "fit" in method else float("nan")
                    print(
                        f"| {title} | {snr_db:.0f} | {method} | {sum(row[1] for row in rows)}/{seeds} "
                        f"| {np.median(errors):.3f} | {np.percentile(errors, 95):.3f} "
                        f"| {np.mean(errors <= 0.2):.2f} | {holds:.2f} |"
                    )
                print(f"<!-- {time.perf_counter() - start:.0f} s -->", flush=True)
        calibration(2 * seeds, Path(name))


if __name__ == "__main__":
    main()
