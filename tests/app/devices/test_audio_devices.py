"""Which inputs there are, and that a name finds its device again."""

import sys
import threading
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.devices import portaudio
from app.devices.audio_devices import AudioDevice, best_of_each, list_inputs, named, plain_name
from app.devices.audio_spec import AudioChoice
from app.devices.audio_stream import open_input, suitable_rate
from processing.errors import ErrorCode, LeaklineError


def device(name, index=0, host_api="ALSA", is_default=False):
    return AudioDevice(name, host_api, 2, 48_000.0, index, is_default)


# as PortAudio lists one USB microphone and the built-in one on Windows; MME cuts names off after 31 characters
WINDOWS = (
    device("Microsoft Sound Mapper - Input", 0, "MME"),
    device("Microphone (USB Audio CODEC for", 1, "MME", is_default=True),
    device("Microphone Array (Realtek Audio", 2, "MME"),
    device("Primary Sound Capture Driver", 3, "Windows DirectSound"),
    device("Microphone (USB Audio CODEC for field use)", 4, "Windows DirectSound"),
    device("Microphone Array (Realtek Audio)", 5, "Windows DirectSound"),
    device("Microphone (USB Audio CODEC for field use)", 6, "Windows WASAPI"),
    device("Microphone Array (Realtek Audio)", 7, "Windows WASAPI"),
    device("Microphone (USB Audio CODEC for field use)", 8, "Windows WDM-KS"),
)


def test_on_windows_each_device_is_listed_once_by_its_best_way():
    listed = best_of_each(WINDOWS, "win32")
    assert [(d.name, d.host_api) for d in listed] == [
        ("Microphone (USB Audio CODEC for field use)", "Windows WASAPI"),
        ("Microsoft Sound Mapper - Input", "MME"),
        ("Primary Sound Capture Driver", "Windows DirectSound"),
        ("Microphone Array (Realtek Audio)", "Windows WASAPI"),
    ]
    assert [d.is_default for d in listed] == [True, False, False, False]


def test_two_devices_of_one_kind_are_two():
    pair = (device("USB Audio: - (hw:1,0)", 1), device("USB Audio: - (hw:2,0)", 2))
    assert best_of_each(pair, "linux") == pair


def test_a_device_behind_jack_too_is_listed_by_alsa():
    rows = (device("USB Audio", 0, "JACK Audio Connection Kit"), device("USB Audio: (hw:1,0)", 1, "OSS"))
    rows += (device("USB Audio", 2, "ALSA"),)
    assert [d.host_api for d in best_of_each(rows, "linux")] == ["OSS", "ALSA"]


@given(st.permutations(WINDOWS))
def test_the_order_in_which_the_system_lists_them_does_not_matter(rows):
    assert {d.name for d in best_of_each(rows, "win32")} == {d.name for d in best_of_each(WINDOWS, "win32")}


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("USB Audio CODEC: - (hw:1,0)", "USB Audio CODEC: - (hw:2,0)"),
        ("Microphone (USB Audio CODEC)", "Microphone (3- USB Audio CODEC)"),
        ("Mikrofon (2- Ölçüm Kartı)", "Mikrofon (Ölçüm Kartı)"),
    ],
)
def test_a_name_finds_its_device_in_another_socket(before, after):
    others = (device("HDA Intel PCH: ALC269 (hw:0,0)", 0), device(after, 1))
    assert named(AudioChoice(before), others).name == after


def test_the_exact_name_goes_before_one_that_is_alike():
    pair = (device("USB: (hw:1,0)", 1), device("USB: (hw:2,0)", 2))
    assert named(AudioChoice("USB: (hw:2,0)"), pair).index == 2


def test_numbers_that_belong_to_a_name_stay():
    assert plain_name("Scarlett 2i2: USB (hw:1,0)") == "scarlett 2i2: usb"
    assert plain_name("MOTU M-2-B") != plain_name("MOTU M-3-B")


def test_default_is_what_the_system_says():
    rows = (device("a", 0), device("b", 1, is_default=True))
    assert named(AudioChoice(), rows).name == "b"


def test_a_device_that_is_not_there_is_told_with_those_that_are():
    with pytest.raises(LeaklineError) as told:
        named(AudioChoice("Ball"), (device("a"), device("b")))
    assert told.value.code is ErrorCode.SOUND_DEVICE_MISSING
    assert told.value.params == {"name": "Ball", "known": "a, b"}


@pytest.mark.parametrize("name", ["default", "Ball"])
def test_a_computer_without_any_input_is_told(name):
    with pytest.raises(LeaklineError) as told:
        named(AudioChoice(name), ())
    assert told.value.code is ErrorCode.SOUND_NO_INPUT


