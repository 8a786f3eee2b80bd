"""Feeds the quality plots of the path page with what the chosen group of the present results has to show."""

from functools import partial
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.survey_session import SurveySession
from processing import messages
from widgets.allan_plot import AllanLines
from widgets.quality_panel import NOISE, QualityLine, QualityLines, QualityPanel

if TYPE_CHECKING:
    from processing.results import Results

GROUPS = ("interval", "speed", "attitude", "offset", "heading", "innovations", "field", NOISE)


class QualityControl(QObject):
    """Works only while the plots are shown: hours of samples are not gone through for a picture nobody looks at."""

    def __init__(
        self, session: SurveySession, panel: QualityPanel, language: str, parent: QObject | None = None
    ) -> None:
        super().__init__(parent)
        self._session, self._panel, self._language = session, panel, language
        self._shown = False
        panel.group_chosen.connect(lambda _group: self._show())
        session.results_changed.connect(self._show)
        texts = messages.table("quality", language)
        panel.set_groups([(group, texts[f"{group}_title"], texts[f"{group}_words"]) for group in GROUPS])

    def set_shown(self, shown: bool) -> None:
        """Tell whether the plots are in view."""
        self._shown = shown
        self._show()

    def _show(self) -> None:
        results = self._session.results
        group = self._panel.group
        if not self._shown or results is None:
            self._panel.show_strips(None)
        elif group == NOISE:
            self._panel.show_noise(partial(_noise, results, self._language))
        else:
            self._panel.show_strips(partial(_strips, results, group, self._language))


def _strips(results: "Results", group: str, language: str) -> tuple[QualityLines, ...]:
    from processing.quality import quality_strips

    texts = messages.table("quality", language)
    return tuple(
        QualityLines(
            texts[strip.key],
            strip.unit,
            tuple(QualityLine(texts.get(f"{c.key}_label", ""), c.time_s, c.values) for c in strip.curves),
            strip.least,
            strip.from_zero,
            strip.interval,
        )
        for strip in quality_strips(results, group)
    )


def _noise(results: "Results", language: str) -> tuple[tuple[AllanLines, ...], str]:
    """Return the Allan deviations of the longest rest, or why there are none."""
    import numpy as np

    from processing.orientation.allan import allan

    texts = messages.table("quality", language)
    imu, calibration = results.recording.imu, results.calibration
    found = allan(imu, calibration.rests) if imu is not None and calibration is not None else None
    if found is None:
        return (), texts["no_rest"]
    gyr, acc, degrees = found.gyr, found.acc, float(np.degrees(1.0))
    return (
        AllanLines(texts["gyro"], "°/s", gyr.tau_s, degrees * gyr.deviation, degrees * gyr.low, degrees * gyr.high),
        AllanLines(texts["accelerometer"], "m/s²", acc.tau_s, acc.deviation, acc.low, acc.high),
    ), ""
