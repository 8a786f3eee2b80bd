"""Mains with leaks and false sources drawn at random, by which leak detectors are measured: a usual and an other kind.

The usual kind follows acoustics §5.2, with stronger and weaker leaks, air pockets and stray knocks added; detectors are
tuned on it. The other kind breaks what a detector may have learnt from the first: spectra are no bells, leaks die away
exponentially and unequally, flow is not pink, the rolling noise lies elsewhere and swells three times a turn, something
scrapes now and then, the microphone turns away, the gyro's scale is 2 % off and there are no joints.

A leak's SNR is that in its own band at closest approach above flow and rolling noise at nominal speed; of the other
kind, in those 1.8 octaves in which it stands out most.
"""

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
    Paperwork,
    PipeRoute,
    Pump,
    Scenario,
    Scraping,
    Sound,
    Stop,
    Timed,
    Vector,
)
from processing.simulation.sound import frequencies
from processing.simulation.sources import background_shape, shape_of
from processing.simulation.spectra import in_band
from processing.survey import LeakClass

SNR_CLASSES_DB = (12.0, 10.0, 6.0, 2.0, -2.0, -6.0, -8.0)
LEAKS_APART_M = 12.0
_SECONDS = 960.0
_SHORTEST_M, _LONGEST_M = 420.0, 900.0
_END_M = 10.0  # no leak closer to either end
_SNR_OCTAVES = 1.8
_PINK_SHARE = 0.31  # of flow noise within 250–2500 Hz


def leaky_main(seed: int) -> Scenario:
    """Return a main of the usual kind: 420–900 m in some 16 minutes with 5–8 leaks. Simulate it with the same seed."""
    rng = np.random.default_rng([seed, 90])
    speed = _speed(rng)
    length = float(np.clip(speed * _SECONDS, _SHORTEST_M, _LONGEST_M))
    flow = float(rng.uniform(-50, -44))
    rolling = flow + 10 * float(np.log10(_PINK_SHARE)) + float(rng.uniform(0, 6))
    sound = Sound(
        flow_dbfs=flow,
        flow_drift_db=float(rng.uniform(1.5, 2.0)),
        rolling_dbfs=rolling,
        rolling_drift_db=float(rng.uniform(2.0, 3.0)),
        rolling_modulation=(float(rng.uniform(0.35, 0.7)), float(rng.uniform(0.1, 0.3))),
        bend_snr_db=float(rng.uniform(0, 8)),
        joints=Joints(float(rng.uniform(4, 6)), float(rng.uniform(0.1, 0.3)), bump_dbfs=float(rng.uniform(-24, -14))),
        knocks=Knocks(stray_per_minute=float(rng.uniform(0.5, 4))),
        local=(*_usual_leaks(rng, length), *_false_places(rng, length)),
        timed=_traffic(rng, length / speed),
        pumps=_pumps(rng, length / speed),
    )
    return _main(f"leaky-main-{seed}", rng, speed, length, sound, Imu(rate_hz=100.0, pressure=False))


def other_main(seed: int) -> Scenario:
    """Return a main of the other kind: nothing of it may be used for tuning. Simulate it with the same seed."""
    rng = np.random.default_rng([seed, 91])
    speed = _speed(rng)
    length = float(np.clip(speed * _SECONDS, _SHORTEST_M, _LONGEST_M))
    flow = float(rng.uniform(-50, -44))
    low = float(rng.uniform(120, 700))
    sound = Sound(
        flow_dbfs=flow,
        flow_drift_db=float(rng.uniform(1.0, 2.5)),
        flow_slope=float(rng.uniform(0.5, 1.8)),
        flow_corner_hz=float(rng.uniform(15, 120)),
        rolling_dbfs=flow + float(rng.uniform(-5, 3)),
        rolling_drift_db=float(rng.uniform(1.5, 3.0)),
        rolling_band_hz=(low, low * float(rng.uniform(4, 9))),
        rolling_modulation=(float(rng.uniform(0.2, 0.5)), float(rng.uniform(0.1, 0.3))),
        rolling_third=float(rng.uniform(0.15, 0.4)),
        bend_snr_db=float(rng.uniform(0, 8)),
        joints=Joints(spacing_m=0.0),
        knocks=Knocks(stray_per_minute=float(rng.uniform(0.5, 4))),
        local=(*_other_leaks(rng, length), *_false_places(rng, length)),
        timed=_traffic(rng, length / speed),
        pumps=_pumps(rng, length / speed),
        scraping=Scraping(
            float(rng.uniform(1, 6)), flow + float(rng.uniform(-8, 2)), float(rng.uniform(0.4, 1.5)), (1200.0, 4800.0)
        ),
    )
    imu = Imu(rate_hz=100.0, pressure=False, gyro_scale_sigma=0.0, gyro_scale_range=(0.015, 0.025))
    return _heard_best(_main(f"other-main-{seed}", rng, speed, length, sound, imu))