def test_a_computer_without_the_library_is_told_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", None)
    with pytest.raises(LeaklineError) as told:
        list_inputs()
    assert told.value.code is ErrorCode.SOUND_LIBRARY_MISSING


def test_the_server_is_an_input_and_the_default_one(sound_server):
    listed = list_inputs()
    assert "default" in [d.name for d in listed]
    assert [d.is_default for d in listed].count(True) == 1
    assert all(d.channels > 0 for d in listed)


def test_a_device_that_comes_later_is_seen_unless_a_stream_is_open(sound_server):
    def names():
        return [d.name for d in list_inputs()]

    stream = open_input(named(AudioChoice(), list_inputs()), 48_000, 1, SilentCallback())
    try:
        sound_server.write_asound("pcm.later { type pulse }\n")
        assert "later" not in names()
    finally:
        stream.close()
    assert "later" in names()


def test_a_device_that_refuses_is_told_and_holds_nothing(sound_server):
    with pytest.raises(LeaklineError) as told:
        open_input(named(AudioChoice(), list_inputs()), 48_000, 99, SilentCallback())
    assert told.value.code is ErrorCode.SOUND_DEVICE_REFUSED
    assert told.value.params["channels"] == 99
    assert portaudio.refresh()


def test_48_khz_is_recorded_where_a_device_takes_it(sound_server):
    assert suitable_rate(named(AudioChoice(), list_inputs()), 1) == 48_000
    assert suitable_rate(device("gone", 1_000), 1) == 48_000  # its own


def test_who_asks_while_the_system_hangs_is_told_and_not_held_up(monkeypatch):
    monkeypatch.setattr(portaudio, "WAIT_S", 0.05)
    go_on, hangs = threading.Event(), threading.Event()

    def hang():
        hangs.set()
        go_on.wait(10.0)

    system = SimpleNamespace(_initialized=1, _terminate=hang, _initialize=lambda: None, PortAudioError=OSError)
    monkeypatch.setitem(sys.modules, "sounddevice", system)
    other = threading.Thread(target=portaudio.refresh, daemon=True)
    other.start()
    try:
        assert hangs.wait(10.0)
        for call in (portaudio.refresh, portaudio.Hold):
            with pytest.raises(LeaklineError) as told:
                call()
            assert told.value.code is ErrorCode.SOUND_SYSTEM_HANGS
    finally:
        go_on.set()
        other.join(10.0)
    assert not other.is_alive()


class SilentCallback:
    """Takes what comes."""

    def __call__(self, data, frames, times, status):
        pass

    def on_finished(self):
        pass


class Refusing:
    """A WASAPI device as PortAudio behaves with it: alone at its own rate, or told to resample."""

    def __init__(self, takes, runs_at=None):
        self.takes, self.runs_at, self.tried = takes, runs_at, []

    def WasapiSettings(self, exclusive=False, auto_convert=False):  # noqa: N802  # sounddevice's name
        return "exclusive" if exclusive else "converted" if auto_convert else "?"

    def RawInputStream(self, *, extra_settings, samplerate, **more):  # noqa: N802
        self.tried.append(extra_settings)
        if extra_settings != self.takes:
            raise ValueError("Invalid sample rate")
        nothing = SimpleNamespace(start=lambda: None, abort=lambda: None, close=lambda: None)
        nothing.samplerate = float(self.runs_at or samplerate)
        return nothing


@pytest.mark.parametrize("takes", [None, "exclusive", "converted"])
def test_wasapi_is_asked_to_resample_only_where_nothing_else_goes_and_that_is_told(monkeypatch, takes):
    system = Refusing(takes)
    monkeypatch.setitem(sys.modules, "sounddevice", system)
    stream = open_input(device("Microphone", host_api="Windows WASAPI"), 96_000, 1, SilentCallback())
    stream.close()
    order = [None, "exclusive", "converted"]
    assert system.tried == order[: order.index(takes) + 1]
    assert stream.is_converted == (takes == "converted")


def test_a_stream_at_another_rate_than_asked_for_is_refused(monkeypatch):
    monkeypatch.setitem(sys.modules, "sounddevice", Refusing(None, runs_at=44_100))
    with pytest.raises(LeaklineError) as told:
        open_input(device("Microphone"), 48_000, 1, SilentCallback())
    assert told.value.code is ErrorCode.SOUND_DEVICE_REFUSED
    assert "44100" in told.value.params["reason"]
