"""Every tunable of the pipeline, with unit, range, default and why; one frozen dataclass a step.

A field is made by :func:`tunable`; its metadata feeds the settings page, the check of ``--set`` and the manual.
The hash of a step's dataclass is part of the cache key of its result.
"""

import dataclasses
import hashlib
import json
from dataclasses import dataclass, field, fields, replace
from typing import Any

from processing.errors import ErrorCode, LeaklineError


def tunable(default: float, unit: str, low: float, high: float, why: str) -> Any:  # noqa: ANN401  # as dataclasses.field
    """Return a dataclass field for a number ``default`` in ``unit`` that may lie in ``low``..``high``."""
    return field(default=default, metadata={"unit": unit, "low": low, "high": high, "why": why})


def choice(default: str, options: tuple[str, ...], why: str) -> Any:  # noqa: ANN401  # as dataclasses.field
    """Return a dataclass field for one of ``options``."""
    return field(default=default, metadata={"options": options, "why": why})


@dataclass(frozen=True)
class ImportSettings:
    """How far the import doctor mends before it masks."""

    gap_factor: float = tunable(5.0, "sample periods", 2.0, 1000.0, "a longer silence in the time stamps is a gap")
    short_hole_s: float = tunable(
        0.05, "s", 0.0, 1.0, "shorter holes are bridged (navigation §6.1), longer ones masked"
    )
    gyr_limit_radps: float = tunable(100.0, "rad/s", 10.0, 1000.0, "5730 °/s: no gyro in use reads further")
    acc_limit_mps2: float = tunable(2000.0, "m/s²", 50.0, 1e5, "200 g: beyond shock sensors' range in such devices")
    rest_gravity_pct: float = tunable(3.0, "%", 0.5, 50.0, "|a| at rest further from 9.81 is a wrong scale or offset")
    sound_mismatch_pct: float = tunable(5.0, "%", 0.5, 100.0, "sound and IMU log of one run are equally long")
    sound_mismatch_s: float = tunable(30.0, "s", 1.0, 600.0, "starting and stopping two recorders takes that long")


