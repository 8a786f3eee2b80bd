"""The sensors' own noise from a rest: overlapping Allan deviation of gyro and accelerometer, and what its slopes mean.

IEEE Std 952-1997, annex C: with the integral ``θ`` of the readings at spacing ``τ₀`` and ``τ = m τ₀``,

    σ²(τ) = Σ (θ_{k+2m} − 2 θ_{k+m} + θ_k)² / (2 τ² (N − 2m)),

and with angle random walk ``N``, bias instability ``B``, rate random walk ``K`` and quantisation ``Q``

    σ²(τ) = 3 Q²/τ² + N²/τ + (2 ln 2/π) B² + K² τ/3.

``N`` is σ at one second on the falling branch, in units per √Hz as drawn from a two-sided spectrum: a datasheet's
one-sided density is √2 of it. The confidence interval is that of χ² with the equivalent degrees of freedom of
W. J. Riley, NIST Special Publication 1065 (2008), table 5. A rest of minutes says nothing of long averaging times:
what no branch shows is NaN and named in ``unseen``.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls
from scipy.stats import chi2

from processing.orientation.rests import Rest
from processing.survey import Finding, FloatArray, ImuSamples, Severity

TERMS = ("quantisation", "random_walk", "bias_instability", "rate_random_walk")
_MOST_ROWS = 2_000_000  # longer rests are averaged in blocks first: their long times are what matters
_LEAST_ROWS = 200
_A_DECADE = 6
_CONFIDENCE = 0.95
_LEAST_EDF = 2.0
_DOMINATES = 0.5  # of σ²: where a term's own slope shows
_FLICKER = 2.0 * np.log(2.0) / np.pi
_LONG_TAU_S = 100.0  # where the bias instability of consumer MEMS lies


@dataclass(frozen=True)
class AllanCurve:
    """Allan deviation of three axes: ``tau_s`` (k,), ``deviation`` and its 95 % interval ``low``..``high`` (k, 3).

    ``terms`` and ``terms_sigma`` (4, 3) in the order of :data:`TERMS`, NaN where no branch shows them; units of the
    readings times √s, √s, 1 and 1/√s... as the formula has them. ``model`` (k, 3) is the deviation that they make.
    """

    tau_s: FloatArray
    deviation: FloatArray
    low: FloatArray
    high: FloatArray
    terms: FloatArray
    terms_sigma: FloatArray
    model: FloatArray


@dataclass(frozen=True)
class AllanResult:
    """Gyro in rad/s and accelerometer in m/s² over the rest ``start_s``..``end_s``.

    ``unseen`` names those of :data:`TERMS` that the rest was too short to show on any axis of the gyro; ``shaken`` is
    True where the device trembled, so that the curve shows what shook it and not the sensors.
    """

    start_s: float
    end_s: float
    gyr: AllanCurve
    acc: AllanCurve
    unseen: tuple[str, ...]
    shaken: bool

    @property
    def longest_tau_s(self) -> float:
        """The longest averaging time of the curves."""
        return float(self.gyr.tau_s[-1])


def allan(imu: ImuSamples, rests: tuple[Rest, ...]) -> AllanResult | None:
    """Return the Allan deviations over the longest quiet rest (else the longest shaken one); None without any.

    Rows that are not valid and holes end a stretch: the longest whole one within the rest is taken.
    """
    for rest in sorted(rests, key=lambda r: (r.shaken, -r.duration_s)):
        rows = _whole_rows(imu, rest)
        if rows.stop - rows.start < _LEAST_ROWS:
            continue
        period = float(np.median(np.diff(imu.time_s[rows])))
        gyr, acc = (curve(np.asarray(v[rows]), period) for v in (imu.gyr_s_radps, imu.acc_s_mps2))
        unseen = tuple(n for n, values in zip(TERMS[1:], gyr.terms[1:], strict=True) if np.all(np.isnan(values)))
        start, end = float(imu.time_s[rows.start]), float(imu.time_s[rows.stop - 1])
        return AllanResult(start, end, gyr, acc, unseen, rest.shaken)
    return None


def allan_findings(result: AllanResult) -> tuple[Finding, ...]:
    """Return what must be said beside the plot: the rest was too short for the long times, or the device trembled."""
    found = []
    params = {"rest_s": result.end_s - result.start_s, "longest_s": result.longest_tau_s}
    if result.longest_tau_s < _LONG_TAU_S:
        found.append(Finding("allan_rest_short", Severity.INFO, params))
    if result.shaken:
        found.append(Finding("allan_rest_shaken", Severity.INFO, params))
    return tuple(found)


def curve(readings: FloatArray, period_s: float) -> AllanCurve:
    """Return the Allan deviation of readings (n, 3), n ≥ 9, taken every ``period_s``, and its terms."""
    block = -(-len(readings) // _MOST_ROWS)
    if block > 1:
        whole = len(readings) // block * block
        readings = readings[:whole].reshape(-1, block, 3).mean(axis=1)
    tau0 = period_s * block
    theta = np.vstack([np.zeros((1, 3)), np.cumsum(readings - readings.mean(axis=0), axis=0)]) * tau0
    steps = _steps(len(readings))
    deviation = np.array([_deviation(theta, m, tau0) for m in steps])
    tau_s = steps * tau0
    edf = _degrees_of_freedom(steps, len(theta), deviation)
    low = deviation * np.sqrt(edf / chi2.ppf(0.5 + 0.5 * _CONFIDENCE, edf))
    high = deviation * np.sqrt(edf / chi2.ppf(0.5 - 0.5 * _CONFIDENCE, edf))
    fits = [_terms(tau_s, deviation[:, k], edf[:, k]) for k in range(3)]
    terms, sigmas, models = (np.column_stack(part) for part in zip(*fits, strict=True))
    return AllanCurve(tau_s, deviation, low, high, terms, sigmas, models)


def _whole_rows(imu: ImuSamples, rest: Rest) -> slice:
    """Return the longest stretch of a rest whose rows are all valid and follow one another."""
    first, last = np.searchsorted(imu.time_s, [rest.start_s, rest.end_s])
    if last - first < 2:
        return slice(int(first), int(first))
    time_s, valid = imu.time_s[first:last], imu.valid[first:last]
    step = np.diff(time_s)
    broken = (step > 1.5 * np.median(step)) | ~valid[1:] | ~valid[:-1]
    edges = np.concatenate([[0], np.flatnonzero(broken) + 1, [len(time_s)]])
    longest = int(np.argmax(np.diff(edges)))
    return slice(int(first + edges[longest]), int(first + edges[longest + 1]))


def _steps(count: int) -> FloatArray:
    """Return the averaging lengths in samples: even steps in the logarithm, up to a third of the data."""
    most = max(count // 3, 1)
    return np.unique(np.round(np.logspace(0.0, np.log10(most), max(int(_A_DECADE * np.log10(most)), 2))))


def _deviation(theta: FloatArray, length: float, tau0: float) -> FloatArray:
    m = int(length)
    second = theta[2 * m :] - 2.0 * theta[m:-m] + theta[: -2 * m]
    return np.asarray(np.sqrt(np.mean(second**2, axis=0) / 2.0) / (m * tau0), dtype=np.float64)


def _degrees_of_freedom(steps: FloatArray, points: int, deviation: FloatArray) -> FloatArray:
    """Return the equivalent degrees of freedom (k, 3) for the noise that the local slope betrays (Riley, table 5)."""
    n, m = float(points), steps[:, None]
    white = (1.5 * (n - 1.0) / m - 2.0 * (n - 2.0) / n) * 4.0 * m**2 / (4.0 * m**2 + 5.0)
    flicker = np.where(m < 1.5, 2.0 * (n - 2.0) ** 2 / (2.3 * n - 4.9), 5.0 * n**2 / (4.0 * m * (n + 3.0 * m)))
    walk = (n - 2.0) / m * ((n - 1.0) ** 2 - 3.0 * m * (n - 1.0) + 4.0 * m**2) / (n - 3.0) ** 2
    logs = np.log(np.maximum(deviation, 1e-300))
    slope = np.gradient(logs, np.log(steps), axis=0) if len(steps) > 1 else np.full_like(deviation, -0.5)
    chosen = np.where(slope < -0.25, white, np.where(slope < 0.25, flicker, walk))
    return np.asarray(np.maximum(chosen, 1.0), dtype=np.float64)


def _terms(tau_s: FloatArray, deviation: FloatArray, edf: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return terms (4,), their sigma and the model's deviation (k,), by non-negative least squares on the variances.

    Weighted by the relative scatter √(2/edf) of each; times that follow one another closely share their data, so the
    sigma is that of as many independent times as there are octaves.
    """
    parts = np.column_stack([3.0 / tau_s**2, 1.0 / tau_s, np.full_like(tau_s, _FLICKER), tau_s / 3.0])
    variance = deviation**2
    usable = (edf >= _LEAST_EDF) & (variance > 0.0)
    nothing = np.full(len(TERMS), np.nan)
    if np.count_nonzero(usable) < 3:
        return nothing, nothing, np.full_like(tau_s, np.nan)
    weight = np.sqrt(0.5 * edf[usable]) / variance[usable]
    design = parts[usable] * weight[:, None]
    size = np.linalg.norm(design, axis=0)
    squares, _ = nnls(design / size, variance[usable] * weight)
    squares = squares / size
    model = parts @ squares
    share = parts[usable] * squares / model[usable][:, None]
    seen = (share.max(axis=0) >= _DOMINATES) & (squares > 0.0)
    terms, sigma = nothing.copy(), nothing.copy()
    terms[seen] = np.sqrt(squares[seen])
    active = squares > 0.0
    covariance = np.full(len(TERMS), np.nan)
    redundancy = _A_DECADE * np.log10(2.0)
    covariance[active] = np.diag(np.linalg.pinv(design[:, active].T @ design[:, active])) * redundancy
    sigma[seen] = np.sqrt(covariance[seen]) / (2.0 * terms[seen])
    return terms, sigma, np.sqrt(model)
