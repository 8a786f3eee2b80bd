"""Proposes leaks: runs the chosen detector, places what it finds on the path with a 95 % interval, and labels it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from processing.conditioning.pressure_along import with_pressure
from processing.errors import ErrorCode, LeaklineError
from processing.position.distance import NORMAL_95, places_at, times_at
from processing.progress import Progress, silent
from processing.settings import DetectorSettings
from processing.sound.agreeing import HEARD_AT_LEAST, Judged, agreed
from processing.sound.cells import CELL_M, Cells, Frames, band_log_power, cells_of, frames_of
from processing.sound.envelope import find_by_envelope
from processing.sound.judging import Judging
from processing.sound.layers import find_in_layers
from processing.sound.level_along import LevelAlong, level_along
from processing.sound.loud import find_in_metres_or_loud
from processing.sound.metres import find_in_metres
from processing.sound.paper_detectors import find_by_kurtosis_band, find_by_spectrum, find_by_wavelet_band
from processing.sound.rolling_noise import RollingNoise, listened_bands, rolling_noise, turned_angle
from processing.sound.scan import SoundScan
from processing.sound.spots import Listening, Spot
from processing.survey import (
    Candidate,
    Channel,
    ClockMap,
    Finding,
    ImuSamples,
    LeakClass,
    Motion,
    Severity,
    Stretch,
    Survey,
    Track,
)

__all__ = ["DETECTORS", "Heard", "LevelAlong", "find_candidates"]

# One row a method; ``survey.processing.detector`` names it, ``auto`` chooses. Of two searches, the judged results are
# combined.
DETECTORS: Mapping[str, tuple[Callable[[Listening], list[Spot]], ...]] = {
    "envelope": (find_by_envelope,),
    "metres": (find_in_metres,),
    "metres_or_loud": (find_in_metres_or_loud,),
    "layers": (find_in_layers,),
    "agreed": (find_in_metres, find_in_layers),
    "kurtosis_band": (find_by_kurtosis_band,),
    "wavelet_band": (find_by_wavelet_band,),
    "spectrum": (find_by_spectrum,),
}

_METRES_AT_LEAST_M = 15.0  # below it there are not enough cells for the statistics of the bands
_UNHEARD_S = 1.0
_NAN_PLACE = (float("nan"), float("nan"), float("nan"))


@dataclass(frozen=True)
class Heard:
    """What one run of the detector gives: candidates, best first; the level along the pipe; what was not heard."""

    candidates: tuple[Candidate, ...]
    along: LevelAlong | None
    findings: tuple[Finding, ...] = ()
    not_assessed: tuple[Stretch, ...] = ()


def find_candidates(
    scan: SoundScan,
    clock: ClockMap,
    track: Track | None,
    survey: Survey,
    settings: DetectorSettings,
    progress: Progress | None = None,
    not_assessed: Sequence[Stretch] = (),
    imu: ImuSamples | None = None,
) -> Heard:
    """Return the candidates on the path, best score first, and the level along it.

    Without a track there are candidates in time only: their chainage, interval, width and position are NaN, and there
    is no level along the pipe. No candidate lies in a stretch of ``not_assessed`` that concerns the sound, nor where
    ``scan`` was silent, interrupted or clipped, nor (with a track) while the device stood still.

    Args:
        scan: what the pass over the sound measured; its last band is the chosen one.
        clock: audio to survey time.
        track: the path; None where there is none.
        survey: names the detector and how the device moves.
        settings: of the detectors.
        progress: told a few times.
        not_assessed: stretches to leave out besides those of ``scan``.
        imu: with it the noise of a rolling ball is weighed by the phase of its turning.

    Raises:
        LeaklineError: SETTING_INVALID for a detector that does not exist.
    """
    progress = progress or silent()
    progress.update(0.0, "leaks_searching")
    frames = frames_of(scan, clock, track, not_assessed, settings)
    rolling = None
    if track is not None and imu is not None and survey.device.motion is Motion.ROLLING:
        rolling = _rolling(scan, frames, imu, settings)
    progress.update(0.1)
    cells = cells_of(scan, frames, rolling) if track is not None else None
    progress.update(0.5)
    listening = Listening(scan, frames, cells, settings)
    method, findings = _method(survey.processing.detector, cells, track, settings)
    judging = Judging.on(listening, track, imu, survey)
    progress.update(0.6)
    hears = frames.counts.any() and (track is None or cells is not None)
    judged = _judged(DETECTORS[method], listening, judging) if hears else []
    progress.update(0.9)
    on_path = track if cells is not None else None
    placed = [_placed(spot, leak_class, on_path, clock, listening) for spot, leak_class in judged]
    placed = [candidate for candidate in placed if _worth_showing(candidate, settings)]
    placed.sort(key=lambda candidate: -candidate.score)
    witnessed, told = with_pressure(placed, imu, on_path)
    findings += told
    candidates = tuple(_numbered(candidate, number) for number, candidate in enumerate(witnessed, 1))
    band = (float(scan.bands_hz[-1, 0]), float(scan.bands_hz[-1, 1]))
    if rolling is not None:
        findings += (Finding("rolling_heard", Severity.INFO, {"share_pct": 100 * rolling.heard_share}),)
    progress.update(1.0)
    return Heard(
        candidates=candidates,
        along=level_along(cells, band, settings) if cells is not None else None,
        findings=findings,
        not_assessed=_unheard(scan, clock, track),
    )


def _judged(
    finders: tuple[Callable[[Listening], list[Spot]], ...], listening: Listening, judging: Judging
) -> list[Judged]:
    """Return what one search finds, judged; of two, what they say together."""
    if len(finders) == 1:
        return [judging.of(spot) for spot in finders[0](listening)]
    all_of_it = replace(listening, settings=replace(listening.settings, min_score=HEARD_AT_LEAST))
    by_metres, by_layers = ([judging.of(spot) for spot in find(all_of_it)] for find in finders)
    return agreed(by_metres, by_layers, listening.settings)


def _rolling(scan: SoundScan, frames: Frames, imu: ImuSamples, settings: DetectorSettings) -> RollingNoise | None:
    bands = listened_bands(scan.bands_hz[:-1])
    if settings.rolling_phase == "off" or not len(bands) or not frames.counts.any():
        return None
    level = np.zeros(len(frames.time_s), np.float32)
    for band in bands:
        level += band_log_power(scan, int(band)) / np.float32(len(bands))
    return rolling_noise(level, turned_angle(imu, frames.time_s), frames.counts, scan.frame_s)


def _method(
    wanted: str, cells: Cells | None, track: Track | None, settings: DetectorSettings
) -> tuple[str, tuple[Finding, ...]]:
    """Return the detector to use, and why it is not the one that was asked for."""
    if wanted not in ("auto", *DETECTORS):
        allowed = ", ".join(("auto", *DETECTORS))
        raise LeaklineError(ErrorCode.SETTING_INVALID, name="processing.detector", value=wanted, allowed=allowed)
    length_m = float(np.count_nonzero(cells.heard)) * CELL_M if cells is not None else 0.0
    if track is not None and cells is None:
        return "envelope", (Finding("sound_misses_path", Severity.WARNING),)
    params = {"length_m": length_m}
    if cells is None or length_m < _METRES_AT_LEAST_M:
        if wanted == "metres":
            return "envelope", (Finding("detector_needs_path", Severity.WARNING, params),)
        return "envelope", (Finding("detector_envelope", Severity.INFO, params),) if wanted == "auto" else ()
    if wanted != "auto":
        return wanted, ()
    if length_m >= settings.metres_from_m:
        return "agreed" if length_m > settings.metres_alone_from_m else "metres_or_loud", (
            Finding("detector_metres", Severity.INFO, params),
        )
    return "envelope", (Finding("detector_envelope", Severity.INFO, params),)


def _worth_showing(candidate: Candidate, settings: DetectorSettings) -> bool:
    """Whether it may be a leak, or sounded like one and is known for something else: then the list says what it is."""
    if candidate.score >= settings.min_score:
        return True
    heard = candidate.evidence.get("heard_score", 0.0)
    return candidate.leak_class is not LeakClass.UNKNOWN and float(heard) >= settings.min_score


def _placed(spot: Spot, leak_class: LeakClass, track: Track | None, clock: ClockMap, listening: Listening) -> Candidate:
    """Return the candidate of a spot: its interval holds the path's, the clock's and the sound's own doubt."""
    evidence = {**spot.evidence, "sigma_sound_m": spot.sigma if track is not None else float("nan")}
    nan = float("nan")
    if track is None:
        return Candidate(
            id=0, time_s=spot.place, chainage_m=nan, chainage_low95_m=nan, chainage_high95_m=nan,
            position_w_m=_NAN_PLACE, score=spot.score, level_db=spot.level_db, leak_class=leak_class,
            band_hz=spot.band_hz, width_m=nan, evidence=evidence,
        )  # fmt: skip
    reached, left = times_at(track, spot.place)
    time_s = 0.5 * float(reached[0] + left[0])
    at = places_at(track, time_s)
    moving = listening.frames.counts & (np.abs(listening.frames.chainage_m - spot.place) <= 1.0)
    speed = float(np.median(listening.frames.speed_mps[moving])) if moving.any() else 0.0
    sigmas = (float(at.sigma_along_m[0]), float(clock.sigma_at(time_s)) * speed, spot.sigma)
    half = NORMAL_95 * float(np.sqrt(np.square(sigmas).sum()))
    evidence |= {"sigma_path_m": sigmas[0], "sigma_clock_m": sigmas[1], "speed_mps": speed}
    east, north, up = (float(x) for x in at.position_w_m[0])
    return Candidate(
        id=0,
        time_s=time_s,
        chainage_m=spot.place,
        chainage_low95_m=spot.place - half,
        chainage_high95_m=spot.place + half,
        position_w_m=(east, north, up),
        score=spot.score,
        level_db=spot.level_db,
        leak_class=leak_class,
        band_hz=spot.band_hz,
        width_m=spot.width,
        evidence=evidence,
    )


def _unheard(scan: SoundScan, clock: ClockMap, track: Track | None) -> tuple[Stretch, ...]:
    """Return where the path goes on and the sound does not."""
    if track is None:
        return ()
    begin, end = (float(t) for t in clock.to_survey(np.array([0.0, scan.duration_s])))
    first, last = float(track.time_s[0]), float(track.time_s[-1])
    spans = ((first, min(begin, last)), (max(end, first), last))
    return tuple(Stretch(a, b, Channel.SOUND, "no_sound") for a, b in spans if b - a > _UNHEARD_S)


def _numbered(candidate: Candidate, number: int) -> Candidate:
    return replace(candidate, id=number)
