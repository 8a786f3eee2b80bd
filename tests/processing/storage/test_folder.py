"""A survey folder is made whole or not at all, opens whatever happened to it, and tells what it noticed.

Longer than 400 lines because making, opening, restoring and exporting share one set of broken folders.
"""

import errno
import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import threading
from contextlib import contextmanager
from pathlib import Path

import pytest

from processing import messages
from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.progress import Progress
from processing.settings import Settings, with_value
from processing.storage import creating, files, schema
from processing.storage.creating import create_folder
from processing.storage.folder import SurveyFolder, is_survey_folder
from processing.storage.lock import LOCK_NAME
from processing.survey import Decision, ImportedFile, Run, Survey, SurveyInfo, TiePoint, Verdict

YES = Decision(Verdict.CONFIRMED)


def codes(opened):
    for finding in opened.findings:
        for language in messages.LANGUAGES:
            assert messages.finding_sentence(finding, language)
    return [finding.code for finding in opened.findings]


def refused(path, **how):
    with pytest.raises(LeaklineError) as caught:
        SurveyFolder.open(path, **how)
    for language in messages.LANGUAGES:
        assert messages.error_sentence(caught.value, language)
    return caught.value.code


# --- making


def test_a_new_folder_holds_true_copies_and_the_survey(folder, device, survey):
    assert folder.path.name == "İstasyon-Caddesi-2026-05-04.leakline"
    assert folder.read_survey() == survey
    assert {p.name for p in folder.path.iterdir()} >= {
        "survey.db",
        "recordings",
        "cache",
        "exports",
        "backups",
        LOCK_NAME,
    }
    for name in ("imu.csv", "audio.wav"):
        assert (folder.original_dir / name).read_bytes() == (device / name).read_bytes()
    assert [(f.path.name, f.role, f.size) for f in folder.files()] == [
        ("audio.wav", "audio", 10240),
        ("imu.csv", "imu", 25),
    ]
    assert all(f.path.is_file() for f in folder.files())
    assert not folder.read_only
    assert is_survey_folder(folder.path)
    assert not is_survey_folder(device)
    assert list(folder.path.parent.iterdir()) == [folder.path]


def test_a_name_that_is_taken_gets_a_number(folder, survey):
    assert create_folder(folder.path.parent, survey, []).name == "İstasyon-Caddesi-2026-05-04-2.leakline"
    assert create_folder(folder.path.parent, survey, []).name == "İstasyon-Caddesi-2026-05-04-3.leakline"


@pytest.mark.parametrize(
    ("name", "date", "expected"),
    [
        ("", "", "Survey.leakline"),
        ("../../../evil", "../x", "evil-x.leakline"),
        ("Station Road", "2026-05-04", "Station-Road-2026-05-04.leakline"),
        ("İĞÜŞÖÇ ığüşöç", " ", "İĞÜŞÖÇ-ığüşöç.leakline"),
    ],
)
def test_the_folder_lies_in_its_target_whatever_the_survey_is_called(tmp_path, name, date, expected):
    made = create_folder(tmp_path / "x", Survey(SurveyInfo(name=name, date=date)), [])
    assert made == tmp_path / "x" / expected


def test_files_of_subfolders_keep_their_places_and_files_of_one_name_never_meet(tmp_path, device):
    for sub in ("a", "b"):
        (device / sub).mkdir()
        (device / sub / "part.wav").write_bytes(sub.encode())
    made = create_folder(tmp_path / "out", Survey(), [device / "imu.csv", device / "a/part.wav", device / "b/part.wav"])
    original = made / "recordings/1/original"
    assert (original / "a/part.wav").read_bytes() == b"a"
    assert (original / "b/part.wav").read_bytes() == b"b"
    assert (original / "imu.csv").exists()


def test_a_file_that_changed_since_import_is_refused(tmp_path, device):
    told = ImportedFile(device / "imu.csv", "imu", 25, "0" * 64)
    with pytest.raises(LeaklineError) as caught:
        create_folder(tmp_path / "out", Survey(), [told])
    assert caught.value.code is ErrorCode.FILE_UNREADABLE
    assert list((tmp_path / "out").iterdir()) == []


