"""The sheet of a check is kept with the recording, and nothing is kept where nothing is recorded."""

import json

from fake_devices import FakeInput, FakeLink

from app.devices.audio_spec import parse_audio_spec
from app.devices.imu_spec import parse_imu_spec
from app.devices.recorder import Makers, Recorder
from app.devices.recording_plan import RecordingPlan
from processing.live.check_sheet import CheckItem, CheckSheet, Light
from processing.survey import Survey, SurveyInfo

SHEET = CheckSheet("launch", "2026-05-04T09:00:00+00:00", (CheckItem("field", Light.OPEN, "field_none", {}),))


def test_a_sheet_is_kept_in_the_journal_of_the_recording_under_way(tmp_path):
    plan = RecordingPlan(
        survey=Survey(SurveyInfo(name="Gül Sokağı")),
        target=tmp_path,
        sound=parse_audio_spec("default"),
        motion=parse_imu_spec("tcp:ball:1"),
    )
    makers = Makers(lambda choice, block: FakeInput(choice, block, 8000), FakeLink)
    with Recorder(plan, makers, drain_s=0.0) as recorder:
        recorder.open()
        recorder.keep_sheet(SHEET)  # nothing is recorded yet
        folder = recorder.start()
        recorder.keep_sheet(SHEET)
        recorder.stop()
    lines = (folder / "recordings" / "1" / "original" / "recording.jsonl").read_text(encoding="utf-8").splitlines()
    kept = [json.loads(line) for line in lines]
    sheets = [CheckSheet.from_json(line["values"]) for line in kept if line["event"] == "check"]
    assert sheets == [SHEET]
