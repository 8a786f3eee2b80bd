"""The report's table of digs says of each statement what the window and the history of digs say of it."""

from dataclasses import replace

import pytest

from processing.dig_statistics import errors_of
from processing.quantities import Units
from processing.reporting.appendix import dig_row
from processing.reporting.options import ReportOptions
from processing.reporting.words import Words
from processing.review_facts import DigFinding, DigResult

DIG = DigResult(
    2, DigFinding.LEAK, "2026-05-12", 0.9, stated_chainage_m=40.0, stated_low95_m=39.2, stated_high95_m=40.8
)  # fmt: skip


@pytest.mark.parametrize(
    ("off_m", "sigma_m", "held"),
    [
        (0.7, None, "yes"),
        (0.85, None, "yes"),  # beyond the window by less than the tape's own error of 0.2 m (1 sigma)
        (0.85, 0.01, "NO"),
        (-0.9, 0.01, "NO"),
        (1.5, None, "NO"),
    ],
)
def test_a_window_held_where_the_history_counts_it_as_held(off_m, sigma_m, held):
    dig = replace(DIG, off_along_m=off_m, sigma_m=sigma_m)
    assert dig_row(dig, Words(ReportOptions("en")))[5] == held
    assert bool(errors_of([dig]).held[0]) is (held == "yes")


def test_the_direction_stands_in_words_in_the_units_of_the_report():
    onward = dig_row(replace(DIG, off_along_m=3.048), Words(ReportOptions("en", units=Units.US)))
    assert onward[3].startswith("10.00 ft")
    backward = dig_row(replace(DIG, off_along_m=-1.8), Words(ReportOptions("tr")))
    assert backward[3].startswith("1,80 m")
    assert onward[3].split("ft")[1] != backward[3].split("m", 1)[1]


def test_what_was_not_measured_is_not_known():
    assert dig_row(replace(DIG, off_along_m=None), Words(ReportOptions("en")))[5] == "not known"
