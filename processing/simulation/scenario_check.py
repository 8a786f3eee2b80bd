"""What a scenario must keep to, so that whatever passes can be simulated within the machine's memory."""

import dataclasses
from collections.abc import Iterator, Mapping
from itertools import pairwise
from pathlib import Path

from processing.simulation.route import centre_line
from processing.simulation.scenario import Foot, Scenario, Sound
from processing.survey import Motion

#: field name (in any table, or ``table.field``) → least and greatest value
_LIMITS: Mapping[str, tuple[float, float]] = {
    "bend_radius_m": (0.01, 1e4),
    "route.length_m": (0.5, 1e5),
    "speed_mps": (0.01, 20.0),
    "variation": (0.0, 0.5),
    "variation_period_s": (1.0, 3600.0),
    "ramp_s": (0.1, 600.0),
    "rest_start_s": (0.0, 3600.0),
    "rest_end_s": (0.0, 3600.0),
    "duration_s": (0.01, 36000.0),
    "radius_m": (0.005, 2.0),
    "told_radius_m": (0.001, 10.0),
    "slip": (-0.5, 0.9),
    "slip_sigma": (0.0, 0.3),
    "slip_tau_s": (0.1, 1e5),
    "spin_sigma_radps": (0.0, 50.0),
    "spin_tau_s": (0.1, 1e5),
    "step_hz": (0.05, 10.0),
    "bob_m": (0.0, 0.5),
    "sway_m": (0.0, 0.5),
    "wobble_deg": (0.0, 60.0),
    "stride_m": (0.05, 5.0),
    "stride_s": (0.2, 20.0),
    "heel_share": (0.01, 0.4),
    "flat_share": (0.02, 0.8),
    "toe_share": (0.01, 0.4),
    "clearance_m": (0.0, 1.0),
    "heel_pitch_deg": (0.0, 80.0),
    "toe_pitch_deg": (0.0, 89.0),
    "base_pitch_deg": (-89.0, 89.0),
    "creep_deg": (0.0, 45.0),
    "shock_mps2": (0.0, 2000.0),
    "drag_mps2": (0.0, 100.0),
    "foot.variation": (0.0, 0.2),
    "aside_m": (-1.0, 1.0),
    "sway_deg": (0.0, 20.0),
    "imu.rate_hz": (10.0, 2000.0),
    "sound.rate_hz": (4000.0, 192000.0),
    "gyro_range_radps": (0.01, 1e9),
    "acc_range_mps2": (0.01, 1e9),
    "gyro_step_radps": (0.0, 1.0),
    "acc_step_mps2": (0.0, 10.0),
    "stamp_jitter_s": (0.0, 1.0),
    "nan_rows": (0, 100),
    "duplicate_rows": (0, 100),
    "swapped_rows": (0, 100),
    "pipe_scale_m": (0.05, 1e4),
    "half_width_m": (0.01, 1e5),
    "centre_hz": (5.0, 1e5),
    "octaves": (0.1, 10.0),
    "snr_db": (-100.0, 150.0),
    "bend_snr_db": (-100.0, 150.0),
    "flow_drift_db": (0.0, 20.0),
    "rolling_drift_db": (0.0, 20.0),
    "spin_radps": (0.0, 200.0),
    "slides.share": (-1.0, 1.0),
    "gyro_scale_range": (0.0, 0.1),
    "gyro_misalignment_range_rad": (0.0, 0.1),
    "gyro_g_sensitivity": (0.0, 0.1),
    "gyro_instability_radps": (0.0, 1.0),
    "latitude_deg": (-90.0, 90.0),
    "magnetic_ut": (0.0, 1000.0),
    "magnetic_half_width_m": (0.02, 100.0),
    "rolling_modulation": (0.0, 5.0),
    "flutter": (0.0, 2.0),
    "turning": (0.0, 1.0),
    "skew": (0.05, 20.0),
    "spectrum": (-300.0, 1e5),
    "flow_slope": (-3.0, 6.0),
    "flow_corner_hz": (1.0, 1e5),
    "band_hz": (5.0, 1e5),
    "rolling_band_hz": (5.0, 1e5),
    "rolling_third": (0.0, 5.0),
    "order": (0.1, 1e4),
    "lines_stable_m": (0.05, 1e5),
    "lines_fade_db": (0.0, 20.0),
    "lines_wander_rad": (0.0, 20.0),
    "per_minute": (0.0, 600.0),
    "frequency_hz": (1.0, 1e5),
    "harmonics": (1, 200),
    "spacing_m": (0.0, 1e5),
    "bump_mps2": (0.0, 500.0),
    "knock_mps2": (0.0, 500.0),
    "stray_per_minute": (0.0, 600.0),
    "latitude": (-89.9, 89.9),
    "longitude": (-180.0, 180.0),
    "drift_ppm": (-1e4, 1e4),
    "clock.start_s": (-3600.0, 3600.0),
}
_MOST_IMU_ROWS = 1e7
_MOST_WAV_BYTES = 4e9


