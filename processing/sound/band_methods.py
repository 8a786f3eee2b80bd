"""In which band does a stretch of sound stand out of what lies around it? One map of bands for each way to ask."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from processing.errors import ErrorCode, LeaklineError
from processing.sound.band_choice import BandChoice
from processing.sound.kurtogram import Kurtogram, fast_kurtogram, kurtosis_band
from processing.sound.pcm import Samples
from processing.sound.source import AudioReader
from processing.sound.wavelet_packets import CRITERIA, packet_band, wavelet_packets
from processing.survey import AudioSource, FloatArray

LONGEST_S = 60.0  # of a stretch and of its background: a minute tells a band, and takes about a second
_FEWEST = 8192  # samples: 128 of the finest packets
_LEVELS = 6

Spans = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class BandMap:
    """Bands of several widths (n,): edges, ``row`` (0 the widest bands) and by how much the stretch stands out.

    ``choice`` is the band it stands out in most, None where it stands out in none beyond chance.
    """

    bands_hz: FloatArray  # (n, 2)
    row: FloatArray  # (n,)
    value: FloatArray  # (n,) dB for ``energy``, else without unit
    choice: BandChoice | None
    seconds: float
    background_s: float


def band_map(method: str, audio: AudioSource, span_s: tuple[float, float], background_s: Spans) -> BandMap:
    """Return the map of the stretch ``span_s`` against ``background_s``, both in audio seconds.

    ``method`` is one of ``BAND_METHODS``. Of a long stretch its middle minute is taken, of the background the minute
    nearest to the stretch, half on either side.

    Raises:
        LeaklineError: TOO_FEW_SAMPLES where either is too short; AUDIO_UNREADABLE.
    """
    compute = BAND_METHODS[method]
    rate = audio.sample_rate_hz
    middle, half = 0.5 * (span_s[0] + span_s[1]), 0.5 * min(span_s[1] - span_s[0], LONGEST_S)
    with AudioReader(audio) as reader:
        stretch = _read(reader, audio, [(middle - half, middle + half)])
        background = _read(reader, audio, _near(span_s, background_s))
    for samples in (stretch, background):
        if len(samples) < _FEWEST:
            raise LeaklineError(ErrorCode.TOO_FEW_SAMPLES, count=len(samples), needed=_FEWEST)
    bands, row, value, choice = compute(stretch, background, rate)
    return BandMap(bands, row, value, choice, len(stretch) / rate, len(background) / rate)


_Found = tuple[FloatArray, FloatArray, FloatArray, BandChoice | None]


def _by_kurtogram(stretch: Samples, background: Samples, rate: float) -> _Found:
    table, other = fast_kurtogram(stretch, rate, _LEVELS), fast_kurtogram(background, rate, _LEVELS)
    # a short stretch has fewer narrow bands: only what both have can be compared
    count = min(len(table.value), len(other.value))
    table, other = (_first_rows(each, count) for each in (table, other))
    rise = table.value - np.maximum(other.value, 0.0)
    row = np.searchsorted(np.unique(table.level), table.level).astype(np.float64)
    return table.bands_hz, row, rise, kurtosis_band(table, other)


def _first_rows(table: Kurtogram, count: int) -> Kurtogram:
    return Kurtogram(table.bands_hz[:count], table.level[:count], table.value[:count], table.sigma[:count])


def _by_packets(criterion: str) -> Callable[[Samples, Samples, float], _Found]:
    def found(stretch: Samples, background: Samples, rate: float) -> _Found:
        table, other = wavelet_packets(stretch, rate, _LEVELS), wavelet_packets(background, rate, _LEVELS)
        value = {
            "energy": 10.0 * np.log10(np.maximum(table.power, 1e-30) / np.maximum(other.power, 1e-30)),
            "kurtosis": table.kurtosis - other.kurtosis,
            "entropy": other.entropy - table.entropy,
        }[criterion]
        return table.bands_hz, table.level.astype(np.float64) - 1.0, value, packet_band(table, other, criterion)

    return found


BAND_METHODS: Mapping[str, Callable[[Samples, Samples, float], _Found]] = {
    **{criterion: _by_packets(criterion) for criterion in CRITERIA[:1]},
    "kurtogram": _by_kurtogram,
    **{criterion: _by_packets(criterion) for criterion in CRITERIA[1:]},
}


def _read(reader: AudioReader, audio: AudioSource, spans_s: Spans) -> Samples:
    pieces = [np.zeros(0, np.float32)]
    for start_s, end_s in spans_s:
        start, end = (round(min(max(t, 0.0), audio.duration_s) * audio.sample_rate_hz) for t in (start_s, end_s))
        if end > start:
            pieces.append(reader.read(start, end - start))
    return np.concatenate(pieces)


def _near(span_s: tuple[float, float], background_s: Spans) -> list[tuple[float, float]]:
    """Return of each background span the half minute nearest to the stretch."""
    share = LONGEST_S / max(len(background_s), 1)
    kept = []
    for low, high in background_s:
        if high <= span_s[0]:
            kept.append((max(low, high - share), high))
        else:
            kept.append((low, min(high, low + share)))
    return kept
