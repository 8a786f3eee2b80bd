"""The user's own table of presets, and the settings that a survey is processed with."""

from pathlib import Path
from typing import TYPE_CHECKING

from app.settings import config_folder
from processing.errors import LeaklineError

if TYPE_CHECKING:
    from app.survey_session import SurveySession
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


def settings_in_force(session: "SurveySession") -> "Settings":
    """Return the settings with which the open survey would be processed now.

    A table that cannot be read fills nothing in here; processing says what is wrong with it.
    """
    try:
        return effective_settings(session.settings, session.survey)
    except LeaklineError:
        return session.settings
