"""An input against devices that misbehave as no virtual one can: played by the test, which owns the callback."""

import threading
import time
from types import SimpleNamespace

import numpy as np
import pytest

from app.devices import audio_input
from app.devices.audio_devices import AudioDevice
from app.devices.audio_input import AudioInput
from app.devices.audio_source import Source
from app.devices.audio_spec import AudioChoice
from app.devices.audio_stream import digitised
from processing.errors import ErrorCode, LeaklineError
from processing.live.stream import LinkState

DEADLINE_S = 15.0
RATE_HZ = 48_000
MICROPHONE = AudioDevice("Ball: Audio (hw:1,0)", "ALSA", 2, 48_000.0, 3)
INNER = AudioDevice("Laptop: Analog (hw:0,0)", "ALSA", 2, 44_100.0, 1, is_default=True)


def wait_for(condition, what):
    until = time.monotonic() + DEADLINE_S
    while not condition():
        assert time.monotonic() < until, f"waited in vain: {what}"
        time.sleep(0.01)


class Played:
    """A sound system whose devices the test plugs, plays and breaks."""

    def __init__(self, *devices):
        self.devices = devices
        self.opened = []  # (device, rate, channels)
        self.callback = None
        self.refuses = None
        self.source, self.is_converted = None, False
        self.hangs_opening = self.hangs_closing = False
        self.go_on = threading.Event()
        self.closed = 0
        self._begun_s = 0.0
        self._sent = 0

    def list(self):
        return self.devices

    def open(self, device, rate_hz, channels, callback):
        if self.refuses is not None:
            raise self.refuses
        if self.hangs_opening:
            self.go_on.wait(DEADLINE_S)
        self.opened.append((device, rate_hz, channels))
        self.callback, self._begun_s, self._sent = callback, time.monotonic(), 0
        return SimpleNamespace(sample_rate_hz=float(rate_hz), is_converted=self.is_converted, close=self._close)

    def _close(self):
        if self.hangs_closing:
            self.go_on.wait(DEADLINE_S)
        self.closed += 1

    def play(self, frames, overflow=False):
        """Bring frames (n, channels) as a card does, a twentieth of a second after they sounded."""
        age_s = time.monotonic() - (self._begun_s + self._sent / RATE_HZ)
        self._sent += len(frames)
        times = SimpleNamespace(currentTime=7.0, inputBufferAdcTime=7.0 - max(age_s, 1e-3))
        self.callback(frames.tobytes(), len(frames), times, SimpleNamespace(input_overflow=overflow))


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    monkeypatch.setattr(audio_input, "RETRY_S", 0.05)


@pytest.fixture
def begun():
    """Makes inputs that are stopped at the end, whatever happens."""
    running = []

    def begin(system, on_block=lambda block: None, choice=None, **more):
        choice = choice or AudioChoice(MICROPHONE.name, RATE_HZ, 1)
        system_of = {"open_device": system.open, "devices": system.list, "source_of": lambda device: system.source}
        sound = AudioInput(choice, on_block, **system_of, **more)
        running.append((sound, system))
        sound.start()
        return sound

    yield begin
    for sound, system in running:
        system.go_on.set()
        assert sound.stop()


def block(value=1 << 20, frames=4_800, channels=1):
    return np.full((frames, channels), value, np.int32)


def test_blocks_come_from_the_worker_and_the_status_says_how_loud_they_are(begun):
    system, threads, blocks = Played(MICROPHONE), [], []

    def on_block(came):
        threads.append(threading.current_thread().name)
        blocks.append(came)

    sound = begun(system, on_block)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    assert sound.status().state is LinkState.WAITING  # open, but nothing has come
    for _ in range(20):
        system.play(block(1 << 30))
    wait_for(lambda: len(blocks) == 20, "the blocks")
    wait_for(lambda: sound.status().state is LinkState.LIVE, "the state")
    status = sound.status()
    assert set(threads) == {"sound"}
    assert (status.device, status.sample_rate_hz, status.channels) == (MICROPHONE.name, RATE_HZ, 1)
    assert (status.frames, status.lost_frames, status.overflows) == (96_000, 0, 0)
    assert status.peak_db[0] == pytest.approx(-6.02, abs=0.01)
    assert status.is_digital_silence  # a steady voltage carries no sound
    assert sound.fault is None


def test_a_device_that_is_not_there_is_told_and_taken_when_it_comes(begun):
    system = Played(INNER)
    sound = begun(system)
    wait_for(lambda: sound.fault is not None, "the reason")
    assert sound.fault.code is ErrorCode.SOUND_DEVICE_MISSING
    assert sound.status().state is LinkState.WAITING
    system.devices = (INNER, MICROPHONE)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block())
    wait_for(lambda: sound.status().state is LinkState.LIVE and sound.fault is None, "sound")


def test_a_device_that_refuses_says_why_and_is_tried_again(begun):
    system = Played(MICROPHONE)
    system.refuses = LeaklineError(ErrorCode.SOUND_DEVICE_REFUSED, name="x", rate_hz=1.0, channels=1.0, reason="in use")
    sound = begun(system)
    wait_for(lambda: sound.fault is system.refuses, "the reason")
    system.refuses = None
    wait_for(lambda: system.callback is not None, "the device to be opened")


