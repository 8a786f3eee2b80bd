"""What the widening factor makes of simulated digs: ``python tests/benchmarks/dig_widening.py [histories]``.

For intervals that are too narrow by a known scale: the factor's median, and how often the widened interval holds the
next leak (closed form), by the number of digs.
"""

import sys

import numpy as np
from scipy import stats

from processing.dig_statistics import NORMAL_95, Errors, widening

TAPE_M = 0.2


def main(histories: int) -> None:
    """Print a line for each scale and number of digs."""
    rng = np.random.default_rng(1)
    print("true scale  digs  median factor  share widened  coverage  (unwidened)")
    for scale in (0.5, 1.0, 1.2, 1.5, 2.0, 3.0):
        for count in (2, 5, 10, 20, 40, 80):
            factors = []
            for _ in range(histories):
                sigma, tape = rng.uniform(0.3, 1.5, count), np.full(count, TAPE_M)
                error = rng.normal(0.0, np.hypot(scale * sigma, tape))
                held = np.abs(error) <= NORMAL_95 * np.hypot(sigma, tape)
                factors.append(widening(Errors(error, sigma, tape, held)).factor)
            coverage = np.mean(2.0 * stats.norm.cdf(NORMAL_95 * np.array(factors) / scale) - 1.0)
            plain = 2.0 * stats.norm.cdf(NORMAL_95 / scale) - 1.0
            share = np.mean(np.array(factors) > 1.0)
            print(f"{scale:10} {count:5} {np.median(factors):14.2f} {share:14.2f} {coverage:9.3f} {plain:12.3f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 300)
