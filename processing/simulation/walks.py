"""Walks with a sensor on the foot: squares, circles and stairs that end where they began, and random ones.

For zero-velocity detectors. ``random_walk(seed)`` draws shape, laps, gaits (slow, brisk, running, stairs, crawling),
strides, mounting and sensor; the same way is walked, with other strides, by other seeds given to the simulation.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from processing.simulation.scenario import (
    Drive,
    Foot,
    Gait,
    Imu,
    Joints,
    Knocks,
    Paperwork,
    PipeRoute,
    Scenario,
    Sound,
    Stop,
    Vector,
)
from processing.survey import Motion

GAITS: Mapping[str, Gait] = {
    "walk": Gait(),
    "slow": Gait(stride_m=0.95, stride_s=1.45, heel_share=0.10, flat_share=0.40, toe_share=0.18, clearance_m=0.04,
                 heel_pitch_deg=14.0, toe_pitch_deg=42.0, creep_deg=1.5, shock_mps2=20.0),
    "brisk": Gait(stride_m=1.6, stride_s=0.95, heel_share=0.08, flat_share=0.30, toe_share=0.19, clearance_m=0.08,
                  heel_pitch_deg=26.0, toe_pitch_deg=65.0, shock_mps2=65.0),
    "run": Gait(stride_m=2.1, stride_s=0.72, heel_share=0.07, flat_share=0.15, toe_share=0.16, clearance_m=0.18,
                heel_pitch_deg=15.0, toe_pitch_deg=75.0, creep_deg=3.0, shock_mps2=110.0),
    "stairs": Gait(stride_m=0.58, stride_s=1.25, heel_share=0.06, flat_share=0.40, toe_share=0.16, clearance_m=0.12,
                   heel_pitch_deg=3.0, toe_pitch_deg=40.0, shock_mps2=30.0),
    "crawl": Gait(stride_m=0.55, stride_s=1.5, heel_share=0.02, flat_share=0.48, toe_share=0.06, clearance_m=0.015,
                  heel_pitch_deg=0.0, toe_pitch_deg=8.0, base_pitch_deg=55.0, creep_deg=1.0, shock_mps2=12.0,
                  drag_mps2=2.5),
}  # fmt: skip

_SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))
_RESTS = Drive(rest_start_s=8.0, rest_end_s=6.0)
# a MEMS unit for feet at 200 Hz: 16 g, 2000 °/s
_IMU = Imu(gyro_scale_sigma=3e-3, acc_scale_sigma=3e-3, pressure=False)


def _scenario(name: str, title: str, route: PipeRoute, foot: Foot, drive: Drive = _RESTS, imu: Imu = _IMU) -> Scenario:
    return Scenario(
        name=name, motion=Motion.FOOT, route=route, drive=drive, foot=foot, imu=imu, sound=_SILENT,
        paperwork=Paperwork(title=f"{title} (simulated)", material="none (walked above ground)"),
    )  # fmt: skip


def _laps(once: list[Vector], laps: int) -> tuple[Vector, ...]:
    """Return a closed way gone round ``laps`` times: it starts and ends at the first point."""
    return (*once * laps, once[0])


def square_route(side_m: float, laps: int) -> PipeRoute:
    """Return squares that begin in the middle of a side."""
    half = 0.5 * side_m
    corners = [(0.0, 0.0, 0.0), (half, 0.0, 0.0), (half, side_m, 0.0), (-half, side_m, 0.0), (-half, 0.0, 0.0)]
    return PipeRoute(_laps(corners, laps), bend_radius_m=0.35)


def circle_route(radius_m: float, laps: int) -> PipeRoute:
    """Return circles as many-sided figures with round corners, of the circle's own curvature on the average."""
    sides = 24
    angles = 2 * np.pi * (np.arange(sides) + 0.5) / sides
    size = radius_m / float(np.cos(np.pi / sides))
    points = [(size * float(np.sin(a)), radius_m - size * float(np.cos(a)), 0.0) for a in angles]
    return PipeRoute(_laps([(0.0, 0.0, 0.0), *points], laps), bend_radius_m=radius_m)


def stairs_route(steps: int, laps: int) -> PipeRoute:
    """Return ``steps`` double steps up, a turn on the landing, and the same down beside it, back to the start."""
    run, rise = 0.58 * steps, 0.34 * steps
    once = [(0.0, 0.0, 0.0), (2.0, 0.0, 0.0), (2.0 + run, 0.0, rise), (4.0 + run, 0.0, rise), (4.0 + run, 1.6, rise),
            (2.0 + run, 1.6, rise), (2.0, 1.6, 0.0), (0.0, 1.6, 0.0), (-1.5, 1.6, 0.0), (-1.5, 0.0, 0.0)]  # fmt: skip
    return PipeRoute(_laps(once, laps), bend_radius_m=0.3)


def foot_square() -> Scenario:
    """Three rounds of a 10 m square at a walk."""
    return _scenario("foot-square", "Square of 10 m, three rounds", square_route(10.0, 3), Foot())


def foot_circle() -> Scenario:
    """Three rounds of a circle of 5 m radius at a walk."""
    return _scenario("foot-circle", "Circle of 5 m radius, three rounds", circle_route(5.0, 3), Foot())


