"""Backups are made when something changed, kept in number, and lead back."""

import sqlite3
from pathlib import Path

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.storage import backup, schema
from processing.storage.database import open_writable
from processing.storage.folder import SurveyFolder, is_survey_folder
from processing.storage.migration import migrate, migrated_copy
from processing.survey import Decision, Survey, SurveyInfo, Verdict

YES = Decision(Verdict.CONFIRMED)


def rename_survey(path, name):
    with SurveyFolder.open(path) as opened:
        opened.write_survey(Survey(SurveyInfo(name)))


def test_a_backup_is_made_at_opening_only_if_something_changed(folder):
    folder.close()
    for _ in range(3):
        SurveyFolder.open(folder.path).close()
    assert len(folder.backups()) == 1
    rename_survey(folder.path, "a")
    SurveyFolder.open(folder.path).close()
    assert len(folder.backups()) == 2


def test_the_newest_ten_are_kept_in_order_whatever_the_clock_does(folder):
    folder.close()
    for count in range(13):
        rename_survey(folder.path, f"name {count}")
    numbers = [int(path.name.split("-")[1]) for path in folder.backups()]
    assert numbers == list(range(13, 3, -1))


def test_a_damaged_survey_is_restored_from_the_newest_sound_backup(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    SurveyFolder.open(folder.path).close()
    sound = folder.backups()[0]
    (folder.backups_dir / f"survey-000099-{'0' * 16}.db").write_bytes(b"SQLite format 3\x00 spoilt")
    damaged = b"SQLite format 3\x00" + bytes(5000)
    (folder.path / "survey.db").write_bytes(damaged)
    (folder.path / "survey.db-journal").write_bytes(b"a journal that must never be played back")
    with SurveyFolder.restore(folder.path) as opened:
        assert opened.findings[0].code == "survey_restored"
        assert opened.findings[0].params == {"backup": sound.name}
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}
    assert (folder.backups_dir / "damaged-1.db").read_bytes() == damaged
    assert not (folder.path / "survey.db-journal").exists()


def test_a_lost_database_is_damage_and_can_be_restored(folder, survey):
    folder.close()
    SurveyFolder.open(folder.path).close()
    (folder.path / "survey.db").unlink()
    assert is_survey_folder(folder.path)
    with pytest.raises(LeaklineError) as caught:
        SurveyFolder.open(folder.path)
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED
    with SurveyFolder.restore(folder.path) as opened:
        assert opened.read_survey() == survey


def test_without_a_sound_backup_nothing_is_touched(folder):
    folder.close()
    (folder.path / "survey.db").write_bytes(b"spoilt")
    for file in folder.backups():
        file.write_bytes(b"spoilt too")
    with pytest.raises(LeaklineError) as caught:
        SurveyFolder.restore(folder.path)
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED
    assert (folder.path / "survey.db").read_bytes() == b"spoilt"


def test_a_survey_in_use_is_not_restored(folder):
    with pytest.raises(LeaklineError) as caught:
        SurveyFolder.restore(folder.path)
    assert caught.value.code is ErrorCode.SURVEY_LOCKED


def test_a_backup_that_cannot_be_made_is_told_and_the_survey_opens(folder):
    folder.close()
    for file in folder.backups():
        file.unlink()
    folder.backups_dir.rmdir()
    folder.backups_dir.write_text("somebody's file in the way")
    with SurveyFolder.open(folder.path) as opened:
        assert [f.code for f in opened.findings] == ["survey_backup_failed"]
        assert not opened.read_only


# --- migration, on steps of the test's own, and the real one

NOW = schema.VERSION
STEPS = {
    NOW: (NOW + 1, ("ALTER TABLE runs ADD COLUMN place TEXT",)),
    NOW + 1: (2000, ("CREATE TABLE more (a TEXT) STRICT", "INSERT INTO more VALUES ('ğ')")),
}


@pytest.fixture
def database(folder):
    folder.close()
    opened = open_writable(folder.path / "survey.db")
    yield opened
    opened.close()


def test_migration_takes_all_steps_after_a_backup_of_the_old(folder, database):
    before = len(folder.backups())
    with database.transaction() as db:
        db.execute("INSERT INTO state VALUES ('a', '1')")
    migrate(database, folder.backups_dir, STEPS, 2000)
    assert database.version == 2000
    assert database.rows("SELECT a FROM more") == [("ğ",)]
    assert len(folder.backups()) == before + 1
    old = sqlite3.connect(folder.backups()[0])
    assert old.execute("PRAGMA user_version").fetchone() == (NOW,)
    old.close()


def test_a_migration_that_fails_leaves_the_old_version(folder, database):
    steps = STEPS | {NOW + 1: (2000, ("CREATE TABLE more (a TEXT) STRICT", "INSERT INTO nowhere VALUES (1)"))}
    with pytest.raises(sqlite3.OperationalError, match="nowhere"):
        migrate(database, folder.backups_dir, steps, 2000)
    assert database.version == NOW
    assert [row[1] for row in database.rows("PRAGMA table_info(runs)")] == [
        "id",
        "created_utc",
        "settings_hash",
        "versions",
    ]


def test_a_version_from_which_no_way_leads_is_told(folder, database):
    with pytest.raises(LeaklineError) as caught:
        migrate(database, folder.backups_dir, {}, 2000)
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED
    assert database.version == NOW


def test_an_old_survey_that_may_not_be_written_is_migrated_in_memory(folder, database):
    before = (folder.path / "survey.db").read_bytes()
    copy = migrated_copy(database, STEPS, 2000)
    assert copy.read_only
    assert copy.rows("SELECT a FROM more") == [("ğ",)]
    copy.close()
    assert Path(folder.path / "survey.db").read_bytes() == before


def test_a_survey_of_version_1_0_opens_with_its_decisions_and_takes_the_new_facts(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.close()
    old = sqlite3.connect(folder.path / "survey.db")
    for table in ("photos", "dig_results", "opinions"):
        old.execute(f"DROP TABLE {table}")
    old.execute("PRAGMA user_version = 1000")
    old.commit()
    old.close()
    with SurveyFolder.open(folder.path) as opened:
        assert "survey_migrated" in [finding.code for finding in opened.findings]
        assert opened.review.decisions(stored.run) == {stored.candidates[0].id: YES}
    now = sqlite3.connect(folder.path / "survey.db")
    now.execute("INSERT INTO dig_results (number, at_utc, operator, value) VALUES (1, '', '', '{}')")
    with pytest.raises(sqlite3.DatabaseError, match="append-only"):
        now.execute("DELETE FROM dig_results")
    now.close()


def test_today_s_version_needs_no_step_and_all_steps_lead_to_it():
    assert schema.VERSION not in schema.MIGRATIONS
    for version in schema.MIGRATIONS:
        now = version
        while now < schema.VERSION:
            assert schema.MIGRATIONS[now][0] > now
            now = schema.MIGRATIONS[now][0]
        assert now == schema.VERSION
    assert backup.KEEP == 10
