"""All kinds of evidence together on one simulated run: each is told, true, and can be switched off."""

import dataclasses
from functools import cache

import numpy as np
import pytest

from processing.messages import LANGUAGES, finding_sentence, text
from processing.orientation.registry import estimate_attitude
from processing.position.evidence import Evidence
from processing.position.gathering import gather, gather_on_route
from processing.position.registry import reckon
from processing.progress import silent
from processing.settings import OrientationSettings, PositionSettings
from processing.simulation.run import simulate
from processing.simulation.scenario import (
    Ball,
    Drive,
    Imu,
    Joints,
    Knocks,
    Marker,
    Paperwork,
    PipeRoute,
    Scenario,
    Slide,
    Sound,
)
from processing.survey import Motion

SETTINGS = PositionSettings()


@cache
def rolled():
    scenario = Scenario(
        name="evidence",
        route=PipeRoute(((0.0, 0, 0), (40.0, 0, 0.5), (60.0, 30.0, 1.0), (110.0, 20.0, 0.0), (110.0, 60.0, 0.0)), 1.0),
        drive=Drive(0.7),
        ball=Ball(0.0475, slip=0.015, slip_sigma=0.01, spin_sigma_radps=0.3, slides=(Slide(70.0, 78.0),)),
        imu=Imu(rate_hz=100.0),
        sound=Sound(enabled=False, joints=Joints(6.0, 0.03), knocks=Knocks(stray_per_minute=2.0)),
        markers=(Marker("retrieval", sigma_m=0.1),),
        paperwork=Paperwork(tell_route=True, route_sigma_m=0.1),
    )
    made = simulate(scenario, 3)
    attitude, _, _ = estimate_attitude(made.imu, made.survey, OrientationSettings(), silent())
    return made, attitude, reckon(made.imu, attitude, made.survey, SETTINGS, silent())


def everything(settings=SETTINGS, survey=None):
    made, attitude, reckoned = rolled()
    survey = survey or made.survey
    found = gather(made.imu, attitude, reckoned, survey, settings, silent())
    return gather_on_route(reckoned, survey, settings, silent(), found)


def truly(time_s):
    motion = rolled()[0].motion
    return np.interp(time_s, motion.time_s, motion.chainage_m)


def test_every_kind_is_found_and_true():
    found = everything()
    codes = [f.code for f in found.findings]
    assert codes == ["slips_found", "joints_counted", "joints_standard", "pressure_used", "bends_recognised"]
    for fix in found.fixes:
        assert abs(fix.chainage_m - truly(fix.time_s)) < 3.0 * np.hypot(fix.sigma_m, fix.shared_sigma_m)
    assert len(found.fixes) == 2  # the third bend lies within the slide
    length = np.array([i.length_m for i in found.increments])
    true = np.array([truly(i.end_s) - truly(i.start_s) for i in found.increments])
    sigma = np.array([i.sigma_m for i in found.increments])
    scale = np.mean(true / length)  # the pipes' length was not told
    assert np.mean(np.abs(scale * length - true) < 1.96 * sigma) >= 0.9
    (slide,) = found.slips
    assert truly(slide.start_s) == pytest.approx(70.0, abs=1.5)
    assert truly(slide.end_s) == pytest.approx(78.0, abs=1.5)
    assert len(found.heights) == 1


def test_each_kind_can_be_switched_off():
    off = dataclasses.replace(SETTINGS, bends="off", joints="off", pressure="off", slips="off")
    assert everything(off) == Evidence()
    for kind, part in (("bends", "fixes"), ("joints", "increments"), ("pressure", "heights"), ("slips", "slips")):
        some = everything(dataclasses.replace(SETTINGS, **{kind: "off"}))
        assert [len(getattr(some, p)) > 0 for p in ("fixes", "increments", "heights", "slips")] == [
            p != part for p in ("fixes", "increments", "heights", "slips")
        ]


def test_a_device_on_a_foot_has_no_joints_no_slips_and_no_water_above_it():
    made, attitude, reckoned = rolled()
    device = dataclasses.replace(made.survey.device, motion=Motion.FOOT)
    survey = dataclasses.replace(made.survey, device=device)
    assert gather(made.imu, attitude, reckoned, survey, SETTINGS, silent()) == Evidence()


def test_a_ball_of_unknown_radius_finds_the_bends_through_the_known_end():
    made, _, reckoned = rolled()
    unknown = dataclasses.replace(
        reckoned,
        chainage_m=1.3 * reckoned.chainage_m,
        position_w_m=1.3 * reckoned.position_w_m,
        speed_mps=1.3 * reckoned.speed_mps,
        scale_sigma=0.5,
    )
    slips = Evidence(slips=everything().slips)
    found = gather_on_route(unknown, made.survey, SETTINGS, silent(), slips)
    assert len(found.fixes) == 2
    for fix in found.fixes:
        assert abs(fix.chainage_m - truly(fix.time_s)) < 3.0 * np.hypot(fix.sigma_m, fix.shared_sigma_m)


def changed(change):
    made, _, reckoned = rolled()
    points = tuple(tuple(change(np.array(p))) for p in made.survey.route.points)
    survey = dataclasses.replace(made.survey, route=dataclasses.replace(made.survey.route, points=points))
    return gather_on_route(reckoned, survey, SETTINGS, silent(), Evidence(slips=everything().slips))


@pytest.mark.parametrize(
    "change",
    [lambda p: p - [12.0, 0.0, 0.0], lambda p: p * 1.06, lambda p: p * [1.0, -1.0, 1.0]],
    ids=["shifted", "stretched", "mirrored"],
)
def test_a_wrong_map_gives_no_fixes_and_a_warning(change):
    found = changed(change)
    assert found.fixes == ()
    assert len(found.findings) == 1
    assert found.findings[0].code in {"bends_shifted", "bends_against_ties", "bends_mirrored", "bends_not_recognised"}


def test_the_right_map_passes():
    assert len(changed(lambda p: p).fixes) == 2


def test_without_a_route_nothing_is_added():
    made, _, reckoned = rolled()
    known = Evidence(fixes=())
    survey = dataclasses.replace(made.survey, route=None)
    assert gather_on_route(reckoned, survey, SETTINGS, silent(), known) is known


@pytest.mark.parametrize("language", LANGUAGES)
def test_everything_is_said_in_plain_words(language):
    found = everything()
    for finding in found.findings:
        assert "{" not in finding_sentence(finding, language)
    for span in found.slips:
        assert text("reasons", span.reason, language)
