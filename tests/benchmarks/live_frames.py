"""What the recording page costs while it runs: time of a frame on the window's thread, delay from sample to screen.

    python tests/benchmarks/live_frames.py [SECONDS] [--size 1366x768] [--imu 1000] [--sound 96000] [--channels 2]

A thread stands in for the devices: blocks of 20 ms of noise and of a rolling ball's motion go into the feed of a
scripted recorder in real time; the page, its worker and all views are the real ones, drawn offscreen. A frame is taking
a picture, handing it to the views, and painting them; its cost is CPU time of the window's thread. The delay runs from
the newest sample of a block to the end of the painting that shows it; real devices add the length of their own blocks.
"""

import argparse
import os
import sys
import tempfile
import threading
import time
from pathlib import Path

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "helpers"))

import numpy as np
from PySide6.QtCore import QEvent, QTimer
from PySide6.QtWidgets import QApplication
from scripted_recorder import Laptop

from app import appearance
from app.recording_control import RecordingControl
from app.recording_page import RecordingPage
from app.settings import PreferencesStore
from processing.live.stream import MotionBlock, SoundBlock
from processing.survey import ImuSamples
from widgets.device_form import MotionWish, SoundWish
from widgets.plot_theme import THEMES

BLOCK_S = 0.02


class Devices(threading.Thread):
    """Puts blocks into a feed at the pace of the wall clock."""

    def __init__(self, feed, imu_hz, sound_hz, channels):
        super().__init__(name="devices", daemon=True)
        self.feed, self.end = feed, threading.Event()
        self.imu_hz, self.sound_hz = imu_hz, sound_hz
        random = np.random.default_rng(5)
        self.noise = (random.normal(0, 0.05, (4 * sound_hz, channels)) * 2**31).astype(np.int32)

    def run(self):
        begun, number = time.monotonic(), 0
        frames, rows = round(BLOCK_S * self.sound_hz), round(BLOCK_S * self.imu_hz)
        while not self.end.wait(max(0.0, begun + (number + 1) * BLOCK_S - time.monotonic())):
            first = number * frames
            at = first % (len(self.noise) - frames)
            now = time.monotonic()
            self.feed.add(
                SoundBlock(self.noise[at : at + frames], first, now - BLOCK_S),
                MotionBlock(rolling(number * BLOCK_S + np.arange(rows) / self.imu_hz), now),
            )
            number += 1


def rolling(time_s):
    """Return samples of a ball that rests for five seconds and then rolls two turns a second about its y axis."""
    turning = np.clip(time_s - 5.0, 0.0, None)
    angle = 4.0 * np.pi * turning
    rate = np.where(turning > 0.0, 4.0 * np.pi, 0.0)
    zero = np.zeros_like(time_s)
    jitter = np.random.default_rng(int(1000 * time_s[0])).normal(0.0, 0.02, (len(time_s), 3))
    force = 9.81 * np.column_stack([-np.sin(angle), zero, np.cos(angle)]) + jitter
    gyro = np.column_stack([zero, rate, zero]) + 0.1 * jitter
    return ImuSamples(time_s, force, gyro, np.ones(len(time_s), bool))


def main():
    words = argparse.ArgumentParser()
    words.add_argument("seconds", nargs="?", type=float, default=30.0)
    words.add_argument("--size", default="1366x768")
    words.add_argument("--imu", type=int, default=1000)
    words.add_argument("--sound", type=int, default=96_000)
    words.add_argument("--channels", type=int, default=2)
    words.add_argument("--theme", default="light", choices=sorted(THEMES))
    told = words.parse_args()
    qt = QApplication(sys.argv[:1])
    theme = THEMES[told.theme]
    appearance.apply_theme(qt, theme)
    laptop = Laptop()
    page = RecordingPage(theme, "en")
    width, height = (int(part) for part in told.size.split("x"))
    page.resize(width - 110, height - 60)
    with tempfile.TemporaryDirectory() as folder:
        control = RecordingControl(page, PreferencesStore(Path(folder) / "p.json"), laptop.kit, page)
        page.devices.set_wishes(SoundWish("USB Mic", told.sound, told.channels), MotionWish("serial", "usb:0403:6015"))
        page.show()
        control.enter()
        while not laptop.recorders or control._worker is None:
            qt.processEvents()
        laptop.recorder.change_sound(sample_rate_hz=float(told.sound), channels=told.channels)
        laptop.recorder.change_motion(rate_hz=float(told.imu))
        measure(qt, page, control, laptop.recorder, told)
        control.shut()
    return 0


def measure(qt, page, control, recorder, told):
    cost, sound_delay, motion_delay, at = [], [], [], []
    show = page.show_picture

    def timed(picture):
        begun = time.thread_time()
        show(picture)
        qt.sendPostedEvents(page, QEvent.Type.UpdateRequest.value)  # paint what is due, each widget once
        cost.append(1e3 * (time.thread_time() - begun))
        now = time.monotonic()
        at.append(now)
        if picture.sound_host_s is not None and picture.sound is not None and len(picture.sound.tiles):
            sound_delay.append(1e3 * (now - picture.sound_host_s))
        if picture.motion_host_s is not None:
            motion_delay.append(1e3 * (now - picture.motion_host_s))

    page.show_picture = timed
    devices = Devices(recorder.feed, told.imu, told.sound, told.channels)
    QTimer.singleShot(round(1000 * told.seconds), qt.quit)
    wall, window, process = time.monotonic(), time.thread_time(), time.process_time()
    devices.start()
    qt.exec()
    devices.end.set()
    devices.join(2.0)
    wall = time.monotonic() - wall
    window, process = time.thread_time() - window, time.process_time() - process
    print(f"{told.imu} Hz IMU, {told.channels} x {told.sound} Hz sound, {told.size}, {told.theme}, {wall:.0f} s")
    print(f"  frames               {len(cost)} ({len(cost) / wall:.1f} a second)")
    for name, values in (
        ("cost of a frame (ms)", cost),
        ("between frames (ms)", 1e3 * np.diff(at)),
        ("delay of sound (ms)", sound_delay),
        ("delay of motion (ms)", motion_delay),
    ):
        p50, p95, most = np.percentile(values, [50, 95, 100])
        print(f"  {name:20} p50 {p50:.1f}   p95 {p95:.1f}   most {most:.1f}")
    print(
        f"  CPU: window's thread {100 * window / wall:.1f} %, all threads, stand-in too, {100 * process / wall:.1f} %"
    )


if __name__ == "__main__":
    sys.exit(main())
