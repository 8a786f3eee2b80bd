"""Builds :class:`~processing.importing.frames.Frames` from columns that a decoder has found."""

import numpy as np
import numpy.typing as npt

from processing.importing.frames import Frames
from processing.survey import FloatArray

LATEST_S = 1e12  # a device's time beyond this is damage; it still counts as microseconds in 64 bits
_COUNTERS = 1 << 32


def usable_time(time_s: FloatArray) -> npt.NDArray[np.bool_]:
    """Return of (n,) times in seconds which can be written as a frame's microseconds."""
    with np.errstate(invalid="ignore"):
        return np.isfinite(time_s) & (time_s >= 0.0) & (time_s < LATEST_S)


def frames_of(
    time_s: FloatArray,
    acc_s_mps2: FloatArray,
    gyr_s_radps: FloatArray,
    counter: npt.NDArray[np.int64],
    *,
    mag_s_ut: FloatArray | None = None,
    quat_ws: FloatArray | None = None,
    pressure_kpa: FloatArray | None = None,
    temperature_c: FloatArray | None = None,
) -> Frames:
    """Return ``n`` samples; ``time_s`` (n,) must be usable, ``counter`` (n,) is taken modulo 2³², no ``host_s``."""
    n = len(time_s)
    return Frames(
        counter=(counter % _COUNTERS).astype(np.uint32),
        time_us=np.rint(1e6 * time_s).astype(np.uint64),
        acc_s_mps2=_single(acc_s_mps2, (n, 3)),
        gyr_s_radps=_single(gyr_s_radps, (n, 3)),
        mag_s_ut=_single(mag_s_ut, (n, 3)),
        pressure_kpa=_single(pressure_kpa, (n,)),
        temperature_c=_single(temperature_c, (n,)),
        quat_ws=_single(quat_ws, (n, 4)),
        host_s=np.full(n, np.nan),
    )


def _single(values: FloatArray | None, shape: tuple[int, ...]) -> npt.NDArray[np.float32]:
    return np.full(shape, np.nan, np.float32) if values is None else np.asarray(values, np.float32)
