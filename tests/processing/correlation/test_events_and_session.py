"""Knocks on both recorders give the clocks; a session comes back as it was written, and a bad one is refused."""

import json

import numpy as np
import pytest
from correlator_runs import pair_on_disk, pipe_of, source_of
from hypothesis import given, settings
from hypothesis import strategies as st

from processing import messages
from processing.correlation.analysis import Choice, analyse, read
from processing.correlation.correlogram import Suppressed
from processing.correlation.events import EventOffset, offset_of_event, sync_of_events
from processing.correlation.phase_fit import DispersionChoice
from processing.correlation.pipe import Pipe, PipeSection
from processing.correlation.recordings import Pair, Sync, SyncKind
from processing.correlation.report import CorrelationReport, headline, numbers, write_report
from processing.correlation.session import CorrelatorSession, RecordingChoice, read_session, write_session
from processing.correlation.simulation import SimulatedPair
from processing.correlation.weighting import Band, Weighting
from processing.errors import ErrorCode, LeaklineError
from processing.progress import silent

RATE = 4000


def knocked(offset_s, times_s, seconds=20.0, seed=0):
    """Return two recordings of the same knocks, each through its own microphone, B begun ``offset_s`` later."""
    rng = np.random.default_rng(seed)
    sounds = []
    for shift in (0.0, offset_s):
        time_s = np.arange(int(seconds * RATE)) / RATE + shift
        sound = 0.002 * rng.standard_normal(len(time_s))
        for at in times_s:
            after = np.clip(time_s - at, 0.0, None)
            sound += 0.4 * np.where(time_s >= at, np.exp(-after * 150.0) * np.sin(2 * np.pi * 700.0 * after), 0.0)
        sounds.append(sound)
    return sounds


def test_knocks_give_the_offset_of_the_clocks(tmp_path):
    a, b = knocked(1.73456, (3.0, 3.9, 6.1, 7.0, 9.4))
    pair = Pair(source_of(tmp_path / "a.wav", a, RATE), source_of(tmp_path / "b.wav", b, RATE))
    found = offset_of_event(pair, 2.0, 11.0, silent())
    assert found.offset_s == pytest.approx(1.73456, abs=3e-4)
    assert found.sigma_s < 2e-3


def test_an_even_rhythm_is_refused_since_it_fits_in_many_places(tmp_path):
    a, b = knocked(2.0, np.arange(4.0, 14.0, 1.0))
    pair = Pair(source_of(tmp_path / "a.wav", a, RATE), source_of(tmp_path / "b.wav", b, RATE))
    with pytest.raises(LeaklineError) as caught:
        offset_of_event(pair, 5.5, 9.5, silent())
    assert caught.value.code is ErrorCode.CORRELATION_NO_EVENT


@pytest.mark.parametrize("stretch", [(2.0, 11.0), (5.0, 5.1)])
def test_unrelated_sound_gives_no_offset(tmp_path, stretch):
    rng = np.random.default_rng(1)
    sources = [source_of(tmp_path / f"{n}.wav", 0.05 * rng.standard_normal(20 * RATE), RATE) for n in "ab"]
    with pytest.raises(LeaklineError) as caught:
        offset_of_event(Pair(*sources), *stretch, silent())
    assert caught.value.code is ErrorCode.CORRELATION_NO_EVENT


def test_two_events_give_the_drift():
    """A clock that runs 30 ppm fast loses 30 µs of offset each second."""
    sync = sync_of_events((EventOffset(10.0, 0.5, 1e-4), EventOffset(1010.0, 0.5 - 0.03, 2e-4)))
    assert sync.drift_ppm == pytest.approx(30.0)
    assert sync.offset_s == pytest.approx(0.5003)
    assert sync.sigma_s == 2e-4
    assert sync_of_events(()).known is False
    assert sync_of_events((EventOffset(10.0, 0.5, 1e-4),)) == Sync(SyncKind.EVENT, 0.5, 1e-4, at_s=10.0)


