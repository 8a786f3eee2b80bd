"""``summary.json``: versions, settings, input hashes, timings and quality figures: a result can be made again."""

import json
import math
import platform
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from processing.reporting.content import ReportContent, verdict_counts
from processing.reporting.files import whole_file
from processing.survey import Finding

LIBRARIES = ("leakline", "numpy", "scipy", "soundfile", "vqf", "pyproj", "typst")


def write_summary(path: Path, content: ReportContent) -> None:
    """Write the summary as JSON; unknown numbers are null."""
    with whole_file(path) as file:
        json.dump(plain(summary(content)), file, ensure_ascii=False, allow_nan=False, indent=1)


def summary(content: ReportContent) -> dict[str, Any]:
    """Return all that is needed to judge and to repeat a run."""
    results = content.results
    track = results.track
    return {
        "versions": {"python": platform.python_version(), **{name: version(name) for name in LIBRARIES}},
        "run": results.run_hash,
        "survey": asdict(results.survey),
        "settings": asdict(results.settings),
        "inputs": [
            {"file": file.path.name, "role": file.role, "size": file.size, "sha256": file.sha256}
            for file in results.recording.files
        ],
        "timings_s": results.timings,
        "findings": [finding_entry(finding) for finding in results.findings],
        "not_assessed": [
            {**asdict(part.stretch), "start_m": part.start_m, "end_m": part.end_m} for part in content.unassessed
        ],
        "quality": {
            "leaks": verdict_counts(content),
            "orientation": results.attitude_method,
            "position": track.method if track is not None else None,
            "clock": asdict(results.clock),
            "length_m": float(track.chainage_m[-1]) if track is not None else None,
            "largest_sigma_along_m": float(np.max(track.sigma_along_m)) if track is not None else None,
            "not_assessed_m": content.unassessed_m,
            **(dict(track.quality) if track is not None else {}),
            "tie_checks": [asdict(check) for check in results.tie_checks],
        },
    }


def finding_entry(finding: Finding) -> dict[str, Any]:
    """Return a finding with its code and numbers."""
    return {"code": finding.code, "severity": finding.severity.value, **dict(finding.params)}


def version(name: str) -> str | None:
    """Return the version of an installed distribution, None where it is not installed."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def plain(thing: Any) -> Any:  # noqa: ANN401  # JSON is what it is
    """Return ``thing`` as JSON can hold it: numpy numbers as Python's, non-finite numbers as null."""
    if isinstance(thing, dict):
        return {str(key): plain(value) for key, value in thing.items()}
    if isinstance(thing, list | tuple):
        return [plain(value) for value in thing]
    if isinstance(thing, np.generic):
        return plain(thing.item())
    if isinstance(thing, float):
        return thing if math.isfinite(thing) else None
    return thing if thing is None or isinstance(thing, str | int | bool) else str(thing)
