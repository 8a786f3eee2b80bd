"""Commands and session: on disk before anything is shown, undone with the selection, refused without harm."""

import pytest
from small_survey import candidate, make_folder, make_results, other_run

from app.review_commands import Decide, EditSurvey, Mark, WriteNote
from app.survey_session import SurveySession
from processing.errors import ErrorCode, LeaklineError
from processing.storage.folder import SurveyFolder
from processing.storage.review import Reason, replay
from processing.survey import Decision, LeakClass, TiePoint, Verdict


@pytest.fixture
def session(qtbot, tmp_path):
    folder = make_folder(tmp_path)
    session = SurveySession()
    session.open(folder)
    session.set_results(make_results(folder))
    yield session
    session.close()


def on_disk(session):
    """What another program would read from the database now."""
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        run = other.review.latest_run()
        decisions = other.review.decisions(run)
        assert decisions == {k: v for k, v in replay(other.review.decision_log()).items() if k in decisions}
        return decisions


def decide(session, verdict, candidate_id=None):
    wanted = session.selected if candidate_id is None else candidate_id
    after = Decision(verdict, note=session.decision(wanted).note)
    session.push(Decide(session, "verdict", wanted, after, session.next_undecided(wanted)))


def test_the_first_candidate_is_selected_and_the_cursor_goes_there(session):
    first = session.ordered_ids()[0]
    assert session.selected == first
    assert session.cursor.time_s == pytest.approx(session.row(first).candidate.time_s)


def test_a_verdict_is_on_disk_before_the_next_candidate_is_selected(session):
    first, second, *_ = session.ordered_ids()
    seen = []
    session.selection_changed.connect(lambda: seen.append((session.selected, on_disk(session))))
    decide(session, Verdict.CONFIRMED)
    assert seen == [(second, {first: Decision(Verdict.CONFIRMED)})]


def test_undo_of_confirm_selects_the_candidate_again(session):
    first = session.ordered_ids()[0]
    decide(session, Verdict.CONFIRMED)
    session.select(session.ordered_ids()[3])
    session.undo_stack.undo()
    assert session.selected == first
    assert session.decision(first) == Decision()
    assert on_disk(session) == {}


def test_undo_works_after_the_last_candidate_too(session):
    for _ in range(4):
        decide(session, Verdict.REJECTED)
    last = session.selected
    assert session.next_undecided(last) is None
    assert len(on_disk(session)) == 4
    session.undo_stack.undo()
    assert session.selected == session.ordered_ids()[3]
    assert len(on_disk(session)) == 3
    while session.undo_stack.canUndo():
        session.undo_stack.undo()
    assert on_disk(session) == {}
    while session.undo_stack.canRedo():
        session.undo_stack.redo()
    assert len(on_disk(session)) == 4


def test_every_step_is_logged_with_its_reason(session):
    first = session.ordered_ids()[0]
    decide(session, Verdict.UNSURE)
    session.undo_stack.undo()
    session.undo_stack.redo()
    reasons = [entry.reason for entry in session.folder.review.decision_log() if entry.candidate_id == first]
    assert reasons == [Reason.DECIDE, Reason.UNDO, Reason.REDO]


def test_the_next_undecided_is_below_then_from_the_top(session):
    ids = session.ordered_ids()
    session.select(ids[2])
    decide(session, Verdict.CONFIRMED)
    assert session.selected == ids[3]
    decide(session, Verdict.CONFIRMED)
    assert session.selected == ids[0]


def test_what_is_typed_in_one_go_is_one_step_of_undo_and_each_moment_of_it_is_on_disk(session):
    first = session.ordered_ids()[0]
    for note in ("w", "we", "wet"):
        session.push(WriteNote(session, "note", first, Decision(note=note), typing=1))
        assert on_disk(session)[first].note == note
    session.push(WriteNote(session, "note", first, Decision(note="wet road"), typing=2))
    session.undo_stack.undo()
    assert session.decision(first).note == "wet"
    session.undo_stack.undo()
    assert session.decision(first).note == ""
    assert not session.undo_stack.canUndo()


