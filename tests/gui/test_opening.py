"""Every road into a survey ends in a page or in a message with a way on; long work is cancelled without harm."""

import shutil
import sqlite3

import numpy as np
import pytest
from answering import AnsweringBoxes, CountingSink
from PySide6.QtCore import QEvent
from PySide6.QtWidgets import QApplication
from small_survey import SURVEY, make_device_folder, make_folder

from app.jobs import Jobs
from app.main_window import MainWindow
from app.services import Services
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.errors import ErrorCode
from processing.importing.column_mapping import ColumnMapping, MappedColumn, Quantity
from processing.importing.survey_toml import write_survey_toml
from processing.sound import scan
from processing.survey import Motion, PipeInfo, Survey
from widgets.raw_form import RawAnswer


@pytest.fixture
def window(qtbot, tmp_path):
    preferences = PreferencesStore(tmp_path / "preferences.json")
    services = Services(SurveySession(), Jobs(), preferences, None, lambda _r: CountingSink(), lambda: None)
    window = MainWindow(services, "en")
    window.boxes = AnsweringBoxes()
    window.show()
    qtbot.waitUntil(lambda: not services.jobs.running)
    yield window
    window.close()
    services.jobs.stop_all()
    services.session.close()
    window.deleteLater()
    QApplication.sendPostedEvents(None, QEvent.Type.DeferredDelete.value)


@pytest.fixture
def session(window):
    return window._session


@pytest.fixture
def idle(qtbot, window):
    def wait():
        qtbot.waitUntil(lambda: not window._services.jobs.running, timeout=30_000)

    return wait


def test_a_folder_with_its_form_is_processed_at_once_and_copied_untouched(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path / "stick")
    write_survey_toml(device / "survey.toml", SURVEY)
    before = {path.name: path.read_bytes() for path in device.iterdir()}
    window.files.open_path(device)
    idle()
    assert window.boxes.told == []
    assert window.page == "leaks"
    assert session.folder.path == tmp_path / "stick" / "Station-Road-2026-05-04.leakline"
    assert session.results.track is not None
    assert session.survey == SURVEY
    assert {path.name: path.read_bytes() for path in device.iterdir()} == before
    assert {f.path.name: f.path.read_bytes() for f in session.folder.files()} == before


