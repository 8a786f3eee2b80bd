"""The tunables of the channel filters; whoever calls a filter brings them."""

from dataclasses import dataclass

from processing.settings import choice, tunable


@dataclass(frozen=True)
class ConditioningSettings:
    """How a slow scalar channel is smoothed; "unit" is the channel's own."""

    noise_sigma: float = tunable(0.0, "unit", 0.0, 1e9, "1 sigma of one reading; 0: the likeliest for the data")
    wander_sigma: float = tunable(
        0.0, "unit/√s", 0.0, 1e9, "1 sigma by which the true value wanders in a second; 0: the likeliest for the data"
    )
    phase: str = choice(
        "zero", ("zero", "causal"), "zero: smooth backwards too, so that nothing lags; causal: as a live filter, as P2"
    )
    cutoff_hz: float = tunable(1.0, "Hz", 1e-4, 1e5, "pressure, level and speed of a ball change within seconds")
    transition_hz: float = tunable(1.0, "Hz", 1e-4, 1e5, "from passed to stopped; narrower is a longer filter")
    window_s: float = tunable(20.0, "s", 0.1, 3600.0, "adaptive: over so much the innovations are averaged")
    bank_span: float = tunable(100.0, "", 2.0, 1e6, "multiple model: how far the bank reaches either way in wander²")
    dwell_s: float = tunable(30.0, "s", 0.1, 1e5, "multiple model: so long one model holds, on average")
    swing_periods: float = tunable(
        10.0, "periods", 1.0, 1e4, "EKF, UKF: over so many an oscillation keeps its size and speed"
    )
