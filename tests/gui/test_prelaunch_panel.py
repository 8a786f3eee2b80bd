"""The panel of the check: what it asks for, what it shows, in both languages."""

import pytest
from PySide6.QtCore import Qt

from processing import messages
from processing.live.check_sheet import CheckItem, CheckSheet, CheckView, Light, Phase
from widgets.plot_theme import SUN
from widgets.prelaunch_panel import PrelaunchPanel, light_mark

SHEET = CheckSheet(
    "launch",
    "2026-05-04T09:00:00Z",
    (
        CheckItem("gravity", Light.GREEN, "gravity_good", {"size_mps2": 9.81, "off_pct": 0.1}),
        CheckItem("space", Light.RED, "space_short", {"left_h": 0.5, "planned_h": 2.0}),
        CheckItem("battery", Light.YELLOW, "battery_left", {"percent": 30.0}),
    ),
)


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_the_worst_light_comes_first_with_its_words(qtbot, language):
    panel = PrelaunchPanel(language)
    qtbot.addWidget(panel)
    panel.resize(500, 500)
    panel.show()
    panel.show_sheet(SHEET)
    red, yellow, green = panel.texts()
    assert messages.text("check_items", "space", language) in red
    assert "0.5" in red.replace(",", ".")
    assert messages.text("check_lights", "yellow", language) in yellow
    assert "9.81" in green.replace(",", ".")
    panel.apply_theme(SUN)
    assert panel.texts() == [red, yellow, green]
    panel.grab()
    panel.show_sheet(None)
    assert panel.texts() == []


def test_a_sheet_of_another_version_is_shown_as_it_is(qtbot):
    panel = PrelaunchPanel("en")
    qtbot.addWidget(panel)
    strange = (
        CheckItem("<b>wheels</b>", Light.RED, "wheels_off", {"count": 3.0}),
        CheckItem("space", Light.RED, "space_good", {}),
    )
    panel.show_sheet(CheckSheet("launch", "", strange))
    assert "wheels_off" in panel.texts()[0]
    assert "space_good" in panel.texts()[1]


def test_it_says_what_to_do_now_and_offers_what_makes_sense(qtbot):
    panel = PrelaunchPanel("en")
    qtbot.addWidget(panel)
    panel.show()
    panel.set_ready(devices=True, recording=False)
    assert panel.start.isEnabled()
    assert not panel.knocks.isEnabled()
    with qtbot.waitSignal(panel.check_asked) as asked:
        qtbot.mouseClick(panel.start, Qt.MouseButton.LeftButton)
    assert asked.args == ["launch"]
    panel.show_view(CheckView(Phase.REST, 0.3, moved=True))
    assert "moved" in panel.task
    assert panel.skip.isVisible()
    assert not panel.start.isVisible()
    panel.show_view(CheckView(Phase.KNOCK, 0.4, heard=3, felt=2, both=2))
    assert "five times" in panel.task
    assert "both 2" in panel.task
    with qtbot.waitSignal(panel.skip_asked):
        qtbot.mouseClick(panel.skip, Qt.MouseButton.LeftButton)
    panel.show_view(CheckView(Phase.DONE, 1.0))
    assert panel.start.isVisible()


def test_speed_and_range_are_remembered_values_and_told_when_changed(qtbot):
    panel = PrelaunchPanel("en")
    qtbot.addWidget(panel)
    panel.set_values(0.8, 1999.0)
    assert (panel.speed_mps, panel.gyro_range_dps) == (0.8, 2000.0)
    with qtbot.waitSignal(panel.changed):
        panel.gyro_range.setCurrentIndex(0)
    assert panel.gyro_range_dps == 250.0


def test_no_two_lights_share_a_shape():
    assert len({light_mark(light, SUN).shape for light in Light}) == len(Light)
