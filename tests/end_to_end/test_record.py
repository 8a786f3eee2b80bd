"""``leakline record`` with the real stack: pseudo-terminals, a sound server, the disc; marked, killed, out of room."""

import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
import soundfile
from fake_devices import noise
from wired_ball import WiredBall

from app.batch import process_folder
from processing.importing.frames import FrameDecoder
from processing.progress import silent
from processing.storage.folder import SurveyFolder

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="pseudo-terminals and a virtual sound card"
)

RATE_HZ, CHANNELS = 48_000, 2
PATIENCE_S = 40.0
RECORD_S = 4.0
SHOUT_S = 30
# the writer's reserve and what it sets aside, a survey, and three seconds of sound
SMALL_DISC = (64 << 20) + (8 << 20) + (1_600 << 10)


def leakline(*words):
    return [sys.executable, "-m", "app", *map(str, words)]


@dataclass
class Runs:
    """What the recordings left behind: folders, what they said, how they ended."""

    ball: WiredBall
    marked: Path
    marked_said: str
    marked_status: int
    killed_ball: WiredBall
    killed: Path
    full: Path | None
    full_said: str
    full_status: int


class TypedAt:
    """A program on a terminal of its own."""

    def __init__(self, command, environment):
        self._screen, theirs = pty.openpty()
        try:
            self.process = subprocess.Popen(
                command,
                env=environment | {"TERM": "xterm"},
                stdin=theirs,
                stdout=theirs,
                stderr=theirs,
                start_new_session=True,
            )
        finally:
            os.close(theirs)
        self.text = ""

    def read_until(self, word, patience_s=PATIENCE_S):
        until = time.monotonic() + patience_s
        while word not in self.text:
            assert time.monotonic() < until, f"it never said {word!r}: {self.text}"
            if select.select([self._screen], [], [], 0.1)[0]:
                with suppress(OSError):  # EIO: it has ended
                    self.text += os.read(self._screen, 65536).decode()

    def type(self, line):
        os.write(self._screen, line.encode() + b"\n")

    def close(self):
        self.process.kill()
        self.process.wait(PATIENCE_S)
        os.close(self._screen)


@pytest.fixture(scope="module")
def shout(tmp_path_factory):
    """Half a minute of noise in which every frame is another one."""
    file = tmp_path_factory.mktemp("shout") / "shout.wav"
    soundfile.write(file, noise(SHOUT_S * RATE_HZ, CHANNELS), RATE_HZ, subtype="PCM_24")
    return file


@pytest.fixture(scope="module")
def runs(_sound_server, shout, tmp_path_factory):
    """Three recordings at the same time: one on a terminal, one that is killed, one whose disc is too small."""
    folder = tmp_path_factory.mktemp("runs")
    _sound_server.write_asound()
    _sound_server.start()
    _sound_server.reform(RATE_HZ, CHANNELS)
    environment = _sound_server.environment
    audio = ("--audio", f"default@{RATE_HZ},channels={CHANNELS}")
    with ExitStack() as stack:
        stack.callback(_sound_server.end_players)
        ball = stack.enter_context(WiredBall(folder / "ball"))
        killed_ball = stack.enter_context(WiredBall(folder / "killed-ball"))
        words = ("record", "--imu", f"serial:{ball.link}", *audio, "--out", folder / "marked", "--name", "Gül Sokağı")
        marked = TypedAt(leakline(*words, "--radius", "0.05", "--wait", PATIENCE_S), environment)
        stack.callback(marked.close)
        words = ("record", "--imu", f"serial:{killed_ball.link}", *audio, "--out", folder / "killed.leakline")
        killed = TypedAt(leakline(*words, "--wait", PATIENCE_S), environment)
        stack.callback(killed.close)
        full = _on_a_small_disc(folder, audio, environment)
        stack.callback(_end, full)
        marked.read_until("Recording to")
        begun_s = time.monotonic()
        _sound_server.play(shout)
        time.sleep(1.0)
        marked.type("vana 12")
        marked.read_until("Marked 'vana 12'")
        marked.type("wrong")
        marked.read_until("Marked 'wrong'")
        marked.type("-")
        marked.read_until("Took 'wrong' back")
        marked.type("")
        marked.read_until("Marked 'mark 2'")
        killed.read_until("Recording to")
        time.sleep(max(2.5, begun_s + RECORD_S - time.monotonic()))
        killed.process.kill()
        marked.process.send_signal(signal.SIGINT)
        marked.read_until("Recorded 0:00:")
        status = marked.process.wait(PATIENCE_S)
        full_said, full_status = "", 0
        if full is not None:
            full_said = full.communicate(timeout=PATIENCE_S)[0]
            full_status = full.returncode
        yield Runs(
            ball,
            folder / "marked.leakline",
            marked.text,
            status,
            killed_ball,
            folder / "killed.leakline",
            folder / "full.leakline" if full is not None else None,
            full_said,
            full_status,
        )


