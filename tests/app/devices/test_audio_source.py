"""What a sound server and the kernel tell of what feeds a stream."""

import pytest

from app.devices.audio_devices import AudioDevice
from app.devices.audio_source import Source, card_rate, is_same, source_behind, source_numbered, source_of

# as PulseAudio 16 prints them
OUTPUTS = """Source Output #1
	Driver: protocol-native.c
	Client: 17
	Source: 3
	Sample Specification: s32le 1ch 48000Hz
	Properties:
		application.name = "ALSA plug-in [python3.11]"
		application.process.id = "10241"

Source Output #4
	Driver: PipeWire
	Client: 18
	Source: 57
	Properties:
		application.process.id = "222"
"""
SOURCES = """0\tvsink.monitor\tmodule-null-sink.c\tfloat32le 2ch 48000Hz\tRUNNING
3\talsa_input.usb-Ball-00.mono-fallback\tmodule-alsa-card.c\ts16le 1ch 44100Hz\tRUNNING
57\talsa_input.pci-0000_00_1f.3.analog-stereo\tPipeWire\ts32le 2ch 96000Hz\tSUSPENDED
"""


@pytest.mark.parametrize(("process", "number"), [(10241, 3), (222, 57), (17, None)])
def test_a_stream_is_found_by_the_process_that_has_it(process, number):
    assert source_of(OUTPUTS, process) == number


def test_a_source_is_found_by_its_number_with_its_own_rate():
    assert source_numbered(SOURCES, 3) == Source("alsa_input.usb-Ball-00.mono-fallback", 44_100.0)
    assert source_numbered(SOURCES, 57).rate_hz == 96_000.0
    assert source_numbered(SOURCES, 7) is None


@pytest.mark.parametrize("text", ["", "nothing\n", "3\n", "3\ta\tb\tc\td"])
def test_listings_of_another_form_tell_nothing_false(text):
    assert source_of(text, 3) is None
    assert source_numbered(text, 3) in (None, Source("a", None))


def test_the_kernel_tells_the_rate_of_an_open_card(tmp_path):
    folder = tmp_path / "card1" / "pcm0c" / "sub0"
    folder.mkdir(parents=True)
    (folder / "hw_params").write_text(
        "access: MMAP_INTERLEAVED\nformat: S16_LE\nsubformat: STD\nchannels: 2\nrate: 44100 (44100/1)\n"
    )
    assert card_rate(1, 0, tmp_path) == 44_100.0
    (folder / "hw_params").write_text("closed\n")
    assert card_rate(1, 0, tmp_path) is None
    assert card_rate(2, 0, tmp_path) is None


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("alsa_input.usb-Ball-00.mono-fallback", "alsa_input.usb-Ball-00.analog-stereo.2", True),
        ("alsa_input.usb-Ball-00.mono-fallback", "alsa_input.usb-Bell-00.mono-fallback", False),
        ("vsink.monitor", "other.monitor", False),
        ("USB Audio: - (hw:1,0)", "USB Audio: - (hw:2,0)", True),
        ("jack", "jack", True),
    ],
)
def test_a_source_is_known_again_in_another_socket_and_with_other_channels(one, other, same):
    assert is_same(Source(one, None), Source(other, 48_000.0)) is same


def test_of_a_device_behind_another_way_nothing_is_known():
    assert source_behind(AudioDevice("Microphone", "Windows WASAPI", 2, 48_000.0, 0)) is None
