"""Chainage, speed and acceleration at any time, in closed form: rests, smooth ramps, a slowly varying cruise, stops.

Speed is three times differentiable everywhere, so that sampled sensors and simple integrations see no corner in it.
"""

from dataclasses import dataclass

import numpy as np

from processing.simulation.scenario import Drive
from processing.simulation.smooth import step, step_d1, step_d2, step_integral
from processing.survey import FloatArray


@dataclass(frozen=True)
class Going:
    """``chainage_m``, ``speed_mps``, ``acc_mps2`` (n,), and how far the device is under way: ``going`` 0..1 with its
    first and second derivative in time, for what happens only while it moves."""

    chainage_m: FloatArray
    speed_mps: FloatArray
    acc_mps2: FloatArray
    going: FloatArray
    going_d1: FloatArray
    going_d2: FloatArray


@dataclass(frozen=True)
class _Phase:
    """A span of one kind: ``kind`` −1 slows down, 0 cruises (or rests, at speed 0), 1 speeds up."""

    start_s: float
    duration_s: float
    chainage_m: float
    speed_mps: float
    kind: int
    cycles: FloatArray
    shares: FloatArray

    def going(self, t: FloatArray) -> Going:
        u = np.clip((t - self.start_s) / max(self.duration_s, 1e-12), 0.0, 1.0)
        return self._cruise(u) if self.kind == 0 else self._ramp(u)

    def _ramp(self, u: FloatArray) -> Going:
        T, v = self.duration_s, self.speed_mps
        if self.kind > 0:
            g, d1, d2 = step(u), step_d1(u) / T, step_d2(u) / T**2
            s = v * T * step_integral(u)
        else:
            g, d1, d2 = step(1 - u), -step_d1(1 - u) / T, step_d2(1 - u) / T**2
            s = v * T * (0.5 - step_integral(1 - u))
        return Going(self.chainage_m + s, v * g, v * d1, g, d1, d2)

    def _cruise(self, u: FloatArray) -> Going:
        T, v = self.duration_s, self.speed_mps
        speed, way, acc = np.ones_like(u), u.copy(), np.zeros_like(u)
        for cycles, share in zip(self.cycles, self.shares):
            w = 2 * np.pi * cycles
            cos = np.cos(w * u)
            speed += share * np.sin(w * u)
            way += share * (1 - cos) / w
            acc += share * w * cos
        under_way = np.full_like(u, float(v > 0))
        zeros = np.zeros_like(u)
        return Going(self.chainage_m + v * T * way, v * speed, v / max(T, 1e-12) * acc, under_way, zeros, zeros)


class DrivePlan:
    """The drive over ``length_m``; ``at(t)`` evaluates it at any survey times (before and after: at rest)."""

    def __init__(self, drive: Drive, length_m: float, rng: np.random.Generator) -> None:
        """Lay out the phases; stops beyond the ends are left out."""
        self.nominal_mps = drive.speed_mps
        stops = sorted((s for s in drive.stops if 0.0 < s.chainage_m < length_m), key=lambda s: s.chainage_m)
        legs = np.diff([0.0, *(s.chainage_m for s in stops), length_m])
        rests = [drive.rest_start_s, *(s.duration_s for s in stops), drive.rest_end_s]
        self._phases: list[_Phase] = []
        self._stuck: list[tuple[float, float, float]] = []  # start, duration, rate
        clock, chainage = 0.0, 0.0
        spins = [0.0, *(s.spin_radps for s in stops), 0.0]
        for rest, leg, spin in zip(rests, [*legs, None], spins):
            self._phases.append(_still(clock, rest, chainage))
            if spin > 0.0:
                self._stuck.append((clock, rest, spin))
            clock += rest
            if leg is not None and leg > 0:
                moved = _move(drive, clock, chainage, float(leg), rng)
                self._phases += moved
                clock = moved[-1].start_s + moved[-1].duration_s
                chainage += float(leg)
        self.duration_s = clock
        self._starts = np.array([p.start_s for p in self._phases])

    def at(self, t: FloatArray) -> Going:
        """Return the going at survey times ``t`` (n,), in any order."""
        t = np.asarray(t, dtype=np.float64)
        which = np.clip(np.searchsorted(self._starts, t, side="right") - 1, 0, len(self._starts) - 1)
        out = Going(*(np.empty(len(t)) for _ in range(6)))
        for index in np.flatnonzero(np.bincount(which)):
            here = which == index
            part = self._phases[index].going(t[here])
            for name in vars(part):
                getattr(out, name)[here] = getattr(part, name)
        return out

    def turning_on_the_spot(self, t: FloatArray) -> FloatArray | None:
        """Return the rate (n,) at which a stuck ball turns at times ``t`` (n,); None where it never does."""
        if not self._stuck:
            return None
        out = np.zeros(len(t))
        for start, duration, rate in self._stuck:
            ramp = min(1.0, 0.25 * duration)
            within = np.minimum(t - start, start + duration - t) / ramp
            out += rate * step(np.clip(within, 0.0, 1.0))
        return out


def _still(start_s: float, duration_s: float, chainage_m: float) -> _Phase:
    return _Phase(start_s, duration_s, chainage_m, 0.0, 0, np.empty(0), np.empty(0))


def _move(drive: Drive, start_s: float, chainage_m: float, leg_m: float, rng: np.random.Generator) -> list[_Phase]:
    none = np.empty(0)
    ramp = drive.ramp_s
    speed = min(drive.speed_mps, leg_m / ramp)  # a short leg is driven slowly
    cruise = leg_m / speed - ramp
    up = _Phase(start_s, ramp, chainage_m, speed, 1, none, none)
    middle = _Phase(
        start_s + ramp, cruise, chainage_m + speed * ramp / 2, speed, 0, *_variation(drive, cruise, rng)
    )  # fmt: skip
    down = _Phase(start_s + ramp + cruise, ramp, chainage_m + leg_m - speed * ramp / 2, speed, -1, none, none)
    return [up, middle, down]


def _variation(drive: Drive, cruise_s: float, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Return whole numbers of cycles over the cruise and their shares, with no change of speed or slope at its ends."""
    most = int(cruise_s / drive.variation_period_s)
    if most < 2 or drive.variation == 0:
        return np.empty(0), np.empty(0)
    cycles = np.sort(rng.choice(np.arange(1, most + 1), size=min(12, most), replace=False)).astype(np.float64)
    shares = rng.normal(size=len(cycles)) / np.sqrt(cycles)
    shares -= cycles * (shares @ cycles) / (cycles @ cycles)  # Σ share·cycles = 0: no kink in speed at the ends
    shares /= np.sqrt(np.sum(shares**2) / 2)
    return cycles, shares * min(
        drive.variation, 0.7 / float(np.sum(np.abs(shares)))
    )  # never backwards, never at a stand
