"""A recording's journal keeps what it was told, and bears whatever a dying computer leaves of it."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import LinkState
from processing.storage.journal import JournalEvent, is_ended, journal_line, line_bytes, read_journal

VALUES = st.dictionaries(
    st.text(max_size=8),
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    max_size=4,
)


@given(lines=st.lists(st.tuples(st.sampled_from(list(JournalEvent)), VALUES), max_size=6), cut=st.integers(0, 10_000))
def test_a_torn_end_costs_only_its_own_line(tmp_path_factory, lines, cut):
    path = tmp_path_factory.mktemp("journal") / "recording.jsonl"
    told = [journal_line(event, values, host_s=float(i)) for i, (event, values) in enumerate(lines)]
    raw = [line_bytes(line) for line in told]
    whole = b"".join(raw)
    kept = whole[: min(cut, len(whole))]
    path.write_bytes(kept)
    ends = np.cumsum([len(line) for line in raw])
    assert list(read_journal(path)) == told[: int((ends <= len(kept)).sum())]


def test_what_is_no_line_of_ours_is_passed_over(tmp_path):
    path = tmp_path / "recording.jsonl"
    good = line_bytes(journal_line(JournalEvent.NOTE, {"text": "vana 12 geçildi"}))
    foreign = (
        b'{"event": 3}\n[1]\n\x00\x00\x00\n\xff\xfe\n'
        + b"[" * 100_000
        + b'\n{"event":"a","utc":"","host_s":NaN,"values":{}}\n'
    )
    path.write_bytes(foreign + good + b'{"event":"st')
    (line,) = read_journal(path)
    assert (line.event, line.values) == ("note", {"text": "vana 12 geçildi"})


def test_numbers_and_names_of_every_kind_become_plain_json(tmp_path):
    line = journal_line(
        JournalEvent.SOUND_STATE, {"state": LinkState.LOST, "frame": np.int64(7), "ppm": math.nan, "path": tmp_path}
    )
    plain = json.loads(line_bytes(line))
    assert plain["values"] == {"state": "lost", "frame": 7, "ppm": None, "path": str(tmp_path)}


def test_a_recording_has_ended_only_when_its_last_line_says_so(tmp_path):
    path = tmp_path / "recording.jsonl"
    stopped = line_bytes(journal_line(JournalEvent.STOPPED, {}))
    path.write_bytes(b"")
    assert not is_ended(path)
    path.write_bytes(stopped * 3000)
    assert is_ended(path)
    path.write_bytes(stopped[:-1])
    assert not is_ended(path)
    path.write_bytes(stopped + line_bytes(journal_line(JournalEvent.NOTE, {})))
    assert not is_ended(path)
    with pytest.raises(LeaklineError) as missing:
        is_ended(tmp_path / "none.jsonl")
    assert missing.value.code is ErrorCode.FILE_MISSING
