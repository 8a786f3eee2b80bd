"""What is to be recorded, from which devices and to which folder: told before the recorder opens anything."""

from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path

from app.devices.audio_spec import AudioChoice
from app.devices.imu_spec import ImuChoice
from processing.storage.creating import SUFFIX
from processing.survey import Survey

PART_S = 3600.0


@dataclass(frozen=True)
class RecordingPlan:
    """``target`` is where the folder is made: see :func:`writer_target`. None for a device: it is not recorded.

    ``part_s`` is how long a file lasts, ``planned_s`` how long the recording shall (0: nobody said), for the warning
    that the disc will not take it.
    """

    survey: Survey
    target: Path
    sound: AudioChoice | None = None
    motion: ImuChoice | None = None
    part_s: float = PART_S
    planned_s: float = 0.0
    operator: str = ""


def dated(survey: Survey, target: Path, today: str | None = None) -> Survey:
    """Return the survey with today's date and, where nobody gave it a name, the name of its folder."""
    info = survey.info
    if not info.date:
        info = replace(info, date=today or datetime.now().astimezone().date().isoformat())
    if not info.name and not (target.is_dir() and target.suffix != SUFFIX):
        info = replace(info, name=target.name.removesuffix(SUFFIX))
    return replace(survey, info=info)


def writer_target(target: Path) -> Path:
    """Return where the writer makes its folder: what is there is never written over, a taken name gets ``-2``.

    A name that ends in ``.leakline`` is the folder itself; in an existing directory one is made that is called after
    the survey and its date; any other name gets the ending.
    """
    if target.suffix == SUFFIX or target.is_dir():
        return target
    return target.with_name(target.name + SUFFIX)
