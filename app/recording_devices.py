"""The real devices behind the recording page: what is plugged in, and the recorder made for what was chosen."""

from dataclasses import replace
from pathlib import Path

from app.devices.audio_devices import list_inputs
from app.devices.audio_spec import AudioChoice
from app.devices.imu_spec import ImuChoice, list_serial_ports
from app.devices.recorder import Recorder
from app.devices.recording_plan import RecordingPlan
from app.recording_parts import FoundDevices, RecorderLike, RecordingWish
from processing.errors import LeaklineError
from processing.storage.files import writing
from widgets.device_form import NONE, FoundPort, FoundSound, MotionWish, SoundWish


def find_devices() -> FoundDevices:
    """Look for sound inputs and serial ports; a missing sound library leaves the ports."""
    ports = tuple(FoundPort(port.name, _title(port.device, port.title)) for port in list_serial_ports())
    try:
        inputs = list_inputs()
    except LeaklineError as error:
        return FoundDevices((), ports, error)
    return FoundDevices(tuple(FoundSound(device.name, device.channels) for device in inputs), ports)


class PageRecorder(Recorder):
    """A recorder that begins with what stands on the page then; its devices run on."""

    def begin(self, wish: RecordingWish) -> Path:
        """Begin to write and return the folder; raises LeaklineError."""
        with writing(wish.folder):
            wish.folder.mkdir(parents=True, exist_ok=True)
        operator = wish.survey.info.operator
        self.plan = replace(self.plan, planned_s=wish.planned_s, operator=operator)
        return self.start(wish.survey, wish.folder)


def make_recorder(wish: RecordingWish) -> RecorderLike:
    """Return a recorder of the chosen devices; nothing is opened yet."""
    sound, motion = sound_choice(wish.sound), imu_choice(wish.motion)
    return PageRecorder(RecordingPlan(wish.survey, wish.folder, sound, motion, planned_s=wish.planned_s))


def sound_choice(wish: SoundWish) -> AudioChoice | None:
    """Return what the page's choice means."""
    return None if wish.name == NONE else AudioChoice(wish.name, wish.rate_hz, wish.channels)


def imu_choice(wish: MotionWish) -> ImuChoice | None:
    """Return what the page's choice means."""
    if wish.kind == NONE:
        return None
    return ImuChoice(wish.kind, wish.address, wish.port, wish.baud, wish.protocol)


def _title(device: str, title: str) -> str:
    return f"{device}: {title}" if title else device
