"""The clocks of two recorders from a sound that both heard at one place: held together and knocked, before and after.

Knock both recorders in one hand some five times, irregularly, before they are set out, and again afterwards: the
first gives the offset, both give the drift.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import fft, signal

from processing.correlation.correlogram import correlate, peaks
from processing.correlation.phase_fit import DispersionChoice, fit_phase
from processing.correlation.reading import measure
from processing.correlation.recordings import Pair, Sync, SyncKind
from processing.correlation.weighting import Band, Weighting, band_gain, weights
from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress
from processing.sound.source import AudioReader
from processing.survey import AudioSource, FloatArray

LONGEST_EVENT_S = 120.0
MOST_OFFSET_S = 600.0
_COARSE_HZ = 2000.0
_RIVAL = 0.7  # a second place that fits nearly as well: the rhythm was too even
_BAND = Band(80.0, 6000.0, without_hum=False)
_LEAST_SIGMAS = 6.0
_REFINE_S = 0.25
_CONVERTER_S = 2e-5


@dataclass(frozen=True)
class EventOffset:
    """At ``moment_s`` of A, B's recording was ``offset_s`` ± ``sigma_s`` behind (it began so much later)."""

    moment_s: float
    offset_s: float
    sigma_s: float


def offset_of_event(pair: Pair, start_s: float, end_s: float, progress: Progress) -> EventOffset:
    """Return the clocks' offset from a stretch (seconds of A) in which both recorders lay side by side.

    Raises:
        LeaklineError: CORRELATION_NO_EVENT where nothing in B fits, or two places fit alike.
    """
    start_s, end_s = max(0.0, start_s), min(end_s, start_s + LONGEST_EVENT_S, pair.a.duration_s)
    if end_s - start_s < 0.5:
        raise LeaklineError(ErrorCode.CORRELATION_NO_EVENT, Place(pair.a.parts[0].path))
    coarse_s = _coarse(pair, start_s, end_s, progress.part(0.0, 0.6, "correlating"))
    aligned = Pair(pair.a, pair.b, Sync(SyncKind.TYPED, coarse_s), start_s, end_s)
    spectra = measure(aligned, min(2.0 * _REFINE_S, 0.2 * (end_s - start_s)), progress.part(0.6, 1.0))
    band = replace(_BAND, high_hz=min(_BAND.high_hz, 0.4 * min(pair.a.sample_rate_hz, pair.b.sample_rate_hz)))
    weight = weights(spectra, Weighting.SCOT, band)
    tops = peaks(correlate(spectra, spectra.s_ab, weight, 0.02))
    if not tops or tops[0].sigmas < _LEAST_SIGMAS:
        raise LeaklineError(ErrorCode.CORRELATION_NO_EVENT, Place(pair.b.parts[0].path))
    line = fit_phase(spectra, spectra.s_ab, band_gain(spectra.frequency_hz, band), tops[0], DispersionChoice())
    delay_s, sigma_s = (line.delay_s, line.sigma_s) if line is not None else (tops[0].delay_s, tops[0].half_width_s)
    # few knocks are no steady noise: their own sharpness is the honest floor
    sigma_s = max(sigma_s, _CONVERTER_S)
    return EventOffset(0.5 * (start_s + end_s), coarse_s - delay_s, sigma_s)


def sync_of_events(events: tuple[EventOffset, ...]) -> Sync:
    """Return offset and, from two events or more, drift: what must be added to B's clock."""
    if not events:
        return Sync(SyncKind.UNKNOWN)
    first = events[0]
    if len(events) == 1:
        return Sync(SyncKind.EVENT, first.offset_s, first.sigma_s, at_s=first.moment_s)
    moments = np.array([event.moment_s for event in events])
    offsets = np.array([event.offset_s for event in events])
    slope, start = np.polyfit(moments, offsets, 1)
    sigma_s = max(event.sigma_s for event in events)
    return Sync(SyncKind.EVENT, float(start), sigma_s, -1e6 * float(slope))


def _coarse(pair: Pair, start_s: float, end_s: float, progress: Progress) -> float:
    """Return the offset to about a millisecond by correlating loudness rises of A's event with B's recording."""
    step_s = 1e-3
    rises_a = _rises(pair.a, start_s, end_s, step_s)
    progress.update(0.3)
    from_s, to_s = max(0.0, start_s - MOST_OFFSET_S), min(pair.b.duration_s, end_s + MOST_OFFSET_S)
    rises_b = _rises(pair.b, from_s, to_s, step_s)
    if rises_a.size == 0 or rises_b.size < 10 or not rises_a.any() or not rises_b.any():
        raise LeaklineError(ErrorCode.CORRELATION_NO_EVENT, Place(pair.b.parts[0].path))
    length = fft.next_fast_len(len(rises_a) + len(rises_b), real=True)
    lines = fft.rfft(rises_a, length).conj() * fft.rfft(rises_b, length)
    circular = fft.irfft(lines, length)
    lags = np.concatenate([circular[-len(rises_a) + 1 :], circular[: len(rises_b)]])
    top = int(np.argmax(lags))
    far = np.abs(np.arange(len(lags)) - top) > round(0.05 / step_s)
    if far.any() and lags[far].max() > _RIVAL * lags[top]:
        raise LeaklineError(ErrorCode.CORRELATION_NO_EVENT, Place(pair.b.parts[0].path))
    progress.update(1.0)
    in_b_s = from_s + (top - len(rises_a) + 1) * step_s
    return start_s - in_b_s


def _rises(source: AudioSource, from_s: float, to_s: float, step_s: float) -> FloatArray:
    """Return by how much the logarithm of the power grows from step to step, where it grows; mean 0."""
    rate = source.sample_rate_hz
    size = max(1, round(rate * step_s))
    sections = signal.butter(2, min(300.0, 0.2 * rate), "highpass", fs=rate, output="sos")
    state = np.zeros((sections.shape[0], 2))
    powers = []
    with AudioReader(source) as reader:
        first, last = round(from_s * rate), round(to_s * rate)
        for at in range(first, last, size * 20_000):
            block, state = signal.sosfilt(sections, reader.read(at, min(size * 20_000, last - at)), zi=state)
            whole = len(block) // size * size
            powers.append((block[:whole].reshape(-1, size) ** 2).mean(axis=1))
    # steps of a whole number of samples drift from the millisecond grid: lay them on it
    power = np.concatenate(powers) if powers else np.zeros(0)
    moments = (np.arange(len(power)) + 0.5) * size / rate
    grid = np.arange(0.0, to_s - from_s, step_s)
    even = np.interp(grid, moments, power) if len(power) else np.zeros(0)
    level = np.log(np.maximum(even, 1e-12) + 0.01 * (np.mean(even) if len(even) else 0.0))
    slow = 8
    rise = np.maximum(level[slow:] - level[:-slow], 0.0) if len(level) > slow else np.zeros(0)
    return np.asarray(rise - rise.mean()) if rise.size else rise
