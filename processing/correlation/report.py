"""What leaves the correlator: one PDF page, the curve as CSV, the numbers as JSON."""

import csv
import json
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from processing import messages
from processing.correlation.analysis import Choice, Correlation
from processing.correlation.pipe import Pipe, PipeSection, places_of_delays
from processing.correlation.recordings import Pair
from processing.errors import ErrorCode, LeaklineError, Place
from processing.reporting.files import aside_of, whole_file
from processing.reporting.svg import INK, SOFT, Drawing, Frame
from processing.survey import AudioSource, FloatArray

_CURVE, _LEAK, _CHANCE = "#0072b2", "#c3124b", "#8a6d3b"
_MOST_POINTS = 1500
_BEYOND = 0.15


@dataclass(frozen=True)
class CorrelationReport:
    """A result with what it came from; ``language`` is that of the sentences."""

    result: Correlation
    pair: Pair
    pipe: Pipe
    choice: Choice
    note: str = ""
    language: str = "en"


def write_report(stem: Path, report: CorrelationReport) -> tuple[Path, ...]:
    """Write ``stem`` with ``.pdf``, ``.csv`` and ``.json``; each appears only whole.

    Raises:
        LeaklineError: CANNOT_WRITE, REPORT_FAILED.
    """
    paths = tuple(stem.with_name(stem.name + suffix) for suffix in (".csv", ".json", ".pdf"))
    for path, write in zip(paths, (write_curve, write_numbers, write_page), strict=True):
        try:
            write(path, report)
        except OSError as error:
            raise LeaklineError(ErrorCode.CANNOT_WRITE, Place(path), reason=error.strerror or str(error)) from error
    return paths


def write_curve(path: Path, report: CorrelationReport) -> None:
    """Write the correlation: ``delay_ms, from_a_m, correlation, envelope``, a row a point within the pipe's reach."""
    gram = report.result.correlogram
    metres = places_of_delays(report.pipe, gram.delay_s)
    seen = _seen(metres, report.pipe)
    with whole_file(path) as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(("delay_ms", "from_a_m", "correlation", "envelope"))
        rows = np.column_stack([1e3 * gram.delay_s, metres, gram.value, gram.envelope])[seen]
        for delay, place, value, envelope in rows.tolist():
            table.writerow((f"{delay:.6f}", f"{place:.4f}", f"{value:.6f}", f"{envelope:.6f}"))


def write_numbers(path: Path, report: CorrelationReport) -> None:
    """Write all numbers of the result; unknown ones are null."""
    with whole_file(path) as file:
        json.dump(numbers(report), file, ensure_ascii=False, indent=1, allow_nan=False)


