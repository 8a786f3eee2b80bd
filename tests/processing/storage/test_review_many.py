"""Many decisions in one transaction, and marks that move: all or nothing, everything logged."""

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.storage.folder import SurveyFolder
from processing.storage.review import Reason, replay
from processing.survey import Decision, Run, Survey, SurveyInfo, Verdict

NO, YES = Decision(Verdict.REJECTED, None, "below 0.3"), Decision(Verdict.CONFIRMED)


@pytest.fixture
def folder(tmp_path):
    with SurveyFolder.create(tmp_path, Survey(SurveyInfo("Ölçüm")), []) as made:
        yield made


@pytest.fixture
def stored(folder, candidate):
    return folder.review.add_run(Run(0, "", "hash"), [candidate(t) for t in range(100, 600, 100)])


def read_again(folder):
    """Return (decisions, log) as another connection reads them."""
    with SurveyFolder.open(folder.path, read_only=True) as other:
        return other.review.decisions(other.review.latest_run()), other.review.decision_log()


def test_many_decisions_are_on_disc_together_and_each_is_logged(folder, stored):
    ids = [c.id for c in stored.candidates[:4]]
    folder.review.decide(ids[0], YES, "A")
    log_ids = folder.review.decide_many(dict.fromkeys(ids, NO), "B")
    decisions, log = read_again(folder)
    assert decisions == dict.fromkeys(ids, NO)
    assert [e.id for e in log[1:]] == list(log_ids)
    assert [(e.candidate_id, e.before, e.after, e.operator, e.reason) for e in log[1:]] == [
        (i, YES if i == ids[0] else Decision(), NO, "B", Reason.DECIDE) for i in ids
    ]
    assert replay(log) == decisions


def test_of_many_decisions_none_is_stored_when_one_cannot_be(folder, stored):
    ids = [c.id for c in stored.candidates]
    with pytest.raises(KeyError):
        folder.review.decide_many(dict.fromkeys([*ids, 9999], NO), "A")
    assert read_again(folder) == ({}, ())


def test_many_decisions_cost_one_transaction(folder, stored):
    begun = []
    folder._db.connection.set_trace_callback(lambda sql: begun.append(sql) if sql.startswith("COMMIT") else None)
    folder.review.decide_many(dict.fromkeys([c.id for c in stored.candidates], NO), "A")
    folder._db.connection.set_trace_callback(None)
    assert len(begun) == 1


def test_a_read_only_survey_takes_none_of_them(folder, stored):
    with SurveyFolder.open(folder.path, read_only=True) as other, pytest.raises(LeaklineError) as told:
        other.review.decide_many({stored.candidates[0].id: NO}, "A")
    assert told.value.code is ErrorCode.SURVEY_READ_ONLY


def test_a_mark_moves_with_its_number_and_its_decision_and_can_be_put_back(folder, stored, candidate):
    review = folder.review
    mark = review.add_manual_candidate(stored.run, candidate(250), "A", YES)
    moved = review.move_manual_candidate(mark.id, candidate(260), "A")
    assert (moved.label, moved.time_s) == (mark.label, 260.0)
    assert review.candidates(stored.run) == (*stored.candidates, moved)
    assert review.manual_ids(stored.run) == {moved.id}
    assert read_again(folder)[0] == {moved.id: YES}
    review.swap_manual_candidates(moved.id, mark.id, "A")
    assert review.candidates(stored.run) == (*stored.candidates, mark)
    assert read_again(folder)[0] == {mark.id: YES}
    with pytest.raises(KeyError):
        review.move_manual_candidate(stored.candidates[0].id, candidate(1), "A")  # the machine's stay where they are
    with pytest.raises(KeyError):
        review.move_manual_candidate(moved.id, candidate(1), "A")  # it is not there any more
    assert review.candidates(stored.run) == (*stored.candidates, mark)


def test_a_mark_that_moved_comes_along_to_the_next_run_once(folder, stored, candidate):
    review = folder.review
    mark = review.add_manual_candidate(stored.run, candidate(250), "A", YES)
    review.move_manual_candidate(mark.id, candidate(262), "A")
    second = review.add_run(Run(0, "", "another"), [candidate(100)], "A")
    assert [(c.time_s, c.label) for c in second.candidates[1:]] == [(262.0, mark.label)]
    assert list(review.decisions(second.run).values()) == [YES]


def test_a_kept_verdict_whose_mark_moved_is_not_asked_for_again(folder, stored, candidate):
    review = folder.review
    review.decide(stored.candidates[2].id, YES, "A")
    review.add_run(Run(0, "", "another"), [candidate(100)], "A")
    (orphan,) = review.orphaned_decisions()
    kept = review.keep_orphan(orphan.candidate.id, "A")
    moved = review.move_manual_candidate(kept.id, candidate(310), "A")
    assert review.orphaned_decisions() == ()
    review.swap_manual_candidates(moved.id, kept.id, "A")
    assert review.orphaned_decisions() == ()
    review.withdraw_manual_candidate(kept.id, "A")
    assert [o.candidate.id for o in review.orphaned_decisions()] == [orphan.candidate.id]
