"""Kill a reviewing process at random moments and look what is left: no decision told as stored may be lost.

``tests/benchmarks/kill_review.py`` kills fifty, the tests a dozen.
The reviewer is this file run itself: it decides, undoes, marks and re-runs as fast as it can, and tells each
log id after the call returned, and each second opinion likewise. The parent kills it (SIGKILL, TerminateProcess on
Windows) and reads what it told.
"""

import json
import random
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

from deadline import ended_after

from processing.storage.database import damage
from processing.storage.folder import SurveyFolder
from processing.storage.plain import from_plain, to_plain
from processing.storage.review import UNDECIDED, replay
from processing.survey import Candidate, Decision, LeakClass, Run, Survey, SurveyInfo, Verdict

PLACE = (0.0, 0.0, 0.0)


def candidates(count: int, shift_s: float = 0.0) -> list[Candidate]:
    """Candidates 20 s and 20 m apart."""
    first = Candidate(0, 0.0, 0.0, -1.0, 1.0, PLACE, 0.5, 6.0, LeakClass.LEAK, (500.0, 4000.0), 2.0)
    return [replace(first, time_s=20.0 * i + shift_s, chainage_m=20.0 * i) for i in range(count)]


def review(path: Path, seed: int) -> None:
    """Review for ever, telling each stored decision on standard output."""
    chance = random.Random(seed)
    with SurveyFolder.open(path) as folder:
        store = folder.review
        run = store.latest_run() or store.add_run(Run(0, "", "first"), candidates(40)).run
        ids = [c.id for c in store.candidates(run)]
        print(json.dumps("ready"), flush=True)
        while True:
            candidate_id = chance.choice(ids)
            decision = Decision(
                chance.choice(list(Verdict)), chance.choice([None, *LeakClass]), "ğ" * chance.choice([0, 5, 9000])
            )
            reason = chance.choice(["decide", "undo", "redo"])
            log_id = store.decide(candidate_id, decision, "Ayşe", reason)
            print(json.dumps([log_id, candidate_id, to_plain(decision)]), flush=True)
            if chance.random() < 0.3:
                number, reviewer = chance.randrange(1, 40), chance.choice(["Bülent", "Cem"])
                given = folder.opinions.give(number, reviewer, decision)
                print(json.dumps(["opinion", number, reviewer, to_plain(given.decision)]), flush=True)
            if chance.random() < 0.02:
                stored = store.add_run(Run(0, "", str(chance.random())), candidates(40, chance.random()))
                ids = [c.id for c in stored.candidates]


def kill_once(path: Path, seed: int) -> int:
    """Start a reviewer, kill it at a random moment, check what is left; return how many decisions it had told."""
    command = [sys.executable, __file__, str(path), str(seed)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, encoding="utf-8")
    assert process.stdout is not None
    with ended_after(process, 60.0):
        ready = process.stdout.readline()
        time.sleep(random.Random(seed).uniform(0.0, 0.25))
        process.kill()
        told = process.stdout.read().splitlines(keepends=True)
        process.stdout.close()
    assert ready == '"ready"\n', "the reviewer did not start"
    complete = [json.loads(line) for line in told if line.endswith("\n")]
    with SurveyFolder.open(path) as folder:
        assert [finding.code for finding in folder.findings] == ["survey_lock_taken_over"]
        assert damage(folder._db) is None
        log = folder.review.decision_log()
        by_id = {entry.id: entry for entry in log}
        opinions = [line[1:] for line in complete if line[0] == "opinion"]
        words = [[o.number, o.reviewer, to_plain(o.decision)] for o in folder.opinions.log()]
        # each told one is there, in the order in which they were told; at most one more was written and not yet told
        before = len(words) - len(opinions)
        assert any(words[start : start + len(opinions)] == opinions for start in range(max(before - 1, 0), before + 1))
        newest = {(number, reviewer): decision for number, reviewer, decision in words}
        standing = {(o.number, o.reviewer): to_plain(o.decision) for o in folder.opinions.opinions()}
        assert standing == {key: value for key, value in newest.items() if value != to_plain(UNDECIDED)}
        for log_id, candidate_id, decision in (line for line in complete if line[0] != "opinion"):
            assert by_id[log_id].candidate_id == candidate_id
            assert by_id[log_id].after == from_plain(Decision, decision)
        stored: dict[int, Decision] = {}
        for run in folder.review.runs():
            stored |= folder.review.decisions(run)
        assert stored == replay(log)
        assert UNDECIDED not in stored.values()
    return len(complete)


def kill_often(folder: Path, kills: int) -> list[int]:
    """Return how many decisions each of ``kills`` reviewers had told before it was killed; raises if any was lost."""
    with SurveyFolder.create(folder, Survey(SurveyInfo("Öldürülen ölçüm")), []) as made:
        path = made.path
    return [kill_once(path, seed) for seed in range(kills)]


if __name__ == "__main__":
    review(Path(sys.argv[1]), int(sys.argv[2]))