def test_an_unplugged_device_is_lost_and_taken_again_by_its_name_in_another_socket(begun):
    system, blocks = Played(INNER, MICROPHONE), []
    sound = begun(system, blocks.append)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    time.sleep(0.1)
    for _ in range(5):
        system.play(block(frames=480))
    wait_for(lambda: sound.status().state is LinkState.LIVE, "sound")
    first, system.callback, system.devices = system.callback, None, (INNER,)
    first.on_finished()
    wait_for(lambda: sound.status().state is LinkState.LOST, "the loss")
    wait_for(lambda: sound.fault.code is ErrorCode.SOUND_DEVICE_MISSING, "the reason")
    assert system.closed == 1
    again = AudioDevice("Ball: Audio (hw:2,0)", "ALSA", 2, 48_000.0, 7)
    system.devices = (INNER, again)
    wait_for(lambda: system.callback is not None, "the device to be opened again")
    time.sleep(0.6)
    for _ in range(6):
        system.play(block())
    wait_for(lambda: len(blocks) == 11, "the sound after the gap")
    assert [device for device, _, _ in system.opened] == [MICROPHONE, again]
    (gap,) = [b for b in blocks if b.lost_before]
    ends_s = blocks[4].adc_host_s + 0.01
    assert gap.lost_before / RATE_HZ == pytest.approx(gap.adc_host_s - ends_s, abs=0.1)
    assert (gap.reason, sound.status().gaps) == ("sound_input_lost", 1)


def test_another_device_never_goes_on_in_place_of_a_default_one_that_went(begun):
    default = AudioDevice("Ball: Audio (hw:1,0)", "ALSA", 2, 48_000.0, 3, is_default=True)
    system = Played(default, AudioDevice(INNER.name, "ALSA", 2, 44_100.0, 1))
    sound = begun(system, choice=AudioChoice("default", RATE_HZ))
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block())
    first, system.callback, system.devices = system.callback, None, (INNER,)
    first.on_finished()
    wait_for(lambda: sound.fault and sound.fault.code is ErrorCode.SOUND_DEVICE_MISSING, "the reason")
    assert [device for device, _, _ in system.opened] == [default]


def test_a_device_that_falls_silent_is_lost_after_a_while(begun, monkeypatch):
    monkeypatch.setattr(audio_input, "SILENT_S", 0.2)
    monkeypatch.setattr(audio_input, "LOST_S", 1.0)
    system = Played(MICROPHONE)
    sound = begun(system)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block())
    wait_for(lambda: sound.status().state is LinkState.SILENT, "silence to be told")
    wait_for(lambda: system.closed == 1 and len(system.opened) == 2, "the device to be opened again")


def test_a_program_that_stood_still_itself_takes_no_device_for_lost(monkeypatch):
    monkeypatch.setattr(audio_input, "LOST_S", 1.2)
    monkeypatch.setattr(audio_input, "SOURCE_S", 0.0)
    system, looks = Played(MICROPHONE), []

    def source_of(device):
        looks.append(time.monotonic())
        time.sleep(1.5 if len(looks) == 2 else 0.0)  # the thread that watches stands still, as after a suspend

    sound = AudioInput(
        AudioChoice(MICROPHONE.name, RATE_HZ),
        lambda came: None,
        open_device=system.open,
        devices=system.list,
        source_of=source_of,
    )
    sound.start()
    try:
        wait_for(lambda: system.callback is not None, "the device to be opened")
        system.play(block())
        wait_for(lambda: len(looks) >= 3, "a look after the standstill")
        assert sound.status().state is LinkState.LIVE
        wait_for(lambda: len(system.opened) == 2, "the device, really silent now, to be opened again")
        assert time.monotonic() - looks[2] > 1.0
    finally:
        assert sound.stop()


def test_a_slow_taker_costs_what_is_beyond_the_queue_exactly_and_says_so(begun):
    system, blocks, may_go = Played(MICROPHONE), [], threading.Event()

    def on_block(came):
        may_go.wait(DEADLINE_S)
        blocks.append(came)

    sound = begun(system, on_block, queue_s=1.0)
    try:
        wait_for(lambda: system.callback is not None, "the device to be opened")
        for number in range(30):
            system.play(block(number))
        wait_for(lambda: sound.status().waiting_s > 0.5, "sound to wait")
    finally:
        may_go.set()
    wait_for(lambda: sound.status().waiting_s == 0.0, "the queue to be taken")
    for number in range(30, 35):
        system.play(block(number))
    wait_for(lambda: blocks and blocks[-1].frames[0, 0] == 34, "the last block")
    lost = sum(b.lost_before for b in blocks)
    assert 4_800 * 30 - lost <= 48_000 + 2 * 4_800 + 5 * 4_800  # no more waited than may wait
    assert sound.status().lost_frames == lost == 35 * 4_800 - sum(len(b.frames) for b in blocks)
    assert all(b.first_frame == 4_800 * b.frames[0, 0] for b in blocks)
    assert {b.reason for b in blocks if b.lost_before} == {"sound_behind"}


