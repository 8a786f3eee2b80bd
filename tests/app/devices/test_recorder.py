"""The recorder with devices that do as told: what is written between start and stop, and nothing else."""

import threading
from dataclasses import replace

import numpy as np
import pytest
import soundfile
from fake_devices import motion, noise, sent
from recorder_bench import PATIENCE_S, journal_of, motion_of, sound_of

from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import LinkState, MotionBlock, RecordingState, SoundBlock
from processing.survey import Survey, SurveyInfo


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
