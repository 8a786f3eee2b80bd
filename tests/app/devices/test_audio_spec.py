"""What people may write for a sound input."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.devices.audio_spec import AudioChoice, parse_audio_spec
from processing.errors import ErrorCode, LeaklineError


@pytest.mark.parametrize(
    ("text", "choice"),
    [
        ("default", AudioChoice("default", None, 1)),
        ("Default@96000", AudioChoice("default", 96_000, 1)),
        ("USB Audio CODEC: - (hw:1,0)", AudioChoice("USB Audio CODEC: - (hw:1,0)", None, 1)),
        ("USB Audio CODEC: - (hw:1,0)@192000,channels=2", AudioChoice("USB Audio CODEC: - (hw:1,0)", 192_000, 2)),
        ("Mikrofon (Ölçüm), channels=2", AudioChoice("Mikrofon (Ölçüm)", None, 2)),
        ("me@home", AudioChoice("me@home", None, 1)),
    ],
)
def test_a_spec_names_device_rate_and_channels(text, choice):
    assert parse_audio_spec(text) == choice


@pytest.mark.parametrize("text", ["none", " None "])
def test_none_is_no_sound(text):
    assert parse_audio_spec(text) is None


@pytest.mark.parametrize("text", ["", "  ", "@48000", ",channels=2", "mic@7999", "mic@192001", "mic,channels=0"])
def test_a_spec_that_names_nothing_is_told(text):
    with pytest.raises(LeaklineError) as told:
        parse_audio_spec(text)
    assert told.value.code is ErrorCode.SOUND_SPEC_INVALID


@given(
    st.text(min_size=1, max_size=40).map(str.strip).filter(lambda n: n and n.casefold() not in {"none", "default"}),
    st.none() | st.integers(8_000, 192_000),
    st.integers(1, 32),
)
def test_every_choice_is_read_back_from_what_it_prints(name, rate_hz, channels):
    choice = AudioChoice(name + ".", rate_hz, channels)
    assert parse_audio_spec(str(choice)) == choice
