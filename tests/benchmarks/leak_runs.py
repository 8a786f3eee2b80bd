"""Runs for measuring leak detectors: each simulated, listened to once, and kept in a folder to be searched in a second.

    from leak_runs import trial
    run = trial("usual", 7, Path("/tmp/trials"))   # makes it (about 15 s) or loads it (about 10 ms)
    find_candidates(run.scan, run.clock, run.track, run.survey_for("auto"), DetectorSettings(), imu=run.imu)

A detector gets what it gets in the field: the sound's band levels, the gyro with its errors, a clock that is wrong
within its stated sigma, and a path that is wrong along the pipe within its stated sigma (it wanders over 60 m, as
odometry between tie points does). Nothing of the sound itself is kept: the same seed makes the same sound again, as it
does of its own when the scan's format has changed.
"""

import json
import os
import shutil
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import soundfile as sf

from processing.importing.survey_toml import read_survey_toml, write_survey_toml
from processing.settings import SoundSettings, digest
from processing.simulation.leak_trials import leaky_main, other_main
from processing.simulation.run import simulate
from processing.simulation.scenario import Scraping
from processing.simulation.sound import sound_blocks
from processing.simulation.wander import gauss_markov
from processing.sound.scan import VERSION as SCAN_VERSION
from processing.sound.scan import SoundScan, scan
from processing.sound.source import open_audio
from processing.survey import ClockMap, ImuSamples, LeakClass, ProcessingChoice, Survey, Track

SETTINGS = {
    "usual": leaky_main,
    "other": other_main,
    "unscraped": lambda seed: without_scraping(other_main(seed)),  # tells what scraping does from what the rest does
    "quiet": lambda seed: without_leaks(leaky_main(seed)),
}
PATH_SIGMA_M, PATH_WANDER_M, CLOCK_SIGMA_S = 0.25, 60.0, 0.003
_TRACK_HZ = 20.0
_VERSION = 1  # of what is kept


@dataclass(frozen=True)
class TrueLeak:
    """A leak: ``chainage_m`` in truth, ``told_m`` where it lies on the path that the detector is told."""

    name: str
    chainage_m: float
    told_m: float
    snr_db: float
    half_width_m: float


@dataclass(frozen=True)
class FalsePlace:
    """What is no leak: ``kind`` of it, at ``told_m`` on the told path."""

    kind: str
    told_m: float


@dataclass(frozen=True)
class Trial:
    """One run as a detector gets it, and its truth."""

    setting: str
    seed: int
    scan: SoundScan
    clock: ClockMap
    track: Track
    survey: Survey
    imu: ImuSamples
    leaks: tuple[TrueLeak, ...]
    false_places: tuple[FalsePlace, ...]
    length_m: float

    def survey_for(self, detector):
        """Return the survey that asks for ``detector``."""
        return replace(self.survey, processing=ProcessingChoice(detector=detector))


def trial(setting, seed, folder, mixed=None, name=None):
    """Return the run from ``folder``, made there when it is missing or of another make.

    ``mixed(samples, first, run)`` may add to the sound, block by block, and tell its own ``leaks``; such a run needs a
    ``name`` of its own.
    """
    scenario = SETTINGS[setting](seed)
    here = Path(folder) / (name or f"{setting}-{seed:04d}")
    make = f"{digest(scenario, seed, _VERSION, *([repr(mixed)] if mixed is not None else []))}-{SCAN_VERSION}"
    told = here / "trial.json"
    if not told.is_file() or json.loads(told.read_text())["make"] != make:
        aside = here.with_name(f".{here.name}-{os.getpid()}")  # two processes may make it at once
        _make(scenario, seed, aside, make, mixed)
        shutil.rmtree(here, ignore_errors=True)
        try:
            aside.rename(here)
        except OSError:  # the other was quicker, and its run is the same
            shutil.rmtree(aside)
    return _loaded(setting, seed, here)


def without_leaks(scenario):
    """Return the same main with its false sources only."""
    local = tuple(x for x in scenario.sound.local if x.kind is not LeakClass.LEAK)
    return replace(scenario, sound=replace(scenario.sound, local=local))


def without_scraping(scenario):
    """Return the same main where nothing scrapes."""
    return replace(scenario, sound=replace(scenario.sound, scraping=Scraping()))


def wav_of(run, path, mixed=None):
    """Write the sound of a simulated run to ``path`` in blocks, as the simulator itself does."""
    with sf.SoundFile(path, "w", run.sound.rate_hz, 1, subtype="PCM_16") as file:
        done = 0
        for block in sound_blocks(run.sound):
            if mixed is not None:
                block = np.clip(mixed(block, done, run), -1.0, 1.0)
            file.write(np.round(block * 32767).astype(np.int16))
            done += len(block)


