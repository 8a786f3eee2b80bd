"""The spoken check: it asks in turn, says every light, keeps the sheet, and then lets the feed go."""

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from app.devices.audio_spec import AudioChoice
from app.devices.imu_spec import parse_imu_spec
from app.devices.live_feed import LiveFeed
from app.devices.recording_plan import RecordingPlan
from app.recording_check import SpokenCheck
from app.recording_terminal import Terminal
from processing.live.check_sheet import Light
from processing.live.stream import LinkState, MotionBlock, MotionStatus, RecordingStatus, SoundBlock, SoundStatus
from processing.survey import DeviceInfo, ImuSamples, Survey

RATE_HZ = 8000


class Recorded:
    """What the check sees of a recorder: a ball at rest and a quiet microphone, a second at each look."""

    def __init__(self, *, still):
        self.feed, self.sheets, self.now, self._still = LiveFeed(), [], 0.0, still
        self._random = np.random.default_rng(3)

    def monotonic(self):
        return self.now

    def pass_a_second(self):
        shape = (100, 3)
        sway = 0.001 if self._still else 2.0
        imu = ImuSamples(
            self.now + np.arange(100) / 100.0,
            np.array([0.0, 0.0, 9.81]) + 0.01 * self._random.standard_normal(shape),
            sway * self._random.standard_normal(shape),
            np.ones(100, bool),
        )
        self.feed.add(MotionBlock(imu, self.now + 1.0))
        frames = (self._random.standard_normal((RATE_HZ, 1)) * 1e-3 * 2**31).astype(np.int32)
        self.feed.add(SoundBlock(frames, int(self.now * RATE_HZ), self.now))
        self.now += 1.0

    def status(self):
        sound = SoundStatus(
            LinkState.LIVE, "mic", RATE_HZ, 1, int(self.now * RATE_HZ), rms_db=(-60.0,), peak_db=(-48.0,),
            held_peak_db=(-47.0,), clipped=(False,),
        )  # fmt: skip
        motion = MotionStatus(LinkState.LIVE, "ball", "frames", 100.0, int(self.now * 100))
        return RecordingStatus(sound=sound, motion=motion)

    def keep_sheet(self, sheet):
        self.sheets.append(sheet)


def checked(monkeypatch, *, still, language="en"):
    out = io.StringIO()
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: False))
    recorded = Recorded(still=still)
    survey = Survey(device=DeviceInfo(radius_m=0.05))
    plan = RecordingPlan(survey, Path("run"), AudioChoice(), parse_imu_spec("tcp:ball:1"))
    check = SpokenCheck(recorded, plan, Terminal(language), recorded.monotonic)
    looks = 0
    while check.look():
        recorded.pass_a_second()
        looks += 1
        assert looks < 100, "it never ends"
    return recorded, out.getvalue().splitlines()


def test_it_asks_for_silence_rest_and_knocks_in_turn_and_says_every_light(monkeypatch):
    recorded, said = checked(monkeypatch, still=True)
    asked = [line for line in said if line.startswith("> ")]
    assert [line[2:14] for line in asked] == ["Listening to", "Lay the devi", "Knock on it ", "The check is"]
    (sheet,) = recorded.sheets
    lights = {item.key: item.light for item in sheet.items}
    assert (lights["rest"], lights["gravity"], lights["motion"]) == (Light.GREEN,) * 3
    assert len([line for line in said if line.startswith("  [")]) == len(sheet.items)
    assert any(line.startswith("  [good] Gravity: 9.81 m/s²") for line in said)
    assert recorded.now < 60.0


def test_nobody_knocked_and_that_is_said(monkeypatch):
    recorded, _ = checked(monkeypatch, still=True)
    knocks = next(item for item in recorded.sheets[0].items if item.key == "knocks")
    assert knocks.light is not Light.GREEN


def test_a_ball_that_is_not_laid_down_is_told_and_does_not_hold_up_the_run(monkeypatch):
    recorded, said = checked(monkeypatch, still=False)
    assert "> It moved. Lay it down and do not touch it." in said
    rest = next(item for item in recorded.sheets[0].items if item.key == "rest")
    assert rest.light is not Light.GREEN


def test_afterwards_nothing_waits_in_the_feed(monkeypatch):
    recorded, _ = checked(monkeypatch, still=True)
    recorded.pass_a_second()
    assert recorded.feed.take() == ()


@pytest.mark.parametrize("language", ["en", "tr"])
def test_it_speaks_both_languages(monkeypatch, language):
    _, said = checked(monkeypatch, still=True, language=language)
    assert ("Yerçekimi" in "\n".join(said)) == (language == "tr")
