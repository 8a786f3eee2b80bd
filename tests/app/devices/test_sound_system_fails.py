"""A sound system that fails as nobody thought: the input is tried again, and its state never says that it is heard."""

import time
from types import SimpleNamespace

import numpy as np
import pytest

from app.devices import audio_input, portaudio
from app.devices.audio_devices import AudioDevice
from app.devices.audio_input import AudioInput
from app.devices.audio_spec import AudioChoice
from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import LinkState

DEADLINE_S = 15.0
RATE_HZ = 48_000
MICROPHONE = AudioDevice("Ball: Audio (hw:1,0)", "ALSA", 2, 48_000.0, 3)


class SystemFailsError(Exception):
    """As PortAudio's own: derived from Exception directly."""


def wait_for(condition, what):
    until = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.01)


class System:
    """A sound system whose calls the test lets fail."""

    def __init__(self):
        self.fails = set()
        self.callback = None
        self.asked = self.opened = self.closed = 0

    def list(self):
        self.asked += 1
        if "list" in self.fails:
            raise SystemFailsError("Error initializing PortAudio")
        return (MICROPHONE,)

    def open(self, _device, rate_hz, _channels, callback):
        self.opened += 1
        self.callback = callback
        return SimpleNamespace(sample_rate_hz=float(rate_hz), is_converted=False, close=self.close)

    def close(self):
        self.closed += 1

    def source(self, _device):
        if "source" in self.fails:
            raise SystemFailsError("nobody thought of it")

    def play(self):
        times = SimpleNamespace(currentTime=7.0, inputBufferAdcTime=6.99)
        self.callback(np.ones(480, np.int32).tobytes(), 480, times, SimpleNamespace(input_overflow=False))


@pytest.fixture
def heard(monkeypatch):
    """The system, and an input that listens to it."""
    monkeypatch.setattr(audio_input, "RETRY_S", 0.02)
    monkeypatch.setattr(audio_input, "SOURCE_S", 0.05)
    system = System()
    choice = AudioChoice(MICROPHONE.name, RATE_HZ, 1)
    sound = AudioInput(choice, lambda _: None, open_device=system.open, devices=system.list, source_of=system.source)
    yield system, sound
    assert sound.stop()


def test_an_input_is_opened_when_the_system_answers_at_last(heard):
    system, sound = heard
    system.fails.add("list")
    sound.start()
    wait_for(lambda: system.asked > 2, "it to be tried again")
    assert sound.status().state is LinkState.WAITING
    assert sound.fault.code is ErrorCode.SOUND_SYSTEM_HANGS
    system.fails.clear()
    wait_for(lambda: system.callback is not None, "the device to be opened")


def test_an_input_that_cannot_be_watched_is_lost_and_opened_again(heard):
    system, sound = heard
    sound.start()
    wait_for(lambda: system.opened == 1, "the device to be opened")

    def comes():
        system.play()
        return sound.status().state is LinkState.LIVE

    wait_for(comes, "sound")
    system.fails.add("source")
    wait_for(lambda: sound.status().state is LinkState.LOST, "the state to say so")
    assert system.closed >= 1
    system.fails.clear()
    wait_for(comes, "sound again")


def test_a_library_that_could_not_be_begun_anew_is_begun_the_next_time(monkeypatch):
    calls = []

    class Library:
        PortAudioError = SystemFailsError
        _initialized = 1

        def _terminate(self):
            if not self._initialized:
                raise SystemFailsError("PortAudio not initialized")
            calls.append("end")
            self._initialized -= 1

        def _initialize(self):
            if calls == ["end"]:
                calls.append("refused")
                raise SystemFailsError("the sound server is away")
            calls.append("begin")
            self._initialized += 1

    library = Library()
    monkeypatch.setattr(portaudio, "library", lambda: library)
    with pytest.raises(LeaklineError) as caught:
        portaudio.refresh()
    assert caught.value.code is ErrorCode.SOUND_SYSTEM_HANGS
    assert portaudio.refresh()
    assert calls == ["end", "refused", "begin"]
