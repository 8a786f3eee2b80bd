"""The order of the steps, written down once: recording → orientation → path → sound → clock → candidates.

The window, the command line and the tests all call :func:`process`. Each step's result is kept in the cache under the
hash of all that made it, so that opening a processed survey, or changing only the last step, computes nothing twice.
"""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from processing.clock import align
from processing.clock_fit import ClockFit
from processing.errors import ErrorCode, LeaklineError
from processing.importing.folder import ImportOptions, import_folder
from processing.orientation.calibration import Calibration
from processing.orientation.registry import estimate_attitude
from processing.position.evidence import Evidence
from processing.position.fit_results import Fitted
from processing.position.fitting import fit, prepare
from processing.position.gathering import gather_on_route
from processing.position.registry import Reckoned, find_reckoned
from processing.progress import Progress, silent
from processing.results import Results
from processing.settings import ClockSettings, ImportSettings, Settings, digest
from processing.sound.candidates import Heard, find_candidates
from processing.sound.coarse import GrowingPass
from processing.sound.gaps import gap_stretches, told_once
from processing.sound.scan import SoundScan, scan
from processing.storage.cache import Cache, cached
from processing.storage.cache_facts import load_facts, loader, save_facts
from processing.storage.unfinished import with_sums
from processing.survey import (
    Attitude,
    AudioGap,
    AudioInfo,
    AudioSource,
    Channel,
    ClockMap,
    Finding,
    ImportedFile,
    ImuSamples,
    Recording,
    Severity,
    Stretch,
    Survey,
    Track,
)

T = TypeVar("T")

# raised when a step's result changes for the same input, so that old caches are not believed
VERSIONS = {
    "recording": 4,
    "attitude": 7,
    "odometry": 5,
    "evidence": 2,
    "track": 8,
    "scan": 3,
    "clock": 4,
    "candidates": 9,
}

FASTEST_MPS = 30.0  # water in a main never flows so fast, and nobody carries a device so fast


@dataclass(frozen=True)
class Oriented:
    """Attitude with the calibration it rests on."""

    attitude: Attitude
    calibration: Calibration
    findings: tuple[Finding, ...]


def read_recording(
    path: Path,
    options: ImportOptions,
    settings: ImportSettings,
    cache: Cache | None,
    progress: Progress | None = None,
    files: tuple[ImportedFile, ...] = (),
) -> Recording:
    """Return the recording in ``path``; ``files`` with known hashes let the cache answer without reading them.

    Those of a live recording that was not ended have none yet: theirs are counted first, so that what grows meanwhile,
    or has grown, is never taken for what the cache holds.

    Raises:
        LeaklineError: whatever :func:`processing.importing.folder.import_folder` finds that cannot be mended.
    """
    progress = progress or silent()
    files = with_sums(files, told=lambda _: progress.update(0.0, "import_hashing"))

    def compute() -> Recording:
        return import_folder(path, options, settings, progress, files)

    if not files:
        return compute()
    hashes = sorted((file.path.name, file.sha256) for file in files)
    key = digest("recording", VERSIONS["recording"], hashes, options, settings)

    def save(entry: Path, recording: Recording) -> None:
        save_facts(entry, _moved(recording, lambda file: Path(os.path.relpath(file, path))))

    def load(entry: Path) -> Recording:
        return _moved(load_facts(entry, Recording), lambda file: path / file)

    return cached(cache, "recording", key, compute, save, load)


def _moved(recording: Recording, moved: Callable[[Path], Path]) -> Recording:
    """Return a recording with other paths: the cache keeps relative ones, so that a survey may be moved."""
    files = tuple(replace(file, path=moved(file.path)) for file in recording.files)
    audio = recording.audio
    if audio is not None:
        audio = replace(audio, parts=tuple(replace(part, path=moved(part.path)) for part in audio.parts))
    return replace(recording, files=files, audio=audio)