def told_path(run, seed):
    """Return the track that is told, and the function from true to told chainage."""
    motion = run.motion
    rng = np.random.default_rng([seed, 92])
    error = gauss_markov((0.0, max(run.route.length_m, 1.0)), PATH_SIGMA_M, PATH_WANDER_M, rng)

    def told(chainage_m):
        at = np.atleast_1d(np.asarray(chainage_m, np.float64))
        return at + error(at)

    every = max(round(run.scenario.imu.rate_hz / _TRACK_HZ), 1)
    rows = slice(None, None, every)
    time_s = motion.time_s[rows]
    chainage = np.maximum.accumulate(told(motion.chainage_m[rows]))
    sigma = np.full(len(time_s), PATH_SIGMA_M)
    track = Track(
        time_s, chainage, motion.position_w_m[rows], sigma, sigma, sigma, motion.quat_ws[rows],
        np.gradient(chainage, time_s), "truth",
    )  # fmt: skip
    return track, told


def _make(scenario, seed, here, make, mixed):
    shutil.rmtree(here, ignore_errors=True)
    here.mkdir(parents=True)
    run = simulate(scenario, seed)
    wav = here / "audio.wav"
    wav_of(run, wav, mixed)
    source, _ = open_audio([wav])
    scan(source, SoundSettings(), out_dir=here / "scan", threads=1)
    wav.unlink()
    track, told = told_path(run, seed)
    imu = run.imu
    np.savez(here / "imu.npz", time_s=imu.time_s, acc=imu.acc_s_mps2.astype(np.float32), gyr=imu.gyr_s_radps)
    np.savez(
        here / "track.npz", time_s=track.time_s, chainage_m=track.chainage_m, position_w_m=track.position_w_m,
        quat_ws=track.quat_ws, speed_mps=track.speed_mps,
    )  # fmt: skip
    write_survey_toml(here / "survey.toml", run.survey)
    leaks = [TrueLeak(p.name, p.chainage_m, float(told(p.chainage_m)[0]), p.snr_db, p.half_width_m) for p in run.leaks]
    for k, x in enumerate(mixed.leaks if mixed is not None else ()):
        told_m = float(told(x.chainage_m)[0])
        leaks.append(TrueLeak(f"{x.kind} {k + 1}", x.chainage_m, told_m, x.snr_db, x.half_width_m))
    clock_error = float(np.random.default_rng([seed, 93]).normal(0, CLOCK_SIGMA_S))
    content = {
        "make": make,
        "clock": [run.clock.start_s + clock_error, run.clock.drift_ppm],
        "length_m": run.route.length_m,
        "leaks": [asdict(leak) for leak in leaks],
        "false_places": [[kind, float(told(at)[0])] for kind, at in _false_places(run)],
    }
    (here / "trial.json").write_text(json.dumps(content))


def _false_places(run):
    """What stands, passes or happens along the way and is no leak; joints and scraping are everywhere."""
    motion, scenario = run.motion, run.scenario

    def where(time_s):
        return float(np.interp(time_s, motion.time_s, motion.chainage_m))

    yield from ((str(p.kind), p.chainage_m) for p in run.places if p.kind is not LeakClass.LEAK)
    yield from (("bend", float(at)) for at, _ in run.route.bends_m)
    yield from (("traffic", where(x.time_s)) for x in scenario.sound.timed)
    yield from (("stop", s.chainage_m) for s in scenario.drive.stops)
    yield from (("stray", b.chainage_m) for b in run.blows if b.kind == "stray")
    yield from (("pump", where(t)) for p in scenario.sound.pumps for t in (p.start_s, p.end_s))


def _loaded(setting, seed, here):
    content = json.loads((here / "trial.json").read_text())
    with np.load(here / "imu.npz") as kept:
        time_s = kept["time_s"]
        imu = ImuSamples(time_s, kept["acc"].astype(np.float64), kept["gyr"], np.ones(len(time_s), np.bool_))
    with np.load(here / "track.npz") as kept:
        sigma = np.full(len(kept["time_s"]), PATH_SIGMA_M)
        track = Track(
            kept["time_s"], kept["chainage_m"], kept["position_w_m"], sigma, sigma, sigma, kept["quat_ws"],
            kept["speed_mps"], "truth",
        )  # fmt: skip
    start_s, drift_ppm = content["clock"]
    return Trial(
        setting=setting,
        seed=seed,
        scan=SoundScan.load(here / "scan"),
        clock=ClockMap(start_s, drift_ppm, CLOCK_SIGMA_S, "knocks"),
        track=track,
        survey=read_survey_toml(here / "survey.toml"),
        imu=imu,
        leaks=tuple(TrueLeak(**row) for row in content["leaks"]),
        false_places=tuple(FalsePlace(*row) for row in content["false_places"]),
        length_m=content["length_m"],
    )
