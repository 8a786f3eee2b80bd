"""The simulated ball's wires, with real terminals and sockets: all that is sent comes, in time, whatever happens."""

import json
import socket
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
import serial

from app.devices.simulated.faults import parse_faults
from app.devices.simulated.ports import PtyPort, open_port
from app.devices.simulated.protocols import encoder_named
from app.devices.simulated.sender import Pace, RowSender
from app.devices.simulated.source import RowReel
from app.devices.simulated.truth import TruthFile
from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import FrameDecoder
from processing.live.decoders import decoder_named
from processing.survey import ImuSamples

DEADLINE_S = 20.0
has_terminals = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")


def reel(seconds, rate_hz):
    count = round(seconds * rate_hz)
    values = np.random.default_rng(3).normal(0, 5, (count, 3))
    return RowReel(ImuSamples(np.arange(count) / rate_hz, values, -values, np.ones(count, np.bool_)), loop=False)


class Run:
    """A sender that is ended in any case, with its truth."""

    def __init__(self, port, folder, *, seconds=1.0, rate_hz=200.0, protocol="frames", faults="", wait=True):
        plan = parse_faults(faults)
        self.port, self.path = port, folder / "truth"
        self.truth = TruthFile(self.path)
        self.sender = RowSender(
            reel(seconds, rate_hz), lambda first: encoder_named(protocol, first), port,
            Pace(plan.drift_ppm, 1.0, rate_hz), plan, wait=wait, truth=self.truth,
        )  # fmt: skip

    def __enter__(self):
        self.sender.start()
        return self

    def __exit__(self, *_):
        self.sender.stop()
        self.truth.close()

    def rows(self, fate="sent"):
        lines = [json.loads(line) for line in self.path.read_text(encoding="utf-8").splitlines()]
        return [line["counter"] for line in lines if line["what"] == "row" and line["fate"] == fate]

    def sent_frames(self):
        return FrameDecoder().feed(self.path.with_name("truth.lkf").read_bytes())


class SerialReader:
    def __init__(self, path):
        self.port = serial.Serial(path, 115200, timeout=0.05)

    def read(self):
        try:
            return self.port.read(max(1, self.port.in_waiting))
        except OSError:  # unplugged
            return None

    def close(self):
        self.port.close()


class SocketReader:
    def __init__(self, one):
        self.one = one
        self.one.settimeout(0.05)

    def read(self):
        try:
            return self.one.recv(65536) or None
        except TimeoutError:
            return b""
        except OSError:
            return None

    def close(self):
        self.one.close()


def connect(kind, port):
    if kind == "pty":
        return SerialReader(port.path)
    return SocketReader(socket.create_connection(("127.0.0.1", int(port.spec.rsplit(":", 1)[1])), DEADLINE_S))


def listen(reader, run):
    """Read until the sender has ended and nothing more comes."""
    data, until = [], time.monotonic() + DEADLINE_S
    while time.monotonic() < until:
        is_over = run.sender.wait(0.0)
        piece = reader.read()
        if piece is None or (is_over and not piece):
            break
        data.append(piece)
    assert run.sender.wait(5.0)
    assert run.sender.error is None
    return b"".join(data)


KINDS = ("tcp", "udp") if sys.platform == "win32" else ("pty", "tcp", "udp")


