"""What is wrong with widgets as they stand: words that are cut, names that are missing, places no key leads to."""

import re

from PySide6.QtCore import Qt
from PySide6.QtGui import QAccessible, QKeySequence
from PySide6.QtTest import QTest
from PySide6.QtWidgets import (
    QAbstractButton,
    QAbstractItemView,
    QAbstractSpinBox,
    QApplication,
    QCheckBox,
    QComboBox,
    QHeaderView,
    QLabel,
    QLineEdit,
    QPlainTextEdit,
    QPushButton,
    QScrollArea,
    QSlider,
    QTabBar,
    QToolButton,
    QWidget,
)

from app.actions import ACTIONS

INTERACTIVE = (
    QAbstractButton,
    QComboBox,
    QLineEdit,
    QAbstractSpinBox,
    QAbstractItemView,
    QPlainTextEdit,
    QSlider,
    QTabBar,
)
SLACK = 2  # pixels that rounding may cost
MOST_SECTIONS = 4  # of one field that Tab leads through: day, month, year
ARROW = 24  # pixels of a choice that are not its text


def bare(text):
    """Return a text without the marks of its mnemonics."""
    return re.sub(r"&(?=\w)", "", text)


def told(widget):
    """Return how widgets are named in a failure."""
    text = widget.text() if hasattr(widget, "text") and callable(widget.text) else ""
    return f"{type(widget).__name__} {widget.objectName()} {text!r} {widget.width()}×{widget.height()}"


def cut_words(window):
    """Return all visible widgets whose words do not fit into them and are in no tool tip either."""
    found = [told(w) for w in window.findChildren(QWidget) if w.isVisible() and not w.toolTip() and _is_cut(w)]
    for bar in window.findChildren(QTabBar):
        if bar.isVisible():
            found += [f"tab {bar.tabText(row)!r}" for row in range(bar.count()) if _tab_is_cut(bar, row)]
    for header in window.findChildren(QHeaderView):
        if header.isVisible() and header.orientation() is Qt.Orientation.Horizontal:
            found += _cut_titles(header)
    for area in window.findChildren(QScrollArea):
        if area.isVisible() and area.horizontalScrollBarPolicy() is Qt.ScrollBarPolicy.ScrollBarAlwaysOff:
            wanted, room = area.widget().minimumSizeHint().width(), area.viewport().width()
            if wanted > room + SLACK:
                found.append(f"{told(area.widget())} in {told(area.parentWidget())} wants {wanted} of {room}")
    return found


def _is_cut(widget):
    metrics, room = widget.fontMetrics(), widget.width() + SLACK
    if isinstance(widget, QCheckBox):
        return widget.sizeHint().width() > room
    if isinstance(widget, QPushButton | QToolButton):
        words = max((metrics.horizontalAdvance(line) for line in bare(widget.text()).split("\n")), default=0)
        below = (
            isinstance(widget, QToolButton) and widget.toolButtonStyle() is Qt.ToolButtonStyle.ToolButtonTextUnderIcon
        )
        icon = 0 if widget.icon().isNull() or below else widget.iconSize().width() + 4
        return bool(words) and words + icon > room
    if isinstance(widget, QComboBox):
        return metrics.horizontalAdvance(widget.currentText()) + ARROW > room
    if isinstance(widget, QLabel) and widget.text() and widget.pixmap().isNull():
        if widget.wordWrap():
            return widget.heightForWidth(widget.width()) > widget.height() + SLACK
        return widget.minimumSizeHint().width() > room or widget.minimumSizeHint().height() > widget.height() + SLACK
    return False


def _tab_is_cut(bar, row):
    if not bar.isTabVisible(row):
        return False
    rect = bar.tabRect(row)
    return bar.fontMetrics().horizontalAdvance(bar.tabText(row)) > rect.width() or rect.right() > bar.width() + SLACK


def _cut_titles(header):
    model, found = header.model(), []
    for section in range(header.count()):
        title = model.headerData(section, Qt.Orientation.Horizontal) or ""
        tip = model.headerData(section, Qt.Orientation.Horizontal, Qt.ItemDataRole.ToolTipRole)
        wide = header.fontMetrics().horizontalAdvance(str(title))
        if not header.isSectionHidden(section) and not tip and wide > header.sectionSize(section) + SLACK:
            found.append(f"title {title!r} {header.sectionSize(section)}")
    return found


# --- reach ---


def interactive(window):
    """Return all widgets in ``window`` with which something can be done now, without the parts of others."""
    holders = QComboBox | QAbstractSpinBox | QLineEdit | QAbstractItemView | QTabBar
    return [
        widget
        for widget in window.findChildren(QWidget)
        if isinstance(widget, INTERACTIVE)
        and not isinstance(widget, QHeaderView)
        and widget.isVisible()
        and widget.isEnabled()
        and not isinstance(widget.parentWidget(), holders)
    ]


def nameless(window):
    """Return what a screen reader would call nothing."""
    return [told(w) for w in interactive(window) if not _accessible_name(w)]


def _accessible_name(widget):
    face = QAccessible.queryAccessibleInterface(widget)
    return face.text(QAccessible.Text.Name).strip() if face is not None else ""


def without_key(window):
    """Return what neither Tab nor a key of the action table leads to."""
    return [told(w) for w in interactive(window) if not _takes_tab(w) and not _has_key(w)]


def _takes_tab(widget):
    return bool(widget.focusPolicy() & Qt.FocusPolicy.TabFocus)


def _is_by_arrows(widget):
    """Tell whether it is one of several of which one is chosen: Tab leads to that one, arrows on from there."""
    return isinstance(widget, QAbstractButton) and widget.group() is not None and widget.group().exclusive()


def _has_key(widget):
    native = QKeySequence.SequenceFormat.NativeText
    keys = {
        QKeySequence(key).toString(form)
        for row in ACTIONS
        for key in row.keys
        for form in (native, native.PortableText)
    }
    if _is_by_arrows(widget):
        return True
    if isinstance(widget, QToolButton) and widget.defaultAction() is not None:
        return not widget.defaultAction().shortcut().isEmpty()
    words = f"{widget.toolTip()} {widget.accessibleName()}" + (
        widget.text() if isinstance(widget, QAbstractButton) else ""
    )
    found = [key for inside in re.findall(r"\(([^()]*)\)", words) for key in re.split(r"[,;/]", inside)]
    found += re.findall(r"(\S+)  ", words)  # "1  Confirm"
    return any(key.strip().replace("⇧", "Shift+") in keys for key in found)


def unreached(window):
    """Press Tab until it comes round; return what takes Tab and was not reached, and where it got stuck."""
    wanted = {w for w in interactive(window) if _takes_tab(w) and w.focusProxy() is None and not _is_by_arrows(w)}
    first = QApplication.focusWidget() or window
    seen, at = [], first
    stuck = 0
    for _ in range(3 * len(wanted) + 40):
        QTest.keyClick(at, Qt.Key.Key_Tab)
        now = QApplication.focusWidget()
        stuck = stuck + 1 if now is at else 0
        if stuck > MOST_SECTIONS:
            return [f"stuck at {told(at)}"]
        if now is None or (now in seen and not stuck and seen.count(now) > MOST_SECTIONS):
            break
        seen.append(now)
        at = now
    return [told(widget) for widget in wanted if widget not in seen]
