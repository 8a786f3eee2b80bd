"""A recording is an ordinary survey at every moment, and whatever fails, what was accepted before is there."""

import errno
import os
import shutil
import sqlite3
import threading
import time
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from killed_recording import known_motion, known_sound, motion_in, sound_in

from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.importing.folder import ImportOptions, import_folder
from processing.pipeline import read_recording
from processing.settings import ImportSettings
from processing.storage import disc_space, recording_keeper, recording_streams
from processing.storage.cache import Cache
from processing.storage.folder import SurveyFolder
from processing.storage.growing_file import GrowingFile
from processing.storage.journal import JournalEvent, read_journal
from processing.storage.recording_writer import RecordingWriter, SoundForm
from processing.storage.sound_parts import SoundParts
from processing.survey import Severity, Survey, SurveyInfo, TiePoint

FORM = SoundForm(48000)
PATIENCE_S = 20.0


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """Sync ten times a second, that a test need not wait."""
    monkeypatch.setattr(recording_keeper, "SYNC_S", 0.1)
    monkeypatch.setattr(recording_streams, "DRAIN_S", 0.01)


@contextmanager
def recording(target, **how):
    how = {"motion": True} | how
    writer = RecordingWriter.create(target, Survey(SurveyInfo("Kayıt", date="2026-11-22")), FORM, **how)
    try:
        yield writer
    finally:
        writer.close()


@pytest.fixture
def writer(tmp_path):
    with recording(tmp_path) as writer:
        yield writer


def original(writer):
    return writer.path / "recordings" / "1" / "original"


def give(writer, seconds, start_s=0.0):
    """Hand over known sound and motion in blocks of 0.1 s."""
    for i in range(round(10 * start_s), round(10 * (start_s + seconds))):
        writer.write_sound(known_sound(4800 * i, 4800))
        writer.write_motion(known_motion(40 * i, 40))


def wait_for(is_so):
    deadline = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.01)


def wait_written(writer):
    """Wait until all that was handed over is on the disc for sure."""
    now = time.monotonic()
    wait_for(lambda: (writer.status().synced_host_s or 0.0) > now)


def codes(folder):
    for finding in folder.findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    return [finding.code for finding in folder.findings]


def events(writer):
    return [line.event for line in read_journal(original(writer) / "recording.jsonl")]


# --- an ordinary survey


def test_a_finished_recording_is_a_survey_whose_files_have_their_sums(tmp_path):
    with recording(tmp_path, part_s=0.5, operator="Ayşe") as writer:
        give(writer, 1.2)
        path = writer.close()
    assert path == tmp_path / "Kayıt-2026-11-22.leakline"
    assert writer.fault is None
    with SurveyFolder.open(path) as folder:
        assert codes(folder) == []
        files = folder.files()
        assert [(file.path.name, file.role) for file in files] == [
            *((f"audio-00{i}.wav", "audio") for i in (1, 2, 3)),
            *((f"imu-00{i}.lkf", "imu") for i in (1, 2, 3)),
            ("recording.jsonl", "journal"),
        ]
        assert all(len(file.sha256) == 64 and file.size == file.path.stat().st_size for file in files)
        assert folder.verify_originals() == ()
        found = import_folder(folder.original_dir, known=files)
        assert "recording_unfinished" not in codes(found)
        assert sound_in(found.audio) == 57600
        assert motion_in(folder.original_dir) == 480
    assert events(writer)[0] == "started"
    assert events(writer).count("part") == 6
    last = read_journal(original(writer) / "recording.jsonl")[-1]
    assert (last.event, last.values) == ("stopped", {"sound_frames": 57600, "motion_samples": 480})
    assert not (path / "recordings" / "1" / "room.reserve").exists()


