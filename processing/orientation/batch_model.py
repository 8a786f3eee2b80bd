"""What the batch smoother believes: how the nodes of a run hang together and what each reading says of them.

Between nodes the sums of :mod:`processing.orientation.kernels_preintegration` lead attitude and velocity on. What holds
the tilt is that a device's velocity is bounded: own acceleration sums up to next to nothing, gravity at a wrong tilt
does not. How large a velocity is, is learned from the run itself, over some seconds around. A ball that rolls is held
far better: ``v = r ω × up``, with ``r`` within some per cent of the shell's radius. At rest there is neither velocity
nor rate. The field of a disturbed world counts by Cauchy's weight, begun wide, so that the many agree before the few
are doubted; its strength and inclination are those at the rests, where there are any.
"""

from dataclasses import dataclass

import numpy as np

from processing.orientation import quaternions as qt
from processing.orientation.batch_equations import (
    ACC,
    CONSTANTS,
    FIELD,
    GYRO,
    NODE,
    OFFSET,
    RADIUS,
    TURN,
    VELOCITY,
    NormalEquations,
)
from processing.survey import BoolArray, FloatArray

_GYR_RAD_RTS = np.radians(0.03)
_TURNED_SHARE = 0.0005  # of the angle turned between nodes: what scale and misalignment leave
_BIAS_WALK_RADPS_RTS = np.radians(0.003)
_BIAS_SIGMA_RADPS = np.radians(0.2)
_BIAS_SIGMA_S = 150.0
_ACC_MPS2_RTHZ = 0.02
_GYR_ERROR, _ACC_OFFSET_MPS2, _ACC_ERROR = 0.002, 0.01, 0.002
_FIELD_REFERENCE = 0.01
_FIELD_SIGMA, _FIELD_LASTS_S = 0.01, 2.0
_CAUCHY = 1.5
_WIDE = (4.0, 2.0, 1.0)  # the field's sigma in the first passes
_VELOCITY_MPS, _LEAST_VELOCITY_MPS, _VELOCITY_LASTS_S, _AROUND_S = 1.0, 0.05, 2.0, 5.0
_REST_MPS, _REST_RATE_RADPS_RTHZ = 0.01, np.radians(0.01)
_ROLLING_SHARE, _ROLLING_MPS, _ROLLING_LASTS_S = 0.03, 0.02, 1.0
_LOST_RAD, _LOST_MPS = np.radians(5.0), 1.0
_HEADING_FREE, _HEADING_HELD = 1.0 / np.radians(60.0) ** 2, 1.0 / np.radians(1e-3) ** 2


@dataclass(frozen=True)
class Sums:
    """What the samples say between n nodes, k = n − 1 intervals; vectors in the frame of the interval's first node."""

    duration_s: FloatArray  # (k,)
    lost: BoolArray  # (k,) holds a hole in the log
    resting: BoolArray  # (n,) the device lay still
    turn_q: FloatArray  # (k, 4)
    turn_by_gyro: FloatArray  # (k, 3, 12) by offset and by scale and misalignment, row by row
    gained_mps: FloatArray  # (k, 3) sum of specific force
    gained_by_gyro: FloatArray  # (k, 3, 12)
    gained_by_acc: FloatArray  # (k, 3, 12) by offset and by scale and misalignment
    rate_radps: FloatArray  # (k, 3) mean
    rate_s_radps: FloatArray  # (k, 3) mean in the sensor's own turning frame
    field: FloatArray | None  # (k, 3) mean, in units of the undisturbed field


@dataclass(frozen=True)
class Nodes:
    """The estimate: n nodes and the constants."""

    quat_ws: FloatArray  # (n, 4)
    velocity_mps: FloatArray  # (n, 3)
    offset_radps: FloatArray  # (n, 3) beyond the calibration
    constants: FloatArray  # (24,)

    @property
    def gyro_error(self) -> FloatArray:
        """Scale and misalignment (3, 3): what is to be added of the calibrated rate."""
        return self.constants[GYRO].reshape(3, 3)


