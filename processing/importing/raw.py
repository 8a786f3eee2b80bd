"""What a reader hands to the doctor: rows as the file has them, on arrays of our own that may live in a file."""

import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Any

import numpy as np

from processing.importing.text_blocks import Faults
from processing.importing.units import AUTO
from processing.progress import Progress, silent
from processing.survey import Finding, FloatArray

SPILL_BYTES = 48 << 20


class GrowingArray:
    """Rows of ``width`` numbers (0: a plain vector), gathered block by block; beyond 48 MB they go to a scratch file.

    The file has no name any more where the system allows it, and vanishes with the last array that shows it.
    """

    def __init__(self, width: int, folder: Path | None = None) -> None:
        self._width = width
        self._folder = folder
        self._blocks: list[FloatArray] = []
        self._bytes = 0
        self._file: IO[bytes] | None = None

    def append(self, block: FloatArray) -> None:
        """Add rows: ``block`` (k, width), or (k,) for a vector."""
        block = np.ascontiguousarray(block, dtype=np.float64)
        self._bytes += block.nbytes
        if self._file is not None:
            self._file.write(block.data)
            return
        self._blocks.append(block)
        if self._bytes > SPILL_BYTES:
            self._file = tempfile.TemporaryFile(dir=self._folder)  # noqa: SIM115  # lives as long as the array
            for held in self._blocks:
                self._file.write(held.data)
            self._blocks = []

    def finish(self) -> FloatArray:
        """Return all rows as one writable array, (n, width) or (n,)."""
        rows = self._bytes // 8 // max(self._width, 1)
        shape: Any = (rows, self._width) if self._width else (rows,)
        if self._file is not None:
            self._file.flush()
            return np.memmap(self._file, dtype=np.float64, mode="r+", shape=shape)
        if not self._blocks:
            return np.empty(shape)
        joined = np.concatenate(self._blocks) if len(self._blocks) > 1 else self._blocks[0].copy()
        self._blocks = []
        return joined.reshape(shape)


@dataclass
class RawImu:
    """Rows in the order of the file, not yet examined; NaN where a cell was no number. Owned by whoever holds it.

    ``time`` is in seconds where ``time_unit`` is known, as written where it is ``auto``, and holds sample numbers where
    it is ``count``. ``acc`` and the others are in SI under the assumption of their declared unit, as written for
    ``auto``. With ``keep_origin`` the times are those of the contract and may not be moved.
    """

    time: FloatArray  # (n,)
    acc: FloatArray  # (n, 3)
    gyr: FloatArray  # (n, 3)
    mag: FloatArray | None = None  # (n, 3)
    quat: FloatArray | None = None  # (n, 4)
    pressure: FloatArray | None = None  # (n,)
    temperature: FloatArray | None = None  # (n,)
    counter: FloatArray | None = None  # (n,)
    time_unit: str = AUTO
    acc_unit: str = AUTO
    gyr_unit: str = AUTO
    mag_unit: str = AUTO
    sample_rate_hz: float | None = None
    keep_origin: bool = False
    faults: Faults = field(default_factory=Faults)
    findings: list[Finding] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)  # beside the file itself: siblings whose columns were merged in

    def __len__(self) -> int:
        return len(self.time)

    def arrays(self) -> dict[str, FloatArray]:
        """Return all arrays that exist, by name."""
        names = ("time", "acc", "gyr", "mag", "quat", "pressure", "temperature", "counter")
        return {n: getattr(self, n) for n in names if getattr(self, n) is not None}


@dataclass(frozen=True)
class ReadContext:
    """What every reader is given: where it may keep scratch files, how much it shall read, and who watches."""

    scratch: Path | None = None
    max_bytes: int | None = None  # read no more of each file: a preview
    sample_rate_hz: float | None = None  # told by the operator, for logs without times
    progress: Progress = field(default_factory=silent)
