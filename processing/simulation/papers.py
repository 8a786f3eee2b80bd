"""The published experiments as scenarios: P0's three carried runs with a leak each, and P1's fourteen rolling loops.

P0: A. E. Akkaya, M. F. Talu 2017, table 1. P1: E. Yazan, M. F. Talu 2022, table 1; only the shape's name and its length
are published, so corners, speed and radius are ours, in the published spirit.
"""

from collections.abc import Callable, Mapping

from processing.simulation.scenario import (
    Ball,
    Carried,
    Clock,
    Drive,
    Imu,
    Joints,
    Knocks,
    Local,
    Magnetics,
    Marker,
    Paperwork,
    PipeRoute,
    Scenario,
    Sound,
    Stop,
    Vector,
)
from processing.survey import LeakClass, Motion

Plan = tuple[tuple[float, float], ...]

# MPU-9150 class, 100 Hz, held in the hand indoors; north is the paper's own, so no declination
_P0_IMU = Imu(
    rate_hz=100.0, gyro_noise=1.0e-4, gyro_bias_sigma_radps=2e-3, gyro_scale_sigma=1e-3, acc_noise=1.5e-3,
    acc_bias_sigma_mps2=0.02, acc_scale_sigma=1e-3, gyro_range_radps=8.73, acc_range_mps2=39.2, pressure=False,
    magnetics=Magnetics(enabled=True, declination_deg=0.0, noise_ut=0.4),
)  # fmt: skip


def _p0(name: str, title: str, route: PipeRoute, leak_m: float, closed: bool = False) -> Scenario:
    length = route.length_m or 0.0
    # some four metres at a time, held still in between: zero velocity is the paper's anchor
    stops = tuple(Stop(s, 2.5) for s in _spaced(length, 4.2) if abs(s - leak_m) > 1.0)
    leak = Local(LeakClass.LEAK, leak_m, 0.9, 1800.0, 2.2, 16.0, "crack")
    ends = (Marker("start = end", None, 0.05, "coordinates"),) if closed else ()
    return Scenario(
        name=name,
        motion=Motion.CARRIED,
        route=route,
        drive=Drive(speed_mps=0.7, variation=0.08, variation_period_s=3.0, ramp_s=1.2, rest_start_s=16.0,
                    rest_end_s=14.0, stops=stops),
        carried=Carried(bob_m=0.004, sway_m=0.006, wobble_deg=1.5),
        imu=_P0_IMU,
        sound=Sound(
            flow_dbfs=-44.0, rolling_dbfs=-90.0, bends_rumble=False, joints=Joints(spacing_m=0.0), knocks=Knocks(),
            local=(leak,),
        ),
        clock=Clock(start_s=-0.8, drift_ppm=18.0),
        markers=ends,
        paperwork=Paperwork(title=title, material="none (carried above ground)", tell_length=True),
    )  # fmt: skip


def _spaced(length_m: float, about_m: float) -> list[float]:
    count = max(round(length_m / about_m), 1)
    return [length_m * k / count for k in range(1, count)]


def p0_straight() -> Scenario:
    """P0 scenario 1: 23.45 m straight to the north-east, leak at 13.400 m."""
    route = PipeRoute(((0.0, 0.0, 0.0), (20.0, 20.0, 0.0)), length_m=23.45)
    return _p0("p0-straight", "P0 scenario 1 (simulated)", route, 13.400)


def p0_closed() -> Scenario:
    """P0 scenario 2: a closed way of 45.77 m, leak at 25.230 m; the operator declares that it is closed."""
    corners = ((0.0, 0.0, 0.0), (7.0, 0.0, 0.0), (7.0, 9.0, 0.0), (-7.0, 9.0, 0.0), (-7.0, 0.0, 0.0))
    route = PipeRoute(corners, bend_radius_m=0.6, length_m=45.77, closed=True)
    return _p0("p0-closed", "P0 scenario 2 (simulated)", route, 25.230, closed=True)


def p0_50m() -> Scenario:
    """P0 scenario 3: 50 m with corners, leak at 35.165 m."""
    corners = ((0.0, 0.0, 0.0), (18.0, 0.0, 0.0), (18.0, 16.0, 0.0), (34.0, 16.0, 0.0))
    route = PipeRoute(corners, bend_radius_m=0.6, length_m=50.0)
    return _p0("p0-50m", "P0 scenario 3 (simulated)", route, 35.165)


