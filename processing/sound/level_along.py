"""The level of the chosen band along the pipe, with its background and the level that would stand out."""

from dataclasses import dataclass

import numpy as np

from processing.settings import DetectorSettings
from processing.sound.background import robust_sigma, running_median
from processing.sound.cells import CELL_M, DB_PER_LN, Cells
from processing.survey import FloatArray

THRESHOLD_SIGMAS = 4.0


@dataclass(frozen=True)
class LevelAlong:
    """Cells of a quarter metre, ascending; levels in dBFS, NaN where the sound was not heard."""

    chainage_m: FloatArray  # (n,)
    time_s: FloatArray  # (n,) survey time at which the device was there
    level_db: FloatArray  # (n,) of the chosen band
    background_db: FloatArray  # (n,) running median in metres
    threshold_db: FloatArray  # (n,) a level above it stands out of the background's own scatter
    band_hz: tuple[float, float]


def level_along(cells: Cells, band_hz: tuple[float, float], settings: DetectorSettings) -> LevelAlong:
    """Return the level of the chosen band, the last of the cells' bands, along the pipe."""
    level = cells.log_power[:, -1] * DB_PER_LN
    background = running_median(level, max(1, round(settings.background_m / CELL_M)))
    scatter = robust_sigma(level - background)
    return LevelAlong(
        chainage_m=cells.chainage_m,
        time_s=cells.time_s,
        level_db=level,
        background_db=background,
        threshold_db=np.asarray(background + THRESHOLD_SIGMAS * scatter, np.float64),
        band_hz=band_hz,
    )
