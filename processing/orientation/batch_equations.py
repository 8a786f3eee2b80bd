"""Normal equations of the batch smoother: nodes in a chain, each coupled to the next, and constants coupled to all.

Each node has nine unknowns: the turn of its attitude in the world, its velocity and its gyro offset. The constants are
 the errors of scale and misalignment of the gyro (9), offset (3) and scale and misalignment (9) of the
accelerometer, the field's horizontal and vertical part (2) and the rolling radius (1). With the chain's matrix ``H``
banded and the constants as its border, Schur's complement solves both at a cost linear in the number of nodes.
"""

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from processing.survey import FloatArray

NODE = 9
TURN, VELOCITY, OFFSET = slice(0, 3), slice(3, 6), slice(6, 9)
CONSTANTS = 24
GYRO, ACC, FIELD, RADIUS = slice(0, 9), slice(9, 21), slice(21, 23), 23


class NormalEquations:
    """Sums weighted squares of ``e + J_k δ_k + J_n δ_{k+1} + J_c δ_c`` over the intervals between nodes."""

    def __init__(self, nodes: int) -> None:
        self._own = np.zeros((nodes, NODE, NODE))
        self._next = np.zeros((nodes - 1, NODE, NODE))
        self._right = np.zeros((nodes, NODE))
        self._border = np.zeros((nodes, NODE, CONSTANTS))
        self._constants = np.zeros((CONSTANTS, CONSTANTS))
        self._constants_right = np.zeros(CONSTANTS)

    def add(
        self,
        error: FloatArray,
        weight: FloatArray,
        here: FloatArray,
        after: FloatArray | None = None,
        constants: FloatArray | None = None,
    ) -> None:
        """Add residuals (k, r) with weights (k,) or (k, r) and derivatives (k, r, 9), (k, r, 9) and (k, r, 24)."""
        w = np.broadcast_to(weight if weight.ndim == 2 else weight[:, None], error.shape)
        weighted = w * error
        w_here = w[:, :, None] * here
        t_here = here.transpose(0, 2, 1)
        self._own[:-1] += t_here @ w_here
        self._right[:-1] -= (t_here @ weighted[:, :, None])[:, :, 0]
        if after is not None:
            w_after, t_after = w[:, :, None] * after, after.transpose(0, 2, 1)
            self._own[1:] += t_after @ w_after
            self._right[1:] -= (t_after @ weighted[:, :, None])[:, :, 0]
            self._next += t_here @ w_after
        if constants is not None:
            w_constants = w[:, :, None] * constants
            self._border[:-1] += t_here @ w_constants
            if after is not None:
                self._border[1:] += t_after @ w_constants
            flat = constants.reshape(-1, CONSTANTS)
            self._constants += flat.T @ w_constants.reshape(-1, CONSTANTS)
            self._constants_right -= flat.T @ weighted.ravel()

    def add_at_nodes(self, part: slice, error: FloatArray, weight: FloatArray) -> None:
        """Add residuals (n, 3) of one part of the nodes' unknowns with weights (n,)."""
        places = np.arange(part.start, part.stop)
        self._own[:, places, places] += weight[:, None]
        self._right[:, part] -= weight[:, None] * error

    def add_to_constants(self, error: FloatArray, sigma: FloatArray) -> None:
        """Add the prior of the constants: residuals and sigmas (24,)."""
        self._constants[np.diag_indices(CONSTANTS)] += 1.0 / sigma**2
        self._constants_right -= error / sigma**2

    def solve(self) -> tuple[FloatArray, FloatArray]:
        """Return the unknowns of the nodes (n, 9) and the constants (24,)."""
        nodes = len(self._own)
        size = nodes * NODE
        band = np.zeros((2 * NODE, size))
        for column in range(NODE):
            for row in range(column, NODE):
                band[row - column, column::NODE] = self._own[:, row, column]
            for row in range(NODE):
                band[NODE + row - column, column : size - NODE : NODE] = self._next[:, column, row]
        factor = cholesky_banded(band, overwrite_ab=True, lower=True, check_finite=False)
        border = self._border.reshape(size, CONSTANTS)
        right = np.column_stack([self._right.reshape(size), border])
        solved = cho_solve_banded((factor, True), right, overwrite_b=True, check_finite=False)
        reduced = self._constants - border.T @ solved[:, 1:]
        constants = np.asarray(
            np.linalg.solve(reduced, self._constants_right - border.T @ solved[:, 0]), dtype=np.float64
        )
        return (solved[:, 0] - solved[:, 1:] @ constants).reshape(nodes, NODE), constants