@dataclass(frozen=True)
class OrientationSettings:
    """Calibration at rest and the attitude estimators."""

    rest_min_s: float = tunable(2.0, "s", 0.5, 60.0, "a shorter rest gives too noisy a gyro offset (navigation §6.2)")
    rest_acc_std_mps2: float = tunable(0.15, "m/s²", 0.01, 2.0, "held for rest on all BROAD trials (navigation §6.2)")
    rest_gyr_std_dps: float = tunable(1.5, "°/s", 0.1, 20.0, "held for rest on all BROAD trials (navigation §6.2)")
    rest_gyr_mean_dps: float = tunable(10.0, "°/s", 0.5, 50.0, "no gyro's offset is larger: a steady turn is no rest")
    rest_agree_dps: float = tunable(
        1.0, "°/s", 0.05, 20.0, "offsets of one run differ by less: else it was a steady turn"
    )
    gravity_tolerance_pct: float = tunable(
        2.0, "%", 0.1, 20.0, "|a| at rest further off is a wrong unit, scale or offset"
    )
    # rows that cannot be trusted, and holes in time
    bridge_s: float = tunable(0.05, "s", 0.0, 1.0, "over a shorter hole the turn is interpolated (navigation §6.1)")
    restart_s: float = tunable(1.0, "s", 0.1, 60.0, "after a longer hole the tilt is found anew from the accelerometer")
    restart_deg: float = tunable(5.0, "°", 0.1, 360.0, "so much turned in a hole is lost: likewise")
    start_s: float = tunable(
        3.0, "s", 0.2, 60.0, "specific force is averaged so long to find the first tilt (VQF: tau 3 s)"
    )
    rate_stands_for: str = choice(
        "interval",
        ("interval", "instant"),
        "the mean since the sample before, as strapdown recorders deliver it and BROAD wants it, or of the moment",
    )
    # magnetometer
    magnetometer: str = choice("auto", ("auto", "use", "ignore"), "auto trusts a steady field in a pipe without iron")
    mag_norm_tolerance_pct: float = tunable(
        10.0, "%", 1.0, 100.0, "a field of other strength is disturbed (navigation §6.2)"
    )
    mag_dip_tolerance_deg: float = tunable(
        10.0, "°", 1.0, 90.0, "a field of other inclination is disturbed (navigation §6.2)"
    )
    mag_clean_share: float = tunable(
        0.8, "1", 0.1, 1.0, "share of steady readings from which the magnetometer is trusted"
    )
    declination_deg: float = tunable(0.0, "°", -180.0, 180.0, "magnetic north east of true north, from a map")
    # estimators: defaults chosen on the nine BROAD trials of shared/data
    acc_deviation_g: float = tunable(
        100.0,
        "g",
        0.005,
        1000.0,
        "| |a|/g − 1 | that halves a reading; off: over bounded motion all of them average out",
    )
    madgwick_beta_radps: float = tunable(
        0.05, "rad/s", 0.0001, 10.0, "least total RMSE on BROAD, given a rest calibration"
    )
    mahony_kp_radps: float = tunable(0.2, "rad/s", 0.0, 50.0, "least total RMSE on BROAD; 0.1 to 0.4 differ by 15 %")
    mahony_ki_radps2: float = tunable(0.0001, "rad/s²", 0.0, 10.0, "more lets hard acceleration wind the offset up")
    mahony_kp_mag_radps: float = tunable(
        0.05, "rad/s", 0.0, 50.0, "slower than the tilt: a field is disturbed for seconds"
    )
    ekf_gyr_noise_dps_rthz: float = tunable(
        0.8, "°/s/√Hz", 0.0001, 10.0, "with the next two, least total RMSE on BROAD"
    )
    ekf_bias_walk_dps_rts: float = tunable(0.001, "°/s/√s", 0.0, 1.0, "more lets hard acceleration pull the offset")
    ekf_acc_noise_g_rthz: float = tunable(0.1, "g/√Hz", 0.0001, 10.0, "own acceleration, not sensor noise")
    ekf_heading_noise_deg_rthz: float = tunable(20.0, "°/√Hz", 0.01, 1000.0, "disturbed field, not sensor noise")
    gyro_scale: str = choice(
        "auto", ("auto", "off"), "auto finds the scale along a rolling ball's spin axis (navigation §4.4)"
    )
    accelerometer: str = choice(
        "auto", ("auto", "off"), "auto finds its offset, scale and place in the ball where these help (navigation §6.2)"
    )
    # error-state filter: chosen on half of BROAD's trials, a broad minimum; the other half was as good
    eskf_gyr_noise_dps_rthz: float = tunable(
        0.45, "°/s/√Hz", 0.0001, 10.0, "not sensor noise but scale and misalignment while it turns; least total RMSE"
    )
    eskf_bias_walk_dps_rts: float = tunable(0.001, "°/s/√s", 0.0, 1.0, "0.0003 to 0.003 differ by 0.1 %")
    eskf_acc_noise_mps_rts: float = tunable(0.1, "m/s/√s", 0.0001, 10.0, "specific force: noise, scale and vibration")
    eskf_velocity_noise_mps_rthz: float = tunable(
        0.3, "m/s/√Hz", 0.001, 100.0, "the velocity is bounded: 1.3 m/s at 20 Hz; 0.25 to 0.6 differ by 2 %"
    )
    eskf_heading_noise_deg_rthz: float = tunable(
        6.0, "°/√Hz", 0.01, 1000.0, "with the gyro's noise a pull of some 20 s"
    )
    eskf_heading_sigma_deg: float = tunable(
        8.0, "°", 0.1, 90.0, "a field further off than 3 sigma is doubted (navigation §6.2)"
    )
    # P3's filter with a gradient-descent observation
    ekf_gd_form: str = choice(
        "predicted", ("predicted", "published"), "where the descent begins; as published, turns about up are held back"
    )
    ekf_gd_alpha: float = tunable(10.0, "1", 1.0, 1000.0, "the descent's step over the turn's (P3: α > 1); least RMSE")
    ekf_gd_noise_rthz: float = tunable(
        1e-4, "1/√Hz", 1e-7, 10.0, "noise of the observed quaternion; with α, least total RMSE on half of BROAD"
    )


