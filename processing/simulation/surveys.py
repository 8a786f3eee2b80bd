"""Rolling surveys of mains: a small one for tests, a long one for benchmarks, any number of random realistic ones."""

from dataclasses import replace

import numpy as np

from processing.simulation.scenario import (
    Ball,
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
    Pump,
    Scenario,
    Sound,
    Stop,
    Timed,
    Vector,
)
from processing.survey import LeakClass, Motion


def small_rolling() -> Scenario:
    """Return two minutes in 60 m with one bend, one leak and tie points at both ends: quick, for tests."""
    return Scenario(
        name="rolling",
        route=PipeRoute(((0.0, 0.0, 0.0), (0.0, 38.0, 0.0), (22.0, 38.0, 0.4)), bend_radius_m=0.9),
        drive=Drive(speed_mps=0.6),
        ball=Ball(slip=0.01, slip_sigma=0.01, spin_sigma_radps=0.2),
        sound=Sound(rate_hz=16000, local=(Local(LeakClass.LEAK, 24.0, 1.4, 1500.0, 1.8, 10.0, "leak"),)),
        markers=(Marker("valve chamber", 38.0, 0.2), Marker("retrieval", sigma_m=0.2)),
        paperwork=Paperwork(title="Small rolling run (simulated)", diameter_m=0.3),
    )


def noise_free(motion: Motion) -> Scenario:
    """Return some 200 m without any error, slip, blow or sound: what dead reckoning must bring back to millimetres.

    The ball does not bank, so that the contact normal is the vertical that the odometer assumes.
    """
    stops = (20.0, 55.0, 100.0, 150.0) if motion is Motion.CARRIED else (70.0,)
    return Scenario(
        name=f"noise-free-{motion}",
        motion=motion,
        route=PipeRoute(
            ((0.0, 0.0, 0.0), (40.0, 0.0, 0.0), (40.0, 50.0, 0.0), (90.0, 70.0, 0.0), (60.0, 110.0, 0.0)), 1.0
        ),
        drive=Drive(speed_mps=0.8, stops=tuple(Stop(s, 3.0) for s in stops)),
        ball=Ball(spin_sigma_radps=0.3, bank=False),
        imu=replace(Imu.perfect(200.0), magnetics=Magnetics(enabled=True, declination_deg=0.0, noise_ut=0.0)),
        sound=Sound(enabled=False, joints=Joints(spacing_m=0.0), knocks=Knocks(at_start=False, at_end=False)),
        paperwork=Paperwork(title=f"Noise-free {motion} run (simulated)"),
    )


def long_main() -> Scenario:
    """Return an hour at 44.1 kHz and 200 Hz in some two kilometres, for benchmarks."""
    corners: list[Vector] = [(0.0, 0.0, 0.0)]
    heading = 0.4
    for k, leg in enumerate((310.0, 180.0, 260.0, 420.0, 150.0, 330.0, 290.0, 210.0)):
        east, north, up = corners[-1]
        corners.append(
            (east + leg * float(np.cos(heading)), north + leg * float(np.sin(heading)), up + (-1) ** k * 1.5)
        )
        heading += (0.8, -1.2, 0.5, -0.4, 1.1, -0.9, 0.6, 0.0)[k]
    leaks = tuple(
        Local(LeakClass.LEAK, chainage, width, centre, 1.8, snr, f"leak {i + 1}")
        for i, (chainage, width, centre, snr) in enumerate(
            [
                (203.0, 1.2, 1500.0, 10.0),
                (640.0, 2.5, 1000.0, 6.0),
                (1011.0, 0.9, 1900.0, 2.0),
                (1588.0, 1.8, 1300.0, 8.0),
            ]
        )
    )
    return Scenario(
        name="long-main",
        route=PipeRoute(tuple(corners), bend_radius_m=1.5),
        drive=Drive(speed_mps=0.62, variation=0.12, variation_period_s=20.0,
                    stops=(Stop(700.0, 30.0), Stop(1500.0, 60.0))),
        ball=Ball(slip=0.012, slip_sigma=0.015, spin_sigma_radps=0.25),
        sound=Sound(
            local=(*leaks, Local(LeakClass.VALVE, 900.0, 1.2, 180.0, 1.8, 9.0, "gate valve")),
            timed=tuple(Timed(LeakClass.TRAFFIC, t) for t in (420.0, 1300.0, 1330.0, 2600.0)),
            pumps=(Pump(level_dbfs=-56.0),),
        ),
        markers=(Marker("chamber 1", 310.0, 0.4), Marker("chamber 2", 752.0, 0.4), Marker("chamber 3", 1320.0, 0.4),
                 Marker("chamber 4", 1805.0, 0.4), Marker("retrieval", sigma_m=0.4)),
        paperwork=Paperwork(title="Long main (simulated)", diameter_m=0.4, tell_length=True),
    )  # fmt: skip