@pytest.fixture
def wires():
    """A port of each kind, and who listens to it."""
    made = {}
    try:
        for kind in KINDS:
            if kind == "udp":
                reader = SocketReader(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
                reader.one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
                reader.one.bind(("127.0.0.1", 0))
                port = open_port(f"udp:127.0.0.1:{reader.one.getsockname()[1]}")
            else:
                port = open_port("pty" if kind == "pty" else "tcp:0")
                reader = connect(kind, port)
            made[kind] = port, reader
        yield made
    finally:
        for port, reader in made.values():
            reader.close()
            port.close()


def test_all_samples_of_fast_balls_come_bit_by_bit_on_all_wires_at_once(wires, tmp_path):
    for kind in wires:
        (tmp_path / kind).mkdir()
    with ExitStack() as stack, ThreadPoolExecutor(len(wires)) as pool:
        runs = {
            kind: stack.enter_context(Run(port, tmp_path / kind, seconds=3.0, rate_hz=1000.0))
            for kind, (port, _) in wires.items()
        }
        heard = {kind: pool.submit(listen, wires[kind][1], run) for kind, run in runs.items()}
        data = {kind: one.result(DEADLINE_S + 10.0) for kind, one in heard.items()}
    for kind, run in runs.items():
        found, sent = decoder_named("frames").feed(data[kind]), run.sent_frames()
        assert found.counter.tolist() == list(range(3000)), kind
        for name in ("counter", "time_us", "acc_s_mps2", "gyr_s_radps"):
            assert np.array_equal(getattr(sent, name), getattr(found, name)), (kind, name)


def test_samples_leave_at_their_time_by_a_clock_that_runs_fast(tmp_path):
    """No earlier than due: a lower bound holds on any machine."""
    port = open_port("tcp:0")
    reader = connect("tcp", port)
    try:
        with Run(port, tmp_path, seconds=0.8, rate_hz=500.0, faults="drift=50000") as run:
            listen(reader, run)
    finally:
        reader.close()
    sent = run.sent_frames()
    started = json.loads((tmp_path / "truth").read_text(encoding="utf-8").splitlines()[0])["host_s"]
    due_s = started + sent.time_us / 1e6 / 1.05
    assert np.all(sent.host_s >= due_s - 0.1)  # the first sample is sent a moment after the start
    span = (sent.host_s[-1] - sent.host_s[0]) * 1.05
    assert span >= 0.7


@pytest.mark.parametrize("protocol", ["csv", "printed", "ximu3", "ximu3-binary"])
def test_other_protocols_pass_a_terminal_unchanged(protocol, tmp_path):
    """Among the bytes of a binary message are all that a terminal may take for commands."""
    if sys.platform == "win32":
        pytest.skip("Windows has no pseudo-terminals")
    port = open_port("pty")
    reader = connect("pty", port)
    try:
        with Run(port, tmp_path, seconds=0.1, rate_hz=1000.0, protocol=protocol) as run:
            found = decoder_named("auto").feed(listen(reader, run))
    finally:
        reader.close()
    assert len(found) == 100
    assert len(run.rows()) == 100


@pytest.mark.parametrize("kind", [pytest.param("pty", marks=has_terminals), "tcp"])
def test_an_unplugged_wire_comes_back_where_it_was_and_the_truth_tells_what_went(kind, tmp_path):
    link = tmp_path / "ball"
    port = open_port(f"pty:{link}" if kind == "pty" else "tcp:0")
    first = connect(kind, port)
    second = None
    data, until = b"", time.monotonic() + DEADLINE_S
    try:
        with Run(port, tmp_path, seconds=0.9, faults="unplug@0.3+0.3") as run:
            while time.monotonic() < until and (piece := first.read()) is not None:
                data += piece
            first.close()
            while second is None and time.monotonic() < until:
                try:
                    second = SerialReader(str(link)) if kind == "pty" else connect(kind, port)
                except OSError:  # refused, or no such terminal
                    time.sleep(0.02)
            assert second is not None
            data += listen(second, run)
    finally:
        for one in (first, second):
            if one is not None:
                one.close()
    found = FrameDecoder().feed(data).counter.tolist()
    # what lies in a terminal's buffer when it goes is gone with it; a connection gives it out first
    gone = sorted(set(run.rows("sent")) - set(found))
    assert gone == list(range(60 - len(gone), 60)) if kind == "pty" else not gone
    assert found == [row for row in run.rows("sent") if row not in gone]
    assert run.rows("unplugged") == list(range(60, 120))
    assert max(found) == 179
    assert not link.exists()


@has_terminals
def test_a_link_is_no_file_of_somebody_else(tmp_path):
    link = tmp_path / "precious"
    link.write_text("mine")
    with pytest.raises(LeaklineError) as caught:
        PtyPort(link)
    assert caught.value.code is ErrorCode.SIMULATED_PORT_FAILED
    assert link.read_text() == "mine"


@has_terminals
def test_who_does_not_read_loses_whole_samples_and_the_truth_says_so(tmp_path):
    port = open_port("pty")
    reader = connect("pty", port)
    try:
        with Run(port, tmp_path, seconds=0.4, rate_hz=5000.0) as run:
            assert run.sender.wait(DEADLINE_S)  # 84 kB would come, a terminal holds less
    finally:
        reader.close()
    unheard = run.rows("unheard")
    assert unheard
    assert len(unheard) + len(run.rows("sent")) == 2000


def test_it_waits_for_a_listener_and_can_be_stopped_meanwhile(tmp_path):
    port = open_port("tcp:0")
    with Run(port, tmp_path) as run:
        assert not run.sender.wait(0.2)
        assert run.sender.sent == 0
    assert run.sender.wait(0.0)


@pytest.mark.parametrize("words", ["tcp", "tcp:x", "udp:500", "usb:1", "tcp:99999999", ""])
def test_ports_that_are_none_are_refused(words):
    with pytest.raises(LeaklineError) as caught:
        open_port(words)
    assert caught.value.code is ErrorCode.SETTING_INVALID


def test_a_port_that_is_taken_is_said():
    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(LeaklineError) as caught:
        open_port(f"tcp:{taken.getsockname()[1]}")
    assert caught.value.code is ErrorCode.SIMULATED_PORT_FAILED


@has_terminals
def test_no_thread_and_no_terminal_is_left_behind(tmp_path):
    def open_files():
        return len(list(Path("/proc/self/fd").iterdir())) if sys.platform == "linux" else 0

    before = open_files()
    port = open_port("pty")
    with Run(port, tmp_path, seconds=5.0, wait=False) as run:
        assert not run.sender.wait(0.1)
    assert "simulated ball" not in {thread.name for thread in threading.enumerate()}
    assert open_files() <= before
