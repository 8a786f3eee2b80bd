"""What was told as stored is there after a kill, and a disc that is really full loses nothing."""

import subprocess
import sys

import pytest
from killed_review import kill_often


def test_no_decision_is_lost_when_the_program_is_killed_at_random_moments(tmp_path):
    told = kill_often(tmp_path, 12)
    assert sum(told) > 12  # it was killed in the middle of work


FULL_DISC = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[2])
from killed_review import candidates
from processing.errors import ErrorCode, LeaklineError
from processing.storage.cache import Cache, cached
from processing.storage.cache_facts import load_arrays, save_arrays
from processing.storage.creating import create_folder
from processing.storage.database import damage
from processing.storage.folder import SurveyFolder
from processing.survey import Decision, Run, Survey, Verdict
import numpy as np

disc = Path(sys.argv[1])

def refused(call):
    try:
        call()
    except LeaklineError as error:
        assert error.code is ErrorCode.DISC_FULL, error
        return
    raise AssertionError("the disc was not full")

def fill():
    try:
        with (disc / "filler").open("ab", buffering=0) as file:
            while file.write(bytes(4096)):
                pass
    except OSError:
        pass

# copying more than there is, the check of free space being fooled
import processing.storage.creating as creating
large = Path(sys.argv[3])
creating.shutil.disk_usage = lambda _: type("usage", (), {"free": 1 << 40})
refused(lambda: create_folder(disc, Survey(), [large]))
assert list(disc.iterdir()) == []

folder = SurveyFolder.create(disc, Survey(), [])
stored = folder.review.add_run(Run(0, "", "h"), candidates(40))
fill()
done = {}
def decide_until_full():
    for _ in range(10000):
        for candidate in stored.candidates:
            decision = Decision(Verdict.CONFIRMED, note="x" * 500 + str(len(done)))
            folder.review.decide(candidate.id, decision, "A")
            done[candidate.id] = decision
refused(decide_until_full)
assert folder.review.decisions(stored.run) == done
assert damage(folder._db) is None

# the result of a step is there though it cannot be cached, and nothing half-made stays
big = np.arange(300_000.0)
result = cached(folder.cache(), "track", "k", lambda: {"a": big}, save_arrays, load_arrays)
assert result["a"] is big
assert folder.cache().get("track", "k") is None
refused(lambda: folder.cache().put("track", "k", lambda place: save_arrays(place, {"a": big})))
assert list((folder.path / "cache").iterdir()) == []
folder.close()

with SurveyFolder.open(folder.path) as reader:
    codes = [finding.code for finding in reader.findings]
    assert codes in (["survey_disc_full"], ["survey_backup_failed"]), codes
    assert reader.review.decisions(stored.run) == done
(disc / "filler").unlink()
with SurveyFolder.open(folder.path) as again:
    assert not again.read_only
    again.review.decide(stored.candidates[0].id, Decision(Verdict.REJECTED), "A")
    assert again.review.decisions(stored.run) == done | {stored.candidates[0].id: Decision(Verdict.REJECTED)}
print("nothing lost")
"""


@pytest.mark.skipif(sys.platform != "linux", reason="makes a small disc of its own as only Linux can")
def test_a_disc_that_is_really_full_loses_nothing(tmp_path, request):
    disc, large = tmp_path / "disc", tmp_path / "large.wav"
    disc.mkdir()
    large.write_bytes(bytes(4_000_000))
    mount = ["unshare", "-rm", "sh", "-c", 'mount -t tmpfs -o size=2m none "$0" && exec "$@"', str(disc)]
    if subprocess.run([*mount, "true"], capture_output=True, timeout=60, check=False).returncode != 0:
        pytest.skip("this system lets nobody but root mount a disc")
    command = [
        *mount,
        sys.executable,
        "-c",
        FULL_DISC,
        str(disc),
        str(request.config.rootpath / "tests" / "helpers"),
        str(large),
    ]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "nothing lost"
