"""Decisions are logged, carried, listed, and always what the log says."""

import sqlite3
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

from processing.errors import ErrorCode, LeaklineError
from processing.storage import database as db_file
from processing.storage.review import Reason, ReviewStore, replay
from processing.survey import Candidate, Decision, LeakClass, Run, Verdict

YES, NO = Decision(Verdict.CONFIRMED), Decision(Verdict.REJECTED, note="vana gürültüsü")


def test_stored_candidates_have_ids_of_their_own_and_are_otherwise_the_same(folder, candidate):
    given_ = [candidate(100, id=7), candidate(50, id=7, evidence={"basis": "şüpheli", "count": 3})]
    stored = folder.review.add_run(Run(0, "2026-05-04T10:00:00+00:00", "h", {"leakline": "0.1.0"}), given_)
    assert stored.is_new
    assert stored.run == Run(stored.run.id, "2026-05-04T10:00:00+00:00", "h", {"leakline": "0.1.0"})
    assert len({c.id for c in stored.candidates}) == 2
    assert [c.time_s for c in stored.candidates] == [100, 50]
    assert stored.candidates[1].evidence == {"basis": "şüpheli", "count": 3}
    assert folder.review.candidates(stored.run) == stored.candidates
    assert folder.review.latest_run() == stored.run
    assert folder.review.runs() == (stored.run,)


def test_a_candidate_without_a_place_is_stored_as_such(folder, candidate):
    nowhere = candidate(5, chainage_m=float("nan"), position_w_m=(float("nan"),) * 3)
    (stored,) = folder.review.add_run(Run(0, "", "h"), [nowhere]).candidates
    assert stored.chainage_m != stored.chainage_m
    assert stored.time_s == 5


def test_a_decision_is_there_with_its_log_row(folder, stored):
    first = stored.candidates[0].id
    decision = Decision(Verdict.CONFIRMED, LeakClass.VALVE, "İğne ucu kadar, ölçüldü")
    log_id = folder.review.decide(first, decision, "Ayşe")
    assert folder.review.decisions(stored.run) == {first: decision}
    assert folder.review.decision(first) == decision
    (entry,) = folder.review.decision_log()
    assert (entry.id, entry.operator, entry.reason) == (log_id, "Ayşe", Reason.DECIDE)
    assert (entry.candidate_id, entry.before, entry.after) == (first, Decision(), decision)


def test_clearing_a_decision_leaves_only_the_log(folder, stored):
    first = stored.candidates[0].id
    folder.review.decide(first, YES, "A")
    folder.review.decide(first, Decision(), "A", "undo")
    assert folder.review.decisions(stored.run) == {}
    assert [(e.before, e.after) for e in folder.review.decision_log()] == [(Decision(), YES), (YES, Decision())]


def test_an_unknown_candidate_or_reason_is_our_bug_and_writes_nothing(folder, stored):
    with pytest.raises(KeyError):
        folder.review.decide(999, YES, "A")
    with pytest.raises(ValueError, match="whim"):
        folder.review.decide(stored.candidates[0].id, YES, "A", "whim")
    assert folder.review.decision_log() == ()


@pytest.mark.parametrize("table", ["decision_log", "survey_log", "candidates", "runs", "carried", "recording_files"])
def test_what_is_precious_can_be_neither_changed_nor_deleted_nor_replaced(folder, stored, candidate, table):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    folder.review.add_run(Run(0, "", "hash-2"), [candidate(100)])
    rows = folder._db.rows(f"SELECT * FROM {table}")
    assert rows
    column = folder._db.connection.execute(f"SELECT * FROM {table}").description[0][0]
    marks = ", ".join("?" * len(rows[0]))
    for sql, values in (
        (f"DELETE FROM {table}", ()),
        (f"UPDATE {table} SET {column} = {column}", ()),
        (f"INSERT OR REPLACE INTO {table} VALUES ({marks})", rows[0]),
    ):
        with pytest.raises(sqlite3.IntegrityError, match="append-only"), folder._db.transaction() as db:
            db.execute(sql, values)
    assert folder._db.rows(f"SELECT * FROM {table}") == rows


def test_a_new_run_carries_decisions_and_lists_those_without_a_partner(folder, stored, candidate):
    found_again, lost = stored.candidates[0], stored.candidates[2]
    folder.review.decide(found_again.id, YES, "A")
    folder.review.decide(lost.id, NO, "A")
    second = folder.review.add_run(Run(0, "", "hash-2"), [candidate(100.4), candidate(150)], "A")
    assert folder.review.decisions(second.run) == {second.candidates[0].id: YES}
    assert second.carried == folder.review.carried(second.run) == {second.candidates[0].id: found_again.id}
    (orphan,) = folder.review.orphaned_decisions()
    assert (orphan.candidate, orphan.run_id, orphan.decision) == (lost, stored.run.id, NO)
    assert folder.review.decision_log()[-1].reason is Reason.CARRY
    # the earlier run is untouched
    assert folder.review.decisions(stored.run) == {found_again.id: YES, lost.id: NO}


def test_an_orphan_finds_its_candidate_again_in_a_later_run(folder, stored, candidate):
    folder.review.decide(stored.candidates[2].id, NO, "A")
    folder.review.add_run(Run(0, "", "hash-2"), [candidate(10)])
    third = folder.review.add_run(Run(0, "", "hash-3"), [candidate(300)])
    assert folder.review.decisions(third.run) == {third.candidates[0].id: NO}
    assert folder.review.orphaned_decisions() == ()


def test_a_decision_that_was_changed_after_carrying_is_the_one_that_is_carried_on(folder, stored, candidate):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    second = folder.review.add_run(Run(0, "", "hash-2"), [candidate(100)])
    folder.review.decide(second.candidates[0].id, NO, "A")
    third = folder.review.add_run(Run(0, "", "hash-3"), [candidate(100)])
    assert folder.review.decisions(third.run) == {third.candidates[0].id: NO}


def test_an_orphan_can_be_cleared_or_kept_as_the_operators_own_mark(folder, stored, candidate):
    cleared, kept = stored.candidates[1], stored.candidates[2]
    folder.review.decide(cleared.id, YES, "A")
    folder.review.decide(kept.id, YES, "A")
    second = folder.review.add_run(Run(0, "", "hash-2"), [candidate(10)])
    folder.review.decide(cleared.id, Decision(), "A")
    mark = folder.review.keep_orphan(kept.id, "A")
    assert folder.review.orphaned_decisions() == ()
    assert folder.review.candidates(second.run)[-1] == mark
    assert folder.review.manual_ids(second.run) == {mark.id}
    assert folder.review.decisions(second.run) == {mark.id: YES}
    folder.review.withdraw_manual_candidate(mark.id, "A")  # undo
    assert [o.candidate for o in folder.review.orphaned_decisions()] == [kept]


def test_the_same_run_again_is_not_stored_twice(folder, stored, candidate):
    again = folder.review.add_run(Run(0, "", "hash-1"), [candidate(100 * i) for i in range(1, 5)])
    assert not again.is_new
    assert again.run == stored.run
    assert again.candidates == stored.candidates
    other = folder.review.add_run(Run(0, "", "hash-1"), [candidate(100)])
    assert other.is_new


def test_a_mark_of_the_operator_is_stored_taken_back_and_put_there_again(folder, stored, candidate):
    mark = folder.review.add_manual_candidate(stored.run, candidate(250), "A", YES)
    assert folder.review.candidates(stored.run) == (*stored.candidates, mark)
    assert folder.review.decisions(stored.run) == {mark.id: YES}
    folder.review.withdraw_manual_candidate(mark.id, "A")
    assert folder.review.candidates(stored.run) == stored.candidates
    assert folder.review.decisions(stored.run) == {}
    folder.review.reinstate_manual_candidate(mark.id, "A")
    assert folder.review.decisions(stored.run) == {mark.id: YES}
    reasons = [entry.reason for entry in folder.review.decision_log()]
    assert reasons == [Reason.ADD, Reason.DECIDE, Reason.WITHDRAW, Reason.REINSTATE]
    with pytest.raises(KeyError):
        folder.review.withdraw_manual_candidate(stored.candidates[0].id, "A")  # the machine's are not the operator's


def test_marks_come_along_to_a_new_run_to_where_the_new_track_puts_them(folder, stored, candidate):
    far = folder.review.add_manual_candidate(stored.run, candidate(250), "A", YES)
    undecided = folder.review.add_manual_candidate(stored.run, candidate(280), "A")
    found = folder.review.add_manual_candidate(stored.run, candidate(320), "A", NO)
    gone = folder.review.add_manual_candidate(stored.run, candidate(350), "A", YES)
    folder.review.withdraw_manual_candidate(gone.id, "A")

    def relocate(mark):
        return candidate(mark.time_s, chainage_m=mark.time_s + 17)

    second = folder.review.add_run(Run(0, "", "hash-2"), [candidate(320)], "A", relocate)
    machine, *marks = second.candidates
    assert [(c.time_s, c.chainage_m) for c in marks] == [(250, 267), (280, 297)]
    assert folder.review.decisions(second.run) == {machine.id: NO, marks[0].id: YES}
    assert second.carried == {machine.id: found.id, marks[0].id: far.id, marks[1].id: undecided.id}
    assert folder.review.orphaned_decisions() == ()