def test_a_running_recording_is_read_as_it_lies_there_but_changed_by_nobody_else(writer):
    give(writer, 1.0)
    wait_written(writer)
    with pytest.raises(LeaklineError) as locked:
        SurveyFolder.open(writer.path)
    assert locked.value.code is ErrorCode.SURVEY_LOCKED
    with SurveyFolder.open(writer.path, read_only=True) as folder:
        assert codes(folder) == ["recording_running"]
        files = folder.files()
        assert [(file.path.name, file.sha256) for file in files] == [
            ("audio-001.wav", ""),
            ("imu-001.lkf", ""),
            ("recording.jsonl", ""),
        ]
        assert [finding.code for finding in folder.verify_originals()] == ["original_without_sum"] * 3
        found = import_folder(folder.original_dir, known=files)
        assert (sound_in(found.audio), len(found.imu.time_s)) == (48000, 400)
        assert all(len(file.sha256) == 64 for file in found.files)
        with pytest.raises(LeaklineError) as refused:
            folder.complete_recording(found.files)
        assert refused.value.code is ErrorCode.SURVEY_READ_ONLY


def test_what_has_grown_is_not_taken_from_the_cache(writer, tmp_path):
    cache, lengths = Cache(tmp_path / "cache"), []
    for second in range(2):
        give(writer, 1.0, second)
        wait_written(writer)
        with SurveyFolder.open(writer.path, read_only=True) as folder:
            settings = (ImportOptions(), ImportSettings(), cache)
            found = read_recording(folder.original_dir, *settings, files=folder.files())
        lengths.append((found.audio.frames, len(found.imu.time_s)))
    assert lengths == [(48000, 400), (96000, 800)]


def test_the_sums_of_a_recording_that_was_never_ended_are_stored_once_it_was_read(tmp_path):
    with recording(tmp_path) as writer:
        give(writer, 1.0)
        wait_written(writer)
        left = shutil.copytree(writer.path, tmp_path / "left.leakline", ignore=shutil.ignore_patterns("survey.lock"))
    with SurveyFolder.open(left) as folder:
        assert codes(folder) == []
        found = import_folder(folder.original_dir, known=folder.files())
        assert "recording_unfinished" in codes(found)
        folder.complete_recording(found.files)
        assert all(file.sha256 for file in folder.files())
        assert set(found.files) <= {*folder.files()}
        assert folder.verify_originals() == ()
        folder.complete_recording(found.files)
        assert not (left / "recordings" / "1" / "room.reserve").exists()
        (left / "recordings" / "1" / "original" / "imu-001.lkf").write_bytes(b"?")
        assert [finding.code for finding in folder.verify_originals()] == ["original_changed"]


def test_a_stick_too_slow_to_be_read_again_leaves_the_sums_to_the_import(tmp_path, monkeypatch):
    monkeypatch.setattr(recording_keeper, "HASH_AT_END_S", 0.0)
    with recording(tmp_path) as writer:
        give(writer, 1.0)
    with SurveyFolder.open(writer.path) as folder:
        assert "" in {file.sha256 for file in folder.files()}  # a part may have been summed while it was recorded
        found = import_folder(folder.original_dir, known=folder.files())
        assert "recording_unfinished" not in codes(found)
        folder.complete_recording(found.files)
        assert folder.verify_originals() == ()


def test_a_folder_that_was_imported_lists_only_what_was_imported(folder):
    (folder.original_dir / "audio-007.wav").write_bytes(b"put there by hand")
    assert "audio-007.wav" not in [file.path.name for file in folder.files()]


def test_the_folder_may_be_named_and_a_taken_name_is_never_written_over(tmp_path):
    for name in ("kayıt.leakline", "kayıt-2.leakline"):
        with recording(tmp_path / "kayıt.leakline") as writer:
            give(writer, 0.1)
        assert writer.path == tmp_path / name
    writer = RecordingWriter.create(tmp_path, Survey(), None, motion=True)
    writer.close()
    year = time.strftime("%Y")
    assert writer.path.name.startswith(f"Survey-{year}-")


# --- what is told beside


