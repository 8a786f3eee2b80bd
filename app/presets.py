"""The user's own table of presets, and the settings that a survey is processed with."""

from pathlib import Path
from typing import TYPE_CHECKING

from app.settings import config_folder

if TYPE_CHECKING:
    from processing.settings import Settings
    from processing.sound.presets import Preset
    from processing.survey import Survey

FILE_NAME = "presets.toml"


def user_file() -> Path:
    """Return where the user's rows stand."""
    return config_folder() / FILE_NAME


def preset_rows() -> "tuple[Preset, ...]":
    """Return the whole table; raises LeaklineError where the user's file cannot be read."""
    from processing.sound.presets import table

    return table(user_file())


def effective_settings(settings: "Settings", survey: "Survey") -> "Settings":
    """Return the settings with the pipe's preset filled in where nothing was changed by hand.

    Raises:
        LeaklineError: what is wrong with the user's table, or SETTING_INVALID for a preset that does not exist.
    """
    from processing.sound.presets import effective

    return effective(settings, survey, preset_rows())
