"""No word is shown that does not come from the translations: literals given to widgets are signs, units or names."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SHOWING = {
    "QLabel", "QPushButton", "QToolButton", "QCheckBox", "QRadioButton", "QGroupBox", "QAction",
    "setText", "setToolTip", "setStatusTip", "setWhatsThis", "setAccessibleName", "setAccessibleDescription",
    "setPlaceholderText", "setWindowTitle", "setTitle", "setSuffix", "setPrefix", "setTabText", "addTab", "addItem",
    "addItems", "addRow", "addMenu", "addAction", "setHeaderLabels", "setHorizontalHeaderLabels", "showMessage",
}  # fmt: skip
# what is the same in every language: our name, the languages' own names, systems, formats, keys, units
NAMES = {
    "Leakline", "English", "Türkçe", "EPSG", "WGS", "Hz", "kHz", "dB", "PVC", "PE100", "PE80", "IMU", "PDF", "PNG",
    "SVG", "CSV", "ZIP", "ppm", "ms", "mm", "bar", "psi", "GNSS", "UDP", "TCP",
}  # fmt: skip
WORD = re.compile(r"[^\W\d_]{2,}")


def shown_literals(source):
    """Return line and text of each literal with words that is handed to a widget as it is."""
    found = []
    for call in (node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Call)):
        name = getattr(call.func, "attr", getattr(call.func, "id", ""))
        if name in SHOWING:
            for argument in call.args[:1] if name == "addItem" else call.args:  # its second one is a value
                found += [(call.lineno, text) for text in _literals(argument) if set(WORD.findall(text)) - NAMES]
    return found


def _literals(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        yield node.value
    elif isinstance(node, ast.JoinedStr):
        yield "".join(part.value for part in node.values if isinstance(part, ast.Constant))
    elif isinstance(node, ast.IfExp):
        yield from (*_literals(node.body), *_literals(node.orelse))
    elif isinstance(node, ast.BinOp):
        yield from (*_literals(node.left), *_literals(node.right))


@pytest.mark.parametrize("package", ["app", "widgets"])
def test_no_widget_is_given_words_that_are_not_translated(package):
    found = {
        f"{path.relative_to(ROOT)}:{line}": text
        for path in sorted((ROOT / package).rglob("*.py"))
        for line, text in shown_literals(path.read_text(encoding="utf-8"))
    }
    assert found == {}


@pytest.mark.parametrize(
    ("line", "count"),
    [
        ('QLabel("Text")', 1),
        ('label.setText(f"{n} leaks")', 1),
        ('label.setText("Yes" if on else "No")', 2),
        ('label.setText(self.tr("Text"))', 0),
        ('label.setText(f"{n} dB")', 0),
        ('label.setObjectName("text")', 0),
        ('combo.addItem("Türkçe", "tr")', 0),
        ('combo.addItem("Turkish", "tr")', 1),
    ],
)
def test_the_search_finds_what_it_should(line, count):
    assert len(shown_literals(line)) == count
