"""Results of single runs in a file of lines, so that an interrupted benchmark goes on where it stopped."""

import json
import multiprocessing
from pathlib import Path


class Kept:
    """Results by key in memory, and in ``path`` where one is given: one JSON line each, read again at the start."""

    def __init__(self, path=None):
        self.path, self.rows = path, {}
        if path is not None and path.exists():
            for line in path.read_text(encoding="utf-8").splitlines():
                try:
                    key, value = json.loads(line)
                except ValueError:  # the line at which it was interrupted
                    continue
                self.rows[_frozen(key)] = value

    def add(self, key, value):
        """Keep a result."""
        self.rows[_frozen(key)] = value
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as file:
                file.write(json.dumps([key, value]) + "\n")


def _frozen(key):
    return tuple(key) if isinstance(key, list) else key


def run_all(tasks, work, kept, jobs, said):
    """Do ``work(task)`` for each task whose key is not kept, one line each; an interrupt ends it without losing any.

    A task is a tuple of plain values, which is its key; ``said(result)`` is what its line says.
    """
    todo = [task for task in tasks if task not in kept.rows]
    if len(todo) < len(tasks):
        print(f"{len(tasks) - len(todo)} of {len(tasks)} runs are kept from before")
    pool = multiprocessing.get_context("spawn").Pool(jobs) if jobs > 1 else None
    try:
        done = pool.imap_unordered(_Paired(work), todo) if pool is not None else map(_Paired(work), todo)
        for number, (task, result) in enumerate(done, 1):
            kept.add(task, result)
            print(f"[{number}/{len(todo)}] {' '.join(str(t) for t in task)}: {said(result)}", flush=True)
    except KeyboardInterrupt:
        print("interrupted: the table holds what was done")
    finally:
        if pool is not None:
            pool.terminate()


class _Paired:
    """A function that returns its task too; a class, so that other processes can load it."""

    def __init__(self, work):
        self.work = work

    def __call__(self, task):
        return task, self.work(task)


def common_words(words):
    """Add the options that all benchmarks of this kind share."""
    words.add_argument("--seeds", type=int, default=20)
    words.add_argument("--first", type=int, default=0, help="the first seed")
    words.add_argument("--jobs", type=int, default=1, help="processes side by side")
    words.add_argument("--keep", type=Path, help="file of results, to go on with later")