def foot_stairs() -> Scenario:
    """Twice up and down a flight of 16 steps."""
    return _scenario("foot-stairs", "Stairs, twice up and down", stairs_route(8, 2), Foot((GAITS["stairs"],)))


def random_walk(seed: int) -> Scenario:
    """Return a walk drawn from what walks are like: shape, gaits that change on the way, foot, rests and sensor."""
    rng = np.random.default_rng([seed, 79])
    shape = str(rng.choice(["square", "circle", "stairs", "there and back", "crooked"], p=[0.2, 0.2, 0.2, 0.2, 0.2]))
    route, length = _random_route(shape, rng)
    kinds = ["stairs"] if shape == "stairs" else ["walk", "slow", "brisk", "run", "crawl"]
    chance = None if shape == "stairs" else [0.35, 0.15, 0.2, 0.2, 0.1]
    gaits, at = [], 0.0
    while at < length:
        gaits.append(_varied(GAITS[str(rng.choice(kinds, p=chance))], at, rng))
        at += float(rng.uniform(15.0, 60.0))
    places = rng.uniform(3.0, max(length - 3.0, 4.0), int(rng.integers(0, 4)))
    drive = replace(_RESTS, rest_start_s=float(rng.uniform(3, 12)), rest_end_s=float(rng.uniform(3, 10)),
                    stops=tuple(Stop(float(s), float(rng.uniform(0.5, 6.0))) for s in places))  # fmt: skip
    height, ahead = rng.uniform(0.04, 0.11), rng.uniform(0.0, 0.19)  # heel to instep
    across = rng.normal(0, 0.01)
    foot = Foot(
        gaits=tuple(gaits),
        variation=float(rng.uniform(0.015, 0.06)),
        aside_m=float(rng.choice([-1, 1]) * rng.uniform(0.05, 0.14)),
        toe_out_deg=float(rng.uniform(0, 15)),
        sway_deg=float(rng.uniform(0.15, 0.9)),
        from_heel_m=(float(ahead), float(across), float(height)),
        from_toe_m=(float(ahead - rng.uniform(0.19, 0.24)), float(across), float(height)),
    )
    imu = replace(_IMU, rate_hz=float(rng.choice([100.0, 200.0, 200.0, 400.0])),
                  gyro_noise=float(rng.uniform(0.7e-4, 4e-4)), acc_noise=float(rng.uniform(0.8e-3, 4e-3)),
                  acc_range_mps2=float(rng.choice([78.5, 157.0, 157.0])))  # fmt: skip
    return _scenario(f"walk-{seed}", f"Random walk {seed}, {shape}", route, foot, drive, imu)


def _varied(gait: Gait, from_m: float, rng: np.random.Generator) -> Gait:
    """A person's own way of this gait: longer strides come a little faster, blows and angles differ by a third."""
    pace, clock = float(np.exp(0.10 * rng.normal())), float(np.exp(0.08 * rng.normal()))
    hard, steep, high = np.exp(rng.normal(size=3) * [0.35, 0.15, 0.25])
    flat = float(np.clip(gait.flat_share * np.exp(0.10 * rng.normal()), 0.06, 0.5))
    return replace(
        gait, from_m=from_m, stride_m=gait.stride_m * pace if gait is not GAITS["stairs"] else gait.stride_m,
        stride_s=gait.stride_s * clock, flat_share=flat, clearance_m=gait.clearance_m * float(high),
        heel_pitch_deg=gait.heel_pitch_deg * float(steep), toe_pitch_deg=min(gait.toe_pitch_deg * float(steep), 85.0),
        creep_deg=gait.creep_deg * float(high), shock_mps2=gait.shock_mps2 * float(hard),
    )  # fmt: skip


def _random_route(shape: str, rng: np.random.Generator) -> tuple[PipeRoute, float]:
    laps = int(rng.integers(1, 5))
    if shape == "square":
        side = float(rng.uniform(4, 15))
        return square_route(side, laps), 4 * side * laps
    if shape == "circle":
        radius = float(rng.uniform(2, 8))
        return circle_route(radius, laps), 2 * np.pi * radius * laps
    if shape == "stairs":
        steps = int(rng.integers(4, 14))
        return stairs_route(steps, laps), (12.0 + 1.2 * steps) * laps
    if shape == "there and back":
        way = float(rng.uniform(8, 40))
        once: list[Vector] = [(0.0, 0.0, 0.0), (way, 0.0, 0.0), (way, 0.8, 0.0), (0.0, 0.8, 0.0), (-0.8, 0.8, 0.0),
                              (-0.8, 0.0, 0.0)]  # fmt: skip
        return PipeRoute(_laps(once, laps), bend_radius_m=0.25), 2 * (way + 1.6) * laps
    legs = rng.uniform(3.0, 20.0, int(rng.integers(3, 12)))
    headings = np.cumsum(rng.uniform(-2.0, 2.0, len(legs)))
    steps_m = np.column_stack([legs * np.cos(headings), legs * np.sin(headings), rng.normal(0, 0.03, len(legs)) * legs])
    corners = np.vstack([np.zeros(3), np.cumsum(steps_m, axis=0)])
    points = tuple((float(e), float(n), float(u)) for e, n, u in corners)
    return PipeRoute(points, bend_radius_m=float(rng.uniform(0.2, 2.0))), float(np.sum(legs))
