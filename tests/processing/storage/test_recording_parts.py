"""Parts of a recording hold what was given, bit for bit, however it came in pieces, and are whole at any moment."""

import errno
import os
import wave
from contextlib import contextmanager

import numpy as np
import pytest
import soundfile
from hypothesis import given, settings
from hypothesis import strategies as st
from killed_recording import known_motion

from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import FrameDecoder, encode
from processing.sound.riff import read_wave_layout
from processing.storage.growing_file import GrowingFile
from processing.storage.motion_parts import MotionParts, joined
from processing.storage.sound_parts import LARGEST_PART, SoundForm, SoundParts, packed

SUBTYPES = ("PCM_16", "PCM_24", "PCM_32", "FLOAT")


def any_sound(count, channels, seed=3):
    return np.random.default_rng(seed).integers(-(2**31), 2**31, (count, channels), dtype=np.int32)


@pytest.fixture
def begun():
    """A list of the parts that begin, closed in the end."""
    with listening() as files:
        yield files


@contextmanager
def listening():
    files = []
    try:
        yield files
    finally:
        for file, _ in files:
            file.close()


def to(files):
    """Return the function that hears of a new part."""
    return lambda file, first: files.append((file, first))


@pytest.mark.parametrize("subtype", ["PCM_16", "PCM_24", "PCM_32"])
def test_sound_has_the_bytes_that_libsndfile_would_write(tmp_path, subtype):
    sound = any_sound(1000, 3)
    soundfile.write(tmp_path / "peer.wav", sound, 44100, subtype=subtype)
    layout = read_wave_layout(tmp_path / "peer.wav")
    peer = (tmp_path / "peer.wav").read_bytes()[layout.data_offset :][: layout.data_bytes]
    assert packed(sound, subtype) == peer


def test_floats_are_the_numbers_between_minus_one_and_one(tmp_path, begun):
    parts = SoundParts(tmp_path, SoundForm(96000, 2, "FLOAT"), 60.0, to(begun))
    sound = any_sound(1000, 2) >> 8 << 8  # a float has 24 bits
    parts.put(packed(sound, "FLOAT"))
    parts.flush()
    read, rate = soundfile.read(tmp_path / "audio-001.wav", dtype="float64")
    assert rate == 96000
    assert np.array_equal(read, sound / 2.0**31)


@settings(max_examples=30, deadline=None)
@given(
    pieces=st.lists(st.tuples(st.booleans(), st.integers(0, 300)), min_size=1, max_size=8),
    part_frames=st.integers(40, 400),
    channels=st.integers(1, 3),
    subtype=st.sampled_from(SUBTYPES),
)
def test_parts_continue_each_other_without_a_gap_however_the_pieces_come(
    tmp_path_factory, pieces, part_frames, channels, subtype
):
    folder, given_bytes = tmp_path_factory.mktemp("parts"), b""
    form = SoundForm(1000, channels, subtype)
    with listening() as begun:
        parts = SoundParts(folder, form, part_frames / 1000, to(begun))
        for seed, (is_silent, count) in enumerate(pieces):
            piece = count if is_silent else packed(any_sound(count, channels, seed), subtype)
            parts.put(piece)
            given_bytes += bytes(count * form.frame_bytes) if is_silent else piece
            if seed % 3:
                parts.flush()
        parts.flush()
    found = sorted(folder.glob("*.wav"))
    layouts = [read_wave_layout(path) for path in found]
    assert not any(layout.is_repaired for layout in layouts)
    assert [layout.frames for layout in layouts[:-1]] == [part_frames] * max(0, len(found) - 1)
    content = [path.read_bytes()[layout.data_offset :] for path, layout in zip(found, layouts, strict=True)]
    assert b"".join(content) == given_bytes
    names = [(file.path.name, first) for file, first in begun]
    assert names == [(f"audio-{i + 1:03d}.wav", i * part_frames) for i in range(len(found))]
    assert parts.frames == len(given_bytes) // form.frame_bytes