def test_a_missing_file_is_told_before_anything_is_made(tmp_path, device):
    with pytest.raises(LeaklineError) as caught:
        create_folder(tmp_path / "out", Survey(), [device / "gone.wav"])
    assert caught.value.code is ErrorCode.FILE_MISSING
    assert not (tmp_path / "out").exists()


def test_cancelling_at_any_moment_leaves_nothing(tmp_path, device):
    for calls in range(6):
        left = [calls]

        def cancelled(left=left):
            left[0] -= 1
            return left[0] < 0

        try:
            create_folder(tmp_path / "out", Survey(), sorted(device.iterdir()), Progress(is_cancelled=cancelled))
        except Cancelled:
            assert list((tmp_path / "out").iterdir()) == []
        else:
            assert calls > 2
            return
    pytest.fail("it never came to an end")


def test_progress_grows_to_one(tmp_path, device):
    told = []
    create_folder(
        tmp_path / "out", Survey(), sorted(device.iterdir()), Progress(lambda f, phrase: told.append((f, phrase)))
    )
    assert [f for f, _ in told] == sorted(f for f, _ in told)
    assert told[-1] == (1.0, "copying_originals")


def test_a_disc_that_is_too_small_is_told_at_once(tmp_path, device, monkeypatch):
    monkeypatch.setattr(creating.shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(10, 10, 0))
    with pytest.raises(LeaklineError) as caught:
        create_folder(tmp_path / "out", Survey(), sorted(device.iterdir()))
    assert caught.value.code is ErrorCode.DISC_FULL


def test_a_disc_that_fills_up_meanwhile_is_told_and_nothing_is_left(tmp_path, device, monkeypatch):
    def full(_handle):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(files.os, "fsync", full)
    with pytest.raises(LeaklineError) as caught:
        create_folder(tmp_path / "out", Survey(), sorted(device.iterdir()))
    assert caught.value.code is ErrorCode.DISC_FULL
    assert list((tmp_path / "out").iterdir()) == []


def test_what_a_killed_maker_left_is_swept_but_not_what_a_living_one_makes(tmp_path):
    dead = subprocess.Popen([sys.executable, "-c", "pass"])
    dead.wait()
    for name, pid in (("dead", dead.pid), ("alive", os.getpid())):
        part = tmp_path / f".{name}-1.leakline-part"
        part.mkdir()
        creating.acquire(part)
        if name == "dead":
            text = (part / LOCK_NAME).read_text().replace(f'"pid": {os.getpid()}', f'"pid": {pid}')
            (part / LOCK_NAME).write_text(text)
    create_folder(tmp_path, Survey(), [])
    assert sorted(p.name for p in tmp_path.iterdir()) == [".alive-1.leakline-part", "Survey.leakline"]


@pytest.mark.skipif(os.name == "nt", reason="Windows allows no such names")
def test_a_path_with_signs_that_mean_something_in_addresses_is_taken_literally(tmp_path, survey):
    place = tmp_path / "100%41 a?mode=memory #1 & ölçüm"
    with SurveyFolder.create(place, survey, []) as made, SurveyFolder.open(made.path, read_only=True) as reader:
        assert reader.read_survey() == survey
        assert [p.name for p in place.iterdir()] == [made.path.name]


# --- what the operator told


def test_the_survey_is_stored_and_each_change_logged(folder, survey):
    changed = Survey(survey.info, survey.pipe, tie_points=(*survey.tie_points, TiePoint("dönüş", 5.0, chainage_m=9.0)))
    folder.write_survey(changed, "Ayşe")
    folder.write_survey(changed, "Ayşe")
    assert folder.read_survey() == changed
    log = folder._db.rows("SELECT operator, part, before IS NULL FROM survey_log ORDER BY id")
    assert log[-2:] == [("Ayşe", "tie_points", 0), ("Ayşe", "route", 0)]
    assert len([row for row in log if row[1] == "tie_points"]) == 2


