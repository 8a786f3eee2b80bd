"""A live recording's parts and journal as the import reads them: parts are one log, gaps are told and not assessed."""

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import soundfile
from arrivals import frames_at
from hypothesis import given, settings
from hypothesis import strategies as st
from small_survey import RATE_HZ as SURVEY_RATE
from small_survey import SURVEY, make_device_folder

from processing import messages
from processing.importing.folder import ImportOptions, import_folder, preview_folder
from processing.importing.frames import encode
from processing.importing.live_journal import MOST_BYTES, Journal, journal_in, with_gaps
from processing.pipeline import process
from processing.settings import Settings
from processing.sound.gaps import gap_stretches, outside, told_once
from processing.storage.cache import Cache
from processing.survey import AudioGap, AudioPart, AudioSource, Channel, ClockMap, Stretch

RATE, IMU_RATE = 8000, 200


def write_parts(folder, bounds, counter0=0, hole=None, name="imu"):
    """Samples from ``bounds[0]`` to the last in parts; ``hole`` (from, to) was never there."""
    rows = np.arange(bounds[0], bounds[-1])
    if hole is not None:
        rows = rows[(rows < hole[0]) | (rows >= hole[1])]
    frames = frames_at(5_000_000 + rows * (1_000_000 // IMU_RATE), counter0 + rows, seed=1)
    frames.acc_s_mps2[:, 2] += 9.81
    for number, (start, end) in enumerate(pairwise(bounds), 1):
        here = (rows >= start) & (rows < end)
        part = type(frames)(*(getattr(frames, field)[here] for field in frames.__dataclass_fields__))
        (folder / f"{name}-{number:03d}.lkf").write_bytes(encode(part) if here.any() else b"")


def write_sound(folder, seconds, silent=()):
    sound = np.random.default_rng(2).normal(0, 0.05, round(seconds * RATE))
    for start_s, end_s in silent:
        sound[round(start_s * RATE) : round(end_s * RATE)] = 0.0
    soundfile.write(folder / "audio-001.wav", sound, RATE, subtype="PCM_24")


def write_journal(folder, *lines, tail=b""):
    rows = [
        json.dumps({"event": event, "utc": "2026-11-22T10:00:00Z", "host_s": 1.0, "values": values})
        for event, values in lines
    ]
    (folder / "recording.jsonl").write_bytes("".join(f"{row}\n" for row in rows).encode() + tail)


def codes(recording):
    for finding in recording.findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    for stretch in recording.not_assessed:
        for language in messages.LANGUAGES:
            assert messages.text("reasons", stretch.reason, language)
    return {finding.code for finding in recording.findings}


def test_parts_are_one_recording_whose_times_and_counter_go_on(tmp_path):
    write_parts(tmp_path, [0, 1000, 2500, 4000], counter0=2**32 - 1500)
    recording = import_folder(tmp_path)
    assert np.array_equal(np.round(1e6 * recording.imu.time_s), np.arange(4000) * 5000)
    assert [f.path.name for f in recording.files if f.role == "imu"] == [f"imu-00{n}.lkf" for n in (1, 2, 3)]
    assert all(len(f.sha256) == 64 for f in recording.files)
    assert not codes(recording) & {"several_imu_logs", "gaps", "time_restart"}


def test_it_does_not_matter_which_part_is_largest(tmp_path):
    write_parts(tmp_path, [0, 300, 4000])
    assert len(import_folder(tmp_path).imu.time_s) == 4000


def test_a_part_after_a_missing_one_is_another_log(tmp_path):
    write_parts(tmp_path, [0, 2000, 3000, 4000])
    (tmp_path / "imu-002.lkf").unlink()
    recording = import_folder(tmp_path)
    assert len(recording.imu.time_s) == 2000
    (finding,) = [f for f in recording.findings if f.code == "several_imu_logs"]
    assert finding.params["others"] == "imu-003.lkf"


def test_logs_of_separate_runs_with_numbered_names_are_not_joined(tmp_path):
    write_parts(tmp_path, [0, 2000], name="ball-a")
    (tmp_path / "ball-a-001.lkf").rename(tmp_path / "run-001.lkf")
    write_parts(tmp_path, [0, 2000], name="ball-b")
    (tmp_path / "ball-b-001.lkf").rename(tmp_path / "run-002.lkf")
    recording = import_folder(tmp_path)
    assert len(recording.imu.time_s) == 2000
    assert "several_imu_logs" in codes(recording)
    assert [f.path.name for f in recording.files] == ["run-001.lkf"]


def test_an_empty_last_part_and_a_torn_frame_cost_nothing_else(tmp_path):
    write_parts(tmp_path, [0, 2000, 4000])
    with (tmp_path / "imu-002.lkf").open("ab") as file:
        file.write(b"\xc5\x4c\x01\x10torn")
    (tmp_path / "imu-003.lkf").write_bytes(b"")
    recording = import_folder(tmp_path)
    assert len(recording.imu.time_s) == 4000
    assert "frames_garbage" in codes(recording)


def test_a_preview_names_all_files_of_the_recording(tmp_path):
    write_parts(tmp_path, [0, 2000, 4000])
    write_sound(tmp_path, 20)
    write_journal(tmp_path, ("stopped", {}))
    preview = preview_folder(tmp_path)
    assert preview.ready
    assert {p.name for p in preview.paths} == {"imu-001.lkf", "imu-002.lkf", "audio-001.wav", "recording.jsonl"}


def test_gaps_of_the_sound_are_told_and_kept_on_its_clock(tmp_path):
    write_parts(tmp_path, [0, 4000])
    write_sound(tmp_path, 20, silent=[(5.0, 5.5), (9.0, 9.02)])
    gaps = [{"frame": 40_000, "frames": 4000, "reason": "sound_input_lost"}, {"frame": 72_000, "frames": 160}]
    write_journal(
        tmp_path, ("started", {}), *(("sound_gap", gap) for gap in gaps), ("stopped", {}), tail=b'{"event":"no'
    )
    recording = import_folder(tmp_path)
    (told,) = [f for f in recording.findings if f.code == "live_sound_lost"]
    assert told.params == pytest.approx(
        {"count": 2, "total_s": 0.52, "first_s": 5.0, "longest_s": 0.5, "longest_at_s": 5.0}
    )
    assert [(g.start_s, g.end_s) for g in recording.audio.gaps] == [(5.0, 5.5), (9.0, 9.02)]
    assert recording.audio.gaps[1].reason == "live_sound_lost"
    assert [f.path.name for f in recording.files if f.role == "journal"] == ["recording.jsonl"]


def test_a_restart_says_why_there_is_no_motion_and_a_loss_is_counted(tmp_path):
    write_parts(tmp_path, [0, 4000], hole=(1000, 1400))
    write_journal(
        tmp_path,
        ("motion_gap", {"start_s": 4.995, "end_s": 7.0, "lost": 399, "reason": "live_restart"}),
        ("motion_restart", {"time_us": 12_000_000}),
        ("motion_gap", {"start_s": 15.0, "end_s": 15.01, "lost": 1, "reason": "live_lost"}),
        ("stopped", {}),
    )
    recording = import_folder(tmp_path)
    assert recording.not_assessed == (Stretch(4.995, 7.0, Channel.PATH, "live_restart"),)
    told = {f.code: f.params for f in recording.findings}
    assert told["live_motion_lost"] == {"count": 400}
    assert told["live_motion_restarts"] == pytest.approx({"count": 1, "first_s": 4.995, "longest_s": 2.005})
    assert codes(recording) >= {"gaps", "live_motion_lost", "live_motion_restarts"}


@pytest.mark.parametrize(
    ("code", "told"), [("disc_full", "live_ended_disc_full"), ("cannot_write", "live_ended_by_fault")]
)
def test_a_fault_that_ended_the_recording_is_told(tmp_path, code, told):
    write_parts(tmp_path, [0, 4000])
    write_journal(tmp_path, ("fault", {"code": code, "reason": "x"}))
    assert told in codes(import_folder(tmp_path))


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=20),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
keys = st.sampled_from(["frame", "frames", "start_s", "end_s", "lost", "reason", "code", "x"])
events = st.sampled_from(["sound_gap", "motion_gap", "motion_restart", "fault", "stopped", "unheard-of"])


@given(st.lists(st.tuples(events, st.dictionaries(keys, anything, max_size=5)), max_size=8), st.binary(max_size=60))
@settings(max_examples=60, deadline=None)
def test_whatever_a_journal_says_it_is_read(tmp_path_factory, lines, tail):
    folder = tmp_path_factory.mktemp("journal")
    write_journal(folder, *lines, tail=tail)
    journal, findings = journal_in(folder)
    assert findings == ()
    assert all(frames > 0 and first >= 0 for first, frames, _ in journal.sound_gaps)
    assert all(gap.start_s >= 0 and np.isfinite(gap.end_s) for gap in journal.motion_gaps)
    for finding in journal.findings(48_000.0):
        assert messages.finding_sentence(finding)


def test_a_journal_of_impossible_size_is_not_read(tmp_path):
    with (tmp_path / "recording.jsonl").open("wb") as file:
        file.truncate(MOST_BYTES + 1)
    journal, (finding,) = journal_in(tmp_path)
    assert journal is None
    assert finding.code == "live_journal_unreadable"


def test_thousands_of_gaps_become_few_and_hide_none():
    audio = AudioSource((AudioPart(Path("a.wav"), 43_200 * RATE),), RATE, 1)
    lost = tuple((nth * 3 * RATE, 80, "live_sound_lost") for nth in range(14_400))
    gaps = with_gaps(audio, Journal(Path("recording.jsonl"), lost)).gaps
    assert len(gaps) <= 1000
    starts, ends = np.array([g.start_s for g in gaps]), np.array([g.end_s for g in gaps])
    at_s = np.array([first for first, _, _ in lost]) / RATE
    which = np.searchsorted(starts, at_s, side="right") - 1
    assert (at_s + 0.01 <= ends[which] + 1e-9).all()


def test_a_gap_is_masked_with_its_edges_and_told_once():
    audio = AudioSource((), RATE, 1, gaps=(AudioGap(10.0, 12.0, "live_sound_lost"),))
    clock = ClockMap(100.0, 1e4)
    (gap,) = gap_stretches(audio, clock)
    assert (gap.start_s, gap.end_s) == (pytest.approx(100 + 9.9 / 1.01), pytest.approx(100 + 12.1 / 1.01))
    inside = Stretch(gap.start_s + 0.05, gap.end_s - 0.05, Channel.SOUND, "sound_dropout")
    elsewhere = Stretch(0.0, gap.end_s, Channel.SOUND, "sound_clipped")
    assert told_once([inside, elsewhere], [gap]) == (elsewhere,)
    assert outside(np.array([9.0, 9.95, 11.0, 12.05, 13.0]), audio.gaps).tolist() == [True, False, False, False, True]


def test_a_single_part_can_still_be_opened_by_itself(tmp_path):
    write_parts(tmp_path, [0, 2000, 4000])
    recording = import_folder(tmp_path, ImportOptions(imu_file=tmp_path / "imu-002.lkf"))
    assert len(recording.imu.time_s) == 2000


def test_zeros_of_a_gap_are_neither_a_quiet_pipe_nor_an_edge_of_a_leak(tmp_path):
    device = make_device_folder(tmp_path)
    sound, _ = soundfile.read(device / "audio.wav")
    spans = [(20.0, 23.0), (30.0, 30.005), (35.0, 35.03)]
    for start_s, end_s in spans:
        sound[round(start_s * SURVEY_RATE) : round(end_s * SURVEY_RATE)] = 0.0
    soundfile.write(device / "audio.wav", sound, SURVEY_RATE, subtype="PCM_16")
    lines = [
        ("sound_gap", {"frame": round(a * SURVEY_RATE), "frames": round((b - a) * SURVEY_RATE), "reason": "gone"})
        for a, b in spans
    ]
    write_journal(device, *lines, ("stopped", {}))
    recording = import_folder(device)
    results = process(SURVEY, recording, Settings(), Cache(tmp_path / "cache"))
    told = [s for s in results.not_assessed if s.channel is Channel.SOUND]
    assert [(s.start_s, s.end_s) for s in told] == [pytest.approx((a - 0.1, b + 0.1), abs=1e-3) for a, b in spans]
    assert {s.reason for s in told} == {"live_sound_lost"}
    assert not [c for c in results.candidates if any(s.start_s <= c.time_s <= s.end_s for s in told)]
    felt = results.clock_fit.heard_s
    assert not any(a - 0.1 <= t <= b + 0.1 for t in felt for a, b in spans)
