"""The mains by which leak detectors are measured keep to what they promise."""

from collections import Counter

import numpy as np
import pytest

from processing.simulation.leak_trials import LEAKS_APART_M, SNR_CLASSES_DB, leaky_main, other_main
from processing.simulation.route import centre_line
from processing.simulation.scenario_file import from_mapping, to_mapping
from processing.simulation.sound import frequencies
from processing.simulation.sources import background_shape, peak_power, shape_of
from processing.survey import LeakClass

KINDS = pytest.mark.parametrize("main", [leaky_main, other_main])
SEEDS = range(40)


def leaks_of(scenario):
    return [x for x in scenario.sound.local if x.kind is LeakClass.LEAK]


@KINDS
def test_each_main_holds_five_to_eight_leaks_well_apart_and_inside(main):
    for seed in SEEDS:
        scenario = main(seed)
        places = np.array([x.chainage_m for x in leaks_of(scenario)])
        assert 5 <= len(places) <= 8
        assert np.diff(places).min() >= LEAKS_APART_M
        assert 420 <= scenario.route.length_m <= 900
        assert places[0] >= 10
        assert places[-1] <= scenario.route.length_m - 10


@KINDS
def test_all_snr_classes_are_met_about_equally_often(main):
    count = Counter(x.snr_db for seed in SEEDS for x in leaks_of(main(seed)))
    assert set(count) == set(SNR_CLASSES_DB)
    assert min(count.values()) > 0.7 * max(count.values())


@KINDS
def test_every_kind_of_false_source_is_met_and_a_main_can_be_kept_in_a_file(main):
    kinds = Counter()
    for seed in SEEDS:
        scenario = main(seed)
        sound = scenario.sound
        kinds.update({str(x.kind) for x in (*sound.local, *sound.timed)})
        kinds.update({"pump"} if sound.pumps else set())
        kinds.update({"stop"} if scenario.drive.stops else set())
        kinds.update({"joints"} if sound.joints.spacing_m else set())
        assert from_mapping(to_mapping(scenario)) == scenario
    assert {"leak", "valve", "air", "traffic", "pump", "stop"} <= set(kinds)
    assert kinds["joints"] == (40 if main is leaky_main else 0)


def test_the_same_seed_is_the_same_main_and_another_is_another():
    assert leaky_main(3) == leaky_main(3)
    assert leaky_main(3) != leaky_main(4)
    assert other_main(3) == other_main(3)


def test_the_line_of_a_main_is_as_long_as_it_says():
    scenario = leaky_main(5)
    assert centre_line(scenario.route).length_m == pytest.approx(scenario.route.length_m, abs=1e-3)


def test_a_leak_of_the_other_kind_nowhere_stands_out_more_than_its_snr_says():
    hz = frequencies(44100)
    for seed in range(6):
        scenario = other_main(seed)
        background = background_shape(scenario, hz)
        for leak in leaks_of(scenario):
            power = peak_power(leak, background, hz) * shape_of(leak, hz)
            for centre in 300.0 * 2.0 ** np.arange(0.0, 4.01, 0.25):
                inside = np.abs(np.log2(np.maximum(hz, 1.0) / centre)) <= 0.9
                assert 10 * np.log10(power[inside].sum() / background[inside].sum()) <= leak.snr_db + 0.5


def test_leaks_of_the_other_kind_are_no_bells():
    hz = frequencies(44100)
    octave = np.log2(np.maximum(hz, 1.0))
    for leak in leaks_of(other_main(1)):
        shape = shape_of(leak, hz)
        inside = shape > 1e-3 * shape.max()
        level = np.log(shape[inside])
        rest = level - np.polyval(np.polyfit(octave[inside], level, 2), octave[inside])  # a bell is a parabola
        assert np.std(rest) * 10 / np.log(10) > 0.8
        assert leak.shape == "exponential"
        assert leak.turning > 0
