"""Hard and soft iron from points that an ellipsoid of known centre and shape has drawn."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.orientation.field_ellipsoid import fit_ellipsoid

FIELD_UT = 47.0


def directions(count, seed=0):
    d = np.random.default_rng(seed).standard_normal((count, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def ring(tilt_rad=0.6, count=800, seed=0):
    """Directions of a field that makes ``tilt_rad`` with the plane in which a sensor turns about its y axis."""
    angle = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, count)
    return np.column_stack(
        [np.cos(angle) * np.cos(tilt_rad), np.full(count, np.sin(tilt_rad)), np.sin(angle) * np.cos(tilt_rad)]
    )


def noise(count, seed=1):
    return 0.3 * np.random.default_rng(seed).standard_normal((count, 3))


@settings(deadline=None, max_examples=12)
@given(
    centre=st.lists(st.floats(-60.0, 60.0), min_size=3, max_size=3),
    soft=st.lists(st.floats(-0.12, 0.12), min_size=6, max_size=6),
)
def test_any_plain_hard_and_soft_iron_is_found(centre, soft):
    bend = np.eye(3) + np.array([[soft[0], soft[3], soft[4]], [soft[3], soft[1], soft[5]], [soft[4], soft[5], soft[2]]])
    bend /= np.linalg.det(bend) ** (1.0 / 3.0)
    mag = FIELD_UT * directions(1500) @ bend + np.array(centre) + noise(1500)
    found = fit_ellipsoid(mag)
    if found.extent == "none":  # hardly displaced: nothing would be steadier for it
        assert np.linalg.norm(centre) + FIELD_UT * np.abs(bend - np.eye(3)).max() < 3.0
        return
    np.testing.assert_allclose(found.centre_ut, centre, atol=0.3)
    np.testing.assert_allclose(found.matrix, np.linalg.inv(bend), atol=0.01)
    assert found.norm_ut == pytest.approx(FIELD_UT, abs=0.3)
    assert found.residual < 0.02


def test_outliers_near_iron_do_not_pull_it():
    mag = FIELD_UT * directions(1500) + np.array([12.0, -20.0, 5.0]) + noise(1500)
    mag[::20] += np.array([0.0, 80.0, 0.0])
    np.testing.assert_allclose(fit_ellipsoid(mag).centre_ut, [12.0, -20.0, 5.0], atol=0.6)


def test_a_clean_sensor_is_left_alone():
    assert fit_ellipsoid(FIELD_UT * directions(1500) + noise(1500)).extent == "none"


def test_a_ring_tells_its_centre_across_the_axis_only():
    mag = FIELD_UT * ring() + np.array([8.0, 15.0, -6.0]) + noise(800)
    found = fit_ellipsoid(mag)
    assert found.extent == "ring"
    assert abs(found.axis[1]) > 0.999
    np.testing.assert_allclose(found.centre_ut[[0, 2]], [8.0, -6.0], atol=0.3)
    assert abs(found.centre_ut[1]) < 1.0  # the field's own share along the axis cannot be told from the iron's
    np.testing.assert_array_equal(found.matrix, np.eye(3))


@pytest.mark.parametrize("count", [20, 800])
def test_half_a_ring_or_too_few_points_tell_nothing(count):
    mag = FIELD_UT * ring() + np.array([8.0, 15.0, -6.0]) + noise(800)
    assert fit_ellipsoid(mag[mag[:, 0] > 8.0][:count]).extent == "none"


def test_a_field_that_is_not_the_same_everywhere_is_no_ellipsoid():
    rng = np.random.default_rng(3)
    mag = FIELD_UT * directions(1500) * rng.uniform(0.6, 1.5, (1500, 1))
    assert fit_ellipsoid(mag).extent == "none"


def test_nothing_comes_of_nothing():
    assert fit_ellipsoid(np.zeros((500, 3))).extent == "none"
    assert fit_ellipsoid(np.zeros((0, 3))).extent == "none"
