"""The window is killed while somebody reviews: every verdict that was shown is on disk, and the database is sound."""

import os
import random
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from deadline import ended_after
from small_survey import make_folder

from processing.storage.folder import SurveyFolder
from processing.storage.review import replay

HELPERS = Path(__file__).resolve().parent.parent / "helpers"
KILLS = int(os.environ.get("LEAKLINE_KILLS", "4"))


@pytest.mark.slow
@pytest.mark.skipif(
    sys.platform == "win32", reason="Windows has no SIGKILL; its TerminateProcess is the same to the disc"
)
def test_no_verdict_that_was_shown_is_lost_when_the_window_is_killed(tmp_path):
    folder = make_folder(tmp_path)
    path = folder.path
    folder.close()
    choose, shown = random.Random(7), {}
    for round_number in range(KILLS):
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(HELPERS), str(HELPERS.parent.parent)))}
        child = subprocess.Popen(
            [sys.executable, str(HELPERS / "killed_window.py"), str(path), str(round_number)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            env=environment,
        )
        with ended_after(child, 90.0):
            first = child.stdout.readline()
            assert first, "the window never showed a verdict"
            time.sleep(choose.uniform(0.0, 0.6))
            child.send_signal(signal.SIGKILL)
            lines = [first, *child.stdout.read().splitlines(keepends=True)]
            child.stdout.close()
        told = [line.split(maxsplit=2) for line in lines if line.endswith("\n")]
        shown |= {int(number): (verdict, note.strip()) for number, verdict, note in told}
        with sqlite3.connect(path / "survey.db") as database:
            assert database.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        database.close()
        with SurveyFolder.open(path) as reopened:
            review = reopened.review
            stored = replay(review.decision_log())
            last = next(reversed(review.decision_log()))
            for candidate_id, (verdict, note) in shown.items():
                if candidate_id == last.candidate_id:
                    continue  # written perhaps, but killed before it could be shown
                decision = stored.get(candidate_id, review.decision(candidate_id))
                assert (decision.verdict.value, decision.note or "-") == (verdict, note)
            shown = {k: (d.verdict.value, d.note or "-") for k, d in stored.items()}
    assert shown