def test_marks_are_in_the_survey_at_once_and_the_clock_at_the_end(writer):
    points = [TiePoint(f"vana {i}", float(i), chainage_m=10.0 * i) for i in range(3)]
    for point in points:
        writer.mark(point)
    assert writer.wait_stored(PATIENCE_S)
    with SurveyFolder.open(writer.path, read_only=True) as folder:
        assert folder.read_survey().tie_points == tuple(points)
        assert folder.read_survey().audio.start_time_s is None

    @dataclass(frozen=True)
    class Guess:
        start_time_s: float = 0.25
        drift_ppm: float = -12.5
        start_sigma_s: float = 0.002
        drift_sigma_ppm: float = 0.5

    for ppm in range(50):
        writer.set_clock(Guess(drift_ppm=float(ppm)))
    writer.set_clock(Guess())
    writer.close()
    with SurveyFolder.open(writer.path) as folder:
        audio = folder.read_survey().audio
        assert (audio.start_time_s, audio.drift_ppm, audio.start_sigma_s, audio.drift_sigma_ppm) == (
            0.25,
            -12.5,
            0.002,
            0.5,
        )
        assert folder.read_survey().tie_points == tuple(points)
    clocks = [line.values for line in read_journal(original(writer) / "recording.jsonl") if line.event == "clock"]
    assert clocks == [{"start_time_s": 0.25, "drift_ppm": -12.5, "start_sigma_s": 0.002, "drift_sigma_ppm": 0.5}]


def test_a_survey_that_somebody_reads_for_long_is_stored_later(writer, monkeypatch):
    real, refused = SurveyFolder.write_survey, []

    def busy(folder, survey, operator):
        if not refused:
            refused.append(survey)
            raise LeaklineError(ErrorCode.SURVEY_LOCKED)
        real(folder, survey, operator)

    monkeypatch.setattr(SurveyFolder, "write_survey", busy)
    writer.mark(TiePoint("vana", 1.0))
    assert writer.wait_stored(PATIENCE_S)
    assert refused
    assert writer.fault is None


def test_who_reads_the_survey_for_long_keeps_nothing_from_the_disc(writer):
    with closing(sqlite3.connect(writer.path / "survey.db", isolation_level=None)) as reader:
        reader.execute("BEGIN")
        reader.execute("SELECT count(*) FROM survey_log").fetchone()
        writer.mark(TiePoint("vana", 1.0))
        begun_s = time.monotonic()
        while (writer.status().synced_host_s or 0.0) < begun_s + 1.0:  # synced twice meanwhile
            assert time.monotonic() < begun_s + 8.0, "the syncs waited for the reader"
            time.sleep(0.01)
        assert not writer.wait_stored(0.0)
    assert writer.wait_stored(PATIENCE_S)


def test_a_survey_that_cannot_be_stored_even_in_the_end_is_told(tmp_path, monkeypatch):
    def busy(folder, survey, operator):
        raise LeaklineError(ErrorCode.SURVEY_LOCKED)

    with recording(tmp_path) as writer:
        monkeypatch.setattr(SurveyFolder, "write_survey", busy)
        writer.mark(TiePoint("vana", 1.0))
        assert not writer.wait_stored(0.3)
        assert writer.fault is None
    assert writer.fault.code is ErrorCode.SURVEY_LOCKED
    assert "mark" in events(writer)


def test_everybody_may_write_at_once(writer):
    def sound():
        for i in range(100):
            writer.write_sound(known_sound(480 * i, 480))

    def motion():
        for i in range(100):
            writer.write_motion(known_motion(4 * i, 4))

    def told():
        for i in range(100):
            writer.note(JournalEvent.NOTE, number=i)

    threads = [threading.Thread(target=work, daemon=True) for work in (sound, motion, told)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE_S)
        assert not thread.is_alive()
    writer.close()
    found = import_folder(original(writer))
    assert (sound_in(found.audio), motion_in(original(writer))) == (48000, 400)
    lines = read_journal(original(writer) / "recording.jsonl")
    assert [line.values["number"] for line in lines if line.event == "note"] == list(range(100))


