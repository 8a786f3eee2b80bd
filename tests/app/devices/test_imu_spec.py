"""What people may write for an IMU, and which port a name means."""

import pytest

from app.devices.imu_spec import ImuChoice, parse_imu_spec
from app.devices.serial_ports import SerialPort, named_ports, port_named
from processing import messages
from processing.errors import ErrorCode, LeaklineError

FTDI, OTHER = (0x0403, 0x6001, "A1B2"), (0x1A86, 0x7523, "")


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("serial:/dev/ttyUSB0@921600", ImuChoice("serial", "/dev/ttyUSB0", baud=921600)),
        ("serial:COM3", ImuChoice("serial", "COM3", baud=115200)),
        (" Serial:AUTO ", ImuChoice("serial", "auto")),
        ("serial:auto@9600,protocol=printed", ImuChoice("serial", "auto", baud=9600, protocol="printed")),
        ("serial:/dev/serial/by-id/usb-A@b-if00@300", ImuChoice("serial", "/dev/serial/by-id/usb-A@b-if00", baud=300)),
        ("serial:usb:0403:6001:A1B2@115200", ImuChoice("serial", "usb:0403:6001:A1B2")),
        ("tcp:ball.local:7000", ImuChoice("tcp", "ball.local", 7000)),
        ("tcp:[fe80::1%eth0]:7000, protocol = CSV", ImuChoice("tcp", "fe80::1%eth0", 7000, protocol="csv")),
        ("udp:9000", ImuChoice("udp", "", 9000)),
        ("udp:10.0.0.7:9000,protocol=ximu3", ImuChoice("udp", "10.0.0.7", 9000, protocol="ximu3")),
        ("none", ImuChoice("none")),
    ],
)
def test_a_choice_is_read_and_written_again(text, choice):
    assert parse_imu_spec(text) == choice
    assert parse_imu_spec(str(choice)) == choice


@pytest.mark.parametrize(
    "text",
    ["", "serial", "serial:", "serial:@9600", "serial:COM3@20", "serial:COM3@9600,protocol=morse", "serial:COM3,baud=9",
     "tcp:7000", "tcp:ball", "tcp:ball:0", "tcp:ball:70000", "tcp:a b:7000", "udp:", "udp:x", "bluetooth:1", "COM3"],
)  # fmt: skip
def test_what_names_no_imu_is_told_with_what_would(text):
    with pytest.raises(LeaklineError) as caught:
        parse_imu_spec(text)
    assert caught.value.code is ErrorCode.IMU_SPEC_INVALID
    for language in messages.LANGUAGES:
        sentence = messages.error_sentence(caught.value, language)
        assert "serial:auto" in sentence
        assert "frames, csv, printed, ximu3" in sentence


def test_every_reason_of_a_link_has_a_sentence():
    from app.devices import link_fault

    codes = [v for k, v in vars(link_fault).items() if k.isupper() and isinstance(v, str)]
    assert len(codes) == 12
    for language in messages.LANGUAGES:
        assert set(codes) <= set(messages.table("reasons", language))


def test_a_port_without_a_lasting_name_is_named_after_its_usb_numbers_where_they_are_its_own():
    ports = named_ports(
        [
            SerialPort("", "COM1", "on the board"),
            SerialPort("", "COM9", "ball", FTDI),
            SerialPort("", "COM4", "two", (1, 2, "S")),
            SerialPort("", "COM5", "of a kind", (1, 2, "S")),
            SerialPort("", "COM6", "nameless", OTHER),
            SerialPort("/dev/serial/by-id/x", "/dev/ttyUSB0", "linked", (7, 8, "T")),
        ]
    )
    assert [str(p) for p in ports] == [
        "serial:/dev/serial/by-id/x", "serial:COM4", "serial:COM5", "serial:COM6", "serial:usb:0403:6001:A1B2",
        "serial:COM1",
    ]  # fmt: skip
    for port in ports:
        assert port_named(port.name, ports) == port
        assert parse_imu_spec(str(port)).address == port.name


def test_auto_is_the_only_usb_port_and_stays_with_it():
    board, ball, second = (
        SerialPort("c1", "COM1"),
        SerialPort("c9", "COM9", "", FTDI),
        SerialPort("c4", "COM4", "", OTHER),
    )
    assert port_named("auto", [board, ball]) == ball
    assert port_named("auto", [board]) is None
    assert port_named("auto", [ball, second]) is None
    assert port_named("auto", [ball, second], known_usb=FTDI) == ball
    assert port_named("auto", [second], known_usb=FTDI) is None


def test_a_stick_that_comes_back_under_another_name_is_the_one_that_was_chosen():
    before = [SerialPort("a", "/dev/ttyUSB0", "", FTDI)]
    assert port_named("/dev/ttyUSB0", before) == before[0]
    after = [SerialPort("b", "/dev/ttyUSB0", "", OTHER), SerialPort("a", "/dev/ttyUSB1", "", FTDI)]
    assert port_named("/dev/ttyUSB0", after, known_usb=FTDI) == after[1]
    assert port_named("/dev/ttyUSB0", after[:1], known_usb=FTDI) is None  # not the neighbour in its place


def test_usb_numbers_find_a_port_with_or_without_its_serial_number():
    ports = [SerialPort("a", "COM1", "", FTDI), SerialPort("b", "COM2", "", (0x0403, 0x6001, "C3"))]
    assert port_named("usb:403:6001:C3", ports) == ports[1]
    assert port_named("usb:0403:6001", ports) is None  # two of them
    assert port_named("usb:0403:6001", ports[:1]) == ports[0]