def numbers(report: CorrelationReport) -> dict[str, Any]:
    """Return the result as plain values; units stand in the names."""
    result, pair, position = report.result, report.pair, report.result.position
    phase = result.phase
    return {
        "recordings": {name: _recording(source) for name, source in (("a", pair.a), ("b", pair.b))},
        "sync": {
            "kind": pair.sync.kind.value,
            "offset_s": pair.sync.offset_s,
            "sigma_s": pair.sync.sigma_s,
            "drift_ppm": pair.sync.drift_ppm,
        },
        "used_s": result.spectra.used_s,
        "pipe": [_section(section) for section in report.pipe.sections],
        "distance_m": report.pipe.length_m,
        "weighting": report.choice.weighting.value,
        "band_hz": [result.band.low_hz, result.band.high_hz],
        "delay_s": _finite(result.delay_s),
        "delay_sigma_s": _finite(result.delay_sigma_s),
        "significant": result.significant,
        "dispersion_per_octave": None if phase is None else phase.dispersion.slope * math.log(2.0),
        "leak": None
        if position is None
        else {
            "from_a_m": position.from_a_m,
            "from_b_m": position.from_b_m,
            "low95_m": position.low95_m,
            "high95_m": position.high95_m,
            "where": position.where.value,
            "sigma_m": {share.source: share.sigma_m for share in position.shares},
        },
        "peaks": [
            {"delay_s": peak.delay_s, "height": peak.height, "chance": peak.probability} for peak in result.peaks
        ],
        "suppressed": [
            {"delay_s": gone.delay_s, "half_width_s": gone.half_width_s, "name": gone.name}
            for gone in report.choice.suppressed
        ],
        "findings": [finding.code for finding in result.findings],
        "note": report.note,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _recording(source: AudioSource) -> dict[str, Any]:
    files = [str(part.path).encode("utf-8", "replace").decode("utf-8") for part in source.parts]
    return {"files": files, "channel": source.channel, "sample_rate_hz": source.sample_rate_hz}


def _section(section: PipeSection) -> dict[str, Any]:
    speed, sigma = section.speed()
    return {
        "length_m": section.length_m,
        "material": section.material,
        "diameter_m": section.diameter_m,
        "speed_mps": speed,
        "speed_sigma_mps": sigma,
    }


def _seen(metres: FloatArray, pipe: Pipe) -> "np.ndarray[Any, np.dtype[np.bool_]]":
    return np.asarray((metres >= -_BEYOND * pipe.length_m) & (metres <= (1.0 + _BEYOND) * pipe.length_m))


# --- the page --------------------------------------------------------------------------------------------------------


def write_page(path: Path, report: CorrelationReport) -> None:
    """Write the PDF page: the place in large letters, the two pictures, what it came from, and the notes.

    Raises:
        LeaklineError: REPORT_FAILED with the template's own words.
    """
    import typst  # slow to import: only who writes a page pays for it

    data = page_data(report)
    words = _words(report.language)
    with tempfile.TemporaryDirectory(prefix="leakline-correlation-") as name:
        folder = Path(name)
        (folder / "correlation.svg").write_text(correlation_figure(report, words), encoding="utf-8")
        (folder / "coherence.svg").write_text(coherence_figure(report, words), encoding="utf-8")
        (folder / "data.json").write_text(json.dumps(data, ensure_ascii=False), encoding="utf-8", errors="replace")
        template = (resources.files("resources") / "report" / "correlation.typ").read_text(encoding="utf-8")
        (folder / "correlation.typ").write_text(template, encoding="utf-8")
        with resources.as_file(resources.files("resources") / "fonts") as fonts:
            try:
                pdf = typst.compile(
                    str(folder / "correlation.typ"),
                    font_paths=[str(fonts)],
                    ignore_system_fonts=True,
                    root=str(folder),
                )
            except RuntimeError as error:  # typst has no narrower class
                raise LeaklineError(ErrorCode.REPORT_FAILED, Place(path), reason=str(error)) from error
    aside = aside_of(path)
    try:
        aside.write_bytes(pdf)
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def _words(language: str) -> Callable[..., str]:
    return lambda key, **params: messages.text("correlator", key, language, **params)


def headline(report: CorrelationReport) -> tuple[str, str]:
    """Return where the leak is and its interval, as two lines; the second is empty where there is no place."""
    words, position = _words(report.language), report.result.position
    if position is None:
        return words("no_place"), ""
    place = words("leak_at", from_a=position.from_a_m, from_b=position.from_b_m)
    return place, words("interval", low=position.low95_m, high=position.high95_m)


def page_data(report: CorrelationReport) -> dict[str, Any]:
    """Return all words and numbers of the page."""
    words, result, language = _words(report.language), report.result, report.language
    place, interval = headline(report)
    facts = [
        (words("recording_a"), _named(report.pair.a, words)),
        (words("recording_b"), _named(report.pair.b, words)),
        (words("used"), words("used_value", seconds=result.spectra.used_s)),
        (words("distance"), f"{report.pipe.length_m:.2f} m"),
    ]
    if math.isfinite(result.delay_s):
        delay = words("delay_value", delay_ms=1e3 * result.delay_s, sigma_ms=1e3 * result.delay_sigma_s)
        facts.append((words("delay"), delay))
    weighting = messages.text("weightings", report.choice.weighting.value, language)
    method = words("method_value", weighting=weighting, low=result.band.low_hz, high=result.band.high_hz)
    facts.append((words("method"), method))
    if result.position is not None:
        shares = [words(f"share_{share.source}", metres=share.sigma_m) for share in result.position.shares]
        facts.append((words("uncertainty"), ", ".join(shares)))
    for gone in report.choice.suppressed:
        value = words("suppressed_value", delay_ms=1e3 * gone.delay_s, name=gone.name)
        facts.append((words("suppressed"), value))
    return {
        "language": language,
        "title": words("title"),
        "place": place,
        "interval": interval,
        "facts": [list(row) for row in facts],
        "head": [words(key) for key in ("section", "length", "material", "diameter", "speed")],
        "rows": [_row(number, section, language) for number, section in enumerate(report.pipe.sections, 1)],
        "pipe": words("pipe"),
        "about": words("about"),
        "findings": words("findings"),
        "notes": [messages.finding_sentence(f, language) for f in result.findings] + [report.note] * bool(report.note),
    }


def _named(source: AudioSource, words: Callable[..., str]) -> str:
    name = source.parts[0].path.name + (f" +{len(source.parts) - 1}" if len(source.parts) > 1 else "")
    return f"{name}, {words('channel', number=source.channel + 1)}" if source.channels > 1 else name


def _row(number: int, section: PipeSection, language: str) -> list[str]:
    speed, sigma = section.speed()
    known = section.material in messages.table("materials", language)
    material = messages.text("materials", section.material, language) if known else section.material
    diameter = "" if section.diameter_m is None else f"{1e3 * section.diameter_m:.0f}"
    return [str(number), f"{section.length_m:.2f}", material, diameter, f"{speed:.0f} ± {sigma:.0f}"]


def correlation_figure(report: CorrelationReport, words: Callable[..., str]) -> str:
    """Return the correlation over metres from A as SVG."""
    gram, pipe = report.result.correlogram, report.pipe
    metres = places_of_delays(pipe, gram.delay_s)
    seen = _seen(metres, pipe)
    x, y = _thinned(metres[seen], gram.value[seen])
    low, high = float(np.min(y, initial=0.0)), float(np.max(y, initial=1e-9))
    room = 0.12 * (high - low)
    drawing = Drawing(494.0, 190.0)
    reach = _BEYOND * pipe.length_m
    frame = Frame(46, 10, 436, 145, -reach, pipe.length_m + reach, low - room, high + room)
    drawing.axes(frame, words("axis_place"), words("axis_correlation"))
    position = report.result.position
    if position is not None:
        left, right = frame.x(position.low95_m), frame.x(position.high95_m)
        drawing.rectangle(left, frame.top, max(right - left, 1.0), frame.height, _LEAK, 0.25)
    chance = 3.0 * gram.chance
    for level in (chance, -chance):
        if frame.y_low < level < frame.y_high:
            drawing.line(frame.left, frame.y(level), frame.left + frame.width, frame.y(level), _CHANCE, 0.6)
    points = zip(x.tolist(), y.tolist(), strict=True)
    drawing.clipped(frame, lambda: drawing.path(((frame.x(a), frame.y(b)) for a, b in points), _CURVE, 0.9))
    for name, place in (("A", 0.0), ("B", pipe.length_m)):
        drawing.line(frame.x(place), frame.top, frame.x(place), frame.top + frame.height, INK, 1.0)
        drawing.text(frame.x(place) + 3, frame.top + 9, name, weight=600)
    return drawing.svg()


def coherence_figure(report: CorrelationReport, words: Callable[..., str]) -> str:
    """Return coherence over frequency, with the band and the bound of chance, as SVG."""
    result = report.result
    spectra = result.spectra
    top_hz = min(float(spectra.frequency_hz[-1]), 2.0 * result.band.high_hz)
    seen = spectra.frequency_hz <= top_hz
    x, y = _thinned(spectra.frequency_hz[seen], np.maximum(spectra.true_coherence[seen], 0.0))
    drawing = Drawing(494.0, 150.0)
    frame = Frame(46, 10, 436, 105, 0.0, top_hz, 0.0, max(0.1, 1.1 * float(np.max(y, initial=0.0))))
    drawing.axes(frame, words("axis_frequency"), words("axis_coherence"))
    left, right = frame.x(result.band.low_hz), frame.x(min(result.band.high_hz, top_hz))
    drawing.rectangle(left, frame.top, right - left, frame.height, _CURVE, 0.15)
    if spectra.bound < frame.y_high:
        height = frame.y(spectra.bound)
        drawing.line(frame.left, height, frame.left + frame.width, height, _CHANCE, 0.6)
    points = zip(x.tolist(), y.tolist(), strict=True)
    drawing.clipped(frame, lambda: drawing.path(((frame.x(a), frame.y(b)) for a, b in points), SOFT, 0.8))
    return drawing.svg()


def _thinned(x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return few enough points for paper, keeping the extremes of each stretch."""
    if len(x) <= _MOST_POINTS:
        return x, y
    size = -(-len(x) // (_MOST_POINTS // 2))
    keep: list[int] = []
    for start in range(0, len(x), size):
        part = y[start : start + size]
        keep += sorted({start + int(np.argmin(part)), start + int(np.argmax(part))})
    return x[keep], y[keep]
