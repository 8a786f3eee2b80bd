"""A recording survives a kill, a power cut and a disc that is really full: all but the last moments are there."""

import random
import shutil
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor

import pytest
from killed_recording import FIRST_US, IMU_HZ, RATE_HZ, kill_once, known_motion, known_sound, sound_in

from processing.importing.folder import import_folder
from processing.importing.frames import FrameDecoder
from processing.storage import recording_keeper, recording_streams
from processing.storage.folder import SurveyFolder
from processing.storage.growing_file import GrowingFile
from processing.storage.recording_writer import RecordingWriter, SoundForm
from processing.survey import Survey, SurveyInfo

PATIENCE_S = 20.0


def test_a_kill_at_a_random_moment_costs_no_more_than_the_last_second(tmp_path):
    chance = random.Random(11)
    moments = [chance.uniform(0.3, 1.5) for _ in range(5)]
    with ThreadPoolExecutor(3) as pool:
        killed = list(pool.map(kill_once, [tmp_path / str(i) for i in range(5)], moments))
    for one in killed:
        assert one.sound_s <= 1.2
        assert one.motion_s <= 1.2


# --- power


def give(writer, first, blocks):
    """Hand over blocks of 0.1 s."""
    for i in range(first, first + blocks):
        writer.write_sound(known_sound(RATE_HZ // 10 * i, RATE_HZ // 10))
        writer.write_motion(known_motion(IMU_HZ // 10 * i, IMU_HZ // 10))


def wait_for(is_so):
    deadline = time.monotonic() + PATIENCE_S
    while not is_so():
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.01)


@pytest.fixture(scope="module")
def running(tmp_path_factory):
    """A copy of a running recording, and how much of each file was synced by then: about half; new parts not at all."""
    folder = tmp_path_factory.mktemp("running")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(recording_keeper, "SYNC_S", 0.1)
        patch.setattr(recording_streams, "DRAIN_S", 0.01)
        writer = RecordingWriter.create(
            folder, Survey(SurveyInfo("Kayıt")), SoundForm(RATE_HZ), motion=True, part_s=1.5
        )
        try:
            give(writer, 0, 10)
            now = time.monotonic()
            wait_for(lambda: (writer.status().synced_host_s or 0.0) > now)
            patch.setattr(GrowingFile, "sync", lambda file: None)  # the last second of the computer's life
            files = {file.path.name: file for file in writer._streams.files()}
            give(writer, 10, 8)
            wait_for(lambda: (writer._streams.sound_frames, writer._streams.motion_samples) == (86400, 720))
            synced = {name: file.synced_size for name, file in files.items()}
            copy = shutil.copytree(writer.path, folder / "copy.leakline", ignore=shutil.ignore_patterns("survey.lock"))
        finally:
            writer.close()
    assert sorted(synced) == ["audio-001.wav", "imu-001.lkf"]
    assert (copy / "recordings" / "1" / "original" / "audio-002.wav").exists()
    return copy, synced


def cut_power(original, synced, chance):
    """Leave of each file what was synced and any part of the rest, or zeros in its place as some discs do."""
    for path in sorted(original.iterdir()):
        if path.name == "recording.jsonl":
            continue
        raw, safe = path.read_bytes(), synced.get(path.name, 0)
        end = chance.randint(safe, len(raw))
        kind = chance.choice(["cut", "zeros", "gone"])
        if kind == "gone" and not safe:
            path.unlink()
        elif kind == "zeros":
            path.write_bytes(raw[:end] + bytes(len(raw) - end))
        else:
            path.write_bytes(raw[:end])


@pytest.mark.parametrize("seed", range(12))
def test_a_power_cut_costs_only_what_was_not_synced(running, tmp_path, seed):
    copy, synced = running
    left = shutil.copytree(copy, tmp_path / "left.leakline")
    original = left / "recordings" / "1" / "original"
    cut_power(original, synced, random.Random(seed))
    frames = (synced["audio-001.wav"] - 44) // 3
    assert frames >= RATE_HZ
    with SurveyFolder.open(left) as folder:
        found = import_folder(folder.original_dir, known=folder.files())
        assert "recording_unfinished" in [finding.code for finding in found.findings]
        folder.complete_recording(found.files)
        assert folder.verify_originals() == ()
    assert found.audio.frames >= frames
    assert sound_in(found.audio, frames) == frames
    whole = FrameDecoder().feed((original / "imu-001.lkf").read_bytes()[: synced["imu-001.lkf"]])
    assert len(whole) >= IMU_HZ
    assert int(whole.time_us[0]) == FIRST_US
    assert len(found.imu.time_s) >= len(whole)


# --- a full disc

FULL_DISC = """
import sys, time
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from killed_recording import known_motion, known_sound, motion_in, sound_in
import processing.storage.creating as creating
import processing.storage.recording_keeper as keeper
from processing.errors import ErrorCode
from processing.importing.folder import import_folder
from processing.storage.folder import SurveyFolder
from processing.storage.recording_writer import RecordingWriter, SoundForm
from processing.survey import Survey, TiePoint

disc, how = Path(sys.argv[1]), sys.argv[3]
creating._MARGIN = 0
reserve = 1 << 20
if how == "sudden":
    keeper.free_bytes = lambda folder: 1 << 40  # nobody warned: the bytes just run out
    reserve = 1 << 10
keeper.SYNC_S = 0.05
writer = RecordingWriter.create(disc, Survey(), SoundForm(48000), motion=True, reserve_bytes=reserve)
writer.mark(TiePoint("vana", 0.5))
frames = samples = i = 0
end = time.monotonic() + 60
while writer.fault is None:
    assert time.monotonic() < end, "the disc was never full"
    writer.write_sound(known_sound(4800 * i, 4800))
    if writer.fault is None:
        frames += 4800
    writer.write_motion(known_motion(40 * i, 40))
    if writer.fault is None:
        samples += 40
    i += 1
    time.sleep(0.005)
assert writer.fault.code is ErrorCode.DISC_FULL, writer.fault
writer.write_sound(known_sound(0, 10))
path = writer.close()
with SurveyFolder.open(path) as folder:
    told = {finding.code for finding in folder.findings}
    assert told <= {"survey_backup_failed", "survey_disc_full"}, told
    assert all(file.sha256 for file in folder.files())
    assert folder.verify_originals() == ()
    assert [point.name for point in folder.read_survey().tie_points] == ["vana"]
    found = import_folder(folder.original_dir)
got = sound_in(found.audio), motion_in(path / "recordings" / "1" / "original")
assert got[0] >= frames and got[1] >= samples, (got, frames, samples)
print("nothing lost")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="makes a small disc of its own as only Linux can")
@pytest.mark.parametrize("how", ["foreseen", "sudden"])
def test_a_disc_that_is_really_full_ends_the_recording_and_nothing_accepted_is_missing(tmp_path, request, how):
    disc = tmp_path / "disc"
    disc.mkdir()
    mount = ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs -o size=4m none "$0" && exec "$@"', str(disc)]
    if subprocess.run([*mount, "true"], capture_output=True, check=False, timeout=60).returncode != 0:
        pytest.skip("this system lets nobody but root mount a disc")
    helpers = str(request.config.rootpath / "tests" / "helpers")
    command = [*mount, sys.executable, "-c", FULL_DISC, str(disc), helpers, how]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "nothing lost"
