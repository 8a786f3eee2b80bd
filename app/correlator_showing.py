"""Puts a correlation onto the page: plots, sketch, the place in large letters, and what was noticed."""

import math

import numpy as np

from app.correlator_page import CorrelatorPage
from processing import messages
from processing.correlation.analysis import Choice, Correlation
from processing.correlation.pipe import Pipe
from processing.correlation.recordings import Pair
from processing.correlation.report import CorrelationReport, headline
from processing.survey import FloatArray
from widgets.correlator_plot import ShownCorrelation
from widgets.correlator_spectrum import ShownCoherence
from widgets.units import quantities

CHANCE_SIGMAS = 3.0


def show_result(
    page: CorrelatorPage, result: Correlation, pipe: Pipe, choice: Choice, pair: Pair | None, language: str
) -> None:
    """Show a result and how it was come by."""
    spectra = result.spectra
    chance = CHANCE_SIGMAS * result.correlogram.chance
    page.correlation.show_correlation(
        ShownCorrelation(
            pipe, result.correlogram, result.peaks, result.chosen, result.position, choice.suppressed, chance
        )
    )
    page.coherence.show_coherence(
        ShownCoherence(
            spectra.frequency_hz,
            spectra.true_coherence,
            spectra.bound,
            _decibels(spectra.smooth_aa),
            _decibels(spectra.smooth_bb),
            result.hum,
            result.band,
        )
    )
    page.phase.show_line(result.phase)
    page.parts.show_parts(result.parts, result.delay_s)
    page.band_low.set_value(round(result.band.low_hz, 1))
    page.band_high.set_value(round(result.band.high_hz, 1))
    page.sketch.show_pipe(pipe, result.position)
    page.set_ready(ready=result.chosen is not None)
    notes = [messages.finding_sentence(finding, language, quantities().units) for finding in result.findings]
    if pair is None:
        page.say("", notes)
        return
    place, interval = headline(CorrelationReport(result, pair, pipe, choice, language=language))
    if math.isfinite(result.delay_s):
        numbers = {"delay_ms": 1e3 * result.delay_s, "sigma_ms": 1e3 * result.delay_sigma_s}
        value = messages.text("correlator", "delay_value", language, **numbers)
        delay = f"{messages.text('correlator', 'delay', language)}: {value}"
        interval = f"{interval}   ·   {delay}" if interval else delay
    page.say(place, [interval, *notes] if interval else notes)


def _decibels(power: FloatArray) -> FloatArray:
    return np.asarray(10.0 * np.log10(np.maximum(power, 1e-300)))
