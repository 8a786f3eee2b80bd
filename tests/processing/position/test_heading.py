"""The direction in which a path sets out, wherever the first bend comes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.position.heading import initial_direction
from processing.position.odometry import Odometry


def path(along_m, aside_m, yaw_rad):
    """Return a free path through these places, turned by ``yaw_rad``."""
    cos, sin = np.cos(yaw_rad), np.sin(yaw_rad)
    place = np.column_stack([cos * along_m - sin * aside_m, sin * along_m + cos * aside_m, np.zeros(len(along_m))])
    chainage = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(place[:, :2], axis=0).T))])
    zero = np.zeros(len(chainage))
    return Odometry(chainage / 0.5, place, chainage, zero + 0.5, np.tile([1.0, 0, 0, 0], (len(zero), 1)),
                    zero, zero, zero, zero, 0.01, 0.01)  # fmt: skip


def with_bend(first_m, angle_deg, radius_m=0.35, length_m=60.0):
    """Return along and aside of a straight piece of ``first_m``, a bend, and the rest."""
    step = 0.01
    heading = np.zeros(int(length_m / step))
    bend = round(np.radians(abs(angle_deg)) * radius_m / step)
    start = round(first_m / step)
    heading[start : start + bend] = np.radians(angle_deg) * np.arange(bend) / bend
    heading[start + bend :] = np.radians(angle_deg)
    return np.cumsum(np.cos(heading)) * step, np.cumsum(np.sin(heading)) * step


@given(st.floats(0.4, 30.0), st.sampled_from([-90.0, -45.0, 30.0, 90.0]), st.floats(-3.0, 3.0))
def test_the_pipe_may_turn_right_after_the_launch(first_m, angle_deg, yaw_rad):
    found = initial_direction(path(*with_bend(first_m, angle_deg), yaw_rad))
    assert np.degrees(np.angle(np.exp(1j * (found - yaw_rad)))) == pytest.approx(0.0, abs=2.0)


@given(st.floats(0.0, 6.0), st.floats(-3.0, 3.0))
def test_a_ball_that_weaves_from_wall_to_wall_does_not_lead_it_astray(phase, yaw_rad):
    along = np.arange(0.0, 60.0, 0.01)
    aside = 0.03 * (np.sin(2.0 * np.pi * along / 2.0 + phase) - np.sin(phase))
    found = initial_direction(path(along, aside, yaw_rad))
    assert np.degrees(np.angle(np.exp(1j * (found - yaw_rad)))) == pytest.approx(0.0, abs=2.5)


def test_a_device_that_never_left_has_no_direction():
    assert initial_direction(path(np.linspace(0.0, 0.3, 10), np.zeros(10), 0.0)) is None
