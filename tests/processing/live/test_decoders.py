"""What decodes a device's stream: the same rows however it is cut, what was sent and no more; garbage costs little."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from imu_streams import HEADER, PROTOCOLS, G, messages, samples

from processing.errors import ErrorCode, LeaklineError
from processing.live.decoders import DOUBT_BYTES, decoder_named
from processing.live.frame_rows import joined

each_protocol = pytest.mark.parametrize("protocol", PROTOCOLS)
each_way = pytest.mark.parametrize("way", ["named", "auto"])


def decoder_for(protocol, way="named"):
    return decoder_named("auto" if way == "auto" else protocol.removesuffix("_text"))


def fed(decoder, stream, cuts=()):
    parts, at = [], 0
    for cut in [*cuts, len(stream)]:
        parts.append(decoder.feed(stream[at : at + cut]))
        at += cut
    return joined(parts)


def assert_same(found, time_us, acc_g, gyr_dps):
    assert found.time_us.tolist() == time_us.tolist()
    assert np.allclose(found.acc_s_mps2, G * acc_g, rtol=1e-6, atol=1e-6)
    assert np.allclose(found.gyr_s_radps, np.radians(gyr_dps), rtol=1e-6, atol=1e-6)
    assert found.acc_s_mps2.dtype == np.float32


@each_protocol
@each_way
def test_what_was_sent_is_what_comes_out(protocol, way):
    decoder = decoder_for(protocol, way)
    stream = b"".join(messages(protocol, 200))
    assert_same(fed(decoder, (HEADER if protocol == "csv" else b"") + stream, [500, 1, 1000]), *samples(200))
    assert decoder.name == protocol.removesuffix("_text")
    assert decoder.has_time
    assert decoder.counts().garbage_bytes == decoder.counts().bad_sums == 0


@each_protocol
@each_way
@settings(deadline=None, max_examples=25)
@given(cuts=st.lists(st.integers(0, 400), max_size=30))
def test_however_a_stream_is_cut_the_same_rows_come_out(protocol, way, cuts):
    stream = b"".join(messages(protocol, 30))
    assert_same(fed(decoder_for(protocol, way), stream, cuts), *samples(30))


@each_protocol
@settings(deadline=None, max_examples=25)
@given(garbage=st.binary(min_size=1, max_size=200), at=st.integers(20, 40), cut=st.integers(1, 300))
def test_garbage_between_messages_costs_at_most_the_one_after_it(protocol, garbage, at, cut):
    sent = messages(protocol, 60)
    stream = b"".join([*sent[:at], garbage, *sent[at:]])
    decoder = decoder_for(protocol)
    found = fed(decoder, stream + bytes(80), [cut] * (len(stream) // cut))
    time_us = samples(60)[0]
    right = np.isin(time_us, found.time_us.astype(np.int64))
    right[at] = True
    assert right.all()
    strange = ~np.isin(found.time_us.astype(np.int64), time_us)
    assert strange.sum() <= (0 if protocol == "frames" else 1)  # digits may have run into a line's first number


@each_protocol
@each_way
def test_a_stream_that_is_joined_in_the_middle_of_a_message_loses_no_other(protocol, way):
    sent = messages(protocol, 60)
    for lost in [*range(1, 14), *range(14, len(sent[0]), 5)]:
        decoder = decoder_for(protocol, way)
        found = fed(decoder, b"".join(sent)[lost:], [70] * 20)
        time_us = found.time_us.tolist()
        expected = samples(60)[0].tolist()
        assert time_us[-59:] == expected[1:], lost
        assert time_us[:-59] in ([], expected[:1]), lost  # its time cannot be cut off unseen


@each_protocol
@settings(deadline=None, max_examples=25)
@given(noise=st.lists(st.binary(max_size=4000), max_size=6))
def test_nothing_that_comes_raises(protocol, noise):
    decoder = decoder_for(protocol, "auto")
    for part in [*noise, *messages(protocol, 20), *noise]:
        decoder.feed(part)
    assert decoder.counts().garbage_bytes >= 0


@each_protocol
@pytest.mark.parametrize("filler", [b"A", b"\0", b"\xc9", b"\xc5\x4c\x01\x00", b"1,", b"Accelerometer(", b"\xdb"])
def test_half_a_megabyte_without_an_end_takes_no_room_and_the_next_messages_are_found(protocol, filler):
    decoder = decoder_for(protocol)
    decoder.feed(b"".join(messages(protocol, 20)))
    blocks = [filler * (16384 // len(filler))] * 30
    decoder.feed(blocks[0])
    tracemalloc.start()
    decoder.feed(blocks[1])
    room, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert room < 40_000  # what it keeps
    for block in blocks[2:]:
        decoder.feed(block)
    assert decoder.counts().garbage_bytes > 0.99 * 30 * len(blocks[0]) - 2500
    later = messages(protocol, 60, first_s=30.0)
    found = fed(decoder, b"\n" + b"".join(later), [100] * 30)
    assert len(found) >= 59


@each_way
def test_bytes_that_are_lost_on_the_wire_cost_the_lines_that_they_belonged_to(way):
    for protocol in ("printed", "csv"):
        sent = messages(protocol, 60)
        stream = b"".join(sent)
        begin, size = len(b"".join(sent[:30])) + 50, len(sent[30])
        found = fed(decoder_for(protocol, way), stream[:begin] + stream[begin + size - 20 :])
        assert set(samples(60)[0].tolist()) - set(found.time_us.tolist()) <= set(samples(60)[0][30:32].tolist())


@pytest.mark.parametrize("after", PROTOCOLS)
@pytest.mark.parametrize("before", PROTOCOLS)
def test_another_protocol_is_found_after_a_while_of_garbage(before, after):
    decoder = decoder_named("auto")
    fed(decoder, b"".join(messages(before, 50)), [33] * 60)
    count = 400
    found = fed(decoder, b"".join(messages(after, count, first_s=60.0)), [256] * 500)
    assert decoder.name == after.removesuffix("_text")
    missing = count - len(found)
    assert missing * len(messages(after, 1)[0]) <= DOUBT_BYTES + 1500


def test_it_stays_with_its_protocol_through_a_bit_of_garbage():
    decoder = decoder_named("auto")
    fed(decoder, b"".join(messages("csv", 50)))
    decoder.feed(b"\x93\x01" * 1000 + b"\n")
    assert decoder.name == "csv"
    assert decoder.counts().garbage_bytes == 2001
    found = decoder.feed(b"".join(messages("csv", 10, first_s=70.0)))
    assert len(found) == 10


def test_while_nothing_is_known_the_garbage_is_still_counted():
    decoder = decoder_named("auto")
    for _ in range(20):
        assert not len(decoder.feed(b"hello world \xff\xfe\n" * 10))
    assert decoder.name == "auto"
    assert not decoder.has_time
    assert decoder.counts().garbage_bytes > 0


@each_protocol
def test_what_comes_after_a_pause_does_not_continue_what_came_before_it(protocol):
    sent = messages(protocol, 60)
    decoder = decoder_for(protocol, "auto")
    first = decoder.feed(b"".join(sent[:30]) + sent[30][:-20])
    decoder.restart()
    second = decoder.feed(sent[35][-21:] + b"".join(sent[36:]))
    expected = samples(60)[0].tolist()
    assert [*first.time_us.tolist(), *second.time_us.tolist()] == [*expected[:30], *expected[36:]]


def test_counters_are_the_devices_own_or_counted():
    stream = messages("frames", 50)
    del stream[20:25]
    assert decoder_for("frames").feed(b"".join(stream)).counter.tolist() == [*range(20), *range(25, 50)]
    decoder = decoder_named("csv")
    first, second = decoder.feed(HEADER + b"".join(messages("csv", 30))), decoder.feed(b"".join(messages("csv", 5)))
    assert [*first.counter.tolist(), *second.counter.tolist()] == list(range(35))
    assert not decoder.has_counter


def test_a_wrong_sum_is_counted():
    data = bytearray(b"".join(messages("frames", 20)))
    data[100] ^= 1
    decoder = decoder_named("frames")
    assert len(decoder.feed(bytes(data))) == 19
    assert decoder.counts().bad_sums == 1


def test_a_protocol_that_nobody_knows_is_told():
    with pytest.raises(LeaklineError) as caught:
        decoder_named("morse")
    assert caught.value.code is ErrorCode.SETTING_INVALID
    assert "printed" in caught.value.params["allowed"]
