"""The simulated ball's sound keeps its own clock, is lost while the microphone is unplugged, and fits its motion."""

import json
import sys
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
import sound_server as helper

from app.devices.simulated.faults import Fault, FaultKind
from app.devices.simulated.player import TapePlayer
from app.devices.simulated.sound_out import open_out
from app.devices.simulated.sound_server import SoundServer
from app.devices.simulated.source import ScenarioTape, Wanted, open_ball
from processing.errors import ErrorCode, LeaklineError
from processing.progress import silent
from processing.simulation.run import simulate
from processing.simulation.scenario import PipeRoute
from processing.simulation.scenario_file import read_scenario, to_mapping
from processing.simulation.scenarios import load_scenario

DEADLINE_S = 10.0


class CountingTape:
    rate_hz, channels = 1000, 1

    def __init__(self, frames):
        self._frames, self._at = frames, 0

    def read(self, count):
        count = min(count, self._frames - self._at)
        self._at += count
        return np.arange(self._at - count, self._at, dtype=np.float32)[:, None]

    def rewind(self):
        self._at = 0

    def close(self):
        pass


class ListOut:
    sets_pace = False

    def __init__(self):
        self.sound, self.said = [], []

    def write(self, frames):
        self.sound += frames[:, 0].tolist()
        return len(frames)

    def unplug(self):
        self.said.append("unplug")

    def replug(self):
        self.said.append("replug")

    def close(self):
        self.said.append("close")


def played(frames, until, **words):
    out = ListOut()
    player = TapePlayer(CountingTape(frames), out, **words)
    began = time.monotonic()
    player.start(began)
    deadline = began + DEADLINE_S
    while not until(out) and time.monotonic() < deadline:
        time.sleep(0.01)
    player.stop()
    assert player.error is None
    return out, time.monotonic() - began


def test_a_card_that_runs_fast_takes_more_frames_but_none_before_its_time():
    out, took = played(10_000, lambda out: len(out.sound) >= 400, drift_ppm=50_000)
    assert out.sound == list(range(len(out.sound)))
    assert 400 <= len(out.sound) <= took * 1050
    assert out.said == ["close"]


def test_sound_while_the_microphone_is_unplugged_is_lost_and_time_goes_on():
    fault = Fault(FaultKind.AUDIO_UNPLUG, 0.1, 0.2)
    out, _ = played(600, lambda out: out.sound[-1:] == [599], faults=(fault,))
    steps = np.flatnonzero(np.diff(out.sound) != 1)
    assert len(steps) == 1
    before, after = out.sound[steps[0]], out.sound[steps[0] + 1]
    assert 99 <= before <= 110
    assert after >= 300
    assert out.said == ["unplug", "replug", "close"]


def test_a_lap_longer_than_the_sound_ends_in_silence_and_begins_anew():
    out, _ = played(50, lambda out: len(out.sound) >= 200, lap_s=0.08)
    assert out.sound[:160] == [*range(50), *[0] * 30] * 2


@pytest.fixture(scope="module")
def short():
    long = load_scenario("rolling")
    return replace(
        long,
        route=PipeRoute(((0.0, 0.0, 0.0), (0.0, 9.0, 0.0)), bend_radius_m=0.9),
        sound=replace(long.sound, rate_hz=8000, local=()),
        drive=replace(long.drive, rest_start_s=3.0, rest_end_s=2.0, stops=()),
        markers=(),
    )


def test_a_scenarios_second_channel_is_the_first_turned_over_and_it_can_be_rewound(short):
    tape = ScenarioTape(simulate(short, 1).sound, 2)
    first = tape.read(20_000)
    assert first.shape == (20_000, 2)
    assert np.array_equal(first[:, 0], -first[:, 1])
    assert first.std() > 0
    assert np.array_equal(first * 32768, np.round(first * 32768)), "16 bits, so that nothing is rounded on its way"
    tape.rewind()
    again = np.concatenate([tape.read(7_000), tape.read(13_000)])
    assert np.array_equal(again, first)


def test_a_scenarios_clocks_are_as_far_apart_as_it_is_told(short, tmp_path):
    """A sound clock 1000 ppm fast against the IMU's has 1000 ppm more frames for the same run."""
    file = tmp_path / "short.json"
    file.write_text(json.dumps(to_mapping(short)), encoding="utf-8")
    assert read_scenario(file).sound.rate_hz == 8000
    lengths = []
    for ppm in (0.0, 1000.0):
        ball = open_ball(str(file), Wanted(rate_hz=50.0, clock_ppm=ppm), tmp_path, silent())
        count = 0
        while block := len(ball.sound.read(8000)):
            count += block
        lengths.append(count)
        assert ball.imu.sample_rate_hz == pytest.approx(50.0, rel=1e-3)
    assert lengths[1] / lengths[0] == pytest.approx(1.001, abs=2e-5)


@pytest.mark.skipif(helper.why_missing() is not None, reason=str(helper.why_missing()))
def test_our_servers_microphone_goes_and_comes_back_and_all_ends_with_it():
    with SoundServer(48_000, 2) as server:
        out = open_out("none", server, 48_000, 2)
        # nobody records: writing never waits, and what is old is forgotten
        heard = [out.write(np.ones((480, 2), np.float32)) for _ in range(500)]
        assert heard == [0] * 500
        assert out._waiting_bytes() == 480 * 8
        assert server._pactl("list", "short", "sources")
        out.unplug()
        assert not server.pipe.exists()
        assert out.write(np.ones((480, 2), np.float32)) == 0
        out.replug()
        assert server.pipe.exists()
        out.close()
        process, folder = server._server, server._folder
    assert process.poll() is not None
    assert not folder.exists()


@pytest.mark.skipif(helper.why_missing() is not None, reason=str(helper.why_missing()))
def test_a_sink_of_a_running_server_takes_the_sound(sound_server):
    out = open_out(helper.SINK, None, 48_000, 1)
    player = TapePlayer(CountingTape(10_000), out)
    player.start(time.monotonic())
    deadline = time.monotonic() + DEADLINE_S
    try:
        while "pacat" not in sound_server.control("list", "sink-inputs") and time.monotonic() < deadline:
            time.sleep(0.05)
        assert "pacat" in sound_server.control("list", "sink-inputs")
    finally:
        player.stop()
    assert player.error is None
    assert "simulated sound" not in {thread.name for thread in threading.enumerate()}


@pytest.mark.skipif(sys.platform != "linux", reason="pacat")
def test_a_sink_that_is_none_is_said(monkeypatch, tmp_path):
    monkeypatch.setenv("PULSE_SERVER", f"unix:{tmp_path / 'none'}")
    if helper.why_missing() is not None:
        pytest.skip(str(helper.why_missing()))
    out = open_out("nothing", None, 48_000, 1)
    player = TapePlayer(CountingTape(10_000_000), out)
    player.start(time.monotonic())
    deadline = time.monotonic() + DEADLINE_S
    while player.error is None and time.monotonic() < deadline:
        time.sleep(0.02)
    player.stop()
    assert isinstance(player.error, LeaklineError)
    assert player.error.code is ErrorCode.SIMULATED_SOUND_FAILED


def test_a_file_that_cannot_be_written_is_said(tmp_path):
    with pytest.raises(LeaklineError) as caught:
        open_out(f"wav:{tmp_path / 'no' / 'such' / 'folder.wav'}", None, 48_000, 1)
    assert caught.value.code is ErrorCode.CANNOT_WRITE