def _heard_best(scenario: Scenario) -> Scenario:
    """Return the scenario with each leak's SNR meant in those 1.8 octaves in which it stands out most.

    A spectrum that is no bell, over noise that is not pink, would else be heard 2 to 10 dB better somewhere else than
    where its SNR is stated, and the runs would be easier than they say.
    """
    hz = frequencies(scenario.sound.rate_hz)
    background = background_shape(scenario, hz)
    centres = 300.0 * 2.0 ** np.arange(0.0, 4.01, 0.2)
    bands = np.array([in_band(hz, float(centre), _SNR_OCTAVES) for centre in centres])
    local = []
    for x in scenario.sound.local:
        if x.kind is LeakClass.LEAK:
            best = int(np.argmax((bands @ shape_of(x, hz)) / (bands @ background)))
            x = replace(x, centre_hz=round(float(centres[best]), 1), octaves=_SNR_OCTAVES)
        local.append(x)
    return replace(scenario, sound=replace(scenario.sound, local=tuple(local)))


def _speed(rng: np.random.Generator) -> float:
    """Nominal speed: with its slow variation 0.25 to 1 m/s occur."""
    return float(np.exp(rng.uniform(np.log(0.35), np.log(0.85))))


def _main(name: str, rng: np.random.Generator, speed: float, length: float, sound: Sound, imu: Imu) -> Scenario:
    places = rng.uniform(_END_M, length - _END_M, int(rng.integers(0, 4)))
    stops = tuple(Stop(float(s), float(rng.uniform(4, 12))) for s in np.sort(places))
    radius = float(rng.uniform(0.04, 0.08))
    return Scenario(
        name=name,
        route=_route(rng, length),
        drive=Drive(speed, float(rng.uniform(0.1, 0.18)), 15.0, 4.0, stops=stops),
        ball=Ball(radius, tuple(rng.normal(0, 0.003, 3).tolist()), 0.0, float(rng.uniform(0.003, 0.015)), 15.0, 0.2),
        imu=imu,
        sound=sound,
        clock=Clock(float(rng.uniform(-5, 5)), float(rng.normal(0, 30))),
        paperwork=Paperwork(title=f"{name} (simulated)", diameter_m=0.3),
    )


def _route(rng: np.random.Generator, length: float) -> PipeRoute:
    """A main with four bends: as many rumbles, at places that nobody tells the detector."""
    cuts = np.sort(rng.uniform(0.05 * length, 0.95 * length, 4))
    legs = np.maximum(np.diff([0.0, *cuts, length]), 6.0)
    headings = rng.uniform(0, 2 * np.pi) + np.cumsum(rng.choice([-1, 1], len(legs)) * rng.uniform(0.3, 0.9, len(legs)))
    steps = np.column_stack([legs * np.cos(headings), legs * np.sin(headings), legs * rng.normal(0, 0.01, len(legs))])
    corners = np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
    points: tuple[Vector, ...] = tuple((float(e), float(n), float(u)) for e, n, u in corners)
    return PipeRoute(points, bend_radius_m=float(rng.uniform(0.6, 1.5)), length_m=length)


def _leak_places(rng: np.random.Generator, length: float) -> list[tuple[float, float]]:
    """Return chainage and SNR of 5–8 leaks: a draw of the classes without repetition, one twice where there are 8."""
    count = int(rng.integers(5, 9))
    levels = rng.permutation(SNR_CLASSES_DB)[: min(count, len(SNR_CLASSES_DB))].tolist()
    if count > len(SNR_CLASSES_DB):
        levels.append(float(rng.choice(SNR_CLASSES_DB)))
    # gaps of 12 m and what chance adds, so that no draw is ever thrown away
    free = length - 2 * _END_M - LEAKS_APART_M * (count - 1)
    places = _END_M + np.sort(rng.uniform(0, free, count)) + LEAKS_APART_M * np.arange(count)
    return [(float(s), float(db)) for s, db in zip(places, levels)]


def _usual_leaks(rng: np.random.Generator, length: float) -> list[Local]:
    return [
        Local(LeakClass.LEAK, place, float(rng.uniform(0.8, 4.0)), float(1300 * 1.4 ** rng.normal()),
              float(rng.uniform(1.2, 2.3)), snr, f"leak {i + 1}")
        for i, (place, snr) in enumerate(_leak_places(rng, length))
    ]  # fmt: skip


def _other_leaks(rng: np.random.Generator, length: float) -> list[Local]:
    leaks = []
    for i, (place, snr) in enumerate(_leak_places(rng, length)):
        centre = float(np.clip(1300 * 1.5 ** rng.normal(), 500, 3000))
        skew = float(rng.uniform(1.0, 2.5)) ** float(rng.choice([-1.0, 1.0]))
        leak = Local(LeakClass.LEAK, place, float(rng.uniform(0.8, 4.0)), centre, _SNR_OCTAVES, snr, f"leak {i + 1}")
        spectrum = _resonant(rng, centre) if rng.random() < 0.6 else _humped(rng, centre)
        leaks.append(
            replace(leak, turning=float(rng.uniform(0.3, 0.5)), shape="exponential", skew=skew, spectrum=spectrum)
        )
    return leaks


def _resonant(rng: np.random.Generator, centre_hz: float) -> tuple[tuple[float, float], ...]:
    """A power law that breaks at ``centre_hz``, with two to four resonances of pipe and shell on it."""
    octaves = np.arange(-4.0, 3.01, 0.125)
    rise, fall = rng.uniform(1.5, 6.0), rng.uniform(6.0, 12.0)  # dB an octave
    level = np.where(octaves < 0, rise * octaves, -fall * octaves)
    for _ in range(int(rng.integers(2, 5))):
        height, middle, width = rng.uniform(3, 9), rng.uniform(-1.5, 1.5), rng.uniform(0.08, 0.25)
        level += height * np.exp(-0.5 * ((octaves - middle) / width) ** 2)
    return _points(centre_hz * 2.0**octaves, level)


def _humped(rng: np.random.Generator, centre_hz: float) -> tuple[tuple[float, float], ...]:
    """Two humps with a dip between, as leaks in the PVC loop of ``hydrophone_pvc`` stand above its quiet pipe."""
    octaves = np.arange(-3.0, 3.01, 0.125)
    first, second = rng.uniform(-0.9, -0.3), rng.uniform(0.9, 1.5)
    low = np.exp(-0.5 * ((octaves - first) / rng.uniform(0.3, 0.5)) ** 2)
    high = 10 ** (rng.uniform(-8, 0) / 10) * np.exp(-0.5 * ((octaves - second) / rng.uniform(0.3, 0.6)) ** 2)
    return _points(centre_hz * 2.0**octaves, 10 * np.log10(low + high + 1e-4))


def _points(hz: np.ndarray, level_db: np.ndarray) -> tuple[tuple[float, float], ...]:
    return tuple((round(float(f), 2), round(float(db), 2)) for f, db in zip(hz, level_db - level_db.max()))


def _false_places(rng: np.random.Generator, length: float) -> list[Local]:
    """Return valves, low rumbles of a place, and air pockets, which gurgle."""
    valves = [
        Local(LeakClass.VALVE, float(rng.uniform(5, length - 5)), float(rng.uniform(0.8, 2.0)),
              float(rng.uniform(90, 250)), 1.8, float(rng.uniform(3, 10)), f"valve {i + 1}")
        for i in range(int(rng.integers(1, 5)))
    ]  # fmt: skip
    air = [
        Local(LeakClass.AIR, float(rng.uniform(8, length - 8)), float(rng.uniform(0.8, 2.0)),
              float(rng.uniform(700, 1200)), 2.4, float(rng.uniform(2, 9)), f"air {i + 1}",
              float(rng.uniform(0.6, 0.9)))
        for i in range(int(rng.choice([0, 1, 2], p=[0.5, 0.3, 0.2])))
    ]  # fmt: skip
    return [*valves, *air]


def _traffic(rng: np.random.Generator, seconds: float) -> tuple[Timed, ...]:
    return tuple(
        Timed(LeakClass.TRAFFIC, float(rng.uniform(20, seconds)), float(rng.uniform(5, 20)),
              float(rng.uniform(50, 120)), 1.8, float(rng.uniform(3, 12)), f"traffic {i + 1}")
        for i in range(5)
    )  # fmt: skip


def _pumps(rng: np.random.Generator, seconds: float) -> tuple[Pump, ...]:
    """A pump that starts and stops on the way, in two runs of three."""
    if rng.random() < 1 / 3:
        return ()
    start = float(rng.uniform(-0.3, 0.6)) * seconds
    return (
        Pump(float(rng.choice([49.4, 24.7, 58.0])), 15, float(rng.uniform(-62, -52)), start,
             start + float(rng.uniform(0.2, 0.8)) * seconds),
    )  # fmt: skip