def test_only_settings_that_differ_are_stored_and_strangers_are_told(folder):
    settings = with_value(Settings(), "sound", "band_low_hz", "700.25")
    settings = with_value(settings, "report", "language", "tr")
    folder.write_settings(settings)
    assert folder.read_settings() == settings
    assert len(folder._db.rows("SELECT * FROM settings")) == 2
    with folder._db.transaction() as db:
        db.execute("INSERT INTO settings VALUES ('sound.of_the_future', '1'), ('sound.band_high_hz', '-5')")
    assert folder.read_settings() == settings
    folder.read_settings()
    assert codes(folder) == ["stored_setting_ignored", "stored_setting_ignored"]
    folder.write_settings(Settings())
    assert folder._db.rows("SELECT name FROM settings") == [("sound.of_the_future",)]


def test_import_options_and_window_state_come_back(folder):
    assert folder.read_import_options() is None
    folder.write_import_options({"units": {"acc": "g"}, "columns": ["a", 1, None]})
    assert folder.read_import_options() == {"units": {"acc": "g"}, "columns": ["a", 1, None]}
    folder.write_state({"selected": 3, "layout": "ğ"})
    folder.write_state({"selected": 4})
    assert folder.read_state() == {"selected": 4}


def test_exports_never_overwrite_and_carry_run_and_date(folder):
    run = Run(3, "2026-05-04T10:00:00.000+00:00", "h")
    first = folder.new_export("leaks", ".csv", run)
    assert first == folder.exports_dir / "leaks-run3-2026-05-04.csv"
    first.write_text("x")
    assert folder.new_export("leaks", ".csv", run).name == "leaks-run3-2026-05-04-2.csv"


def test_changed_and_missing_originals_are_told(folder):
    assert folder.verify_originals() == ()
    (folder.original_dir / "imu.csv").write_bytes(b"something else")
    (folder.original_dir / "audio.wav").unlink()
    found = folder.verify_originals()
    assert [f.code for f in found] == ["original_missing", "original_changed"]
    assert all(messages.finding_sentence(f, "tr") for f in found)


def test_a_database_that_names_files_outside_is_refused(folder):
    with folder._db.transaction() as db:
        db.execute(f"INSERT INTO recording_files VALUES (1, '../../../../etc/passwd', 'imu', 1, '{'0' * 64}')")
    with pytest.raises(LeaklineError) as caught:
        folder.files()
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED


# --- opening


def test_a_closed_folder_opens_with_everything_in_it(folder, stored, survey):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    folder.close()
    assert not (folder.path / LOCK_NAME).exists()
    with SurveyFolder.open(folder.path) as again:
        assert codes(again) == []
        assert again.read_survey() == survey
        assert again.review.candidates(stored.run) == stored.candidates
        assert again.review.decisions(stored.run) == {stored.candidates[0].id: YES}
        assert again.version == schema.version_text(schema.VERSION)


