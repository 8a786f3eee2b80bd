"""What a simulated ball truly sent, for whoever compares it with what was recorded.

``FILE`` holds a JSON object a line, in order of sending: first ``{"what": "start", …}``, then for each sample
``{"what": "row", "counter", "time_us", "host_s", "fate"}``, and for each fault ``{"what": "fault", "kind", "at_s",
"length_s", "host_s"}``; ``host_s`` is ``time.monotonic()``, one clock for all programs of a computer. Beside it
``FILE.lkf`` has the samples that went out for sure (once each, SI, host time as sent) as binary frames, and
``FILE.wav`` the sound that was played.
"""

import json
import threading
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import numpy.typing as npt
import soundfile

from app.devices.simulated.faults import Fate, Rows, taken
from app.devices.simulated.protocols import with_host_time
from app.devices.simulated.source import SoundArray
from processing.importing.frames import encode


class TruthFile:
    """Takes note of all that goes out; samples and sound may come from two threads."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._lock = threading.Lock()
        self._lines = path.open("w", encoding="utf-8")
        self._frames = path.with_name(path.name + ".lkf").open("wb")
        self._sound: Any = None

    def note(self, what: str, **values: str | float) -> None:
        """Write one line about something else than samples."""
        with self._lock:
            self._lines.write(json.dumps({"what": what, **values}) + "\n")
            self._lines.flush()

    def rows(self, rows: Rows, host_s: npt.NDArray[np.float64], fates: list[Fate]) -> None:
        """Write samples with when they were sent, and what became of them at last."""
        frames = rows.frames
        with self._lock:
            self._lines.writelines(
                f'{{"what": "row", "counter": {c}, "time_us": {t}, "host_s": {h:.6f}, "fate": "{fate}"}}\n'
                for c, t, h, fate in zip(frames.counter.tolist(), frames.time_us.tolist(), host_s.tolist(), fates)
            )
            sent = np.array([fate is Fate.SENT for fate in fates], np.bool_)
            if sent.any():
                self._frames.write(encode(with_host_time(taken(frames, sent), host_s[sent])))

    def sound(self, frames: SoundArray, rate_hz: int) -> None:
        """Write sound that was played."""
        with self._lock:
            if self._sound is None:
                path = str(self._path.with_name(self._path.name + ".wav"))
                self._sound = soundfile.SoundFile(path, "w", rate_hz, frames.shape[1], "FLOAT", format="RF64")
            self._sound.write(frames)

    def close(self) -> None:
        """End the files."""
        with self._lock:
            for file in (self._lines, self._frames, self._sound):
                if file is not None:
                    file.close()
            self._sound = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
