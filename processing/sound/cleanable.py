"""Says whether a run can be cleaned of its rolling at all, without importing what would do it."""

from enum import StrEnum
from typing import TYPE_CHECKING

from processing.survey import Motion

if TYPE_CHECKING:
    from processing.results import Results

_FEWEST_ROWS = 3  # of a motion record that has a rate


class NotCleaned(StrEnum):
    """Why there is nothing to clean with; also keys of [reasons]."""

    NO_SOUND = "cleaning_no_sound"
    NO_IMU = "cleaning_no_imu"
    NOT_ROLLING = "cleaning_not_rolling"
    NOT_HEARD = "cleaning_not_heard"


def why_not_cleaned(results: "Results") -> NotCleaned | None:
    """Return why this run cannot be cleaned, as far as that is known without listening; None where it may be."""
    if results.recording.audio is None or results.scan is None:
        return NotCleaned.NO_SOUND
    imu = results.recording.imu
    if imu is None or len(imu.time_s) < _FEWEST_ROWS:
        return NotCleaned.NO_IMU
    return None if results.survey.device.motion is Motion.ROLLING else NotCleaned.NOT_ROLLING
