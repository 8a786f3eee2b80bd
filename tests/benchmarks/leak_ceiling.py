"""The ceiling: a leak detector that is told everything but the place, by Neyman and Pearson's likelihood ratio.

The sound is Gaussian noise of known sources, so its power in frame t (64 ms) and band b follows a gamma law of mean
μ_tb, the sum of the sources' true powers, with ν_b = bandwidth · frame length degrees of freedom (pairs). For a leak of
known spectrum, strength, width, shape and turning, put at place s, with mean λ_tb(s) of its own,

    L(s) = Σ ν_b [ (P_tb/μ_tb) · r/(1 + r) − ln(1 + r) ],   r = λ_tb(s)/μ_tb,

is the logarithm of the likelihood ratio of "it lies at s" against "it lies nowhere": no test of equal false alarms
finds more. The detector is told the path, the clock, the turning, all other sources and leaks at every moment, knows
pump tones and blows exactly (they are left out, the latter with the frames in which they ring), and looks at 90 Hz to
16 kHz in sixth octaves. A leak's own score is the highest L within the tolerance of its place; false alarms are the
peaks of L, 5 m apart, over the whole pipe where that leak is absent: the best of all the run's leaks at each place.

``levels unknown`` is told less: each band's level around a place (±24 m) is anything like
a + b·d + c·d² + e·ln(speed) beside what the turning does. That part is projected out of the relative rise r, and

    z(s) = Σ ν_b (P_tb/μ_tb − 1) r⊥_tb / √(Σ ν_b r⊥_tb²)

is the best linear test that no such level can fool (of unit variance where nothing is).

Both are bounds: a detector that must also learn spectra, widths and turning from the same sound has to be worse, and
so has one that does not know where valves and air pockets lie. What they do not use is phase: sounds of independent
sources carry nothing there.
"""

import sys

import numpy as np
from leak_figures import TOLERANCE_M, TOLERANCE_WIDTHS, Outcome, Row
from leak_runs import SETTINGS

from processing.simulation.run import simulate
from processing.simulation.sound import frequencies
from processing.simulation.sources import Heard
from processing.survey import LeakClass

FRAME_S, RING_S = 0.064, 0.12
STEP_M, FINE_M, APART_M = 0.5, 0.05, 5.0
REACH_WIDTHS, REACH_M, AROUND_M = 8.0, 6.0, 24.0
EDGES_HZ = 90.0 * 2.0 ** (np.arange(46) / 6.0)


