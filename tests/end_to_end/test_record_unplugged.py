"""Devices that are pulled out, stall and talk rubbish while they are recorded, on real wires, with real sound."""

import json
import sys
import time
from contextlib import ExitStack

import numpy as np
import pytest
import soundfile
from fake_devices import noise
from wired_ball import WiredBall

from app.batch import process_folder
from app.devices.audio_spec import AudioChoice
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Recorder
from app.devices.recording_plan import RecordingPlan
from processing.importing.frames import FrameDecoder
from processing.live.stream import LinkState, RecordingState
from processing.progress import silent
from processing.survey import Survey

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="pseudo-terminals and a virtual sound card"
)

RATE_HZ, CHANNELS = 48_000, 2
PATIENCE_S = 30.0
SHOUT_S = 10


def wait_until(condition, what):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, f"in vain: {what}"
        time.sleep(0.01)


@pytest.fixture
def unlucky(sound_server, tmp_path):
    """A recording in which everything happens that can happen to a device; its folder, ball, status and shouts."""
    shouts = []
    for seed in (1, 2):
        shouts.append(noise(SHOUT_S * RATE_HZ, CHANNELS, seed=seed))
        soundfile.write(tmp_path / f"{seed}.wav", shouts[-1], RATE_HZ, subtype="PCM_24")
    plan = RecordingPlan(
        Survey(),
        tmp_path / "run",
        AudioChoice(rate_hz=RATE_HZ, channels=CHANNELS),
        parse_imu_spec(f"serial:{tmp_path / 'ball'}"),
    )
    with ExitStack() as stack:
        ball = stack.enter_context(WiredBall(tmp_path / "ball"))
        recorder = stack.enter_context(Recorder(plan))
        recorder.open()

        def state():
            status = recorder.status()
            return status.motion.state, status.sound.state

        def told(code):
            return any(finding.code == code for finding in recorder.status().findings)

        live = LinkState.LIVE
        wait_until(lambda: state() == (live, live), "both alive")
        folder = recorder.start()
        sound_server.play(tmp_path / "1.wav")
        time.sleep(1.0)
        ball.say(bytes(range(128)) * 8)
        ball.is_stalled = True
        sound_server.unload_sink()
        wait_until(lambda: told("recorder_imu_silent"), "the ball is silent")
        ball.is_stalled = False
        wait_until(lambda: state()[0] is live, "the ball speaks again")
        ball.unplug()
        wait_until(lambda: state() == (LinkState.LOST, LinkState.LOST), "both gone")
        sound_server.load_sink()
        ball.plug()
        wait_until(lambda: state() == (live, live), "both are back")
        wait_until(lambda: told("recorder_sound_back") and told("recorder_imu_back"), "their return is told")
        sound_server.play(tmp_path / "2.wav")
        time.sleep(1.2)
        recorder.stop()
        yield folder, ball, recorder.status(), shouts


def runs_of_sound(sound):
    """Return where it is not silent, as pairs of first frame and the one behind the last."""
    edges = np.flatnonzero(np.diff(sound.any(axis=1), prepend=False, append=False))
    return edges.reshape(-1, 2).tolist()


def test_whatever_happens_to_the_devices_all_that_came_is_there_and_the_gaps_are_told(unlucky, tmp_path):
    folder, ball, status, shouts = unlucky
    original = folder / "recordings" / "1" / "original"
    assert status.state is RecordingState.STOPPED

    sound = soundfile.read(original / "audio-001.wav", dtype="int32")[0]
    runs = runs_of_sound(sound)
    assert len(runs) == 2, "what was played before the input was gone, silence, and what was played afterwards"
    for (first, end), shout in zip(runs, shouts, strict=True):
        assert end - first > RATE_HZ // 2
        (at,) = np.flatnonzero((shout == sound[first]).all(axis=1))
        np.testing.assert_array_equal(sound[first:end], shout[at : at + end - first])
    assert status.sound.gaps >= 1
    assert len(sound) == status.sound.frames + status.sound.lost_frames

    motion = FrameDecoder().feed((original / "imu-001.lkf").read_bytes())
    numbers = {row.tobytes(): number for number, row in enumerate(ball.frames.acc_s_mps2)}
    which = np.array([numbers[row.tobytes()] for row in motion.acc_s_mps2])
    assert (np.diff(which) > 0).all(), "each once, in order"
    assert np.count_nonzero(np.diff(which) > 1) == 2, (
        "missing while it was stalled and while it was unplugged, else never"
    )
    span = np.arange(which[0], which[-1] + 1)
    on_the_wire = np.setdiff1d(span[ball.sent[span]], which)
    assert len(on_the_wire) < 400, "what was on the wire when it was cut, or before it was opened again"
    np.testing.assert_array_equal(motion.gyr_s_radps, ball.rows(which).gyr_s_radps)
    # no clock of the ball began anew, so that its own times stand, over every gap
    np.testing.assert_array_equal(np.diff(motion.time_us), np.diff(ball.frames.time_us[which]))
    assert status.motion.lost == which[-1] - which[0] + 1 - len(which)
    assert status.motion.garbage_bytes >= 1024

    lines = [json.loads(line) for line in (original / "recording.jsonl").read_text(encoding="utf-8").splitlines()]
    events = {line["event"] for line in lines}
    assert {"started", "sound_gap", "motion_gap", "motion_state", "sound_state", "motion_garbage", "stopped"} <= events
    codes = {finding.code for finding in status.findings}
    assert {"recorder_imu_silent", "recorder_imu_lost", "recorder_imu_back", "recorder_imu_gap"} <= codes
    assert {"recorder_sound_lost", "recorder_sound_back", "recorder_imu_garbage"} <= codes

    results = process_folder(folder, tmp_path / "out", [], "en", silent())
    # the sound is told where it is missing by its gaps, which become stretches when its clock is known
    assert {stretch.channel for stretch in results.not_assessed} >= {"path", "sound"}