# outlines, each beginning in the middle of a straight side so that the closed way starts and ends smoothly
_RECTANGLE: Plan = ((3.0, 0.0), (6.0, 0.0), (6.0, 3.0), (0.0, 3.0), (0.0, 0.0))
_SQUARE: Plan = ((2.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0), (0.0, 0.0))
_TRIANGLE: Plan = ((1.5, 0.0), (3.0, 0.0), (1.5, 2.6), (0.0, 0.0))
_TRIANGLES: Plan = ((0.0, 0.0), (4.0, 3.0), (4.0, -3.0), (-4.0, 3.0), (-4.0, -3.0))  # a bow tie
_L: Plan = ((2.0, 0.0), (4.0, 0.0), (4.0, 1.5), (1.5, 1.5), (1.5, 6.0), (0.0, 6.0), (0.0, 0.0))
_T: Plan = ((2.0, 0.0), (2.7, 0.0), (2.7, 4.0), (4.5, 4.0), (4.5, 5.5), (0.0, 5.5), (0.0, 4.0), (1.3, 4.0), (1.3, 0.0))
_U: Plan = ((2.5, 0.0), (5.0, 0.0), (5.0, 6.0), (3.5, 6.0), (3.5, 1.5), (1.5, 1.5), (1.5, 6.0), (0.0, 6.0), (0.0, 0.0))
_H: Plan = (
    (0.75, 0.0), (1.5, 0.0), (1.5, 2.5), (3.5, 2.5), (3.5, 0.0), (5.0, 0.0), (5.0, 6.0), (3.5, 6.0), (3.5, 4.0),
    (1.5, 4.0), (1.5, 6.0), (0.0, 6.0), (0.0, 0.0),
)  # fmt: skip
_F: Plan = (
    (0.75, 0.0), (1.5, 0.0), (1.5, 2.5), (3.0, 2.5), (3.0, 3.7), (1.5, 3.7), (1.5, 4.8), (4.0, 4.8), (4.0, 6.0),
    (0.0, 6.0), (0.0, 0.0),
)  # fmt: skip
_E: Plan = (
    (2.0, 0.0), (4.0, 0.0), (4.0, 1.2), (1.3, 1.2), (1.3, 2.4), (3.2, 2.4), (3.2, 3.6), (1.3, 3.6), (1.3, 4.8),
    (4.0, 4.8), (4.0, 6.0), (0.0, 6.0), (0.0, 0.0),
)  # fmt: skip
_A: Plan = (
    (0.6, 0.0), (1.2, 0.0), (1.7, 1.6), (3.3, 1.6), (3.8, 0.0), (5.0, 0.0), (3.1, 6.0), (1.9, 6.0), (0.0, 0.0),
)  # fmt: skip

#: number → shape, its outline, total distance in metres (P1, table 1)
P1_LOOPS: Mapping[int, tuple[str, Plan, float]] = {
    1: ("rectangle", _RECTANGLE, 72.0),
    2: ("rectangle", _RECTANGLE, 93.0),
    3: ("L", _L, 50.4),
    4: ("triangle", _TRIANGLE, 20.28),
    5: ("E", _E, 45.6),
    6: ("T", _T, 15.6),
    7: ("T", _T, 36.0),
    8: ("triangles", _TRIANGLES, 56.4),
    9: ("U", _U, 58.8),
    10: ("F", _F, 40.8),
    11: ("A", _A, 46.8),
    12: ("T", _T, 36.0),
    13: ("H", _H, 55.2),
    14: ("square", _SQUARE, 48.0),
}

# Xsens MTw2 class at 100 Hz; its own quaternion is in the log, as in the paper
_P1_IMU = Imu(
    rate_hz=100.0, gyro_noise=1.75e-4, gyro_bias_sigma_radps=3.5e-3, gyro_walk=5e-6, gyro_scale_sigma=2e-3,
    gyro_misalignment_sigma_rad=1e-3, acc_noise=2e-3, acc_bias_sigma_mps2=0.03, acc_scale_sigma=3e-3,
    pressure=False, device_quaternion=True, magnetics=Magnetics(enabled=True, pipe_sigma_ut=3.0, noise_ut=0.2),
)  # fmt: skip


def p1_loop(number: int) -> Scenario:
    """P1's loop ``number`` (1..14): a ball of 10 cm rolled round a closed figure on the floor, without sound."""
    shape, plan, length = P1_LOOPS[number]
    points: tuple[Vector, ...] = tuple((x, y, 0.0) for x, y in plan)
    return Scenario(
        name=f"p1-{number:02d}",
        route=PipeRoute(points, bend_radius_m=0.35, length_m=length, closed=True),
        # loops 7 and 12 are the same figure: other speeds make them other runs
        drive=Drive(speed_mps=0.44 + 0.01 * number, variation=0.12, variation_period_s=5.0, ramp_s=2.0,
                    rest_start_s=8.0, rest_end_s=5.0),
        ball=Ball(radius_m=0.10, lever_arm_s_m=(0.01, 0.005, -0.008), slip=0.0, slip_sigma=0.01, slip_tau_s=8.0,
                  spin_sigma_radps=0.15, bank=False),
        imu=_P1_IMU,
        sound=Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False)),
        paperwork=Paperwork(title=f"P1 loop {number}, {shape} of {length:g} m (simulated)", material="floor"),
    )  # fmt: skip


def p1_maker(number: int) -> Callable[[], Scenario]:
    """Return a function that makes loop ``number``: a row of the table of scenarios."""
    return lambda: p1_loop(number)
