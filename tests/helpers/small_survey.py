"""A tiny survey on disc with results made by hand: a straight pipe of 100 m, ten seconds a candidate."""

from dataclasses import replace

import numpy as np
import soundfile

from processing.results import Results
from processing.settings import Settings
from processing.sound.scan import scan
from processing.sound.source import open_audio
from processing.storage.folder import SurveyFolder
from processing.survey import (
    Candidate,
    Channel,
    ClockMap,
    DeviceInfo,
    Finding,
    ImuSamples,
    LeakClass,
    Recording,
    Severity,
    Stretch,
    Survey,
    SurveyInfo,
    TiePoint,
    Track,
)

RATE_HZ = 8000
SPEED_MPS = 2.0
DURATION_S = 50.0
RADIUS_M = 0.1
SURVEY = Survey(
    info=SurveyInfo("Station Road", "A. Şahin", "2026-05-04"),
    device=DeviceInfo(radius_m=RADIUS_M),
    tie_points=(TiePoint("retrieval", DURATION_S, chainage_m=SPEED_MPS * DURATION_S),),
)


def make_device_folder(place):
    """Write a device's folder: rolling along x at constant speed, with noise for sound; returns it."""
    device = place / "device"
    device.mkdir(parents=True)
    time_s = np.arange(0.0, DURATION_S, 0.02)
    turning = np.where((time_s > 5.0) & (time_s < DURATION_S - 5.0), SPEED_MPS / RADIUS_M, 0.0)
    angle = np.concatenate([[0.0], np.cumsum(turning[1:] * 0.02)])
    zero = np.zeros_like(time_s)
    exact = [-9.81 * np.sin(angle), zero, 9.81 * np.cos(angle), zero, turning, zero]
    noise = np.random.default_rng(2).normal(0.0, [0.02] * 3 + [0.002] * 3, (len(time_s), 6))  # silence looks dead
    table = np.column_stack([time_s, np.column_stack(exact) + noise])
    rows = "\n".join(",".join(f"{value:.4f}" for value in row) for row in table)
    header = "time_s,acc_x_mps2,acc_y_mps2,acc_z_mps2,gyr_x_radps,gyr_y_radps,gyr_z_radps"
    (device / "imu.csv").write_text(f"{header}\n{rows}\n", encoding="utf-8")
    noise = np.random.default_rng(1).normal(0.0, 0.05, int(DURATION_S * RATE_HZ))
    soundfile.write(device / "audio.wav", noise, RATE_HZ, subtype="PCM_16")
    return device


def make_folder(place):
    """Make a survey folder of a device's folder; returns it open."""
    device = make_device_folder(place)
    return SurveyFolder.create(place, SURVEY, [device / "imu.csv", device / "audio.wav"])


def candidate(number, chainage_m, score):
    """Return a candidate at ``chainage_m`` of the straight pipe."""
    return Candidate(
        id=number,
        time_s=chainage_m / SPEED_MPS,
        chainage_m=chainage_m,
        chainage_low95_m=chainage_m - 0.8,
        chainage_high95_m=chainage_m + 0.8,
        position_w_m=(chainage_m, 0.0, 0.0),
        score=score,
        level_db=9.0 * score,
        leak_class=LeakClass.LEAK,
        band_hz=(500.0, 3500.0),
        width_m=2.0,
    )


def make_track():
    """Return the straight path due east at constant speed."""
    time_s = np.arange(0.0, DURATION_S + 0.01, 0.1)
    chainage_m = SPEED_MPS * time_s
    count = len(time_s)
    zeros = np.zeros(count)
    return Track(
        time_s=time_s,
        chainage_m=chainage_m,
        position_w_m=np.column_stack([chainage_m, zeros, zeros]),
        sigma_along_m=np.full(count, 0.4),
        sigma_cross_m=np.full(count, 0.2),
        sigma_up_m=np.full(count, 0.1),
        quat_ws=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        speed_mps=np.full(count, SPEED_MPS),
        method="test",
    )


def make_results(folder, chainages_m=(20.0, 40.0, 60.0, 80.0), *, run_hash="made by hand"):
    """Return results of ``folder`` with one candidate at each chainage, the later the less likely."""
    audio, _ = open_audio([folder.original_dir / "audio.wav"])
    time_s = np.arange(0.0, DURATION_S, 0.1)
    acc = np.tile([0.0, 0.0, 9.81], (len(time_s), 1))
    imu = ImuSamples(time_s, acc, np.zeros_like(acc), np.ones(len(time_s), dtype=bool))
    stretches = (Stretch(45.0, 47.0, Channel.SOUND, "sound_silent"),)
    findings = (Finding("sound_missing", Severity.WARNING),)
    count = len(chainages_m)
    return Results(
        survey=folder.read_survey(),
        recording=Recording(imu, audio, findings, stretches, folder.files()),
        settings=Settings(),
        clock=ClockMap(),
        attitude_method="test",
        calibration=None,
        track=make_track(),
        scan=scan(audio, Settings().sound, out_dir=folder.path / "cache" / "scan-of-test"),
        level_along=None,
        candidates=tuple(candidate(i, c, 0.9 - 0.5 * i / count) for i, c in enumerate(chainages_m, start=1)),
        findings=findings,
        not_assessed=stretches,
        run_hash=run_hash,
        timings={},
    )


def other_run(results, chainages_m, run_hash):
    """Return the same results with candidates at other places."""
    found = tuple(candidate(i, c, 0.8) for i, c in enumerate(chainages_m, start=1))
    return replace(results, candidates=found, run_hash=run_hash)
