"""Whether the gyroscope turns as gravity says: the right unit must win on every kind of motion at hand."""

import numpy as np
import pytest
from scipy.io import loadmat

from processing.importing.coherence import coherence

DEG = np.pi / 180
FACTORS = (1.0, DEG, 1 / DEG, 10.0, 0.1, -1.0, 0.0)


def wins(found, winner, sigmas):
    assert found.best(found.factors) == winner
    for other in set(found.factors) - {winner}:
        assert found.margin(winner, other)[1] > sigmas, other


@pytest.mark.parametrize("spin", [0.5, 3.0, 20.0])
@pytest.mark.parametrize("rate_hz", [60.0, 400.0])
def test_the_right_factor_wins_on_a_tumbling_device(make, spin, rate_hz):
    rows = make(seconds=30.0, rate_hz=rate_hz, spin=spin)
    wins(coherence(rows.time, rows.acc, rows.gyr, FACTORS), 1.0, 3.0)
    assert coherence(rows.time, rows.acc, rows.gyr, FACTORS).mean[0] > 0.98


def test_a_wrong_unit_is_seen_as_the_factor_that_mends_it(make):
    rows = make(seconds=30.0)
    assert coherence(rows.time, rows.acc, rows.gyr / DEG, FACTORS).best(FACTORS) == DEG
    assert coherence(rows.time, rows.acc, rows.gyr * DEG, FACTORS).best(FACTORS) == 1 / DEG
    assert coherence(rows.time * 0.1, rows.acc, rows.gyr, FACTORS).best(FACTORS) == 10.0
    assert coherence(rows.time, rows.acc, -rows.gyr, FACTORS).best(FACTORS) == -1.0


def test_at_rest_nothing_is_claimed(make):
    rows = make(seconds=30.0, spin=0.0)
    found = coherence(rows.time, rows.acc, rows.gyr, (1.0, DEG))
    assert abs(found.margin(1.0, DEG)[0]) < 0.01


def test_too_little_data_gives_no_margin(make):
    rows = make(seconds=2.0)
    assert coherence(rows.time[:50], rows.acc[:50], rows.gyr[:50], FACTORS).margin(1.0, 0.0) == (0.0, 0.0)


@pytest.mark.data
@pytest.mark.parametrize("number", ["02", "06", "09", "16", "21", "28", "33", "36"])
def test_the_right_unit_wins_on_broad_however_it_is_shaken(shared_data, number):
    trial = loadmat(next((shared_data / "broad").glob(f"{number}_*.mat")))
    acc, gyr = trial["imu_acc"], trial["imu_gyr"]
    rate_hz = float(np.squeeze(trial["sampling_rate"]))
    wins(coherence(np.arange(len(acc)) / rate_hz, acc, gyr, FACTORS), 1.0, 5.0)
