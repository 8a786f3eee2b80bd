"""The import doctor: raw rows in, clean samples out, with every fault told, mended where certain and masked where not.

What cannot be repaired is never invented: such rows stay in place with ``valid`` False and finite values held or drawn
straight, and every span longer than ``short_hole_s`` is returned as a :class:`~processing.survey.Stretch`, which the
report shows as *not assessed*.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing import doctor_extras, doctor_time, doctor_units, doctor_values
from processing.importing.doctor_time import MIN_ROWS
from processing.importing.raw import RawImu
from processing.importing.text_blocks import Faults
from processing.progress import Progress, silent
from processing.settings import ImportSettings
from processing.survey import BoolArray, Channel, Finding, FloatArray, ImuSamples, Severity, Stretch


@dataclass(frozen=True)
class Examined:
    """Clean samples, what was found, and the spans that cannot be assessed."""

    imu: ImuSamples
    findings: tuple[Finding, ...]
    not_assessed: tuple[Stretch, ...]


def examine(
    raw: RawImu, settings: ImportSettings, path: Path | None = None, progress: Progress | None = None
) -> Examined:
    """Return what is sound in ``raw``, which is used up: its arrays become those of the samples.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES where less than 16 usable rows are left; SAMPLE_RATE_MISSING where there are no
            times and nobody told the rate.
    """
    progress = silent() if progress is None else progress
    place = Place(path) if path is not None else None
    findings = [*raw.findings, *fault_findings(raw.faults)]
    _check_size(raw, place)
    findings += doctor_time.settle_unit(raw, place)
    progress.update(0.1, "import_examining")
    more, stretches = doctor_time.settle_order(raw, settings)
    findings += more
    _check_size(raw, place)
    progress.update(0.4)
    unreadable = doctor_values.find_unreadable(raw)
    findings += doctor_units.settle_acc(raw)
    findings += doctor_units.settle_gyr(raw)
    progress.update(0.6)
    gaps, gap_stretches = doctor_time.find_gaps(raw.time, settings)
    findings += gaps
    findings += doctor_time.find_two_rates(raw.time)
    masks = [unreadable, doctor_values.find_impossible(raw, settings)]
    masks += [*doctor_values.find_saturated(raw), doctor_values.find_frozen(raw)]
    for mask in masks:
        told, spans = doctor_values.stretches_of(mask, raw.time, settings)
        findings += told
        stretches += spans
    progress.update(0.8)
    holes = unreadable.rows | masks[1].rows
    valid = ~np.logical_or.reduce([m.rows for m in masks])
    dead, is_dead = doctor_values.find_dead(raw)
    if is_dead:
        findings += dead
        valid[:] = False
        stretches = [Stretch(float(raw.time[0]), float(raw.time[-1]), Channel.PATH, "imu_dead")]
    elif (~holes).sum() < MIN_ROWS:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, place, count=int((~holes).sum()), needed=MIN_ROWS)
    doctor_values.fill(raw.acc, raw.time, holes)
    doctor_values.fill(raw.gyr, raw.time, holes)
    findings += doctor_values.find_rest_gravity(raw.time, raw.acc, raw.gyr, settings)
    imu, more = _assembled(raw, valid)
    findings += more
    progress.update(1.0)
    return Examined(imu, tuple(findings), merged([*stretches, *gap_stretches]))


def _check_size(raw: RawImu, place: Place | None) -> None:
    if len(raw) < MIN_ROWS:
        raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, place, count=len(raw), needed=MIN_ROWS)


def fault_findings(faults: Faults) -> list[Finding]:
    """Return what the reader could not read, as findings."""
    findings = []
    if faults.lines:
        params: dict[str, str | float] = {"count": faults.lines, "first_line": faults.first_line or 0}
        findings.append(Finding("lines_unreadable", Severity.REPAIRED, params))
    if faults.long_lines:
        findings.append(Finding("lines_too_long", Severity.REPAIRED, {"count": faults.long_lines}))
    if faults.nul_bytes:
        findings.append(Finding("nul_bytes", Severity.REPAIRED, {"count": faults.nul_bytes}))
    return findings


def _assembled(raw: RawImu, valid: BoolArray) -> tuple[ImuSamples, list[Finding]]:
    mag, findings = doctor_extras.settle_mag(raw)
    quat, more = doctor_extras.settle_quat(raw)
    pressure = doctor_extras.settle_slow(raw.pressure, raw.time)
    temperature = doctor_extras.settle_slow(raw.temperature, raw.time)
    arrays: list[FloatArray | BoolArray | None] = [raw.time, raw.acc, raw.gyr, valid, mag, quat, pressure, temperature]
    for array in arrays:
        if array is not None:
            array.flags.writeable = False
    imu = ImuSamples(raw.time, raw.acc, raw.gyr, valid, mag, quat, pressure, temperature)
    return imu, [*findings, *more]


def merged(stretches: list[Stretch], apart_s: float = 0.1) -> tuple[Stretch, ...]:
    """Return stretches in the order of time; those of one reason that (nearly) touch become one."""
    out: list[Stretch] = []
    last: dict[tuple[Channel, str], int] = {}
    for stretch in sorted(stretches, key=lambda s: (s.start_s, s.end_s)):
        at = last.get((stretch.channel, stretch.reason))
        if at is not None and stretch.start_s - out[at].end_s <= apart_s:
            end = max(out[at].end_s, stretch.end_s)
            out[at] = Stretch(out[at].start_s, end, stretch.channel, stretch.reason)
        else:
            last[(stretch.channel, stretch.reason)] = len(out)
            out.append(stretch)
    return tuple(out)
