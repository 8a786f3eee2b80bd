"""Buttons flow into as many rows as they need, share a row's width, and never overlap."""

import pytest
from PySide6.QtWidgets import QPushButton, QWidget

from widgets.flow_layout import FlowLayout


@pytest.fixture
def flow(qtbot):
    holder = QWidget()
    qtbot.addWidget(holder)
    layout = FlowLayout(6)
    for _ in range(6):
        button = QPushButton("x")
        button.setFixedHeight(40)
        button.setMinimumWidth(100)
        layout.addWidget(button)
    holder.setLayout(layout)
    holder.show()
    return holder, layout


def boxes(holder, width):
    holder.resize(width, 400)
    holder.layout().activate()
    return [holder.layout().itemAt(i).geometry() for i in range(6)]


@pytest.mark.parametrize(("width", "rows"), [(640, 1), (630, 1), (629, 2), (320, 2), (311, 3), (100, 6), (60, 6)])
def test_there_are_as_many_rows_as_the_width_asks_for(flow, width, rows):
    holder, layout = flow
    found = boxes(holder, max(width, 100))
    assert len({box.top() for box in boxes(holder, width)}) == (rows if width >= 100 else 6)
    assert layout.heightForWidth(width) == 40 * rows + 6 * (rows - 1)
    for i, one in enumerate(found):
        assert not any(one.intersects(other) for other in found[i + 1 :])
        assert one.right() < max(width, 100)


def test_a_hidden_button_takes_no_room(flow):
    _holder, layout = flow
    layout.itemAt(0).widget().hide()
    assert layout.heightForWidth(530) == 40
    assert layout.sizeHint().width() == 5 * 100 + 4 * 6
