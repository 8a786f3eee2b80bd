"""A simulated run as a survey folder, as the technician would copy it off the device, with the truth beside it.

``imu.csv``, the sound file, ``survey.toml`` are what Leakline reads; ``truth.json`` and ``truth_track.csv`` are for
whoever checks the result.
"""

import dataclasses
import errno
import json
import shutil
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.survey_toml import write_survey_toml
from processing.progress import Progress, silent
from processing.simulation.run import SimulatedRun
from processing.simulation.scenario import Faults
from processing.simulation.sound import sound_blocks
from processing.survey import FloatArray, ImuSamples

_ROWS_A_BLOCK = 4096
_LEAST_FREE_BYTES = 1 << 20
_TRUTH_RATE_HZ = 20.0
_COLUMNS = (
    (("acc_x_mps2", "acc_y_mps2", "acc_z_mps2"), "%.4f"),
    (("gyr_x_radps", "gyr_y_radps", "gyr_z_radps"), "%.6f"),
    (("mag_x_uT", "mag_y_uT", "mag_z_uT"), "%.3f"),
    (("quat_w", "quat_x", "quat_y", "quat_z"), "%.6f"),
    (("pressure_kPa",), "%.3f"),
    (("temperature_C",), "%.2f"),
)


def write_run(run: SimulatedRun, folder: Path, progress: Progress | None = None) -> None:
    """Write all files of ``run`` into ``folder`` (made if absent; files of the same names are replaced).

    Raises:
        LeaklineError: DISC_FULL, or CANNOT_WRITE where the folder or a file cannot be written.
    """
    progress = progress or silent()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        progress.update(0.0, "write_imu")
        _write_imu(run.imu, run.scenario.faults, run.seed, folder / "imu.csv", progress.part(0.0, 0.3))
        if run.sound is not None:
            _write_sound(run, folder / run.scenario.sound.file, progress.part(0.3, 0.95, "write_sound"))
        write_survey_toml(folder / "survey.toml", run.survey)
        (folder / "truth.json").write_text(json.dumps(_truth(run), indent=1), encoding="utf-8")
        _write_track(run, folder / "truth_track.csv")
    except OSError as error:
        reason = error.strerror or str(error)
        code = ErrorCode.DISC_FULL if error.errno == errno.ENOSPC else ErrorCode.CANNOT_WRITE
        raise LeaklineError(code, Place(folder), reason=reason) from error
    progress.update(1.0, "write_sound")


def _write_imu(imu: ImuSamples, faults: Faults, seed: int, path: Path, progress: Progress) -> None:
    channels = (imu.acc_s_mps2, imu.gyr_s_radps, imu.mag_s_ut, imu.quat_ws, imu.pressure_kpa, imu.temperature_c)
    names, formats, parts = ["time_s"], ["%.6f"], [imu.time_s[:, None]]
    for (columns, form), data in zip(_COLUMNS, channels):
        if data is not None:
            names += columns
            formats += [form] * len(columns)
            parts.append(data.reshape(len(data), -1))
    _write_table(path, names, formats, _with_faults(np.hstack(parts), faults, seed), progress)


def _with_faults(table: FloatArray, faults: Faults, seed: int) -> FloatArray:
    rng = np.random.default_rng([seed, 4])
    keep = np.ones(len(table), dtype=np.bool_)
    for gap in faults.gaps:
        keep &= (table[:, 0] < gap.start_s) | (table[:, 0] > gap.end_s)
    table = table[keep]
    if faults.nan_rows:
        table[rng.choice(len(table), faults.nan_rows, replace=False), 1:] = np.nan
    if faults.duplicate_rows:
        table = np.insert(table, (rows := rng.choice(len(table), faults.duplicate_rows, replace=False)), table[rows], 0)
    for row in rng.choice(len(table) - 1, faults.swapped_rows, replace=False):
        table[[row, row + 1]] = table[[row + 1, row]]
    return table


def _write_table(path: Path, names: list[str], formats: list[str], table: FloatArray, progress: Progress) -> None:
    """Write a CSV; one format call a block of rows is some ten times as fast as one a row."""
    line = ",".join(formats) + "\n"
    whole = line * _ROWS_A_BLOCK
    with path.open("w", encoding="utf-8", newline="") as file:
        file.write(",".join(names) + "\n")
        for first in range(0, len(table), _ROWS_A_BLOCK):
            block = table[first : first + _ROWS_A_BLOCK]
            form = whole if len(block) == _ROWS_A_BLOCK else line * len(block)
            file.write(form % tuple(block.ravel().tolist()))
            progress.update(first / len(table))


def _write_sound(run: SimulatedRun, path: Path, progress: Progress) -> None:
    import soundfile as sf

    plan = run.sound
    assert plan is not None
    done = 0
    try:
        with sf.SoundFile(path, "w", plan.rate_hz, 1, subtype="PCM_16") as file:
            for block in sound_blocks(plan):
                # scaled here, so that the file is the same whatever the library makes of full scale
                file.write(np.round(block * 32767).astype(np.int16))
                done += len(block)
                progress.update(min(done / plan.frames, 1.0), "write_sound")
    except sf.LibsndfileError as error:
        # the library does not say why it cannot write; half a file would look like the device's own
        full = shutil.disk_usage(path.parent).free < _LEAST_FREE_BYTES
        path.unlink(missing_ok=True)
        raise OSError(errno.ENOSPC if full else errno.EIO, error.error_string) from error


def _write_track(run: SimulatedRun, path: Path) -> None:
    motion = run.motion
    every = max(round(run.scenario.imu.rate_hz / _TRUTH_RATE_HZ), 1)
    rows = slice(None, None, every)
    table = np.column_stack(
        [motion.time_s[rows], motion.chainage_m[rows], motion.position_w_m[rows], motion.speed_mps[rows],
         motion.quat_ws[rows], motion.rotation_rad[rows]]
    )  # fmt: skip
    names = ["time_s", "chainage_m", "east_m", "north_m", "up_m", "speed_mps"]
    names += ["quat_w", "quat_x", "quat_y", "quat_z", "rotation_rad"]
    _write_table(path, names, ["%.4f"] * 6 + ["%.7f"] * 4 + ["%.4f"], table, silent())


def _truth(run: SimulatedRun) -> dict[str, object]:
    return {
        "simulated": True,
        "scenario": run.scenario.name,
        "seed": run.seed,
        "length_m": run.route.length_m,
        "duration_s": float(run.motion.time_s[-1]),
        "clock": {"start_s": run.clock.start_s, "drift_ppm": run.clock.drift_ppm},
        "places": [dataclasses.asdict(place) for place in run.places],
        "timed": [dataclasses.asdict(x) for x in run.scenario.sound.timed],
        "pumps": [dataclasses.asdict(x) for x in run.scenario.sound.pumps],
        "bends": [{"chainage_m": c, "angle_deg": float(np.degrees(a))} for c, a in run.route.bends_m],
        "stops": [dataclasses.asdict(x) for x in run.scenario.drive.stops],
        "blows": [dataclasses.asdict(blow) for blow in run.blows],
        "ball": dataclasses.asdict(run.scenario.ball),
    }
