"""What a recorder loses that is stopped for some seconds, by the bits of what was played; and what listening costs.

    python tests/benchmarks/sound_standstill.py [SECONDS ...]        stopped for so long, as by a suspended laptop
    python tests/benchmarks/sound_standstill.py --cost RATE CHANNELS [SECONDS]

The sound is noise of 24 bits through a virtual sound server; every tenth of a second of what was recorded is looked up
in it, so that a frame too many or too few anywhere shows.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

HELPERS = Path(__file__).resolve().parent.parent / "helpers"
ROOT = HELPERS.parent.parent
sys.path[:0] = [str(HELPERS), str(ROOT)]
RATE_HZ = 48_000
BEFORE_S, AFTER_S = 8.0, 6.0
_KEY = 64  # samples by which a place in the noise is known


def main(words: list[str]) -> None:
    """Measure what was asked for."""
    if words[:1] == ["--record"]:
        record(float(words[1]), Path(words[2]))
    elif words[:1] == ["--cost"]:
        cost(int(words[1]), int(words[2]), float(words[3]) if len(words) > 3 else 60.0)
    else:
        for stopped_s in map(float, words or ["0.5", "3", "8", "20"]):
            standstill(stopped_s)


def standstill(stopped_s: float) -> None:
    """Stop a recorder for some time and compare what it made with what was played."""
    import soundfile
    from sound_server import SoundServer

    noise = np.random.default_rng(1).integers(-(2**23), 2**23, round(RATE_HZ * (40 + stopped_s)), dtype=np.int32) << 8
    server = SoundServer(RATE_HZ, 1)
    recorder = None
    try:
        server.start()
        played, made = server.folder / "noise.wav", server.folder / "made.npy"
        soundfile.write(played, noise, RATE_HZ, "PCM_24")
        seconds = BEFORE_S + stopped_s + AFTER_S
        command = [sys.executable, __file__, "--record", str(seconds), str(made)]
        recorder = subprocess.Popen(command, env=server.environment)
        time.sleep(5.0)  # the clocks' line is settled by then
        server.play(played)
        time.sleep(BEFORE_S - 5.0)
        recorder.send_signal(signal.SIGSTOP)
        time.sleep(stopped_s)
        recorder.send_signal(signal.SIGCONT)
        recorder.wait(timeout=seconds + 60.0)
        steps = steps_in(np.load(made), noise)
        print(f"stopped for {stopped_s} s; frames too many (+) or too few, and where:", steps or "none", flush=True)
    finally:
        if recorder is not None:
            recorder.kill()
            recorder.wait(timeout=10.0)
        server.close()


def record(seconds: float, path: Path) -> None:
    """Record the default input and write it as one array, silence where frames were lost."""
    from app.devices.audio_input import AudioInput
    from app.devices.audio_spec import AudioChoice

    blocks = []
    sound = AudioInput(AudioChoice("default", RATE_HZ), blocks.append)
    sound.start()
    time.sleep(seconds)
    sound.stop()
    made = np.zeros(blocks[-1].first_frame + len(blocks[-1].frames), np.int32)
    for block in blocks:
        made[block.first_frame :][: len(block.frames)] = block.frames[:, 0]
    np.save(path, made)
    print("  losses told:", [(b.lost_before, b.reason) for b in blocks if b.lost_before] or "none", flush=True)


def steps_in(made: np.ndarray, noise: np.ndarray) -> list[tuple[int, float]]:
    """Return by how many frames places in the recording shift against the noise, and at which second."""
    places = {int(value): place for place, value in enumerate(noise[:-_KEY])}
    steps, last = [], None
    for at in range(int(np.flatnonzero(made)[0]), len(made) - _KEY, RATE_HZ // 10):
        place = places.get(int(made[at]))
        if place is None or not np.array_equal(made[at : at + _KEY], noise[place : place + _KEY]):
            continue
        if last is not None and at - place != last:
            steps.append((at - place - last, round(at / RATE_HZ, 1)))
        last = at - place
    return steps


def cost(rate_hz: int, channels: int, seconds: float) -> None:
    """Print which share of one core an input takes while it is looked at ten times a second."""
    from sound_server import SoundServer

    server = SoundServer(rate_hz, channels)
    try:
        server.start()
        os.environ.update(server.variables)
        from app.devices.audio_input import AudioInput
        from app.devices.audio_spec import AudioChoice

        sound = AudioInput(AudioChoice("default", rate_hz, channels), lambda block: None)
        sound.start()
        time.sleep(3.0)
        begun_s, used_s = time.monotonic(), time.process_time()
        while time.monotonic() < begun_s + seconds:
            time.sleep(0.1)
            sound.status()
        share = (time.process_time() - used_s) / (time.monotonic() - begun_s)
        status = sound.status()
        sound.stop()
        print(f"{rate_hz} Hz, {channels} channels: {share:.2%} of a core; {status.lost_frames} frames lost")
    finally:
        server.close()


if __name__ == "__main__":
    main(sys.argv[1:])
