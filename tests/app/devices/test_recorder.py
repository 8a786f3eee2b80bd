"""The recorder with devices that do as told: what is written and told, and that no stream harms the other."""

import json
import threading
import time
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
import soundfile
from fake_devices import RATE_HZ, FakeInput, FakeLink, motion, noise, sent

from app.devices import motion_intake
from app.devices.audio_spec import parse_audio_spec
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Makers, Recorder
from app.devices.recording_plan import RecordingPlan
from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import FrameDecoder
from processing.live.stream import LinkState, MotionBlock, RecordingState, SoundBlock
from processing.storage import recording_keeper
from processing.storage.folder import SurveyFolder
from processing.storage.recording_writer import RecordingWriter
from processing.survey import Survey, SurveyInfo, TiePoint

PATIENCE_S = 10.0
SMALL = partial(RecordingWriter.create, reserve_bytes=1 << 20)


def wait_until(condition):
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, "it did not happen in time"
        time.sleep(0.005)


class Bench:
    """A recorder with its fake devices; motion is sent on a clock of its own that the test moves."""

    def __init__(self, target, sound="default", imu="tcp:ball:1", **plan):
        self.inputs, self.links = [], []
        self.rate_hz = RATE_HZ
        plan = {"survey": Survey(SurveyInfo(name="Gül Sokağı")), "target": target} | plan
        choices = {"sound": parse_audio_spec(sound), "motion": None if imu == "none" else parse_imu_spec(imu)}
        self.recorder = Recorder(RecordingPlan(**plan, **choices), Makers(self._input, self._link, SMALL), drain_s=0.0)
        self.begun_s = time.monotonic()
        self.sent = 0

    def _input(self, choice, on_block):
        self.inputs.append(FakeInput(choice, on_block, self.rate_hz))
        return self.inputs[-1]

    def _link(self, choice, on_bytes, on_state):
        self.links.append(FakeLink(choice, on_bytes, on_state))
        return self.links[-1]

    @property
    def mic(self):
        return self.inputs[-1]

    @property
    def ball(self):
        return self.links[-1]

    def move(self, count=40, skip=0, **form):
        """Send samples, and wait until they are taken in; their times go on by what is skipped."""
        frames = motion(count, self.sent + skip, **form)
        before = self.recorder.status().motion
        self.sent += skip + count
        self.ball.give(sent(frames), self.begun_s + self.sent / 400.0)
        wait_until(lambda: self.recorder.status().motion.samples >= before.samples + count)
        return frames

    def codes(self):
        return [finding.code for finding in self.recorder.status().findings]


@pytest.fixture
def bench(tmp_path):
    benches = []

    def make(target=None, **words):
        benches.append(Bench(target or tmp_path, **words))
        benches[-1].recorder.open()
        return benches[-1]

    yield make
    for one in benches:
        one.recorder.close()


def sound_of(folder):
    files = sorted((folder / "recordings" / "1" / "original").glob("audio-*.wav"))
    return np.concatenate([soundfile.read(file, dtype="int32", always_2d=True)[0] for file in files])


def motion_of(folder):
    files = sorted((folder / "recordings" / "1" / "original").glob("imu-*.lkf"))
    return FrameDecoder().feed(b"".join(file.read_bytes() for file in files))


