"""The reasons come when they are asked for, from what was measured; a known leak is kept, undone, and sizes others."""

import pytest
from PySide6.QtWidgets import QDialog, QLabel, QWidget
from small_survey import make_folder, make_results

from app.evidence_control import EvidenceControl
from app.page_tools import PageTools, TabTools
from app.survey_session import SurveySession
from processing.survey import CalibrationLeak
from widgets.evidence_panel import EvidencePanel
from widgets.known_leak_dialog import KnownFlow, KnownLeakDialog
from widgets.plot_theme import THEMES


@pytest.fixture
def session(qtbot, tmp_path):
    folder = make_folder(tmp_path)
    session = SurveySession()
    session.open(folder)
    session.set_results(make_results(folder))
    yield session
    session.close()


@pytest.fixture
def control(session, qtbot):
    beside = TabTools(QWidget(), "Motion", "beside")
    side = TabTools(QWidget(), "Leaks", "side")
    for widget in (beside, side):
        qtbot.addWidget(widget)
    tools = PageTools(beside, side)
    panel = EvidencePanel(THEMES["light"])
    tools.add_tool("why", "Why", panel, pages=("leaks",))
    tools.set_page("leaks")
    made = EvidenceControl(session, tools, panel, "en")
    yield made
    made.stop()


def said(control):
    return [label.text() for label in control._panel.findChildren(QLabel) if not label.isHidden()]


def test_nothing_is_measured_before_the_panel_is_in_front(control, session):
    assert not control._loader.busy
    control.toggle()
    assert control._tools.is_in_front("why")
    assert control._loader.busy or "Comparing" not in said(control)[0]
    control.toggle()
    assert not control._tools.is_in_front("why")


def test_the_selected_candidate_is_explained(control, session, qtbot):
    session.select(session.ordered_ids()[0])
    control.toggle()
    qtbot.waitUntil(lambda: not control._loader.busy, timeout=20000)
    first = said(control)[0]
    assert session.row(session.selected).name in first or "Nothing was heard" in first


def test_a_known_leak_is_kept_and_undone(control, session, monkeypatch):
    session.select(session.ordered_ids()[0])
    at = session.row(session.selected).candidate.chainage_m
    monkeypatch.setattr(KnownLeakDialog, "exec", lambda _self: QDialog.DialogCode.Accepted)
    monkeypatch.setattr(KnownLeakDialog, "answer", property(lambda _self: KnownFlow(12.0, 3.0)))
    control.mark_known()
    known = session.survey.calibration_leak
    assert known == CalibrationLeak(at, 12.0, 3.0, session.row(session.selected).name)
    assert session.folder.read_survey().calibration_leak == known
    session.undo_stack.undo()
    assert session.survey.calibration_leak is None
    assert session.folder.read_survey().calibration_leak is None
