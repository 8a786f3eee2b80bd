"""A second reviewer judges blind, every word is on disc at once, and the first one's decisions are never touched."""

import pytest
from small_survey import candidate, make_folder, make_results, other_run

from app.review_commands import Decide, DecideMany, Mark, WriteNote
from app.survey_session import SurveySession
from processing.errors import ErrorCode
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, LeakClass, Verdict

YES = Decision(Verdict.CONFIRMED, LeakClass.LEAK, "hears it well")
NO = Decision(Verdict.REJECTED)
SECOND = "Bülent Iğdır"


@pytest.fixture
def session(qtbot, tmp_path):
    folder = make_folder(tmp_path)
    session = SurveySession()
    session.open(folder)
    session.set_results(make_results(folder))
    for candidate_id in session.ordered_ids()[:3]:
        session.push(Decide(session, "first", candidate_id, YES))
    yield session
    session.close()


def on_disk(session):
    """The first one's decisions by id, and the second one's by number, as another program would read them now."""
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        run = other.review.latest_run()
        return other.review.decisions(run), other.opinions.of(SECOND)


def test_nothing_of_the_first_review_is_seen_by_the_second(session):
    ids = session.ordered_ids()
    session.set_reviewer(SECOND)
    assert session.decisions == {}
    assert all(row.decision == Decision() for row in session.rows())
    assert all(row.kind is row.candidate.leak_class for row in session.rows())
    assert session.selected == ids[0]  # the first undecided one: all are
    assert session.operator == SECOND


def test_a_second_verdict_is_an_opinion_and_the_first_ones_stay(session):
    ids = session.ordered_ids()
    before = on_disk(session)[0]
    session.set_reviewer(SECOND)
    label = session.row(ids[0]).candidate.label
    session.push(Decide(session, "second", ids[0], NO, ids[1]))
    assert on_disk(session) == (before, {label: NO})
    assert session.selected == ids[1]
    session.push(WriteNote(session, "note", ids[1], Decision(note="vana"), typing=1))
    session.push(DecideMany(session, "many", {ids[2]: NO, ids[3]: NO}))
    assert len(on_disk(session)[1]) == 4
    while session.undo_stack.canUndo():
        session.undo_stack.undo()
    assert on_disk(session) == (before, {})
    while session.undo_stack.canRedo():
        session.undo_stack.redo()
    assert len(on_disk(session)[1]) == 4
    assert on_disk(session)[0] == before


def test_leaving_brings_the_first_review_back_and_no_undo_of_the_second_can_touch_it(session):
    ids = session.ordered_ids()
    before = session.decisions
    session.set_reviewer(SECOND)
    session.push(Decide(session, "second", ids[0], NO))
    session.set_reviewer("")
    assert session.decisions == before
    assert not session.undo_stack.canUndo()
    assert session.operator == "A. Şahin"
    session.set_reviewer(SECOND)
    assert session.decision(ids[0]) == NO
    assert not session.undo_stack.canUndo()


def test_a_run_made_anew_while_the_second_reviews_stays_blind(session):
    ids = session.ordered_ids()
    session.set_reviewer(SECOND)
    session.push(Decide(session, "second", ids[0], NO))
    session.set_results(other_run(session.results, (20.1, 40.0, 60.0, 80.0), "again"))
    assert [d.verdict for d in session.decisions.values()] == [Verdict.REJECTED]
    session.set_reviewer("")
    assert [d.verdict for d in session.decisions.values()] == [Verdict.CONFIRMED] * 3


def test_a_mark_of_the_second_reviewer_is_theirs_in_the_log(session):
    session.set_reviewer(SECOND)
    session.push(Mark(session, "mark", candidate(0, 50.0, 0.5)))
    marked = session.selected
    session.push(Decide(session, "second", marked, YES))
    assert session.folder.review.decision_log()[-1].operator == SECOND
    session.undo_stack.undo()
    session.undo_stack.undo()
    session.undo_stack.redo()
    assert session.decision(session.selected) == Decision()
    session.set_reviewer("")
    assert session.decision(marked) == Decision()


def test_a_survey_opened_anew_is_reviewed_by_the_first(session, tmp_path):
    session.set_reviewer(SECOND)
    path = session.folder.path
    session.close()
    session.open(SurveyFolder.open(path))
    assert session.reviewer == ""


def test_a_refused_opinion_changes_nothing_and_is_told(session):
    ids = session.ordered_ids()
    path = session.folder.path
    session.close()
    session.open(SurveyFolder.open(path, read_only=True))
    session.set_results(make_results(session.folder))
    session.set_reviewer(SECOND)
    told = []
    session.refused.connect(lambda error: told.append(error.code))
    session.push(Decide(session, "second", ids[0], NO))
    assert told == [ErrorCode.SURVEY_READ_ONLY]
    assert session.decisions == {}
    assert not session.undo_stack.canUndo()
