"""Quantities are written as people read them; the conversions are checked against published definitions."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from processing.quantities import Places, Quantities, Units

EN, TR = Quantities("en"), Quantities("tr")
US = Quantities("en", Units.US)
STATIONS = Quantities("en", places=Places.STATIONING)
US_STATIONS = Quantities("en", Units.US, Places.STATIONING)


@pytest.mark.parametrize(
    ("how", "metres", "text"),
    [
        (EN, 1234.56, "1,234.6 m"),
        (TR, 1234.56, "1.234,6 m"),
        (EN, -0.04, "0.0 m"),
        (TR, -12.3, "−12,3 m"),
        (US, 1200.0, "3,937.0 ft"),  # the definition of the US survey foot
        (EN, None, "–"),
        (EN, math.nan, "–"),
    ],
)
def test_a_length_reads_as_its_language_and_units_have_it(how, metres, text):
    assert how.length(metres) == text


@pytest.mark.parametrize(
    ("how", "metres", "text"),
    [
        (EN, 1234.56, "1,234.6 m"),
        (STATIONS, 1234.56, "1+234.6"),
        (STATIONS, 4.2, "0+004.2"),
        (STATIONS, 999.96, "1+000.0"),  # rounded before it is parted
        (STATIONS, -3.0, "−0+003.0"),
        (STATIONS, -0.01, "0+000.0"),
        (US_STATIONS, 1200.0, "39+37.0"),
        (Quantities("tr", places=Places.STATIONING), 12.34, "0+012,3"),
    ],
)
def test_a_place_reads_as_on_the_plan(how, metres, text):
    assert how.place(metres) == text


def test_other_quantities_have_their_units():
    assert EN.small_length(0.3) == "300 mm"
    assert US.small_length(0.3048) == "12.0 in"
    assert EN.pressure(3.25) == "3.2 bar"
    assert US.pressure(1.0) == "15 psi"
    assert US.flow(3.785411784) == "1.0 gal/min"
    assert TR.flow(8.3) == "8,3 L/dak"
    assert (EN.day("2026-05-04"), TR.day("2026-05-04"), EN.day("yesterday")) == (
        "4 May 2026",
        "04.05.2026",
        "yesterday",
    )


@given(st.floats(-1e5, 1e5), st.sampled_from([EN, TR, US, US_STATIONS]))
def test_what_is_typed_back_is_the_length_that_was_shown(metres, how):
    assert how.to_metres(metres * how.length_factor) == pytest.approx(metres, abs=1e-9)


@given(st.floats(0.0, 1e5))
def test_a_station_holds_the_same_metres_as_the_chainage(metres):
    whole, rest = STATIONS.place(metres, 2).split("+")
    assert int(whole) * 1000 + float(rest) == pytest.approx(metres, abs=0.005001)
