"""Widens the stated 95 % intervals along the pipe by what digs showed, where the operator has chosen so."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from processing.survey import Candidate

if TYPE_CHECKING:
    from processing.results import Results


def widened(candidate: Candidate, factor: float) -> Candidate:
    """Return the candidate with its interval ``factor`` times as wide, ending at the launch; never narrower."""
    if not factor > 1.0:
        return candidate
    at = candidate.chainage_m
    low = at - factor * (at - candidate.chainage_low95_m)
    high = at + factor * (candidate.chainage_high95_m - at)
    return replace(candidate, chainage_low95_m=max(low, 0.0) if np.isfinite(low) else low, chainage_high95_m=high)


def as_stated(results: "Results") -> "Results":
    """Return the results with all intervals along the pipe as the survey's report states them: leaks and path."""
    factor = results.survey.stated.widen
    if not factor > 1.0:
        return results
    track = results.track
    if track is not None:
        track = replace(track, sigma_along_m=np.asarray(factor * track.sigma_along_m, np.float64))
    return replace(results, track=track, candidates=tuple(widened(c, factor) for c in results.candidates))
