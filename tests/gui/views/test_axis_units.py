"""Axes along the pipe are marked at round places in the unit that people read, wherever the data are in metres."""

import numpy as np
import pytest
from PySide6.QtCore import QLocale, QPointF

from processing.quantities import Places, Quantities, Units
from widgets import units
from widgets.plan_geometry import PlanScale
from widgets.profile_view import ProfileView
from widgets.time_axis import AxisMode, x_text, x_ticks

FEET_A_METRE = 39.37 / 12.0  # the US survey foot: 39.37 inches are a metre exactly
US = Quantities("en", Units.US)
ENGLISH = QLocale(QLocale.Language.English)


@pytest.fixture
def in_feet(qapp):
    units.use(US)
    yield
    units.use(Quantities())


@pytest.mark.parametrize("span_m", [3.0, 47.0, 960.0, 21_000.0])
def test_ticks_stand_at_round_feet(span_m):
    ticks, step = x_ticks(12.3, 12.3 + span_m, AxisMode.DISTANCE, 8, US)
    feet = np.array(ticks) * FEET_A_METRE
    step_ft = step * FEET_A_METRE
    assert 3 <= len(ticks) <= 9
    assert step_ft / 10 ** np.floor(np.log10(step_ft) + 1e-9) == pytest.approx(
        round(step_ft / 10 ** np.floor(np.log10(step_ft) + 1e-9))
    )
    assert feet / step_ft == pytest.approx(np.round(feet / step_ft), abs=1e-6)
    assert np.all(feet >= 12.3 * FEET_A_METRE - 1e-6)


@pytest.mark.parametrize(
    ("write", "metres", "step_m", "label"),
    [
        (Quantities(), 1500.0, 500.0, "1500"),
        (US, 500.0 / FEET_A_METRE, 100.0 / FEET_A_METRE, "500"),
        (US, 2.5 / FEET_A_METRE, 0.5 / FEET_A_METRE, "2.5"),
        (Quantities(places=Places.STATIONING), 1500.0, 500.0, "1+500"),
        (Quantities("en", Units.US, Places.STATIONING), 1550.0 / FEET_A_METRE, 50.0 / FEET_A_METRE, "15+50"),
        (Quantities("tr", Units.METRIC, Places.STATIONING), 1500.5, 0.5, "1+500,5"),
    ],
)
def test_a_tick_is_written_as_places_are(write, metres, step_m, label):
    assert x_text(metres, step_m, AxisMode.DISTANCE, ENGLISH, write) == label


def test_time_is_time_in_any_unit():
    assert x_ticks(0.0, 600.0, AxisMode.TIME, 8, US) == x_ticks(0.0, 600.0, AxisMode.TIME, 8)


def test_the_profile_is_drawn_in_feet_and_its_marks_on_its_line(in_feet, cursor, track, shown, make_candidate):
    view = shown(ProfileView(cursor), 700, 300)
    view.set_track(track)
    here = cursor.position_at(500.0)
    view.set_candidates([make_candidate(1, 500.0, cursor.chainage_at(500.0), position=here)])
    view.grab()
    place = QPointF(view.pixel_of_time(500.0), view.y_of(here[2] * FEET_A_METRE))
    assert view.candidate_at(place) == 1
    assert view._readout(place).value == pytest.approx(here[2] * FEET_A_METRE, abs=0.02)
    assert view._readout(place).unit == "ft"
    assert view.y_range[0] < here[2] * FEET_A_METRE < view.y_range[1]


def test_the_bar_of_the_plan_is_round_in_feet(in_feet):
    from widgets.path_paint import _bar_length_m

    feet = _bar_length_m(PlanScale((0.0, 0.0), 3.3, (800.0, 600.0))) * FEET_A_METRE
    assert feet == pytest.approx(100.0)