def read_sums(rows: FloatArray, span_s: FloatArray, resting: BoolArray, *, with_field: bool) -> Sums:
    """Return the sums of the kernel's ``rows`` (k, ROW_SIZE); ``span_s`` (k,) is the time from node to node."""
    duration = np.maximum(rows[:, 4], 1e-6)
    by_gyro = rows[:, 8:44].reshape(-1, 3, 12)
    turned = by_gyro[:, :, [3, 7, 11]].sum(axis=2)
    return Sums(
        duration_s=duration,
        lost=span_s > 1.2 * duration,
        resting=resting,
        turn_q=rows[:, :4],
        turn_by_gyro=by_gyro,
        gained_mps=rows[:, 5:8],
        gained_by_gyro=rows[:, 44:80].reshape(-1, 3, 12),
        gained_by_acc=rows[:, 80:116].reshape(-1, 3, 12),
        rate_radps=turned / duration[:, None],
        rate_s_radps=rows[:, 119:122] / duration[:, None],
        field=rows[:, 116:119] / duration[:, None] if with_field else None,
    )


@dataclass(frozen=True)
class Around:
    """What is known beforehand: gravity, the field's dip (0 without a field), a ball's radius ± 1 sigma."""

    gravity_mps2: float
    dip_rad: float = 0.0
    radius_m: tuple[float, float] | None = None  # None: it does not roll
    earth_up_radps: float = 0.0  # the part of Earth's rotation about the vertical, where the latitude is known


def smooth(sums: Sums, quat_ws: FloatArray, around: Around) -> Nodes:
    """Return the nodes from first attitudes (n, 4), by Gauss and Newton; weights are learned on the way."""
    constants = np.zeros(CONSTANTS)
    constants[RADIUS] = around.radius_m[0] if around.radius_m else 0.0
    if sums.field is not None:
        turn, constants[FIELD] = _first_field(sums, quat_ws, around.dip_rad)
        quat_ws = qt.multiply(qt.turn_about_up(turn), quat_ws)
    before = constants.copy()
    zero = np.zeros((len(quat_ws), 3))
    nodes = Nodes(quat_ws, zero, zero, constants)
    speed = np.full(len(quat_ws), _VELOCITY_MPS)
    for width in (*_WIDE, 1.0, 1.0):
        equations = NormalEquations(len(quat_ws))
        _priors(equations, sums, nodes, before, around.radius_m[1] if around.radius_m else 1.0)
        _chain(equations, sums, nodes, around)
        _rests(equations, sums, nodes, around.earth_up_radps)
        if around.radius_m is None:
            weight = _per_node(sums.duration_s) / (_VELOCITY_LASTS_S * speed**2)
            equations.add_at_nodes(VELOCITY, nodes.velocity_mps, weight)
        else:
            _rolling(equations, sums, nodes)
        if sums.field is not None:
            _field(equations, sums, nodes, width)
        step, more = equations.solve()
        nodes = Nodes(
            qt.normalise(qt.multiply(qt.exp_map(step[:, TURN]), nodes.quat_ws)),
            nodes.velocity_mps + step[:, VELOCITY],
            nodes.offset_radps + step[:, OFFSET],
            nodes.constants + more,
        )
        speed = _usual_speed(nodes.velocity_mps, float(np.median(sums.duration_s)))
    return nodes


def _first_field(sums: Sums, quat_ws: FloatArray, dip_rad: float) -> tuple[float, FloatArray]:
    """Return the turn about up to the field's north, and its horizontal and vertical part."""
    assert sums.field is not None
    field = qt.rotate(quat_ws[:-1], sums.field)
    rest = sums.resting[:-1] & sums.resting[1:]
    level = np.hypot(field[:, 0], field[:, 1])
    reference = np.array([np.cos(dip_rad), -np.sin(dip_rad)])
    if np.any(rest):
        reference = np.array([np.median(level[rest]), np.median(field[rest, 2])])
    off = np.hypot(level - reference[0], field[:, 2] - reference[1]) / (_WIDE[0] * _FIELD_SIGMA)
    weight = np.where(rest | ~np.any(rest), 1.0, 0.1) / (1.0 + off**2) / np.maximum(level, 1e-9)
    east, north = weight @ field[:, 0], weight @ field[:, 1]
    return float(np.arctan2(east, north)), reference


