"""The list and the decision panel: what they show, what they announce, and what they leave to others."""

import math

import pytest
from PySide6.QtCore import QLocale, Qt
from PySide6.QtWidgets import QComboBox, QLabel, QSlider, QToolButton, QWidget

from processing.survey import Candidate, Decision, LeakClass, Verdict
from widgets.candidate_row import CandidateRow, sort_rows
from widgets.candidate_table import NOTE, VERDICT, CandidateTable
from widgets.decision_panel import DecisionPanel
from widgets.note_field import NoteField
from widgets.playback_bar import PlaybackBar
from widgets.plot_theme import LIGHT
from widgets.toast import Toast
from widgets.vocabulary import clock_text, number, place_text, verdict_icon, verdict_text


def candidate(number, *, chainage_m=10.0, score=0.5, half_m=1.0):
    return Candidate(
        id=number,
        time_s=chainage_m / 0.5,
        chainage_m=chainage_m,
        chainage_low95_m=chainage_m - half_m,
        chainage_high95_m=chainage_m + half_m,
        position_w_m=(chainage_m, 0.0, 0.0),
        score=score,
        level_db=6.0,
        leak_class=LeakClass.LEAK,
        band_hz=(500.0, 4000.0),
        width_m=3.0,
    )


ROWS = [
    CandidateRow(candidate(1, chainage_m=30.0, score=0.4), Decision()),
    CandidateRow(
        candidate(2, chainage_m=10.0, score=0.9), Decision(Verdict.CONFIRMED, LeakClass.VALVE, "at the\nvalve")
    ),
    CandidateRow(candidate(3, chainage_m=20.0, score=math.nan), Decision(), manual=True),
]


@pytest.fixture
def table(qtbot):
    table = CandidateTable(LIGHT)
    qtbot.addWidget(table)
    table.resize(700, 400)
    table.set_rows(sort_rows(ROWS, "score"))
    table.show()
    return table


@pytest.fixture
def panel(qtbot):
    panel = DecisionPanel(LIGHT)
    qtbot.addWidget(panel)
    panel.show()
    return panel


def text(table, row, column):
    return table.model.data(table.model.index(row, column), Qt.ItemDataRole.DisplayRole)


def test_best_score_comes_first_and_an_unknown_score_last():
    assert [row.candidate.id for row in sort_rows(ROWS, "score")] == [2, 1, 3]
    assert [row.candidate.id for row in sort_rows(ROWS, "chainage")] == [2, 3, 1]


def test_the_order_is_the_same_whatever_the_order_of_input():
    for order in ("score", "chainage"):
        forwards, backwards = sort_rows(ROWS, order), sort_rows(ROWS[::-1], order)
        assert [r.candidate.id for r in forwards] == [r.candidate.id for r in backwards]


def test_a_verdict_is_a_word_and_a_mark_and_the_note_stands_on_one_line(table):
    assert text(table, 0, VERDICT) == verdict_text(Verdict.CONFIRMED)
    assert not table.model.data(table.model.index(0, VERDICT), Qt.ItemDataRole.DecorationRole).isNull()
    assert text(table, 0, NOTE) == "at the valve"
    assert text(table, 2, 0) == "M3"


def test_choosing_by_hand_is_announced_and_selecting_by_program_is_not(table, qtbot):
    chosen = []
    table.candidate_chosen.connect(chosen.append)
    table.select(1)
    assert (table.selected_id(), chosen) == (1, [])
    table._table.selectRow(2)
    assert chosen == [3]


def test_a_new_decision_keeps_the_selection(table):
    table.select(1)
    table.set_decision(1, Decision(Verdict.REJECTED))
    assert table.selected_id() == 1
    assert text(table, 1, VERDICT) == verdict_text(Verdict.REJECTED)


def test_an_empty_list_says_what_to_do(table):
    table.set_rows(())
    assert not table._empty.isHidden()
    assert table.selected_id() is None


def test_verdict_marks_differ_in_shape_not_only_in_colour(qapp):
    greys = set()
    for verdict in Verdict:
        image = verdict_icon(LIGHT, verdict, 32).pixmap(32, 32).toImage()
        greys.add(bytes(1 if image.pixelColor(x, y).alpha() > 128 else 0 for y in range(32) for x in range(32)))
    assert len(greys) == len(Verdict)


def test_buttons_announce_verdicts_and_show_what_is_decided_not_what_was_clicked(panel, qtbot):
    panel.show_row(ROWS[0], writable=True)
    chosen = []
    panel.verdict_chosen.connect(chosen.append)
    for verdict in Verdict:
        button = panel.findChild(QToolButton, f"verdict_{verdict.value}")
        qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
        assert not button.isChecked()  # nobody has decided: the row is still undecided
    assert chosen == list(Verdict)
    assert all(isinstance(verdict, Verdict) for verdict in chosen)


def test_the_panel_shows_the_place_with_its_interval(panel):
    panel.show_row(ROWS[0], writable=True, evidence="louder than all")
    assert panel.findChild(QLabel, "candidate_title").text() == f"L1 · {number(30, 1)} m ± {number(1, 1)} m"
    assert panel.findChild(QLabel, "candidate_evidence").text() == "louder than all"


