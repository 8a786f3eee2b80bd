"""Extended and unscented Kalman filters for a model given as functions, of one or a few states.

The model is Python, called once a row (EKF) or 2d + 1 times (UKF): for channels of some thousand rows.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from processing.survey import BoolArray, FloatArray

Function = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class Model:
    """``x_k = f(x_{k−1}) + w``, ``z_k = h(x_k) + v`` with covariances ``Q`` (d, d) and ``R`` (m, m).

    ``f`` and ``h`` take (d,) and return (d,) and (m,); their Jacobians (d, d) and (m, d) are needed by the EKF only.
    """

    f: Function
    h: Function
    Q: FloatArray
    R: FloatArray
    f_jacobian: Function | None = None
    h_jacobian: Function | None = None
    takes_rows: bool = False  # f and h take points (k, d) too, which spares the UKF its loops


@dataclass(frozen=True)
class StateEstimates:
    """What a filter believes after each of n rows, and how surprised it was.

    In a row that is not valid the state is predicted, the innovation is 0 and the log likelihood 0.
    """

    mean: FloatArray  # (n, d)
    covariance: FloatArray  # (n, d, d)
    innovation: FloatArray  # (n, m)
    innovation_covariance: FloatArray  # (n, m, m)
    log_likelihood: FloatArray  # (n,)
    # what was expected of each row before it was read, and its covariance with the row before; for the smoother
    predicted_mean: FloatArray  # (n, d)
    predicted_covariance: FloatArray  # (n, d, d)
    step_covariance: FloatArray  # (n, d, d)


Predict = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]
Expect = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray, FloatArray]]


def ekf(
    model: Model, readings: FloatArray, mean: FloatArray, covariance: FloatArray, valid: BoolArray | None = None
) -> StateEstimates:
    """Filter ``readings`` (n, m) or (n,) by linearising at the estimate (P2, eq. 3.10–3.18).

    ``mean`` (d,) and ``covariance`` (d, d) are those before the step to the first row.

    Raises:
        ValueError: the model has no Jacobians.
    """
    f_jacobian, h_jacobian = model.f_jacobian, model.h_jacobian
    if f_jacobian is None or h_jacobian is None:
        raise ValueError("the EKF needs both Jacobians; the UKF does without")

    def predict(x: FloatArray, P: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        F = f_jacobian(x)
        step = P @ F.T
        return model.f(x), F @ step + model.Q, step

    def expect(x: FloatArray, P: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        H = h_jacobian(x)
        return model.h(x), H @ P @ H.T + model.R, P @ H.T

    return _run(predict, expect, readings, mean, covariance, valid)


def ukf(
    model: Model,
    readings: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
    valid: BoolArray | None = None,
    kappa: float = 0.0,
) -> StateEstimates:
    """Filter ``readings`` (n, m) or (n,) by the unscented transform of S. Julier, J. Uhlmann.

    With ``kappa`` 0 these are the 2d equally weighted points of P2 (eq. 3.19–3.27), drawn anew before the reading;
    else a middle point has the weight ``kappa/(d + kappa)``, 3 − d being right for Gaussians; not negative.
    """
    dimension = len(mean)
    weights = np.full(2 * dimension + 1, 0.5 / (dimension + kappa))
    weights[0] = kappa / (dimension + kappa)

    def each(function: Function, drawn: FloatArray) -> FloatArray:
        return function(drawn) if model.takes_rows else np.array([function(point) for point in drawn])

    def points(x: FloatArray, P: FloatArray) -> FloatArray:
        root = np.linalg.cholesky((dimension + kappa) * P).T
        return np.vstack([x, x + root, x - root])

    def predict(x: FloatArray, P: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        drawn = points(x, P)
        moved = each(model.f, drawn)
        middle = weights @ moved
        off = moved - middle
        return middle, (off.T * weights) @ off + model.Q, ((drawn - x).T * weights) @ off

    def expect(x: FloatArray, P: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        drawn = points(x, P)
        seen = each(model.h, drawn)
        middle = weights @ seen
        off = seen - middle
        return middle, (off.T * weights) @ off + model.R, ((drawn - x).T * weights) @ off

    return _run(predict, expect, readings, mean, covariance, valid)


def smoothed(estimates: StateEstimates) -> tuple[FloatArray, FloatArray]:
    """Return means (n, d) and covariances (n, d, d) given the whole record, for either filter.

    Backwards as H. E. Rauch, F. Tung, C. T. Striebel (1965), with the filter's own covariance of one row and the next:
    for the unscented filter that is S. Särkkä's smoother (2008).
    """
    mean, covariance = estimates.mean.copy(), estimates.covariance.copy()
    for k in range(len(mean) - 2, -1, -1):
        predicted = estimates.predicted_covariance[k + 1]
        back = np.linalg.solve(predicted, estimates.step_covariance[k + 1].T).T
        mean[k] += back @ (mean[k + 1] - estimates.predicted_mean[k + 1])
        changed = covariance[k] + back @ (covariance[k + 1] - predicted) @ back.T
        covariance[k] = 0.5 * (changed + changed.T)
    return mean, covariance


def _run(
    predict: Predict,
    expect: Expect,
    readings: FloatArray,
    mean: FloatArray,
    covariance: FloatArray,
    valid: BoolArray | None,
) -> StateEstimates:
    z = np.asarray(readings, dtype=np.float64)
    z = z[:, None] if z.ndim == 1 else z
    trusted: BoolArray = np.asarray(np.isfinite(z).all(axis=1), dtype=np.bool_)
    if valid is not None:
        trusted &= valid
    (rows, m), d = z.shape, len(mean)
    out = StateEstimates(
        np.empty((rows, d)),
        np.empty((rows, d, d)),
        np.zeros((rows, m)),
        np.empty((rows, m, m)),
        np.zeros(rows),
        np.empty((rows, d)),
        np.empty((rows, d, d)),
        np.empty((rows, d, d)),
    )
    x, P = np.asarray(mean, dtype=np.float64), np.asarray(covariance, dtype=np.float64)
    for k in range(rows):
        x, P, out.step_covariance[k] = predict(x, P)
        out.predicted_mean[k], out.predicted_covariance[k] = x, P
        expected, S, cross = expect(x, P)
        out.innovation_covariance[k] = S
        if trusted[k]:
            innovation = z[k] - expected
            inverse = np.linalg.inv(S)
            gain = cross @ inverse
            x, P = x + gain @ innovation, P - gain @ S @ gain.T
            P = 0.5 * (P + P.T)  # rounding must not make it lopsided over a long run
            out.innovation[k] = innovation
            surprise = float(innovation @ inverse @ innovation)
            out.log_likelihood[k] = -0.5 * (surprise + np.linalg.slogdet(S)[1] + m * np.log(2.0 * np.pi))
        out.mean[k], out.covariance[k] = x, P
    return out