def process(
    survey: Survey,
    recording: Recording,
    settings: Settings,
    cache: Cache,
    progress: Progress | None = None,
    growing: GrowingPass | None = None,
) -> Results:
    """Derive everything from a recording: path, levels, candidates, and what could not be assessed.

    ``growing`` is told how far the pass over the sound is, for those who want to see it before all is done.

    Raises:
        LeaklineError: NO_IMU where there is neither motion nor sound; PATH_IMPOSSIBLE where what was told makes the
            device faster than ``FASTEST_MPS``.
        Cancelled: when the operator stops it; what was finished stays in the cache.
    """
    steps = _Steps(cache, progress or silent(), growing or GrowingPass())
    recording = _told_channel(recording, survey)
    imu, audio = recording.imu, recording.audio
    if imu is None and audio is None:
        raise LeaklineError(ErrorCode.NO_IMU)
    files = sorted((file.role, file.sha256, file.size) for file in recording.files)
    imu_key = digest("imu", files, settings.importing, recording.not_assessed)
    path = _path(survey, imu, settings, steps, imu_key) if imu is not None else None
    oriented, track = (path.oriented, path.fitted.track) if path is not None else (None, None)
    known_bad = (*recording.not_assessed, *(track.not_assessed if track is not None else ()))
    sound = _sound(survey, imu, audio, settings, steps, files) if audio is not None else None
    gaps = gap_stretches(sound.source, sound.clock) if sound is not None else ()
    known_bad += gaps
    heard = _candidates(survey, imu, track, sound, known_bad, settings, steps) if sound is not None else Heard((), None)
    findings = [*recording.findings]
    findings += oriented.findings if oriented is not None else ()
    findings += track.findings if track is not None else ()
    findings += (*sound.scan.findings, *sound.fit.findings) if sound is not None else ()
    stretches = {
        *known_bad,
        *_never_heard(track, audio),
        *_never_placed(track, sound),
        *heard.not_assessed,
        *(told_once(sound.scan.stretches(sound.clock), gaps) if sound is not None else ()),
    }
    return Results(
        survey=survey,
        recording=recording,
        settings=settings,
        clock=sound.clock if sound is not None else ClockMap(),
        attitude_method=oriented.attitude.method if oriented is not None else "",
        calibration=oriented.calibration if oriented is not None else None,
        track=track,
        scan=sound.scan if sound is not None else None,
        level_along=heard.along,
        candidates=heard.candidates,
        findings=(*findings, *heard.findings),
        not_assessed=tuple(sorted(stretches, key=lambda s: (s.start_s, s.end_s, s.reason))),
        run_hash=digest(steps.keys),
        timings=steps.timings,
        reckoned=path.reckoned if path is not None else None,
        tie_checks=path.fitted.checks if path is not None else (),
        series=path.fitted.series if path is not None else None,
        attitude=oriented.attitude if oriented is not None else None,
        clock_fit=sound.fit if sound is not None else None,
    )


class _Steps:
    """Runs steps through the cache, times them, and shares out the progress."""

    def __init__(self, cache: Cache, progress: Progress, growing: GrowingPass) -> None:
        self.cache, self.progress, self.growing = cache, progress, growing
        self.keys: list[str] = []
        self.timings: dict[str, float] = {}

    def cached(self, step: str, key: str, compute: Callable[[], T], kind: type[T]) -> T:
        """Return a step's result from the cache, or compute and keep it."""
        full = digest(step, VERSIONS[step], key)
        self.keys.append(full)
        self.timings[step] = 0.0
        return cached(self.cache, step, full, lambda: self.timed(step, compute), save_facts, loader(kind))

    def timed(self, step: str, compute: Callable[[], T]) -> T:
        """Compute and note how long it took."""
        began = time.perf_counter()
        result = compute()
        self.timings[step] = round(time.perf_counter() - began, 3)
        return result


@dataclass(frozen=True)
class _Sound:
    source: AudioSource
    scan: SoundScan
    fit: ClockFit
    key: str

    @property
    def clock(self) -> ClockMap:
        return self.fit.clock


@dataclass(frozen=True)
class _Path:
    oriented: Oriented
    reckoned: Reckoned
    fitted: Fitted


def _path(survey: Survey, imu: ImuSamples, settings: Settings, steps: _Steps, imu_key: str) -> _Path:
    key = digest(
        imu_key,
        settings.orientation,
        survey.processing.orientation,
        survey.device.motion,
        survey.pipe.material,
        survey.launch.heading_deg,
    )
    oriented = steps.cached(
        "attitude",
        key,
        lambda: Oriented(
            *estimate_attitude(imu, survey, settings.orientation, steps.progress.part(0.0, 0.3, "orientation"))
        ),
        Oriented,
    )
    known = survey.pipe.length_m is not None or any(t.enabled and t.chainage_m for t in survey.tie_points)
    # where the radius is not told, it matters whether anything can tell it: else no tie point has a part here
    told = (
        survey.device,
        survey.processing.position,
        survey.pipe.joint_spacing_m,
        survey.pipe.diameter_m,
        survey.device.radius_m is None and known,
    )
    reckoned_key = digest(key, settings.position, *told)
    reckoned = steps.cached(
        "odometry",
        reckoned_key,
        lambda: find_reckoned(
            imu, oriented.attitude, survey, settings.position, steps.progress.part(0.3, 0.48, "position")
        ),
        Reckoned,
    )
    known_places = (survey.pipe, survey.launch, survey.tie_points, survey.route)
    evidence = steps.cached(
        "evidence",
        digest(reckoned_key, settings.position, *known_places),
        lambda: gather_on_route(
            reckoned.odometry,
            survey,
            settings.position,
            steps.progress.part(0.48, 0.49, "position_bends"),
            reckoned.evidence,
        ),
        Evidence,
    )
    fitted = steps.cached(
        "track",
        digest(reckoned_key, settings.position, *known_places),
        lambda: fit(
            prepare(reckoned.odometry, survey, evidence, settings.position),
            survey,
            settings.position,
            steps.progress.part(0.49, 0.5, "position_fit"),
        ),
        Fitted,
    )
    _check_speed(fitted.track)
    return _Path(oriented, replace(reckoned, evidence=evidence), fitted)


