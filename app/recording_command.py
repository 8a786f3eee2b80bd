"""``leakline record``: the window's recorder without the window; time, Ctrl+C and SIGTERM all end it cleanly.

The main thread only waits, says what happened, and passes on what is typed; devices and disc have threads of their own.
"""

import argparse
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from types import FrameType

from app.devices.audio_spec import parse_audio_spec
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Recorder
from app.devices.recording_plan import RecordingPlan
from app.keep_awake import keep_awake
from app.recording_check import SpokenCheck
from app.recording_terminal import Terminal
from processing import messages
from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.importing.survey_toml import apply_override, read_survey_toml
from processing.live.stream import LinkState, RecordingState, RecordingStatus
from processing.settings import Settings
from processing.survey import AudioInfo, Survey

_LOOK_EVERY_S = 0.1
_STATUS_EVERY_S = 1.0
TAKE_BACK = "-"  # typed instead of a name
_TOLD = {"name": "survey.name", "diameter": "pipe.diameter_m", "radius": "device.radius_m", "motion": "device.motion"}


def record(words: argparse.Namespace) -> int:
    """Record as the words say and return the exit status.

    Raises:
        LeaklineError: bad specs, a device that is not there, a disc that takes nothing.
        Cancelled: stopped before anything was recorded.
    """
    terminal = Terminal(words.language)
    if words.list:
        terminal.list_devices()
        return 0
    plan = plan_of(words)
    # leaving the recorder brings a recording to its end, whatever went wrong out here
    with _stopping() as stopper, _awake(), Recorder(plan, is_shown=words.check) as recorder:
        recorder.open()
        _wait(recorder, plan, words.wait, stopper, terminal)
        folder = recorder.start()
        terminal.begin(folder)
        check = SpokenCheck(recorder, plan, terminal) if words.check else None
        _watch(recorder, terminal, words.seconds, stopper, check)
        recorder.stop()
        terminal.done(recorder.status(), folder)
        if recorder.fault is not None:
            raise recorder.fault
    return 0


def plan_of(words: argparse.Namespace) -> RecordingPlan:
    """Return the plan that the words mean; raises LeaklineError for words that mean nothing."""
    motion = parse_imu_spec(words.imu) if words.imu else None
    motion = None if motion is None or motion.kind == "none" else motion
    sound = parse_audio_spec(words.audio) if words.audio else None
    if motion is None and sound is None:
        raise LeaklineError(ErrorCode.RECORDING_NOTHING_CHOSEN)
    if words.out is None:
        raise LeaklineError(ErrorCode.KEY_MISSING, name="--out")
    survey = read_survey_toml(words.survey) if words.survey else Survey()
    # moments and clocks that it tells are of another run
    survey = replace(survey, tie_points=(), audio=AudioInfo(channel=survey.audio.channel))
    for word, key in _TOLD.items():
        if (value := getattr(words, word)) is not None:
            survey, _ = apply_override(survey, Settings(), f"{key}={value}")
    return RecordingPlan(
        survey,
        words.out,
        sound,
        motion,
        part_s=60.0 * words.part_minutes,
        planned_s=words.seconds or 0.0,
        operator=survey.info.operator,
    )


class Stopper:
    """Whether somebody asked to stop. A plain flag: a handler that took a lock could wait for itself for ever."""

    def __init__(self) -> None:
        self.asked = False

    def __call__(self, _signal: int, _frame: FrameType | None) -> None:
        """Take a signal."""
        self.asked = True


@contextmanager
def _stopping() -> Iterator[Stopper]:
    """Take the signals that end a program as the wish to stop, as long as it lasts."""
    stopper = Stopper()
    if threading.current_thread() is not threading.main_thread():  # Python gives signals to no other
        yield stopper
        return
    before = {}
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK"):  # a closed terminal ends a recording as well as it can
        number = getattr(signal, name, None)
        # what was to be ignored stays so: under nohup a closed terminal shall not end it
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:
            before[number] = signal.signal(number, stopper)
    if hasattr(signal, "SIGTTIN"):  # put into the background it would be halted when it looks at what is typed
        before[signal.SIGTTIN] = signal.signal(signal.SIGTTIN, signal.SIG_IGN)
    try:
        yield stopper
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def _awake() -> Iterator[None]:
    end = keep_awake()
    try:
        yield
    finally:
        end()


def _wait(recorder: Recorder, plan: RecordingPlan, patience_s: float, stopper: Stopper, terminal: Terminal) -> None:
    """Return when every chosen device is alive; raises LeaklineError when one is not in time, Cancelled on a signal."""
    until = time.monotonic() + patience_s
    terminal.say("record_waiting")
    while True:
        status = recorder.status()
        has_motion = plan.motion is None or status.motion.state is LinkState.LIVE
        has_sound = plan.sound is None or status.sound.state is LinkState.LIVE
        if has_motion and has_sound:
            return
        if stopper.asked:
            raise Cancelled
        terminal.tell(status)
        if time.monotonic() >= until:
            raise _missing(recorder, plan, status, terminal.language, patience_s)
        time.sleep(_LOOK_EVERY_S)


def _missing(
    recorder: Recorder, plan: RecordingPlan, status: RecordingStatus, language: str, patience_s: float
) -> LeaklineError:
    """Return what to say of the device that is not there."""
    if plan.motion is not None and status.motion.state is not LinkState.LIVE:
        motion = status.motion
        why = messages.text("states", motion.state.value, language)
        if motion.reason:
            why = messages.text("reasons", motion.reason, language)
        device = str(plan.motion)
    else:
        if recorder.sound_fault is not None:
            return recorder.sound_fault
        why = messages.text("states", status.sound.state.value, language)
        device = str(plan.sound)
    return LeaklineError(ErrorCode.DEVICE_MISSING, device=device, seconds=patience_s, reason=why)


def _watch(
    recorder: Recorder, terminal: Terminal, seconds: float | None, stopper: Stopper, check: SpokenCheck | None
) -> None:
    """Return when the recording shall end, or has ended by itself."""
    shown_s = 0.0
    while not stopper.asked:
        status = recorder.status()
        terminal.tell(status)
        if status.state is not RecordingState.RECORDING or (seconds is not None and status.elapsed_s >= seconds):
            return
        for line in terminal.typed():
            _mark(recorder, terminal, line)
        if check is not None and not check.look():
            check = None
        if time.monotonic() - shown_s >= _STATUS_EVERY_S:
            shown_s = time.monotonic()
            terminal.show(status)
        left_s = _LOOK_EVERY_S if seconds is None else seconds - status.elapsed_s
        time.sleep(max(0.0, min(_LOOK_EVERY_S, left_s)))


def _mark(recorder: Recorder, terminal: Terminal, line: str) -> None:
    """Do what a typed line means: a marker of this name, or the last one taken back."""
    try:
        if line == TAKE_BACK:
            gone = recorder.unmark()
            if gone is not None:
                terminal.say("record_unmarked", name=gone.name)
            return
        number = len(recorder.marks) + 1
        point = recorder.mark(line or messages.text("cli", "record_mark_name", terminal.language, number=number))
    except LeaklineError as error:
        if error.code is not ErrorCode.RECORDING_NOT_RUNNING:  # it has just ended by itself, and says so
            raise
    else:
        terminal.say("record_marked", name=point.name, time_s=point.time_s)