def journal_of(folder):
    lines = (folder / "recordings" / "1" / "original" / "recording.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def values_of(folder, event):
    return [line["values"] for line in journal_of(folder) if line["event"] == event]


def ties_of(folder):
    with SurveyFolder.open(folder, read_only=True) as opened:
        return opened.read_survey().tie_points


# --- what is written


def test_monitoring_shows_everything_and_writes_nothing(bench, tmp_path):
    one = bench()
    one.mic.give(noise(800))
    one.move()
    status = one.recorder.status()
    assert (status.state, status.sound.state, status.motion.state) == ("monitoring", "live", "live")
    assert {type(block) for block in one.recorder.feed.take()} == {SoundBlock, MotionBlock}
    assert list(tmp_path.iterdir()) == []
    assert one.recorder.stop() is None


def test_what_comes_between_start_and_stop_is_written_to_the_last_bit_and_nothing_else(bench):
    one = bench(sound="default,channels=2")
    one.mic.give(noise(800, 2, seed=1))
    one.move()
    folder = one.recorder.start()
    parts, frames = [noise(n, 2, seed=n) for n in (800, 1, 333)], [one.move(60), one.move(1)]
    for part in parts:
        one.mic.give(part)
    assert one.recorder.stop() == folder
    one.mic.give(noise(800, 2, seed=2))
    one.ball.give(sent(motion(40, one.sent)))
    status = one.recorder.status()
    assert (status.sound.frames, status.motion.samples) == (1134, 61), "of the recording, not of what comes after it"
    np.testing.assert_array_equal(sound_of(folder), np.concatenate(parts))
    found = motion_of(folder)
    np.testing.assert_array_equal(found.acc_s_mps2, np.concatenate([f.acc_s_mps2 for f in frames]))
    np.testing.assert_array_equal(found.gyr_s_radps, np.concatenate([f.gyr_s_radps for f in frames]))
    np.testing.assert_array_equal(np.diff(found.time_us), 2500)


def test_survey_time_and_the_frames_of_the_feed_begin_at_nought_with_the_recording(bench):
    one = bench()
    one.mic.give(noise(800))
    one.move()
    one.recorder.start()
    one.mic.give(noise(400))
    one.move()
    blocks = one.recorder.feed.take()
    assert [block.first_frame for block in blocks if isinstance(block, SoundBlock)] == [0]
    times = np.concatenate([block.imu.time_s for block in blocks if isinstance(block, MotionBlock)])
    np.testing.assert_allclose(times, np.arange(40) / 400.0, atol=1e-9)


def test_the_devices_run_on_and_a_second_start_makes_another_folder(bench, tmp_path):
    one = bench()
    folders = []
    for seed in (1, 2):
        folders.append(one.recorder.start())
        one.mic.give(noise(500, seed=seed))
        one.move()
        one.recorder.stop()
        assert one.mic.is_running
    assert folders[0] != folders[1]
    assert len(one.inputs) == len(one.links) == 1
    for seed, folder in zip((1, 2), folders, strict=True):
        np.testing.assert_array_equal(sound_of(folder), noise(500, seed=seed))
        assert motion_of(folder).time_us.size == 40


def test_the_folder_is_called_after_the_survey_and_its_date_in_a_directory_else_as_told(bench, tmp_path):
    dated = bench(survey=Survey(SurveyInfo(name="Gül Sokağı", date="2026-05-04")))
    assert dated.recorder.start() == tmp_path / "Gül-Sokağı-2026-05-04.leakline"
    told = bench(tmp_path / "run")
    assert told.recorder.start() == tmp_path / "run.leakline"
    again = bench(tmp_path / "run.leakline")
    assert again.recorder.start() == tmp_path / "run-2.leakline"


def test_a_second_start_while_recording_is_refused(bench):
    one = bench()
    one.recorder.start()
    with pytest.raises(LeaklineError) as refused:
        one.recorder.start()
    assert refused.value.code is ErrorCode.RECORDING_RUNNING


def test_many_threads_may_stop_it_and_all_get_the_same_folder_when_it_is_done(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(500))
    found = []
    threads = [threading.Thread(target=lambda: found.append(one.recorder.stop()), daemon=True) for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(PATIENCE_S)
    assert found == [folder] * 5
    assert journal_of(folder)[-1]["event"] == "stopped"
    assert one.recorder.status().state is RecordingState.STOPPED


def test_a_recording_of_sound_alone_or_motion_alone_works(bench, tmp_path):
    heard = bench(tmp_path / "heard", imu="none")
    folder = heard.recorder.start()
    heard.mic.give(noise(500))
    heard.recorder.stop()
    np.testing.assert_array_equal(sound_of(folder), noise(500))
    assert heard.recorder.status().motion.state is LinkState.OFF
    felt = bench(tmp_path / "felt", sound="none")
    folder = felt.recorder.start()
    felt.move(100)
    felt.recorder.stop()
    assert len(motion_of(folder)) == 100
    assert felt.recorder.status().sound.state is LinkState.OFF


def test_a_microphone_that_comes_only_after_the_start_is_opened_with_the_rate_of_the_file(bench):
    one = bench()
    one.mic.now = replace(one.mic.now, state=LinkState.WAITING, sample_rate_hz=0.0, channels=0)
    folder = one.recorder.start()
    assert one.mic.choice.rate_hz == 48_000
    one.move()
    one.mic.now = replace(one.mic.now, state=LinkState.LIVE, sample_rate_hz=48_000.0, channels=1)
    one.mic.give(noise(4800))
    one.recorder.stop()
    assert soundfile.info(folder / "recordings" / "1" / "original" / "audio-001.wav").samplerate == 48_000
    np.testing.assert_array_equal(sound_of(folder), noise(4800))


# --- markers


def test_a_marker_is_on_the_disc_when_it_is_set_and_the_recording_goes_on(bench):
    one = bench()
    folder = one.recorder.start()
    one.move(400)
    point = one.recorder.mark("vana 12", 104.5, host_s=one.begun_s + 1.0)
    assert point == TiePoint("vana 12", point.time_s, chainage_m=104.5)
    assert point.time_s == pytest.approx(1.0, abs=0.01)
    assert ties_of(folder) == (point,)
    assert one.recorder.status().markers == 1
    assert one.recorder.status().state is RecordingState.RECORDING


def test_a_marker_may_have_coordinates_or_nothing_but_its_name(bench):
    one = bench()
    folder = one.recorder.start()
    one.move()
    placed = one.recorder.mark("bend", latitude=40.9, longitude=29.1, sigma_m=2.0)
    bare = one.recorder.mark("here")
    assert ties_of(folder) == (placed, bare)
    assert (placed.latitude, placed.sigma_m, bare.chainage_m) == (40.9, 2.0, None)


def test_the_last_marker_can_be_taken_back_and_any_can_be_amended(bench):
    one = bench()
    folder = one.recorder.start()
    one.move()
    first, second = one.recorder.mark("one"), one.recorder.mark("two")
    assert one.recorder.unmark() == second
    named = replace(first, name="valve", chainage_m=12.0)
    one.recorder.amend(first, named)
    assert ties_of(folder) == one.recorder.marks == (named,)
    one.recorder.amend(named, None)
    assert one.recorder.unmark() is None
    assert ties_of(folder) == ()


def test_without_a_recording_nothing_can_be_marked(bench):
    one = bench()
    with pytest.raises(LeaklineError) as refused:
        one.recorder.mark("early")
    assert refused.value.code is ErrorCode.RECORDING_NOT_RUNNING
    one.recorder.start()
    one.recorder.stop()
    with pytest.raises(LeaklineError):
        one.recorder.mark("late")


def test_markers_of_a_recording_without_motion_count_on_the_sound(bench):
    one = bench(imu="none")
    one.mic.give(noise(3 * RATE_HZ), host_s=one.begun_s - 1.0)
    one.recorder.start()
    one.mic.give(noise(2 * RATE_HZ), host_s=one.begun_s + 10.0)
    assert one.recorder.mark("here", host_s=one.begun_s + 9.5).time_s == pytest.approx(1.5, abs=1e-3)


def test_markers_set_before_the_first_sample_of_the_imu_get_its_time_later(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(800), host_s=one.begun_s + 0.1)
    early = one.recorder.mark("launch", host_s=one.begun_s + 0.1)
    one.begun_s += 5.0
    one.move(400)
    one.recorder.stop()
    (tie,) = ties_of(folder)
    assert early.time_s == pytest.approx(0.1, abs=1e-3)
    assert tie.time_s == pytest.approx(0.1 - 5.0, abs=0.01)


def test_a_marker_that_is_named_later_keeps_the_time_that_is_known_better_by_then(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(800), host_s=one.begun_s + 0.1)
    early = one.recorder.mark("marker 1", host_s=one.begun_s + 0.1)
    one.begun_s += 5.0
    one.move(400)
    one.recorder._take.settle()
    named = one.recorder.amend(early, replace(early, name="launch", chainage_m=0.0))
    assert named.time_s == pytest.approx(0.1 - 5.0, abs=0.01)
    again = one.recorder.amend(named, replace(named, name="launch pit"))
    one.recorder.stop()
    assert ties_of(folder) == (again,)


# --- what goes wrong


def test_a_link_that_stutters_for_hours_does_not_fill_the_journal(bench, monkeypatch):
    monkeypatch.setattr(motion_intake, "HOLES_AT_ONCE", 3)
    one = bench()
    folder = one.recorder.start()
    one.move(40)
    for _ in range(40):
        one.move(2, skip=4)  # ten milliseconds each
    one.move(40)
    lost = one.recorder.status().motion.lost
    one.recorder.stop()
    holes = values_of(folder, "motion_gap")
    assert lost == 160
    assert sum(hole["lost"] for hole in holes) == lost
    assert 4 <= len(holes) <= 8


def test_lost_sound_is_replaced_by_silence_of_the_same_length_and_written_down(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(500, seed=1))
    one.mic.give(noise(500, seed=2), lost=123)
    one.recorder.stop()
    sound = sound_of(folder)
    np.testing.assert_array_equal(sound, np.concatenate([noise(500, seed=1), np.zeros((123, 1)), noise(500, seed=2)]))
    assert values_of(folder, "sound_gap") == [{"frame": 500, "frames": 123, "reason": "sound_overflow"}]
    status = one.recorder.status()
    assert (status.sound.lost_frames, status.sound.gaps, status.sound.frames) == (123, 1, 1000)
    assert one.codes() == ["recorder_sound_gap"]


def test_what_was_lost_before_the_recording_is_no_gap_in_it(bench):
    one = bench()
    one.mic.give(noise(500))
    folder = one.recorder.start()
    one.mic.give(noise(400, seed=3), lost=1000)
    one.recorder.stop()
    np.testing.assert_array_equal(sound_of(folder), noise(400, seed=3))
    assert one.recorder.status().sound.lost_frames == 0


def test_lost_samples_are_counted_and_the_hole_is_written_down(bench):
    one = bench()
    folder = one.recorder.start()
    one.move(400)
    one.move(400, skip=7)
    one.recorder.stop()
    (hole,) = values_of(folder, "motion_gap")
    assert hole["lost"] == 7
    assert (hole["start_s"], hole["end_s"]) == pytest.approx((399 / 400, 407 / 400))
    assert one.recorder.status().motion.lost == 7
    assert one.codes() == ["recorder_imu_gap"]


def test_an_imu_that_goes_and_comes_back_with_a_new_clock_is_continued_and_the_sound_does_not_notice(bench):
    one = bench()
    folder = one.recorder.start()
    one.move(400)
    one.mic.give(noise(500, seed=1))
    one.ball.go(LinkState.LOST, "imu_unplugged")
    one.mic.give(noise(500, seed=2))
    one.sent, one.begun_s = 0, one.begun_s + 3.0  # two seconds after its last sample it counts from nought
    one.move(400, start_us=0)
    one.recorder.stop()
    codes = one.codes()
    assert [code for code in codes if code != "recorder_imu_gap"] == [
        "recorder_imu_lost",
        "recorder_imu_back",
        "recorder_imu_restarted",
    ]
    found = motion_of(folder)
    steps = np.diff(found.time_us.astype(np.int64))
    assert np.count_nonzero(steps != 2500) == 1
    assert 1e-6 * steps.max() == pytest.approx(3.0 - 1.0, abs=1.1), "bridged by the computer's clock"
    assert [line["state"] for line in values_of(folder, "motion_state")][:2] == ["live", "lost"]
    np.testing.assert_array_equal(sound_of(folder), np.concatenate([noise(500, seed=1), noise(500, seed=2)]))


def test_garbage_costs_what_it_covers_and_is_told(bench):
    one = bench()
    folder = one.recorder.start()
    one.move(100)
    rubbish = bytes(np.random.default_rng(5).integers(0, 256, 900, dtype=np.uint8)).replace(b"\xc5", b"\x00")
    one.ball.give(rubbish, one.begun_s + 0.3)
    one.move(100)
    one.recorder.stop()
    assert len(motion_of(folder)) == 200
    assert one.recorder.status().motion.garbage_bytes == 900
    (finding,) = [f for f in one.recorder.status().findings if f.code == "recorder_imu_garbage"]
    assert finding.params["bytes"] == 900


def test_an_imu_that_speaks_in_tongues_is_told_once(bench):
    one = bench(imu="tcp:ball:1,protocol=frames")
    for _ in range(3):
        one.ball.give(bytes(5000))
    wait_until(lambda: "recorder_imu_unknown" in one.codes())
    assert one.codes().count("recorder_imu_unknown") == 1


def test_a_microphone_that_goes_and_comes_back_is_told_and_its_gap_is_silence(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(500, seed=1))
    wait_until(lambda: one.recorder.status().sound.state is LinkState.LIVE)
    time.sleep(0.3)  # the recorder looks five times a second
    one.mic.now = replace(one.mic.now, state=LinkState.LOST)
    wait_until(lambda: "recorder_sound_lost" in one.codes())
    one.mic.now = replace(one.mic.now, state=LinkState.LIVE)
    one.mic.give(noise(500, seed=2), lost=4000, reason="sound_input_lost")
    one.recorder.stop()
    assert one.codes() == ["recorder_sound_lost", "recorder_sound_back"]
    assert np.count_nonzero(sound_of(folder)[500:4500]) == 0
    assert len(sound_of(folder)) == 5000


def test_clipping_and_exact_silence_are_told(bench):
    one = bench()
    one.mic.now = replace(one.mic.now, clipped=(True,))
    wait_until(lambda: "recorder_clipped" in one.codes())
    assert next(f for f in one.recorder.status().findings).params["channels"] == "1"


def test_a_fault_of_ours_in_one_stream_costs_a_block_of_it_and_the_other_stream_nothing(bench, monkeypatch):
    one = bench()
    folder = one.recorder.start()
    writer = one.recorder._take.writer

    def burst(_frames):
        raise RuntimeError("out of ideas")

    with monkeypatch.context() as broken:
        broken.setattr(writer, "write_sound", burst)
        one.mic.give(noise(100, seed=1))
        one.move(100)
    one.mic.give(noise(100, seed=2))
    one.recorder.stop()
    assert len(motion_of(folder)) == 100
    assert "recorder_fault" in one.codes()
    # the lost block's place is kept by silence, so that the axis stays true
    np.testing.assert_array_equal(sound_of(folder), np.concatenate([np.zeros((100, 1)), noise(100, seed=2)]))


def test_when_the_disc_is_full_the_recording_ends_by_itself_and_what_was_written_is_safe(bench, monkeypatch):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(500))
    one.move(100)
    monkeypatch.setattr(recording_keeper, "free_bytes", lambda _path: 0)
    wait_until(lambda: one.recorder.status().state is RecordingState.FAILED)
    assert one.recorder.fault.code is ErrorCode.DISC_FULL
    assert "recorder_ended_disc" in one.codes()
    assert one.recorder.stop() == folder
    np.testing.assert_array_equal(sound_of(folder), noise(500))
    assert len(motion_of(folder)) == 100
    monkeypatch.undo()
    assert one.recorder.start() != folder, "with room on the disc the next recording can begin"


def test_one_look_waits_for_nobody(bench):
    one = bench()
    one.recorder.start()
    one.move()
    found = []
    with one.recorder._motion.lock, one.recorder._sound.lock, one.recorder._lock:
        looker = threading.Thread(target=lambda: found.append(one.recorder.status()), daemon=True)
        looker.start()
        looker.join(PATIENCE_S)
    assert [status.state for status in found] == [RecordingState.RECORDING]


def test_closing_in_the_middle_of_a_recording_brings_it_to_its_end(bench):
    one = bench()
    folder = one.recorder.start()
    one.mic.give(noise(500))
    one.recorder.close()
    one.recorder.close()
    assert journal_of(folder)[-1]["event"] == "stopped"
    assert not one.mic.is_running
    assert not one.ball.is_running


def test_what_waits_to_be_decoded_when_it_is_stopped_is_in_the_recording(bench, monkeypatch):
    one = bench()
    folder = one.recorder.start()
    one.move(10)
    place, waits = one.recorder._motion.timeline.place, threading.Event()

    def slowly(*arguments):
        waits.wait(0.5)
        return place(*arguments)

    monkeypatch.setattr(one.recorder._motion.timeline, "place", slowly)
    for nth in range(5):
        one.ball.give(sent(motion(100, 10 + 100 * nth)), one.begun_s + 0.25 * (nth + 1))
    one.recorder.stop()
    assert len(motion_of(folder)) == 510


def test_what_was_still_on_its_way_when_the_imu_went_is_not_taken_for_its_return(bench):
    one = bench()
    one.recorder.start()
    one.move(400)
    for nth in range(3):
        one.ball.give(sent(motion(40, 400 + 40 * nth)), one.begun_s + 1.1 + 0.1 * nth)
    one.ball.go(LinkState.LOST, "imu_unplugged")
    wait_until(lambda: one.recorder.status().motion.samples == 520)
    assert one.codes() == ["recorder_imu_lost"]
    one.ball.give(sent(motion(40, 2000)), one.begun_s + 5.1)
    wait_until(lambda: one.recorder.status().motion.samples == 560)
    back = next(finding for finding in one.recorder.status().findings if finding.code == "recorder_imu_back")
    assert back.params["gap_s"] == pytest.approx(5.1 - 1.3)


def test_a_pause_of_the_imu_that_began_before_the_recording_is_no_gap_in_it(bench):
    one = bench()
    one.move(400)
    one.ball.go(LinkState.LOST, "imu_unplugged")
    folder = one.recorder.start()
    one.move(400, skip=1200)
    one.recorder.stop()
    assert values_of(folder, "motion_gap") == []
    assert (one.recorder.status().motion.lost, one.recorder.status().motion.samples) == (0, 400)