def test_overflows_are_counted(begun):
    system = Played(MICROPHONE)
    sound = begun(system)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block())
    system.play(block(), overflow=True)
    wait_for(lambda: sound.status().frames == 9_600, "the blocks")
    assert sound.status().overflows == 1


def test_a_taker_that_fails_does_not_end_the_stream(begun, caplog):
    system, seen = Played(MICROPHONE), []

    def on_block(came):
        seen.append(came)
        raise ValueError("a fault")

    begun(system, on_block)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block())
    system.play(block())
    wait_for(lambda: len(seen) == 2, "the second block")
    wait_for(lambda: "a fault" in caplog.text, "the log")


def test_the_callback_never_raises_into_the_sound_system(begun):
    system = Played(MICROPHONE)
    sound = begun(system)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.callback(None, 4_800, None, None)  # nothing of what it is promised
    system.play(block(5))
    wait_for(lambda: sound.status().lost_frames == 4_800, "the loss to be counted")


def test_stop_hands_over_what_came_before_it(begun):
    system, blocks = Played(MICROPHONE), []
    sound = begun(system, lambda came: (time.sleep(0.01), blocks.append(came)))
    wait_for(lambda: system.callback is not None, "the device to be opened")
    for _ in range(20):
        system.play(block())
    assert sound.stop()
    assert len(blocks) == 20
    assert sound.status().state is LinkState.ENDED


@pytest.mark.parametrize("what", ["hangs_opening", "hangs_closing"])
def test_stop_returns_in_time_when_the_system_hangs_and_says_so(begun, what):
    system = Played(MICROPHONE)
    setattr(system, what, True)
    sound = begun(system)
    if what == "hangs_closing":
        wait_for(lambda: system.callback is not None, "the device to be opened")
    begun_s = time.monotonic()
    assert not sound.stop(timeout_s=0.3)
    assert time.monotonic() - begun_s < 5.0
    assert sound.status().state is LinkState.ENDED


def test_an_input_that_was_never_started_stops_at_once():
    system = Played(MICROPHONE)
    assert AudioInput(AudioChoice(), lambda block: None, open_device=system.open, devices=system.list).stop()


def test_rate_and_channels_stay_what_they_were_at_the_first_opening(begun):
    system = Played(MICROPHONE)
    begun(system, choice=AudioChoice(MICROPHONE.name, 96_000, 2))
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block(channels=2))
    first, system.callback = system.callback, None
    first.on_finished()
    wait_for(lambda: system.callback is not None, "the device to be opened again")
    assert [form[1:] for form in system.opened] == [(96_000, 2)] * 2


def test_a_device_that_the_system_put_in_place_of_ours_is_not_recorded(begun, monkeypatch):
    monkeypatch.setattr(audio_input, "SOURCE_S", 0.05)
    system, blocks = Played(MICROPHONE), []
    system.source = Source("alsa_input.usb-Ball-00.mono", 48_000.0)
    sound = begun(system, blocks.append)
    wait_for(lambda: system.callback is not None, "the device to be opened")
    system.play(block(1))
    wait_for(lambda: sound.status().source, "the source to be known")
    assert sound.status().source_rate_hz == 48_000.0
    system.source = Source("alsa_input.pci-0000.analog-stereo", 44_100.0)
    first = system.callback
    wait_for(lambda: system.callback is not first, "the device to be opened again")
    assert sound.fault.code is ErrorCode.SOUND_DEVICE_SWAPPED
    assert sound.status().state is LinkState.LOST
    for _ in range(3):
        system.play(block(2))
    system.source = Source("alsa_input.usb-Ball-00.analog-stereo.2", 48_000.0)

    def heard():
        system.play(block(3, frames=480))
        return sound.status().state is LinkState.LIVE and sound.fault is None and len(blocks) > 5

    wait_for(heard, "the device to be heard again")
    assert {int(b.frames[0, 0]) for b in blocks} == {1, 3}


def test_a_stream_that_the_system_resamples_says_from_which_rate(begun):
    system = Played(INNER)
    system.is_converted = True
    sound = begun(system, choice=AudioChoice(INNER.name, RATE_HZ))
    wait_for(lambda: sound.status().source, "the source to be known")
    status = sound.status()
    assert (status.sample_rate_hz, status.source_rate_hz) == (48_000.0, 44_100.0)


@pytest.mark.parametrize("clock", [time.monotonic, time.time, time.perf_counter])
def test_an_age_is_counted_to_the_moment_of_the_callback_on_the_systems_own_clock(clock):
    current = clock() - 0.08  # the callback waited for the processor since
    now, age_s = digitised(current, current - 0.05)
    assert 0.13 <= age_s < DEADLINE_S
    assert now <= time.monotonic()


def test_an_age_on_a_clock_that_nobody_knows_is_the_systems_own():
    assert digitised(77.0, 76.9)[1] == pytest.approx(0.1)


def test_a_time_that_was_not_told_has_no_age():
    assert np.isnan(digitised(time.time(), 0.0)[1])
