"""What the operator chose in the import page, and how it is kept beside the recording."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from processing.importing.column_mapping import ColumnMapping
from processing.sound.pcm import RawForm


@dataclass(frozen=True)
class ImportOptions:
    """What the operator chose in the import page; all None is: find out.

    ``format`` is a name of :data:`processing.importing.registry.FORMATS`; ``mapping`` wins over it. ``mapping_store``
    is the file of remembered mappings. ``scratch`` is where arrays of long logs live; None is the temporary folder.
    """

    imu_file: Path | None = None
    format: str | None = None
    mapping: ColumnMapping | None = None
    sample_rate_hz: float | None = None
    audio_files: tuple[Path, ...] | None = None
    raw_form: RawForm | None = None
    mapping_store: Path | None = None
    scratch: Path | None = None

    def to_json(self) -> dict[str, Any]:
        """Return what goes with the recording as plain JSON data; of places on this computer only the log's name."""
        return {
            "imu_file": None if self.imu_file is None else self.imu_file.name,
            "format": self.format,
            "mapping": None if self.mapping is None else self.mapping.to_json(),
            "sample_rate_hz": self.sample_rate_hz,
            "raw_form": None if self.raw_form is None else asdict(self.raw_form),
        }

    @classmethod
    def from_json(cls, data: Mapping[str, Any] | None, folder: Path | None = None) -> "ImportOptions":
        """Return what :meth:`to_json` wrote, the log being in ``folder``, the defaults for None; raises ValueError."""
        if data is None:
            return cls()
        mapping, form, rate = data.get("mapping"), data.get("raw_form"), data.get("sample_rate_hz")
        log = data.get("imu_file")
        try:
            return cls(
                imu_file=None if log is None or folder is None else folder / Path(str(log)).name,
                format=data.get("format"),
                mapping=None if mapping is None else ColumnMapping.from_json(mapping),
                sample_rate_hz=None if rate is None else float(rate),
                raw_form=None if form is None else RawForm(**form),
            )
        except TypeError as fault:
            raise ValueError("no import options") from fault