class Truth:
    """Frames of one run with all that its sources do; ``power`` is one draw of what is heard."""

    def __init__(self, setting, seed):
        run = simulate(SETTINGS[setting](seed), seed)
        plan, motion = run.sound, run.motion
        time_s = np.arange(motion.time_s[0] + FRAME_S, motion.time_s[-1], FRAME_S)
        for blow in run.blows:
            time_s = time_s[(time_s < blow.time_s - FRAME_S) | (time_s > blow.time_s + RING_S + FRAME_S)]
        chainage, speed, turn = (
            np.interp(time_s, motion.time_s, x) for x in (motion.chainage_m, motion.speed_mps, motion.rotation_rad)
        )
        self.heard = Heard(time_s, chainage, speed, turn)
        hz = frequencies(plan.rate_hz)
        band = np.searchsorted(EDGES_HZ, hz, side="right") - 1
        inside = (band >= 0) & (band < len(EDGES_HZ) - 1)
        self.shapes = np.array([np.bincount(band[inside], s.shape[inside], len(EDGES_HZ) - 1) for s in plan.sources])
        bins = np.bincount(band[inside], minlength=len(EDGES_HZ) - 1)
        self.pairs = np.maximum(bins * (hz[1] - hz[0]) * FRAME_S, 1.0)
        self.sources, self.length_m = plan.sources, run.route.length_m
        powers = np.stack([s.power(self.heard) for s in plan.sources], axis=1)
        self.mean = powers @ self.shapes
        rng = np.random.default_rng([seed, 94])
        self.power = self.mean * rng.gamma(self.pairs, 1.0, self.mean.shape) / self.pairs
        first = 3  # flow, rolling, hiss come before the local ones
        self.leaks = [(first + k, x) for k, x in enumerate(run.scenario.sound.local) if x.kind is LeakClass.LEAK]

    def ratios(self, source, local, places, mean):
        """Return L at ``places`` for the leak ``local`` against ``mean`` (t, b)."""
        chainage = self.heard.chainage_m
        reach = max(REACH_WIDTHS * local.half_width_m * np.sqrt(local.skew), REACH_M)
        relative, shape = self.power / mean, self.shapes[source] / mean
        out = np.zeros(len(places))
        for k, place in enumerate(places):
            rows = slice(*np.searchsorted(chainage, [place - reach, place + reach]))
            if rows.stop <= rows.start:
                continue
            moved = Heard(
                self.heard.time_s[rows], chainage[rows] - place + local.chainage_m,
                self.heard.speed_mps[rows], self.heard.rotation_rad[rows],
            )  # fmt: skip
            r = self.sources[source].power(moved)[:, None] * shape[rows]
            out[k] = np.sum((relative[rows] * r / (1 + r) - np.log1p(r)) @ self.pairs)
        return out

    def without_levels(self, source, local, places, mean):
        """Return z at ``places`` for the leak ``local``, whatever the bands' levels do."""
        chainage, relative = self.heard.chainage_m, self.power / mean - 1
        shape, log_speed = self.shapes[source] / mean, np.log(np.maximum(self.heard.speed_mps, 0.05))
        out = np.zeros(len(places))
        for k, place in enumerate(places):
            rows = slice(*np.searchsorted(chainage, [place - AROUND_M, place + AROUND_M]))
            if rows.stop - rows.start < 16:
                continue
            away = (chainage[rows] - place) / AROUND_M
            free = np.column_stack([np.ones(len(away)), away, away**2, log_speed[rows]])
            basis = np.linalg.svd(free, full_matrices=False)[0]
            moved = Heard(
                self.heard.time_s[rows], chainage[rows] - place + local.chainage_m,
                self.heard.speed_mps[rows], self.heard.rotation_rad[rows],
            )  # fmt: skip
            rise = self.sources[source].power(moved)[:, None] * shape[rows]
            rise -= basis @ (basis.T @ rise)
            strength = float(np.sum(np.square(rise) @ self.pairs))
            out[k] = np.sum((relative[rows] * rise) @ self.pairs) / np.sqrt(max(strength, 1e-30))
        return out


def told_the_truth(setting, seeds, levels_known=True):
    """Return the outcome of the detector that is told the truth; its scores are logarithms of ratios, or z."""
    test = Truth.ratios if levels_known else Truth.without_levels
    rows, levels, lengths = [], [], []
    for index, seed in enumerate(seeds):
        truth = Truth(setting, seed)
        everywhere = np.arange(0.5 * STEP_M, truth.length_m, STEP_M)
        absent = np.full(len(everywhere), -np.inf)
        for number, (source, local) in enumerate(truth.leaks):
            own = np.outer(truth.sources[source].power(truth.heard), truth.shapes[source])
            rows.append(_hit(test, truth, index, number, source, local, truth.mean - own))
            np.maximum(absent, test(truth, source, local, everywhere, truth.mean), out=absent)
        rows += [Row(index, float(score), -1) for score in _peaks(everywhere, absent)]
        levels.append(tuple(local.snr_db for _, local in truth.leaks))
        lengths.append(truth.length_m)
        print(f"  ceiling {setting} {seed}", file=sys.stderr, flush=True)
    return Outcome(tuple(rows), tuple(levels), tuple(lengths))


def _hit(test, truth, index, number, source, local, others):
    tolerance = max(TOLERANCE_M, TOLERANCE_WIDTHS * local.half_width_m)
    near = local.chainage_m + np.arange(-tolerance, tolerance, 0.25)
    best = near[np.argmax(test(truth, source, local, near, others))]
    near = best + np.arange(-0.25, 0.25 + FINE_M / 2, FINE_M)
    score = test(truth, source, local, near, others)
    error = float(near[np.argmax(score)] - local.chainage_m)
    return Row(index, float(score.max()), number, error, error)


def _peaks(places, score):
    """Return the highest values above zero, 5 m apart."""
    score, found = score.copy(), []
    while (best := int(np.argmax(score))) >= 0 and score[best] > 0:
        found.append(score[best])
        score[np.abs(places - places[best]) < APART_M] = -np.inf
    return found