def test_a_second_opener_may_only_read_and_sees_what_is_committed(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    assert refused(folder.path) is ErrorCode.SURVEY_LOCKED
    with SurveyFolder.open(folder.path, read_only=True) as reader:
        assert reader.read_only
        assert reader.review.decisions(stored.run) == {stored.candidates[0].id: YES}
        folder.review.decide(stored.candidates[1].id, YES, "A")
        assert len(reader.review.decisions(stored.run)) == 2
        with pytest.raises(LeaklineError) as caught:
            reader.review.decide(stored.candidates[2].id, YES, "B")
        assert caught.value.code is ErrorCode.SURVEY_READ_ONLY
    assert (folder.path / LOCK_NAME).exists()


def test_another_process_is_kept_out(folder):
    script = (
        "import sys; from pathlib import Path; from processing.storage.folder import SurveyFolder\n"
        "from processing.errors import LeaklineError\n"
        "try: SurveyFolder.open(Path(sys.argv[1]))\n"
        "except LeaklineError as error: print(error.code.value)\n"
    )
    command = [sys.executable, "-c", script, str(folder.path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == "survey_locked"


def test_the_folder_belongs_to_the_thread_that_opened_it(folder):
    caught = []

    def other():
        try:
            folder.read_survey()
        except sqlite3.ProgrammingError as error:
            caught.append(error)

    thread = threading.Thread(target=other)
    thread.start()
    thread.join()
    assert len(caught) == 1


def test_what_is_no_survey_is_told_as_such(tmp_path, device):
    assert refused(tmp_path / "gone") is ErrorCode.FILE_MISSING
    assert refused(device) is ErrorCode.NOT_A_SURVEY
    assert refused(device / "imu.csv") is ErrorCode.NOT_A_SURVEY
    sqlite3.connect(device / "survey.db").execute("CREATE TABLE a (b)").connection.close()
    assert refused(device) is ErrorCode.NOT_A_SURVEY
    assert not (device / LOCK_NAME).exists()


@pytest.mark.parametrize("content", [b"", b"not a database at all", b"SQLite format 3\x00" + bytes(3000)])
@pytest.mark.parametrize("read_only", [False, True])
def test_a_garbled_database_is_damage(folder, content, read_only):
    folder.close()
    (folder.path / "survey.db").write_bytes(content)
    assert refused(folder.path, read_only=read_only) is ErrorCode.SURVEY_DAMAGED
    assert not (folder.path / LOCK_NAME).exists()


def test_every_overwritten_page_is_noticed_or_harmless(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    sound = (folder.path / "survey.db").read_bytes()
    page = 4096
    told = []
    for start in range(0, len(sound), page):
        (folder.path / "survey.db").write_bytes(sound[:start] + b"\xa5" * page + sound[start + page :])
        try:
            with SurveyFolder.open(folder.path, read_only=True) as opened:
                opened.read_survey()
                opened.review.decisions(1)
                opened.review.candidates(1)
        except LeaklineError as error:
            told.append(error.code)
    assert set(told) == {ErrorCode.SURVEY_DAMAGED}
    assert len(told) >= 0.9 * len(sound) / page


@contextmanager
def unwritable(path):
    """Make a tree read-only; root may write everywhere, so it becomes nobody for a while."""
    places = [path, *path.rglob("*")]
    for place in places:
        place.chmod(0o555 if place.is_dir() else 0o444)
    was_root = os.geteuid() == 0
    if was_root:
        os.seteuid(65534)
    try:
        yield
    finally:
        if was_root:
            os.seteuid(0)
        for place in places:
            place.chmod(0o755 if place.is_dir() else 0o644)


@pytest.fixture
def elsewhere():
    """A place whose parents anybody may enter."""
    with tempfile.TemporaryDirectory() as place:
        Path(place).chmod(0o755)
        yield Path(place)


@pytest.mark.skipif(os.name == "nt", reason="file modes")
def test_a_folder_where_nothing_can_be_written_opens_read_only(folder, stored, elsewhere):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    (folder.path / "cache" / "step").mkdir()
    folder.close()
    moved = Path(shutil.copytree(folder.path, elsewhere / "Salt okunur çubuk.leakline"))
    before = sorted(p.name for p in moved.iterdir())
    with unwritable(moved), SurveyFolder.open(moved) as opened:
        assert codes(opened) == ["survey_medium_read_only"]
        assert opened.read_only
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}
        made = opened.cache().entry("track", "abc", lambda place: (place / "a").write_text("x") and None)
        assert opened.cache().get("track", "abc") == made
        assert moved not in made.parents
    assert not made.exists()
    assert sorted(p.name for p in moved.iterdir()) == before


def leave_a_hot_journal(folder, stored):
    """Die in the middle of a commit: half of the change in the database, the way back in the journal."""
    script = (
        "import os, sqlite3, sys\n"
        "db = sqlite3.connect(sys.argv[1], isolation_level=None)\n"
        "db.execute('PRAGMA cache_size = 1'); db.execute('PRAGMA cache_spill = 1')\n"
        "db.execute('BEGIN IMMEDIATE')\n"
        "db.execute('DELETE FROM decisions')\n"
        "db.execute('CREATE TABLE filler (a)')\n"
        "db.executemany('INSERT INTO filler VALUES (?)', [('x' * 4000,)] * 200)\n"
        "os._exit(9)\n"
    )
    subprocess.run([sys.executable, "-c", script, str(folder.path / "survey.db")], check=False, timeout=60)
    assert (folder.path / "survey.db-journal").stat().st_size > 0


@pytest.mark.parametrize("read_only", [False, True])
def test_a_commit_that_a_crash_cut_in_two_is_rolled_back(folder, stored, read_only):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    leave_a_hot_journal(folder, stored)
    cut = (folder.path / "survey.db").read_bytes()
    with SurveyFolder.open(folder.path, read_only=read_only) as opened:
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}
        assert opened._db.rows("SELECT name FROM sqlite_schema WHERE name = 'filler'") == []
    assert ((folder.path / "survey.db").read_bytes() == cut) is read_only  # reading writes nothing


@pytest.mark.skipif(os.name == "nt", reason="file modes")
def test_a_cut_commit_on_a_read_only_medium_is_rolled_back_in_a_copy(folder, stored, elsewhere):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    leave_a_hot_journal(folder, stored)
    moved = Path(shutil.copytree(folder.path, elsewhere / "a.leakline"))
    with unwritable(moved), SurveyFolder.open(moved) as opened:
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}


def test_a_full_disc_refuses_the_decision_and_keeps_the_others(folder, stored):
    first, second = (c.id for c in stored.candidates[:2])
    folder.review.decide(first, YES, "A")
    (pages,) = folder._db.rows("PRAGMA page_count")[0]
    folder._db.connection.execute(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(LeaklineError) as caught:
        folder.review.decide(second, Decision(Verdict.UNSURE, note="x" * 100_000), "A")
    assert caught.value.code is ErrorCode.DISC_FULL
    assert folder.review.decisions(stored.run) == {first: YES}
    folder._db.connection.execute("PRAGMA max_page_count = 1000000")
    folder.review.decide(second, YES, "A")  # space was freed
    assert folder.review.decisions(stored.run) == {first: YES, second: YES}
    assert len(folder.review.decision_log()) == 2


@pytest.mark.skipif(sys.platform != "linux", reason="a limit on file size, as Linux has it")
def test_a_write_that_fails_half_way_is_told_and_rolled_back(folder, stored):
    import resource

    folder.review.decide(stored.candidates[0].id, YES, "A")
    old = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, ((folder.path / "survey.db").stat().st_size, old[1]))
    try:
        with pytest.raises(LeaklineError) as caught:
            folder.review.decide(stored.candidates[1].id, Decision(Verdict.UNSURE, note="x" * 100_000), "A")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old)
    assert caught.value.code in (ErrorCode.CANNOT_WRITE, ErrorCode.DISC_FULL)
    assert folder.review.decisions(stored.run) == {stored.candidates[0].id: YES}
    folder.review.decide(stored.candidates[1].id, YES, "A")
    assert len(folder.review.decision_log()) == 2


