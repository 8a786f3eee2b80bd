"""Links to an IMU over real pseudo-terminals and sockets: data, unplugging, replugging, silence, and the end."""

import os
import socket
import sys
import threading
import time

import pytest

from app.devices import imu_link, link_fault, serial_link, socket_links
from app.devices.imu_link import ImuLink
from app.devices.imu_spec import ImuChoice, parse_imu_spec
from app.devices.link_fault import LinkFault
from app.devices.serial_link import SerialSource
from app.devices.serial_ports import SerialPort
from processing.live.stream import LinkState

DEADLINE_S = 10.0
on_terminals = pytest.mark.skipif(sys.platform == "win32", reason="Windows has no pseudo-terminals")


def wait_for(condition, what):
    until = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.005)


class Heard:
    """A link that is heard, and what it said."""

    def __init__(self, choice, source=None, on_bytes=None):
        self.data, self.stamps, self.states, self.reasons = bytearray(), [], [], []
        self.link = ImuLink(choice, on_bytes or self._bytes, self._state, source=source)

    def _bytes(self, data, host_s):
        self.data += data
        self.stamps.append((host_s, time.monotonic()))

    def _state(self, state, reason):
        self.states.append(state)
        self.reasons.append(reason)

    def wait_state(self, state, reason=None):
        wait_for(lambda: self.link.state is state and reason in {None, self.link.reason}, f"{state} {reason}")

    def wait_open(self, times=1):
        """What was sent to a port before is forgotten by the system when it is opened."""
        wait_for(lambda: self.link.opened >= times, "the link to be open")

    def wait_bytes(self, count):
        wait_for(lambda: len(self.data) >= count, f"{count} bytes, have {len(self.data)}")


@pytest.fixture
def hear(monkeypatch):
    monkeypatch.setattr(imu_link, "SILENT_S", 0.3)
    monkeypatch.setattr(imu_link, "_STALE_EVERY_S", 0.05)
    links = []

    def make(choice, **options):
        heard = Heard(choice if isinstance(choice, ImuChoice) else parse_imu_spec(choice), **options)
        links.append(heard.link)
        heard.link.start()
        return heard

    yield make
    ended = [link.stop(timeout=5.0) for link in links]
    assert all(ended)


class Terminal:
    """A pseudo-terminal that stands for a device's port."""

    def __init__(self):
        import tty

        self.master, self._slave = os.openpty()
        tty.setraw(self._slave)
        self.name = os.ttyname(self._slave)

    def let_go(self):
        """Leave the other end to whoever opens it by name."""
        os.close(self._slave)
        self._slave = -1

    def send(self, data):
        os.write(self.master, data)

    def unplug(self):
        for end in (self.master, self._slave):
            if end >= 0:
                os.close(end)
        self.master = self._slave = -1


@pytest.fixture
def terminals():
    made = []

    def make():
        made.append(Terminal())
        return made[-1]

    yield make
    for terminal in made:
        terminal.unplug()


@on_terminals
def test_bytes_arrive_in_order_with_the_time_at_which_they_came(hear, terminals):
    terminal = terminals()
    heard = hear(f"serial:{terminal.name}@921600")
    heard.wait_open()
    sent = bytes(range(256)) * 40
    begun_s = time.monotonic()
    for at in range(0, len(sent), 1024):
        terminal.send(sent[at : at + 1024])
    heard.wait_bytes(len(sent))
    assert bytes(heard.data) == sent
    assert heard.states[:2] == [LinkState.WAITING, LinkState.LIVE]
    assert heard.link.device == terminal.name
    stamps = [stamp for stamp, _ in heard.stamps]
    assert stamps == sorted(stamps)
    assert all(begun_s <= stamp <= called for stamp, called in heard.stamps)


@on_terminals
def test_a_port_that_is_not_there_yet_is_waited_for(hear, terminals, tmp_path):
    heard = hear(f"serial:{tmp_path / 'ball'}")
    heard.wait_state(LinkState.WAITING, link_fault.NOT_THERE)
    terminal = terminals()
    (tmp_path / "ball").symlink_to(terminal.name)
    heard.wait_open()
    terminal.send(b"here I am")
    heard.wait_state(LinkState.LIVE)
    heard.wait_bytes(9)


@on_terminals
def test_an_unplugged_device_is_lost_and_comes_back_under_its_lasting_name(hear, terminals, tmp_path):
    first, name = terminals(), tmp_path / "by-id"
    name.symlink_to(first.name)
    heard = hear(f"serial:{name}")
    heard.wait_open()
    first.send(b"before")
    heard.wait_bytes(6)
    second = terminals()  # made before the first is gone, so that it cannot have its number
    first.unplug()
    heard.wait_state(LinkState.LOST)
    name.unlink()
    heard.wait_state(LinkState.LOST, link_fault.NOT_THERE)
    name.symlink_to(second.name)
    heard.wait_open(2)
    second.send(b" and after")
    heard.wait_state(LinkState.LIVE)
    heard.wait_bytes(16)
    assert bytes(heard.data) == b"before and after"
    lost = heard.states.index(LinkState.LOST)
    assert heard.reasons[lost] == link_fault.UNPLUGGED
    assert heard.states[-1] is LinkState.LIVE


