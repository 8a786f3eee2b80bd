"""A recorder with devices that do as told, and what lies on the disc when it has recorded."""

import json
import time
from functools import partial

import numpy as np
import soundfile
from fake_devices import RATE_HZ, FakeInput, FakeLink, motion, sent

from app.devices.audio_spec import parse_audio_spec
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Makers, Recorder
from app.devices.recording_plan import RecordingPlan
from processing.importing.frames import FrameDecoder
from processing.storage.folder import SurveyFolder
from processing.storage.recording_writer import RecordingWriter
from processing.survey import Survey, SurveyInfo

PATIENCE_S = 10.0
SMALL = partial(RecordingWriter.create, reserve_bytes=1 << 20)


def wait_until(condition):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, "it did not happen in time"
        time.sleep(0.005)


class Bench:
    """A recorder with its fake devices; motion is sent on a clock of its own that the test moves."""

    def __init__(self, target, sound="default", imu="tcp:ball:1", **plan):
        self.inputs, self.links = [], []
        self.rate_hz = RATE_HZ
        plan = {"survey": Survey(SurveyInfo(name="Gül Sokağı")), "target": target} | plan
        choices = {"sound": parse_audio_spec(sound), "motion": None if imu == "none" else parse_imu_spec(imu)}
        self.recorder = Recorder(RecordingPlan(**plan, **choices), Makers(self._input, self._link, SMALL), drain_s=0.0)
        self.begun_s = time.monotonic()
        self.sent = 0

    def _input(self, choice, on_block):
        self.inputs.append(FakeInput(choice, on_block, self.rate_hz))
        return self.inputs[-1]

    def _link(self, choice, on_bytes, on_state):
        self.links.append(FakeLink(choice, on_bytes, on_state))
        return self.links[-1]

    @property
    def mic(self):
        return self.inputs[-1]

    @property
    def ball(self):
        return self.links[-1]

    def move(self, count=40, skip=0, **form):
        """Send samples, and wait until they are taken in; their times go on by what is skipped."""
        frames = motion(count, self.sent + skip, **form)
        before = self.recorder.status().motion
        self.sent += skip + count
        self.ball.give(sent(frames), self.begun_s + self.sent / 400.0)
        wait_until(lambda: self.recorder.status().motion.samples >= before.samples + count)
        return frames

    def codes(self):
        return [finding.code for finding in self.recorder.status().findings]


def sound_of(folder):
    files = sorted((folder / "recordings" / "1" / "original").glob("audio-*.wav"))
    return np.concatenate([soundfile.read(file, dtype="int32", always_2d=True)[0] for file in files])


def motion_of(folder):
    files = sorted((folder / "recordings" / "1" / "original").glob("imu-*.lkf"))
    return FrameDecoder().feed(b"".join(file.read_bytes() for file in files))


def journal_of(folder):
    lines = (folder / "recordings" / "1" / "original" / "recording.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def values_of(folder, event):
    return [line["values"] for line in journal_of(folder) if line["event"] == event]


def ties_of(folder):
    with SurveyFolder.open(folder, read_only=True) as opened:
        return opened.read_survey().tie_points
