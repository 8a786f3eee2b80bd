"""Terminals, locales, names and signals that `leakline` meets: real processes, as the technician starts them."""

import os
import signal
import subprocess
import sys
import time

import pytest
from deadline import ended_after

LEAKLINE = [sys.executable, "-m", "app"]
posix_only = pytest.mark.skipif(os.name == "nt", reason="closes and limits POSIX streams")


def run_leakline(*words, **more):
    return subprocess.run([*LEAKLINE, *map(str, words)], capture_output=True, check=False, timeout=60, **more)


def test_turkish_in_an_ascii_terminal_is_no_reason_to_fail(device_folder, tmp_path):
    plain = {**os.environ, "PYTHONIOENCODING": "ascii"}
    done = run_leakline("process", device_folder, "--out", tmp_path, "--language", "tr", env=plain)
    assert (done.returncode, done.stderr) == (0, b"")


@posix_only
def test_all_three_streams_may_be_closed(device_folder, tmp_path):
    line = '"$0" -m app process "$1" --out "$2" <&- >&- 2>&-'
    done = subprocess.run(["sh", "-c", line, sys.executable, device_folder, tmp_path / "out"], check=False, timeout=60)
    assert done.returncode == 0
    assert (tmp_path / "out" / "report.pdf").exists()


@posix_only
def test_a_name_that_is_no_utf_8_is_processed(device_folder, tmp_path):
    try:
        folder = tmp_path / os.fsdecode(b"main\xff street")
        folder.mkdir()
    except OSError:
        pytest.skip("this file system wants UTF-8")
    for name in ("imu.csv", "audio.wav"):
        (folder / name).write_bytes((device_folder / name).read_bytes())
    done = run_leakline("process", folder, "--out", tmp_path / "out")
    assert (done.returncode, done.stderr) == (0, b"")


@posix_only
@pytest.mark.parametrize("sign", [signal.SIGINT, signal.SIGTERM], ids=lambda s: s.name)
def test_stopping_leaves_nothing_behind(device_folder, tmp_path, sign):
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    words = [*LEAKLINE, "process", str(device_folder), "--out", str(tmp_path / "out")]
    own = {**os.environ, "TMPDIR": str(scratch)}
    running = subprocess.Popen(words, env=own, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    with ended_after(running, 120.0):
        for _ in range(3000):
            if any(scratch.glob("leakline-*")) or running.poll() is not None:
                break
            time.sleep(0.01)
        running.send_signal(sign)
        said = running.communicate(timeout=60)[1]
    assert (running.returncode, said) == (130, b"")
    assert list(scratch.iterdir()) == []


@pytest.mark.parametrize("words", [("--debug", "process"), ("process", "--debug")])
def test_debug_counts_before_and_after_the_command(tmp_path, words):
    done = run_leakline(*words, tmp_path / "nowhere", "--out", tmp_path)
    assert done.returncode == 2
    assert b"Traceback" in done.stderr


@pytest.mark.parametrize(
    "words",
    [
        ("process", "", "--out", "out"),
        ("process", ".", "--out", ""),
        ("simulate", "rolling", "--out", "out", "--seed", "-1"),
        ("simulate", "random-" + "9" * 5000, "--out", "out"),
        pytest.param(("simulate", "/dev/zero", "--out", "out"), marks=posix_only),
    ],
    ids=["no path", "no out", "negative seed", "huge number", "endless file"],
)
def test_words_that_make_no_sense_are_refused_in_one_line(tmp_path, words):
    done = run_leakline(*words, cwd=tmp_path, env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
