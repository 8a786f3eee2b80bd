"""The methods' names, apart from their code, so that a form can offer them without loading filters and fits.

The tables that do the work are ``processing.orientation.registry.ESTIMATORS`` and
``processing.position.registry.METHODS``; a test holds these names to them.
"""

ORIENTATION_NAMES = (
    "batch",
    "offline_vqf",
    "vqf",
    "eskf",
    "ukf",
    "ekf7",
    "ekf_gd",
    "madgwick",
    "madgwick6",
    "mahony",
    "mahony6",
    "accmag",
    "gyro",
    "device",
)
POSITION_NAMES = ("rolling", "zupt", "inertial")
