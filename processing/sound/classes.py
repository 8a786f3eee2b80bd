"""Says what a spot is taken for: a leak, or a thing that sounds like one, by the evidence gathered on it.

A naive Bayes model over the figures of :mod:`processing.sound.place_features`: each figure's distribution in each class
is a table of a few bins that anybody can read (``resources/leak_classes/model.json``), each figure counts with a
weight of 0 to 1 that makes up for figures that tell the same thing twice. The detector's probability is the prior of
*leak*; figures that are unknown say nothing. Trained on simulated mains by ``packaging/train_leak_classes.py``.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from importlib.resources import files
from typing import Any

import numpy as np

from processing.survey import FloatArray, LeakClass

__all__ = ["ClassModel", "Judgement", "checked", "judge", "load_model"]

CLASSES = tuple(LeakClass)
OTHERS = tuple(c for c in CLASSES if c is not LeakClass.LEAK)
_FADED = 0.5  # of its level that a sound may change by while the device stands at it, to belong to the place
_MOMENT_LEAK, _MOMENT_TRAFFIC = 0.05, 0.55
_LEAST_P = 1e-4
_LIKELY = 0.5
_MOST_VALUES = 4000
_SUREST = 0.95  # of the detector's probability: it tells sound from noise, and no loudness tells leaks from pumps


@dataclass(frozen=True)
class FeatureTable:
    """One figure: ``edges`` (k − 1,) ascending between k bins, ``ln_p`` (classes, k), and its ``weight``."""

    name: str
    edges: FloatArray
    ln_p: FloatArray
    weight: float
    basis: str  # trained | stated

    def ln_likelihood(self, value: float) -> FloatArray:
        """Return the weighted ln p(value | class) of each class; zeros where the value is unknown."""
        if not np.isfinite(value):
            return np.zeros(len(CLASSES))
        return np.asarray(self.weight * self.ln_p[:, int(np.searchsorted(self.edges, value, side="right"))])


@dataclass(frozen=True)
class ClassModel:
    """The tables, the ``prior`` (classes,) of what is no leak (0 for leak), and the ``record`` of the training."""

    tables: tuple[FeatureTable, ...]
    prior: FloatArray
    record: Mapping[str, Any]

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The figures that it weighs."""
        return tuple(t.name for t in self.tables)


@dataclass(frozen=True)
class Judgement:
    """What a spot is taken for, the probability of each class (sums to 1), and what each figure said for a leak.

    ``for_leak`` is ln of the likelihood ratio of a leak over everything else, per figure: positive speaks for one.
    """

    leak_class: LeakClass
    probability: Mapping[LeakClass, float]
    for_leak: Mapping[str, float]

    @property
    def score(self) -> float:
        """The probability that it is a leak."""
        return self.probability[LeakClass.LEAK]


def judge(leak_probability: float, features: Mapping[str, float], model: ClassModel) -> Judgement:
    """Return what a spot is, from the detector's ``leak_probability`` (0..1, calibrated) and its figures.

    Bayes' rule: the odds of *leak* are the detector's times the likelihood ratio of the figures; what is no leak is
    shared among the other classes by their priors and likelihoods. ``faded_share`` in ``features`` (how much of its
    level a sound lost or gained while the device stood there) above a half overrules all: it is of a moment.
    """
    said = np.array([table.ln_likelihood(features.get(table.name, float("nan"))) for table in model.tables])
    said = said.reshape(-1, len(CLASSES))
    p = float(np.clip(leak_probability, 1e-3, _SUREST))
    leak = CLASSES.index(LeakClass.LEAK)
    with np.errstate(divide="ignore"):
        ln_prior = np.log((1.0 - p) * model.prior)
    ln_prior[leak] = np.log(p)
    posterior = _normalised(ln_prior + said.sum(axis=0))
    others = _normalised(np.where(np.arange(len(CLASSES)) == leak, -np.inf, ln_prior + said.sum(axis=0)))
    for_leak = {t.name: float(row[leak] - others @ row) for t, row in zip(model.tables, said, strict=True)}
    if features.get("faded_share", 0.0) > _FADED:
        posterior = _of_a_moment(posterior)
        others = _of_a_moment(others)
    probability = {c: float(q) for c, q in zip(CLASSES, posterior, strict=True)}
    return Judgement(_named(posterior, others), probability, for_leak)


def _of_a_moment(posterior: FloatArray) -> FloatArray:
    """Return the classes where the sound faded while the device stood: nothing that a place sounds like outweighs it.

    A twentieth is left to a leak (somebody may have turned a tap), most goes to *traffic*, the rest to what passes.
    """
    passing = np.isin(CLASSES, (LeakClass.TRAFFIC, LeakClass.BUMP, LeakClass.UNKNOWN))
    left = (1.0 - _MOMENT_LEAK - _MOMENT_TRAFFIC) * _normalised(np.log(np.where(passing, posterior, 0.0) + 1e-300))
    left[CLASSES.index(LeakClass.TRAFFIC)] += _MOMENT_TRAFFIC
    left[CLASSES.index(LeakClass.LEAK)] += _MOMENT_LEAK
    return np.asarray(left, np.float64)


def _named(posterior: FloatArray, others: FloatArray) -> LeakClass:
    if posterior[CLASSES.index(LeakClass.LEAK)] >= _LIKELY:
        return LeakClass.LEAK
    likeliest = int(np.argmax(others))
    return CLASSES[likeliest] if others[likeliest] >= _LIKELY else LeakClass.UNKNOWN


def _normalised(ln_weight: FloatArray) -> FloatArray:
    weight = np.exp(ln_weight - ln_weight.max())
    return np.asarray(weight / weight.sum(), np.float64)


def load_model() -> ClassModel:
    """Return the shipped model."""
    return checked(json.loads((files("resources") / "leak_classes" / "model.json").read_text(encoding="utf-8")))


def checked(stored: Mapping[str, Any]) -> ClassModel:
    """Return the model that plain JSON values hold.

    Raises:
        ValueError: with what is wrong: bins and probabilities that do not fit together, or no probabilities at all.
    """
    tables = tuple(_table(name, entry) for name, entry in stored["features"].items())
    prior = np.array([float(stored["prior"].get(c.value, 0.0)) for c in CLASSES])
    if not np.all(np.isfinite(prior)) or np.any(prior < 0) or abs(float(prior.sum()) - 1.0) > 1e-3:
        raise ValueError("prior")
    if prior[CLASSES.index(LeakClass.LEAK)] != 0.0:
        raise ValueError("the prior of a leak is the detector's")
    return ClassModel(tables, prior / prior.sum(), stored["record"])


def _table(name: str, entry: Mapping[str, Any]) -> FeatureTable:
    edges = np.array(entry["edges"], np.float64)
    p = np.array([entry["p"][c.value] for c in CLASSES], np.float64)
    if edges.ndim != 1 or p.shape != (len(CLASSES), len(edges) + 1) or p.size > _MOST_VALUES:
        raise ValueError(f"{name}: {len(edges)} edges do not fit {p.shape}")
    if not np.all(np.isfinite(edges)) or np.any(np.diff(edges) <= 0):
        raise ValueError(f"{name}: edges must rise")
    if not np.all(np.isfinite(p)) or np.any(p < 0) or np.any(np.abs(p.sum(axis=1) - 1.0) > 0.01):
        raise ValueError(f"{name}: probabilities of a class must sum to 1")
    weight = float(entry["weight"])
    if not 0.0 <= weight <= 1.0:
        raise ValueError(f"{name}: weight")
    return FeatureTable(name, edges, np.log(np.maximum(p, _LEAST_P)), weight, str(entry["basis"]))
