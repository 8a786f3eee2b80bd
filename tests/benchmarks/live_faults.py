"""Record a simulated device through each fault and report what was told, what was marked, and whether all is right.

    python tests/benchmarks/live_faults.py [--only NAME,...] [--seconds N] [--rate HZ] [--audio-rate HZ] [--keep DIR]

Both commands are the real ones in processes of their own: `leakline simulate-device` with its own sound server, and
`leakline record` through PortAudio and a pseudo-terminal, a TCP connection or datagrams. What was recorded is compared
with the device's truth file: samples by their values, sound bit by bit.
"""

import argparse
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import soundfile
from scipy.spatial import cKDTree

from processing.importing.folder import import_folder
from processing.importing.frames import FrameDecoder, Frames

DEADLINE_S = 90.0
RESYNC = 256  # frames that must agree where the sound goes on
RATE_HZ = 400.0
# tolerance of a match, in SI: what the wire's digits leave of a sample
TOLERANCE = {"frames": 1e-6, "csv": 1e-6, "ximu3-binary": 1e-4, "ximu3": 2e-3, "printed": 2e-3}


@dataclass(frozen=True)
class Case:
    """One recording: what goes wrong at 5 s, over which wire, in which protocol."""

    name: str
    faults: str = ""
    imu: str = "pty"
    protocol: str = "frames"


CASES = (
    Case("none"),
    Case("garbage", "garbage@5+2"),
    Case("stall", "stall@5+3"),
    Case("unplug-pty", "unplug@5+3"),
    Case("unplug-tcp", "unplug@5+3", "tcp"),
    Case("unplug-udp", "unplug@5+3", "udp"),
    Case("burst", "burst@5+0.5"),
    Case("repeat", "repeat@5+0.2"),
    Case("lost", "lost@5+0.1"),
    Case("restart", "restart@5+1"),
    Case("absurd-time", "absurd-time@5"),
    Case("audio-unplug", "audio-unplug@5+3"),
    Case("both-unplug", "unplug@5+2,audio-unplug@6+2"),
    Case("drift", "drift=80,audio-drift=-50"),
    Case("csv", "", "tcp", "csv"),
    Case("csv-garbage", "garbage@5+2", "pty", "csv"),
    Case("ximu3", "", "tcp", "ximu3"),
    Case("ximu3-unplug", "unplug@5+3", "pty", "ximu3-binary"),
    Case("printed", "", "tcp", "printed"),
    Case("printed-unplug", "unplug@5+3", "pty", "printed"),
)


@dataclass
class Outcome:
    """What came of a case."""

    told: list[str] = field(default_factory=list)
    status: int | None = None
    rows: int = 0
    foreign: int = 0  # recorded samples that were never sent
    missing: int = 0  # that were sent for sure between the first and the last recorded one
    twice: int = 0
    time_off_ms: tuple[float, float] = (0.0, 0.0)  # recorded time less when sent: about its median, least and most
    clock_off_ms: tuple[float, float] = (0.0, 0.0)  # recorded time less the device's own
    pause_s: tuple[float, float] = (0.0, 0.0)  # the longest between two arrivals, and between two sendings
    sound_equal: int = 0
    sound_filled: int = 0  # frames of silence written for what was lost
    sound_lost: int = 0  # played frames that are not in the recording, between its first and last
    sound_off_ms: float = 0.0  # after the last gap, how far sound lies from where it belongs
    findings: list[str] = field(default_factory=list)
    marked_s: dict[str, float] = field(default_factory=dict)
    events: dict[str, int] = field(default_factory=dict)