def test_a_mark_comes_and_goes_with_undo_and_keeps_its_id(session):
    before = session.selected
    session.push(Mark(session, "mark", candidate(0, 50.0, 0.5)))
    marked = session.selected
    assert session.row(marked).manual
    assert marked in session.ordered_ids()
    assert marked in {c.id for c in session.results.candidates}
    decide(session, Verdict.CONFIRMED, marked)
    session.undo_stack.undo()
    session.undo_stack.undo()
    assert session.row(marked) is None
    assert session.selected == before
    session.undo_stack.redo()
    assert session.selected == marked


def test_a_tie_point_edit_is_on_disk_and_can_be_undone(session):
    before = session.survey
    after = before.__class__(**{**before.__dict__, "tie_points": (TiePoint("valve", 3.0, chainage_m=6.0),)})
    session.push(EditSurvey(session, "tie points", after))
    assert session.folder.read_survey() == after
    session.undo_stack.undo()
    assert session.folder.read_survey() == session.survey == before


def test_a_write_that_is_refused_changes_nothing_and_is_told(session, monkeypatch, qtbot):
    def full(*_args):
        raise LeaklineError(ErrorCode.DISC_FULL)

    first = session.selected
    monkeypatch.setattr(session.folder.review, "decide", full)
    with qtbot.waitSignal(session.refused) as told:
        decide(session, Verdict.CONFIRMED)
    assert told.args[0].code is ErrorCode.DISC_FULL
    assert session.selected == first
    assert session.decision(first) == Decision()
    assert not session.undo_stack.canUndo()
    monkeypatch.undo()
    decide(session, Verdict.CONFIRMED)
    assert on_disk(session) == {first: Decision(Verdict.CONFIRMED)}


def test_a_read_only_survey_shows_everything_and_refuses_every_change(session, qtbot):
    first = session.selected
    decide(session, Verdict.CONFIRMED)
    path = session.folder.path
    results = session.results
    session.close()
    session.open(SurveyFolder.open(path, read_only=True))
    session.set_results(results)
    assert session.decision(first).verdict is Verdict.CONFIRMED
    with qtbot.waitSignal(session.refused) as told:
        decide(session, Verdict.REJECTED, first)
    assert told.args[0].code is ErrorCode.SURVEY_READ_ONLY
    assert session.decision(first).verdict is Verdict.CONFIRMED


def test_a_new_run_carries_decisions_over_and_lists_those_without_a_partner(session):
    first, _, _, last = session.ordered_ids()
    session.push(Decide(session, "verdict", first, Decision(Verdict.CONFIRMED, LeakClass.VALVE, "here")))
    session.push(Decide(session, "verdict", last, Decision(Verdict.REJECTED)))
    session.set_results(other_run(make_results(session.folder), (20.2, 41.0), "another run"))
    carried = {session.row(i).candidate.chainage_m: session.decision(i) for i in session.ordered_ids()}
    assert carried == {20.2: Decision(Verdict.CONFIRMED, LeakClass.VALVE, "here"), 41.0: Decision()}
    assert [orphan.candidate.chainage_m for orphan in session.orphans] == [80.0]
    session.keep_orphans()
    assert session.orphans == ()
    kept = next(row for row in session.rows() if row.manual)
    assert kept.decision.verdict is Verdict.REJECTED


def test_opening_again_shows_the_decisions_without_a_new_run(session):
    first = session.selected
    decide(session, Verdict.CONFIRMED)
    path, results, run = session.folder.path, make_results(session.folder), session.run
    session.close()
    session.open(SurveyFolder.open(path))
    session.set_results(results)
    assert session.run.id == run.id
    assert session.decision(first).verdict is Verdict.CONFIRMED


def test_closing_forgets_everything(session):
    session.close()
    assert (session.folder, session.results, session.selected, session.rows()) == (None, None, None, [])
    assert not session.undo_stack.canUndo()
