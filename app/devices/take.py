"""One recording under way, as the recorder knows it."""

import threading
import time
from dataclasses import dataclass

from processing.storage.recording_writer import RecordingWriter
from processing.survey import TiePoint


@dataclass(frozen=True)
class Mark:
    """A marker, and when it was set: survey time may be known better, or at all, only later."""

    point: TiePoint
    told: TiePoint  # as it was when it was set
    host_s: float
    is_on_motion: bool  # its time is that of the IMU's clock, which all others give way to


class Take:
    """One recording under way."""

    def __init__(self, writer: RecordingWriter) -> None:
        self.writer = writer
        self.began_s = time.monotonic()
        self.ended_s: float | None = None
        self.marks: list[Mark] = []
        self.clock_due_s = self.began_s + 2.0
        self.is_plan_told = False
        self.done = threading.Event()
