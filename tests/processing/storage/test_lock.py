"""One writer at a time; the dead are found by process id and start time, not by the clock."""

import json
import os
import subprocess
import sys
import threading
from dataclasses import asdict, replace

import pytest

from processing.errors import ErrorCode, LeaklineError
from processing.storage import lock as locks
from processing.storage.processes import own_start, process_start


@pytest.fixture
def dead_pid():
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()
    return process.pid


def write_lock(folder, **changes):
    holder = replace(locks._myself(), **changes)
    (folder / locks.LOCK_NAME).write_text(json.dumps(asdict(holder)), encoding="utf-8")


def test_a_second_locker_is_told_who_holds_it(tmp_path):
    locks.acquire(tmp_path)
    with pytest.raises(LeaklineError) as caught:
        locks.acquire(tmp_path)
    assert caught.value.code is ErrorCode.SURVEY_LOCKED
    assert "@" in caught.value.params["owner"]


def test_a_released_lock_is_free(tmp_path):
    lock = locks.acquire(tmp_path)
    lock.release()
    lock.release()
    assert list(tmp_path.iterdir()) == []
    assert locks.acquire(tmp_path).taken_from is None


def test_the_lock_of_a_dead_process_is_taken_over(tmp_path, dead_pid):
    write_lock(tmp_path, pid=dead_pid, user="ölü")
    assert "ölü" in locks.acquire(tmp_path).taken_from


def test_the_lock_of_an_earlier_life_of_the_same_process_id_is_taken_over(tmp_path):
    write_lock(tmp_path, pid=os.getpid(), process_start="an-earlier-boot:1")
    assert locks.acquire(tmp_path).taken_from is not None


def test_a_lock_from_the_future_of_a_dead_process_is_taken_over_whatever_the_clock_says(tmp_path, dead_pid):
    write_lock(tmp_path, pid=dead_pid, since_utc="2999-01-01 00:00 UTC")
    assert locks.acquire(tmp_path).taken_from is not None


def test_another_computer_is_believed_unless_the_operator_knows_better(tmp_path, dead_pid):
    write_lock(tmp_path, pid=dead_pid, host="the-van-laptop")
    with pytest.raises(LeaklineError):
        locks.acquire(tmp_path)
    assert "the-van-laptop" in locks.acquire(tmp_path, take_over=True).taken_from


def test_a_living_process_of_this_computer_is_never_robbed(tmp_path):
    locks.acquire(tmp_path)
    with pytest.raises(LeaklineError):
        locks.acquire(tmp_path, take_over=True)


@pytest.mark.parametrize("garbage", [b"", b"{", b"\xff\xfe", b"[1]", b'{"pid": "x"}', b"[" * 3000])
def test_a_lock_that_nobody_can_read_is_taken_over(tmp_path, monkeypatch, garbage):
    monkeypatch.setattr(locks, "_PATIENCE_S", 0.05)
    (tmp_path / locks.LOCK_NAME).write_bytes(garbage)
    assert locks.acquire(tmp_path).taken_from == "?"


def test_releasing_leaves_a_lock_that_somebody_else_took(tmp_path):
    lock = locks.acquire(tmp_path)
    write_lock(tmp_path, token="somebody else")
    lock.release()
    assert locks.read_holder(tmp_path / locks.LOCK_NAME).token == "somebody else"


def test_of_many_that_find_a_dead_lock_exactly_one_gets_it(tmp_path, dead_pid):
    write_lock(tmp_path, pid=dead_pid)
    barrier, got, lost = threading.Barrier(8), [], []

    def race():
        barrier.wait()
        try:
            got.append(locks.acquire(tmp_path))
        except LeaklineError as error:
            lost.append(error.code)

    threads = [threading.Thread(target=race) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert len(got) == 1
    assert lost == [ErrorCode.SURVEY_LOCKED] * 7


def test_a_living_process_has_one_start_and_a_dead_one_none(dead_pid):
    assert process_start(os.getpid()) == own_start() != "unknown"
    assert process_start(dead_pid) is None
    assert process_start(0) is None
    assert process_start(-1) is None


def test_a_process_that_nobody_waited_for_counts_as_dead():
    process = subprocess.Popen([sys.executable, "-c", "pass"], stdout=subprocess.PIPE)
    process.stdout.read()
    process.stdout.close()
    for _ in range(500):
        if process_start(process.pid) is None:
            break
        threading.Event().wait(0.01)
    assert process_start(process.pid) is None
    process.wait()
