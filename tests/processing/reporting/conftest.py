"""One small processed survey, made by hand, so that every number in a report is known beforehand."""

from pathlib import Path

import numpy as np
import pytest

from processing.results import Results
from processing.settings import Settings
from processing.sound.level_along import LevelAlong
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.survey import (
    AudioSource,
    Candidate,
    Channel,
    ClockMap,
    Decision,
    ImportedFile,
    Launch,
    LeakClass,
    PipeInfo,
    Recording,
    Stretch,
    Survey,
    SurveyInfo,
    TiePoint,
    Track,
    Verdict,
)

LENGTH_M, SPEED_MPS = 100.0, 0.5
NOTE = 'ıslak zemin; "İŞĞÜÖÇ", =2+2'


def straight_track() -> Track:
    """A straight run of 100 m to the north-east at 0.5 m/s, ± 0.5 m along."""
    time_s = np.arange(0.0, LENGTH_M / SPEED_MPS + 0.05, 0.1)
    chainage_m = time_s * SPEED_MPS
    side = chainage_m / np.sqrt(2)
    half = np.full(time_s.size, 0.5)
    return Track(
        time_s=time_s,
        chainage_m=chainage_m,
        position_w_m=np.column_stack([side, side, -0.01 * chainage_m]),
        sigma_along_m=half,
        sigma_cross_m=half,
        sigma_up_m=half,
        quat_ws=np.tile([1.0, 0.0, 0.0, 0.0], (time_s.size, 1)),
        speed_mps=np.full(time_s.size, SPEED_MPS),
        method="rolling",
        quality={"tie_residual_rms_m": 0.2, "tie_left_out_max_m": 0.7},
    )


def candidate(number: int, chainage_m: float, score: float) -> Candidate:
    """A candidate on the straight track with ± 1 m."""
    side = chainage_m / np.sqrt(2)
    return Candidate(
        id=number,
        time_s=chainage_m / SPEED_MPS,
        chainage_m=chainage_m,
        chainage_low95_m=chainage_m - 1.0,
        chainage_high95_m=chainage_m + 1.0,
        position_w_m=(side, side, -0.01 * chainage_m),
        score=score,
        level_db=6.0,
        leak_class=LeakClass.LEAK,
        band_hz=(500.0, 4000.0),
        width_m=1.5,
    )


@pytest.fixture(scope="session")
def sound(tmp_path_factory) -> tuple[AudioSource, Path]:
    import soundfile

    folder = tmp_path_factory.mktemp("sound")
    noise = np.random.default_rng(1).normal(0, 0.05, 8000 * 200)
    soundfile.write(folder / "audio.wav", noise, 8000, subtype="PCM_16")
    source, _ = open_audio([folder / "audio.wav"])
    scan(source, Settings().sound, out_dir=folder / "scan")
    return source, folder / "scan"


@pytest.fixture(scope="session")
def results(sound) -> Results:
    from processing.sound.scan import SoundScan

    source, folder = sound
    along = np.arange(0.0, 100.0, 0.25)
    level = np.full(along.size, -40.0)
    return Results(
        survey=Survey(
            info=SurveyInfo(name="Çınar Sokağı", operator="Ayşe", date="2026-05-04"),
            pipe=PipeInfo("ductile iron", 0.3, LENGTH_M),
            launch=Launch(latitude=40.9012, longitude=29.1, elevation_m=31.0),
            tie_points=(TiePoint("valve 12", 60.0, chainage_m=30.0), TiePoint("hydrant", 160.0, chainage_m=80.0)),
        ),
        recording=Recording(None, source, files=(ImportedFile(Path("imu.csv"), "imu", 1234, "ab" * 32),)),
        settings=Settings(),
        clock=ClockMap(sigma_s=0.002, basis="knocks"),
        attitude_method="offline_vqf",
        calibration=None,
        track=straight_track(),
        scan=SoundScan.load(folder),
        level_along=LevelAlong(
            time_s=along / SPEED_MPS,
            chainage_m=along,
            level_db=level + np.where(np.abs(along - 42) < 1, 8.0, 0.0),
            background_db=level,
            threshold_db=level + 4,
            band_hz=(500.0, 4000.0),
        ),
        candidates=(candidate(1, 42.0, 0.6), candidate(2, 70.0, 0.9), candidate(3, 10.0, 0.3)),
        findings=(),
        not_assessed=(Stretch(100.0, 120.0, Channel.SOUND, "sound_clipped"),),
        run_hash="0123456789abcdef01234567",
        timings={"track": 0.5},
    )


@pytest.fixture
def decisions() -> dict[int, Decision]:
    return {1: Decision(Verdict.CONFIRMED, LeakClass.VALVE, NOTE), 3: Decision(Verdict.REJECTED)}
