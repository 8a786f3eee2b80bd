"""What each figure of a check before the launch means: green, yellow or red, and by which rule."""

import math
from dataclasses import dataclass

import numpy as np

from processing.live.check_knocks import Knocks
from processing.live.check_sheet import CheckItem, Light
from processing.live.stream import DiscStatus, SoundStatus
from processing.settings import tunable
from processing.survey import BoolArray, FloatArray, Motion

GRAVITY_MPS2 = 9.80665


@dataclass(frozen=True)
class CheckSettings:
    """The borders of the lights."""

    lost_green: float = tunable(1e-3, "", 0.0, 1.0, "so few lost samples are bridged without a trace")
    lost_yellow: float = tunable(1e-2, "", 0.0, 1.0, "more than one in a hundred: a bad cable or radio")
    samples_a_turn: float = tunable(15.0, "", 3.0, 200.0, "the sway of a turn is followed well with so many")
    least_samples_a_turn: float = tunable(6.0, "", 2.0, 200.0, "fewer lose turns")
    quiet_acc_mps2: float = tunable(0.15, "m/s²", 0.01, 2.0, "as a rest of the calibration")
    quiet_gyr_dps: float = tunable(1.5, "°/s", 0.1, 20.0, "as a rest of the calibration")
    bias_green_dps: float = tunable(3.0, "°/s", 0.1, 50.0, "small gyros stay below (data sheets: ±1 to 3)")
    bias_yellow_dps: float = tunable(10.0, "°/s", 0.1, 50.0, "the calibration takes no more for an offset")
    gravity_green_pct: float = tunable(2.0, "%", 0.1, 20.0, "the calibration's own tolerance")
    gravity_yellow_pct: float = tunable(5.0, "%", 0.1, 50.0, "further off is a wrong unit or a broken axis")
    speed_green: float = tunable(1.5, "", 1.0, 10.0, "a ball overtakes the water's mean speed and bounces")
    speed_yellow: float = tunable(1.1, "", 1.0, 10.0, "with less to spare the gyro is at its end in the run")
    quiet_sound_db: float = tunable(-90.0, "dB", -150.0, 0.0, "the noise of a live microphone is above")
    field_low_ut: float = tunable(22.0, "µT", 0.0, 200.0, "the weakest field of the Earth (World Magnetic Model)")
    field_high_ut: float = tunable(67.0, "µT", 0.0, 200.0, "the strongest")
    knocks: int = tunable(5, "", 3, 20, "three are not enough (acoustics §6)")
    knock_jitter_ms: float = tunable(12.0, "ms", 1.0, 200.0, "what both felt lies closer together than this")
    irregular: float = tunable(0.2, "", 0.0, 2.0, "intervals that differ less could be shifted by one knock unnoticed")
    space_green: float = tunable(1.5, "", 1.0, 10.0, "runs last longer than planned")
    battery_green_pct: float = tunable(50.0, "%", 0.0, 100.0, "enough for half a day with the screen on")
    battery_yellow_pct: float = tunable(20.0, "%", 0.0, 100.0, "below, laptops save power and may sleep")


def _item(key: str, light: Light, verdict: str, **params: float | str) -> CheckItem:
    return CheckItem(key, light, verdict, params)


def sound_item(status: SoundStatus, seconds: float, live: BoolArray, settings: CheckSettings) -> CheckItem:
    """Judge whether sound arrives: ``status`` counts what came in ``seconds``, ``live`` (channels,) what changes."""
    if status.frames == 0:
        return _item("sound", Light.RED, "sound_none")
    if status.is_digital_silence:
        return _item("sound", Light.RED, "sound_zeros")
    if not live.all():
        dead = ", ".join(str(number) for number, is_live in enumerate(live, 1) if not is_live)
        return _item("sound", Light.RED, "sound_channel_dead", channels=dead)
    share = status.lost_frames / max(status.frames + status.lost_frames, 1)
    params = {"rate_hz": status.sample_rate_hz, "lost_pct": 100 * share}
    rate = status.frames / seconds if seconds > 0 else 0.0
    if status.sample_rate_hz and abs(rate / status.sample_rate_hz - 1) > 0.05:
        return _item("sound", Light.YELLOW, "sound_rate", **params, measured_hz=rate)
    if share > settings.lost_yellow:
        return _item("sound", Light.RED, "sound_lost", **params)
    return _item("sound", Light.YELLOW if share > settings.lost_green else Light.GREEN, "sound_arrives", **params)