@pytest.mark.parametrize("channels", [1, 2])
def test_every_reader_opens_a_part_while_it_grows(tmp_path, channels, begun):
    parts = SoundParts(tmp_path, SoundForm(48000, channels), 3600.0, to(begun))
    for count in range(1, 8):
        parts.put(packed(any_sound(481, channels), "PCM_24"))
        parts.flush()
        path = tmp_path / "audio-001.wav"
        assert soundfile.info(path).frames == 481 * count
        with wave.open(str(path)) as plain:
            form = (plain.getnframes(), plain.getnchannels(), plain.getsampwidth(), plain.getframerate())
        assert form == (481 * count, channels, 3, 48000)


def test_a_part_stays_below_two_gigabytes_however_long_it_may_last(tmp_path, begun):
    parts = SoundParts(tmp_path, SoundForm(192000, 8, "PCM_32"), 86400.0, to(begun))
    most = parts._part_frames * parts.form.frame_bytes + parts._head
    assert LARGEST_PART - parts.form.frame_bytes <= most < LARGEST_PART < 2**31


@settings(max_examples=30, deadline=None)
@given(
    sizes=st.lists(st.integers(0, 60), min_size=1, max_size=10), part_rows=st.integers(10, 100), gap=st.integers(0, 400)
)
def test_motion_is_cut_by_survey_time_and_comes_back_as_it_was(tmp_path_factory, sizes, part_rows, gap):
    folder = tmp_path_factory.mktemp("motion")
    with listening() as begun:
        parts = MotionParts(folder, part_rows * 0.0025, to(begun))
        blocks, at = [], 0
        for i, size in enumerate(sizes):
            blocks.append(known_motion(at, size))
            at += size + (gap if i == len(sizes) // 2 else 0)
            parts.put(blocks[-1])
            if i % 2:
                parts.flush()
        parts.flush()
    whole = joined(blocks)
    found = sorted(folder.glob("*.lkf"))
    assert b"".join(path.read_bytes() for path in found) == (encode(whole) if len(whole) else b"")
    for path, (_, first) in zip(found, begun, strict=True):
        stored = FrameDecoder().feed(path.read_bytes())
        assert int(stored.time_us[0]) == first
        part = (stored.time_us.astype(np.int64) - int(whole.time_us[0])) // (2500 * part_rows)
        assert len(set(part.tolist())) == 1
    assert parts.samples == len(whole)


def test_what_fails_to_be_appended_leaves_no_trace_and_can_be_tried_again(tmp_path, monkeypatch):
    file = GrowingFile(tmp_path / "a.bin", "audio", b"head")
    real = os.write

    def half(handle, data):
        if len(data) < 4:
            raise OSError(errno.ENOSPC, "full")
        return real(handle, data[: len(data) // 2])

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", half)
        with pytest.raises(LeaklineError) as full:
            file.append(b"0123456789")
    assert full.value.code is ErrorCode.DISC_FULL
    assert file.path.read_bytes() == b"head"
    file.append(b"0123456789")
    file.rewrite(0, b"HEAD")
    file.sync()
    assert file.synced_size == file.size == 14
    file.close()
    file.close()
    assert file.path.read_bytes() == b"HEAD0123456789"


def test_a_part_that_cannot_even_begin_leaves_no_empty_file(tmp_path, monkeypatch, begun):
    def none(handle, data):
        raise OSError(errno.EDQUOT, "quota")

    parts = SoundParts(tmp_path, SoundForm(8000), 60.0, to(begun))
    parts.put(packed(any_sound(10, 1), "PCM_24"))
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", none)
        with pytest.raises(LeaklineError) as full:
            parts.flush()
    assert full.value.code is ErrorCode.DISC_FULL
    assert list(tmp_path.iterdir()) == []
    parts.flush()
    assert soundfile.info(tmp_path / "audio-001.wav").frames == 10