@on_terminals
def test_silence_is_told_and_ends_with_the_next_byte(hear, terminals):
    terminal = terminals()
    heard = hear(f"serial:{terminal.name}")
    heard.wait_state(LinkState.SILENT)
    terminal.send(b"x")
    heard.wait_state(LinkState.LIVE)
    heard.wait_state(LinkState.SILENT)
    assert heard.states == [LinkState.WAITING, LinkState.SILENT, LinkState.LIVE, LinkState.SILENT]


@on_terminals
def test_a_driver_that_keeps_silent_about_the_unplugging_is_found_out(hear, terminals, tmp_path):
    first, second, name = terminals(), terminals(), tmp_path / "by-id"
    name.symlink_to(first.name)
    heard = hear(f"serial:{name}")
    heard.wait_open()
    first.send(b"before")
    heard.wait_bytes(6)
    name.unlink()
    name.symlink_to(second.name)  # the first stays open and says nothing
    heard.wait_state(LinkState.LOST, link_fault.UNPLUGGED)
    heard.wait_open(2)
    second.send(b" after")
    heard.wait_bytes(12)


@on_terminals
def test_a_port_that_another_program_reads_is_busy_until_it_lets_go(hear, terminals):
    import serial

    terminal = terminals()
    other = serial.Serial(terminal.name, exclusive=True)
    try:
        heard = hear(f"serial:{terminal.name}")
        heard.wait_state(LinkState.WAITING, link_fault.BUSY)
    finally:
        other.close()
    heard.wait_open()
    terminal.send(b"mine")
    heard.wait_bytes(4)


@on_terminals
def test_auto_takes_the_only_port_and_finds_it_again_under_another_number(hear, terminals):
    first, second, stranger = terminals(), terminals(), terminals()
    usb = (0x0403, 0x6001, "A1")
    there = [SerialPort("a", first.name, "", usb), SerialPort("on board", "/dev/ttyS9")]
    heard = hear("serial:auto", source=SerialSource("auto", 115200, lambda: tuple(there)))
    heard.wait_open()
    first.send(b"one")
    heard.wait_bytes(3)
    there[:] = [SerialPort("s", stranger.name, "", (1, 2, "x"))]
    first.unplug()
    heard.wait_state(LinkState.LOST, link_fault.NOT_THERE)
    there.append(SerialPort("a", second.name, "", usb))
    heard.wait_open(2)
    second.send(b"two")
    stranger.send(b"not me")
    heard.wait_bytes(6)
    assert bytes(heard.data) == b"onetwo"


def test_auto_says_which_ports_there_are_when_it_cannot_choose(hear):
    there = [SerialPort("usb:1:2:A", "COM3", "", (1, 2, "A")), SerialPort("usb:1:2:B", "COM4", "", (1, 2, "B"))]
    heard = hear("serial:auto", source=SerialSource("auto", 115200, lambda: tuple(there)))
    heard.wait_state(LinkState.WAITING, link_fault.SEVERAL_PORTS)
    assert heard.link.detail == "serial:usb:1:2:A, serial:usb:1:2:B"
    there.clear()
    heard.wait_state(LinkState.WAITING, link_fault.NO_PORT)


@pytest.fixture
def server():
    listening = socket.create_server(("127.0.0.1", 0))
    listening.settimeout(DEADLINE_S)
    yield listening
    listening.close()


def test_a_tcp_device_is_heard_and_heard_again_after_it_closed(hear, server):
    port = server.getsockname()[1]
    heard = hear(f"tcp:localhost:{port}")
    for number in range(2):
        connection, _ = server.accept()
        with connection:
            connection.sendall(bytes([number]) * 70_000)
            heard.wait_bytes(70_000 * (number + 1))
            heard.wait_state(LinkState.LIVE)
        heard.wait_state(LinkState.LOST)
    assert bytes(heard.data) == bytes(70_000) + b"\1" * 70_000
    assert heard.reasons[heard.states.index(LinkState.LOST)] == link_fault.CLOSED
    assert heard.link.device == f"localhost:{port}"


def test_a_tcp_device_that_refuses_is_tried_until_it_takes(hear):
    with socket.socket() as reserved:
        reserved.bind(("127.0.0.1", 0))
        port = reserved.getsockname()[1]
        heard = hear(f"tcp:127.0.0.1:{port}")
        heard.wait_state(LinkState.WAITING, link_fault.REFUSED)
        reserved.listen()
        reserved.settimeout(DEADLINE_S)
        connection, _ = reserved.accept()
        with connection:
            connection.sendall(b"now")
            heard.wait_bytes(3)


def test_a_host_that_there_is_not_is_told(hear):
    heard = hear(ImuChoice("tcp", "a..b", 7000))
    heard.wait_state(LinkState.WAITING, link_fault.UNREACHABLE)


