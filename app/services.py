"""What outlives a window: the survey, the work in progress, the preferences and the devices."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from app.devices.audio_output import Sink, open_sink, why_silent
from app.jobs import Jobs
from app.recording_parts import RecordingKit
from app.settings import PreferencesStore
from app.survey_session import SurveySession


@dataclass(frozen=True)
class Services:
    """What outlives a window: it can be closed and made again in another language around these."""

    session: SurveySession
    jobs: Jobs
    preferences: PreferencesStore
    log_file: Path | None = None
    make_sink: Callable[[float], Sink] = open_sink
    why_silent: Callable[[], str | None] = why_silent
    recording: RecordingKit | None = None  # None: the real devices
