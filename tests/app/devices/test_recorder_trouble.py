"""The recorder with devices in trouble: what is written and told, and that no stream harms the other."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from fake_devices import motion, noise, sent
from recorder_bench import PATIENCE_S, journal_of, motion_of, sound_of, values_of, wait_until

from app.devices import motion_intake
from processing.errors import ErrorCode
from processing.live.stream import LinkState, RecordingState
from processing.storage import recording_keeper


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