def _priors(equations: NormalEquations, sums: Sums, nodes: Nodes, before: FloatArray, radius_sigma_m: float) -> None:
    sigma = np.concatenate(
        [np.full(9, _GYR_ERROR), np.full(3, _ACC_OFFSET_MPS2), np.full(9, _ACC_ERROR), np.full(2, _FIELD_REFERENCE)]
    )
    equations.add_to_constants(nodes.constants - before, np.append(sigma, radius_sigma_m))
    per_node = _per_node(sums.duration_s)
    weight = per_node / max(float(per_node.sum()), _BIAS_SIGMA_S) / _BIAS_SIGMA_RADPS**2
    equations.add_at_nodes(OFFSET, nodes.offset_radps, weight)
    # nobody knows the heading without a field: the first node holds it; nobody knows a free tilt either
    held = np.full((len(per_node) - 1, 3), 1e-8)
    held[0, 2] = _HEADING_HELD if sums.field is None else _HEADING_FREE
    equations.add(np.zeros_like(held), held, _of_node(len(held), TURN))


def _chain(equations: NormalEquations, sums: Sums, nodes: Nodes, around: Around) -> None:
    """Add what leads from node to node: turn, velocity and the wandering offset."""
    k = len(sums.duration_s)
    R = qt.to_matrix(nodes.quat_ws[:-1])
    gyro = np.column_stack([nodes.offset_radps[:-1], np.broadcast_to(nodes.constants[GYRO], (k, 9))])
    root = np.sqrt(sums.duration_s)
    own = np.matmul(sums.turn_by_gyro, gyro[:, :, None])[:, :, 0]
    led = qt.multiply(qt.multiply(nodes.quat_ws[:-1], qt.exp_map(own)), sums.turn_q)
    error = qt.log_map(qt.multiply(nodes.quat_ws[1:], qt.conjugate(led)))
    error[:, 2] += around.earth_up_radps * sums.duration_s  # the gyro feels the ground turn, which stands still to us
    turn_w = R @ sums.turn_by_gyro
    constants = np.zeros((k, 3, CONSTANTS))
    constants[:, :, GYRO] = -turn_w[:, :, 3:]
    here = -_of_node(k, TURN)
    here[:, :, OFFSET] = -turn_w[:, :, :3]
    turned = np.linalg.norm(sums.rate_s_radps, axis=1) * sums.duration_s
    sigma = np.hypot(np.hypot(_GYR_RAD_RTS * root, _TURNED_SHARE * turned), np.where(sums.lost, _LOST_RAD, 0.0))
    equations.add(error, 1.0 / sigma**2, here, _of_node(k, TURN), constants)

    gained_s = sums.gained_mps + (sums.gained_by_gyro @ gyro[:, :, None])[:, :, 0]
    gained_s = gained_s + sums.gained_by_acc @ nodes.constants[ACC]
    gained = (R @ gained_s[:, :, None])[:, :, 0]
    error = nodes.velocity_mps[1:] - nodes.velocity_mps[:-1] - gained
    error[:, 2] += around.gravity_mps2 * sums.duration_s
    gained_w = R @ sums.gained_by_gyro
    constants = np.zeros((k, 3, CONSTANTS))
    constants[:, :, GYRO] = -gained_w[:, :, 3:]
    constants[:, :, ACC] = -(R @ sums.gained_by_acc)
    here = -_of_node(k, VELOCITY)
    here[:, :, TURN] = _cross_matrix(gained)
    here[:, :, OFFSET] = -gained_w[:, :, :3]
    sigma = np.hypot(_ACC_MPS2_RTHZ * root, np.where(sums.lost, _LOST_MPS, 0.0))
    equations.add(error, 1.0 / sigma**2, here, _of_node(k, VELOCITY), constants)

    error = nodes.offset_radps[1:] - nodes.offset_radps[:-1]
    weight = 1.0 / (_BIAS_WALK_RADPS_RTS * root) ** 2
    equations.add(error, weight, -_of_node(k, OFFSET), _of_node(k, OFFSET))


