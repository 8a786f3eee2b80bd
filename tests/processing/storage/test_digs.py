"""Digs are kept, corrected and taken back; what was stated when a crew dug never changes."""

import sqlite3
from dataclasses import replace

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.review_facts import DigFinding, DigResult
from processing.storage.digs import stated_by
from processing.storage.folder import SurveyFolder
from processing.survey import Run

FOUND = DigResult(1, DigFinding.LEAK, "2026-05-12", off_along_m=0.6, cause="çatlak", dug_by="Şükrü", note="İğne ucu")


@pytest.fixture
def entered(folder, stored):
    return folder.digs.record(stated_by(stored.candidates[0], stored.run.id, FOUND), "Ayşe")


def test_a_dig_is_on_disc_with_its_statement_before_the_call_returns(folder, stored, entered):
    elsewhere = sqlite3.connect(f"file:{folder.path / 'survey.db'}?mode=ro", uri=True)
    (row,) = elsewhere.execute("SELECT number, operator, value FROM dig_results").fetchall()
    elsewhere.close()
    assert row[:2] == (1, "Ayşe")
    assert '"cause":"çatlak"' in row[2]
    first = stored.candidates[0]
    assert folder.digs.results() == {1: entered}
    assert (entered.stated_chainage_m, entered.stated_low95_m, entered.stated_high95_m) == (100.0, 99.0, 101.0)
    assert (entered.stated_score, entered.run_id) == (first.score, stored.run.id)
    assert entered.at_utc.startswith("20")


def test_a_correction_counts_and_keeps_what_was_stated_then(folder, candidate, entered):
    folder.review.add_run(Run(0, "", "hash-2"), [candidate(100, half_m=9.0)])
    folder.digs.record(replace(FOUND, off_along_m=0.8), "Ali")
    (now,) = folder.digs.results().values()
    assert (now.off_along_m, now.operator) == (0.8, "Ali")
    assert (now.stated_low95_m, now.stated_high95_m, now.run_id) == (99.0, 101.0, entered.run_id)
    assert [(e.operator, e.result.off_along_m) for e in folder.digs.log()] == [("Ayşe", 0.6), ("Ali", 0.8)]


def test_what_was_taken_back_is_gone_but_for_the_log_and_can_be_entered_anew(folder, entered):
    folder.digs.clear(1, "Ali")
    assert folder.digs.results() == {}
    assert [(e.number, e.operator, e.result is None) for e in folder.digs.log()] == [
        (1, "Ayşe", False),
        (1, "Ali", True),
    ]
    folder.digs.record(entered, "Ayşe")
    assert folder.digs.results()[1].off_along_m == 0.6


def test_a_missed_leak_has_no_statement_even_where_one_was_entered_before(folder, entered):
    stored = folder.digs.record(DigResult(1, DigFinding.LEAK, missed=True), "Ayşe")
    assert stored.stated_chainage_m is None


def test_a_leak_without_a_place_states_none(folder, candidate):
    nowhere = candidate(5, chainage_m=float("nan"), score=float("nan"))
    folder.digs.record(stated_by(nowhere, 1, FOUND), "A")
    assert folder.digs.results()[1].stated_chainage_m is None
    assert folder.digs.results()[1].stated_score is None


def test_a_crew_may_have_dug_by_an_older_run_whose_statement_is_still_there(folder, stored, candidate):
    second = folder.review.add_run(Run(0, "2026-05-06", "hash-2"), [candidate(100.4, half_m=2.0), candidate(700)])
    number = second.candidates[0].label
    assert number == stored.candidates[0].label
    found = folder.digs.statements(number)
    assert [(s.run_id, s.candidate.chainage_low95_m) for s in found] == [(second.run.id, 98.4), (stored.run.id, 99.0)]
    assert found[0].run_utc == "2026-05-06"
    assert folder.digs.statements(99) == ()


def test_a_mark_of_the_operators_is_a_statement_though_its_figures_are_no_numbers(folder, stored, candidate):
    mark = folder.review.add_manual_candidate(stored.run, candidate(450, score=float("nan")), "Ayşe")
    (found,) = folder.digs.statements(mark.label)
    assert found.candidate.chainage_m == 450.0
    assert folder.digs.statements(1)[0].candidate.chainage_m == 100.0  # not that of number 10 or 11


def test_digs_can_be_neither_changed_nor_deleted(folder, entered):
    for sql in ("DELETE FROM dig_results", "UPDATE dig_results SET value = NULL"):
        with pytest.raises(sqlite3.IntegrityError, match="append-only"), folder._db.transaction() as db:
            db.execute(sql)
    assert folder.digs.results() == {1: entered}


def test_a_survey_that_is_read_only_takes_no_dig_but_shows_them(folder, entered):
    folder.close()
    with SurveyFolder.open(folder.path, read_only=True) as reader:
        assert reader.digs.results() == {1: entered}
        with pytest.raises(LeaklineError) as caught:
            reader.digs.record(FOUND, "A")
        assert caught.value.code is ErrorCode.SURVEY_READ_ONLY


def test_a_damaged_entry_is_told_as_damage(folder, entered):
    with folder._db.transaction() as db:
        db.execute("INSERT INTO dig_results (number, at_utc, operator, value) VALUES (2, '', '', '{\"number\":2}')")
    with pytest.raises(LeaklineError) as caught:
        folder.digs.results()
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED
