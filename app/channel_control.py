"""Feeds the channels panel: reads a channel of the present results, filters it, and says what the filter found."""

from dataclasses import fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QObject

from app.survey_session import SurveySession
from processing import messages
from processing.conditioning.names import CONDITIONER_FIELDS
from processing.conditioning.settings import ConditioningSettings
from processing.errors import LeaklineError
from widgets.channel_panel import ChannelPanel, Choice, FilterSetting
from widgets.channel_view import ChannelLine, ChannelPicture, ChannelStrip
from widgets.vocabulary import clock_text

if TYPE_CHECKING:
    from app.page_tools import PageTools
    from processing.conditioning.channel import Conditioned
    from processing.conditioning.channels import ChannelSeries
    from processing.results import Results

NAME = "channels"
CHANNELS = (
    "pressure",
    "pressure_level",
    "level",
    "speed",
)  # processing.conditioning.channels.CHANNELS, without loading it
_MOST_ROWS = {"ekf": 20_000, "ukf": 20_000}  # their models are Python: some seconds of work
_MOST_CHANGES = 5
_LEAST = {"kPa": 0.3, "dB": 3.0, "m/s": 0.1}


class ChannelControl(QObject):
    """Works only while the panel is in front: hours of samples are not filtered for a picture nobody looks at."""

    def __init__(
        self,
        session: SurveySession,
        tools: "PageTools",
        panel: ChannelPanel,
        language: str,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._tools, self._panel, self._language = session, tools, panel, language
        panel.set_choices(*choices(language))
        panel.changed.connect(self._show)
        panel.view.failed.connect(self._on_failed)
        session.results_changed.connect(self._show)
        tools.chosen.connect(lambda _name: self._show())

    def _show(self) -> None:
        results, panel = self._session.results, self._panel
        if results is None or not self._tools.is_in_front(NAME):
            panel.show_channel(None)
            return
        settings = replace(ConditioningSettings(), **_as_any(panel.values))
        panel.show_channel(partial(channel_picture, results, panel.channel, panel.filter, settings, self._language))

    def _on_failed(self, error: Exception) -> None:
        self._panel.tell(
            messages.error_sentence(error, self._language) if isinstance(error, LeaklineError) else str(error)
        )


def choices(
    language: str,
) -> tuple[tuple[Choice, ...], tuple[Choice, ...], dict[str, tuple[FilterSetting, ...]]]:
    """Return the channels, the filters, and each filter's settings, in the window's language."""
    titles, filters = messages.table("channel_titles", language), messages.table("conditioner_titles", language)
    words, labels = messages.table("conditioner_words", language), messages.table("conditioner_settings", language)
    specs = {spec.name: spec for spec in fields(ConditioningSettings)}

    def setting(name: str) -> FilterSetting:
        meta, default = specs[name].metadata, specs[name].default
        assert isinstance(default, str | float)
        if "options" in meta:
            options = tuple(Choice(option, labels[option]) for option in meta["options"])
            return FilterSetting(name, labels[name], default, options=options)
        return FilterSetting(name, labels[name], default, meta["low"], meta["high"])

    return (
        tuple(Choice(name, titles[name]) for name in CHANNELS),
        tuple(Choice(name, filters[name], words[name]) for name in CONDITIONER_FIELDS),
        {name: tuple(setting(field) for field in used) for name, used in CONDITIONER_FIELDS.items()},
    )


def channel_picture(
    results: "Results", channel: str, filter_name: str, settings: ConditioningSettings, language: str
) -> ChannelPicture:
    """Return the strips of a channel of these results; runs in a worker.

    Raises:
        LeaklineError: what the filter cannot do with this channel, such as a cut-off above its rate.
    """
    from processing.conditioning.channels import channel_series
    from processing.conditioning.registry import condition

    texts = messages.table("channels", language)
    series = channel_series(channel, results.recording.imu, results.track, results.scan, results.clock)
    if series is None:
        return ChannelPicture((), texts["none"])
    used = series.coarser(_MOST_ROWS.get(filter_name, len(series.values)))
    out = condition(filter_name, used.values, used.sample_rate_hz, settings, used.valid)
    title = messages.text("channel_titles", channel, language)
    figures = _figures(series, used, out, language)
    if series.unit == "kPa":
        figures = "\n".join(part for part in (figures, _changes(results, language)) if part)
    return ChannelPicture(_strips(series, used, out, title, language), figures)


def _strips(
    series: "ChannelSeries", used: "ChannelSeries", out: "Conditioned", title: str, language: str
) -> tuple[ChannelStrip, ...]:
    import numpy as np

    texts, least = messages.table("channels", language), _LEAST[series.unit]
    raw = np.where(series.valid, series.values, np.nan)
    residual = np.where(used.valid, used.values - out.values, np.nan)
    lines = (ChannelLine(texts["raw"], series.time_s, raw), ChannelLine(texts["filtered"], used.time_s, out.values))
    strips = [
        ChannelStrip(title, series.unit, lines, least),
        ChannelStrip(texts["residual"], series.unit, (ChannelLine("", used.time_s, residual),), 0.3 * least),
    ]
    if out.sigma is not None:
        doubt = ChannelLine("", used.time_s, 1.96 * out.sigma)
        strips.append(ChannelStrip(texts["doubt"], series.unit, (doubt,), 0.02 * least, from_zero=True))
    return tuple(strips)


def _figures(series: "ChannelSeries", used: "ChannelSeries", out: "Conditioned", language: str) -> str:
    parts = []
    for name, value in out.figures.items():
        if name in ("swing_hz", "swing_size") and not value:
            continue
        shown = float(value) + 1.0 if name == "likeliest_model" else float(value)
        parts.append(messages.text("channels", name, language, value=shown, unit=series.unit))
    if used is not series:
        parts.append(messages.text("channels", "averaged", language, value=1.0 / used.sample_rate_hz))
    return "  ·  ".join(parts)


def _changes(results: "Results", language: str) -> str:
    """Return a line of the pressure's sudden changes, the largest first; empty where there is none."""
    from processing.conditioning.transients import find_transients, pressure_rows

    imu = results.recording.imu
    rows = pressure_rows(imu) if imu is not None else None
    events = find_transients(rows, results.track) if rows is not None else ()
    if not events:
        return ""
    parts = [
        messages.text(
            "channels",
            f"change_{event.kind}",
            language,
            time=clock_text(event.time_s),
            size=event.size_kpa,
            hz=event.ringing_hz,
        )
        for event in sorted(events, key=lambda event: -abs(event.size_kpa))[:_MOST_CHANGES]
    ]
    return messages.text("channels", "changes", language, count=float(len(events)), listed=";  ".join(parts))


def _as_any(values: dict[str, str | float]) -> dict[str, Any]:
    return dict(values)