def test_nobody_who_brings_samples_waits_for_a_disc_that_syncs_for_long(writer, monkeypatch):
    wait_written(writer)
    real, go_on, is_syncing = os.fsync, threading.Event(), threading.Event()

    def slow(handle):
        is_syncing.set()
        assert go_on.wait(PATIENCE_S)
        real(handle)

    monkeypatch.setattr(os, "fsync", slow)
    try:
        assert is_syncing.wait(PATIENCE_S)
        give(writer, 2.0)
        # it is even written, out of a kill's reach
        wait_for(lambda: sum(path.stat().st_size for path in original(writer).glob("*.wav")) >= 3 * 96000)
    finally:
        go_on.set()


def test_silence_keeps_the_place_of_what_was_lost(tmp_path):
    with recording(tmp_path, part_s=1.0) as writer:
        writer.write_sound(known_sound(0, 1000))
        writer.write_silence(100_000)
        writer.write_sound(known_sound(101_000, 1000))
    found = import_folder(original(writer))
    assert found.audio.frames == 102_000
    import soundfile

    sound = np.concatenate([soundfile.read(part.path, dtype="int32")[0] for part in found.audio.parts])
    right = known_sound(0, 102_000)[:, 0]
    right[1000:101_000] = 0
    assert np.array_equal(sound, right)


def test_wrong_blocks_are_a_fault_of_the_caller(writer):
    with pytest.raises(ValueError, match="int32"):
        writer.write_sound(np.zeros((10, 1), np.float32))
    with pytest.raises(ValueError, match="int32"):
        writer.write_sound(np.zeros((10, 2), np.int32))
    with pytest.raises(ValueError, match="number"):
        writer.write_silence(-1)
    with pytest.raises(ValueError, match="nothing"):
        RecordingWriter.create(Path(), Survey(), None, motion=False)


# --- the disc


def fake_disc(monkeypatch, free):
    monkeypatch.setattr(disc_space.shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(1 << 40, 0, free[0]))


def test_a_disc_that_will_be_full_is_told_in_time_and_ends_the_recording_cleanly(tmp_path, monkeypatch):
    free = [disc_space.RESERVE_BYTES + 700 * 144_000]
    fake_disc(monkeypatch, free)
    with recording(tmp_path) as writer:
        give(writer, 1.0)
        wait_written(writer)
        assert writer.findings == ()
        assert 590 < writer.status().seconds_left <= 700
        free[0] -= 200 * 144_000
        wait_for(lambda: writer.findings)
        (told,) = writer.findings
        assert (told.code, told.severity) == ("recording_disc_low", Severity.WARNING)
        assert 5.0 < told.params["minutes"] < 8.4
        assert writer.fault is None
        give(writer, 1.0, 1.0)
        free[0] = disc_space.RESERVE_BYTES - 1
        wait_for(lambda: writer.fault)
        assert writer.fault.code is ErrorCode.DISC_FULL
        give(writer, 1.0, 2.0)  # ignored without a word
    assert events(writer)[-3:] == ["disc_low", "fault", "stopped"]
    with SurveyFolder.open(writer.path) as folder:
        assert codes(folder) == []
        assert all(file.sha256 for file in folder.files())
        found = import_folder(folder.original_dir)
        assert (sound_in(found.audio), motion_in(folder.original_dir)) == (96000, 800)


