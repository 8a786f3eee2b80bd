"""Leakline's binary frames: the written form, what damage costs, and the way into a recording."""

import binascii
import struct
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from processing.importing import frame_log
from processing.importing.folder import ImportOptions, import_folder
from processing.importing.frames import LONGEST, SYNC, FrameDecoder, Frames, checksums, encode
from processing.importing.raw import ReadContext
from processing.settings import ImportSettings


def samples(count, seed=0, *, extras=True, rate=400.0, first=0):
    rng = np.random.default_rng(seed)
    nothing = np.full(count, np.nan, np.float32)
    return Frames(
        counter=((first + np.arange(count)) % 2**32).astype(np.uint32),
        time_us=(5_000_000 + np.arange(count) * 1e6 / rate).astype(np.uint64),
        acc_s_mps2=(rng.normal(0, 0.2, (count, 3)) + np.array([0, 0, 9.81])).astype(np.float32),
        gyr_s_radps=rng.normal(0, 1, (count, 3)).astype(np.float32),
        mag_s_ut=rng.normal(0, 30, (count, 3)).astype(np.float32)
        if extras
        else np.full((count, 3), np.nan, np.float32),
        pressure_kpa=rng.normal(400, 1, count).astype(np.float32) if extras else nothing,
        temperature_c=nothing,
        quat_ws=np.full((count, 4), np.nan, np.float32),
        host_s=rng.uniform(0, 9, count) if extras else np.full(count, np.nan),
    )


def same(a, b):
    return all(np.array_equal(getattr(a, f.name), getattr(b, f.name), equal_nan=True) for f in fields(Frames))


def joined(parts):
    return Frames(**{f.name: np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Frames)})


def test_a_frame_is_written_as_its_table_says():
    one = samples(1)
    data = encode(one)
    body = struct.pack("<BBIQ3f3f3ffd", 1, 1 | 2 | 16, 0, 5_000_000, *one.acc_s_mps2[0], *one.gyr_s_radps[0],
                       *one.mag_s_ut[0], one.pressure_kpa[0], one.host_s[0])  # fmt: skip
    assert data == b"\xc5\x4c" + body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF))


def test_no_samples_are_no_bytes():
    assert encode(samples(0)) == b""


def test_the_checksum_is_that_of_the_standard():
    # the check value of CRC-16/CCITT-FALSE
    assert checksums(np.frombuffer(b"123456789", np.uint8)[None])[0] == 0x29B1


@given(st.lists(st.integers(1, 700), max_size=20), st.integers(0, 2**32 - 1))
@example([], 1_687_506_285)  # its last byte is the first of a beginning
def test_however_a_stream_is_cut_the_same_samples_come_out(cuts, first):
    sent = samples(40, first=first)
    data = encode(sent)
    decoder, parts, at = FrameDecoder(), [], 0
    for cut in [*cuts, len(data)]:
        parts.append(decoder.feed(data[at : at + cut]))
        at += cut
    assert same(joined(parts), sent)
    assert decoder.garbage_bytes == 0


@given(st.binary(max_size=300), st.binary(max_size=300), st.integers(0, 39))
def test_garbage_before_between_and_after_costs_no_frame(before, between, at):
    sent = samples(40, extras=False)
    size = len(encode(sent)) // 40
    data = encode(sent)
    decoder = FrameDecoder()
    found = joined(
        [decoder.feed(before + data[: at * size] + between + data[at * size :]), decoder.feed(SYNC + bytes(200))]
    )
    # a piece of garbage that looks like a beginning may wait for its end, but takes nothing with it
    assert set(found.counter.tolist()) == set(range(40))


def test_a_byte_that_is_wrong_costs_its_own_frame():
    sent = samples(100)
    size = len(encode(sent)) // 100
    for offset in range(size):
        data = bytearray(encode(sent))
        data[50 * size + offset] ^= 0x41
        decoder = FrameDecoder()
        found = joined([decoder.feed(bytes(data)), decoder.feed(bytes(LONGEST))])
        assert set(range(100)) - set(found.counter.tolist()) == {50}, offset
        assert decoder.garbage_bytes >= size


def test_frames_of_several_kinds_may_follow_one_another():
    with_field, without = samples(3, 1), samples(4, 2, extras=False)
    found = FrameDecoder().feed(encode(with_field) + encode(without) + encode(with_field))
    assert len(found) == 10
    assert np.isnan(found.mag_s_ut[3:7]).all()
    assert np.array_equal(found.mag_s_ut[7:], with_field.mag_s_ut)


def test_a_file_of_frames_is_a_recording(tmp_path):
    sent = samples(8000, first=2**32 - 4000)
    (tmp_path / "ball.lkf").write_bytes(b"hello" + encode(sent) + SYNC)
    recording = import_folder(tmp_path, ImportOptions(), ImportSettings())
    imu = recording.imu
    assert imu.sample_rate_hz == pytest.approx(400.0, rel=1e-6)
    assert len(imu.time_s) == 8000
    assert np.allclose(imu.acc_s_mps2, sent.acc_s_mps2, atol=1e-6)
    assert np.allclose(imu.mag_s_ut, sent.mag_s_ut, atol=1e-4)
    assert imu.valid.all()
    assert "frames_garbage" in [f.code for f in recording.findings]


def test_frames_that_were_lost_are_a_gap(tmp_path):
    sent = samples(8000)
    data, size = encode(sent), len(encode(sent)) // 8000
    (tmp_path / "ball.lkf").write_bytes(data[: 4000 * size] + data[4400 * size :])
    recording = import_folder(tmp_path, ImportOptions(), ImportSettings())
    gaps = [s for s in recording.not_assessed if s.end_s - s.start_s > 0.9]
    assert len(gaps) == 1
    assert gaps[0].end_s - gaps[0].start_s == pytest.approx(1.0, abs=0.05)


def test_what_holds_no_frame_is_not_taken_for_one(tmp_path):
    path = tmp_path / "x.lkf"
    path.write_bytes(bytes(5000) + SYNC * 30)
    assert frame_log.sniff(path, None) == 0.0
    with pytest.raises(Exception, match="frame"):
        frame_log.read(path, ReadContext())