def test_connecting_can_be_stopped(monkeypatch):
    monkeypatch.setattr(socket_links, "CONNECT_S", 60.0)
    with socket.socket() as full:  # nobody accepts: once its queue is full, connecting hangs
        full.bind(("127.0.0.1", 0))
        full.listen(0)
        waiting = []
        try:
            for _ in range(4):
                waiting.append(socket.socket())
                waiting[-1].setblocking(False)
                waiting[-1].connect_ex(full.getsockname())
            link = ImuLink(ImuChoice("tcp", "127.0.0.1", full.getsockname()[1]), lambda *_: None, lambda *_: None)
            link.start()
            time.sleep(0.2)
            assert link.stop(timeout=5.0)
            assert link.state is LinkState.ENDED
        finally:
            for connection in waiting:
                connection.close()


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


@pytest.fixture
def sender():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        yield one


def test_datagrams_are_one_stream_and_lines_without_ends_get_them(hear, sender):
    port = free_udp_port()
    heard = hear(f"udp:127.0.0.1:{port}")
    heard.wait_open()
    for datagram in (b"1,2", b"\xc5\x4c\x00", b"3,4", b"5,6\r\n7", b",8\r\n9"):
        sender.sendto(datagram, ("127.0.0.1", port))
    heard.wait_bytes(22)
    assert bytes(heard.data) == b"1,2\n\xc5\x4c\x003,4\n5,6\r\n7,8\r\n9"
    assert heard.states == [LinkState.WAITING, LinkState.LIVE]


def test_only_the_chosen_sender_is_heard(sender):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        address = listener.getsockname()
        sender.sendto(b"one\n", address)
        assert socket_links.UdpStream(listener, "udp", frozenset({"127.0.0.1"})).read() == b"one\n"
        sender.sendto(b"two\n", address)
        assert socket_links.UdpStream(listener, "udp", frozenset({"10.0.0.7"})).read() == b""


def test_a_listener_for_anybody_hears_this_computer(hear, sender):
    port = free_udp_port()
    heard = hear(f"udp:{port}")
    heard.wait_open()
    sender.sendto(b"one\n", ("127.0.0.1", port))
    heard.wait_bytes(4)


def test_a_port_that_is_taken_is_busy(hear):
    port = free_udp_port()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as other:
        other.bind(("127.0.0.1", port))
        heard = hear(f"udp:127.0.0.1:{port}")
        heard.wait_state(LinkState.WAITING, link_fault.BUSY)


def test_a_fault_of_ours_ends_the_link_and_is_kept(hear, sender, caplog):
    def fail(_data, _host_s):
        raise RuntimeError("ours")

    port = free_udp_port()
    heard = hear(f"udp:127.0.0.1:{port}", on_bytes=fail)
    heard.wait_open()
    sender.sendto(b"x\n", ("127.0.0.1", port))
    heard.wait_state(LinkState.ENDED, link_fault.OUR_FAULT)
    assert isinstance(heard.link.error, RuntimeError)
    assert "the IMU's link ended" in caplog.text


def test_a_link_that_was_stopped_says_that_it_ended(hear):
    heard = hear(f"udp:127.0.0.1:{free_udp_port()}")
    heard.wait_open()
    assert heard.link.stop(timeout=5.0)
    assert heard.link.stop(timeout=5.0)
    assert heard.states[-1] is LinkState.ENDED
    assert not any(thread.name == "imu link" and thread is heard.link._thread for thread in threading.enumerate())


@on_terminals
def test_a_port_that_goes_while_it_is_opened_is_tried_again(hear, terminals, monkeypatch):
    import termios

    import serial

    terminal, opened = terminals(), serial.Serial
    errors = [termios.error(5, "Input/output error"), OSError(5, "Input/output error"), ValueError("no such rate")]

    def fail(*_, **__):
        raise errors.pop(0) if len(errors) > 1 else errors[0]

    monkeypatch.setattr(serial, "Serial", fail)
    heard = hear(f"serial:{terminal.name}")
    heard.wait_state(LinkState.WAITING, link_fault.FAILED)
    wait_for(lambda: len(errors) == 1, "all of them")
    monkeypatch.setattr(serial, "Serial", opened)
    heard.wait_open()
    assert heard.link.error is None


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (OSError("could not open port 'COM3': PermissionError(13, 'Access is denied.', None, 5)"), link_fault.BUSY),
        (OSError("could not open port 'COM3': FileNotFoundError(2, 'no such file', None, 2)"), link_fault.NOT_THERE),
        (PermissionError(13, "denied"), link_fault.DENIED),
        (ValueError("Not a valid baudrate: 7"), link_fault.FAILED),
    ],
)
def test_what_the_system_says_when_it_does_not_open_is_understood(error, reason):
    fault = serial_link._opening_fault(error)
    assert isinstance(fault, LinkFault)
    assert fault.reason == reason
