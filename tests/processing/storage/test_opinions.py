"""Second opinions are appended, on disc at once, and the newest word of each reviewer holds."""

import sqlite3

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.review_facts import Opinion
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, LeakClass, Run, Verdict

YES, NO = Decision(Verdict.CONFIRMED, LeakClass.LEAK, "açık seçik"), Decision(Verdict.REJECTED, note="vana")


def test_an_opinion_is_on_disc_when_the_call_returns(folder):
    given = folder.opinions.give(4, "Bülent Iğdır", YES)
    assert given == Opinion(4, "Bülent Iğdır", YES, given.at_utc)
    with SurveyFolder.open(folder.path, read_only=True) as other:
        assert other.opinions.opinions() == (given,)


def test_the_newest_word_of_each_reviewer_holds_and_all_words_are_kept(folder):
    store = folder.opinions
    store.give(1, "B", NO)
    store.give(1, "C", YES)
    store.give(2, "B", YES)
    store.give(1, "B", YES)
    assert [(o.number, o.reviewer, o.decision) for o in store.opinions()] == [
        (1, "C", YES), (1, "B", YES), (2, "B", YES),
    ]  # fmt: skip
    assert store.of("B") == {1: YES, 2: YES}
    assert store.reviewers() == ("B", "C")
    assert [(o.number, o.reviewer, o.decision) for o in store.log()] == [
        (1, "B", NO), (1, "C", YES), (2, "B", YES), (1, "B", YES),
    ]  # fmt: skip


def test_an_empty_decision_takes_an_opinion_back(folder):
    store = folder.opinions
    store.give(1, "B", YES)
    store.give(1, "B", Decision())
    assert store.opinions() == ()
    assert store.reviewers() == ()
    assert [o.decision for o in store.log()] == [YES, Decision()]
    store.give(1, "B", NO)
    assert store.of("B") == {1: NO}


def test_names_are_one_line_and_somebodys(folder):
    assert folder.opinions.give(1, "  Bülent \n Iğdır ", YES).reviewer == "Bülent Iğdır"
    with pytest.raises(ValueError, match="somebody"):
        folder.opinions.give(1, " \n", YES)


def test_opinions_stay_with_the_leak_when_the_survey_is_processed_again(folder, stored, candidate):
    label = stored.candidates[2].label
    folder.opinions.give(label, "B", YES)
    again = folder.review.add_run(Run(0, "", "hash-2"), [candidate(300.2), candidate(50)])
    (same,) = (c for c in again.candidates if c.label == label)
    assert same.time_s == 300.2
    assert folder.opinions.of("B") == {label: YES}


def test_many_are_given_together_or_not_at_all(folder):
    folder.opinions.give_all({1: YES, 2: NO}, "B")
    assert folder.opinions.of("B") == {1: YES, 2: NO}
    with pytest.raises(sqlite3.Error):
        folder.opinions.give_all({3: YES, "x" * 9: NO}, "B")  # no number
    assert folder.opinions.of("B") == {1: YES, 2: NO}


def test_what_was_said_can_be_neither_changed_nor_deleted(folder):
    folder.opinions.give(1, "B", YES)
    for sql in ("DELETE FROM opinions", "UPDATE opinions SET reviewer = 'C'"):
        with pytest.raises(sqlite3.IntegrityError, match="append-only"), folder._db.transaction() as db:
            db.execute(sql)


def test_a_read_only_survey_takes_no_opinion(folder):
    folder.opinions.give(1, "B", YES)
    folder.close()
    with SurveyFolder.open(folder.path, read_only=True) as opened:
        with pytest.raises(LeaklineError) as caught:
            opened.opinions.give(1, "B", NO)
        assert caught.value.code is ErrorCode.SURVEY_READ_ONLY
        assert opened.opinions.of("B") == {1: YES}


def test_a_spoilt_row_is_damage_not_a_crash(folder):
    with folder._db.transaction() as db:
        db.execute("INSERT INTO opinions (number, at_utc, reviewer, value) VALUES (1, '', 'B', '{\"verdict\": 3}')")
    with pytest.raises(LeaklineError) as caught:
        folder.opinions.opinions()
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED
