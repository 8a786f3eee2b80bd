"""From a scenario and a seed to a run: truth, what the sensors say, the sound to be, and what the technician knows."""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.progress import Progress, silent
from processing.simulation.carried import Carrying, carry
from processing.simulation.drive import DrivePlan
from processing.simulation.events import Blow, blows, felt_w_mps2, time_at_chainage
from processing.simulation.imu_errors import measured
from processing.simulation.lines import lines_of
from processing.simulation.motion import TrueMotion
from processing.simulation.paperwork import survey_of
from processing.simulation.rolling import INNER_RATE_HZ, roll, rolling_of
from processing.simulation.route import SmoothRoute, centre_line
from processing.simulation.scenario import Scenario
from processing.simulation.sound import SoundPlan, frequencies, sound_length
from processing.simulation.sources import background_shape, peak_power, sources_of
from processing.simulation.walking import Walking, dragged_w_mps2, walk
from processing.survey import ClockMap, ImuSamples, LeakClass, Motion, Survey

_QUICK_RATE_HZ = 100.0


@dataclass(frozen=True)
class PlacedTruth:
    """A local sound as it was: ``power_dbfs`` at closest approach, ``time_s`` when the device was there."""

    name: str
    kind: LeakClass
    chainage_m: float
    time_s: float
    position_w_m: tuple[float, float, float]
    half_width_m: float
    snr_db: float
    power_dbfs: float


@dataclass(frozen=True)
class SimulatedRun:
    """A run with its truth. ``imu`` is the log before faults; ``sound`` makes the audio in blocks (None: no sound)."""

    scenario: Scenario
    seed: int
    route: SmoothRoute
    motion: TrueMotion
    imu: ImuSamples
    blows: tuple[Blow, ...]
    places: tuple[PlacedTruth, ...]
    sound: SoundPlan | None
    clock: ClockMap
    survey: Survey

    @property
    def leaks(self) -> tuple[PlacedTruth, ...]:
        """The places that are leaks."""
        return tuple(p for p in self.places if p.kind is LeakClass.LEAK)


def simulate(
    scenario: Scenario, seed: int = 0, progress: Progress | None = None, *, quick: bool = False
) -> SimulatedRun:
    """Return one run of ``scenario``; the same seed gives the same run, sample for sample.

    ``quick`` is for thousands of runs whose sound nobody hears: without it, and with the ball's turning integrated at
    100 Hz, which is the same within 1e-6 rad.
    Each part draws from its own stream, so that, say, a leak added to the sound leaves path and sensors as they were.
    Memory: about 350 bytes an IMU sample; the sound is not made here.
    """
    progress = progress or silent()
    progress.update(0.0, "simulate_motion")
    streams = [np.random.default_rng([seed, 100 + k]) for k in range(8)]
    of_drive, of_motion, of_blows, of_imu, of_felt, of_sound, of_papers, of_more = streams
    route = centre_line(scenario.route)
    plan = DrivePlan(scenario.drive, route.length_m, of_drive)
    walking = Walking(scenario.foot, scenario.drive, route, of_motion) if scenario.motion is Motion.FOOT else None
    inner_hz = _QUICK_RATE_HZ if quick else INNER_RATE_HZ
    motion = _move(scenario, route, plan, walking, of_motion, inner_hz, progress.part(0.0, 0.8))
    all_blows = blows(scenario, motion, of_blows, walking.shocks() if walking is not None else ())
    progress.update(0.8, "simulate_sensors")
    felt = felt_w_mps2(all_blows, motion.time_s, of_felt)
    if walking is not None:
        felt += dragged_w_mps2(walking, motion.time_s, of_felt)
    joints = np.array([b.chainage_m for b in all_blows if b.kind == "joint"])
    imu = measured(scenario.imu, motion, felt, of_imu, of_more, (scenario.sound.joints, joints))
    heard = scenario.sound.enabled and not quick
    sound = _sound(scenario, route, motion, all_blows, of_sound, seed) if heard else None
    clock = ClockMap(scenario.clock.start_s, scenario.clock.drift_ppm, 0.0, "given")
    survey = survey_of(scenario, route, motion, of_papers)
    progress.update(1.0)
    return SimulatedRun(
        scenario, seed, route, motion, imu, all_blows, _places(scenario, motion, route), sound, clock, survey
    )


def _move(
    scenario: Scenario,
    route: SmoothRoute,
    plan: DrivePlan,
    walking: Walking | None,
    rng: np.random.Generator,
    inner_hz: float,
    progress: Progress,
) -> TrueMotion:
    imu = scenario.imu
    if walking is not None:
        return walk(walking, imu.rate_hz, imu.gyro_sampling, qt.normalise(rng.normal(size=4)))
    if scenario.motion is Motion.ROLLING:
        start = qt.normalise(rng.normal(size=4))  # a ball lies as it fell
        rolling = rolling_of(scenario.ball, route, plan, rng)
        return roll(rolling, imu.rate_hz, imu.gyro_sampling, start, progress, inner_hz)
    carrying = Carrying(scenario.carried, route, plan, rng.uniform(0, 2 * np.pi, 6))
    return carry(carrying, imu.rate_hz, imu.gyro_sampling)


def _sound(
    scenario: Scenario, route: SmoothRoute, motion: TrueMotion, all_blows: tuple[Blow, ...],
    rng: np.random.Generator, seed: int,
) -> SoundPlan:  # fmt: skip
    rate = scenario.sound.rate_hz
    frames, clock = sound_length(scenario, float(motion.time_s[-1]))
    span = (min(clock.start_s, 0.0), float(motion.time_s[-1]) + 2.0)
    sources = sources_of(scenario, route, span, frequencies(rate), rng)
    lines = lines_of(scenario, (0.0, max(route.length_m, 1.0)), seed)
    return SoundPlan(rate, frames, clock, motion, sources, all_blows, scenario.sound.pumps, seed, lines)


def _places(scenario: Scenario, motion: TrueMotion, route: SmoothRoute) -> tuple[PlacedTruth, ...]:
    bins = frequencies(scenario.sound.rate_hz)
    background = background_shape(scenario, bins)
    chainages = np.array([x.chainage_m for x in scenario.sound.local])
    positions = route.points(chainages).position_w_m if len(chainages) else np.empty((0, 3))
    return tuple(
        PlacedTruth(
            name=x.name or f"{x.kind} {i + 1}",
            kind=x.kind,
            chainage_m=x.chainage_m,
            time_s=time_at_chainage(motion, x.chainage_m),
            position_w_m=(float(p[0]), float(p[1]), float(p[2])),
            half_width_m=x.half_width_m,
            snr_db=x.snr_db,
            power_dbfs=float(10 * np.log10(peak_power(x, background, bins))),
        )
        for i, (x, p) in enumerate(zip(scenario.sound.local, positions))
    )
