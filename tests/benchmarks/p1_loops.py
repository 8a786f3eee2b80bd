"""P1's fourteen rolling loops, simulated with realistic noise: end error beside the published 0.948 / 0.817 / 0.780 %.

    python tests/benchmarks/p1_loops.py [seeds]

As in the paper, the filters take accelerometer and gyro; the last column lets the magnetometer speak (``auto``).
The path is free: no length, no tie point, no closed loop. Only its end is compared with its start, as in the paper;
the error is in per cent of the way. ``device`` is the simulated sensor's own quaternion, the others are ours.
"""

import sys

import numpy as np

from processing.orientation.registry import estimate_attitude
from processing.position.registry import find_track
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.papers import P1_LOOPS, p1_loop
from processing.simulation.run import simulate
from processing.survey import DeviceInfo, Launch, ProcessingChoice, Survey

METHODS = ("device", "madgwick", "mahony", "offline_vqf", "auto")
PUBLISHED = {"device": 0.948, "madgwick": 0.817, "mahony": 0.780}


def end_error_pct(number: int, seed: int, method: str) -> float:
    """Distance between the end and the start of the found path, in per cent of the true way."""
    run = simulate(p1_loop(number), seed)
    survey = Survey(
        launch=Launch(heading_deg=90.0),
        device=DeviceInfo(radius_m=run.scenario.ball.radius_m),
        processing=ProcessingChoice(orientation=method),
    )
    options = OrientationSettings(magnetometer="auto" if method == "auto" else "ignore")
    attitude, _, _ = estimate_attitude(run.imu, survey, options, silent())
    track = find_track(run.imu, attitude, survey, PositionSettings())
    end = track.position_w_m[-1] - track.position_w_m[0]
    return 100.0 * float(np.hypot(end[0], end[1])) / P1_LOOPS[number][2]


def main(seeds: int) -> None:
    errors = {method: np.zeros((len(P1_LOOPS), seeds)) for method in METHODS}
    print("loop            way m  " + "  ".join(f"{m:>11}" for m in METHODS) + "   (end error, % of the way)")
    for row, (number, (shape, _, length)) in enumerate(P1_LOOPS.items()):
        for method in METHODS:
            errors[method][row] = [end_error_pct(number, seed, method) for seed in range(seeds)]
        means = "  ".join(f"{errors[m][row].mean():11.3f}" for m in METHODS)
        print(f"{number:2d} {shape:10s} {length:7.2f}  {means}", flush=True)
    print(f"mean of 14 × {seeds} runs  " + "  ".join(f"{errors[m].mean():11.3f}" for m in METHODS))
    print("published             " + "  ".join(f"{PUBLISHED.get(m, float('nan')):11.3f}" for m in METHODS))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3)
