"""A real PulseAudio server for tests, with a sink that nobody hears and whose monitor is the default input.

Each server has its own folder below the system's temporary one (a socket's path is short), its own settings and its own
socket, works as root, and dies with the process that started it, whatever happens to that.
"""

import ctypes
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

PROGRAMS = {"pulseaudio": "pulseaudio", "paplay": "pulseaudio-utils", "pactl": "pulseaudio-utils"}
PLUGIN = "libasound2-plugins"
START_S = 10.0  # how long the server may take on a loaded machine
CALL_S = 10.0
SINK = "vsink"
_OPTIONS = (
    *("-n", "--daemonize=no", "--exit-idle-time=-1", "--disallow-exit", "--use-pid-file=no"),
    *("--realtime=no", "--high-priority=no", "--log-level=error"),
)
# killed by the kernel when the test process ends, however that ends
_DIES_WITH_US = ("setpriv", "--pdeathsig", "KILL") if shutil.which("setpriv") else ()
_PLUGIN_FILE = "libasound_module_pcm_pulse.so"


def why_missing() -> str | None:
    """Return why no sound server can be started here, None where one can."""
    if not sys.platform.startswith("linux"):
        return "the virtual sound server needs Linux"
    missing = {package for program, package in PROGRAMS.items() if shutil.which(program) is None}
    folders = (Path("/usr/lib/alsa-lib"), Path("/usr/lib64/alsa-lib"), *Path("/usr/lib").glob("*/alsa-lib"))
    if not any((folder / _PLUGIN_FILE).exists() for folder in folders):
        missing.add(PLUGIN)
    try:
        ctypes.CDLL("libportaudio.so.2")
    except OSError:
        missing.add("libportaudio2")
    return f"no virtual sound server: {', '.join(sorted(missing))} not installed" if missing else None


class SoundServer:
    """Started and killed as often as wanted; :meth:`close` ends all that it began."""

    def __init__(self, rate_hz: int = 48_000, channels: int = 2) -> None:
        self.rate_hz, self.channels = rate_hz, channels
        self.folder = Path(tempfile.mkdtemp(prefix="leakline-sound-"))
        self.socket = self.folder / "native"
        self.asound = self.folder / "asound.conf"
        self.write_asound()
        self._server: subprocess.Popen | None = None
        self._players: list[subprocess.Popen] = []

    @property
    def variables(self) -> dict[str, str]:
        """What a program's environment must hold to record from, and play into, this server."""
        return {"ALSA_CONFIG_PATH": str(self.asound), "PULSE_SERVER": f"unix:{self.socket}"}

    @property
    def environment(self) -> dict[str, str]:
        """A whole environment for a child process."""
        return {**os.environ, **self.variables}

    def write_asound(self, more: str = "") -> None:
        """Write ALSA's configuration anew: the system's, its default device the server, and ``more``."""
        self.asound.write_text(
            "</usr/share/alsa/alsa.conf>\npcm.!default { type pulse }\nctl.!default { type pulse }\n" + more,
            encoding="utf-8",
        )

    def start(self) -> None:
        """Start the server and wait until it answers; it ends with the thread that calls this."""
        if self.is_running():
            return
        self.socket.unlink(missing_ok=True)  # a killed server leaves it behind
        home = {name: str(self.folder) for name in ("HOME", "XDG_RUNTIME_DIR", "XDG_CONFIG_HOME")}
        home |= {"PULSE_RUNTIME_PATH": str(self.folder / "run"), "PULSE_STATE_PATH": str(self.folder / "state")}
        protocol = f"module-native-protocol-unix socket={self.socket} auth-anonymous=1 auth-cookie-enabled=0"
        self._server = subprocess.Popen(
            [*_DIES_WITH_US, "pulseaudio", *_OPTIONS, "-L", protocol, "-L", self._sink()],
            env={**os.environ, **home},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        until = time.monotonic() + START_S
        while not self._answers():
            if self._server.poll() is not None or time.monotonic() > until:
                self.kill()
                raise RuntimeError("the sound server did not start")
            time.sleep(0.02)

    def _sink(self) -> str:
        # norewinds: else the monitor hears what a player took back again
        form = f"rate={self.rate_hz} channels={self.channels} format=float32le"
        return f"module-null-sink sink_name={SINK} norewinds=1 {form}"

    def is_running(self) -> bool:
        """Tell whether the server lives."""
        return self._server is not None and self._server.poll() is None

    def kill(self) -> None:
        """End the server at once, as a cable is pulled."""
        if self._server is not None:
            _end(self._server)
            self._server = None

    def hang(self) -> None:
        """Let the server answer nobody, until :meth:`wake` or :meth:`kill`."""
        assert self._server is not None
        self._server.send_signal(signal.SIGSTOP)

    def wake(self) -> None:
        """Let the server go on after :meth:`hang`."""
        assert self._server is not None
        self._server.send_signal(signal.SIGCONT)

    def unload_sink(self) -> None:
        """Take the sink and its monitor away; the server lives on."""
        for line in self.control("list", "short", "modules").splitlines():
            number, module, *argument = line.split("\t")
            if module == "module-null-sink" and f"sink_name={SINK} " in argument[0]:
                self.control("unload-module", number)

    def reform(self, rate_hz: int, channels: int) -> None:
        """Have the sink in this form."""
        if (rate_hz, channels) != (self.rate_hz, self.channels):
            self.unload_sink()
            self.load_sink(rate_hz, channels)

    def load_sink(self, rate_hz: int | None = None, channels: int | None = None) -> None:
        """Bring the sink back, in another form if one is given."""
        self.rate_hz, self.channels = rate_hz or self.rate_hz, channels or self.channels
        self.control("load-module", *self._sink().split())

    def control(self, *words: str) -> str:
        """Run ``pactl`` with these words and return what it says."""
        done = subprocess.run(
            ["pactl", *words], env=self.environment, timeout=CALL_S, check=True, capture_output=True, text=True
        )
        return done.stdout

    def play(self, path: Path) -> subprocess.Popen:
        """Begin to play a file into the sink, in its own rate and channels, with room for a busy machine."""
        return self._begin(["paplay", f"--device={SINK}", "--latency-msec=2000", str(path)], subprocess.DEVNULL)

    def play_raw(self, latency_ms: int = 50) -> subprocess.Popen:
        """Begin to play what is written to the returned process's ``stdin``: int16 in the sink's rate and channels."""
        form = [f"--rate={self.rate_hz}", f"--channels={self.channels}", "--format=s16le", "--raw", "--playback"]
        return self._begin(["pacat", f"--device={SINK}", f"--latency-msec={latency_ms}", *form], subprocess.PIPE)

    def _begin(self, command: list[str], stdin: int) -> subprocess.Popen:
        player = subprocess.Popen(
            [*_DIES_WITH_US, *command],
            env=self.environment,
            stdin=stdin,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self._players.append(player)
        return player

    def end_players(self) -> None:
        """End whatever still plays."""
        while self._players:
            _end(self._players.pop())

    def close(self) -> None:
        """End everything and remove the folder."""
        try:
            self.end_players()
        finally:
            self.kill()
            shutil.rmtree(self.folder, ignore_errors=True)

    def _answers(self) -> bool:
        if not self.socket.exists():
            return False
        try:
            return SINK in self.control("list", "short", "sinks")
        except (subprocess.SubprocessError, OSError):
            return False


def _end(process: subprocess.Popen) -> None:
    process.kill()
    if process.stdin is not None:
        process.stdin.close()
    process.wait(timeout=CALL_S)
