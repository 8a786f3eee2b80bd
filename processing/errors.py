"""The two families of errors: what the user can mend (:class:`LeaklineError`), and all else, which is our bug."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path


class ErrorCode(StrEnum):
    """What went wrong; the sentence for each stands in the ``[errors]`` table of ``resources/messages/*.toml``."""

    FILE_MISSING = "file_missing"
    FILE_UNREADABLE = "file_unreadable"
    FILE_EMPTY = "file_empty"
    FILE_TOO_LARGE = "file_too_large"
    FORMAT_UNKNOWN = "format_unknown"
    TEXT_NOT_A_TABLE = "text_not_a_table"
    COLUMN_MISSING = "column_missing"
    VALUE_NOT_A_NUMBER = "value_not_a_number"
    TOO_FEW_SAMPLES = "too_few_samples"
    TOML_INVALID = "toml_invalid"
    KEY_MISSING = "key_missing"
    SAMPLE_RATE_MISSING = "sample_rate_missing"
    SETTING_UNKNOWN = "setting_unknown"
    SETTING_INVALID = "setting_invalid"
    NO_IMU = "no_imu"
    AUDIO_UNREADABLE = "audio_unreadable"
    AUDIO_NEEDS_FORM = "audio_needs_form"
    AUDIO_PARTS_DIFFER = "audio_parts_differ"
    DISC_FULL = "disc_full"
    CANNOT_WRITE = "cannot_write"
    NOT_A_SURVEY = "not_a_survey"
    SURVEY_LOCKED = "survey_locked"
    SURVEY_NEWER = "survey_newer"
    SURVEY_DAMAGED = "survey_damaged"
    SURVEY_READ_ONLY = "survey_read_only"
    CRS_UNKNOWN = "crs_unknown"
    LAUNCH_INCOMPLETE = "launch_incomplete"
    LAUNCH_INVALID = "launch_invalid"
    TIE_POINTS_IMPOSSIBLE = "tie_points_impossible"
    PATH_IMPOSSIBLE = "path_impossible"
    REPORT_FAILED = "report_failed"
    SCENARIO_UNKNOWN = "scenario_unknown"
    SIMULATED_FAULT_UNKNOWN = "simulated_fault_unknown"
    SIMULATED_PORT_FAILED = "simulated_port_failed"
    SIMULATED_SOUND_FAILED = "simulated_sound_failed"
    ROUTE_FORMAT_UNKNOWN = "route_format_unknown"
    ROUTE_DAMAGED = "route_damaged"
    ROUTE_EMPTY = "route_empty"
    ROUTE_TOO_MANY = "route_too_many"
    ROUTE_NOT_ONE_LINE = "route_not_one_line"
    ROUTE_NEEDS_CRS = "route_needs_crs"
    ROUTE_OUTSIDE_CRS = "route_outside_crs"
    CORRELATION_TOO_SHORT = "correlation_too_short"
    CORRELATION_SILENT = "correlation_silent"
    CORRELATION_ALL_CLIPPED = "correlation_all_clipped"
    CORRELATION_NEEDS_SPEED = "correlation_needs_speed"
    CORRELATION_WALL = "correlation_wall"
    CORRELATION_SECTIONS = "correlation_sections"
    CORRELATION_LENGTH = "correlation_length"
    CORRELATION_SPEED = "correlation_speed"
    CORRELATION_SUM = "correlation_sum"
    CORRELATION_TAP_MIDDLE = "correlation_tap_middle"
    CORRELATION_TAP_SIGN = "correlation_tap_sign"
    CORRELATION_NO_EVENT = "correlation_no_event"
    CORRELATION_SESSION_DAMAGED = "correlation_session_damaged"
    CORRELATION_SESSION_NEWER = "correlation_session_newer"
    IMU_SPEC_INVALID = "imu_spec_invalid"
    RECORDING_NOTHING_CHOSEN = "recording_nothing_chosen"
    RECORDING_NOT_RUNNING = "recording_not_running"
    RECORDING_RUNNING = "recording_running"
    DEVICE_MISSING = "device_missing"
    SOUND_LIBRARY_MISSING = "sound_library_missing"
    SOUND_SPEC_INVALID = "sound_spec_invalid"
    SOUND_NO_INPUT = "sound_no_input"
    SOUND_DEVICE_MISSING = "sound_device_missing"
    SOUND_DEVICE_REFUSED = "sound_device_refused"
    SOUND_DEVICE_GONE = "sound_device_gone"
    SOUND_SYSTEM_HANGS = "sound_system_hangs"
    SOUND_DEVICE_SWAPPED = "sound_device_swapped"
    PHOTO_UNKNOWN = "photo_unknown"
    PHOTO_HEIC = "photo_heic"
    PHOTO_DAMAGED = "photo_damaged"
    PHOTO_TOO_MANY_PIXELS = "photo_too_many_pixels"
    OPINIONS_OTHER_SURVEY = "opinions_other_survey"
    OPINIONS_NONE = "opinions_none"
    PLACE_UNREADABLE = "place_unreadable"
    PLACE_FAR = "place_far"
    REPEAT_NOT_PROCESSED = "repeat_not_processed"
    REPEAT_SAME_SURVEY = "repeat_same_survey"
    REPEAT_NO_PATH = "repeat_no_path"
    REPEAT_NOTHING_COMMON = "repeat_nothing_common"


@dataclass(frozen=True)
class Place:
    """Where in which file: ``line`` and ``column`` count from 1, ``byte`` from 0."""

    path: Path
    line: int | None = None
    column: int | None = None
    byte: int | None = None

    def __str__(self) -> str:
        parts = [str(self.path)]
        if self.line is not None:
            parts.append(f"line {self.line}")
        if self.column is not None:
            parts.append(f"column {self.column}")
        if self.byte is not None:
            parts.append(f"byte {self.byte}")
        return ", ".join(parts)


class LeaklineError(Exception):
    """Something that the user can mend: a bad file, a full disc, a locked survey.

    ``params`` fill the placeholders of the sentence of ``code``; :func:`processing.messages.error_sentence` makes it.
    """

    def __init__(self, code: ErrorCode, place: Place | None = None, **params: str | float) -> None:
        self.code = code
        self.place = place
        self.params = params
        details = ", ".join(f"{k}={v}" for k, v in params.items())
        super().__init__(f"{code.value}{f' at {place}' if place else ''}{f' ({details})' if details else ''}")


class Cancelled(Exception):  # noqa: N818  # not an error: the operator's wish
    """The operator stopped the work; nothing is left half-written."""
