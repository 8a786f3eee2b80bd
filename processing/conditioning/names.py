"""The channel filters' names and settings, apart from their code, so that a form can offer them without loading it."""

# a row each in processing.conditioning.registry.CONDITIONERS, with the fields of ConditioningSettings that it reads
CONDITIONER_FIELDS: dict[str, tuple[str, ...]] = {
    "kalman": ("phase", "noise_sigma", "wander_sigma"),
    "fir": ("cutoff_hz", "transition_hz"),
    "kalman_fir": ("phase", "noise_sigma", "wander_sigma", "cutoff_hz", "transition_hz"),
    "fir_kalman": ("phase", "noise_sigma", "wander_sigma", "cutoff_hz", "transition_hz"),
    "adaptive": ("phase", "window_s"),
    "multiple_model": ("phase", "noise_sigma", "wander_sigma", "bank_span", "dwell_s"),
    "ekf": ("phase", "noise_sigma", "wander_sigma", "swing_periods"),
    "ukf": ("phase", "noise_sigma", "wander_sigma", "swing_periods"),
}
