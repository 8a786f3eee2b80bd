"""The path given everything: linearised about itself until it stands still, over the levels of noise that remain.

Each level of noise gives a normal distribution of paths (:mod:`processing.position.chain`); the whole is their mixture.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from processing.position.chain import Chain, Smoothed, log_likelihood, smooth
from processing.position.factors import Copies, Factors, Item, Read, readings_of, with_copies
from processing.position.keyframes import Keyframes
from processing.position.motion_model import (
    EAST,
    NORTH,
    SCALE,
    WAY,
    LevelModel,
    Levels,
    Nominal,
    Prior,
    level_model,
    next_nominal,
    start_nominal,
)
from processing.position.noise_levels import Weighed, log_prior, mean_levels, mixed_sigma, weigh
from processing.position.odometry import directions
from processing.position.tie_checks import hold_down
from processing.settings import PositionSettings
from processing.survey import FloatArray

TURNS = 20
_STILL_M = 1e-3
_NEARLY_STILL_M = 0.03  # good enough to see what disagrees
_OPEN_SCALE = 0.2  # while ties are checked against each other, the radius has no say
_USUAL, _ROUGH, _QUIET = Levels(), Levels(9.0, 4.0), Levels(1.0, 0.0144)
_LINEAR_SHARE = 0.15  # of the way: what a path may miss a place by and still be linear in its heading
_GROWING_TURNS = 4
_CHECKING_TURNS = 6
_DOUBT = np.log(100.0)  # one tie point in a hundred is wrong


@dataclass(frozen=True)
class Settled:
    """The path at the keyframes, and what it was made of."""

    nominal: Nominal
    mean: FloatArray  # (k, d) of the mixture
    cov: FloatArray  # (k, d, d) of the mixture
    along_sigma_m: FloatArray  # (k,) ±1.96 hold 95 %
    cross_sigma_m: FloatArray
    wandered_m2: FloatArray  # (k − 1,) variance of the chainage that builds up from keyframe to keyframe
    items: tuple[Item, ...]
    held: tuple[Item, ...]
    amid: Smoothed  # at the level of noise amid all
    read: Read
    levels: Levels
    turns: int


def settle(
    frames: Keyframes,
    factors: Factors,
    prior: Prior,
    shorter: FloatArray,
    settings: PositionSettings,
    tick: Callable[[float], None],
) -> Settled:
    """Return the path at the keyframes given all factors."""
    smoother = _Smoother(frames, factors.copies, prior, shorter)
    nominal = smoother.grown(factors.items)
    tick(0.3)
    nominal, held = _held_down(smoother, nominal, factors.items, settings)
    tick(0.6)
    turns = 1
    model = smoother.model(nominal)
    read = readings_of(held, factors.copies.size)
    weighed = weigh(lambda levels: log_likelihood(smoother.chain(model, levels), read.readings))
    levels = mean_levels(weighed)
    if smoother.bends(held):
        nominal, turns = smoother.around(held, nominal, levels)
        model = smoother.model(nominal)
    tick(0.8)
    amid = smooth(smoother.chain(model, levels), read.readings)
    parts = [smooth(smoother.chain(model, w.levels), read.readings) for w in weighed] if len(weighed) > 1 else [amid]
    if not smoother.bends(held):
        nominal = next_nominal(frames, nominal, shorter, model, amid.mean)
    tick(1.0)
    wandered = model.at(levels).noise[:, WAY, WAY]
    return _mixed(nominal, weighed, parts, wandered, factors.items, held, amid, read, levels, turns)


@dataclass(frozen=True)
class _Smoother:
    """The smoothing problem of one run about any nominal path."""

    frames: Keyframes
    copies: Copies
    prior: Prior
    shorter: FloatArray

    def model(self, nominal: Nominal) -> LevelModel:
        return level_model(self.frames, nominal, self.shorter, self.prior, self.copies.size)

    def chain(self, model: LevelModel, levels: Levels, *, doubting: bool = False) -> Chain:
        """Return the chain at a level of noise; ``doubting`` gives the radius no say."""
        chain = with_copies(model.at(levels), self.copies)
        if doubting:
            chain.prior_cov[SCALE, SCALE] = max(self.prior.scale, _OPEN_SCALE) ** 2
        return chain

    @staticmethod
    def bends(items: Sequence[Item]) -> bool:
        """Return whether the problem is not linear."""
        return any(item.is_place for item in items)

    def around(
        self, items: Sequence[Item], nominal: Nominal, levels: Levels, *, doubting: bool = False, most: int = TURNS
    ) -> tuple[Nominal, int]:
        """Linearise again about each new path until it stands still (Gauss–Newton); how many turns that took."""
        if not self.bends(items):
            return nominal, 1
        readings = readings_of(items, self.copies.size).readings
        nowhere = np.zeros(len(self.frames.rows), dtype=np.bool_)
        for turn in range(1, most + 1):
            model = self.model(nominal)
            mean = smooth(self.chain(model, levels, doubting=doubting), readings, nowhere).mean
            new = next_nominal(self.frames, nominal, self.shorter, model, mean)
            moved = float(np.max(np.abs(new.place_m - nominal.place_m)))
            nominal = new
            if moved < (_STILL_M if most == TURNS else _NEARLY_STILL_M):
                return nominal, turn
        return nominal, most

    def grown(self, items: Sequence[Item]) -> Nominal:
        """Return a path from which the linearisation converges: places are taken in one after the other.

        A heading that drifts by a radian before the last place is far from linear in it, but from place to place it
        is: each solution tells the next section's heading.
        """
        nominal = start_nominal(self.frames, self.shorter)
        places = [item for item in items if item.kind == "tie" and item.is_place]
        way = self.frames.odometry.chainage_m
        anchor, known = 0, 0
        while known < len(places):
            while known < len(places):
                item = places[known]
                miss = float(np.hypot(*(item.value - nominal.place_m[item.node])))
                allowed = 3.0 * np.sqrt(item.covariance_m2[0, 0]) + _LINEAR_SHARE * (way[item.node] - way[anchor])
                if miss > allowed:
                    break
                anchor, known = item.node, known + 1
            if known == len(places):
                break
            known += 1
            until = places[known - 1].node
            anchor = until
            nominal, _ = self.around([i for i in items if i.node <= until], nominal, Levels(), most=_GROWING_TURNS)
        return nominal


def _held_down(
    smoother: _Smoother, nominal: Nominal, items: tuple[Item, ...], settings: PositionSettings
) -> tuple[Nominal, tuple[Item, ...]]:
    """Hold down what all others contradict.

    A wrong tie may be a right one of a rougher run, and an innocent looking one a wrong one of a run with a quieter
    gyro: the likelihood decides, with wrong ties being rare.
    """
    usual = _held_down_at(smoother, nominal, items, settings, _USUAL)
    tried = [usual]
    if smoother.bends(items):
        tried.append(_held_down_at(smoother, nominal, items, settings, _QUIET))
    if any(hypothesis.wrong for hypothesis in tried):
        tried.append(_held_down_at(smoother, nominal, items, settings, _ROUGH))
    best = max(tried, key=lambda hypothesis: hypothesis.score)
    return best.nominal, best.held


@dataclass(frozen=True)
class _Hypothesis:
    """What is held down at one level of noise, and how well that explains everything."""

    nominal: Nominal
    held: tuple[Item, ...]
    wrong: int
    score: float


def _held_down_at(
    smoother: _Smoother, nominal: Nominal, items: tuple[Item, ...], settings: PositionSettings, levels: Levels
) -> _Hypothesis:
    nowhere = np.zeros(len(smoother.frames.rows), dtype=np.bool_)
    solutions: list[tuple[Nominal, Chain]] = []

    def solved(some: tuple[Item, ...]) -> tuple[Smoothed, Read]:
        last = solutions[-1][0] if solutions else nominal
        about, _ = smoother.around(some, last, levels, doubting=True, most=_CHECKING_TURNS)
        chain = smoother.chain(smoother.model(about), levels, doubting=True)
        solutions.append((about, chain))
        read = readings_of(some, smoother.copies.size)
        return smooth(chain, read.readings, nowhere), read

    held = hold_down(items, solved, settings)
    if not solutions:
        return _Hypothesis(nominal, held, 0, 0.0)
    current, chain = solutions[-1]
    wrong = sum(mine is not given for mine, given in zip(held, items))
    # whitened readings hide how wide each is: its width belongs into the likelihood
    wide = sum(float(np.linalg.slogdet(i.covariance_m2)[1]) for i in held if len(i.value) > 1)
    likelihood = log_likelihood(chain, readings_of(held, smoother.copies.size).readings)
    return _Hypothesis(current, held, wrong, likelihood - 0.5 * wide - wrong * _DOUBT + log_prior(levels))


def _mixed(
    nominal: Nominal,
    weighed: tuple[Weighed, ...],
    parts: list[Smoothed],
    wandered: FloatArray,
    items: tuple[Item, ...],
    held: tuple[Item, ...],
    amid: Smoothed,
    read: Read,
    levels: Levels,
    turns: int,
) -> Settled:
    weights = np.array([w.weight for w in weighed])
    means = np.stack([part.mean for part in parts])
    mean = np.einsum("j,jkd->kd", weights, means)
    off = means - mean
    cov = sum(w * part.cov for w, part in zip(weights, parts)) + np.einsum("j,jki,jkl->kil", weights, off, off)
    ahead = _ahead(nominal.place_m)
    side = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    place = slice(EAST, NORTH + 1)
    along = mixed_sigma(weights, off[:, :, WAY], _floor(np.stack([part.cov[:, WAY, WAY] for part in parts])))
    cross = mixed_sigma(
        weights,
        np.einsum("jki,ki->jk", off[:, :, place], side),
        _floor(np.stack([np.einsum("ki,kij,kj->k", side, part.cov[:, place, place], side) for part in parts])),
    )
    return Settled(nominal, mean, np.asarray(cov), along, cross, wandered, items, held, amid, read, levels, turns)


def _ahead(place_m: FloatArray) -> FloatArray:
    """Unit directions of travel at the keyframes (k, 2): those of the steps on both sides."""
    step = directions(place_m)
    both = np.vstack([step[:1], step[1:] + step[:-1], step[-1:]])
    size = np.hypot(*both.T)[:, None]
    return np.asarray(np.where(size > 1e-3, both / np.maximum(size, 1e-3), np.vstack([step, step[-1:]])))


def _floor(variance: FloatArray) -> FloatArray:
    return np.maximum(variance, 1e-6)
