"""What lies in the folder, and the two small forms for what no program can know."""

import pytest
from PySide6.QtCore import Qt
from PySide6.QtWidgets import QComboBox, QPushButton

from processing.importing.column_mapping import ColumnMapping, MappedColumn, Quantity
from processing.importing.units import FACTORS
from widgets.column_mapping_table import MEANING, UNIT, ColumnMappingTable
from widgets.import_preview import ImportPreview, PreviewedFile
from widgets.raw_form import RawAnswer, RawForm

NAMES = ("t", "ax", "ay", "az", "gx", "gy", "gz")
ROWS = (("0", "1", "2", "3", "4", "5", "6"), ("10", "1", "2", "3", "4", "5", "6"))
GUESS = ColumnMapping((MappedColumn(0, Quantity.TIME, "ms", "t"), MappedColumn(1, Quantity.ACC_X, "g", "ax")))


@pytest.fixture
def table(qtbot):
    table = ColumnMappingTable()
    qtbot.addWidget(table)
    table.set_table(NAMES, ROWS, GUESS)
    return table


@pytest.fixture
def preview(qtbot):
    preview = ImportPreview()
    qtbot.addWidget(preview)
    preview.show()
    return preview


def choose(table, row, column, data):
    box = table._table.cellWidget(row, column)
    assert isinstance(box, QComboBox)
    assert box.findData(data) >= 0
    box.setCurrentIndex(box.findData(data))
    box.activated.emit(box.currentIndex())


def test_a_guess_comes_out_as_it_went_in(table):
    assert table.mapping() == GUESS


def test_each_choice_comes_out_as_a_whole_mapping(table):
    told = []
    table.mapping_changed.connect(told.append)
    choose(table, 2, MEANING, Quantity.ACC_Y)
    choose(table, 2, UNIT, "g")
    assert told[-1].column_of(Quantity.ACC_Y) == MappedColumn(2, Quantity.ACC_Y, "g", "ay")
    assert told[-1].column_of(Quantity.TIME) == GUESS.column_of(Quantity.TIME)


def test_a_meaning_belongs_to_one_column(table):
    choose(table, 3, MEANING, Quantity.ACC_X)
    mapping = table.mapping()
    assert [c.column for c in mapping.columns if c.quantity is Quantity.ACC_X] == [3]


@pytest.mark.parametrize("quantity", list(Quantity))
def test_every_unit_of_a_quantity_can_be_chosen(table, quantity):
    choose(table, 5, MEANING, quantity)
    for unit in FACTORS[quantity.kind]:
        choose(table, 5, UNIT, unit)
        assert table.mapping().column_of(quantity).unit == unit


def test_what_is_missing_is_said_until_it_is_there(table):
    assert "accelerometer y" in table._missing.text()
    for row, quantity in enumerate((Quantity.ACC_X, Quantity.ACC_Y, Quantity.ACC_Z), start=1):
        choose(table, row, MEANING, quantity)
    for row, quantity in enumerate((Quantity.GYR_X, Quantity.GYR_Y, Quantity.GYR_Z), start=4):
        choose(table, row, MEANING, quantity)
    assert table._missing.text() == ""
    assert table.mapping().missing == ()


def test_a_file_that_must_be_asked_about_is_in_front(preview):
    known = PreviewedFile("imu.csv", "motion", 10, NAMES, ROWS)
    unknown = PreviewedFile("log.csv", "motion", 10, NAMES, ROWS, GUESS)
    preview.set_files((known, unknown))
    assert preview._list.currentRow() == 1
    assert preview._below.currentWidget() is preview._mapping
    preview._list.setCurrentCell(0, 0)
    assert preview._rows.item(1, 0).text() == "10"


def test_a_chosen_mapping_names_its_file(preview, qtbot):
    preview.set_files((PreviewedFile("log.csv", "motion", 10, NAMES, ROWS, GUESS),))
    with qtbot.waitSignal(preview.mapping_chosen) as told:
        choose(preview._mapping, 2, MEANING, Quantity.ACC_Z)
    assert told.args[0] == "log.csv"
    assert told.args[1].column_of(Quantity.ACC_Z).column == 2


def test_the_form_for_headerless_sound_answers_only_when_it_is_complete(qtbot):
    form = RawForm()
    qtbot.addWidget(form)
    answers = []
    form.answered.connect(answers.append)
    form._rate.set_value(None)
    button = form.findChild(QPushButton, "raw_apply")
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert answers == []
    form._rate.set_value(96_000.0)
    form._kind.setCurrentIndex(2)
    form._channels.set_value(2.0)
    qtbot.mouseClick(button, Qt.MouseButton.LeftButton)
    assert answers == [RawAnswer(96_000.0, 32, "signed", "little", 2)]
