"""What is heard: the loop's span, the volume's range, and the leak band filtered without a seam."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_survey import candidate

from app.listening import BandFilter
from app.player import LEAD_IN_S, LONGEST_LOOP_S, gain_of, loop_span

RATE_HZ = 8000.0


def tone(frequency_hz):
    return np.sin(2 * np.pi * frequency_hz * np.arange(16_000) / RATE_HZ).astype(np.float32)


def filtered(sound, sizes, band=(500.0, 1500.0)):
    band_filter = BandFilter(lambda start, count: sound[start : start + count], RATE_HZ, band)
    out, at = [], 0
    for size in sizes:
        out.append(band_filter(at, size))
        at += size
    return np.concatenate(out)


def test_volume_zero_is_silence_and_the_range_is_sixty_decibels():
    assert gain_of(0.0) == 0.0
    assert gain_of(2.0 / 3.0) == pytest.approx(1.0)
    assert gain_of(1.0) == pytest.approx(10.0)


@given(st.floats(0.0, 1e4))
def test_a_loop_has_its_lead_in_holds_the_candidate_and_is_never_endless(speed_mps):
    found = candidate(1, 40.0, 0.5)
    span = loop_span(found, speed_mps)
    assert span.start_s <= found.time_s - LEAD_IN_S
    assert span.end_s > found.time_s
    assert span.end_s - span.start_s <= LONGEST_LOOP_S + 1e-9


def test_the_band_passes_what_is_in_it_and_not_what_is_outside():
    inside, below, above = (filtered(tone(f), [16_000])[4000:] for f in (866.0, 100.0, 3500.0))
    assert np.sqrt(np.mean(inside**2)) == pytest.approx(np.sqrt(0.5), rel=0.05)
    assert np.abs(below).max() < 0.01
    assert np.abs(above).max() < 0.01


def test_blocks_join_without_a_seam():
    sound = np.random.default_rng(5).normal(0.0, 0.1, 16_000).astype(np.float32)
    np.testing.assert_allclose(filtered(sound, [16_000]), filtered(sound, [400] * 40), rtol=0, atol=1e-6)


def test_a_jump_starts_the_filter_anew():
    sound = tone(866.0)
    band_filter = BandFilter(lambda start, count: sound[start : start + count], RATE_HZ, (500.0, 1500.0))
    first = band_filter(0, 800)
    band_filter(800, 800)
    np.testing.assert_array_equal(band_filter(0, 800), first)


def test_a_band_above_what_was_recorded_still_gives_a_filter():
    assert np.all(np.isfinite(filtered(tone(1000.0), [16_000], band=(20_000.0, 40_000.0))))
