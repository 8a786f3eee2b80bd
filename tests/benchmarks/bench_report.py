"""How long a report takes, how large it is and how much memory it needs, by the number of leaks.

``python tests/benchmarks/bench_report.py [SURVEY] [leaks …]``: SURVEY is a device's folder (default: the bundled
demonstration); its own path, sound and settings are used, with made-up leaks spread evenly along the path, all of them
confirmed, each with a photo of a phone's size. Each number of leaks runs in a process of its own, so that the peak of
the memory is its own.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from processing.importing.folder import ImportOptions, read_survey
from processing.pipeline import process, read_recording
from processing.position import distance
from processing.progress import silent
from processing.results import Results
from processing.review_facts import Photo, ReviewRecord
from processing.settings import Settings
from processing.storage.cache import Cache
from processing.survey import Candidate, Decision, LeakClass, Verdict


def main() -> None:
    """Print one line a number of leaks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("survey", nargs="?", type=Path)
    parser.add_argument("leaks", nargs="*", type=int, default=[2, 20, 200])
    parser.add_argument("--one", action="store_true", help="measure in this process")
    parser.add_argument("--keep", type=Path, help="write the reports into this folder")
    told = parser.parse_args()
    if not told.one:
        keep = ["--keep", str(told.keep)] if told.keep else []
        for count in told.leaks:
            survey = told.survey or _demonstration()
            subprocess.run([sys.executable, __file__, str(survey), str(count), "--one", *keep], check=True)
        return
    with tempfile.TemporaryDirectory(prefix="bench-report-") as name:
        measure(told.survey, told.leaks[0], Path(name), told.keep)


def measure(survey_dir: Path, count: int, scratch: Path, keep: Path | None) -> None:
    """Process the survey, then time the report alone."""
    survey, settings, cache = read_survey(survey_dir), Settings(), Cache(scratch / "cache")
    recording = read_recording(survey_dir, ImportOptions(), settings.importing, cache, silent())
    results = process(survey, recording, settings, cache, silent())
    results = replace(results, candidates=spread(results, count))
    record = photographed(results, scratch)
    before = peak_mb()

    from processing.reporting.content import make_content
    from processing.reporting.pdf import write_pdf

    decisions = {c.id: Decision(Verdict.CONFIRMED, LeakClass.LEAK, "wet kerb") for c in results.candidates}
    target = (keep or scratch) / f"report-{count}.pdf"
    target.parent.mkdir(parents=True, exist_ok=True)
    wall, cpu = time.perf_counter(), time.process_time()
    write_pdf(target, make_content(results, decisions, record), silent())
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    size = target.stat().st_size / 1e6
    print(
        f"{count:4d} leaks: {wall:6.2f} s ({cpu:6.2f} s CPU), {size:6.2f} MB, "
        f"peak memory {peak_mb():5.0f} MB, before the report {before:5.0f} MB",
        flush=True,
    )


def spread(results: Results, count: int) -> tuple[Candidate, ...]:
    """Return leaks evenly along the path, each with ± 1 m."""
    track = results.track
    assert track is not None
    chainages = np.linspace(track.chainage_m[0], track.chainage_m[-1], count + 2)[1:-1]
    made = []
    for number, chainage in enumerate(chainages, start=1):
        time_s = float(distance.times_at(track, chainage)[0][0])
        east, north, up = (float(x) for x in distance.places_at(track, time_s).position_w_m[0])
        made.append(
            Candidate(
                id=number,
                time_s=time_s,
                chainage_m=float(chainage),
                chainage_low95_m=float(chainage) - 1.0,
                chainage_high95_m=float(chainage) + 1.0,
                position_w_m=(east, north, up),
                score=0.9,
                level_db=6.0,
                leak_class=LeakClass.LEAK,
                band_hz=(500.0, 4000.0),
                width_m=1.5,
            )
        )
    return tuple(made)


def photographed(results: Results, scratch: Path) -> ReviewRecord:
    """Return a record in which each leak has the same 12 megapixel photo."""
    from PIL import Image

    rng = np.random.default_rng(1)
    coarse = Image.fromarray(rng.integers(60, 200, (30, 40, 3), dtype=np.uint8))
    coarse.resize((4000, 3000), Image.Resampling.BICUBIC).save(scratch / "photo.jpg", quality=90)
    photos = tuple(
        (Photo(c.id, c.id, "photo.jpg", "0" * 64, 0), str(scratch / "photo.jpg")) for c in results.candidates
    )
    return ReviewRecord(photos=photos)


def peak_mb() -> float:
    """Return the most memory that this process ever held."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _demonstration() -> Path:
    from app.demonstration import demonstration_folder

    return demonstration_folder(silent())


if __name__ == "__main__":
    main()
