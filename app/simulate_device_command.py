"""``leakline simulate-device``: a ball that is not there, for trying live recording without any hardware."""

import json
import os
import shlex
import signal
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from app.devices.audio_spec import AudioChoice
from app.devices.simulated.faults import Fault, FaultKind, FaultPlan, parse_faults
from app.devices.simulated.player import TapePlayer
from app.devices.simulated.ports import Port, open_port
from app.devices.simulated.protocols import encoder_named
from app.devices.simulated.sender import Pace, RowSender
from app.devices.simulated.sound_out import open_out
from app.devices.simulated.sound_server import SoundServer
from app.devices.simulated.source import Ball, RowReel, Wanted, open_ball
from app.devices.simulated.truth import TruthFile
from processing import messages
from processing.errors import ErrorCode, LeaklineError
from processing.progress import Progress

_LOOK_S = 0.2


@dataclass(frozen=True)
class SimulateDeviceWords:
    """What the command line says; see its help."""

    source: str
    imu: str = "pty"
    protocol: str = "frames"
    audio: str = "none"
    rate_hz: float | None = None
    audio_rate_hz: int | None = None
    channels: int = 1
    speed: float = 1.0
    loop: bool = False
    faults: str = ""
    seed: int = 0
    seconds: float | None = None
    wait: bool = True
    start_server: bool = False
    truth: Path | None = None
    language: str = "en"


def simulate_device(
    words: SimulateDeviceWords, progress: Progress, say: Callable[[str], None], stop: threading.Event | None = None
) -> None:
    """Send a run until it ends, the seconds are over, or ``stop`` is set (Ctrl+C and SIGTERM set it in a main thread).

    ``say`` is given one line of JSON first, then sentences.

    Raises:
        LeaklineError: what the user can mend.
    """
    plan = parse_faults(words.faults)
    has_sound = words.start_server or words.audio != "none"
    if has_sound and words.speed != 1.0:
        raise LeaklineError(
            ErrorCode.SETTING_INVALID, name="--speed", value=str(words.speed), allowed="1, --audio none"
        )
    stop = stop or threading.Event()
    with ExitStack() as stack:
        stopping = stack.enter_context(_Stopping(stop))
        scratch = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="leakline-", ignore_cleanup_errors=True)))
        port = open_port(words.imu)
        stack.callback(port.close)
        ball = open_ball(words.source, _wanted(words, plan), scratch, progress)
        if has_sound and ball.sound is None:
            raise LeaklineError(ErrorCode.SIMULATED_SOUND_FAILED, reason=f"{ball.name} has no sound")
        server = None
        if words.start_server and ball.sound is not None:
            server = stack.enter_context(SoundServer(ball.sound.rate_hz, ball.sound.channels))
        truth = None if words.truth is None else stack.enter_context(TruthFile(words.truth))
        reel = RowReel(ball.imu, loop=words.loop)
        player = _player(words, plan, ball, reel, server, truth, stack)
        sender = _sender(words, plan, reel, port, ball, player, truth, say)
        stack.callback(sender.stop)
        _announce(words, port, ball, server, say)
        stopping.arm()
        sender.start()
        _wait(sender, player, stop, words.seconds)


def _wanted(words: SimulateDeviceWords, plan: FaultPlan) -> Wanted:
    # the sound is made so that what is heard and felt at one moment is sent at one moment, by each stream's own clock
    apart = (1.0 + 1e-6 * plan.audio_drift_ppm) / (1.0 + 1e-6 * plan.drift_ppm) - 1.0
    return Wanted(words.rate_hz, words.audio_rate_hz, words.channels, words.seed, 1e6 * apart)


