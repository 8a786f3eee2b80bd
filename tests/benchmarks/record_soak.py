"""Records for as long as told from a real pseudo-terminal and a real sound server, and compares every bit.

``record_soak.py --minutes 30 --imu-rate 400 --audio-rate 48000 --channels 1``

The ball and the sound are made in this process from seeds, ``leakline record`` runs as a process of its own; at the end
what lies on the disc is compared with what was sent: each IMU sample, each frame of sound. Where sound is missing it is
said who lost it: the player (the sound stands still for a while), the recorder (its journal says so, and silence stands
there), or the server (frames are gone, and nobody was told).
"""

import argparse
import json
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path

import numpy as np
import psutil
import soundfile

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers"))

from sound_server import SINK, SoundServer
from wired_ball import WiredBall

from processing.importing.frames import FrameDecoder

BLOCK = 4800  # frames that are made from one seed
LOOK_S = 10.0
FAR_BLOCKS = 400


def made(block, channels):
    """Return a block of frames int16 in which no frame is silent."""
    frames = np.random.default_rng(block).integers(1, 2**15, (BLOCK, channels))
    return (frames * np.where(np.random.default_rng([block, 1]).random((BLOCK, channels)) < 0.5, -1, 1)).astype(
        np.int16
    )


class Player:
    """Streams the made blocks into the server through ``pacat``, which sets the pace."""

    def __init__(self, server):
        self._player = server._begin(
            ["pacat", "--playback", f"--device={SINK}", "--latency-msec=4000", f"--rate={server.rate_hz}",
             f"--channels={server.channels}", "--format=s16le", "--raw"], subprocess.PIPE,
        )  # fmt: skip
        self._channels = server.channels
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        block = 0
        while not self._ending.is_set():
            try:
                self._player.stdin.write(made(block, self._channels).tobytes())
            except (OSError, ValueError):  # the recording is over
                return
            block += 1

    def end(self):
        self._ending.set()
        self._player.kill()
        self._thread.join(5.0)
        with suppress(BrokenPipeError):  # it was killed in the middle of a block
            self._player.stdin.close()


class Use:
    """CPU and memory of a process, looked at now and then."""

    def __init__(self, pid):
        self._process = psutil.Process(pid)
        self._begun_s, self._begun_cpu = time.monotonic(), self._cpu()
        self.memory = [self._process.memory_info().rss]
        self.share = 0.0

    def _cpu(self):
        times = self._process.cpu_times()
        return times.user + times.system

    def look(self):
        self.memory.append(self._process.memory_info().rss)
        self.share = (self._cpu() - self._begun_cpu) / (time.monotonic() - self._begun_s)


class Walk:
    """Goes along the recorded and the made sound at the same time, over whatever is missing."""

    def __init__(self, file, channels):
        self._sound = soundfile.SoundFile(file)
        self._channels = channels
        self.total = len(self._sound)
        self._cache = {}
        self.at, self.source = 0, 0  # next frame of the recording, and of what was made
        self.same = 0
        self.troubles = []

    def close(self):
        self._sound.close()

    def recorded(self, start, count):
        self._sound.seek(start)
        return self._sound.read(count, dtype="int32", always_2d=True) >> 16

    def expected(self, start, count):
        first, last = start // BLOCK, (start + count - 1) // BLOCK
        for block in range(first, last + 1):
            if block not in self._cache:
                self._cache[block] = made(block, self._channels)
        for block in [block for block in self._cache if block < first]:
            del self._cache[block]
        rows = np.concatenate([self._cache[block] for block in range(first, last + 1)])
        return rows[start - first * BLOCK :][:count]

    def go(self):
        self._skip_silence()
        self._find(range(FAR_BLOCKS))
        begun_frame = self.at
        while self.at < self.total:
            count = min(10 * BLOCK, self.total - self.at)
            found, wanted = self.recorded(self.at, count), self.expected(self.source, count)
            wrong = (found != wanted).any(axis=1)
            good = int(np.argmax(wrong)) if wrong.any() else count
            self.same += good
            self.at, self.source = self.at + good, self.source + good
            if good < count and not self._over_trouble():
                break
        return begun_frame

    def _skip_silence(self):
        """Return how many frames were silent."""
        start = self.at
        while self.at < self.total:
            sound = self.recorded(self.at, 10 * BLOCK).any(axis=1)
            if sound.any():
                self.at += int(np.argmax(sound))
                break
            self.at += len(sound)
        return self.at - start

    def _find(self, blocks):
        key = self.recorded(self.at, 8)
        for block in blocks:
            wanted = made(block, self._channels)
            for hit in np.flatnonzero((wanted == key[0]).all(axis=1)):
                at = block * BLOCK + int(hit)
                if np.array_equal(self.expected_anywhere(at, len(key)), key):
                    self.source = at
                    return True
        return False

    def expected_anywhere(self, start, count):
        self._cache.clear()
        return self.expected(start, count)

    def _over_trouble(self):
        frame, source = self.at, self.source
        silent = self._skip_silence()
        if self.at >= self.total:
            return False
        near = source // BLOCK
        if not self._find(range(near, near + FAR_BLOCKS)):
            self.troubles.append((frame, silent, None))
            return False
        self.troubles.append((frame, silent, self.source - source))
        return True