@pytest.mark.parametrize("failing", ["write", "fsync"])
@pytest.mark.parametrize("number", [errno.EIO, errno.ENOSPC, errno.EDQUOT])
def test_a_disc_that_fails_ends_the_recording_and_raises_nowhere(tmp_path, monkeypatch, failing, number):
    with recording(tmp_path) as writer:
        give(writer, 1.0)
        writer.mark(TiePoint("vana", 0.5))
        wait_written(writer)

        def broken(handle, *_):
            raise OSError(number, os.strerror(number))

        with monkeypatch.context() as patch:
            patch.setattr(os, failing, broken)
            give(writer, 0.2, 1.0)
            wait_for(lambda: writer.fault)
            give(writer, 1.0, 1.2)
            writer.write_silence(10)
            writer.mark(TiePoint("geç", 2.0))
            writer.close()
        expected = ErrorCode.CANNOT_WRITE if number == errno.EIO else ErrorCode.DISC_FULL
        assert writer.fault.code is expected
        assert writer.close() == writer.path
    with SurveyFolder.open(writer.path) as folder:
        assert folder.read_survey().tie_points[0] == TiePoint("vana", 0.5)
        found = import_folder(folder.original_dir)
        assert sound_in(found.audio) >= 48000
        assert motion_in(folder.original_dir) >= 400


def test_lines_that_found_no_room_are_in_the_journal_in_the_end(tmp_path, monkeypatch):
    real, refused = GrowingFile.append, []

    def full(file, data):
        if b"vana 12" in data and not refused:
            refused.append(data)
            raise LeaklineError(ErrorCode.DISC_FULL)
        real(file, data)

    monkeypatch.setattr(GrowingFile, "append", full)
    with recording(tmp_path) as writer:
        writer.note(JournalEvent.NOTE, text="vana 12")
        wait_for(lambda: writer.fault)
    assert events(writer)[-3:] == ["note", "fault", "stopped"]


@pytest.mark.skipif(os.name == "nt", reason="Windows lets nobody take away what is open")
def test_a_folder_that_is_taken_away_ends_the_recording(tmp_path):
    with recording(tmp_path / "disc") as writer:
        give(writer, 0.5)
        wait_written(writer)
        shutil.rmtree(tmp_path / "disc")
        wait_for(lambda: writer.fault)
        assert writer.fault.code is ErrorCode.CANNOT_WRITE
        give(writer, 0.5, 0.5)
        assert writer.close() == writer.path
    assert not (tmp_path / "disc").exists()


def test_a_disc_that_never_keeps_up_ends_the_recording_before_the_memory_is_full(writer, monkeypatch):
    monkeypatch.setattr(recording_streams, "MOST_WAITING", 1 << 18)
    held, real = threading.Event(), SoundParts.flush

    def slow(parts):
        assert held.wait(PATIENCE_S)
        real(parts)

    monkeypatch.setattr(SoundParts, "flush", slow)
    try:
        for i in range(100):
            writer.write_sound(known_sound(4800 * i, 4800))
        assert writer.fault is not None
        assert "slow" in writer.fault.params["reason"]
    finally:
        held.set()
    writer.close()
    assert sound_in(import_folder(original(writer)).audio) >= (1 << 18) / 3


def test_a_fault_of_ours_ends_the_recording_and_is_raised_by_closing(tmp_path, monkeypatch):
    writer = RecordingWriter.create(tmp_path, Survey(), FORM, motion=True)

    def wrong(parts):
        raise RuntimeError("ours")

    monkeypatch.setattr(SoundParts, "flush", wrong)
    wait_for(lambda: writer.fault)
    with pytest.raises(RuntimeError, match="ours"):
        writer.close()
    assert events(writer)[-2:] == ["fault", "stopped"]
    with SurveyFolder.open(writer.path) as folder:
        assert not folder.read_only


def test_where_nothing_can_be_written_no_folder_is_left(tmp_path, monkeypatch):
    fake_disc(monkeypatch, [disc_space.RESERVE_BYTES // 2])
    with pytest.raises(LeaklineError) as full:
        RecordingWriter.create(tmp_path, Survey(), FORM, motion=True)
    assert full.value.code is ErrorCode.DISC_FULL
    assert list(tmp_path.iterdir()) == []