@dataclass(frozen=True)
class PositionSettings:
    """Odometry, standstills and the fit to what is known."""

    track_rate_hz: float = tunable(20.0, "Hz", 10.0, 200.0, "formats.md promises 10 rows a second or more")
    # odometry
    scale_sigma_pct: float = tunable(2.0, "%", 0.05, 50.0, "a ball not calibrated in this pipe (navigation §6.4)")
    slip_sigma_pct: float = tunable(
        1.0, "%", 0.0, 20.0, "each run tells its own level; the wheels of navigation §4.4 show twice this"
    )
    slip_tau_s: float = tunable(15.0, "s", 0.1, 3600.0, "slip varies within seconds (navigation §6.4: 5 to 20 s)")
    slip_walk: float = tunable(0.01, "m/√m", 0.001, 2.0, "what is left beside the slip that varies slowly")
    slope_sigma_pct: float = tunable(1.0, "%", 0.0, 30.0, "a rolling ball does not feel a constant slope")
    rolling_still_dps: float = tunable(2.0, "°/s", 0.1, 50.0, "a ball that turns more slowly lies still")
    reverse_max_m: float = tunable(2.0, "m", 0.1, 100.0, "rolling back further than this is a turn of the pipe")
    # carried and foot
    still_acc_mps2: float = tunable(0.5, "m/s²", 0.01, 5.0, "filtered | |a| − g | of a standstill (P3; 0.05 g)")
    still_gyr_dps: float = tunable(45.0, "°/s", 0.5, 200.0, "rate of a standstill; a standing foot still rolls")
    still_change_mps2: float = tunable(0.04, "m/s²", 0.005, 5.0, "least change of acceleration that counts as moving")
    still_min_s: float = tunable(0.15, "s", 0.02, 10.0, "a shorter quiet moment is no standstill")
    still_margin_s: float = tunable(0.2, "s", 0.0, 2.0, "the edge of a carried device's standstill still moves")
    zero_velocity_detector: str = choice(
        "auto",
        ("auto", "variance", "magnitude", "rate_energy", "shoe", "butterworth", "lstm", "tcn"),
        "what finds a foot's stances; auto takes what did best on walks that nothing was trained on",
    )
    zero_velocity_threshold: str = choice(
        "adaptive", ("adaptive", "fixed"), "a fixed one suits one gait only: 4.9 m instead of 0.1 m (navigation §4.2)"
    )
    foot_still_mps: float = tunable(0.02, "m/s", 0.0005, 0.5, "how still a stance is; 0.01 to 0.05 do alike")
    foot_acc_noise: float = tunable(0.01, "m/s/√s", 0.0001, 5.0, "of smooth motion; least error on the VICON trials")
    foot_jolt_share: float = tunable(
        0.14,
        "1",
        0.0,
        10.0,
        "of the change between two samples of force or rate, what is not seen: impacts are where strides err",
    )
    foot_gyr_noise_dps: float = tunable(0.02, "°/√s", 0.0001, 5.0, "of smooth motion; 0.01 to 0.035 do alike")
    foot_acc_offset_sigma: float = tunable(0.05, "m/s²", 0.0, 1.0, "consumer MEMS; 0.005 to 0.2 do alike")
    foot_acc_offset_walk: float = tunable(1e-4, "m/s²/√s", 0.0, 0.1, "navigation §6.4")
    foot_gyr_offset_sigma_dps: float = tunable(0.1, "°/s", 0.0, 10.0, "what the orientation step leaves of it")
    foot_gyr_offset_walk_dps: float = tunable(0.001, "°/s/√s", 0.0, 1.0, "navigation §6.4: 0.003; less did as well")
    foot_error_factor: float = tunable(2.0, "1", 0.1, 50.0, "makes 95 % intervals true on the VICON trials")
    foot_up_error_factor: float = tunable(1.0, "1", 0.1, 50.0, "likewise for height")
    foot_scale_sigma_pct: float = tunable(0.5, "%", 0.01, 20.0, "a stance that rolls shortens every stride alike")
    foot_slope_sigma_pct: float = tunable(
        1.3, "%", 0.0, 20.0, "a tilt that stays with the foot lets it rise or sink all the way; likewise"
    )
    inertial_scale_sigma_pct: float = tunable(0.5, "%", 0.01, 20.0, "accelerometer scale of consumer MEMS")
    velocity_walk: float = tunable(
        0.004, "m/s/√s", 0.0001, 1.0, "least error of integrated acceleration; stops raise it"
    )
    # heading
    heading_sigma_deg: float = tunable(3.0, "°", 0.1, 180.0, "how well a person states the direction of the launch")
    heading_drift_dph: float = tunable(
        300.0, "°/h", 0.0, 5000.0, "no magnetometer: 150–400 °/h (navigation §3.1, §4.4)"
    )
    rolling_drift_dph: float = tunable(
        100.0, "°/h", 0.0, 5000.0, "a ball's gyro calibrated by its own turning: wheels, median 27, p90 110, most 180"
    )
    heading_drift_tau_s: float = tunable(
        3600.0, "s", 10.0, 1e6, "the drift itself wanders: bias with temperature, scale with the spin axis"
    )
    heading_walk: float = tunable(0.05, "°/√s", 0.0, 5.0, "gyro noise and scale along the spin axis")
    magnetic_sigma_deg: float = tunable(8.0, "°", 0.5, 90.0, "magnetic heading near pipes (navigation §6.2)")
    # the fit
    keyframes: float = tunable(400.0, "", 50.0, 20000.0, "so many places are fitted; what lies between is summed")
    length_sigma_pct: float = tunable(0.2, "%", 0.001, 10.0, "how well a pipe's length is known, on top of 0.1 m")
    tie_time_sigma_s: float = tunable(0.3, "s", 0.0, 60.0, "reaction time of whoever notes a tie point")
    tie_clock_sigma_s: float = tunable(0.1, "s", 0.0, 60.0, "what all tie points' clock may be off, together")
    outlier_sigmas: float = tunable(3.0, "sigma", 1.5, 10.0, "a tie point that the others miss by more is held down")
    # what the recording itself says of the place
    bends: str = choice("auto", ("auto", "off"), "auto recognises the bends of the mapped route in the ball's turns")
    joints: str = choice("auto", ("auto", "off"), "auto counts pipe joints where blows or field show them regularly")
    pressure: str = choice("auto", ("auto", "off"), "auto takes the height from the pressure in the pipe")
    slips: str = choice("auto", ("auto", "off"), "auto marks where the ball slid, spun or reached a sensor's limit")


