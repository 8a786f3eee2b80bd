"""What the window draws of a running recording: plain facts, each a copy of its own that may go to another thread."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from processing.survey import BoolArray, FloatArray

STRIP_CHANNELS = (
    "acc_x_mps2",
    "acc_y_mps2",
    "acc_z_mps2",
    "acc_norm_mps2",
    "gyr_x_radps",
    "gyr_y_radps",
    "gyr_z_radps",
    "gyr_norm_radps",
    "pressure_kpa",
)

Bytes = npt.NDArray[np.uint8]
Float32Array = npt.NDArray[np.float32]


@dataclass(frozen=True)
class SpectrumColumns:
    """Columns ``first`` … ``first + k − 1`` of a running picture.

    Column j covers ``j·column_s`` to ``(j + 1)·column_s`` of the audio clock.

    ``tiles`` are steps of 0.5 dB above −130 dBFS (:func:`processing.sound.tile_values.tile_db`), the maximum of the
    column's windows. ``is_gap`` marks columns in which sound is missing.
    """

    first: int
    tiles: Bytes  # (k, bins)
    levels_db: Float32Array  # (k, b) dBFS of the bands
    is_gap: BoolArray  # (k,)
    host_s: FloatArray  # (k,) when the column's last sample was digitised, host time
    column_s: float
    capacity: int  # columns that are kept
    frequency_hz: FloatArray  # (bins,) centres of the rows
    bands_hz: FloatArray  # (b, 2) the last is the chosen band


@dataclass(frozen=True)
class StripBins:
    """Bins ``first`` … ``first + k − 1``; bin j covers ``j·bin_s`` to ``(j + 1)·bin_s`` of survey time.

    ``low`` and ``high`` (k, 9) follow :data:`STRIP_CHANNELS`; NaN where no trusted sample fell into the bin.
    The last bin is still growing: draw it anew from the next look.
    """

    first: int
    low: Float32Array  # (k, 9)
    high: Float32Array  # (k, 9)
    bin_s: float
    capacity: int  # bins that are kept


@dataclass(frozen=True)
class LivePose:
    """Where the device is at ``survey_s``; sigmas are 1 sigma, ±1.96 of them hold 95 %.

    ``heading_deg`` is the direction of travel, clockwise from north as far as ``heading_basis`` knows north (launch |
    magnetometer | device | route | tie_points | unknown); None until it has moved. ``position_w_m`` is east, north, up
    from the launch. ``in_gap`` after samples were missing, until half a second has been seen again.
    """

    survey_s: float
    q_ws: tuple[float, float, float, float]
    heading_deg: float | None
    position_w_m: tuple[float, float, float]
    chainage_m: float
    sigma_along_m: float
    sigma_cross_m: float
    speed_mps: float
    is_still: bool
    is_calibrated: bool = False
    heading_basis: str = "unknown"
    in_gap: bool = False


@dataclass(frozen=True)
class LivePolyline:
    """The way so far for drawing: k ≤ some thousands of points; a new ``version`` replaces the one before."""

    version: int
    time_s: FloatArray  # (k,)
    position_w_m: FloatArray  # (k, 3)
    chainage_m: FloatArray  # (k,)
    sigma_along_m: FloatArray  # (k,)
    gaps_s: tuple[tuple[float, float], ...] = ()  # survey time


@dataclass(frozen=True)
class LivePicture:
    """What is new. Rows of ``sound`` and ``strips`` carry running numbers: write each where it belongs.

    ``sound_host_s`` is when the newest sample of the newest column was digitised, ``motion_host_s`` when the newest
    sample in strips and pose arrived; the delay to the screen counts from there.
    """

    sound: SpectrumColumns | None = None  # None while no sound has come
    strips: StripBins | None = None
    pose: LivePose | None = None
    path: LivePolyline | None = None  # None: as in the picture before
    sound_host_s: float | None = None
    motion_host_s: float | None = None
    motion_survey_s: float | None = None  # survey time of the newest sample
    path_version: int = 0
    epoch: int = 0  # another one: forget all that was drawn, numbers count anew