def test_a_clock_that_goes_backwards_changes_no_order(folder, stored, candidate, monkeypatch):
    stamps = iter(["2026-05-04T12:00:00", "2026-05-04T11:00:00", "2020-01-01T00:00:00", "2019-01-01T00:00:00"])
    monkeypatch.setattr("processing.storage.review_rows.now", lambda: next(stamps))
    first = stored.candidates[0].id
    for decision in (YES, NO, YES):
        folder.review.decide(first, decision, "A")
    assert [e.after for e in folder.review.decision_log()] == [YES, NO, YES]
    assert replay(folder.review.decision_log()) == folder.review.decisions(stored.run)
    second = folder.review.add_run(Run(0, "2018-01-01", "hash-2"), [candidate(900)])
    assert folder.review.latest_run() == second.run


def test_what_the_database_holds_instead_of_a_decision_is_told_as_damage(folder, stored):
    folder.review.decide(stored.candidates[0].id, YES, "A")
    with folder._db.transaction() as db:
        db.execute('UPDATE decisions SET value = \'{"verdict": "perhaps"}\'')
    with pytest.raises(LeaklineError) as caught:
        folder.review.decisions(stored.run)
    assert caught.value.code is ErrorCode.SURVEY_DAMAGED


def make_candidates(seconds):
    place = (0.0, 0.0, 0.0)
    return [
        Candidate(0, float(t), float(t), t - 1.0, t + 1.0, place, 0.5, 6.0, LeakClass.LEAK, (100.0, 200.0), 2.0)
        for t in seconds
    ]


class Reviewing(RuleBasedStateMachine):
    """An operator who decides, undoes, redoes, marks and re-runs at random, beside a model of two dictionaries."""

    decisions_ = st.builds(
        Decision, st.sampled_from(Verdict), st.none() | st.sampled_from(LeakClass), st.text(max_size=5)
    )

    def __init__(self):
        super().__init__()
        self.folder = tempfile.TemporaryDirectory()
        path = Path(self.folder.name) / "survey.db"
        db_file.create(path)
        self.db = db_file.open_writable(path)
        self.db.connection.execute("PRAGMA synchronous = OFF")  # here it is about what, not about when
        self.store = ReviewStore(self.db)
        self.done, self.undone, self.expected = [], [], {}

    @initialize()
    def first_run(self):
        self.run = self.store.add_run(Run(0, "", "0"), make_candidates(range(0, 60, 10))).run

    def apply(self, candidate_id, decision, reason):
        self.store.decide(candidate_id, decision, "hypothesis", reason)
        self.expected[candidate_id] = decision

    @rule(data=st.data(), decision=decisions_)
    def decide(self, data, decision):
        candidate_id = data.draw(st.sampled_from([c.id for c in self.store.candidates(self.run)]))
        before = self.store.decision(candidate_id)
        self.apply(candidate_id, decision, "decide")
        self.done.append((candidate_id, before, decision))
        self.undone.clear()

    @precondition(lambda self: self.done)
    @rule()
    def undo(self):
        candidate_id, before, after = self.done.pop()
        self.apply(candidate_id, before, "undo")
        self.undone.append((candidate_id, before, after))

    @precondition(lambda self: self.undone)
    @rule()
    def redo(self):
        candidate_id, before, after = self.undone.pop()
        self.apply(candidate_id, after, "redo")
        self.done.append((candidate_id, before, after))

    @rule(second=st.integers(0, 60))
    def mark(self, second):
        self.store.add_manual_candidate(self.run, make_candidates([second])[0], "hypothesis")

    @rule(seconds=st.lists(st.integers(0, 60), min_size=1, max_size=5, unique=True))
    def run_again(self, seconds):
        before = {o.candidate.id for o in self.store._open_decisions(with_marks=True)}
        stored = self.store.add_run(Run(0, "", f"{len(self.store.runs())}"), make_candidates(seconds))
        for new_id, old_id in stored.carried.items():
            if self.expected.get(old_id, Decision()) != Decision():
                self.expected[new_id] = self.expected[old_id]
        orphans = {o.candidate.id for o in self.store.orphaned_decisions()}
        assert before == orphans | set(stored.carried.values())  # nothing is dropped
        self.run = stored.run
        self.done.clear()
        self.undone.clear()

    @invariant()
    def decisions_are_what_the_log_says_and_what_was_done(self):
        now = {}
        for run in self.store.runs():
            now |= self.store.decisions(run)
        assert now == replay(self.store.decision_log())
        assert now == {key: decision for key, decision in self.expected.items() if decision != Decision()}

    def teardown(self):
        assert db_file.damage(self.db) is None
        self.db.close()
        self.folder.cleanup()