def test_the_same_folder_again_opens_the_survey_that_was_made_of_it(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    first = session.folder.path
    window.files.close_survey()
    window.files.open_path(device)
    idle()
    assert session.folder.path == first
    assert len(list(tmp_path.glob("*.leakline"))) == 1
    assert session.run.id == 1


def test_a_folder_without_a_form_waits_for_the_operator_and_his_words_are_used(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    window.files.open_path(device)
    idle()
    assert window.page == "data"
    assert session.folder is None
    assert window.files.previewing
    survey = window.data_page.survey
    edited = Survey(
        info=survey.info.__class__(name="Mill Lane"),
        pipe=PipeInfo("PVC", 0.2, 55.0),
        device=survey.device.__class__(Motion.CARRIED),
    )
    window.data_page.form.survey_changed.emit(edited)
    window.files.process()
    idle()
    assert session.folder.path.name == "Mill-Lane.leakline"
    assert session.folder.read_survey() == edited
    assert window.page == "leaks"


def test_a_processed_survey_opens_from_its_cache_with_its_decisions(window, session, idle, tmp_path, monkeypatch):
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    path = session.folder.path
    session.cursor.set_time(20.0)
    window.review.mark_here()
    marked = session.selected
    window.review.confirm()
    window.files.close_survey()
    assert window.page == "start"
    monkeypatch.setattr(scan, "AudioReader", None)  # whoever listened again would stumble
    window.files.open_path(path)
    idle()
    assert window.boxes.told == []
    assert session.row(marked).manual
    assert session.decision(marked).verdict.value == "confirmed"


def test_a_locked_survey_can_be_read(window, session, idle, tmp_path):
    with make_folder(tmp_path) as held:
        window.boxes.answer = "read_only"
        window.files.open_path(held.path)
        idle()
        assert session.folder.read_only
        assert session.results is not None
        assert not window.actions_by_id["process"].isEnabled()
        assert "Read-only" in window.notices.banner.text()


def test_a_locked_survey_can_be_left_alone(window, session, idle, tmp_path):
    with make_folder(tmp_path) as held:
        window.files.open_path(held.path)
        assert len(window.boxes.told) == 1
        assert session.folder is None


def test_a_damaged_survey_is_restored_from_its_backup(window, session, idle, tmp_path):
    folder = make_folder(tmp_path)
    path = folder.path
    folder.close()
    window.files.open_path(path)  # opening makes a backup
    idle()
    window.files.close_survey()
    database = path / "survey.db"
    database.write_bytes(database.read_bytes()[:100] + b"\0" * 5000)
    window.boxes.answer = "restore"
    window.files.open_path(path)
    idle()
    assert session.survey == SURVEY
    with sqlite3.connect(database) as connection:
        assert connection.execute("PRAGMA integrity_check").fetchone() == ("ok",)
    connection.close()


def test_what_is_no_survey_is_told_and_the_window_stays_usable(window, session, idle, tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "cat.jpg").write_bytes(b"\xff\xd8\xff")
    window.files.open_path(tmp_path / "photos")
    idle()
    assert any("neither a survey" in text for text in window.data_page.findings.texts())
    window.files.process()
    assert session.folder is None
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    assert window.page == "leaks"


def test_a_survey_that_is_gone_is_forgotten(window, idle, tmp_path):
    gone = tmp_path / "gone.leakline"
    window._preferences.remember_recent(gone)
    window.files.open_path(gone)
    assert window.boxes.told == [ErrorCode.FILE_MISSING]
    assert window._preferences.values.recent == []


def test_a_cancelled_processing_leaves_the_survey_open_and_it_can_be_processed_again(window, session, idle, tmp_path):
    folder = make_folder(tmp_path)
    path = folder.path
    folder.close()
    window.files.open_path(path)
    for job in window._services.jobs.running:
        job.cancel()
    idle()
    assert session.folder.path == path
    assert window.page == "data"
    assert window.boxes.told == []
    window.files.reprocess()
    idle()
    assert session.results is not None


def test_opening_another_survey_while_one_is_processed_shows_only_the_other(window, session, idle, tmp_path):
    first, second = make_folder(tmp_path / "a"), make_folder(tmp_path / "b")
    paths = first.path, second.path
    first.close()
    second.close()
    window.files.open_path(paths[0])
    window.files.open_path(paths[1])
    idle()
    assert session.folder.path == paths[1]
    assert session.results.recording.audio.parts[0].path.is_relative_to(paths[1])


def test_an_unknown_table_is_mapped_by_the_operator_and_remembered(window, session, idle, tmp_path):
    def make_log(folder):
        folder.mkdir()
        wobble = np.random.default_rng(3).normal(0.0, 0.01, (600, 6))  # what never changes is a dead channel
        values = np.array([0.1, -0.2, 9.7, 1.0, 2.0, 3.0]) + wobble
        rows = "\n".join(f"{i * 10};" + ";".join(f"{v:.5f}" for v in row) for i, row in enumerate(values))
        (folder / "log.csv").write_text(f"tick;p;q;r;u;v;w\n{rows}\n", encoding="utf-8")
        return folder

    window.files.open_path(make_log(tmp_path / "one"))
    idle()
    table = window.data_page.preview._mapping
    assert not window.data_page._process.isEnabled()
    meaning = [("time", "ms"), *((f"acc_{a}", "mps2") for a in "xyz"), *((f"gyr_{a}", "dps") for a in "xyz")]
    mapping = ColumnMapping(
        tuple(MappedColumn(i, Quantity(q), unit, "tickpqruvw"[i]) for i, (q, unit) in enumerate(meaning))
    )
    table.mapping_changed.emit(mapping)
    idle()
    assert window.data_page._process.isEnabled()
    window.files.process()
    idle()
    imu = session.results.recording.imu
    assert imu.time_s[1] - imu.time_s[0] == pytest.approx(0.01)
    assert imu.acc_s_mps2[0].tolist() == pytest.approx([0.1, -0.2, 9.7], abs=0.1)
    window.files.close_survey()
    window.files.open_path(make_log(tmp_path / "two"))
    idle()
    assert window.data_page._process.isEnabled()  # the next file of its kind needs no clicks


def test_tie_point_edits_are_processed_again_and_the_decisions_stay(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    session.cursor.set_time(20.0)
    window.review.mark_here()
    window.review.confirm()
    window.data_page.tie_points.tie_points_changed.emit(())
    assert session.folder.read_survey().tie_points == ()
    assert "changed" in window.data_page._state.text()
    window.files.reprocess()
    idle()
    assert session.run.id == 2
    (row,) = [row for row in session.rows() if row.manual]
    assert row.decision.verdict.value == "confirmed"


def test_the_demonstration_says_that_it_is_simulated(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    simulated = Survey(info=SURVEY.info.__class__("Demo", simulated=True), tie_points=SURVEY.tie_points)
    write_survey_toml(device / "survey.toml", simulated)
    window.files.open_path(device)
    idle()
    assert "simulated" in window.notices.banner.text()
    assert window.notices.banner.isVisible()


def test_a_survey_is_exported_into_its_own_folder(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    window.report.export()
    idle()
    assert window.boxes.told == []
    written = window.report.last_export
    assert written.parent == session.folder.exports_dir
    names = {path.name for path in written.iterdir()}
    assert {"leaks.csv", "track.csv", "leaks.geojson", "summary.json", "report.pdf"} <= names
    shutil.rmtree(written)


@pytest.mark.parametrize(("answer", "band"), [("process", (300.0, 2000.0)), ("keep", (500.0, 4000.0))])
def test_another_band_is_processed_only_if_the_operator_means_it(window, session, idle, tmp_path, answer, band):
    device = make_device_folder(tmp_path)
    write_survey_toml(device / "survey.toml", SURVEY)
    window.files.open_path(device)
    idle()
    runs = session.run.id
    window.boxes.answer = answer
    window.review_page.spectrogram.band_changed.emit(300.0, 2000.0)
    idle()
    sound = session.folder.read_settings().sound
    assert (sound.band_low_hz, sound.band_high_hz) == band
    assert window.review_page.spectrogram.band_hz == band
    assert session.run.id == runs + (answer == "process")


def test_headerless_sound_is_read_as_the_form_says_now_and_at_every_opening(window, session, idle, tmp_path):
    device = make_device_folder(tmp_path)
    (device / "audio.wav").unlink()
    noise = np.random.default_rng(4).normal(0.0, 0.05, (400_000, 2))
    (device / "sound.raw").write_bytes((noise * 2**31).astype("<i4").tobytes())
    window.files.open_path(device)
    idle()
    assert not window.data_page._process.isEnabled()
    assert window.data_page.preview._below.currentWidget() is window.data_page.preview._raw
    window.data_page.preview.raw_form_answered.emit(RawAnswer(8000.0, 32, "signed", "little", 2))
    idle()
    window.files.process()
    idle()
    path = session.folder.path
    for _ in range(2):
        audio = session.results.recording.audio
        assert (audio.sample_rate_hz, audio.channels, audio.frames) == (8000.0, 2, 400_000)
        window.files.open_path(path)
        idle()
    assert window.boxes.told == []