def compare_sound(original, channels, rate_hz):
    journal = [json.loads(line) for line in (original / "recording.jsonl").read_text().splitlines()]
    gaps = {line["values"]["frame"]: line["values"]["frames"] for line in journal if line["event"] == "sound_gap"}
    walk = Walk(original / "audio-001.wav", channels)
    try:
        begun = walk.go()
        print(f"sound: {walk.total} frames ({walk.total / rate_hz:.1f} s), {begun} before the player began, "
              f"{walk.same} the same bit by bit, {len(walk.troubles)} places where not; "
              f"gaps told: {len(gaps)}")  # fmt: skip
        for frame, silent, missing in walk.troubles[:20]:
            if missing is None:
                whom = "not found again: the sound was changed"
            elif missing == 0:
                whom = f"the player stood still for {silent} frames; nothing of it is missing"
            elif frame in gaps:
                whom = f"ours: told as {gaps[frame]} frames, {silent} silent, {missing} missing"
            else:
                whom = f"untold: {silent} silent, {missing} missing"
            print(f"  at {frame / rate_hz:.3f} s: {whom}")
    finally:
        walk.close()


def compare_motion(original, ball):
    found = FrameDecoder().feed(b"".join(file.read_bytes() for file in sorted(original.glob("imu-*.lkf"))))
    first = int(np.flatnonzero((ball.frames.acc_s_mps2 == found.acc_s_mps2[0]).all(axis=1))[0])
    span = np.arange(first, int(np.flatnonzero((ball.frames.acc_s_mps2 == found.acc_s_mps2[-1]).all(axis=1))[0]) + 1)
    sent = ball.rows(span[ball.sent[span]])
    same = len(sent) == len(found) and all(
        np.array_equal(getattr(sent, name), getattr(found, name)) for name in ("acc_s_mps2", "gyr_s_radps")
    )
    even = len(sent) == len(found) and np.array_equal(np.diff(sent.time_us), np.diff(found.time_us))
    print(f"motion: {len(found)} samples, {len(sent)} sent meanwhile, {ball.refused} found no room in the device; "
          f"{'equal' if same else 'NOT EQUAL'} in value, {'equal' if even else 'NOT EQUAL'} in time")  # fmt: skip
    late = found.host_s - 1e-6 * found.time_us.astype(np.float64)
    print(f"  arrivals: {1e3 * (np.median(late) - late.min()):.1f} ms late in the middle, "
          f"{1e3 * (late.max() - late.min()):.0f} ms at most")  # fmt: skip


def soak(words, folder):
    server = SoundServer(words.audio_rate, words.channels)
    ball = WiredBall(folder / "ball", words.imu_rate, 60.0 * words.minutes + 120.0)
    player = recorder = None
    try:
        server.start()
        with ball:
            command = [
                sys.executable,
                "-m",
                "app",
                "record",
                "--imu",
                f"serial:{ball.link}",
                "--out",
                str(folder / "run"),
            ]
            command += ["--audio", f"default@{words.audio_rate},channels={words.channels}", "--wait", "60"]
            command += ["--seconds", str(60.0 * words.minutes)]
            recorder = subprocess.Popen(command, env=server.environment, stdout=subprocess.PIPE, text=True)
            for line in recorder.stdout:
                print(line.rstrip(), flush=True)
                if line.startswith("Recording"):
                    break
            player = Player(server)
            use = Use(recorder.pid)
            until = time.monotonic() + 60.0 * words.minutes
            while recorder.poll() is None and time.monotonic() < until - 2.0:
                time.sleep(min(LOOK_S, max(0.1, until - 2.0 - time.monotonic())))
                use.look()
            said = recorder.communicate(timeout=120.0)[0]
            player.end()
        print(said.rstrip())
        quarter = max(1, len(use.memory) // 4)
        growth = (use.memory[-1] - use.memory[quarter]) / 1e6
        print(f"CPU {100.0 * use.share:.1f} % of a core; memory {use.memory[-1] / 1e6:.0f} MB, "
              f"{growth:+.1f} MB since a quarter of the time; status {recorder.returncode}")  # fmt: skip
        original = folder / "run.leakline" / "recordings" / "1" / "original"
        compare_motion(original, ball)
        compare_sound(original, words.channels, words.audio_rate)
    finally:
        if player is not None:
            player.end()
        if recorder is not None and recorder.poll() is None:
            recorder.send_signal(signal.SIGKILL)
            recorder.communicate(timeout=30.0)
        server.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--imu-rate", type=float, default=400.0)
    parser.add_argument("--audio-rate", type=int, default=48_000)
    parser.add_argument("--channels", type=int, default=1)
    folder = Path(tempfile.mkdtemp(prefix="leakline-soak-"))
    try:
        soak(parser.parse_args(), folder)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