class Process:
    """A command whose lines are read as they come, and that is dead in the end."""

    def __init__(self, words: list[str], environment: dict[str, str] | None = None) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", "app", *words], env={**os.environ, **(environment or {})},
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, text=True, encoding="utf-8",
        )  # fmt: skip
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.lines.append(line.rstrip("\n"))

    def first(self, start: str) -> str:
        """Return the first line that begins so, waiting for it."""
        until = time.monotonic() + DEADLINE_S
        while time.monotonic() < until:
            for line in list(self.lines):
                if line.startswith(start):
                    return line
            if self._process.poll() is not None:
                break
            time.sleep(0.05)
        raise RuntimeError("\n".join(["it said only:", *self.lines]))

    def wait(self, seconds: float) -> int:
        """Return its status."""
        status = self._process.wait(seconds)
        self._reader.join(5.0)
        return status

    def close(self) -> None:
        """End it, kindly first."""
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGTERM)
            try:
                self._process.wait(10.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait(10.0)
        self._reader.join(5.0)


def run(case: Case, folder: Path, seconds: float, rate_hz: float, audio_rate_hz: int) -> Outcome:
    """Record one case and compare."""
    folder.mkdir(parents=True)
    imu = {"pty": f"pty:{folder / 'ball'}", "tcp": "tcp:0", "udp": f"udp:127.0.0.1:{_free_port()}"}[case.imu]
    words = ["simulate-device", "rolling", "--imu", imu, "--protocol", case.protocol, "--rate", str(rate_hz)]
    words += ["--audio-rate", str(audio_rate_hz), "--start-server", "--truth", str(folder / "truth")]
    device = Process([*words, "--faults", case.faults, "--loop"])
    outcome = Outcome()
    try:
        ready = json.loads(device.first("{"))
        recorder = Process(
            ["record", "--imu", ready["imu"], "--audio", ready["audio"], "--out", str(folder / "run.leakline"),
             "--seconds", str(seconds), "--wait", "30"],
            ready["environment"],
        )  # fmt: skip
        try:
            outcome.status = recorder.wait(seconds + DEADLINE_S)
        finally:
            recorder.close()
        outcome.told = [line for line in recorder.lines if line.startswith("- ")] or recorder.lines[-2:]
    finally:
        device.close()
    original = folder / "run.leakline" / "recordings" / "1" / "original"
    compare_motion(original, folder / "truth", TOLERANCE[case.protocol], outcome)
    compare_sound(original, folder / "truth.wav", folder / "truth", outcome)
    imported = import_folder(original)
    outcome.findings = [finding.code for finding in imported.findings]
    for stretch in imported.not_assessed:
        key = f"{stretch.channel}:{stretch.reason}"
        outcome.marked_s[key] = outcome.marked_s.get(key, 0.0) + stretch.end_s - stretch.start_s
    for gap in imported.audio.gaps if imported.audio is not None else ():
        key = f"sound:{gap.reason}"
        outcome.marked_s[key] = outcome.marked_s.get(key, 0.0) + gap.end_s - gap.start_s
    for line in (original / "recording.jsonl").read_text(encoding="utf-8").splitlines():
        event = json.loads(line)["event"]
        outcome.events[event] = outcome.events.get(event, 0) + 1
    return outcome


def compare_motion(original: Path, truth: Path, tolerance: float, outcome: Outcome) -> None:
    """Find each recorded sample among those that were sent, by force and turn rate."""
    got = frames_of(sorted(original.glob("imu-*.lkf")))
    sent = frames_of([truth.with_name("truth.lkf")])
    fates = [json.loads(line) for line in truth.read_text(encoding="utf-8").splitlines()]
    doubtful = sum(row["what"] == "row" and row["fate"] == "spoilt" for row in fates)
    tree = cKDTree(np.hstack([sent.acc_s_mps2, sent.gyr_s_radps]).astype(np.float64))
    away, at = tree.query(np.hstack([got.acc_s_mps2, got.gyr_s_radps]).astype(np.float64))
    known = away <= tolerance
    outcome.rows = len(got)
    outcome.foreign = max(0, int((~known).sum()) - doubtful)  # spoilt ones may arrive, and are not in the file
    at = at[known]
    outcome.twice = len(at) - len(np.unique(at))
    outcome.missing = int(at.max() - at.min()) + 1 - len(np.unique(at)) if len(at) else -1
    time_s = 1e-6 * got.time_us[known].astype(np.float64)
    outcome.time_off_ms = _spread_ms(time_s - sent.host_s[at])
    outcome.pause_s = tuple(float(np.diff(one.host_s).max(initial=0.0)) for one in (got, sent))
    outcome.clock_off_ms = _spread_ms(time_s - 1e-6 * sent.time_us[at].astype(np.float64))
    assert np.all(np.diff(got.time_us.astype(np.int64)) > 0), "time does not rise"


def _spread_ms(off_s: np.ndarray) -> tuple[float, float]:
    if not len(off_s):
        return float("nan"), float("nan")
    off_ms = 1e3 * (off_s - np.median(off_s))
    return float(off_ms.min()), float(off_ms.max())


def compare_sound(original: Path, played: Path, truth: Path, outcome: Outcome) -> None:
    """Walk through the recorded sound beside the played one; what is not the same must be silence."""
    parts = [soundfile.read(str(part), dtype="float32", always_2d=True)[0] for part in sorted(original.glob("audio-*"))]
    got = np.concatenate(parts)[:, 0]
    source, rate = soundfile.read(str(played), dtype="float32", always_2d=True)
    source = source[:, 0]
    at, place, first_off = 0, -1, None
    while at < len(got):
        if place >= 0:
            count = min(len(got) - at, len(source) - place)
            wrong = np.flatnonzero(got[at : at + count] != source[place : place + count])
            equal = int(wrong[0]) if len(wrong) else count
            outcome.sound_equal += equal
            at, place = at + equal, place + equal
            if at >= len(got) or place >= len(source):
                break
        found = _goes_on(got, source, at, max(place, 0))
        if found is None:
            outcome.sound_filled += len(got) - at
            break
        start, where = found
        outcome.sound_filled += start - at
        assert not got[at : start - RESYNC].any() or place < 0, "neither the sound that was played nor silence"
        outcome.sound_lost += where - place if place >= 0 else 0
        first_off = start - where if first_off is None else first_off
        outcome.sound_off_ms = 1e3 * (start - where - first_off) / rate
        at, place = start, where


def _goes_on(got: np.ndarray, source: np.ndarray, at: int, place: int) -> tuple[int, int] | None:
    """Return where, from ``at`` on, recorded sound is found again in the source, and where there."""
    step = RESYNC
    for start in range(at, len(got) - RESYNC, step):
        piece = got[start : start + RESYNC]
        if np.count_nonzero(piece) < RESYNC // 2:
            continue
        for where in np.flatnonzero(source[place : len(source) - RESYNC] == piece[0]) + place:
            if np.array_equal(source[where : where + RESYNC], piece):
                back = 0
                while start - back > at and where - back > place and got[start - back - 1] == source[where - back - 1]:
                    back += 1
                return start - back, int(where) - back
    return None


def frames_of(paths: list[Path]) -> Frames:
    """Return the samples in files of binary frames."""
    decoder = FrameDecoder()
    return decoder.feed(b"".join(path.read_bytes() for path in paths))


def _free_port() -> int:
    import socket

    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def report(case: Case, out: Outcome) -> None:
    """Print a case's figures and sentences."""
    marks = ", ".join(f"{key} {length:.2f} s" for key, length in out.marked_s.items()) or "-"
    print(
        f"{case.name:15} status {out.status}  rows {out.rows:6}  foreign {out.foreign:3}  missing {out.missing:4}  "
        f"twice {out.twice:2}  time {out.time_off_ms[0]:+7.1f} … {out.time_off_ms[1]:+7.1f} ms  "
        f"to its clock {out.clock_off_ms[0]:+.3f} … {out.clock_off_ms[1]:+.3f} ms  "
        f"pause {out.pause_s[0]:.2f} s (sent {out.pause_s[1]:.2f} s)\n    "
        f"sound equal {out.sound_equal:8} filled {out.sound_filled:6} lost {out.sound_lost:6} "
        f"off {out.sound_off_ms:+6.1f} ms"
    )
    print(f"    marked: {marks}")
    print(f"    events: {out.events}")
    print(f"    found at import: {', '.join(out.findings) or '-'}")
    for line in out.told:
        print("    told:   " + re.sub(r"^- ", "", line)[:150])
    sys.stdout.flush()


# what must stand in the recording as not assessed, in seconds at least; faults that cost nothing have none
MARKS = {
    "stall": {"path": 3.0}, "unplug-pty": {"path": 3.0}, "unplug-tcp": {"path": 3.0}, "unplug-udp": {"path": 3.0},
    "lost": {"path": 0.1}, "restart": {"path": 1.0}, "audio-unplug": {"sound": 3.0},
    "both-unplug": {"path": 2.0, "sound": 2.0}, "ximu3-unplug": {"path": 3.0}, "printed-unplug": {"path": 3.0},
}  # fmt: skip
SILENT = {"none", "burst", "drift", "csv", "ximu3", "printed"}  # nothing is to be told of these
IN_TERMINAL = 40  # samples that may lie in a terminal's buffer when it goes
COLUMNS = ("told", "rows equal", "sound bit by bit", "gap marked")


def verdict(case: Case, out: Outcome) -> tuple[bool, bool, bool, bool]:
    """Return what of :data:`COLUMNS` is as it should be."""
    has_told = any(line.startswith("- ") for line in out.told)
    may_miss = IN_TERMINAL if "unplug" in case.faults and case.imu == "pty" else int("absurd" in case.faults)
    rows = out.foreign == 0 and out.twice == 0 and 0 <= out.missing <= may_miss
    sound = "audio-unplug" in case.faults or out.sound_lost == out.sound_filled == 0
    wanted = MARKS.get(case.name, {})
    marked = {
        channel: sum(s for key, s in out.marked_s.items() if key.startswith(channel)) for channel in ("path", "sound")
    }
    most = {channel: wanted.get(channel, 0.0) * 1.5 + 0.02 for channel in marked}
    if "path" in wanted:  # a ball that was pulled out may wait a while before it is there again
        most["path"] = max(most["path"], out.pause_s[1] + 0.1)
    gaps = all(wanted.get(channel, 0.0) - 0.05 <= s <= most[channel] for channel, s in marked.items())
    return has_told != (case.name in SILENT), rows, sound, gaps


def main() -> int:
    """Run the cases and print the table; 1 where anything is not as it should be."""
    words = argparse.ArgumentParser()
    words.add_argument("--only", default="")
    words.add_argument("--seconds", type=float, default=16.0)
    words.add_argument("--rate", type=float, default=RATE_HZ)
    words.add_argument("--audio-rate", type=int, default=48_000)
    words.add_argument("--keep", type=Path)
    told = words.parse_args()
    wanted = set(filter(None, told.only.split(",")))
    table: list[tuple[str, tuple[bool, ...]]] = []
    with tempfile.TemporaryDirectory(prefix="leakline-faults-") as scratch:
        for case in CASES:
            if wanted and case.name not in wanted:
                continue
            try:
                out = run(case, (told.keep or Path(scratch)) / case.name, told.seconds, told.rate, told.audio_rate)
            except (RuntimeError, AssertionError, subprocess.TimeoutExpired, OSError) as error:
                print(f"{case.name:15} FAILED: {error}")
                table.append((case.name, (False,) * len(COLUMNS)))
                continue
            report(case, out)
            table.append((case.name, verdict(case, out)))
    print(f"\n{'':15}" + "".join(f"{name:>18}" for name in COLUMNS))
    for name, marks in table:
        print(f"{name:15}" + "".join(f"{'yes' if mark else 'NO':>18}" for mark in marks))
    return 0 if all(all(marks) for _, marks in table) else 1


if __name__ == "__main__":
    sys.exit(main())
