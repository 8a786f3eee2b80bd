"""How long the files of a hand-over take for a long run: 20 km of track at 10 Hz with 200 leaks, the report left out.

python tests/benchmarks/bench_handover.py [km] [leaks]
"""

import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.progress import silent
from processing.reporting.content import make_content
from processing.reporting.handover.writing import write_handover
from processing.reporting.options import FileKind, HandoverOptions
from processing.results import Results
from processing.settings import Settings
from processing.survey import (
    AudioPart,
    AudioSource,
    Candidate,
    Channel,
    ClockMap,
    Decision,
    Launch,
    LeakClass,
    Recording,
    Stretch,
    Survey,
    SurveyInfo,
    TiePoint,
    Track,
    Verdict,
)

SPEED_MPS = 0.5


def long_track(length_m):
    """A winding pipe, walked at 0.5 m/s, its interval growing with the distance."""
    time_s = np.arange(0.0, length_m / SPEED_MPS, 0.1)
    chainage = SPEED_MPS * time_s
    heading = 0.6 * np.sin(chainage / 300.0) + chainage / 9000.0
    steps = np.diff(chainage, prepend=0.0)
    place = np.column_stack([np.cumsum(steps * np.cos(heading)), np.cumsum(steps * np.sin(heading)), -0.002 * chainage])
    sigma = 0.2 + 0.001 * (chainage % 2000.0)
    quat = np.tile([1.0, 0.0, 0.0, 0.0], (time_s.size, 1))
    speed = np.full(time_s.size, SPEED_MPS)
    return Track(time_s, chainage, place, sigma, sigma, sigma, quat, speed, "made")


def long_results(length_m, leaks):
    """Results with evenly spread leaks, a tie point each kilometre, ten stretches that were not assessed."""
    track = long_track(length_m)
    at = np.linspace(10.0, length_m - 20.0, leaks)
    rows = np.searchsorted(track.chainage_m, at)
    first = Candidate(1, 0.0, 0.0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.5, 6.0, LeakClass.LEAK, (400.0, 2000.0), 2.0)
    candidates = tuple(
        replace(
            first,
            id=i,
            time_s=float(track.time_s[row]),
            chainage_m=float(track.chainage_m[row]),
            chainage_low95_m=float(track.chainage_m[row] - 2.0),
            chainage_high95_m=float(track.chainage_m[row] + 2.0),
            position_w_m=tuple(float(v) for v in track.position_w_m[row]),
        )
        for i, row in enumerate(rows, start=1)
    )
    duration_s = float(track.time_s[-1])
    poor = tuple(
        Stretch(t, t + 60.0, Channel.SOUND, "sound_clipped") for t in np.linspace(500.0, duration_s - 100.0, 10)
    )
    ties = tuple(TiePoint(f"valve {k}", 2000.0 * k, 1000.0 * k) for k in range(1, int(length_m / 1000.0)))
    launch = Launch(latitude=40.9, longitude=29.1, elevation_m=20.0)
    audio = AudioSource((AudioPart(Path("audio.wav"), int(8000 * duration_s)),), 8000.0, 1)
    return Results(
        survey=Survey(info=SurveyInfo("Twenty kilometres", date="2026-05-04"), launch=launch, tie_points=ties),
        recording=Recording(None, audio),
        settings=Settings(),
        clock=ClockMap(),
        attitude_method="made",
        calibration=None,
        track=track,
        scan=None,
        level_along=None,
        candidates=candidates,
        findings=(),
        not_assessed=poor,
        run_hash="0123456789abcdef",
        timings={},
    )


def main(words):
    """Print seconds and megabytes of each format alone, and of all with the zip."""
    length_m = 1000.0 * float(words[0]) if words else 20_000.0
    leaks = int(words[1]) if len(words) > 1 else 200
    results = long_results(length_m, leaks)
    decisions = {i: Decision(Verdict.CONFIRMED, None, "Çınar Sokağı") for i in range(1, leaks + 1, 3)}
    content = make_content(results, decisions)
    print(f"{length_m / 1000.0:.0f} km, {results.track.time_s.size} rows of track, {leaks} leaks")
    chosen = [(kind.value, HandoverOptions(frozenset({kind}), as_zip=False)) for kind in FileKind]
    for name, options in [*chosen, ("everything, zip too", HandoverOptions())]:
        with tempfile.TemporaryDirectory() as folder:
            before = time.perf_counter()
            written = write_handover(content, options, Path(folder), (), silent())
            seconds = time.perf_counter() - before
            size = sum(path.stat().st_size for path in written.files) / 1e6
        print(f"{name:20} {seconds:6.2f} s {size:7.1f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
