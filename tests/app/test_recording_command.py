"""The words of ``leakline record``, and what it says to whoever sits before it."""

import io
import json
import signal
import socket
import sys
import threading
import time
from contextlib import suppress
from types import SimpleNamespace

import numpy as np
import pytest
from fake_devices import motion, sent

from app import cli, recording_terminal
from app.devices.audio_devices import AudioDevice
from app.devices.serial_ports import SerialPort
from app.recording_command import _stopping, plan_of
from app.recording_terminal import Terminal, clock_text
from processing.live.stream import LinkState, MotionStatus, RecordingStatus, SoundStatus
from processing.survey import Finding, Motion, Severity

PATIENCE_S = 20.0


def words(*told):
    return cli.parser().parse_args(["record", *told])


def status_and_errors(capsys, *told):
    try:
        status = cli.run(["record", *told])
    except SystemExit as left:  # argparse leaves by itself
        status = int(left.code or 0)
    return status, capsys.readouterr().err.splitlines()


# --- the words


@pytest.mark.parametrize(
    "told",
    [
        ["--out", "OUT"],
        ["--imu", "none", "--audio", "none", "--out", "OUT"],
        ["--imu", "tcp:127.0.0.1:1"],
        ["--imu", "carrier-pigeon:7", "--out", "OUT"],
        ["--audio", "default@7", "--out", "OUT"],
        ["--imu", "tcp:127.0.0.1:1", "--out", "OUT", "--seconds", "-3"],
        ["--imu", "tcp:127.0.0.1:1", "--out", "OUT", "--radius", "big"],
        ["--imu", "tcp:127.0.0.1:1", "--out", "OUT", "--motion", "flying"],
        ["--imu", "tcp:127.0.0.1:1", "--out", "OUT", "--survey", "nowhere.toml"],
        ["--imu", "tcp:127.0.0.1:1", "--out", "OUT", "--wait", "0.3"],
    ],
    ids=" ".join,
)
def test_words_that_mean_nothing_and_devices_that_are_not_there_give_status_2_and_one_line(told, tmp_path, capsys):
    status, errors = status_and_errors(capsys, *[word.replace("OUT", str(tmp_path / "out")) for word in told])
    assert status == 2
    assert len(errors) == 1, errors
    assert list(tmp_path.iterdir()) == [], "nothing was begun"


def test_a_device_that_is_not_there_is_named_with_the_reason(tmp_path, capsys):
    told = ["--imu", "tcp:127.0.0.1:1", "--out", str(tmp_path / "out"), "--wait", "0.5"]
    assert "tcp:127.0.0.1:1" in status_and_errors(capsys, *told)[1][0]


def test_the_words_become_the_survey_and_moments_of_another_run_do_not(tmp_path):
    told = tmp_path / "survey.toml"
    told.write_text(
        '[survey]\nname = "old"\noperator = "Ayşe"\n[pipe]\ndiameter_m = 0.2\nlength_m = 80.0\n'
        '[audio]\nchannel = 1\nstart_time_s = 3.0\n[[tie_points]]\nname = "end"\ntime_s = 60.0\nchainage_m = 80.0\n',
        encoding="utf-8",
    )
    spec = ["--imu", "serial:/dev/ttyUSB0@921600,protocol=csv", "--audio", "USB mic@96000,channels=2"]
    more = ["--name", "Gül Sokağı", "--diameter", "0.3", "--radius", "0.05", "--motion", "rolling", "--seconds", "90"]
    plan = plan_of(words(*spec, "--out", str(tmp_path), "--survey", str(told), "--part-minutes", "10", *more))
    survey = plan.survey
    assert (survey.info.name, survey.info.operator, plan.operator) == ("Gül Sokağı", "Ayşe", "Ayşe")
    assert (survey.pipe.diameter_m, survey.pipe.length_m) == (0.3, 80.0)
    assert (survey.device.radius_m, survey.device.motion) == (0.05, Motion.ROLLING)
    assert (survey.audio.channel, survey.audio.start_time_s, survey.tie_points) == (1, None, ())
    assert (plan.part_s, plan.planned_s) == (600.0, 90.0)
    assert (str(plan.sound), str(plan.motion)) == ("USB mic@96000,channels=2", spec[1])


def test_the_list_names_devices_as_they_are_named_to_the_command(monkeypatch, capsys):
    mic = AudioDevice("USB mic: Audio", "ALSA", 2, 96_000.0, 0)
    port = SerialPort("usb:0403:6001", "/dev/ttyUSB0", "ball")
    monkeypatch.setattr(recording_terminal, "list_inputs", lambda: (mic,))
    monkeypatch.setattr(recording_terminal, "list_serial_ports", lambda: (port,))
    assert cli.run(["record", "--list"]) == 0
    said = capsys.readouterr().out
    assert "USB mic: Audio    2 channels, 96000 Hz, ALSA" in said
    assert "serial:usb:0403:6001    ball" in said


# --- a whole recording, of motion alone, over a socket


class TcpBall:
    """Sends samples to whoever connects, at 400 Hz."""

    def __init__(self):
        self._listener = socket.create_server(("127.0.0.1", 0))
        self._listener.settimeout(PATIENCE_S)
        self.port = self._listener.getsockname()[1]
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        try:
            line, _ = self._listener.accept()
        except OSError:
            return
        begun_s, done = time.monotonic(), 0
        with line, suppress(ConnectionError):  # it hangs up when it has heard enough
            while not self._ending.wait(0.01):
                due = int(400.0 * (time.monotonic() - begun_s))
                if due > done:
                    line.sendall(sent(motion(due - done, done)))
                done = due

    def close(self):
        self._ending.set()
        self._listener.close()
        self._thread.join(5.0)


