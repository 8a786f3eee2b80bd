"""The detectors after the papers' methods: which band they chose, what they do without a path, and on silence."""

from dataclasses import replace

import numpy as np
import pytest
from sound_runs import Leak, drift

from processing.settings import DetectorSettings
from processing.sound.cells import cells_of, frames_of
from processing.sound.paper_detectors import find_by_kurtosis_band, find_by_spectrum, find_by_wavelet_band
from processing.sound.spots import Listening

ALL = (find_by_kurtosis_band, find_by_wavelet_band, find_by_spectrum)
SETTINGS = DetectorSettings(min_score=0.0)


def listening(run, path=True):
    frames = frames_of(run.scan, run.clock, run.track if path else None, (), SETTINGS)
    return Listening(run.scan, frames, cells_of(run.scan, frames) if path else None, SETTINGS)


@pytest.mark.parametrize("find", ALL[:2])
@pytest.mark.parametrize("centre_hz", [800.0, 3000.0])
def test_the_chosen_band_is_the_leaks(find, centre_hz):
    run = drift((Leak(90.0, 1.5, 12.0, centre_hz, 0.8),), seed=21, seconds=300.0)
    best = find(listening(run))[0]
    assert best.place == pytest.approx(90.0, abs=0.4)
    assert best.band_hz[0] < 1.3 * centre_hz
    assert best.band_hz[1] > centre_hz / 1.3
    assert best.band_hz[1] / best.band_hz[0] < 6.0


@pytest.mark.parametrize("find", ALL)
def test_without_a_path_the_moment_is_found(find):
    run = drift((Leak(60.0, 1.5, 12.0), Leak(120.0, 1.5, 12.0)), seed=22, seconds=300.0)
    spots = find(listening(run, path=False))[:2]
    moments = sorted(float(np.interp(place, run.chainage_m, run.time_s)) for place in (60.0, 120.0))
    assert sorted(spot.place for spot in spots) == pytest.approx(moments, abs=1.0)


@pytest.mark.parametrize("find", ALL)
def test_what_was_never_heard_gives_nothing(find):
    run = drift(seed=23, seconds=60.0)
    deaf = replace(run.scan, state=np.ones_like(run.scan.state))
    frames = frames_of(deaf, run.clock, None, (), SETTINGS)
    assert find(Listening(deaf, frames, None, SETTINGS)) == []


@pytest.mark.parametrize("find", ALL)
def test_a_rumble_below_the_chosen_band_is_no_leak(find):
    def rumble(time, place, hz):
        del time
        return (40.0 / (1 + (hz / 150.0) ** 6)) / (1 + ((place[:, None] - 100.0) / 1.5) ** 2)

    run = drift(seed=24, seconds=300.0, extra=rumble)
    assert not [spot for spot in find(listening(run)) if abs(spot.place - 100.0) < 4.0 and spot.score > 0.3]