def check(scenario: Scenario) -> None:
    """Raise ValueError, naming the key, for what cannot be simulated."""
    for path, value in _numbers(scenario, ""):
        low, high = _limits(path)
        if not low <= value <= high:
            raise ValueError(f"'{path}' = {value:g} is outside {low:g} … {high:g}")
    _check_words(scenario)
    _check_sounds(scenario.sound)
    _check_gaits(scenario.foot)
    _check_size(scenario)


def _limits(path: str) -> tuple[float, float]:
    table, _, name = path.rpartition(".")
    for key in (f"{table.rpartition('.')[2]}.{name}", name):
        if key in _LIMITS:
            return _LIMITS[key]
    if name.endswith("_dbfs"):
        return -200.0, 20.0
    if any(word in name for word in ("sigma", "noise", "walk", "drift")):
        return 0.0, 1e6
    return -1e9, 1e9


def _numbers(thing: object, path: str) -> Iterator[tuple[str, float]]:
    if dataclasses.is_dataclass(thing):
        for f in dataclasses.fields(thing):
            yield from _numbers(getattr(thing, f.name), f"{path}.{f.name}" if path else f.name)
    elif isinstance(thing, tuple):
        for item in thing:
            yield from _numbers(item, path)
    elif isinstance(thing, (int, float)) and not isinstance(thing, bool):
        yield path, float(thing)


def _check_words(scenario: Scenario) -> None:
    if scenario.imu.gyro_sampling not in ("increment", "instant"):
        raise ValueError("'imu.gyro_sampling' must be one of increment, instant")
    for marker in scenario.markers:
        if marker.by not in ("chainage", "coordinates", "both"):
            raise ValueError("'markers.by' must be one of chainage, coordinates, both")
    if (scenario.paperwork.latitude is None) != (scenario.paperwork.longitude is None):
        raise ValueError("'paperwork.latitude' and 'paperwork.longitude' belong together")
    if 0 < scenario.sound.joints.spacing_m < 0.2:
        raise ValueError("'sound.joints.spacing_m' must be 0 (no joints) or at least 0.2")
    file = scenario.sound.file
    if Path(file).name != file or Path(file).suffix.lower() not in {".wav", ".flac", ".w64"}:
        raise ValueError("'sound.file' must be a plain name that ends in .wav, .flac or .w64")


def _check_sounds(sound: Sound) -> None:
    for local in sound.local:
        if local.shape not in ("lorentz", "exponential"):
            raise ValueError("'sound.local.shape' must be one of lorentz, exponential")
        hz = [point[0] for point in local.spectrum]
        if hz and (len(hz) < 2 or hz[0] < 1.0 or any(b <= a for a, b in pairwise(hz))):
            raise ValueError("'sound.local.spectrum' needs two points or more, of rising frequency")
    for name, (low, high) in (("rolling_band_hz", sound.rolling_band_hz), ("scraping.band_hz", sound.scraping.band_hz)):
        if low >= high:
            raise ValueError(f"'sound.{name}' must rise")


def _check_gaits(foot: Foot) -> None:
    if not foot.gaits:
        raise ValueError("'foot.gaits' needs at least one gait")
    if any(g.heel_share + g.flat_share + g.toe_share > 0.9 for g in foot.gaits):
        raise ValueError("'foot.gaits': heel_share, flat_share and toe_share must leave a tenth for the swing")


def _check_size(scenario: Scenario) -> None:
    drive = scenario.drive
    length = centre_line(scenario.route).length_m
    if not 0.5 <= length <= 1e5:
        raise ValueError(f"the route is {length:g} m long; 0.5 … 100000 are possible")
    slowest = drive.speed_mps
    if scenario.motion is Motion.FOOT:
        slowest = min(g.stride_m / g.stride_s for g in scenario.foot.gaits)
    seconds = length / slowest + drive.rest_start_s + drive.rest_end_s
    seconds += sum(s.duration_s + 2 * drive.ramp_s for s in drive.stops)
    if seconds * scenario.imu.rate_hz > _MOST_IMU_ROWS:
        raise ValueError(f"a run of {seconds / 3600:.1f} h at this 'imu.rate_hz' needs too much memory")
    sound = scenario.sound
    if sound.enabled and sound.file.lower().endswith(".wav") and 2 * seconds * sound.rate_hz > _MOST_WAV_BYTES:
        raise ValueError("the sound would outgrow a WAV file; give 'sound.file' the ending .w64")
