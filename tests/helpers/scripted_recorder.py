"""A recorder without devices for tests of the recording page: it does what it is told and remembers what was asked."""

import dataclasses
import threading
import time
from pathlib import Path

import numpy as np

from app.battery import Battery
from app.recording_parts import FoundDevices, RecordingKit
from processing.errors import ErrorCode, LeaklineError, Place
from processing.live.stream import (
    DiscStatus,
    LinkState,
    MotionBlock,
    MotionStatus,
    RecordingState,
    RecordingStatus,
    SoundBlock,
    SoundStatus,
)
from processing.survey import ImuSamples, TiePoint
from widgets.device_form import FoundPort, FoundSound

RATE_HZ, IMU_HZ = 8000, 100


class Feed:
    """Blocks that a test puts in."""

    def __init__(self):
        self.blocks, self.lock = [], threading.Lock()

    def add(self, *blocks):
        with self.lock:
            self.blocks.extend(blocks)

    def take(self):
        with self.lock:
            blocks, self.blocks = tuple(self.blocks), []
        return blocks


class ScriptedRecorder:
    """``asked`` lists the calls; ``change`` sets any field of the status."""

    def __init__(self, wish, folder=None):
        self.wish, self.asked, self.feed = wish, [], Feed()
        self.folder = folder or Path("/nowhere/Main-2026-11-22.leakline")
        self.points, self.threads, self.sheets = [], set(), []
        self.sound_fault = None
        self.fail_open = self.fail_begin = self.fail_mark = None
        self.now_s = time.monotonic
        self.current = RecordingStatus(
            sound=SoundStatus(
                LinkState.LIVE, "USB Mic", float(RATE_HZ), 1, rms_db=(-32.0,), peak_db=(-20.0,),
                held_peak_db=(-11.0,), clipped=(False,),
            ),
            motion=MotionStatus(LinkState.LIVE, "/dev/ttyUSB0", "frames", 400.0),
            disc=DiscStatus(50 << 30, 150_000.0, 40 * 3600.0),
        )  # fmt: skip

    def change(self, **values):
        self.current = dataclasses.replace(self.current, **values)

    def change_sound(self, **values):
        self.change(sound=dataclasses.replace(self.current.sound, **values))

    def change_motion(self, **values):
        self.change(motion=dataclasses.replace(self.current.motion, **values))

    def change_disc(self, **values):
        self.change(disc=dataclasses.replace(self.current.disc, **values))

    def _ask(self, what, fault=None):
        self.asked.append(what)
        self.threads.add(threading.current_thread())
        if fault is not None:
            raise fault

    def open(self):
        self._ask("open", self.fail_open)

    def begin(self, wish):
        self.wish = wish
        self._ask("begin", self.fail_begin)
        self.change(state=RecordingState.RECORDING, elapsed_s=0.0, folder=self.folder)
        return self.folder

    def mark(self, name, chainage_m=None, *, host_s=None):
        self._ask(("mark", name, chainage_m), self.fail_mark)
        self.points.append(TiePoint(name, round(host_s, 3), chainage_m))
        return self.points[-1]

    def amend(self, old, new):
        self._ask(("amend", old.name, new.name))
        self.points[self.points.index(old)] = new
        return new

    def unmark(self):
        self._ask("unmark")
        return self.points.pop() if self.points else None

    def keep_sheet(self, sheet):
        self._ask("keep_sheet")
        self.sheets.append(sheet)

    def clear_clip(self):
        self._ask("clear_clip")
        self.change_sound(clipped=(False,))

    def stop(self):
        self._ask("stop")
        if self.current.state is RecordingState.MONITORING:
            return None
        self.change(state=RecordingState.STOPPED)
        return self.folder

    def close(self):
        self._ask("close")

    def status(self):
        return self.current


class Laptop:
    """A kit without devices; ``recorders`` are all that were made, the newest last."""

    def __init__(self, folder=None):
        self.recorders, self.awake, self.searches = [], 0, 0
        self.folder = folder
        self.left = Battery(0.8, plugged=True)
        self.found = FoundDevices(
            (FoundSound("USB Mic", 1), FoundSound("Field recorder", 2)), (FoundPort("usb:0403:6015", "/dev/ttyUSB0"),)
        )
        self.refusal = None
        self.kit = RecordingKit(
            make_recorder=self._make, find_devices=self._find, battery=lambda: self.left, keep_awake=self._keep_awake
        )

    @property
    def recorder(self):
        return self.recorders[-1]

    def _make(self, wish):
        if self.refusal is not None:
            raise self.refusal
        self.recorders.append(ScriptedRecorder(wish, self.folder))
        return self.recorder

    def _find(self):
        self.searches += 1
        return self.found

    def _keep_awake(self):
        self.awake += 1

        def end():
            self.awake -= 1

        return end


def disc_full():
    return LeaklineError(ErrorCode.DISC_FULL, Place(Path("/media/stick")))


def sound_block(first_frame, count=800, channels=1, hertz=1000.0, lost_before=0):
    time_s = (first_frame + np.arange(count)) / RATE_HZ
    wave = (0.1 * 2**31 * np.sin(2 * np.pi * hertz * time_s)).astype(np.int32)
    return SoundBlock(np.repeat(wave[:, None], channels, axis=1), first_frame, time.monotonic(), lost_before)


def motion_block(first_s, count=10, rate_hz=IMU_HZ):
    time_s = first_s + np.arange(count) / rate_hz
    still = np.zeros((count, 3))
    force = np.broadcast_to([0.0, 0.0, 9.81], (count, 3))
    return MotionBlock(ImuSamples(time_s, force, still, np.ones(count, bool)), time.monotonic())
