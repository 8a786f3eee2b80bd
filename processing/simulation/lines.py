"""Tones locked to the turning of the ball: what a seam, a dent or a texture of its shell sounds like.

Line k of order o is ``√2·a·cos(o·φ + ψ)`` with φ the rolled angle; strength a and phase ψ wander over metres of pipe,
so a line is coherent with the turning over that length and no longer. Each line has its own random stream: a run
without lines, or with fewer, is the same sound otherwise.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.simulation.scenario import RollingLine, Scenario
from processing.simulation.sources import Heard
from processing.simulation.wander import Wander, gauss_markov

_STREAM = 6  # of the sound's random streams
_EVERY = 32  # samples between two looks at what wanders over metres
_HIGHEST = 0.45  # of the sample rate


@dataclass(frozen=True)
class LinesPlan:
    """The lines with how each one's strength (dB) and phase (rad) wander along the chainage."""

    lines: tuple[RollingLine, ...] = ()
    fades_db: tuple[Wander, ...] = ()
    phases_rad: tuple[Wander, ...] = ()
    starts_rad: tuple[float, ...] = ()
    nominal_mps: float = 1.0


def lines_of(scenario: Scenario, span_m: tuple[float, float], seed: int) -> LinesPlan:
    """Return the scenario's rolling lines; the same seed gives the same lines."""
    sound = scenario.sound
    rngs = [np.random.default_rng([seed, _STREAM, k]) for k in range(len(sound.rolling_lines))]
    starts = tuple(float(rng.uniform(0, 2 * np.pi)) for rng in rngs)
    fades = tuple(gauss_markov(span_m, sound.lines_fade_db, sound.lines_stable_m, rng) for rng in rngs)
    phases = tuple(gauss_markov(span_m, sound.lines_wander_rad, sound.lines_stable_m, rng) for rng in rngs)
    return LinesPlan(sound.rolling_lines, fades, phases, starts, scenario.drive.speed_mps)


def line_sound(plan: LinesPlan, heard: Heard, rate_hz: float) -> npt.NDArray[np.float32]:
    """Return the sum of all lines (m,) at consecutive samples; a line above 0.45 of the sample rate is silent."""
    count = len(heard.time_s)
    coarse = np.unique(np.append(np.arange(0, count, _EVERY), count - 1))
    fine = np.arange(count)
    chainage, speed = heard.chainage_m[coarse], heard.speed_mps[coarse]
    loud = (np.maximum(speed, 0.0) / plan.nominal_mps) ** 1.5  # amplitude: power with the cube of the speed
    turning = np.abs(np.gradient(heard.rotation_rad)) * rate_hz if count > 1 else np.zeros(count)
    out = np.zeros(count)
    for line, fade, phase, start in zip(plan.lines, plan.fades_db, plan.phases_rad, plan.starts_rad):
        size = loud * 10 ** ((line.level_dbfs + fade(chainage)) / 20) * np.sqrt(2)
        below = line.order * turning < 2 * np.pi * _HIGHEST * rate_hz
        angle = line.order * heard.rotation_rad + start + np.interp(fine, coarse, phase(chainage))
        out += np.where(below, np.interp(fine, coarse, size), 0.0) * np.cos(angle)
    return out.astype(np.float32)