def _on_a_small_disc(folder, audio, environment):
    """Begin to record on a disc in memory that is full in seconds, and copy from it what was recorded."""
    disc = folder / "disc"
    disc.mkdir()
    mount = ["unshare", "-rm", "sh", "-c"]
    mounted = f'mount -t tmpfs -o size={SMALL_DISC} none "$0"'
    if subprocess.run([*mount, mounted, disc], capture_output=True, check=False, timeout=PATIENCE_S).returncode != 0:
        return None
    script = f'{mounted} && "$@"; status=$?; cp -r "$0/full.leakline" "{folder}"; exit $status'
    words = leakline("record", *audio, "--out", disc / "full", "--wait", PATIENCE_S, "--seconds", "60")
    return subprocess.Popen(
        [*mount, script, disc, *words],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def _end(process):
    if process is None:
        return
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)  # the shell and what it started
    if not process.stdout.closed:
        process.communicate(timeout=PATIENCE_S)


def sound_of(folder):
    return soundfile.read(folder / "recordings" / "1" / "original" / "audio-001.wav", dtype="int32")[0]


def motion_of(folder):
    return FrameDecoder().feed((folder / "recordings" / "1" / "original" / "imu-001.lkf").read_bytes())


def events_of(folder):
    lines = (folder / "recordings" / "1" / "original" / "recording.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line)["event"] for line in lines]


def assert_it_is_the_shout(sound):
    """Silence, then every frame of the shout, one after the other, to the last bit."""
    shouted = noise(SHOUT_S * RATE_HZ, CHANNELS)
    begins = int(np.argmax(sound.any(axis=1)))
    heard = sound[begins:]
    assert len(heard) > RATE_HZ
    (at,) = np.flatnonzero((shouted == heard[0]).all(axis=1))
    np.testing.assert_array_equal(heard, shouted[at : at + len(heard)])


def assert_it_is_what_the_ball_sent(motion, ball):
    """Every sample from the first to the last, as it was sent."""
    first = int(np.flatnonzero((ball.frames.acc_s_mps2 == motion.acc_s_mps2[0]).all(axis=1))[0])
    which = np.arange(first, first + len(motion))
    assert ball.sent[which].all()
    sent = ball.rows(which)
    np.testing.assert_array_equal(motion.acc_s_mps2, sent.acc_s_mps2)
    np.testing.assert_array_equal(motion.gyr_s_radps, sent.gyr_s_radps)
    np.testing.assert_array_equal(np.diff(motion.time_us), np.diff(sent.time_us))


def test_a_recording_on_a_terminal_loses_nothing_and_ends_with_ctrl_c(runs):
    assert runs.marked_status == 0
    said = re.findall(
        r"sound ([\d.]+) s, lost ([\d.]+) s; IMU (\d+) samples, lost (\d+); (\d+) marks", runs.marked_said
    )
    assert len(said) == 1, runs.marked_said
    seconds, lost_s, samples, lost, marks = map(float, said[0])
    assert (lost_s, lost, marks) == (0.0, 0.0, 2.0)
    sound, motion = sound_of(runs.marked), motion_of(runs.marked)
    assert seconds == pytest.approx(len(sound) / RATE_HZ, abs=0.05)
    assert samples == len(motion)
    assert len(motion) / 400.0 > RECORD_S - 1.0
    assert_it_is_the_shout(sound)
    assert_it_is_what_the_ball_sent(motion, runs.ball)


def test_the_terminal_shows_how_it_goes_and_what_was_marked(runs):
    assert re.search(r"0:00:\d\d  IMU alive \d+ Hz, lost 0 \| sound alive -?\d+!? -?\d+!? dBFS", runs.marked_said)
    with SurveyFolder.open(runs.marked, read_only=True) as opened:
        survey = opened.read_survey()
    assert [tie.name for tie in survey.tie_points] == ["vana 12", "mark 2"]
    assert 0.5 < survey.tie_points[0].time_s < survey.tie_points[1].time_s < 60.0
    assert (survey.info.name, survey.device.radius_m) == ("Gül Sokağı", 0.05)


def test_what_was_recorded_is_processed_as_any_survey(runs, tmp_path):
    results = process_folder(runs.marked, tmp_path, [], "en", silent())
    assert (tmp_path / "report.pdf").stat().st_size > 0
    assert results.recording.imu.duration_s == pytest.approx(len(motion_of(runs.marked)) / 400.0, abs=0.1)
    assert results.recording.audio.frames == len(sound_of(runs.marked))
    assert results.recording.not_assessed == ()


def test_a_killed_recording_is_read_as_it_lies_there(runs, tmp_path):
    sound, motion = sound_of(runs.killed), motion_of(runs.killed)
    assert_it_is_what_the_ball_sent(motion, runs.killed_ball)
    assert_it_is_the_shout(sound)
    assert "stopped" not in events_of(runs.killed)
    results = process_folder(runs.killed, tmp_path, [], "en", silent())
    assert results.recording.audio.frames == len(sound)
    with SurveyFolder.open(runs.killed) as opened:  # the lock of the dead is taken over
        assert not opened.read_only


def test_a_full_disc_ends_the_recording_in_time_with_one_line_and_all_of_it_there(runs):
    if runs.full is None:
        pytest.skip("this system lets nobody but root mount a disc")
    assert runs.full_status == 2
    lines = runs.full_said.splitlines()
    assert lines[-1].startswith("leakline: ")
    assert "The disc is full" in lines[-1]
    assert any("was ended" in line for line in lines[:-1]), runs.full_said
    sound = sound_of(runs.full)
    assert len(sound) > RATE_HZ
    assert events_of(runs.full)[-1] == "stopped"
