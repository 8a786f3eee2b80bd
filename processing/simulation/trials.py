"""The scenarios that the navigation is measured by: P1's loops and kilometres of main, with a plain MEMS gyro.

The gyro is that of a good consumer part: 0.01 °/s/√Hz, 10 °/h bias instability, 0.2 °/s turn-on bias, scale wrong by
0.1 to 0.4 % and axes by 0.1 to 0.4°, 0.01 °/s/g, and it feels Earth turn. The ball slips by a share that wanders over
15 seconds and spins about its contact.
"""

from dataclasses import replace

import numpy as np

from processing.simulation.papers import P1_LOOPS, p1_loop
from processing.simulation.route import scaled_to_length
from processing.simulation.scenario import (
    Ball,
    Drive,
    Imu,
    Joints,
    Knocks,
    Paperwork,
    PipeRoute,
    Scenario,
    Sound,
    Vector,
)

DEGREE = float(np.pi / 180)
MEMS = Imu(
    rate_hz=100.0,
    gyro_noise=0.01 * DEGREE,
    gyro_instability_radps=10.0 / 3600.0 * DEGREE,
    gyro_bias_sigma_radps=0.2 * DEGREE,
    gyro_walk=0.0,
    gyro_scale_sigma=0.0,
    gyro_misalignment_sigma_rad=0.0,
    gyro_scale_range=(1e-3, 4e-3),
    gyro_misalignment_range_rad=(0.1 * DEGREE, 0.4 * DEGREE),
    gyro_g_sensitivity=0.01 * DEGREE / 9.81,
    latitude_deg=40.8,
    pressure=False,
)
_SLIP_TAU_S = 15.0
_SILENT = Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False))


def mems_loop(number: int, short_by_m: float = 0.0) -> Scenario:
    """Return P1's loop ``number`` (1..14) with MEMS errors and 0.6 % slip; its end is ``short_by_m`` from its start."""
    loop = p1_loop(number)
    ball = replace(loop.ball, slip=0.0, slip_sigma=0.006, slip_tau_s=_SLIP_TAU_S)
    magnetics = loop.imu.magnetics
    imu = replace(MEMS, magnetics=magnetics, device_quaternion=True)
    route = loop.route if short_by_m == 0.0 else _open_loop(number, loop.route.bend_radius_m, short_by_m)
    return replace(loop, name=f"mems-{number:02d}", ball=ball, imu=imu, route=route)


def _open_loop(number: int, bend_radius_m: float, short_by_m: float) -> PipeRoute:
    _, plan, length = P1_LOOPS[number]
    corners = np.array([(x, y, 0.0) for x, y in (*plan, plan[0])])
    points = scaled_to_length(corners, bend_radius_m, length)
    start = points[0]
    while np.linalg.norm(points[-2] - start) < short_by_m + 2 * bend_radius_m:  # a short last side falls away whole
        points = points[:-1]
    back = points[-1] - points[-2]
    # the last point on this side that is short_by_m away: |points[-2] + x back − start| = short_by_m
    a, b = float(back @ back), float(back @ (points[-2] - start))
    c = float((points[-2] - start) @ (points[-2] - start)) - short_by_m**2
    points[-1] = points[-2] + (-b - np.sqrt(b * b - a * c)) / a * back
    return PipeRoute(_as_vectors(points), bend_radius_m)


def random_main(seed: int, length_m: float = 1000.0, slip_sigma: float = 0.01) -> Scenario:
    """Return a main of ``length_m`` with bends of all sizes, gentle slopes, 0.5 m/s; its radius is told 1 % wrong.

    There are no markers in it: a benchmark lays its own.
    """
    rng = np.random.default_rng([seed, 78])
    legs = rng.uniform(25.0, 160.0, 40)
    turns = rng.choice([-1.0, 1.0], len(legs)) * rng.choice([11.25, 22.5, 30.0, 45.0, 90.0], len(legs)) * DEGREE
    headings = rng.uniform(0.0, 2 * np.pi) + np.cumsum(turns)
    slopes = rng.normal(0.0, 0.01, len(legs))
    count = int(np.searchsorted(np.cumsum(legs), length_m)) + 1
    steps = np.column_stack([legs * np.cos(headings), legs * np.sin(headings), legs * slopes])[:count]
    corners = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    bend_radius = float(rng.uniform(0.6, 3.0))
    radius = 0.0475
    return Scenario(
        name=f"main-{seed}",
        route=PipeRoute(_as_vectors(scaled_to_length(corners, bend_radius, length_m)), bend_radius),
        drive=Drive(speed_mps=0.5, variation=0.12, variation_period_s=15.0, rest_start_s=14.0, rest_end_s=14.0),
        ball=Ball(radius, tuple(rng.normal(0, 0.003, 3).tolist()), 0.0, slip_sigma, _SLIP_TAU_S, 0.2,
                  told_radius_m=radius * (1.0 + 0.01 * float(rng.choice([-1.0, 1.0])))),
        imu=MEMS,
        sound=_SILENT,
        paperwork=Paperwork(title=f"Main {seed} (simulated)", tell_route=True),
    )  # fmt: skip


def _as_vectors(points: np.ndarray) -> tuple[Vector, ...]:
    return tuple((float(e), float(n), float(u)) for e, n, u in points)
