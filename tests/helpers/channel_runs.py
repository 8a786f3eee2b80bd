"""Scalar channels with their truth: random walks, and a weighing as P2 describes one."""

import numpy as np


def random_walk(rows, q, r, seed):
    """Return the true walk and its readings, (rows,) each."""
    rng = np.random.default_rng(seed)
    true = np.cumsum(rng.normal(0.0, np.sqrt(q), rows))
    return true, true + rng.normal(0.0, np.sqrt(r), rows)


def weighing(seed, noise_kg=0.3, sample_rate_hz=10.0):
    """Return true weights and readings of a weighing in motion, made after P2's description, not its data.

    P2 prints readings 94 ms apart from a load cell, objects of different weight around 12, white noise added to the
    recording, and no amplitude, no sample of the noisy signal, and no definition of its "error rate". Here: five
    weights for 20 s each with changes of 1.5 s between, white noise of 2.5 % and a belt's vibration of 2 % of 12 kg.
    """
    rng = np.random.default_rng(seed)
    time_s = np.arange(int(100.0 * sample_rate_hz)) / sample_rate_hz
    knots_s = [0.0, 19.25, 20.75, 39.25, 40.75, 59.25, 60.75, 79.25, 80.75, 100.0]
    true_kg = np.interp(time_s, knots_s, np.repeat([12.0, 5.0, 20.0, 8.0, 15.0], 2))
    vibration_kg = 0.24 * np.sin(2.0 * np.pi * 3.1 * time_s + rng.uniform(0.0, 6.0))
    return true_kg, true_kg + vibration_kg + noise_kg * rng.standard_normal(len(time_s))
