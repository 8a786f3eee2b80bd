"""The rounded route is a unit-speed curve through what the map says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.simulation.route import SmoothRoute, route_of_length


def test_a_straight_route_is_its_chord():
    route = SmoothRoute(np.array([[1.0, 2.0, 3.0], [4.0, 6.0, 3.0]]), 1.0)
    at = route.points(np.array([0.0, 2.5, 5.0]))
    assert route.length_m == pytest.approx(5.0, abs=1e-12)
    np.testing.assert_allclose(at.position_w_m[1], [2.5, 4.0, 3.0], atol=1e-12)
    np.testing.assert_allclose(at.tangent_w, np.tile([0.6, 0.8, 0.0], (3, 1)), atol=1e-12)
    assert np.all(at.curvature_w_pm == 0)


def test_a_right_angle_bend_peaks_at_the_stated_radius_and_has_length_2_theta_r():
    radius = 1.7
    route = SmoothRoute(np.array([[0.0, 0, 0], [30.0, 0, 0], [30.0, 30.0, 0]]), radius)
    ((middle, angle),) = route.bends_m
    assert angle == pytest.approx(np.pi / 2)
    peak = np.linalg.norm(route.points(np.array([middle])).curvature_w_pm)
    assert peak == pytest.approx(1 / radius, rel=1e-12)
    s = np.linspace(0, route.length_m, 20001)
    curved = s[np.linalg.norm(route.points(s).curvature_w_pm, axis=1) > 0]
    assert curved[-1] - curved[0] == pytest.approx(np.pi * radius, abs=0.02)
    # the middle of a symmetric bend lies on the corner's bisector
    x, y, _ = route.points(np.array([middle])).position_w_m[0]
    assert 30.0 - x == pytest.approx(y, abs=1e-9)


corners = st.lists(st.tuples(st.floats(2.0, 40.0), st.floats(-2.6, 2.6), st.floats(-0.2, 0.2)), min_size=1, max_size=8)


@settings(max_examples=40, deadline=None)
@given(legs=corners, radius=st.floats(0.1, 5.0))
def test_every_route_is_a_smooth_unit_speed_curve_between_its_end_points(legs, radius):
    heading, points = 0.0, [np.zeros(3)]
    for length, turn, slope in legs:
        heading += turn
        points.append(points[-1] + length * np.array([np.cos(heading), np.sin(heading), slope]))
    points = np.array(points)
    route = SmoothRoute(points, radius)
    s = np.linspace(0, route.length_m, 4001)
    at = route.points(s)
    np.testing.assert_allclose(at.position_w_m[[0, -1]], points[[0, -1]], atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(at.tangent_w, axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(np.sum(at.tangent_w * at.curvature_w_pm, axis=1), 0.0, atol=1e-9)
    h = min(1e-4, route.length_m / 1e4)
    inner = s[10:-10]
    ahead, behind = route.points(inner + h), route.points(inner - h)
    np.testing.assert_allclose((ahead.position_w_m - behind.position_w_m) / (2 * h), at.tangent_w[10:-10], atol=2e-4)
    # no corner: over h the tangent turns by no more than the tightest bend allows
    tightest = np.max(np.linalg.norm(at.curvature_w_pm, axis=1)) * 1.2 + 1.0 / radius + 1e-6
    assert np.max(np.linalg.norm(ahead.tangent_w - behind.tangent_w, axis=1)) <= 2 * h * tightest * 4


def test_a_route_is_scaled_to_its_stated_length():
    plan = np.array([[0.0, 0, 0], [3.0, 0, 0], [3.0, 2.0, 0], [-1.0, 2.0, 0], [-1.0, 0, 0], [0.0, 0, 0]])
    route = route_of_length(plan, 0.4, 45.77)
    assert route.length_m == pytest.approx(45.77, abs=1e-7)
    np.testing.assert_allclose(route.points(np.array([route.length_m])).position_w_m[0], 0.0, atol=1e-9)


@pytest.mark.parametrize(
    "points", [[[0.0, 0, 0]], [[0.0, 0, 0], [0.0, 0, 0]], [[0.0, 0, 0], [5.0, 0, 0], [0.0, 0.1, 0]]]
)
def test_a_route_that_cannot_be_is_refused(points):
    with pytest.raises(ValueError, match="route"):
        SmoothRoute(np.array(points), 1.0)