# --- sessions ---

numbers_st = st.floats(-100.0, 100.0, allow_nan=False)
sessions = st.builds(
    CorrelatorSession,
    a=st.builds(RecordingChoice, st.just(()), st.integers(0, 7)),
    b=st.builds(RecordingChoice, st.just(()), st.integers(0, 7)),
    sync=st.builds(Sync, st.sampled_from(SyncKind), numbers_st, st.floats(0.0, 10.0), numbers_st),
    start_s=st.floats(0.0, 100.0),
    end_s=st.none() | st.floats(101.0, 1000.0),
    pipe=st.builds(
        Pipe,
        st.lists(
            st.builds(
                PipeSection,
                st.floats(0.0, 1000.0),
                st.sampled_from(["pvc", "steel", "other", "glass"]),
                st.none() | st.floats(0.01, 2.0),
                st.none() | st.floats(0.001, 0.1),
                st.none() | st.floats(100.0, 1600.0),
                st.none() | st.floats(0.0, 100.0),
                st.floats(0.0, 10.0),
            ),
            max_size=3,
        ).map(tuple),
        st.none() | st.floats(1.0, 1000.0),
    ),
    choice=st.builds(
        Choice,
        st.sampled_from(Weighting),
        st.none() | st.builds(Band, st.floats(1.0, 100.0), st.floats(101.0, 5000.0), st.booleans()),
        st.builds(DispersionChoice, st.floats(-0.1, 0.1), st.floats(0.0, 0.1), st.none() | st.floats(1.0, 1000.0)),
        st.lists(st.builds(Suppressed, numbers_st, st.floats(1e-4, 1.0), st.text(max_size=20)), max_size=2)
        .map(tuple),
        st.booleans(),
    ),
    note=st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=50),
)  # fmt: skip


@settings(max_examples=40, deadline=None)
@given(session=sessions.filter(lambda s: not any("\0" in p.name for p in s.choice.suppressed)))
def test_a_session_comes_back_as_it_was_written(tmp_path_factory, session):
    path = tmp_path_factory.mktemp("s") / "one.leakcorr"
    write_session(path, session)
    assert read_session(path) == session


def test_recordings_are_named_from_the_sessions_folder_and_move_with_it(tmp_path):
    (tmp_path / "job" / "sound").mkdir(parents=True)
    wave = tmp_path / "job" / "sound" / "a.wav"
    recording = RecordingChoice((wave,), 1)
    write_session(tmp_path / "job" / "one.leakcorr", CorrelatorSession(recording, recording))
    assert json.loads((tmp_path / "job" / "one.leakcorr").read_text())["a"]["files"] == ["sound/a.wav"]
    (tmp_path / "job").rename(tmp_path / "moved")
    assert read_session(tmp_path / "moved" / "one.leakcorr").a.paths == (tmp_path / "moved" / "sound" / "a.wav",)


GOOD = {"format": "leakline-correlator", "version": 1, "a": {"files": ["a.wav"]}, "b": {"files": ["b.wav"]}}


@pytest.mark.parametrize(
    ("change", "key"),
    [
        ({"format": "something"}, "format"),
        ({"a": ["a.wav"]}, "a"),
        ({"a": {"files": "a.wav"}}, "a.files"),
        ({"a": {"files": [1]}}, "files"),
        ({"a": {"files": ["a.wav"], "channel": 1e9}}, "a.channel"),
        ({"sections": [{"length_m": "ten"}]}, "sections[0].length_m"),
        ({"sections": [{"length_m": True}]}, "sections[0].length_m"),
        ({"sections": [{}]}, "sections[0].length_m"),
        ({"sections": [{"length_m": 1.0}] * 21}, "sections"),
        ({"band_hz": [500, 100]}, "band_hz"),
        ({"band_hz": [500]}, "band_hz"),
        ({"weighting": "best"}, "weighting"),
        ({"start_s": 9, "end_s": 3}, "end_s"),
        ({"sync": {"drift_ppm": 1e6}}, "sync.drift_ppm"),
        ({"note": "x" * 5000}, "note"),
        ({"divide_resonances": "yes"}, "divide_resonances"),
    ],
)
def test_a_damaged_session_is_refused_with_the_key_that_is_wrong(tmp_path, change, key):
    path = tmp_path / "bad.leakcorr"
    path.write_text(json.dumps(GOOD | change))
    with pytest.raises(LeaklineError) as caught:
        read_session(path)
    assert caught.value.code is ErrorCode.CORRELATION_SESSION_DAMAGED
    assert caught.value.params["entry"] == key
    assert all(key in messages.error_sentence(caught.value, language) for language in messages.LANGUAGES)


