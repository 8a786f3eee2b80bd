"""What the recording itself says of the place, as plain data: the factors that the fit weighs beside the tie points.

The modules that find such evidence (bends against the route, joints, pressure, slip) know nothing of the fit, and the
fit knows nothing of them: it takes each piece by its sigma, lets go of pieces that all else contradicts, and says so.
Times are survey seconds. Lengths are along the pipe.
"""

from dataclasses import dataclass

from processing.survey import Finding, FloatArray


@dataclass(frozen=True)
class ChainageFix:
    """The device was at ``chainage_m`` ± ``sigma_m`` (1 sigma) at ``time_s``; ``source`` names who says so (bend).

    ``shared_sigma_m`` is the 1-sigma of one unknown offset that all fixes of the same ``source`` share (a map that is
    shifted as a whole), on top of ``sigma_m``, which is each fix's own.
    """

    time_s: float
    chainage_m: float
    sigma_m: float
    source: str
    shared_sigma_m: float = 0.0


@dataclass(frozen=True)
class ChainageIncrement:
    """Between two moments the device went ``length_m`` ± ``sigma_m`` along the pipe (from joint to joint).

    ``scale_sigma`` is the 1-sigma of one unknown factor that all increments of the same ``source`` share: 0 where the
    length itself is known, 0.01 where pipes are told as 6 m and may all be 6.05 m.
    """

    start_s: float
    end_s: float
    length_m: float
    sigma_m: float
    source: str
    scale_sigma: float = 0.0


@dataclass(frozen=True)
class HeightSeries:
    """Heights (k,) above the launch at times (k,), from pressure: k rows, time strictly increasing.

    ``sigma_m`` is what is left of the noise of one row; an error that wanders with ``wander_sigma_m`` over
    ``correlation_s`` (weather, temperature, flow) and one constant offset of ``offset_sigma_m`` come on top.
    ``gradient_sigma`` is the 1-sigma of one unknown slope along the way (m/m): the pressure that friction takes.
    """

    time_s: FloatArray
    up_m: FloatArray
    sigma_m: float
    correlation_s: float = 600.0
    wander_sigma_m: float = 0.3
    offset_sigma_m: float = 1.0
    source: str = "pressure"
    gradient_sigma: float = 0.0


@dataclass(frozen=True)
class Revisit:
    """At two moments the device was at the same place, ± ``sigma_m`` in each direction: declared, never assumed."""

    first_s: float
    second_s: float
    sigma_m: float
    source: str


@dataclass(frozen=True)
class SlipSpan:
    """A span in which the odometry is not to be trusted: stuck, sliding, saturated, floating.

    ``sigma_share`` is the 1-sigma of what may be missing or too much of the way there, as a share of the way that the
    odometry tells; ``sigma_m`` comes on top, for a device that may have been moved without turning.
    ``heading_sigma_rad`` is what the heading may have lost. The span becomes a stretch of the path that is not
    assessed, with ``reason`` (a key of ``[reasons]``), unless ``reason`` is empty.
    """

    start_s: float
    end_s: float
    reason: str
    sigma_share: float = 1.0
    sigma_m: float = 0.0
    heading_sigma_rad: float = 0.0


@dataclass(frozen=True)
class Evidence:
    """All evidence of one run; ``Evidence()`` is none."""

    fixes: tuple[ChainageFix, ...] = ()
    increments: tuple[ChainageIncrement, ...] = ()
    heights: tuple[HeightSeries, ...] = ()
    revisits: tuple[Revisit, ...] = ()
    slips: tuple[SlipSpan, ...] = ()
    findings: tuple[Finding, ...] = ()
