"""What the recording page needs of the rest, as few words as possible: so that tests can stand in for every device."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Protocol

from app.battery import Battery, battery
from app.keep_awake import keep_awake
from processing.errors import LeaklineError
from processing.live.check_sheet import CheckSheet
from processing.live.stream import MotionBlock, RecordingStatus, SoundBlock
from processing.survey import Survey, TiePoint
from widgets.device_form import NONE, FoundPort, FoundSound, MotionWish, SoundWish

if TYPE_CHECKING:
    from processing.live.picture import LivePicture

Block = SoundBlock | MotionBlock

SPAN_S = 36.0  # what the live views show: a column of 50 ms is a pixel of a small laptop, so that none is passed over


@dataclass(frozen=True)
class RecordingWish:
    """What the operator wants recorded, from which devices, into which folder; ``planned_s`` 0: nobody said."""

    survey: Survey
    folder: Path
    sound: SoundWish
    motion: MotionWish
    planned_s: float = 0.0

    @property
    def is_empty(self) -> bool:
        """Whether no device was chosen."""
        return self.sound.name == NONE and self.motion.kind == NONE


class Feed(Protocol):
    """Blocks for the live views."""

    def take(self) -> tuple[Block, ...]:
        """Return what came since the last call."""


class RecorderLike(Protocol):
    """:class:`app.devices.recorder.Recorder`, as far as the page uses it; every call may be made from any thread."""

    @property
    def feed(self) -> Feed:
        """Blocks for the live views."""

    def open(self) -> None:
        """Let the devices run; nothing is written."""

    def begin(self, wish: RecordingWish) -> Path:
        """Begin to write what the form says now, and return the folder; raises LeaklineError."""

    def mark(self, name: str, chainage_m: float | None = None, *, host_s: float | None = None) -> TiePoint:
        """Store a tie point at a moment of host time, or now; raises LeaklineError."""

    def amend(self, old: TiePoint, new: TiePoint | None) -> TiePoint | None:
        """Put another tie point in the place of a stored one and return what is kept; raises LeaklineError."""

    def unmark(self) -> TiePoint | None:
        """Take the last tie point back; raises LeaklineError."""

    def keep_sheet(self, sheet: CheckSheet) -> None:
        """Keep the sheet of a check with the recording under way."""

    def clear_clip(self) -> None:
        """Put out the clip light."""

    def stop(self) -> Path | None:
        """End the recording and return its folder, None where nothing was recorded."""

    def close(self) -> None:
        """Let the devices go."""

    def status(self) -> RecordingStatus:
        """Return how everything is."""

    @property
    def sound_fault(self) -> LeaklineError | None:
        """Why there is no sound now."""


class ViewLike(Protocol):
    """:class:`processing.live.live_view.LiveView`, as far as the live worker uses it."""

    def add(self, block: Block) -> None:
        """Take a block."""

    def picture(self, after: "LivePicture | None" = None) -> "LivePicture":
        """Return what is new since the picture that was drawn last."""

    def set_sample_rate(self, sample_rate_hz: float) -> None:
        """Tell the rate of the sound."""

    def set_tie_points(self, ties: tuple[TiePoint, ...]) -> None:
        """Lay the path through these."""

    def restart_path(self) -> None:
        """Forget path and strips: the recording begins."""


@dataclass(frozen=True)
class FoundDevices:
    """What is plugged in; ``trouble`` says why one of the searches failed."""

    sounds: tuple[FoundSound, ...] = ()
    ports: tuple[FoundPort, ...] = ()
    trouble: LeaklineError | None = None


def find_devices() -> FoundDevices:
    """Look for sound inputs and serial ports."""
    from app.recording_devices import find_devices as find

    return find()


def make_recorder(wish: RecordingWish) -> RecorderLike:
    """Return a recorder of the real devices; raises LeaklineError where the choices cannot be understood."""
    from app.recording_devices import make_recorder as make

    return make(wish)


def make_view(survey: Survey) -> ViewLike:
    """Return the view of a run."""
    from processing.live.live_view import LiveView

    return LiveView(survey, sound_span_s=SPAN_S, strip_span_s=SPAN_S)


@dataclass(frozen=True)
class RecordingKit:
    """Everything outside the page, replaceable one by one."""

    make_recorder: Callable[[RecordingWish], RecorderLike] = make_recorder
    make_view: Callable[[Survey], ViewLike] = make_view
    find_devices: Callable[[], FoundDevices] = find_devices
    battery: Callable[[], Battery | None] = battery
    keep_awake: Callable[[], Callable[[], None]] = keep_awake
