"""A fault of ours while a recording ends: its files are ended all the same, and the devices are let go."""

import json
import time
from functools import partial

import pytest
from fake_devices import RATE_HZ, FakeInput, FakeLink, motion, noise, sent

from app.devices.audio_spec import parse_audio_spec
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Makers, Recorder
from app.devices.recording_plan import RecordingPlan
from app.devices.take import Take
from processing.errors import ErrorCode, LeaklineError
from processing.importing.live_journal import journal_in
from processing.live.stream import RecordingState
from processing.storage.folder import SurveyFolder
from processing.storage.recording_writer import RecordingWriter
from processing.survey import Survey

PATIENCE_S = 10.0


class OutOfIdeasError(Exception):
    """A fault of ours."""


@pytest.fixture
def recorder(tmp_path):
    """A recorder whose devices are ``inputs`` and ``links``."""
    inputs, links = [], []

    def make(kept, kind, *words):
        kept.append(kind(*words))
        return kept[-1]

    choices = {"sound": parse_audio_spec("default"), "motion": parse_imu_spec("tcp:ball:1")}
    makers = Makers(
        lambda choice, on_block: make(inputs, FakeInput, choice, on_block, RATE_HZ),
        lambda *words: make(links, FakeLink, *words),
        partial(RecordingWriter.create, reserve_bytes=1 << 20),
    )
    one = Recorder(RecordingPlan(Survey(), tmp_path, **choices), makers, drain_s=0.0)
    one.inputs, one.links = inputs, links
    one.open()
    yield one
    one.close()


def recorded(recorder):
    """Begin a recording with a little in it and return its folder."""
    folder = recorder.start()
    recorder.inputs[-1].give(noise(100))
    recorder.links[-1].give(sent(motion(100)))
    return folder


def ended_well(folder):
    journal = folder / "recordings" / "1" / "original" / "recording.jsonl"
    last = json.loads(journal.read_text(encoding="utf-8").splitlines()[-1])
    with SurveyFolder.open(folder):  # nobody holds it any more
        return last["event"] == "stopped" and last["values"] == {"sound_frames": 100, "motion_samples": 100}


def broken(monkeypatch, name):
    def burst(*_words):
        raise OutOfIdeasError

    monkeypatch.setattr(Take, name, burst)


def test_a_recording_that_could_not_be_settled_is_ended_nevertheless_and_the_fault_is_told(recorder, monkeypatch):
    folder = recorded(recorder)
    with monkeypatch.context() as patched:
        broken(patched, "counts")
        with pytest.raises(OutOfIdeasError):
            recorder.stop()
    assert recorder.status().state is RecordingState.STOPPED
    assert ended_well(folder)
    assert recorder.start() != folder


def test_a_fault_at_the_end_does_not_keep_the_devices(recorder, monkeypatch):
    folder = recorded(recorder)
    with monkeypatch.context() as patched:
        broken(patched, "counts")
        with pytest.raises(OutOfIdeasError):
            recorder.close()
    assert ended_well(folder)
    assert not recorder.inputs[-1].is_running
    assert not recorder.links[-1].is_running


def test_a_recording_whose_disc_failed_is_over_though_looking_at_the_devices_fails_too(recorder, monkeypatch):
    recorded(recorder)

    def burst(_now):
        raise OutOfIdeasError

    monkeypatch.setattr(recorder._sound, "look", burst)
    recorder._take.writer._ending.fail(LeaklineError(ErrorCode.DISC_FULL))
    until = time.monotonic() + PATIENCE_S
    while recorder.status().state is not RecordingState.FAILED:
        assert time.monotonic() < until, "the state still says that it records"
        time.sleep(0.01)


def test_the_silence_in_the_place_of_a_block_that_was_not_taken_is_no_sound_to_the_import(recorder, monkeypatch):
    folder = recorder.start()
    recorder.inputs[-1].give(noise(300))

    def burst(_frames):
        raise OutOfIdeasError

    with monkeypatch.context() as patched:
        patched.setattr(recorder._take.writer, "write_sound", burst)
        recorder.inputs[-1].give(noise(100))
    recorder.inputs[-1].give(noise(200), lost=50)
    recorder.stop()
    journal, _ = journal_in(folder / "recordings" / "1" / "original")
    assert sorted((first, count) for first, count, _ in journal.sound_gaps) == [(300, 100), (400, 50)]
