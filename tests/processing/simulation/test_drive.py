"""The drive plan: its chainage is the integral of its speed, its stops are where and as long as they should be."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from processing.simulation.drive import DrivePlan
from processing.simulation.scenario import Drive, Stop


@settings(max_examples=40, deadline=None)
@given(
    speed=st.floats(0.1, 2.0),
    ramp=st.floats(0.5, 8.0),
    variation=st.floats(0.0, 0.3),
    length=st.floats(3.0, 200.0),
    stop_at=st.floats(0.1, 0.9),
    seed=st.integers(0, 1000),
)
def test_speed_is_the_derivative_of_chainage_and_never_negative(speed, ramp, variation, length, stop_at, seed):
    drive = Drive(speed, variation, 6.0, ramp, 3.0, 2.0, (Stop(stop_at * length, 5.0),))
    plan = DrivePlan(drive, length, np.random.default_rng(seed))
    t = np.linspace(0, plan.duration_s, 3001)
    h = 1e-5
    before, now, after = plan.at(t - h), plan.at(t), plan.at(t + h)
    np.testing.assert_allclose((after.chainage_m - before.chainage_m) / (2 * h), now.speed_mps, atol=1e-6 * (1 + speed))
    np.testing.assert_allclose((after.speed_mps - before.speed_mps) / (2 * h), now.acc_mps2, atol=1e-4 * (1 + speed))
    np.testing.assert_allclose((after.going - before.going) / (2 * h), now.going_d1, atol=1e-3)
    assert now.speed_mps.min() >= 0
    assert now.chainage_m[0] == 0
    assert now.chainage_m[-1] == pytest.approx(length, abs=1e-9)


def test_the_device_stands_at_its_stop_for_as_long_as_stated():
    plan = DrivePlan(Drive(stops=(Stop(12.0, 7.5),)), 40.0, np.random.default_rng(1))
    t = np.arange(0, plan.duration_s, 0.001)
    going = plan.at(t)
    standing = t[np.abs(going.chainage_m - 12.0) < 1e-9]
    assert standing[-1] - standing[0] == pytest.approx(7.5, abs=0.15)  # the ramps' ends are flatter than 1e-9 m
    moving = (going.speed_mps > 1e-6).sum() * 0.001
    assert plan.duration_s - moving == pytest.approx(14.0 + 7.5 + 14.0, abs=0.4)