@dataclass(frozen=True)
class ClockSettings:
    """Mapping of the audio clock onto the IMU clock."""

    search_s: float = tunable(25.0, "s", 1.0, 120.0, "how far the two recorders may have been started apart")
    knock_zone_s: float = tunable(90.0, "s", 10.0, 600.0, "knocks are looked for this long at either end")
    max_drift_ppm: float = tunable(150.0, "ppm", 10.0, 1000.0, "no crystal is further off, even in the cold")
    imu_delay_periods: float = tunable(
        0.7, "sample periods", 0.0, 10.0, "delay of a second-order filter at a third of the rate"
    )
    contact_s: float = tunable(
        0.0025, "s", 0.0, 0.02, "half of how long a blow lasts: the middle of its force comes after its first sound"
    )
    assumed_start_sigma_s: float = tunable(1.0, "s", 0.01, 60.0, "how far apart recorders start that nobody aligned")
    assumed_drift_sigma_ppm: float = tunable(30.0, "ppm", 1.0, 200.0, "typical difference of two crystals")


@dataclass(frozen=True)
class SoundSettings:
    """The streamed pass over the audio."""

    band_low_hz: float = tunable(500.0, "Hz", 10.0, 90000.0, "below it flow, traffic and bends dominate")
    band_high_hz: float = tunable(4000.0, "Hz", 20.0, 96000.0, "above it little leak energy is left at a metre")
    silence_db: float = tunable(-100.0, "dBFS", -180.0, -20.0, "quieter than any microphone's own noise: it is not on")


@dataclass(frozen=True)
class DetectorSettings:
    """From levels in metres to candidates."""

    background_m: float = tunable(24.0, "m", 3.0, 200.0, "half window of the running background (acoustics §5.1)")
    min_speed_mps: float = tunable(0.12, "m/s", 0.0, 2.0, "slower, the same metre is heard on and on (acoustics §5.1)")
    min_score: float = tunable(0.2, "", 0.0, 1.0, "93 % of leaks at two false ones a kilometre (acoustics §5.2)")
    narrowest_m: float = tunable(
        0.5,
        "m",
        0.0,
        5.0,
        "half-width: above 800 Hz a leak is heard 1 to 3 m wide even in plastic; a scrape is narrower",
    )
    max_candidates: float = tunable(200.0, "", 1.0, 10000.0, "more than anybody reviews in a day")
    metres_from_m: float = tunable(100.0, "m", 30.0, 5000.0, "auto: shorter runs give metre statistics too few metres")
    metres_alone_from_m: float = tunable(
        300.0,
        "m",
        30.0,
        5000.0,
        "auto: on shorter runs a strong leak bends the bands' statistics, so loud peaks count too",
    )
    rolling_phase: str = choice("on", ("on", "off"), "weigh the quiet half of each turn more (acoustics §5.1 step 2)")
    envelope_smooth_s: float = tunable(4.0, "s", 0.2, 60.0, "best of the envelope finder (acoustics §5.2)")
    envelope_background_s: float = tunable(
        30.0, "s", 2.0, 600.0, "half window of its background where no path is known"
    )
    size_low_hz: float = tunable(800.0, "Hz", 20.0, 40000.0, "a leak's size is told from its level in this band")
    size_high_hz: float = tunable(3200.0, "Hz", 50.0, 90000.0, "likewise; leaks stood out there (hydrophone_pvc)")
    envelope_order: str = choice(
        "background", ("background", "plain"), "rank peaks against the local background, or as the papers, by height"
    )


