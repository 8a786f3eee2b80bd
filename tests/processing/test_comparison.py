"""The comparison of methods: free paths, and their errors at what is known."""

import threading

import numpy as np
import pytest

from processing.comparison import compare, held_against
from processing.errors import Cancelled, ErrorCode
from processing.progress import Progress, silent
from processing.settings import OrientationSettings, Settings
from processing.simulation.papers import P1_LOOPS, p1_loop
from processing.simulation.run import simulate
from processing.survey import DeviceInfo, Launch, PipeInfo, Survey, TiePoint, Track


def straight_track(heading_rad=0.0, scale=1.0):
    """Return 100 m in 100 s, as found by a method that turned the world and measured too long."""
    time_s = np.linspace(0.0, 100.0, 401)
    chainage = scale * time_s
    zero = np.zeros_like(time_s)
    return Track(
        time_s=time_s,
        chainage_m=chainage,
        position_w_m=np.column_stack([chainage * np.cos(heading_rad), chainage * np.sin(heading_rad), zero]),
        sigma_along_m=zero + 1.0,
        sigma_cross_m=zero + 1.0,
        sigma_up_m=zero + 1.0,
        quat_ws=np.tile([1.0, 0.0, 0.0, 0.0], (401, 1)),
        speed_mps=zero + scale,
        method="rolling",
    )


TIES = (
    TiePoint("end", 100.0, chainage_m=100.0, east_m=100.0, north_m=0.0),
    TiePoint("middle", 50.0, east_m=50.0, north_m=0.0),
)


def test_with_a_known_heading_a_turned_path_shows_its_whole_error():
    survey = Survey(launch=Launch(heading_deg=90.0), tie_points=TIES)
    found = held_against(straight_track(heading_rad=0.1), survey, "madgwick")
    assert found.end_error_m == pytest.approx(2 * 100.0 * np.sin(0.05))  # the chord of 0.1 rad
    assert found.rms_m == pytest.approx(2 * np.sin(0.05) * np.sqrt((100.0**2 + 50.0**2) / 2))
    assert found.end_chainage_error_m == pytest.approx(0.0)
    assert not found.turned


def test_with_an_unknown_heading_the_direction_is_not_held_against_a_method():
    found = held_against(straight_track(heading_rad=2.0, scale=1.02), Survey(tie_points=TIES), "madgwick")
    assert found.turned
    assert found.end_error_m == pytest.approx(2.0)
    assert found.end_error_pct == pytest.approx(100.0 * 2.0 / 102.0)
    assert found.end_chainage_error_m == pytest.approx(2.0)
    assert found.position_w_m[-1] == pytest.approx([102.0, 0.0, 0.0], abs=1e-9)


def test_a_tie_point_that_is_switched_off_or_outside_the_run_tells_nothing():
    off = TiePoint("off", 100.0, chainage_m=7.0, east_m=0.0, north_m=0.0, enabled=False)
    late = TiePoint("late", 900.0, chainage_m=7.0, east_m=0.0, north_m=0.0)
    found = held_against(straight_track(), Survey(tie_points=(off, late)), "vqf")
    assert (found.end_error_m, found.rms_m, found.end_chainage_error_m, found.end_error_pct) == (None,) * 4


def test_the_length_of_the_pipe_tells_where_no_tie_point_does():
    found = held_against(straight_track(scale=1.1), Survey(pipe=PipeInfo(length_m=100.0)), "vqf")
    assert found.end_chainage_error_m == pytest.approx(10.0)


@pytest.fixture(scope="module")
def loop():
    return simulate(p1_loop(4), 3)


def test_free_paths_of_a_loop_end_near_their_start_whatever_the_tie_points_say(loop):
    wrong = TiePoint("wrong", float(loop.imu.time_s[-1]), chainage_m=5.0)  # must not pull
    survey = Survey(
        launch=Launch(heading_deg=90.0), device=DeviceInfo(radius_m=loop.scenario.ball.radius_m), tie_points=(wrong,)
    )
    heard = []
    methods = [("madgwick", "auto"), ("offline_vqf", "auto")]
    settings = Settings(orientation=OrientationSettings(magnetometer="ignore"))  # as in the paper
    found = compare(loop.imu, survey, settings, methods, silent(), heard.append)
    assert [(c.orientation, c.position) for c in found] == [("madgwick", "rolling"), ("offline_vqf", "rolling")]
    assert tuple(heard) == found
    way = P1_LOOPS[4][2]
    for compared in found:
        assert compared.length_m == pytest.approx(way, rel=0.05)
        end = compared.position_w_m[-1] - compared.position_w_m[0]
        assert np.hypot(end[0], end[1]) < 0.02 * way
        assert compared.end_chainage_error_m == pytest.approx(way - 5.0, rel=0.06)


def test_a_method_that_cannot_work_is_listed_with_its_trouble(loop):
    survey = Survey(device=DeviceInfo(radius_m=0.05))
    (found,) = compare(loop.imu, survey, Settings(), [("no such method", "auto")], silent())
    assert found.trouble is not None
    assert found.trouble.code is ErrorCode.SETTING_INVALID


def test_the_operator_can_stop_it(loop):
    stop = threading.Event()
    stop.set()
    with pytest.raises(Cancelled):
        compare(loop.imu, Survey(), Settings(), [("vqf", "auto")], Progress(is_cancelled=stop.is_set))
