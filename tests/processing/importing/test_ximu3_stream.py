"""The x-IMU3's byte stream: the manual's own examples, stuffing, cuts, garbage, and the way into a recording."""

import struct

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.importing import ximu3_stream
from processing.importing.folder import ImportOptions, import_folder
from processing.importing.raw import ReadContext
from processing.importing.ximu3_stream import Ximu3Decoder
from processing.settings import ImportSettings

MANUAL_BINARY = bytes.fromhex("C9 40420F0000000000 00000000 00000000 00000000 00000000 00000000 0000803F 0A")
MANUAL_ASCII = b"I,1000000,0.0000,0.0000,0.0000,0.0000,0.0000,1.0000\n"


def binary(kind, time_us, *values):
    body = bytes([0x80 + ord(kind)]) + struct.pack(f"<Q{len(values)}f", time_us, *values)
    return body.replace(b"\xdb", b"\xdb\xdd").replace(b"\n", b"\xdb\xdc") + b"\n"


def ascii_message(kind, time_us, *values):
    return f"{kind},{time_us},{','.join(f'{v:.4f}' for v in values)}\n".encode()


@pytest.mark.parametrize("message", [MANUAL_BINARY, MANUAL_ASCII])
def test_the_manuals_examples_are_one_second_and_one_g(message):
    decoder = Ximu3Decoder()
    assert decoder.feed(message)["I"].tolist() == [[1e6, 0, 0, 0, 0, 0, 1]]
    assert decoder.garbage_bytes == 0


@given(
    st.integers(0, 2**53 - 1),
    st.lists(st.floats(width=32, allow_nan=False, allow_infinity=False), min_size=6, max_size=6),
)
def test_any_bytes_survive_the_stuffing(time_us, values):
    row = Ximu3Decoder().feed(binary("I", time_us, *values))["I"][0]
    assert row.tolist() == [float(time_us), *values]


@given(st.lists(st.integers(1, 90), max_size=40))
def test_however_a_stream_is_cut_the_same_messages_come_out(cuts):
    stream = b"".join(
        binary("I", 2500 * k, k, 0.5, 10, 0, 219, 1) + ascii_message("M", 2500 * k, 1, k, 0) for k in range(30)
    )
    decoder, found, at = Ximu3Decoder(), [], 0
    for cut in [*cuts, len(stream)]:
        found.append(decoder.feed(stream[at : at + cut]))
        at += cut
    assert np.concatenate([f["I"] for f in found])[:, 1].tolist() == list(range(30))
    assert np.concatenate([f["M"] for f in found])[:, 2].tolist() == list(range(30))


def test_what_is_no_message_costs_itself_and_what_is_of_no_use_is_no_garbage():
    decoder = Ximu3Decoder()
    stream = (
        b"\xc9short\n" + b"I,12,x,0,0,0,0,1\n" + b'{"ping":null}\n' + ascii_message("B", 5, 90, 4.1, 0) + MANUAL_ASCII
    )
    assert len(decoder.feed(stream)["I"]) == 1
    assert decoder.garbage_bytes == len(b"\xc9short\n" + b"I,12,x,0,0,0,0,1\n")
    decoder.feed(bytes([65]) * 5000)
    assert decoder.garbage_bytes > 5000


@pytest.mark.parametrize("write", [binary, ascii_message])
def test_a_logged_stream_is_a_recording(tmp_path, write):
    rng = np.random.default_rng(1)
    gyr, acc = rng.normal(0, 40, (4000, 3)), rng.normal(0, 0.02, (4000, 3)) + np.array([0, 0, 1])
    parts = [b"\x00\x01junk\n"]
    for k in range(4000):
        parts.append(write("I", 10_000_000 + 2500 * k, *gyr[k], *acc[k]))
        if k % 20 == 0:
            parts.append(write("M", 10_000_000 + 2500 * k, *(np.array([0.5, 0.0, -0.8]) + 0.01 * np.sin(k))))
            parts.append(write("T", 10_000_000 + 2500 * k, 21.5))
    (tmp_path / "log.ximu3").write_bytes(b"".join(parts))
    recording = import_folder(tmp_path, ImportOptions(), ImportSettings())
    imu = recording.imu
    assert imu.sample_rate_hz == pytest.approx(400.0)
    assert np.allclose(imu.gyr_s_radps, np.radians(gyr), atol=2e-6)
    assert np.allclose(imu.acc_s_mps2, 9.80665 * acc, atol=1e-3)
    assert np.allclose(imu.mag_s_ut[0], [25.0, 0.0, -40.0], atol=1e-4)
    assert np.allclose(imu.mag_s_ut[:3980], [25.0, 0.0, -40.0], atol=0.51)
    assert "stream_garbage" in [f.code for f in recording.findings]


def test_what_holds_no_message_is_not_taken_for_one(tmp_path):
    path = tmp_path / "x.ximu3"
    path.write_bytes(bytes(range(256)) * 40)
    assert ximu3_stream.sniff(path, None) == 0.0
    with pytest.raises(Exception, match="inertial"):
        ximu3_stream.read(path, ReadContext())