def _rests(equations: NormalEquations, sums: Sums, nodes: Nodes, earth_up_radps: float) -> None:
    equations.add_at_nodes(VELOCITY, nodes.velocity_mps, np.where(sums.resting, 1.0 / _REST_MPS**2, 0.0))
    between = sums.resting[:-1] & sums.resting[1:]
    weight = np.where(between, sums.duration_s / _REST_RATE_RADPS_RTHZ**2, 0.0)
    k = len(weight)
    earth_s = qt.rotate_inverse(nodes.quat_ws[:-1], np.array([0.0, 0.0, earth_up_radps]))
    equations.add(nodes.offset_radps[:-1] + earth_s - sums.rate_s_radps, weight, _of_node(k, OFFSET))


def _rolling(equations: NormalEquations, sums: Sums, nodes: Nodes) -> None:
    """Hold the mean velocity between nodes to that of a ball that rolls, ``v = r ω × up``, bounces and floats aside."""
    k = len(sums.duration_s)
    radius = nodes.constants[RADIUS]
    rate = qt.rotate(nodes.quat_ws[:-1], sums.rate_radps)
    way = np.column_stack([rate[:, 1], -rate[:, 0], np.zeros(k)])  # ω × up
    error = 0.5 * (nodes.velocity_mps[:-1] + nodes.velocity_mps[1:]) - radius * way
    here, after, constants = 0.5 * _of_node(k, VELOCITY), 0.5 * _of_node(k, VELOCITY), np.zeros((k, 3, CONSTANTS))
    # a turn of the node turns ω: δω = θ × ω, and its cross product with up
    turned = -_cross_matrix(rate)
    here[:, 0, TURN] = -radius * turned[:, 1]
    here[:, 1, TURN] = radius * turned[:, 0]
    constants[:, :, RADIUS] = -way
    sigma = _ROLLING_MPS + _ROLLING_SHARE * abs(radius) * np.linalg.norm(way, axis=1)
    off = np.linalg.norm(error, axis=1) / (3.0 * _CAUCHY * sigma)
    equations.add(error, sums.duration_s / (_ROLLING_LASTS_S * sigma**2 * (1.0 + off**2)), here, after, constants)


def _field(equations: NormalEquations, sums: Sums, nodes: Nodes, width: float) -> None:
    assert sums.field is not None
    field = qt.rotate(nodes.quat_ws[:-1], sums.field)
    horizontal, vertical = nodes.constants[FIELD]
    error = field - np.array([0.0, horizontal, vertical])
    off = np.linalg.norm(error, axis=1) / (_CAUCHY * width * _FIELD_SIGMA)
    here, constants = np.zeros((len(field), 3, NODE)), np.zeros((len(field), 3, CONSTANTS))
    here[:, :, TURN] = -_cross_matrix(field)
    constants[:, 1, FIELD.start] = -1.0
    constants[:, 2, FIELD.start + 1] = -1.0
    weight = sums.duration_s / (_FIELD_LASTS_S * (width * _FIELD_SIGMA) ** 2 * (1.0 + off**2))
    equations.add(error, weight, here, None, constants)


def _usual_speed(velocity_mps: FloatArray, node_s: float) -> FloatArray:
    """Return the rms velocity per axis (n,) over the seconds around each node."""
    half = max(round(_AROUND_S / node_s), 1)
    square = np.pad(np.mean(velocity_mps**2, axis=1), half, mode="edge")
    total = np.cumsum(np.concatenate([[0.0], square]))
    mean = (total[2 * half + 1 :] - total[: -2 * half - 1]) / (2 * half + 1)
    return np.asarray(np.sqrt(np.maximum(mean, 0.0) + _LEAST_VELOCITY_MPS**2), dtype=np.float64)


def _per_node(duration_s: FloatArray) -> FloatArray:
    return np.append(duration_s, duration_s[-1])


def _of_node(k: int, part: slice) -> FloatArray:
    """Return the derivative (k, 3, 9) of one part of a node's unknowns."""
    derivative = np.zeros((k, 3, NODE))
    derivative[:, :, part] = np.eye(3)
    return derivative


def _cross_matrix(v: FloatArray) -> FloatArray:
    """Return ``[v]×`` (k, 3, 3)."""
    matrix = np.zeros((len(v), 3, 3))
    matrix[:, 0, 1], matrix[:, 0, 2], matrix[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    matrix[:, 1, 0], matrix[:, 2, 0], matrix[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    return matrix
