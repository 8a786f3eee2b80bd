"""What the recording page remembers for the next time: devices, names and places, as plain texts."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from app.devices.audio_spec import MOST_CHANNELS
from app.recording_page import RecordingPage
from app.settings import surveys_folder
from processing.survey import Motion, Survey
from widgets.device_form import MotionWish, SoundWish


def remembered(page: RecordingPage) -> dict[str, str]:
    """Return all that stands on the page."""
    sound, motion, survey = page.devices.sound, page.devices.motion, page.form.survey
    return {
        "sound": sound.name,
        "rate": str(sound.rate_hz or ""),
        "channels": str(sound.channels),
        "imu": motion.kind,
        "address": motion.address,
        "port": str(motion.port),
        "baud": str(motion.baud),
        "protocol": motion.protocol,
        "folder": str(page.form.folder),
        "name": survey.info.name,
        "operator": survey.info.operator,
        "motion": survey.device.motion.value,
        "radius_m": _text(survey.device.radius_m),
        "diameter_m": _text(survey.pipe.diameter_m),
        "planned_s": _text(page.form.planned_s),
        "places": page.form.places_text,
    }


def recall(page: RecordingPage, values: Mapping[str, str]) -> None:
    """Put it back; what is missing or makes no sense is left as a new page has it."""
    sound = SoundWish(
        values.get("sound", SoundWish.name),
        _whole(values, "rate") or None,
        min(max(1, _whole(values, "channels") or 1), MOST_CHANNELS),  # the form makes a line of each
    )
    motion = MotionWish(
        values.get("imu", MotionWish.kind),
        values.get("address", ""),
        min(_whole(values, "port") or 0, 65_535),
        _whole(values, "baud") or MotionWish.baud,
        values.get("protocol", MotionWish.protocol),
    )
    page.devices.set_wishes(sound, motion)
    survey = Survey()
    kind = values.get("motion", "")
    page.form.set_survey(
        replace(
            survey,
            info=replace(survey.info, name=values.get("name", ""), operator=values.get("operator", "")),
            device=replace(
                survey.device,
                motion=Motion(kind) if kind in list(Motion) else survey.device.motion,
                radius_m=_number(values, "radius_m"),
            ),
            pipe=replace(survey.pipe, diameter_m=_number(values, "diameter_m")),
        )
    )
    folder = values.get("folder", "")
    page.form.set_folder(Path(folder) if folder else surveys_folder())
    page.form.set_planned(_number(values, "planned_s") or 0.0)
    page.form.set_places(values.get("places", ""))


def _text(value: float | None) -> str:
    return "" if value is None else repr(value)


def _number(values: Mapping[str, str], name: str) -> float | None:
    try:
        value = float(values.get(name, ""))
    except ValueError:
        return None
    return value if 0.0 < value < 1e9 else None


def _whole(values: Mapping[str, str], name: str) -> int | None:
    text = values.get(name, "")
    return int(text) if text.isascii() and text.isdigit() and len(text) < 9 else None