def level_item(rms_db: float, peak_db: float, *, clipped: bool, settings: CheckSettings) -> CheckItem:
    """Judge the level of the quiet seconds, dB below full scale."""
    params = {"rms_db": rms_db, "peak_db": peak_db}
    if clipped:
        return _item("level", Light.RED, "level_clipped", **params)
    if rms_db < settings.quiet_sound_db:
        return _item("level", Light.YELLOW, "level_low", **params)
    return _item("level", Light.GREEN, "level_good", **params)


def motion_item(rate_hz: float, samples: int, lost: int, settings: CheckSettings) -> CheckItem:
    """Judge whether the IMU's samples arrive."""
    if samples == 0:
        return _item("motion", Light.RED, "motion_none")
    share = lost / max(samples + lost, 1)
    params = {"rate_hz": rate_hz, "lost_pct": 100 * share}
    if share > settings.lost_yellow:
        return _item("motion", Light.RED, "motion_lost", **params)
    return _item("motion", Light.YELLOW if share > settings.lost_green else Light.GREEN, "motion_arrives", **params)


def axes_item(acc_s_mps2: FloatArray, gyr_s_radps: FloatArray) -> CheckItem:
    """Judge whether each axis of (n, 3) and (n, 3) lives: one that never changes by a digit is dead."""
    names = ("acc x", "acc y", "acc z", "gyro x", "gyro y", "gyro z")
    both = np.hstack([acc_s_mps2, gyr_s_radps])
    if len(both) < 2:
        return _item("axes", Light.OPEN, "not_checked")
    dead = [name for name, swing in zip(names, np.ptp(both, axis=0), strict=True) if not swing > 0]
    if dead:
        return _item("axes", Light.RED, "axes_dead", axes=", ".join(dead))
    return _item("axes", Light.GREEN, "axes_live")


def rest_items(acc_s_mps2: FloatArray, gyr_s_radps: FloatArray, settings: CheckSettings) -> tuple[CheckItem, ...]:
    """Judge the rest (n, 3): whether it was one, the gyro's offset, and whether gravity is what it should be."""
    if len(acc_s_mps2) < 2:
        return (_item("rest", Light.OPEN, "not_checked"), _item("gravity", Light.OPEN, "not_checked"))
    sway = math.degrees(float(np.std(gyr_s_radps, axis=0).max()))
    shake = float(np.std(acc_s_mps2, axis=0).max())
    bias = math.degrees(float(np.linalg.norm(np.mean(gyr_s_radps, axis=0))))
    params = {"bias_dps": bias, "sway_dps": sway, "shake_mps2": shake}
    if sway > settings.quiet_gyr_dps or shake > settings.quiet_acc_mps2:
        rest = _item("rest", Light.RED, "rest_moved", **params)
    elif bias > settings.bias_yellow_dps:
        rest = _item("rest", Light.RED, "rest_bias", **params)
    else:
        rest = _item("rest", Light.YELLOW if bias > settings.bias_green_dps else Light.GREEN, "rest_good", **params)
    size = float(np.linalg.norm(np.mean(acc_s_mps2, axis=0)))
    off = 100 * (size / GRAVITY_MPS2 - 1)
    light = Light.GREEN if abs(off) <= settings.gravity_green_pct else Light.YELLOW
    light = Light.RED if abs(off) > settings.gravity_yellow_pct else light
    verdict = "gravity_good" if light is Light.GREEN else "gravity_off"
    return rest, _item("gravity", light, verdict, size_mps2=size, off_pct=off)


def saturation_speed_mps(range_dps: float, radius_m: float) -> float:
    """Return the speed at which a ball of ``radius_m`` that rolls without slip turns at the gyro's full scale."""
    return math.radians(range_dps) * radius_m