TestReviewing = Reviewing.TestCase
TestReviewing.settings = settings(max_examples=40, stateful_step_count=20, deadline=None)


def test_a_leak_keeps_its_number_from_run_to_run_and_no_number_is_given_twice(folder, candidate):
    review = folder.review
    first = review.add_run(Run(0, "", "a"), [candidate(100, 50), candidate(200, 100), candidate(300, 150)])
    assert [c.label for c in first.candidates] == [1, 2, 3]
    # found again in another order, the second one lost, one more found
    second = review.add_run(Run(0, "", "b"), [candidate(300.2, 150), candidate(400, 200), candidate(100.1, 50)])
    assert {round(c.time_s): c.label for c in second.candidates} == {300: 3, 400: 4, 100: 1}
    mark = review.add_manual_candidate(second.run, candidate(350, 175), "me")
    assert mark.label == 5
    third = review.add_run(Run(0, "", "c"), [candidate(200, 100), candidate(100, 50)])
    assert {round(c.time_s): c.label for c in third.candidates} == {200: 6, 100: 1, 350: 5}
    assert len({c.id for run in (first, second, third) for c in run.candidates}) == 9


def test_the_same_run_again_is_recognised_whatever_its_leaks_are_called(folder, candidate):
    found = [candidate(100, 50), candidate(200, 100)]
    stored = folder.review.add_run(Run(0, "", "a"), found)
    again = folder.review.add_run(Run(0, "", "a"), found)
    assert not again.is_new
    assert again.candidates == stored.candidates


def test_a_rejection_never_goes_to_an_undecided_neighbour_that_is_plainly_found_again(folder, candidate):
    first = folder.review.add_run(Run(0, "", "hash-1"), [candidate(100), candidate(102.5)])
    leak, noise = first.candidates
    folder.review.decide(noise.id, Decision(Verdict.REJECTED), "Ayşe")
    second = folder.review.add_run(Run(0, "", "hash-2"), [candidate(100.1)])  # the noise is not found any more
    assert [c.label for c in second.candidates] == [leak.label]
    assert folder.review.decisions(second.run) == {}
    assert [orphan.candidate.id for orphan in folder.review.orphaned_decisions()] == [noise.id]


def test_what_a_run_lost_and_a_later_one_found_again_has_its_number_and_decision_back(folder, candidate):
    first = folder.review.add_run(Run(0, "", "hash-1"), [candidate(100), candidate(200)])
    folder.review.decide(first.candidates[1].id, Decision(Verdict.CONFIRMED), "Ayşe")
    folder.review.add_run(Run(0, "", "hash-2"), [candidate(100), candidate(300)])
    third = folder.review.add_run(Run(0, "", "hash-3"), [candidate(200.2), candidate(100), candidate(300)])
    assert [c.label for c in third.candidates] == [2, 1, 3]
    assert folder.review.decisions(third.run) == {third.candidates[0].id: Decision(Verdict.CONFIRMED)}


def test_a_mark_that_a_new_path_moves_keeps_its_number_by_which_its_photos_are_kept(folder, candidate):
    first = folder.review.add_run(Run(0, "", "hash-1"), [candidate(100), candidate(200)])
    mark = folder.review.add_manual_candidate(first.run, candidate(300), "Ayşe", Decision(Verdict.CONFIRMED))
    mark = folder.review.move_manual_candidate(mark.id, candidate(310), "Ayşe")
    last = [(entry.reason, entry.candidate_id == mark.id) for entry in folder.review.decision_log()[-3:]]
    assert last == [(Reason.WITHDRAW, False), (Reason.ADD, True), (Reason.CARRY, True)]  # told by number: it is there
    second = folder.review.add_run(
        Run(0, "", "hash-2"), [candidate(100), candidate(200)], relocate=lambda old: candidate(old.time_s, 330.0)
    )
    (again,) = (c for c in second.candidates if c.id in folder.review.manual_ids(second.run))
    assert (again.label, again.chainage_m) == (mark.label, 330.0)
    assert folder.review.decision(again.id) == Decision(Verdict.CONFIRMED)
