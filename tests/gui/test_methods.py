"""Trying several methods: the table, the paths on the plan, and taking one of them, which can be undone."""

import numpy as np
import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QLabel, QPushButton
from small_survey import make_folder, make_results

from app.comparison_control import ComparisonControl
from app.jobs import Jobs
from app.survey_session import SurveySession
from processing.storage.folder import SurveyFolder
from widgets.compared_paths import ComparedPath
from widgets.method_panel import MethodPanel, MethodRow, Outcome
from widgets.path_view import PathView

LEFT = Qt.MouseButton.LeftButton


@pytest.fixture
def panel(qtbot):
    panel = MethodPanel()
    qtbot.addWidget(panel)
    rows = (MethodRow("auto", "Automatic", "It chooses."), MethodRow("vqf", "VQF", "A filter.", ticked=False))
    panel.set_methods(rows, "auto", writable=True)
    panel.show()
    return panel


def button(widget, name):
    return widget.findChild(QPushButton, name)


def test_only_ticked_methods_are_asked_for(panel, qtbot):
    with qtbot.waitSignal(panel.compare_asked) as asked:
        qtbot.mouseClick(button(panel, "compare_methods"), LEFT)
    assert asked.args == [("auto",)]
    panel._item(0, 0).setCheckState(Qt.CheckState.Unchecked)
    assert not button(panel, "compare_methods").isEnabled()


def test_the_method_in_use_cannot_be_chosen_again_and_each_one_tells_what_it_is(panel, qtbot):
    words = panel.findChild(QLabel, "method_words")
    assert words.text() == "It chooses."
    panel._table.selectRow(0)
    assert not button(panel, "use_method").isEnabled()
    panel._table.selectRow(1)
    assert words.text() == "A filter."
    with qtbot.waitSignal(panel.use_asked) as asked:
        qtbot.mouseClick(button(panel, "use_method"), LEFT)
    assert asked.args == ["vqf"]


def test_outcomes_stand_beside_their_method_and_an_unknown_error_is_a_dash(panel):
    panel.set_outcomes({"vqf": Outcome(None, None, 0.5, 100.0, style=1), "auto": Outcome(trouble="It is broken.")})
    texts = [[panel._item(row, column).text() for column in range(1, 4)] for row in (0, 1)]
    assert texts == [["cannot", "", ""], ["–", "–", "+0.50 m"]]
    assert panel._item(0, 1).toolTip() == "It is broken."
    panel.set_outcomes({})
    assert panel._item(1, 3).text() == ""


@pytest.fixture
def opened(qtbot, tmp_path):
    session, jobs, panel = SurveySession(), Jobs(), MethodPanel()
    plan = PathView(session.cursor)
    for widget in (panel, plan):
        qtbot.addWidget(widget)
    control = ComparisonControl(session, jobs, panel, plan, "en")
    session.open(make_folder(tmp_path))
    session.set_results(make_results(session.folder))
    yield session, jobs, panel, plan, control
    jobs.stop_all()
    session.close()


def test_methods_are_tried_in_the_background_and_drawn(opened, qtbot):
    _, jobs, panel, plan, control = opened
    control.compare(("gyro", "device"))
    assert not button(panel, "compare_methods").isEnabled()
    qtbot.waitUntil(lambda: not jobs.running, timeout=20_000)
    rows = {row.name: k for k, row in enumerate(panel._rows)}
    assert panel._item(rows["device"], 1).text() == "cannot"  # the log has no quaternions
    assert panel._item(rows["gyro"], 3).text() == "−100.00 m"  # a ball that never turns misses all of the 100 m
    assert len(plan._compared._paths) == 1
    control.clear()
    assert len(plan._compared._paths) == 0


def test_using_another_method_is_written_and_can_be_undone(opened, qtbot):
    session, _, panel, _, control = opened
    with qtbot.waitSignal(control.reprocess_asked):
        panel.use_asked.emit("madgwick6" if any(r.name == "madgwick6" for r in panel._rows) else "madgwick")
    with SurveyFolder.open(session.folder.path, read_only=True) as other:
        assert other.read_survey().processing.orientation.startswith("madgwick")
    session.undo_stack.undo()
    assert session.survey.processing.orientation == "auto"


def test_compared_paths_are_held_in_view(qtbot, opened):
    *_, plan, _ = opened
    plan.resize(400, 300)
    far = ComparedPath("far", np.array([[0.0, 0.0], [5000.0, 0.0]]), 2)
    plan.set_compared((far,))
    plan.fit()
    x, _ = plan.plan_scale.pixel(5000.0, 0.0)
    assert 0 < x < 400


def test_the_selected_method_is_lifted_above_the_path_and_the_comparison_stays_on_its_page(opened):
    *_, panel, plan, control = opened
    rows = [row.name for row in panel._rows]
    style = rows.index("vqf")
    plan.resize(400, 300)
    plan.set_compared((ComparedPath("other", 2.0 * np.eye(2), style + 1), ComparedPath("vqf", np.eye(2), style)))
    panel._table.selectRow(style)
    lines = plan._compared
    plan._prepare()
    other, lifted = lines._items
    assert lifted.zValue() > plan._lines._line.zValue() > other.zValue()
    assert lifted.opts["pen"].widthF() > 2 * other.opts["pen"].widthF()
    assert lines._shown[0].name == "vqf"  # named while there is room
    plan.set_compared_visible(False)
    plan._prepare()
    assert not lifted.isVisible()
    assert len(lines.places) == 0  # what is not shown needs no room
    assert control is not None
