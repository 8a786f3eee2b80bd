"""The panel of reasons: says what it is told, in order, and is reached by a key."""

import numpy as np
import pytest

from widgets.evidence_panel import ROWS, EvidencePanel, EvidenceRow, ShownEvidence
from widgets.evidence_plots import SmallPlot, Weighed
from widgets.plot_theme import THEMES


def shown(rows=3, size="small or medium: …"):
    x = np.geomspace(100.0, 7000.0, 28)
    away = np.linspace(-8, 8, 33)
    fit = 10 * np.log10(1 + 9 / (1 + (away / 1.5) ** 2))
    return ShownEvidence(
        "L1: leak, 93 % a leak",
        size,
        (("leak", 0.93), ("air pocket", 0.05), ("unknown", 0.02)),
        tuple(
            EvidenceRow(f"Sentence {i}.", Weighed(float(i), (0.0, 1.0, 2.0, 3.0, 4.0), 1.0 - i)) for i in range(rows)
        ),
        SmallPlot(x, 10 * np.exp(-0.5 * (np.log2(x / 1300)) ** 2), np.array([x * 0 - 1, x * 0 + 1]), logarithmic=True),
        SmallPlot(away, fit, None, away, fit, dots=True),
        42,
    )


def texts(panel):
    from PySide6.QtWidgets import QLabel

    return [label.text() for label in panel.findChildren(QLabel) if not label.isHidden()]


@pytest.fixture
def panel(qtbot):
    widget = EvidencePanel(THEMES["light"])
    qtbot.addWidget(widget)
    widget.resize(400, 700)
    widget.show()
    return widget


def test_without_evidence_there_is_one_sentence_and_no_picture(panel):
    panel.show_evidence(None, "Comparing …")
    assert texts(panel) == ["Comparing …"]


def test_it_shows_title_size_places_and_the_strongest_reasons(panel):
    panel.show_evidence(shown(rows=ROWS + 3), "")
    said = texts(panel)
    assert said[0] == "L1: leak, 93 % a leak"
    assert said[1].startswith("small or medium")
    assert said[2:-1] == [f"Sentence {i}." for i in range(ROWS)]
    assert "42" in said[-1]


def test_what_is_not_known_leaves_no_hole(panel):
    panel.show_evidence(shown(rows=1, size=""), "")
    assert [t for t in texts(panel) if not t] == []
    assert sum(t.startswith("Sentence") for t in texts(panel)) == 1


@pytest.mark.parametrize("name", THEMES)
def test_the_value_is_drawn_where_it_lies_among_the_usual_ones(panel, name):
    theme = THEMES[name]
    panel.apply_theme(theme)

    def dot_x(value):
        panel.show_evidence(
            ShownEvidence("t", "", (), (EvidenceRow("s", Weighed(value, (0.0, 1.0, 2.0, 3.0, 4.0), 0.0)),),
                          SmallPlot(np.zeros(0), np.zeros(0)), SmallPlot(np.zeros(0), np.zeros(0)), 1), ""
        )  # fmt: skip
        strip = panel._strips[0]
        strip.resize(360, 30)
        image = strip.grab().toImage()
        from PySide6.QtGui import QColor

        wanted = QColor(theme.cursor)
        hits = [
            x
            for x in range(image.width())
            for y in range(image.height())
            if sum(abs(a - b) for a, b in zip(image.pixelColor(x, y).getRgb()[:3], wanted.getRgb()[:3], strict=True))
            < 12
        ]
        return float(np.mean(hits))

    below, middle, above = dot_x(0.5), dot_x(2.0), dot_x(3.5)
    assert below < middle < above
    assert middle - below == pytest.approx(above - middle, abs=3)


def test_values_that_are_no_numbers_are_painted_without_a_fault(panel):
    nan = float("nan")
    empty = SmallPlot(np.array([1.0, 2.0]), np.array([nan, nan]))
    row = EvidenceRow("s", Weighed(nan, (nan,) * 5, -9.0))
    panel.show_evidence(ShownEvidence("t", "", (("leak", 0.0),), (row,), empty, empty, 0), "")
    assert not panel.grab().isNull()
