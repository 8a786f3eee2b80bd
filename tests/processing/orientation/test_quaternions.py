"""Quaternion algebra against scipy's rotations and against turns that one can do in one's head."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from processing.orientation import quaternions as qt

ANGLES = st.floats(-np.pi, np.pi)
VECTORS = arrays(np.float64, (7, 3), elements=st.floats(-10.0, 10.0))
QUATERNIONS = (
    arrays(np.float64, (7, 4), elements=st.floats(-1.0, 1.0))
    .filter(lambda q: np.all(np.linalg.norm(q, axis=1) > 1e-3))
    .map(qt.normalise)
)


def peer(q):
    return Rotation.from_quat(q, scalar_first=True)


def same_rotation(p, q, tolerance=1e-9):
    return np.all(np.abs(np.abs(np.sum(p * q, axis=-1)) - 1.0) < tolerance)


@given(QUATERNIONS, QUATERNIONS)
def test_the_product_of_unit_quaternions_is_unit_and_is_scipys(p, q):
    product = qt.multiply(p, q)
    np.testing.assert_allclose(np.linalg.norm(product, axis=1), 1.0, atol=1e-12)
    assert same_rotation(product, (peer(p) * peer(q)).as_quat(scalar_first=True))


@given(QUATERNIONS, VECTORS)
def test_rotating_is_the_sandwich_product_and_scipys_rotation(q, v):
    sandwich = qt.multiply(qt.multiply(q, np.column_stack([np.zeros(7), v])), qt.conjugate(q))
    np.testing.assert_allclose(qt.rotate(q, v), sandwich[:, 1:], atol=1e-12)
    np.testing.assert_allclose(qt.rotate(q, v), peer(q).apply(v), atol=1e-12)


@given(QUATERNIONS, VECTORS)
def test_rotating_back_returns_the_vector(q, v):
    np.testing.assert_allclose(qt.rotate_inverse(q, qt.rotate(q, v)), v, atol=1e-11)


@given(QUATERNIONS, QUATERNIONS, VECTORS)
def test_turning_by_a_product_is_turning_twice(p, q, v):
    np.testing.assert_allclose(qt.rotate(qt.multiply(p, q), v), qt.rotate(p, qt.rotate(q, v)), atol=1e-11)


@given(VECTORS)
def test_the_exponential_map_is_scipys_and_unit(r):
    q = qt.exp_map(r)
    np.testing.assert_allclose(np.linalg.norm(q, axis=1), 1.0, atol=1e-12)
    assert same_rotation(q, Rotation.from_rotvec(r).as_quat(scalar_first=True))


@given(arrays(np.float64, (7, 3), elements=st.floats(-1.8, 1.8)))
def test_the_logarithm_undoes_the_exponential_below_half_a_turn(r):
    np.testing.assert_allclose(qt.log_map(qt.exp_map(r)), r, atol=1e-9)


@pytest.mark.parametrize("size", [0.0, 1e-12, 1e-7, 0.99e-4, 1.01e-4, 1e-3, 3.14159])
def test_small_and_large_angles_survive_the_round_trip(size):
    r = size * np.array([0.6, -0.8, 0.0])
    np.testing.assert_allclose(qt.log_map(qt.exp_map(r)), r, rtol=1e-9, atol=1e-18)


@given(QUATERNIONS)
def test_matrices_are_scipys_and_lead_back(q):
    np.testing.assert_allclose(qt.to_matrix(q), peer(q).as_matrix(), atol=1e-12)
    assert same_rotation(qt.from_matrix(qt.to_matrix(q)), q)


@pytest.mark.parametrize("axis", range(3))
def test_half_turns_survive_the_matrix_round_trip(axis):
    q = np.insert(np.eye(3)[axis], 0, 0.0)
    assert same_rotation(qt.from_matrix(qt.to_matrix(q)), q)


@given(ANGLES, st.floats(-1.55, 1.55), ANGLES)
def test_roll_pitch_yaw_are_intrinsic_zyx(roll, pitch, yaw):
    q = qt.from_euler_zyx(roll, pitch, yaw)
    assert same_rotation(q, Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_quat(scalar_first=True))
    assert same_rotation(qt.from_euler_zyx(*qt.to_roll_pitch_yaw(q)), q)


def test_a_quarter_yaw_turns_the_sensors_x_axis_from_east_to_north():
    q = qt.from_euler_zyx(0.0, 0.0, np.pi / 2)
    np.testing.assert_allclose(qt.rotate(q, np.array([1.0, 0.0, 0.0])), [0.0, 1.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(qt.turn_about_up(np.pi / 2), q, atol=1e-15)


def test_a_quarter_roll_lays_the_sensors_y_axis_up():
    q = qt.from_euler_zyx(np.pi / 2, 0.0, 0.0)
    np.testing.assert_allclose(qt.rotate(q, np.array([0.0, 1.0, 0.0])), [0.0, 0.0, 1.0], atol=1e-15)


@pytest.mark.parametrize(("yaw_deg", "heading_deg"), [(0, 90), (90, 0), (180, 270), (-90, 180), (45, 45)])
def test_heading_counts_clockwise_from_north(yaw_deg, heading_deg):
    assert np.degrees(qt.heading_from_yaw(np.radians(yaw_deg))) == pytest.approx(heading_deg)
    assert np.cos(qt.yaw_from_heading(np.radians(heading_deg)) - np.radians(yaw_deg)) == pytest.approx(1.0)


@given(arrays(np.float64, (5, 3), elements=st.floats(-5, 5)), arrays(np.float64, (5, 3), elements=st.floats(-5, 5)))
def test_the_shortest_turn_leads_one_direction_into_the_other(a, b):
    a, b = a + 6.0 * np.eye(3)[0], b - 6.0 * np.eye(3)[1]
    q = qt.from_two_vectors(a, b)
    a_unit = a / np.linalg.norm(a, axis=1, keepdims=True)
    b_unit = b / np.linalg.norm(b, axis=1, keepdims=True)
    np.testing.assert_allclose(qt.rotate(q, a_unit), b_unit, atol=1e-7)
    np.testing.assert_allclose(
        qt.angle_between(np.array(qt.IDENTITY), q), np.arccos(np.sum(a_unit * b_unit, 1)), atol=1e-6
    )


@pytest.mark.parametrize("a", [[1.0, 0, 0], [0, 1.0, 0], [0, 0, -2.0], [0.3, -0.4, 0.5]])
def test_opposite_directions_have_a_turn_too(a):
    a = np.array(a)
    np.testing.assert_allclose(qt.rotate(qt.from_two_vectors(a, -a), a), -a, atol=1e-12)
    np.testing.assert_allclose(qt.from_two_vectors(a, a), qt.IDENTITY, atol=1e-12)


def test_slerp_at_times_is_scipys_and_holds_the_ends():
    rng = np.random.default_rng(3)
    time_s = np.array([0.0, 0.5, 0.7, 2.0])
    q = qt.normalise(rng.standard_normal((4, 4)))
    at_s = np.linspace(0.0, 2.0, 41)
    from scipy.spatial.transform import Slerp

    expected = Slerp(time_s, peer(q))(at_s).as_quat(scalar_first=True)
    assert same_rotation(qt.slerp_at(time_s, q, at_s), expected)
    ends = qt.slerp_at(time_s, q, np.array([-1.0, 9.0]))
    assert same_rotation(ends, q[[0, 3]])
    assert same_rotation(qt.slerp_at(time_s[:1], q[:1], at_s), np.repeat(q[:1], 41, axis=0))


def test_one_sample_and_a_whole_run_give_the_same():
    rng = np.random.default_rng(4)
    q, v = qt.normalise(rng.standard_normal((50, 4))), rng.standard_normal((50, 3))
    np.testing.assert_array_equal(qt.rotate(q, v)[7], qt.rotate(q[7], v[7]))
    np.testing.assert_array_equal(qt.multiply(q, q[3])[7], qt.multiply(q[7], q[3]))


def test_a_zero_quaternion_becomes_the_identity():
    np.testing.assert_array_equal(qt.normalise(np.zeros((2, 4))), [qt.IDENTITY] * 2)
