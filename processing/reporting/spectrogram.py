"""The spectrogram around one leak as a figure: the picture itself is pixels, its axes are vectors."""

import numpy as np
import numpy.typing as npt

from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.figures import plain_scale, tick
from processing.reporting.plan_figure import INTERVAL
from processing.reporting.svg import Drawing, Frame
from processing.reporting.words import Words
from processing.sound.tiles import spectrogram_detail, tile_db
from processing.survey import FloatArray

HALF_S = 15.0
COLUMNS = 420  # pixels of a picture that is 67 mm wide on paper: 160 to the inch
TOP_HZ = 8000.0  # above it a ball in a main hears little; the band of the leak is always shown
LEAST_RANGE_DB = 25.0

# anchors of a dark-to-bright map that prints in grey as it looks in colour (after viridis, by its published anchors)
_ANCHORS = np.array(
    [
        *([68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142]),
        *([31, 158, 137], [53, 183, 121], [110, 206, 88], [181, 222, 43], [253, 231, 37]),
    ],
    dtype=np.float64,
)


def spectrogram_excerpt(content: ReportContent, row: LeakRow, words: Words, size: tuple[float, float]) -> str | None:
    """Return 15 s either side of a leak, its moment and its 95 % interval marked, with a dB bar; None without sound."""
    results = content.results
    audio = results.recording.audio
    if audio is None or results.scan is None:
        return None
    middle = float(results.clock.to_audio(row.candidate.time_s))
    start, end = max(0.0, middle - HALF_S), min(audio.duration_s, middle + HALF_S)
    if end - start < 1.0:
        return None
    frequency_hz = results.scan.tiles.frequency_hz
    shown = frequency_hz <= max(TOP_HZ, 1.5 * row.candidate.band_hz[1])
    level_db = tile_db(spectrogram_detail(audio, start, end, COLUMNS, "mean")[shown])
    low = float(np.percentile(level_db, 5)) - 3
    high = max(float(np.percentile(level_db, 99.8)), low + LEAST_RANGE_DB)
    times = results.clock.to_survey(np.array([start, end]))
    top_khz = float(frequency_hz[shown][-1]) / 1000
    frame = Frame(42, 6, size[0] - 96, size[1] - 34, float(times[0]), float(times[1]), 0.0, top_khz)
    drawing = Drawing(*size)
    drawing.image(frame, colours(level_db[::-1], low, high))
    scales = (plain_scale(words), plain_scale(words))
    drawing.axes(frame, words("axis_time"), words("axis_frequency"), grid=False, scales=scales)
    drawing.clipped(frame, lambda: _mark_place(drawing, frame, content, row))
    _bar(drawing, frame, low, high, words)
    return drawing.svg()


def _mark_place(drawing: Drawing, frame: Frame, content: ReportContent, row: LeakRow) -> None:
    """Draw the leak's moment, and between dashes the time in which the device was inside of the 95 % interval."""
    c, track = row.candidate, content.results.track
    bottom = frame.top + frame.height
    if track is not None and np.isfinite([c.chainage_low95_m, c.chainage_high95_m]).all():
        for time_s in distance.times_at(track, [c.chainage_low95_m, c.chainage_high95_m])[0]:
            x = frame.x(float(time_s))
            drawing.path([(x, frame.top), (x, bottom)], INTERVAL, 1.1, dash="4 3", cap="butt")
    x = frame.x(c.time_s)
    drawing.line(x, frame.top, x, frame.top + 6, "#ffffff", 1.6)
    drawing.line(x, bottom - 6, x, bottom, "#ffffff", 1.6)


def _bar(drawing: Drawing, frame: Frame, low: float, high: float, words: Words) -> None:
    """Draw the dB scale beside the picture."""
    bar = Frame(frame.left + frame.width + 8, frame.top, 8, frame.height, 0, 1, low, high)
    ramp = np.linspace(high, low, 64)[:, None]
    drawing.image(bar, colours(ramp, low, high))
    for value in (low, (low + high) / 2, high):
        y = min(max(bar.y(value) + 2.6, bar.top + 6), bar.top + bar.height)
        drawing.text(bar.left + 11, y, f"{tick(round(value), words)} dB", size=7.5)


def colours(level_db: FloatArray | npt.NDArray[np.float32], low: float, high: float) -> npt.NDArray[np.uint8]:
    """Return levels (rows, columns) as colours (rows, columns, 3), ``low`` dark and ``high`` bright."""
    share = np.clip((level_db - low) / (high - low), 0, 1)
    anchors = np.linspace(0, 1, len(_ANCHORS))
    return np.stack([np.interp(share, anchors, _ANCHORS[:, i]) for i in range(3)], axis=-1).astype(np.uint8)
