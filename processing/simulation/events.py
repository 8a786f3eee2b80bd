"""Short blows that both sensors feel: joint bumps on the way, stray knocks, and taps in the rests at both ends."""

from dataclasses import dataclass

import numpy as np

from processing.simulation.motion import TrueMotion
from processing.simulation.scenario import Scenario
from processing.survey import FloatArray

TAP_RHYTHM_S = (1.0, 1.0, 3.0, 1.0, 2.0)  # irregular, so that no shift by a tap can be mistaken for the right one
_TAPS = 5
_QUIET_S = 4.0  # of rest before the first tap: the gyro's offset is learnt there


@dataclass(frozen=True)
class Blow:
    """One blow at survey time ``time_s``: ``kind`` is ``joint``, ``stray``, ``knock`` or ``step``."""

    kind: str
    time_s: float
    chainage_m: float
    acc_mps2: float
    level_dbfs: float
    width_s: float


def blows(
    scenario: Scenario, motion: TrueMotion, rng: np.random.Generator, steps: tuple[Blow, ...] = ()
) -> tuple[Blow, ...]:
    """Draw all blows of a run, in order of time, ``steps`` of a walker among them."""
    out = [*_taps(scenario, motion), *_joints(scenario, motion, rng), *_strays(scenario, motion, rng), *steps]
    return tuple(sorted(out, key=lambda blow: blow.time_s))


def _taps(scenario: Scenario, motion: TrueMotion) -> list[Blow]:
    knocks = scenario.sound.knocks
    rhythm = np.concatenate([[0.0], np.cumsum(TAP_RHYTHM_S[: _TAPS - 1])])
    end_rest = motion.time_s[-1] - scenario.drive.rest_end_s
    times = [*(_QUIET_S + rhythm)] if knocks.at_start else []
    times += [*(end_rest + _QUIET_S + rhythm)] if knocks.at_end else []
    # the first is at an odd place within a sample period, as nature has it
    return [
        Blow("knock", float(t) + 0.00137, _chainage(motion, t), knocks.knock_mps2, knocks.knock_dbfs, 0.003)
        for t in times
    ]


def _joints(scenario: Scenario, motion: TrueMotion, rng: np.random.Generator) -> list[Blow]:
    joints = scenario.sound.joints
    if joints.spacing_m <= 0:
        return []
    length = float(motion.chainage_m[-1])
    count = int(length / joints.spacing_m) + 20
    gaps = np.maximum(rng.normal(joints.spacing_m, joints.spacing_sigma_m, count), 0.2 * joints.spacing_m)
    places = np.cumsum(gaps) - gaps[0] * rng.uniform(0.2, 0.9)
    strength = np.exp(rng.normal(0.0, 0.35, count))
    out = []
    for place, strong in zip(places[places < length - 0.05], strength):
        time = time_at_chainage(motion, float(place))
        speed = float(np.interp(time, motion.time_s, motion.speed_mps)) / scenario.drive.speed_mps
        size = float(strong) * max(speed, 0.05)
        level = joints.bump_dbfs + 20 * np.log10(size)
        out.append(Blow("joint", time, float(place), joints.bump_mps2 * size, float(level), 0.005))
    return out


def _strays(scenario: Scenario, motion: TrueMotion, rng: np.random.Generator) -> list[Blow]:
    start = scenario.drive.rest_start_s
    end = float(motion.time_s[-1]) - scenario.drive.rest_end_s
    count = rng.poisson(scenario.sound.knocks.stray_per_minute * max(end - start, 0.0) / 60)
    times = rng.uniform(start, end, count)
    size = np.exp(rng.normal(-0.3, 0.5, count))
    joints = scenario.sound.joints
    return [
        Blow("stray", float(t), _chainage(motion, t), joints.bump_mps2 * float(k),
             joints.bump_dbfs + 20 * float(np.log10(k)), 0.004)
        for t, k in zip(times, size)
    ]  # fmt: skip


def _chainage(motion: TrueMotion, time_s: float) -> float:
    return float(np.interp(time_s, motion.time_s, motion.chainage_m))


def time_at_chainage(motion: TrueMotion, chainage_m: float) -> float:
    """Return when the device first was at ``chainage_m``."""
    i = int(np.searchsorted(motion.chainage_m, chainage_m))
    if i <= 0 or i >= len(motion.chainage_m):
        return float(motion.time_s[min(max(i, 0), len(motion.time_s) - 1)])
    c0, c1 = motion.chainage_m[i - 1], motion.chainage_m[i]
    share = (chainage_m - c0) / (c1 - c0) if c1 > c0 else 0.0
    return float(motion.time_s[i - 1] + share * (motion.time_s[i] - motion.time_s[i - 1]))


def felt_w_mps2(blows_: tuple[Blow, ...], time_s: FloatArray, rng: np.random.Generator) -> FloatArray:
    """Return (n, 3) world acceleration of all blows: a hop ``A τ² exp(−x²/2τ²)`` differentiated twice.

    It leaves no velocity and no displacement behind; the hop itself is a fraction of a millimetre.
    """
    out = np.zeros((len(time_s), 3))
    for blow in blows_:
        way = np.array([*rng.normal(0.0, 0.45, 2), 1.0])
        reach = 5 * blow.width_s
        middle = blow.time_s + 1.2 * blow.width_s  # the sound's onset is the contact, the force peaks a little later
        rows = slice(*np.searchsorted(time_s, [middle - reach, middle + reach]))
        x = (time_s[rows] - middle) / blow.width_s
        pulse = blow.acc_mps2 * (1 - x**2) * np.exp(-(x**2) / 2)
        out[rows] += pulse[:, None] * way / np.linalg.norm(way)
    return out
