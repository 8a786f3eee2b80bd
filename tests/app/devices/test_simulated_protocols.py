"""What the simulated ball sends is read by the importers and the live decoders as what it measured."""

from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app import cli
from app.devices.simulated.protocols import PROTOCOLS, encoder_named
from processing.importing import frame_log, neutral, printed_log, ximu3_stream
from processing.importing.frames import Frames
from processing.importing.raw import ReadContext
from processing.live.decoders import decoder_named
from processing.progress import silent

# of the wire: a printed line has four decimals in g and °/s, as has an x-IMU3 in its ASCII messages; half of the last
ROUNDED = {"acc_s_mps2": 0.5e-4 * 9.80665, "gyr_s_radps": 0.5e-4 * np.pi / 180, "mag_s_ut": 0.5e-4 * 50}
ROUNDING = dict.fromkeys(("printed", "ximu3"), ROUNDED)
KEPT = ("acc_s_mps2", "gyr_s_radps", "mag_s_ut")


def measured(count=200, seed=1, **without) -> Frames:
    rng = np.random.default_rng(seed)
    columns = {
        "counter": np.arange(count, dtype=np.uint32),
        "time_us": (10_000 * np.arange(count) + np.arange(count) ** 2 % 90).astype(np.uint64),
        "acc_s_mps2": rng.normal(0, 20, (count, 3)).astype(np.float32),
        "gyr_s_radps": rng.normal(0, 10, (count, 3)).astype(np.float32),
        "mag_s_ut": rng.normal(0, 40, (count, 3)).astype(np.float32),
        "pressure_kpa": rng.normal(420, 5, count).astype(np.float32),
        "temperature_c": rng.normal(12, 1, count).astype(np.float32),
        "quat_ws": rng.normal(0, 1, (count, 4)).astype(np.float32),
        "host_s": np.full(count, np.nan),
    }
    return Frames(**columns | without)


def wire(protocol, frames):
    encoder = encoder_named(protocol, frames)
    return encoder.header() + b"".join(encoder.encode(frames))


def assert_same(protocol, found, sent):
    """Equal to the rounding of the wire, and to the last bits of 32-bit floats where units are changed."""
    for name in KEPT:
        rounding = ROUNDING.get(protocol, {}).get(name, 0.0)
        np.testing.assert_allclose(found[name], getattr(sent, name), rtol=3e-7, atol=rounding * 1.01, err_msg=name)


def test_the_command_line_offers_the_protocols_that_there_are():
    assert cli.DEVICE_PROTOCOLS == PROTOCOLS


@pytest.mark.parametrize(
    ("protocol", "suffix", "read"),
    [
        ("frames", ".lkf", frame_log.read),
        ("csv", ".csv", neutral.read),
        ("printed", ".txt", printed_log.read),
        ("ximu3", ".ximu3", ximu3_stream.read),
        ("ximu3-binary", ".ximu3", ximu3_stream.read),
    ],
)
def test_the_importers_read_what_is_sent(protocol, suffix, read, tmp_path):
    sent = measured()
    path = tmp_path / f"sent{suffix}"
    path.write_bytes(wire(protocol, sent))
    raw = read(path, ReadContext(tmp_path, None, None, silent()))
    assert_same(protocol, {"acc_s_mps2": raw.acc, "gyr_s_radps": raw.gyr, "mag_s_ut": raw.mag}, sent)
    if protocol != "printed":
        np.testing.assert_allclose(raw.time, 1e-6 * sent.time_us, atol=1e-7)


@pytest.mark.parametrize("name", ["named", "auto"])
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_the_live_decoders_read_what_is_sent_however_it_is_cut(protocol, name):
    sent = measured()
    data = wire(protocol, sent)
    decoder = decoder_named("auto" if name == "auto" else protocol.removesuffix("-binary"))
    rng = np.random.default_rng(2)
    cuts = np.sort(rng.integers(0, len(data), 60)).tolist()
    parts = [decoder.feed(data[a:b]) for a, b in zip([0, *cuts], [*cuts, len(data)])]
    found = {n: np.concatenate([getattr(part, n) for part in parts]) for n in (*KEPT, "time_us", "counter")}
    count = len(found["counter"])
    assert count == len(sent)
    assert_same(protocol, found, sent)
    assert decoder.counts().garbage_bytes == 0
    assert decoder.has_time == (protocol != "printed")
    if decoder.has_time:
        assert found["time_us"].tolist() == sent.time_us.tolist()
    if decoder.has_counter:
        assert found["counter"].tolist() == sent.counter.tolist()


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_ball_without_magnetometer_sends_none(protocol):
    nothing = np.full((20, 3), np.nan, np.float32)
    sent = measured(20, mag_s_ut=nothing)
    decoder = decoder_named(protocol.removesuffix("-binary"))
    found = decoder.feed(wire(protocol, sent))
    assert len(found) == 20
    assert np.isnan(found.mag_s_ut).all()


def test_there_is_one_piece_for_each_sample():
    sent = measured(37)
    for protocol in PROTOCOLS:
        assert len(encoder_named(protocol, sent).encode(sent)) == 37, protocol


@settings(max_examples=40, deadline=None)
@given(
    time_us=st.integers(0, 2**63 - 1),
    values=st.lists(st.floats(-1e4, 1e4, width=32), min_size=6, max_size=6),
)
def test_stuffed_messages_hold_no_line_feed_and_come_back(time_us, values):
    """Bytes 0x0A and 0xDB may stand in any number."""
    one = measured(1, mag_s_ut=np.full((1, 3), np.nan, np.float32), quat_ws=np.full((1, 4), np.nan, np.float32))
    columns = {f.name: getattr(one, f.name) for f in fields(one)}
    columns |= {"time_us": np.array([time_us], np.uint64), "temperature_c": np.full(1, np.nan, np.float32)}
    columns |= {"acc_s_mps2": np.float32([values[:3]]), "gyr_s_radps": np.float32([values[3:]])}
    (message,) = encoder_named("ximu3-binary", one).encode(Frames(**columns))
    assert message.count(b"\n") == 1
    found = ximu3_stream.Ximu3Decoder().feed(message)["I"]
    assert found.shape == (1, 7)
    np.testing.assert_allclose(found[0, 0], time_us)
    np.testing.assert_allclose(found[0, 4:7] * 9.80665, values[:3], rtol=3e-7, atol=1e-6)
