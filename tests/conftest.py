"""What every test may use: isolation from the user's own files, and the public recordings where they are at hand."""

import os
import signal
from pathlib import Path

import pytest
import sound_server as sound_server_helper
from hypothesis import settings
from pytestqt.qtbot import QtBot

# set before Qt is first imported; a test that needs a real screen starts its own
os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

# a shell's background jobs ignore SIGINT, and what the tests start would with them
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# the same examples each time, however busy the machine is; new ones are looked for with --hypothesis-profile=searching
settings.register_profile("same", derandomize=True, deadline=None)
settings.register_profile("searching", deadline=None)
settings.load_profile("same")

PATIENCE_MS = 30_000
ROOT = Path(__file__).resolve().parent.parent


class PatientBot(QtBot):
    """Waits as long as a busy machine with two processors may need: what comes at once is not waited for."""

    def waitUntil(self, callback, *, timeout=PATIENCE_MS):  # noqa: N802 - the name that is there
        super().waitUntil(callback, timeout=timeout)

    def waitSignal(self, signal, *, timeout=PATIENCE_MS, **more):  # noqa: N802 - the name that is there
        return super().waitSignal(signal, timeout=timeout, **more)

    def waitSignals(self, signals, *, timeout=PATIENCE_MS, **more):  # noqa: N802 - the name that is there
        return super().waitSignals(signals, timeout=timeout, **more)


@pytest.fixture
def qtbot(qapp, request):
    """The usual one, but patient."""
    return PatientBot(request)


@pytest.fixture
def shared_data() -> Path:
    """The folder of public recordings beside the repository; skips where it is absent."""
    folder = ROOT.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip("the public recordings (shared/data) are not beside this checkout")
    return folder


@pytest.fixture(autouse=True)
def own_home(tmp_path_factory, monkeypatch):
    """Keep every test away from the user's settings and data folders."""
    home = tmp_path_factory.mktemp("home")
    for name in ("XDG_CONFIG_HOME", "XDG_DATA_HOME", "XDG_CACHE_HOME", "XDG_STATE_HOME", "APPDATA", "LOCALAPPDATA"):
        monkeypatch.setenv(name, str(home / name.lower()))
    return home


@pytest.fixture(scope="session")
def main_twice(tmp_path_factory):
    """The same simulated main listened to in 2025 and in 2026: paths of both survey folders, and their results.

    A leak stayed at 20 m, one at 45 m grew by 6 dB, one at 80 m was mended, one at 65 m is new; the ball was quicker
    and the recorder set louder the second time.
    """
    from repeated_main import listened

    place = tmp_path_factory.mktemp("main")
    old, before = listened(place, "old", "2025-05-04", [(20.0, 10.0), (45.0, 8.0), (80.0, 9.0)], seed=1)
    new, now = listened(
        place, "new", "2026-05-04", [(20.0, 10.0), (45.0, 14.0), (65.0, 10.0)], seed=2, speed_mps=0.75, gain_db=6.0
    )
    old.close()
    new.close()
    return (old.path, before), (new.path, now)


@pytest.fixture(scope="session")
def _sound_server():
    if (reason := sound_server_helper.why_missing()) is not None:
        pytest.skip(reason)
    server = sound_server_helper.SoundServer()
    try:
        server.start()
        yield server
    finally:
        server.close()


@pytest.fixture
def sound_server(_sound_server):
    """A virtual sound server that this process, and its children, record from by default: a SoundServer that runs.

    PortAudio reads its surroundings when it is initialised, so it is initialised anew before and after.
    """
    from app.devices import portaudio

    _sound_server.write_asound()
    _sound_server.start()
    _sound_server.reform(48_000, 2)
    try:
        with pytest.MonkeyPatch.context() as environment:
            for name, value in _sound_server.variables.items():
                environment.setenv(name, value)
            assert portaudio.refresh(), "a stream of an earlier test is still open"
            yield _sound_server
    finally:
        _sound_server.end_players()
    assert portaudio.refresh(), "this test left a stream open"
