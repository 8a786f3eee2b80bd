"""Where the demonstration survey lives on this computer; it is made from its scenario at first use."""

from pathlib import Path

from platformdirs import user_data_path

from processing.progress import Progress
from processing.simulation.demo import demo_folder


def demonstration_folder(progress: Progress) -> Path:
    """Return the demonstration's device folder, made if it is not there yet.

    Raises:
        LeaklineError: DISC_FULL or CANNOT_WRITE for the user's data folder.
    """
    return demo_folder(user_data_path("leakline", appauthor=False) / "demonstration", progress)