def range_item(
    motion: Motion, radius_m: float | None, speed_mps: float | None, range_dps: float, settings: CheckSettings
) -> CheckItem:
    """Judge whether the gyro's range is enough for the ball and the expected speed (findings §6)."""
    if motion is not Motion.ROLLING:
        return _item("range", Light.GREEN, "range_not_rolling", range_dps=range_dps)
    if radius_m is None:
        return _item("range", Light.YELLOW, "range_no_radius", range_dps=range_dps)
    limit = saturation_speed_mps(range_dps, radius_m)
    params = {"range_dps": range_dps, "limit_mps": limit}
    if speed_mps is None:
        return _item("range", Light.YELLOW, "range_no_speed", **params)
    spare = limit / speed_mps
    params["speed_mps"] = speed_mps
    if spare < settings.speed_yellow:
        return _item("range", Light.RED, "range_short", **params)
    light = Light.GREEN if spare >= settings.speed_green else Light.YELLOW
    return _item("range", light, "range_enough" if light is Light.GREEN else "range_tight", **params)


def rate_item(
    motion: Motion, radius_m: float | None, speed_mps: float | None, rate_hz: float, settings: CheckSettings
) -> CheckItem:
    """Judge whether the IMU samples a turn of the ball often enough."""
    if motion is not Motion.ROLLING or radius_m is None or speed_mps is None or speed_mps <= 0:
        enough = rate_hz >= 50.0
        return _item("rate", Light.GREEN if enough else Light.YELLOW, "rate_plain", rate_hz=rate_hz)
    a_turn = rate_hz * 2 * math.pi * radius_m / speed_mps
    params = {"rate_hz": rate_hz, "a_turn": a_turn}
    if a_turn < settings.least_samples_a_turn:
        return _item("rate", Light.RED, "rate_low", **params)
    return _item("rate", Light.GREEN if a_turn >= settings.samples_a_turn else Light.YELLOW, "rate_turn", **params)


def field_item(mag_s_ut: FloatArray | None, settings: CheckSettings) -> CheckItem:
    """Judge the magnetic field (n, 3) at rest; in the pipe it may not be used anyway, so it is never red."""
    if mag_s_ut is None or not len(mag_s_ut):
        return _item("field", Light.OPEN, "field_none")
    size = float(np.linalg.norm(np.nanmean(mag_s_ut, axis=0)))
    if not math.isfinite(size) or size == 0.0:
        return _item("field", Light.YELLOW, "field_dead")
    good = settings.field_low_ut <= size <= settings.field_high_ut
    return _item("field", Light.GREEN if good else Light.YELLOW, "field_good" if good else "field_off", size_ut=size)


def space_item(disc: DiscStatus, planned_s: float, settings: CheckSettings) -> CheckItem:
    """Judge whether the disc takes the planned duration."""
    if disc.seconds_left is None:
        return _item("space", Light.OPEN, "not_checked")
    params = {"left_h": disc.seconds_left / 3600, "planned_h": planned_s / 3600}
    if disc.seconds_left < planned_s:
        return _item("space", Light.RED, "space_short", **params)
    light = Light.GREEN if disc.seconds_left >= settings.space_green * planned_s else Light.YELLOW
    return _item("space", light, "space_good", **params)


def battery_item(percent: float | None, *, plugged: bool, settings: CheckSettings) -> CheckItem:
    """Judge the laptop's battery; None where it has none."""
    if percent is None:
        return _item("battery", Light.GREEN, "battery_none")
    if plugged:
        return _item("battery", Light.GREEN, "battery_plugged", percent=percent)
    light = Light.GREEN if percent >= settings.battery_green_pct else Light.YELLOW
    light = Light.RED if percent < settings.battery_yellow_pct else light
    return _item("battery", light, "battery_left", percent=percent)


def knocks_item(knocks: Knocks, settings: CheckSettings, *, has_sound: bool, has_motion: bool) -> CheckItem:
    """Judge the knocks that shall align the clocks: enough of them in both, irregular, at one distance."""
    count = len(knocks.paired_s)
    params = {
        "heard": len(knocks.heard_s), "felt": len(knocks.felt_s), "both": count,
        "jitter_ms": 1000 * knocks.jitter_s if count else 0.0,
    }  # fmt: skip
    if not (has_sound and has_motion):
        return _item("knocks", Light.OPEN, "knocks_one_stream")
    if count < settings.knocks:
        return _item("knocks", Light.RED if count < 2 else Light.YELLOW, "knocks_few", **params)
    if knocks.irregularity < settings.irregular:
        return _item("knocks", Light.YELLOW, "knocks_regular", **params)
    return _item("knocks", Light.GREEN, "knocks_good", **params)