def _never_heard(track: Track | None, audio: AudioSource | None) -> tuple[Stretch, ...]:
    """Return the whole way as a stretch where there is no sound at all: a pipe that nobody listened to is not tight."""
    if track is None or audio is not None:
        return ()
    return (Stretch(float(track.time_s[0]), float(track.time_s[-1]), Channel.SOUND, "no_sound"),)


def _never_placed(track: Track | None, sound: "_Sound | None") -> tuple[Stretch, ...]:
    """Return the whole recording as a stretch where there is no motion: what is heard then has no place."""
    if track is not None or sound is None:
        return ()
    start, end = (float(t) for t in sound.clock.to_survey(np.array([0.0, sound.source.duration_s])))
    return (Stretch(start, end, Channel.PATH, "no_motion"),)


def _check_speed(track: Track) -> None:
    """Refuse a path that no device can have gone: its levels, metre by metre, would not fit into the memory."""
    length_m, duration_s = float(track.chainage_m[-1]), float(track.time_s[-1] - track.time_s[0])
    if not length_m <= FASTEST_MPS * duration_s + 1000.0:
        raise LeaklineError(ErrorCode.PATH_IMPOSSIBLE, length_m=length_m, duration_s=duration_s)


def _told_channel(recording: Recording, survey: Survey) -> Recording:
    """Return the recording with the channel that the survey names now: it may be chosen after the import."""
    audio, wanted = recording.audio, survey.audio.channel
    if audio is None or audio.channel == wanted:
        return recording
    if wanted < audio.channels:
        return replace(recording, audio=replace(audio, channel=wanted))
    missing = Finding("audio_channel_missing", Severity.WARNING, {"channel": wanted, "channels": audio.channels})
    if missing in recording.findings:
        return recording
    return replace(recording, findings=(*recording.findings, missing))


def _sound(
    survey: Survey,
    imu: ImuSamples | None,
    audio: AudioSource,
    settings: Settings,
    steps: _Steps,
    files: list[tuple[str, str, int]],
) -> _Sound:
    key = digest("scan", VERSIONS["scan"], files, audio.channel, settings.sound)
    steps.keys.append(key)
    progress = steps.progress.part(0.5, 0.85, "listening")
    steps.timings["scan"] = 0.0

    def listen(place: Path) -> None:
        steps.timed(
            "scan", lambda: scan(audio, settings.sound, progress, place, resume=True, grown=steps.growing.grown)
        )

    folder = steps.cache.entry("scan", key, listen, resumable=True)
    listened = SoundScan.load(folder)
    steps.growing.finished(listened)
    fitted = steps.cached(
        "clock",
        digest(key, files, survey.audio, settings.clock, audio.gaps),
        lambda: _clock(imu, listened, survey.audio, settings.clock, steps.progress.part(0.85, 0.9), audio.gaps),
        ClockFit,
    )
    return _Sound(audio, listened, fitted, key)


def _clock(
    imu: ImuSamples | None,
    listened: SoundScan,
    told: AudioInfo,
    settings: ClockSettings,
    progress: Progress,
    gaps: tuple[AudioGap, ...],
) -> ClockFit:
    """Return the clock; without motion there is nothing to align with, and the sound's own clock serves."""
    if imu is None:
        return ClockFit(ClockMap(told.start_time_s or 0.0, told.drift_ppm or 0.0, 0.0, "given"))
    return align(imu, listened, told, settings, progress, gaps)


def _candidates(
    survey: Survey,
    imu: ImuSamples | None,
    track: Track | None,
    sound: _Sound,
    not_assessed: tuple[Stretch, ...],
    settings: Settings,
    steps: _Steps,
) -> Heard:
    made_of = digest(steps.keys, settings.detector, survey.processing.detector, not_assessed)
    progress = steps.progress.part(0.9, 1.0, "candidates")
    return steps.cached(
        "candidates",
        made_of,
        lambda: find_candidates(sound.scan, sound.clock, track, survey, settings.detector, progress, not_assessed, imu),
        Heard,
    )
