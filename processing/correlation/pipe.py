"""The pipe between the sensors as sections, each with its speed of sound; where on it a delay puts the source."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.survey import FloatArray

WATER_BULK_PA = 2.2e9
WATER_DENSITY = 1000.0
ANCHORING = 0.91  # 1 − ν² for a pipe that cannot move lengthwise, ν = 0.3
Z95 = 1.959964


@dataclass(frozen=True)
class Material:
    """What a pipe is made of: Young's modulus, and how uncertain a speed from theory is (1 sigma, part of it).

    ``wall_part`` is the usual wall thickness as a part of the diameter, for pipes whose wall nobody knows.
    """

    modulus_pa: float
    speed_sigma: float
    wall_part: float


# moduli as makers' tables give them in the middle; tables disagree, so measure the speed on site
MATERIALS: Mapping[str, Material] = {
    "ductile_iron": Material(157e9, 0.04, 0.035),
    "cast_iron": Material(118e9, 0.05, 0.06),
    "steel": Material(208e9, 0.03, 0.025),
    "asbestos_cement": Material(23.5e9, 0.06, 0.10),
    "pvc": Material(3.0e9, 0.07, 0.045),
    "pe100": Material(0.79e9, 0.09, 0.0909),
    "pe50": Material(0.22e9, 0.12, 0.0909),
}
OTHER = "other"
SPEED_RANGE_MPS = (100.0, 1600.0)
LENGTH_RANGE_M = (0.01, 20_000.0)
MOST_SECTIONS = 20
_UNKNOWN_WALL_SIGMA = 0.04  # a pressure class up or down


def sound_speed_mps(material: str, diameter_m: float, wall_m: float | None = None) -> float:
    """Return the speed of the fluid wave: √(K/ρ)/√(1 + 0.91·(K/E)·(D/e)), Korteweg's formula.

    Raises:
        LeaklineError: CORRELATION_PIPE for a material without a modulus, or impossible sizes.
    """
    made_of = MATERIALS.get(material)
    if made_of is None:
        raise LeaklineError(ErrorCode.CORRELATION_NEEDS_SPEED, section="")
    wall = made_of.wall_part * diameter_m if wall_m is None else wall_m
    if not (diameter_m > 0.0 and 0.0 < wall < 0.5 * diameter_m):
        raise LeaklineError(ErrorCode.CORRELATION_WALL, diameter_mm=1e3 * diameter_m, wall_mm=1e3 * wall)
    stretch = ANCHORING * (WATER_BULK_PA / made_of.modulus_pa) * (diameter_m / wall)
    return math.sqrt(WATER_BULK_PA / WATER_DENSITY) / math.sqrt(1.0 + stretch)


@dataclass(frozen=True)
class PipeSection:
    """A stretch of one kind of pipe; the speed is typed or measured, or follows from material and size where None.

    ``length_sigma_m`` and ``speed_sigma_mps`` are 1 sigma; a None speed sigma is the material's own.
    """

    length_m: float
    material: str = OTHER
    diameter_m: float | None = None
    wall_m: float | None = None
    speed_mps: float | None = None
    speed_sigma_mps: float | None = None
    length_sigma_m: float = 0.0

    def speed(self) -> tuple[float, float]:
        """Return speed and its sigma in m/s.

        Raises:
            LeaklineError: CORRELATION_NEEDS_SPEED, CORRELATION_WALL.
        """
        made_of = MATERIALS.get(self.material)
        if self.speed_mps is not None:
            speed = self.speed_mps
            part = made_of.speed_sigma if made_of is not None else 0.05
        else:
            if made_of is None or self.diameter_m is None:
                raise LeaklineError(ErrorCode.CORRELATION_NEEDS_SPEED, section="")
            speed = sound_speed_mps(self.material, self.diameter_m, self.wall_m)
            part = math.hypot(made_of.speed_sigma, 0.0 if self.wall_m is not None else _UNKNOWN_WALL_SIGMA)
        return speed, part * speed if self.speed_sigma_mps is None else self.speed_sigma_mps

    @property
    def kind(self) -> tuple[object, ...]:
        """What makes the speed: sections alike in this are wrong alike."""
        return self.material, self.diameter_m, self.wall_m, self.speed_mps, self.speed_sigma_mps


@dataclass(frozen=True)
class Pipe:
    """Sections from sensor A to sensor B; ``distance_m`` is the whole as it was measured, None where it was not."""

    sections: tuple[PipeSection, ...]
    distance_m: float | None = None

    @property
    def length_m(self) -> float:
        """All sections together."""
        return sum(section.length_m for section in self.sections)

    @property
    def travel_s(self) -> float:
        """How long sound needs from A to B."""
        return sum(section.length_m / section.speed()[0] for section in self.sections)

    def checked(self) -> "Pipe":
        """Return this pipe; raises LeaklineError for what cannot be (CORRELATION_PIPE_…)."""
        if not 1 <= len(self.sections) <= MOST_SECTIONS:
            raise LeaklineError(ErrorCode.CORRELATION_SECTIONS, count=len(self.sections), most=MOST_SECTIONS)
        for number, section in enumerate(self.sections, 1):
            low, high = LENGTH_RANGE_M
            if not low <= section.length_m <= high:
                raise LeaklineError(ErrorCode.CORRELATION_LENGTH, section=number, length_m=section.length_m)
            try:
                speed = section.speed()[0]
            except LeaklineError as error:
                if error.code is ErrorCode.CORRELATION_NEEDS_SPEED:
                    raise LeaklineError(ErrorCode.CORRELATION_NEEDS_SPEED, section=number) from error
                raise
            if not SPEED_RANGE_MPS[0] <= speed <= SPEED_RANGE_MPS[1]:
                raise LeaklineError(ErrorCode.CORRELATION_SPEED, section=number, speed_mps=speed)
        if self.distance_m is not None and abs(self.distance_m - self.length_m) > self.closing_tolerance_m:
            raise LeaklineError(
                ErrorCode.CORRELATION_SUM, sum_m=self.length_m, distance_m=self.distance_m,
                off_m=abs(self.distance_m - self.length_m),
            )  # fmt: skip
        return self

    @property
    def closing_tolerance_m(self) -> float:
        """How far the sum of the sections may be from the whole: three sigma of the lengths, at least half a metre."""
        return max(0.5, 3.0 * math.sqrt(sum(section.length_sigma_m**2 for section in self.sections)))

    def scaled(self, factor: float, part_sigma: float) -> "Pipe":
        """Return the pipe with all speeds times ``factor``, each ± ``part_sigma`` of itself: as measured on site."""
        sections = []
        for section in self.sections:
            speed = section.speed()[0] * factor
            sections.append(replace(section, speed_mps=speed, speed_sigma_mps=part_sigma * speed))
        return replace(self, sections=tuple(sections))


class Where(StrEnum):
    """On which side of the sensors the source is."""

    BETWEEN = "between"
    AT_A = "at_a"  # at sensor A or anywhere beyond it: all of that gives the same delay
    AT_B = "at_b"
    IMPOSSIBLE = "impossible"  # no place on this pipe gives such a delay


@dataclass(frozen=True)
class Share:
    """One reason of the uncertainty and its part of it: ``delay``, ``clock``, ``speed``, ``length``; 1 sigma."""

    source: str
    sigma_m: float


@dataclass(frozen=True)
class Position:
    """Where the source is, metres from A along the pipe, with its 95 % interval and what that is made of."""

    from_a_m: float
    low95_m: float
    high95_m: float
    sigma_m: float
    from_b_m: float
    where: Where
    section: int  # index of the section it lies in
    shares: tuple[Share, ...]


def place_of_delay(pipe: Pipe, delay_s: float) -> float:
    """Return metres from A where a source gives this delay; outside of 0..length where none does.

    Sound from x needs T(x) to A and T(d) − T(x) to B, so ``T(x) = (T(d) − delay)/2``; for one section that is
    ``(d − c·delay)/2``.
    """
    left_s = 0.5 * (pipe.travel_s - delay_s)
    at_m = 0.0
    speed = 1.0
    for number, section in enumerate(pipe.sections):
        speed = section.speed()[0]
        need_s = section.length_m / speed
        if left_s <= need_s or number == len(pipe.sections) - 1:
            return at_m + left_s * speed
        left_s -= need_s
        at_m += section.length_m
    return at_m


def places_of_delays(pipe: Pipe, delay_s: FloatArray) -> FloatArray:
    """Return metres from A (n,) of many delays at once, as :func:`place_of_delay` has them."""
    edges_m, edges_s = [0.0], [0.0]
    for section in pipe.sections:
        edges_m.append(edges_m[-1] + section.length_m)
        edges_s.append(edges_s[-1] + section.length_m / section.speed()[0])
    to_a_s = 0.5 * (edges_s[-1] - delay_s)
    places = np.interp(to_a_s, edges_s, edges_m)
    first, last = pipe.sections[0].speed()[0], pipe.sections[-1].speed()[0]
    beyond_b = np.maximum(to_a_s - edges_s[-1], 0.0) * last
    return np.asarray(places + np.minimum(to_a_s, 0.0) * first + beyond_b)


def delay_of_place(pipe: Pipe, from_a_m: float) -> float:
    """Return how much later B hears a source ``from_a_m`` along the pipe than A: the inverse of the above."""
    to_a_s, start_m = 0.0, 0.0
    for number, section in enumerate(pipe.sections):
        inside = from_a_m - start_m
        if number < len(pipe.sections) - 1:
            inside = min(max(inside, 0.0) if number else inside, section.length_m)
        elif number:
            inside = max(inside, 0.0)
        to_a_s += inside / section.speed()[0]
        start_m += section.length_m
    return pipe.travel_s - 2.0 * to_a_s


def locate(
    pipe: Pipe, delay_s: float, delay_sigma_s: float, clock_sigma_s: float = 0.0, speeds_part_sigma: float = 0.0
) -> Position:
    """Return the place that a delay means, with its interval.

    First-order propagation (for one section ``σ² = (c·σ_t/2)² + (t·σ_c/2)² + (σ_d/2)²``); sections of one kind share
    their error of speed, and all share ``speeds_part_sigma``, a part of the speed. The ends of the interval go through
    the sections themselves.
    """
    at_m = place_of_delay(pipe, delay_s)
    number, start_m = _section_at(pipe.sections, at_m)
    speeds = [section.speed() for section in pipe.sections]
    here = speeds[number][0]
    by_kind: dict[tuple[object, ...], float] = {}
    length_variance, together = 0.0, 0.0
    for index, (section, (speed, sigma)) in enumerate(zip(pipe.sections, speeds, strict=True)):
        sign = (index < number) - (index > number)
        if index == number:
            per_speed = (2.0 * (at_m - start_m) - section.length_m) / (2.0 * here)
            per_length = 0.5
        else:
            per_speed = sign * here * section.length_m / (2.0 * speed**2)
            per_length = 1.0 - here / (2.0 * speed) if index < number else here / (2.0 * speed)
        by_kind[section.kind] = by_kind.get(section.kind, 0.0) + per_speed * sigma
        together += per_speed * speed * speeds_part_sigma
        length_variance += (per_length * section.length_sigma_m) ** 2
    shares = (
        Share("delay", 0.5 * here * delay_sigma_s),
        Share("clock", 0.5 * here * clock_sigma_s),
        Share("speed", math.sqrt(together**2 + sum(part**2 for part in by_kind.values()))),
        Share("length", math.sqrt(length_variance)),
    )
    sigma_m = math.sqrt(sum(share.sigma_m**2 for share in shares))
    reach_s = Z95 * 2.0 * sigma_m / here  # as a delay, so that the ends may lie in another section
    low, high = place_of_delay(pipe, delay_s + reach_s), place_of_delay(pipe, delay_s - reach_s)
    length = pipe.length_m
    where = _side(at_m, low, high, length)
    return Position(at_m, low, high, sigma_m, length - at_m, where, number, shares)


def _section_at(sections: Sequence[PipeSection], at_m: float) -> tuple[int, float]:
    start_m = 0.0
    for number, section in enumerate(sections[:-1]):
        if at_m < start_m + section.length_m:
            return number, start_m
        start_m += section.length_m
    return len(sections) - 1, start_m


def _side(at_m: float, low: float, high: float, length_m: float) -> Where:
    """A source beyond a sensor gives the delay of one at the sensor: whatever reaches the sensor may be beyond it."""
    slack = max(0.005 * length_m, 0.25)
    if high < -slack or low > length_m + slack:
        return Where.IMPOSSIBLE
    if low <= slack and at_m < 0.5 * length_m:
        return Where.AT_A
    if high >= length_m - slack and at_m > 0.5 * length_m:
        return Where.AT_B
    return Where.BETWEEN
