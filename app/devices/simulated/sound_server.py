"""A sound server of our own, with one virtual microphone, for machines without any sound card: PulseAudio on a pipe.

The microphone is PulseAudio's pipe source: it runs at the pace of who writes into the pipe, so that the simulated
sound card has a clock of its own, and nothing is resampled or made up in between. ``environment`` holds what a program
needs so that PortAudio (through ALSA's plugin for PulseAudio) hears it as the default input.
"""

import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from processing.errors import ErrorCode, LeaklineError

# ended by the kernel when we end, however that happens
DIES_WITH_US = ("setpriv", "--pdeathsig", "TERM") if shutil.which("setpriv") else ()
SOURCE_NAME = "leakline_ball"
_READY_S = 10.0
_COMMAND_S = 5.0
_ASOUND = """</usr/share/alsa/alsa.conf>
pcm.!default { type pulse }
ctl.!default { type pulse }
"""


class SoundServer:
    """A running server; :meth:`close` (or leaving ``with``) ends it and removes its folder.

    Raises:
        LeaklineError: SIMULATED_SOUND_FAILED where PulseAudio is not installed or does not start.
    """

    def __init__(self, rate_hz: int, channels: int) -> None:
        for program in ("pulseaudio", "pactl"):
            if shutil.which(program) is None:
                raise _failed(f"{program} is not installed")
        self._rate_hz, self._channels = rate_hz, channels
        self._folder = Path(tempfile.mkdtemp(prefix="leakline-sound-"))
        self._socket = self._folder / "native"
        self.pipe = self._folder / "microphone"
        config = self._folder / "asound.conf"
        config.write_text(_ASOUND, encoding="utf-8")
        self.environment: Mapping[str, str] = {"PULSE_SERVER": f"unix:{self._socket}", "ALSA_CONFIG_PATH": str(config)}
        # its own home and runtime folders: neither the user's server nor its cookies are touched
        own = {"HOME": str(self._folder), "XDG_RUNTIME_DIR": str(self._folder), "PULSE_RUNTIME_PATH": str(self._folder)}
        self._server = subprocess.Popen(
            [
                *DIES_WITH_US, "pulseaudio", "-n", "--daemonize=no", "--exit-idle-time=-1", "--disallow-exit",
                "--use-pid-file=no", "--realtime=no", "--high-priority=no", "--log-level=error",
                "-L", f"module-native-protocol-unix socket={self._socket} auth-anonymous=1 auth-cookie-enabled=0",
                "-L", self._microphone,
            ],
            env={**os.environ, **own},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl+C is for us: the server goes after what plays into it
        )  # fmt: skip
        try:
            self._wait_until_ready()
        except BaseException:
            self.close()
            raise

    @property
    def _microphone(self) -> str:
        return (
            f"module-pipe-source source_name={SOURCE_NAME} file={self.pipe} rate={self._rate_hz} "
            f"channels={self._channels} format=float32le"
        )

    def _wait_until_ready(self) -> None:
        deadline = time.monotonic() + _READY_S
        while time.monotonic() < deadline:
            if self._server.poll() is not None:
                raise _failed(f"PulseAudio ended with status {self._server.returncode}")
            if self._socket.exists() and self.pipe.exists() and self._pactl("info"):
                return
            time.sleep(0.05)
        raise _failed("PulseAudio does not answer")

    def _pactl(self, *words: str) -> bool:
        try:
            done = subprocess.run(
                ["pactl", *words],
                env={**os.environ, **self.environment},
                stdin=subprocess.DEVNULL, capture_output=True, timeout=_COMMAND_S, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return False
        return done.returncode == 0

    def unplug(self) -> None:
        """Take the microphone away; recordings of it end."""
        if not self._pactl("unload-module", "module-pipe-source"):
            raise _failed("PulseAudio does not take the microphone away")
        deadline = time.monotonic() + _COMMAND_S
        while self.pipe.exists() and time.monotonic() < deadline:  # it is unloaded after the answer
            time.sleep(0.01)

    def replug(self) -> None:
        """Bring the microphone back."""
        name, *values = self._microphone.split()
        if not self._pactl("load-module", name, *values):
            raise _failed("PulseAudio does not bring the microphone back")

    def close(self) -> None:
        """End the server."""
        if self._server.poll() is None:
            self._server.terminate()
            try:
                self._server.wait(2.0)
            except subprocess.TimeoutExpired:
                self._server.kill()
                self._server.wait(2.0)
        shutil.rmtree(self._folder, ignore_errors=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def _failed(reason: str) -> LeaklineError:
    return LeaklineError(ErrorCode.SIMULATED_SOUND_FAILED, reason=reason)
