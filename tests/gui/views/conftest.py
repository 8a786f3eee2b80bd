"""What tests of the views share: small synthetic surveys and a cursor over them."""

import numpy as np
import pytest

from processing.survey import Candidate, ImuSamples, LeakClass, Track
from widgets.time_cursor import TimeCursor


def synthetic_track(time_s, chainage_m, *, heading_rad=0.7, sigma_m=0.5):
    """A straight track with the given chainage at the given times."""
    time_s, chainage_m = np.asarray(time_s, float), np.asarray(chainage_m, float)
    count = len(time_s)
    east, north = chainage_m * np.sin(heading_rad), chainage_m * np.cos(heading_rad)
    speed = np.gradient(chainage_m, time_s) if count > 1 else np.zeros(count)
    sigma = np.full(count, sigma_m)
    return Track(
        time_s=time_s,
        chainage_m=chainage_m,
        position_w_m=np.stack((east, north, -0.01 * chainage_m), axis=1),
        sigma_along_m=sigma,
        sigma_cross_m=sigma,
        sigma_up_m=sigma,
        quat_ws=np.tile([1.0, 0.0, 0.0, 0.0], (count, 1)),
        speed_mps=speed,
        method="synthetic",
    )


def synthetic_candidate(number, time_s, chainage_m, *, position=(0.0, 0.0, 0.0), score=0.5):
    return Candidate(
        id=number,
        time_s=time_s,
        chainage_m=chainage_m,
        chainage_low95_m=chainage_m - 1.0,
        chainage_high95_m=chainage_m + 1.0,
        position_w_m=position,
        score=score,
        level_db=6.0,
        leak_class=LeakClass.LEAK,
        band_hz=(500.0, 4000.0),
        width_m=3.0,
    )


@pytest.fixture
def make_track():
    return synthetic_track


@pytest.fixture
def make_candidate():
    return synthetic_candidate


@pytest.fixture
def track():
    """600 s, 400 m: slow, a stop of 100 s, then fast."""
    time_s = np.arange(0.0, 600.01, 0.1)
    speed = np.where(time_s < 200.0, 0.5, np.where(time_s < 300.0, 0.0, 1.0))
    return synthetic_track(time_s, np.concatenate(([0.0], np.cumsum(speed[:-1] * 0.1))))


@pytest.fixture
def cursor(qapp, track):
    """A cursor over the track and a little sound before and after it."""
    cursor = TimeCursor()
    cursor.set_extent(-10.0, 620.0)
    cursor.set_track(track)
    return cursor


@pytest.fixture
def imu():
    """600 s at 100 Hz, rolling at 6 rad/s, with one knock at 123.45 s."""
    count = 60_000
    rng = np.random.default_rng(3)
    acc = rng.normal(0.0, 0.2, (count, 3)) + np.array([0.0, 0.0, 9.81])
    gyr = rng.normal(0.0, 0.02, (count, 3)) + np.array([0.0, 6.0, 0.0])
    acc[12_345, 2] = 70.0
    return ImuSamples(np.arange(count) / 100.0, acc, gyr, np.ones(count, bool))


@pytest.fixture
def shown(qtbot):
    """Show a widget at a size, and return it once it has been painted."""

    def show(widget, width=900, height=240):
        qtbot.addWidget(widget)
        widget.resize(width, height)
        widget.show()
        qtbot.waitExposed(widget)
        return widget

    return show