@pytest.mark.parametrize(
    "content", [b"", b"{", b"\xff\xfe", b"[" * 100_000, b"null", b'{"a": NaN, "format": 1e999}', b" " * 1_000_001]
)
def test_what_is_no_session_is_refused(tmp_path, content):
    path = tmp_path / "bad.leakcorr"
    path.write_bytes(content)
    with pytest.raises(LeaklineError) as caught:
        read_session(path)
    assert caught.value.code is ErrorCode.CORRELATION_SESSION_DAMAGED


def test_a_newer_session_is_told_apart_from_a_damaged_one(tmp_path):
    (tmp_path / "new.leakcorr").write_text(json.dumps(GOOD | {"version": 2}))
    with pytest.raises(LeaklineError) as caught:
        read_session(tmp_path / "new.leakcorr")
    assert caught.value.code is ErrorCode.CORRELATION_SESSION_NEWER


# --- what is written ---


@pytest.mark.parametrize("language", ["en", "tr"])
def test_page_curve_and_numbers_say_where_the_leak_is(tmp_path, language):
    import pypdf

    what = SimulatedPair(leak_m=30.0, snr_db=3.0, duration_s=15.0, rate_hz=2400)
    pair, pipe = pair_on_disk(tmp_path, what), pipe_of(what, 0.01)
    choice = Choice(suppressed=(Suppressed(-0.1, 0.002, "pump <1>"),))
    result = analyse(read(pair, pipe, silent()), pipe, pair.sync, choice)
    report = CorrelationReport(result, pair, pipe, choice, "Nöbet: Işıl", language)
    curve, values, page = write_report(tmp_path / "corr", report)
    rows = np.loadtxt(curve, delimiter=",", skiprows=1)
    top = rows[np.argmax(rows[:, 2])]
    assert top[1] == pytest.approx(30.0, abs=0.6)
    assert top[0] == pytest.approx(1e3 * (100.0 - 2.0 * top[1]) / 400.0, abs=1e-3)
    data = json.loads(values.read_text(encoding="utf-8"))
    assert data == numbers(report)
    assert data["leak"]["from_a_m"] == pytest.approx(30.0, abs=0.3)
    assert data["leak"]["from_a_m"] + data["leak"]["from_b_m"] == pytest.approx(100.0)
    reader = pypdf.PdfReader(page)
    text = reader.pages[0].extract_text()
    assert len(reader.pages) == 1
    for words in (headline(report)[0], "pump <1>", "Işıl", "a.wav"):
        assert words in text
    assert ("%95" if language == "tr" else "95 %") in text


def test_a_report_that_cannot_be_written_is_a_sentence(tmp_path):
    what = SimulatedPair(duration_s=15.0, rate_hz=2400)
    pair, pipe = pair_on_disk(tmp_path, what), pipe_of(what)
    result = analyse(read(pair, pipe, silent()), pipe, pair.sync, Choice())
    with pytest.raises(LeaklineError) as caught:
        write_report(tmp_path / "nowhere" / "corr", CorrelationReport(result, pair, pipe, Choice()))
    assert caught.value.code is ErrorCode.CANNOT_WRITE
