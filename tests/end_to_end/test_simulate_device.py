"""`leakline simulate-device` as a developer or salesman starts it: two commands, no hardware, nothing left behind."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import psutil
import pytest
import serial
import sound_server
import soundfile

from app import cli
from processing.importing.frames import FrameDecoder

DEADLINE_S = 40.0
needs_linux = pytest.mark.skipif(sys.platform != "linux", reason="needs pseudo-terminals and signals")


class Device:
    """The command in a process of its own, which is dead at the end of the test with all its children."""

    def __init__(self, *words):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "app", "simulate-device", *map(str, words)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, encoding="utf-8",
        )  # fmt: skip
        self.lines, self._is_said = [], threading.Condition()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self.children = []

    def _read(self):
        for line in self.process.stdout:
            with self._is_said:
                self.lines.append(line.rstrip("\n"))
                self._is_said.notify_all()

    def told(self, word=""):
        """Wait for a line with a word in it."""
        with self._is_said:
            found = self._is_said.wait_for(lambda: any(word in line for line in self.lines), DEADLINE_S)
        assert found, (self.lines, self.process.poll())
        self.children = psutil.Process(self.process.pid).children(recursive=True)
        return next(line for line in self.lines if word in line)

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        return self.process.wait(DEADLINE_S)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait(DEADLINE_S)
        self._reader.join(5.0)
        self.process.stdout.close()
        self.process.stderr.close()
        for child in self.children:
            if child.is_running():
                child.kill()


@pytest.fixture
def device():
    """Return a function that starts the command."""
    started = []

    def start(*words):
        started.append(Device(*words))
        return started[-1]

    try:
        yield start
    finally:
        for one in started:
            one.__exit__()


@needs_linux
def test_a_recorded_folder_is_sent_over_a_terminal_and_ctrl_c_ends_it(device_folder, device, tmp_path):
    one = device(device_folder, "--imu", f"pty:{tmp_path / 'ball'}", "--truth", tmp_path / "truth", "--protocol", "csv")
    ready = json.loads(one.told("{"))
    assert ready["imu"] == f"serial:{tmp_path / 'ball'},protocol=csv"
    with serial.Serial(str(tmp_path / "ball"), 115200, timeout=1.0) as port:
        lines, until = b"", time.monotonic() + DEADLINE_S
        while lines.count(b"\n") < 50 and time.monotonic() < until:
            lines += port.read(max(1, port.in_waiting))
    assert one.end() == 0, one.process.stderr.read()
    assert one.process.stderr.read() == ""
    header, *rows = lines.decode().splitlines()[:40]
    written = (device_folder / "imu.csv").read_text(encoding="utf-8").splitlines()
    assert header.split(",")[:7] == written[0].split(",")[:7]
    sent = np.array([[float(cell) for cell in row.split(",")] for row in rows if not row.startswith("time_s")])
    source = np.array([[float(cell) for cell in row.split(",")] for row in written[1:60]])
    assert np.diff(sent[:, -1]).tolist() == [1.0] * (len(sent) - 1)
    first = int(sent[0, -1])
    np.testing.assert_allclose(sent[:, 1:7], source[first : first + len(sent), 1:7], rtol=1e-6)
    assert not (tmp_path / "ball").is_symlink()


@needs_linux
def test_the_sound_is_heard_bit_by_bit_and_the_server_goes_with_the_device(device_folder, device, tmp_path):
    if (reason := sound_server.why_missing()) is not None:
        pytest.skip(reason)
    one = device(device_folder, "--imu", "tcp:0", "--start-server", "--truth", tmp_path / "truth")
    ready = json.loads(one.told("{"))
    assert ready["audio"] == "default@8000"
    host, port = ready["imu"].removeprefix("tcp:").split(",")[0].split(":")
    record = (
        "import sys, sounddevice as s\n"
        "one = s.RawInputStream(samplerate=8000, channels=1, dtype='float32', latency=0.2)\n"
        "with one: data = b''.join(bytes(one.read(800)[0]) for _ in range(12))\n"
        "open(sys.argv[1], 'wb').write(data)"
    )
    with socket.create_connection((host, int(port)), DEADLINE_S) as peer:
        peer.settimeout(DEADLINE_S)
        words = [sys.executable, "-c", record, str(tmp_path / "heard")]
        subprocess.run(words, env={**os.environ, **ready["environment"]}, timeout=DEADLINE_S, check=True)
        found = FrameDecoder().feed(peer.recv(1 << 16))
    assert len(found)
    assert one.children
    assert one.end(signal.SIGTERM) == 0
    heard = np.fromfile(tmp_path / "heard", "<f4")
    played, _ = soundfile.read(tmp_path / "truth.wav", dtype="float32")
    assert len(heard) == 12 * 800
    # found by its first samples that are not silence, and then the same to the last
    first = int(np.flatnonzero(heard)[0])
    piece = heard[first : first + 32]
    starts = [k for k in np.flatnonzero(played == piece[0]) if np.array_equal(played[k : k + 32], piece)]
    assert len(starts) == 1
    assert np.array_equal(played[starts[0] : starts[0] + len(heard) - first], heard[first:])
    _, alive = psutil.wait_procs(one.children, DEADLINE_S)
    assert not alive
    assert not Path(ready["environment"]["ALSA_CONFIG_PATH"]).exists()


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["nowhere"], "no scenario"),
        (["rolling", "--imu", "usb"], "--imu"),
        (["rolling", "--faults", "flood@3"], "flood@3"),
        (["rolling", "--audio", "wav"], "--audio"),
        (["rolling", "--audio", "none", "--speed", "0"], "above 0"),
        (["rolling", "--audio", "vsink", "--speed", "2"], "--speed"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(words, told, capsys):
    try:
        status = cli.run(["simulate-device", *words])
    except SystemExit as ended:
        status = ended.code
    error = capsys.readouterr().err
    assert status == 2
    assert told in error
    assert error.count("\n") == 1


def test_it_ends_by_itself_after_the_seconds_it_was_told(device_folder, capsys, tmp_path):
    words = ["--imu", "tcp:0", "--no-wait", "--seconds", "0.3", "--faults", "lost@0.1,drift=40"]
    truth = tmp_path / "truth"
    assert cli.run(["--language", "tr", "simulate-device", str(device_folder), *words, "--truth", str(truth)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert json.loads(lines[0])["imu_rate_hz"] == pytest.approx(100.0, rel=0.01)
    assert any("örnekler kayboluyor" in line for line in lines)
    kinds = [json.loads(line)["what"] for line in truth.read_text(encoding="utf-8").splitlines()]
    assert kinds[0] == "start"
    assert kinds.count("fault") == 1
    assert kinds.count("row") >= 20


def test_sound_goes_into_a_file_in_time(device_folder, tmp_path):
    """The file's clock is the source's: so many seconds, so many frames, never more."""
    out = tmp_path / "out.wav"
    words = ["--imu", "tcp:0", "--no-wait", "--seconds", "0.5", "--audio", f"wav:{out}"]
    started = time.monotonic()
    assert cli.run(["simulate-device", str(device_folder), *words]) == 0
    took = time.monotonic() - started
    played, rate = soundfile.read(out, dtype="float32")
    source, _ = soundfile.read(device_folder / "audio.wav", dtype="float32")
    assert rate == 8000
    assert 0.2 * rate < len(played) < took * rate
    assert np.array_equal(played, source[: len(played)])