@dataclass(frozen=True)
class CleaningSettings:
    """What listening cleaned takes out of the sound; the search for leaks does not use it."""

    lines: str = choice("on", ("on", "off"), "tones locked to the ball's turning: 15 to 25 dB less on simulated ones")
    lines_to_hz: float = tunable(2500.0, "Hz", 100.0, 8000.0, "above it rolling is not heard (acoustics §5.2)")
    rolling_depth: float = tunable(
        1.0, "1", 0.0, 3.0, "amplitude / (noise in this phase of the turn)^this; 1 weighs as the detector does"
    )
    impulse_sigmas: float = tunable(3.5, "sigma", 2.0, 100.0, "a louder frame of a band is a bump (acoustics §5.1)")
    high_pass_hz: float = tunable(0.0, "Hz", 0.0, 5000.0, "0: off; takes flow and traffic out of what is heard")


@dataclass(frozen=True)
class SizeSettings:
    """Small, medium or large: see :mod:`processing.sound.sizes`."""

    small_below_db: float = tunable(
        4.0, "dB", -30.0, 60.0, "excess at 0.5 m/s and 3 bar; an estimate, to be set by known leaks of the same pipe"
    )
    large_above_db: float = tunable(16.0, "dB", -30.0, 80.0, "likewise; 12 dB above: two borders must not touch")
    small_below_lpm: float = tunable(
        8.3, "L/min", 0.01, 10000.0, "0.5 m³/h: what water balances count as background leakage at 50 m of pressure"
    )
    large_above_lpm: float = tunable(
        100.0, "L/min", 0.1, 100000.0, "6 m³/h: what component analysis takes for an unreported burst of a main"
    )
    pressure_exponent: float = tunable(
        2.5, "1", 0.0, 5.0, "sound power for a given flow against pressure: theory of jets near a wall, 1.8 to 3.2"
    )


@dataclass(frozen=True)
class ReportSettings:
    """What the report says and how."""

    language: str = choice("en", ("en", "tr"), "the language of the PDF")


@dataclass(frozen=True)
class Settings:
    """All steps' settings; ``Settings()`` holds the defaults."""

    importing: ImportSettings = field(default_factory=ImportSettings)
    orientation: OrientationSettings = field(default_factory=OrientationSettings)
    position: PositionSettings = field(default_factory=PositionSettings)
    clock: ClockSettings = field(default_factory=ClockSettings)
    sound: SoundSettings = field(default_factory=SoundSettings)
    detector: DetectorSettings = field(default_factory=DetectorSettings)
    report: ReportSettings = field(default_factory=ReportSettings)
    size: SizeSettings = field(default_factory=SizeSettings)
    cleaning: CleaningSettings = field(default_factory=CleaningSettings)


def with_value(settings: Settings, table: str, key: str, text: str) -> Settings:
    """Return ``settings`` with ``table.key`` set from ``text``.

    Raises:
        LeaklineError: SETTING_UNKNOWN for a name that does not exist, SETTING_INVALID for a value out of range.
    """
    step: Any = getattr(settings, table) if table in {f.name for f in fields(settings)} else None
    known = {f.name: f for f in fields(step)} if step is not None else {}
    if key not in known:
        raise LeaklineError(ErrorCode.SETTING_UNKNOWN, name=f"{table}.{key}")
    changes: dict[str, Any] = {table: replace(step, **{key: _parsed(f"{table}.{key}", known[key], text)})}
    return replace(settings, **changes)


def _parsed(name: str, spec: "dataclasses.Field[Any]", text: str) -> str | float:
    meta = spec.metadata
    if "options" in meta:
        if text not in meta["options"]:
            allowed = ", ".join(meta["options"])
            raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed)
        return text
    allowed = f"{meta['low']:g} … {meta['high']:g} {meta['unit']}"
    try:
        value = float(text)
    except ValueError:
        raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed) from None
    if not meta["low"] <= value <= meta["high"]:
        raise LeaklineError(ErrorCode.SETTING_INVALID, name=name, value=text, allowed=allowed)
    return value


def digest(*parts: object) -> str:
    """Return a short stable hash of dataclasses, strings and numbers: the key of a cached result."""
    text = json.dumps(parts, default=_plain, sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:24]


def _plain(thing: object) -> object:
    if dataclasses.is_dataclass(thing) and not isinstance(thing, type):
        return {f.name: getattr(thing, f.name) for f in fields(thing)}
    return str(thing)