def random_scenario(seed: int) -> Scenario:
    """Return a rolling survey drawn from what mains are like: route, speed, ball, sensor, leaks, false sources, clocks.

    For Monte Carlo use; simulate it with the same or any other seed. The sensor's errors are drawn by the simulation.
    """
    rng = np.random.default_rng([seed, 77])
    route, length = _random_route(rng)
    speed = float(rng.uniform(0.3, 0.95))
    ferrous = bool(rng.random() < 0.6)
    radius = float(rng.uniform(0.035, 0.08))
    markers = [
        Marker(f"marker {i + 1}", float(length * (i + 1) / 5 * rng.uniform(0.9, 1.1)), float(rng.uniform(0.2, 1.0)))
        for i in range(int(rng.integers(0, 5)))
    ]
    return Scenario(
        name=f"random-{seed}",
        route=route,
        drive=Drive(speed, float(rng.uniform(0.03, 0.2)), 15.0, float(rng.uniform(2.0, 6.0)),
                    stops=_stops(rng, length)),
        ball=Ball(radius, tuple(rng.normal(0, 0.004, 3).tolist()), float(rng.normal(0, 0.01)),
                  float(rng.uniform(0.002, 0.03)), float(rng.uniform(5, 20)), float(rng.uniform(0, 0.5)),
                  told_radius_m=round(radius * float(rng.normal(1, 0.003)), 5)),
        imu=Imu(rate_hz=float(rng.choice([100.0, 200.0, 400.0])), magnetics=Magnetics(
            enabled=True, pipe_sigma_ut=float(rng.uniform(8, 30)) if ferrous else 0.5)),
        sound=_random_sound(rng, length, length / speed),
        clock=Clock(float(rng.uniform(-15, 15)), float(rng.normal(0, 30))),
        markers=(*markers, Marker("retrieval", sigma_m=float(rng.uniform(0.2, 1.0)))),
        paperwork=Paperwork(title=f"Random survey {seed} (simulated)", material="ductile iron" if ferrous else "PVC",
                            diameter_m=float(rng.choice([0.2, 0.3, 0.4, 0.6])),
                            tell_length=bool(rng.random() < 0.5), tell_route=bool(rng.random() < 0.5)),
    )  # fmt: skip


def _random_route(rng: np.random.Generator) -> tuple[PipeRoute, float]:
    legs = rng.uniform(25.0, 140.0, int(rng.integers(3, 9)))
    headings = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.choice([-1, 1], len(legs)) * rng.uniform(0.15, 1.5, len(legs)))
    slopes = rng.normal(0, 0.02, len(legs))
    steps = np.column_stack([legs * np.cos(headings), legs * np.sin(headings), legs * slopes])
    corners = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    points = tuple((float(e), float(n), float(u)) for e, n, u in corners)
    return PipeRoute(points, bend_radius_m=float(rng.uniform(0.6, 3.0))), float(np.sum(legs))


def _stops(rng: np.random.Generator, length: float) -> tuple[Stop, ...]:
    places = rng.uniform(5, length - 5, int(rng.integers(0, 4)))
    return tuple(Stop(float(s), float(rng.uniform(4, 12))) for s in places)


def _random_sound(rng: np.random.Generator, length: float, seconds: float) -> Sound:
    def anywhere() -> float:
        return float(rng.uniform(8, length - 8))

    leaks = [
        Local(LeakClass.LEAK, anywhere(), float(rng.uniform(0.8, 4.0)), float(1300 * 1.4 ** rng.normal()),
              float(rng.uniform(1.2, 2.3)), float(rng.choice([10.0, 6.0, 2.0, -2.0, -6.0])), f"leak {i + 1}",
              turning=float(rng.choice([0.0, 0.4])))
        for i in range(int(rng.integers(0, 6)))
    ]  # fmt: skip
    valves = [
        Local(LeakClass.VALVE, anywhere(), 1.2, float(rng.uniform(90, 250)), 1.8, float(rng.uniform(3, 10)),
              f"valve {i + 1}")
        for i in range(int(rng.integers(0, 4)))
    ]  # fmt: skip
    air = [
        Local(LeakClass.AIR, anywhere(), float(rng.uniform(0.8, 2.0)), 900.0, 2.4, float(rng.uniform(2, 9)), "air", 0.8)
        for _ in range(int(rng.integers(0, 2)))
    ]
    traffic = tuple(Timed(LeakClass.TRAFFIC, float(rng.uniform(0, seconds)), float(rng.uniform(5, 20)),
                          snr_db=float(rng.uniform(3, 12))) for _ in range(int(rng.integers(0, 6))))  # fmt: skip
    pumps = (Pump(float(rng.uniform(24, 60)), level_dbfs=float(rng.uniform(-62, -50))),) if rng.random() < 0.5 else ()
    return Sound(
        flow_dbfs=float(rng.uniform(-50, -42)), rolling_dbfs=float(rng.uniform(-48, -40)),
        bend_snr_db=float(rng.uniform(0, 8)), joints=Joints(float(rng.choice([0.0, 5.5, 6.0]))),
        knocks=Knocks(stray_per_minute=float(rng.uniform(0, 3))), local=(*leaks, *valves, *air), timed=traffic,
        pumps=pumps,
    )  # fmt: skip