# --- versions


def set_version(path, version, extra=""):
    connection = sqlite3.connect(path / "survey.db")
    connection.executescript(f"{extra}; PRAGMA user_version = {version}")
    connection.close()


def test_a_newer_major_version_opens_read_only_with_a_sentence(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    set_version(folder.path, schema.VERSION + 1000, "CREATE TABLE future (a)")
    with SurveyFolder.open(folder.path) as opened:
        assert codes(opened) == ["survey_newer"]
        assert opened.read_only
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}
        assert not (folder.path / LOCK_NAME).exists()
    with SurveyFolder.open(folder.path, read_only=True) as opened:
        assert codes(opened) == ["survey_newer"]


def test_a_newer_major_version_that_cannot_be_read_is_told(folder):
    folder.close()
    set_version(folder.path, schema.VERSION + 1000, "DROP TABLE survey")
    assert refused(folder.path) is ErrorCode.SURVEY_NEWER


def test_a_newer_minor_version_opens_for_writing_and_stays_what_it_is(folder, survey):
    folder.close()
    set_version(folder.path, schema.VERSION + 7, "ALTER TABLE runs ADD COLUMN future TEXT")
    with SurveyFolder.open(folder.path) as opened:
        assert codes(opened) == []
        opened.write_survey(survey, "A")
        opened.review.add_run(Run(0, "", "h"), [])
        assert opened.version == f"1.{schema.VERSION % 1000 + 7}"