@pytest.fixture
def ball():
    one = TcpBall()
    yield one
    one.close()


def test_it_records_for_as_long_as_told_and_says_where(ball, tmp_path, capsys):
    before = signal.getsignal(signal.SIGTERM)
    told = ["--imu", f"tcp:127.0.0.1:{ball.port}", "--out", str(tmp_path / "run"), "--seconds", "1.0", "--wait", "20"]
    assert cli.run(["record", *told]) == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert f"Recorded 0:00:01 to {tmp_path / 'run.leakline'}: IMU" in said.out.splitlines()[-1]
    last = (tmp_path / "run.leakline/recordings/1/original/recording.jsonl").read_text().splitlines()[-1]
    assert json.loads(last)["values"]["motion_samples"] == pytest.approx(400, abs=200)
    assert signal.getsignal(signal.SIGTERM) is before


def test_sigterm_ends_it_cleanly_with_status_0(ball, tmp_path):
    told = ["--imu", f"tcp:127.0.0.1:{ball.port}", "--out", str(tmp_path / "run"), "--wait", "20"]

    def end():
        until = time.monotonic() + PATIENCE_S
        while not list(tmp_path.glob("*/recordings/1/original/imu-001.lkf")) and time.monotonic() < until:
            time.sleep(0.05)
        signal.raise_signal(signal.SIGTERM)

    threading.Thread(target=end, daemon=True).start()
    assert cli.run(["record", *told]) == 0
    assert "stopped" in (tmp_path / "run.leakline/recordings/1/original/recording.jsonl").read_text()


def test_what_the_caller_ignores_stays_ignored():
    before = signal.signal(signal.SIGTERM, signal.SIG_IGN)
    try:
        with _stopping() as stopper:
            signal.raise_signal(signal.SIGTERM)
            signal.raise_signal(signal.SIGINT)
            time.sleep(0.01)
            assert stopper.asked
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGTERM, before)


# --- what is said


def screen(monkeypatch, *, is_terminal):
    out, err = io.StringIO(), io.StringIO()
    err.isatty = lambda: is_terminal
    monkeypatch.setattr(sys, "stdout", out)
    monkeypatch.setattr(sys, "stderr", err)
    monkeypatch.setattr(sys, "stdin", SimpleNamespace(isatty=lambda: False))
    monkeypatch.setenv("TERM", "xterm")
    return out, err


def a_look(**more):
    sound = SoundStatus(LinkState.LIVE, "mic", 48_000.0, 2, 96_000, 4800, 1, (-20.0, -31.0), clipped=(False, True))
    return RecordingStatus(elapsed_s=3723.0, sound=sound, motion=MotionStatus(LinkState.LIVE, rate_hz=400.0), **more)


def test_the_moving_line_says_how_each_stream_is(monkeypatch):
    _, err = screen(monkeypatch, is_terminal=True)
    monkeypatch.setenv("COLUMNS", "200")
    Terminal("en").show(a_look())
    line = "1:02:03  IMU alive 400 Hz, lost 0 | sound alive -20 -31! dBFS, lost 0.10 s"
    assert err.getvalue() == f"\r\x1b[K{line}"


def test_nothing_moves_where_there_is_no_terminal(monkeypatch):
    _, err = screen(monkeypatch, is_terminal=False)
    Terminal("en").show(a_look())
    assert err.getvalue() == ""


def test_an_event_is_said_once_and_what_it_grew_to_at_the_end(monkeypatch, tmp_path):
    out, _ = screen(monkeypatch, is_terminal=False)
    terminal = Terminal("en")
    first, grown = (
        Finding("recorder_imu_gap", Severity.MASKED, {"at": "13:14:15", "lost": n, "gaps": 1.0}) for n in (2.0, 9.0)
    )
    terminal.tell(a_look(findings=(first,)))
    terminal.tell(a_look(findings=(grown,)))
    assert out.getvalue().count("samples of the IMU were lost") == 1
    terminal.done(a_look(findings=(grown,)), tmp_path)
    assert "9 samples of the IMU were lost" in out.getvalue()


def test_it_speaks_turkish(monkeypatch, tmp_path):
    out, _ = screen(monkeypatch, is_terminal=False)
    Terminal("tr").done(a_look(), tmp_path)
    assert "1:02:03 kaydedildi: ses 2,1 s, kayıp 0,100 s; IMU 0 örnek" in out.getvalue()


def test_a_reader_that_has_gone_ends_no_recording(monkeypatch):
    class Closed(io.StringIO):
        def write(self, _text):
            raise BrokenPipeError

    screen(monkeypatch, is_terminal=True)
    monkeypatch.setattr(sys, "stdout", Closed())
    monkeypatch.setattr(sys, "stderr", Closed())
    sys.stderr.isatty = lambda: True
    terminal = Terminal("en")
    terminal.say("record_waiting")
    terminal.show(a_look())
    terminal.show(a_look())


def test_times_are_hours_minutes_seconds():
    assert [clock_text(seconds) for seconds in (0.0, 59.9, 61.0, 36_000.5)] == [
        "0:00:00",
        "0:00:59",
        "0:01:01",
        "10:00:00",
    ]
    assert np.all([clock_text(float(s)).count(":") == 2 for s in range(0, 100_000, 997)])
