"""Damaged recordings of every kind end in a message or in a result that keeps its promises, never in a traceback."""

import numpy as np
import pytest
from damaged_recordings import mutated, seeds

from processing import messages
from processing.errors import LeaklineError
from processing.importing.folder import import_folder, preview_folder

KINDS = seeds()


def write(folder, files):
    for name, data in files.items():
        (folder / name).write_bytes(data)


def keeps_its_promises(recording):
    for finding in recording.findings:
        for language in messages.LANGUAGES:
            assert "\n" not in messages.finding_sentence(finding, language)
    imu = recording.imu
    if imu is None:
        return
    assert np.all(np.diff(imu.time_s) > 0)
    for array in (imu.time_s, imu.acc_s_mps2, imu.gyr_s_radps, imu.mag_s_ut, imu.quat_ws, imu.pressure_kpa):
        assert array is None or (np.isfinite(array).all() and len(array) == len(imu.valid))
    for stretch in recording.not_assessed:
        assert stretch.start_s <= stretch.end_s
        assert messages.text("reasons", stretch.reason)


@pytest.mark.parametrize("name", KINDS)
def test_the_sound_recording_of_each_kind_is_read(tmp_path, name):
    write(tmp_path, KINDS[name])
    recording = import_folder(tmp_path)
    keeps_its_promises(recording)
    assert len(recording.imu.time_s) >= 298
    assert recording.imu.valid.all()
    assert recording.imu.sample_rate_hz == pytest.approx(100.0, rel=1e-3)


@pytest.mark.parametrize("batch", range(4))
def test_damaged_recordings_end_in_a_message_or_a_result(tmp_path, batch):
    sentences = {}
    for number in range(20 * batch, 20 * batch + 20):
        name, files = mutated(number, KINDS)
        folder = tmp_path / f"{number}"
        folder.mkdir()
        write(folder, files)
        try:
            preview_folder(folder)
            keeps_its_promises(import_folder(folder))
        except LeaklineError as error:
            sentences[name, number] = messages.error_sentence(error)
    assert all(sentences.values())