def test_buttons_are_large_enough_for_gloves(panel):
    assert min(b.minimumHeight() for b in panel.findChildren(QToolButton)) >= 40


def test_nothing_can_be_decided_in_a_read_only_survey(panel):
    panel.show_row(ROWS[0], writable=False)
    assert not any(button.isEnabled() for button in panel.findChildren(QToolButton))
    assert panel._note.isReadOnly()


def test_a_class_is_announced_and_the_first_entry_means_the_machines(panel):
    panel.show_row(ROWS[1], writable=True)
    box = panel.findChild(QComboBox, "leak_class")
    assert box.currentData() == LeakClass.VALVE
    chosen = []
    panel.class_chosen.connect(chosen.append)
    box.activated.emit(box.findData(LeakClass.PUMP))
    box.activated.emit(0)
    assert chosen == [LeakClass.PUMP, None]
    assert isinstance(chosen[0], LeakClass)


def test_a_note_is_announced_while_it_is_typed(panel, qtbot):
    panel.show_row(ROWS[0], writable=True)
    told = []
    panel.note_changed.connect(lambda candidate_id, note: told.append((candidate_id, note)))
    panel.focus_note()
    qtbot.keyClicks(panel._note, "wet")
    qtbot.waitUntil(lambda: bool(told), timeout=1000)
    assert told == [(1, "wet")]


def test_changing_the_candidate_saves_the_note_of_the_one_before(panel, qtbot):
    panel.show_row(ROWS[0], writable=True)
    told = []
    panel.note_changed.connect(lambda candidate_id, note: told.append((candidate_id, note)))
    qtbot.keyClicks(panel._note, "wet")
    panel.show_row(ROWS[1], writable=True)
    assert told == [(1, "wet")]
    assert panel._note.toPlainText() == "at the\nvalve"
    panel.flush()
    assert told == [(1, "wet")]


def test_enter_ends_a_note_and_shift_enter_makes_a_line(qtbot):
    field = NoteField()
    qtbot.addWidget(field)
    notes, left = [], []
    field.note_changed.connect(notes.append)
    field.left.connect(lambda: left.append(True))
    qtbot.keyClicks(field, "one")
    qtbot.keyClick(field, Qt.Key.Key_Return, Qt.KeyboardModifier.ShiftModifier)
    qtbot.keyClicks(field, "two")
    assert left == []
    qtbot.keyClick(field, Qt.Key.Key_Return)
    assert notes == ["one\ntwo"]
    assert left == [True]


def test_numbers_follow_the_locale_and_a_missing_one_is_a_dash(qapp):
    before = QLocale()
    try:
        QLocale.setDefault(QLocale(QLocale.Language.Turkish))
        assert number(1.25, 2) == "1,25"
        assert number(math.nan, 1) == number(None, 1) == "–"
        assert clock_text(3725.04) == "1:02:05,0"
    finally:
        QLocale.setDefault(before)


@pytest.mark.parametrize(
    ("time_s", "shown"), [(0.0, "0:00.0"), (59.96, "1:00.0"), (3599.97, "1:00:00.0"), (-2.5, "−0:02.5")]
)
def test_clock_text_carries_over_and_never_shows_sixty_seconds(time_s, shown):
    before = QLocale()
    try:
        QLocale.setDefault(QLocale.c())
        assert clock_text(time_s) == shown
    finally:
        QLocale.setDefault(before)


def test_numbers_have_a_true_minus_and_no_minus_zero():
    assert number(-1.25, 1) in ("−1.2", "−1.3")
    assert number(-0.004, 2) == "0.00"


def test_a_place_is_never_told_without_its_interval():
    assert place_text(candidate(1, chainage_m=41.26, half_m=0.5)) == "41.3 m ± 0.5 m"


@pytest.mark.parametrize("hint", ["No sound card", "This survey has no sound."])
def test_why_nothing_can_be_heard_is_never_cut(qtbot, hint):
    bar = PlaybackBar()
    qtbot.addWidget(bar)
    bar.set_available(hint)
    bar.resize(bar.minimumSizeHint())
    bar.show()
    label, volume = bar.findChild(QLabel, "playback_hint"), bar.findChild(QSlider)
    assert label.text() == hint
    assert label.width() >= label.fontMetrics().horizontalAdvance(hint)
    assert volume.isHidden()
    bar.set_available("")
    assert not volume.isHidden()
    assert label.minimumWidth() == 0


def test_a_toast_says_all_of_a_long_sentence_in_more_lines(qtbot):
    page = QWidget()
    qtbot.addWidget(page)
    page.resize(300, 400)
    toast = Toast(page)
    page.show()
    toast.tell("short")
    one_line = toast.height()
    words = "Nothing undecided is left in this list; undecided ones that the filter hides: 12"
    toast.tell(words)
    box = toast.fontMetrics().boundingRect(0, 0, toast.contentsRect().width(), 1000, Qt.TextFlag.TextWordWrap, words)
    assert page.rect().contains(toast.geometry())
    assert toast.height() >= box.height() > one_line / 2
    assert toast.width() >= box.width()
    toast.stop()