def _player(
    words: SimulateDeviceWords, plan: FaultPlan, ball: Ball, reel: RowReel, server: SoundServer | None,
    truth: TruthFile | None, stack: ExitStack,
) -> TapePlayer | None:  # fmt: skip
    if ball.sound is None:
        return None
    out = open_out(words.audio, server, ball.sound.rate_hz, ball.sound.channels)
    if out is None:
        ball.sound.close()
        return None
    faults = plan.of(FaultKind.AUDIO_UNPLUG)
    lap_s = reel.lap_length_s / (1.0 + 1e-6 * plan.drift_ppm) if words.loop else None
    player = TapePlayer(
        ball.sound, out, drift_ppm=plan.audio_drift_ppm, lap_s=lap_s, faults=faults, truth=truth
    )  # fmt: skip
    stack.callback(player.stop)
    return player


def _sender(
    words: SimulateDeviceWords, plan: FaultPlan, reel: RowReel, port: Port, ball: Ball, player: TapePlayer | None,
    truth: TruthFile | None, say: Callable[[str], None],
) -> RowSender:  # fmt: skip
    def on_start(host_s: float) -> None:
        if truth is not None:
            truth.note("start", host_s=host_s, protocol=words.protocol, source=ball.name, faults=words.faults)
        if player is not None:
            player.start(host_s)
        say(messages.text("cli", "device_sends", words.language))

    def on_fault(fault: Fault) -> None:
        kind = messages.text("simulated_faults", fault.kind.replace("-", "_"), words.language)
        say(messages.text("cli", "device_fault", words.language, at_s=fault.at_s, fault=kind))

    return RowSender(
        reel,
        lambda first: encoder_named(words.protocol, first),
        port,
        Pace(plan.drift_ppm, words.speed, ball.imu.sample_rate_hz),
        plan,
        seed=words.seed,
        wait=words.wait and not words.imu.startswith("udp"),
        truth=truth,
        on_start=on_start,
        on_fault=on_fault,
    )


def _announce(
    words: SimulateDeviceWords, port: Port, ball: Ball, server: SoundServer | None, say: Callable[[str], None]
) -> None:
    """Say where the ball is: a line for programs, and the command to type for people."""
    environment: Mapping[str, str] = {} if server is None else server.environment
    protocol = words.protocol.removesuffix("-binary")
    imu = f"{port.spec},protocol={protocol}"
    audio = "none"
    if server is not None and ball.sound is not None:
        audio = str(AudioChoice(rate_hz=ball.sound.rate_hz, channels=ball.sound.channels))
    line = {
        "imu": imu, "audio": audio, "environment": dict(environment), "imu_rate_hz": round(ball.imu.sample_rate_hz, 3),
        "audio_rate_hz": None if ball.sound is None else ball.sound.rate_hz,
        "channels": None if ball.sound is None else ball.sound.channels, "pid": os.getpid(),
    }  # fmt: skip
    say(json.dumps(line))
    before = " ".join(f"{name}={shlex.quote(value)}" for name, value in environment.items())
    command = f"{before} leakline record --imu {shlex.quote(imu)} --audio {audio} --out my-recordings".strip()
    say(messages.text("cli", "device_ready", words.language, name=ball.name, command=command))


def _wait(sender: RowSender, player: TapePlayer | None, stop: threading.Event, seconds: float | None) -> None:
    while not sender.wait(0.0):
        if stop.wait(_LOOK_S) or sender.is_over(seconds):
            break
        if player is not None and player.error is not None:
            break
    sender.stop()
    for error in (sender.error, None if player is None else player.error):
        if error is not None:
            raise error


class _Stopping:
    """Lets Ctrl+C and SIGTERM interrupt the preparations, and end the sending tidily; a second one is as usual."""

    def __init__(self, stop: threading.Event) -> None:
        self._stop = stop
        self._before: dict[int, Any] = {}
        self._is_armed = False

    def arm(self) -> None:
        """From now on it is sent."""
        self._is_armed = True

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            for number in (signal.SIGINT, signal.SIGTERM):
                self._before[number] = signal.signal(number, self._asked)
        return self

    def _asked(self, number: int, _frame: object) -> None:
        signal.signal(number, self._before[number])
        if not self._is_armed:
            raise KeyboardInterrupt
        self._stop.set()

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)


def print_line(line: str) -> None:
    """Print at once: whoever started us reads along."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
