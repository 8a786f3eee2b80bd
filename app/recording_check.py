"""The check before the launch, spoken: ``leakline record --check`` asks for rest and knocks, and says the lights.

It is made in the first half minute of the recording itself, so that its knocks are there to align the clocks.
"""

import time
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime

from app.battery import battery
from app.devices.recorder import Recorder
from app.devices.recording_plan import RecordingPlan
from app.recording_terminal import Terminal
from processing import messages
from processing.live.check_sheet import Phase
from processing.live.prelaunch import CheckPlan, PrelaunchCheck, Surroundings

PLANNED_S = 3600.0  # where nobody said how long it will last


class SpokenCheck:
    """One check; :meth:`look` is called a few times a second until it returns False."""

    def __init__(
        self,
        recorder: Recorder,
        plan: RecordingPlan,
        terminal: Terminal,
        monotonic: Callable[[], float] = time.monotonic,
    ) -> None:
        device = plan.survey.device
        told = CheckPlan(
            motion=device.motion,
            radius_m=device.radius_m,
            planned_s=plan.planned_s or PLANNED_S,
            has_sound=plan.sound is not None,
            has_motion=plan.motion is not None,
        )
        self._recorder, self._terminal, self._monotonic = recorder, terminal, monotonic
        self._check = PrelaunchCheck(told, monotonic(), datetime.now(UTC).isoformat(timespec="seconds"))
        self._power = battery()
        self._said = ""

    def look(self) -> bool:
        """Take what came and go on; at the end say the lights, keep the sheet, and return False."""
        status = self._recorder.status()
        for block in self._recorder.feed.take():
            self._check.add(block, status.sound.sample_rate_hz)
        around = Surroundings(status.sound, status.motion, status.disc)
        if self._power is not None:
            around = replace(around, battery_pct=100.0 * self._power.part, is_plugged=self._power.plugged)
        view = self._check.tick(self._monotonic(), around)
        key = view.phase.value
        if view.phase is Phase.REST and (view.moved or self._said == "rest_moved"):  # said once, however often it moves
            key = "rest_moved"
        if key != self._said:
            self._said = key
            self._terminal.write("> " + messages.text("check_phases", key, self._terminal.language))
        if view.phase is not Phase.DONE:
            return True
        self._tell()
        return False

    def _tell(self) -> None:
        sheet, language = self._check.sheet(), self._terminal.language
        for item in sheet.items:
            light = messages.text("check_lights", item.light.value, language)
            verdict = messages.text("check_verdicts", item.verdict, language, **item.params)
            self._terminal.write(f"  [{light}] {messages.text('check_items', item.key, language)}: {verdict}")
        self._recorder.keep_sheet(sheet)
        self._recorder.feed.close()
