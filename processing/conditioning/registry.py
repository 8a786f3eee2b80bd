"""The table of channel filters; adding one is one new module and one row."""

from dataclasses import dataclass
from typing import Protocol

from processing.conditioning.adaptive import adaptive
from processing.conditioning.cascades import fir_kalman, kalman_fir
from processing.conditioning.channel import Conditioned
from processing.conditioning.fir import fir
from processing.conditioning.kalman import kalman
from processing.conditioning.multiple_model import multiple_model
from processing.conditioning.oscillation import by_ekf, by_ukf
from processing.conditioning.settings import ConditioningSettings
from processing.errors import ErrorCode, LeaklineError
from processing.survey import BoolArray, FloatArray


class Function(Protocol):
    """What every channel filter is called with: readings (n,), rate, settings, and which of them can be trusted."""

    def __call__(
        self,
        values: FloatArray,
        sample_rate_hz: float,
        settings: ConditioningSettings,
        valid: BoolArray | None = None,
    ) -> Conditioned:
        """Return the filtered channel."""
        ...


@dataclass(frozen=True)
class Conditioner:
    """One row of the table; ``source`` is what it rests on."""

    name: str
    function: Function
    source: str


CONDITIONERS: tuple[Conditioner, ...] = (
    Conditioner("kalman", kalman, "Zengin 2023; Rauch, Tung, Striebel 1965"),
    Conditioner("fir", fir, "Zengin 2023; Rabiner, Gold, McGonegal 1970"),
    Conditioner("kalman_fir", kalman_fir, "Zengin 2023"),
    Conditioner("fir_kalman", fir_kalman, "Zengin 2023"),
    Conditioner("adaptive", adaptive, "Mehra 1970"),
    Conditioner("multiple_model", multiple_model, "Magill 1965"),
    Conditioner("ekf", by_ekf, "Zengin 2023; La Scala, Bitmead 1996"),
    Conditioner("ukf", by_ukf, "Zengin 2023; Julier, Uhlmann 1995; Särkkä 2008"),
)


def condition(
    name: str,
    values: FloatArray,
    sample_rate_hz: float,
    settings: ConditioningSettings | None = None,
    valid: BoolArray | None = None,
) -> Conditioned:
    """Filter ``values`` (n,), evenly sampled, by the filter of that name; with None the defaults.

    Raises:
        LeaklineError: SETTING_INVALID for a name that is not in the table or a filter that the rate does not allow;
            TOO_FEW_SAMPLES.
    """
    for row in CONDITIONERS:
        if row.name == name:
            return row.function(values, sample_rate_hz, settings or ConditioningSettings(), valid)
    allowed = ", ".join(row.name for row in CONDITIONERS)
    raise LeaklineError(ErrorCode.SETTING_INVALID, name="conditioning.filter", value=name, allowed=allowed)
