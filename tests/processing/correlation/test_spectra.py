"""The streamed spectra are those of scipy, at one rate or two, whatever is silent, clipped or offset."""

import numpy as np
import pytest
import soundfile
from correlator_runs import source_of
from scipy import signal

from processing import messages
from processing.correlation.reading import measure, segments
from processing.correlation.recordings import Pair, Sync, SyncKind, is_clipped, lay_grid
from processing.correlation.spectra import coherence_bound
from processing.errors import Cancelled, ErrorCode, LeaklineError
from processing.progress import Progress, silent
from processing.sound.source import open_audio

RATE = 4000


def noise(seconds, seed, rate=RATE):
    return 0.1 * np.random.default_rng(seed).standard_normal(int(seconds * rate))


def pair_of(folder, a, b, rates=(RATE, RATE), sync=None):
    return Pair(source_of(folder / "a.wav", a, rates[0]), source_of(folder / "b.wav", b, rates[1]), sync or Sync())


@pytest.fixture
def common(tmp_path):
    shared = noise(30, 1)
    return pair_of(tmp_path, shared + noise(30, 2), np.roll(shared, 37) + noise(30, 3))


def test_densities_and_coherence_are_those_of_scipy(common):
    spectra = measure(common, 1.0, silent())
    a, _ = soundfile.read(common.a.parts[0].path)
    b, _ = soundfile.read(common.b.parts[0].path)
    about = {"fs": RATE, "window": "hann", "nperseg": RATE, "noverlap": RATE // 2}
    frequency, cross = signal.csd(a, b, **about)
    np.testing.assert_allclose(spectra.frequency_hz, frequency)
    np.testing.assert_allclose(spectra.s_ab, cross, rtol=1e-5, atol=1e-4 * np.abs(cross).max())
    np.testing.assert_allclose(spectra.s_aa, signal.welch(a, **about)[1], rtol=1e-4)
    np.testing.assert_allclose(spectra.coherence, signal.coherence(a, b, **about)[1], atol=1e-3)


def test_a_part_of_the_recording_is_read_without_the_rest(common):
    whole = measure(common, 1.0, silent(), parts=1)
    parted = measure(common, 1.0, silent(), parts=12)
    assert len(parted.part_s) == 12
    np.testing.assert_allclose(parted.s_ab, whole.s_ab)
    stretch = measure(common.stretch(10.0, 20.0), 1.0, silent())
    assert stretch.used_s == pytest.approx(10.0, abs=0.6)
    assert 14.0 < np.average(stretch.part_s, weights=stretch.used) < 16.0


def test_two_rates_need_no_resampling(tmp_path):
    """The same sound at 4000 and 3000 samples a second is coherent throughout and not delayed."""
    rng = np.random.default_rng(7)
    lines = np.zeros(6001, complex)
    lines[200:5000] = rng.standard_normal(4800) + 1j * rng.standard_normal(4800)  # 16.7 .. 417 Hz, 12 s
    samples = [np.fft.irfft(np.concatenate([lines, np.zeros(rate * 6 - 6000)]), rate * 12) for rate in (4000, 3000)]
    pair = pair_of(tmp_path, *[0.1 * s / np.std(s) for s in samples], rates=(4000, 3000))
    spectra = measure(pair, 1.0, silent())
    inside = (spectra.frequency_hz > 30) & (spectra.frequency_hz < 400)
    assert spectra.frequency_hz[-1] == pytest.approx(1500.0)
    assert spectra.coherence[inside].min() > 0.999
    np.testing.assert_allclose(np.angle(spectra.s_ab[inside]), 0.0, atol=1e-3)
    np.testing.assert_allclose(spectra.s_aa[inside], spectra.s_bb[inside], rtol=0.01)


def test_odd_rates_get_whole_segments(tmp_path):
    pair = pair_of(tmp_path, noise(20, 1, 44100), noise(20, 2, 22051), rates=(44100, 22051))
    grid = lay_grid(pair, 0.9)
    assert grid.count_a / grid.rate_a_hz == grid.count_b / grid.rate_b_hz
    assert grid.count_a % 2 == grid.count_b % 2 == 0


def test_a_typed_offset_is_taken_off_to_a_part_of_a_sample(tmp_path):
    sound = noise(20, 5)
    offset_s = 1.00012
    late = np.fft.irfft(np.fft.rfft(sound) * np.exp(2j * np.pi * np.fft.rfftfreq(len(sound), 1 / RATE) * offset_s))
    pair = pair_of(tmp_path, sound, late, sync=Sync(SyncKind.TYPED, offset_s))
    spectra = measure(pair, 1.0, silent())
    inside = (spectra.frequency_hz > 20) & (spectra.frequency_hz < 1500)
    slope = np.polyfit(2 * np.pi * spectra.frequency_hz[inside], np.unwrap(np.angle(spectra.s_ab[inside])), 1)[0]
    assert abs(slope) < 1e-6


def test_chance_passes_the_bounds_as_rarely_as_they_say(tmp_path):
    spectra = measure(pair_of(tmp_path, noise(120, 11), noise(120, 12)), 0.5, silent())
    assert np.mean(spectra.coherence > coherence_bound(spectra.independent)) == pytest.approx(0.05, abs=0.03)
    assert np.mean(spectra.true_coherence > spectra.bound) < 0.05
    assert abs(np.mean(spectra.true_coherence)) < 0.1 * spectra.bound


def test_silent_and_clipped_stretches_are_left_out_and_counted(tmp_path):
    a, b = noise(30, 1), noise(30, 2)
    a[: 10 * RATE] = 0.0
    b[20 * RATE :] = np.clip(20.0 * b[20 * RATE :], -0.9, 0.9)
    spectra = measure(pair_of(tmp_path, a, b), 1.0, silent())
    assert spectra.counts.silent == 19  # whole segments within the first ten seconds
    assert spectra.counts.clipped == 20
    assert spectra.total + 19 + 20 == spectra.counts.segments


def test_a_sine_is_not_taken_for_clipping():
    assert not is_clipped(np.sin(np.arange(40000) * 0.1).astype(np.float32))


@pytest.mark.parametrize(
    ("spoil", "code", "name"),
    [
        (lambda a, b: (a, 0.0 * b), ErrorCode.CORRELATION_SILENT, "b.wav"),
        (lambda a, b: (0.0 * a, b), ErrorCode.CORRELATION_SILENT, "a.wav"),
        (lambda a, b: (np.clip(100 * a, -0.9, 0.9), b), ErrorCode.CORRELATION_ALL_CLIPPED, "a.wav"),
        (lambda a, b: (a[:900], b), ErrorCode.CORRELATION_TOO_SHORT, "a.wav"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(tmp_path, spoil, code, name):
    pair = pair_of(tmp_path, *spoil(noise(10, 1), noise(10, 2)))
    with pytest.raises(LeaklineError) as caught:
        measure(pair, 1.0, silent())
    assert caught.value.code is code
    assert caught.value.place.path.name == name
    assert all(name in messages.error_sentence(caught.value, language) for language in messages.LANGUAGES)


def test_recordings_that_do_not_overlap_are_refused(tmp_path):
    pair = pair_of(tmp_path, noise(10, 1), noise(10, 2), sync=Sync(SyncKind.TYPED, 50.0))
    with pytest.raises(LeaklineError) as caught:
        lay_grid(pair, 1.0)
    assert caught.value.code is ErrorCode.CORRELATION_TOO_SHORT
    assert caught.value.params["have_s"] == 0.0


def test_different_lengths_use_what_both_have(tmp_path):
    spectra = measure(pair_of(tmp_path, noise(30, 1), noise(12, 2)), 1.0, silent())
    assert spectra.used_s == pytest.approx(12.0, abs=0.6)


def test_reading_can_be_cancelled(common):
    with pytest.raises(Cancelled):
        measure(common, 1.0, Progress(is_cancelled=lambda: True))


def test_two_channels_of_one_file_are_two_recordings(tmp_path):
    both = np.column_stack([noise(10, 1), noise(10, 2)])
    soundfile.write(tmp_path / "both.wav", both, RATE)
    sources = [open_audio([tmp_path / "both.wav"], channel=c)[0] for c in (0, 1)]
    pair = Pair(*sources)
    assert pair.same_file
    first = next(segments(pair, lay_grid(pair, 1.0)))
    np.testing.assert_allclose(first.a, both[:RATE, 0], atol=1e-4)
    np.testing.assert_allclose(first.b, both[:RATE, 1], atol=1e-4)
