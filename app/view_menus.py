"""The menu of a view: what its keys do, as rows of the action table, for a hand that has no key at hand."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QObject, QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from app.page_panels import PagePanels
from widgets.spectrogram_tools import MENU_STYLE

if TYPE_CHECKING:
    from app.main_window import MainWindow

LINE = ""
N = QT_TRANSLATE_NOOP
PLACE = ("goto", "mark", "tie", LINE)
LISTEN = ("play", "loop", "loop_selection", LINE)
# what needs fewer hands stands in menus of its own: the whole must fit on a small screen
MEASURE = (str(N("ViewMenus", "Measure")), ("measure", "measure_end", "measure_tool"))
SELECT = (str(N("ViewMenus", "Selection")), ("select_here", "select", "spectrum", "spectrum_b"))
COLOURS = (str(N("ViewMenus", "Contrast and colours")), (
    "contrast", "contrast_fixed", LINE, "quiet_up", "quiet_down", "loud_up", "loud_down", LINE, "plane", "colours",
))  # fmt: skip
SHOW = (str(N("ViewMenus", "View")), ("zoom_in", "zoom_out", "fit", "axis", "follow", LINE, "full", "full_sound"))
MAP = (SHOW[0], tuple(name for name in SHOW[1] if name != "axis"))
PLAN = (PLACE, (MEASURE, MAP))
STRIP = (PLACE + LISTEN, (MEASURE, SHOW))
SOUND = (PLACE + LISTEN, (MEASURE, SELECT, COLOURS, SHOW))
Group = tuple[str, tuple[str, ...]]
Rows = tuple[tuple[str, ...], tuple[Group, ...]]


class ViewMenus(QObject):
    """Opens a menu where a view asks for one: by the right button, a long press, or the menu key."""

    def __init__(self, window: "MainWindow", panels: PagePanels) -> None:
        super().__init__(window)
        self._window, self._panels = window, panels
        self.shown: QMenu | None = None
        page = window.review_page
        for view in page.views:
            rows = PLAN if view is page.path else SOUND if view is page.spectrogram else STRIP
            view.setContextMenuPolicy(Qt.ContextMenuPolicy.CustomContextMenu)
            view.customContextMenuRequested.connect(lambda place, view=view, rows=rows: self._open(view, rows, place))

    def stop(self) -> None:
        """Leave no menu open."""
        menu, self.shown = self.shown, None
        if menu is not None:
            menu.close()
            menu.deleteLater()

    def _open(self, view: QWidget, rows: Rows, place: QPoint) -> None:
        self.stop()
        menu = self.shown = QMenu(view)
        menu.setStyleSheet(MENU_STYLE)
        menu.setToolTipsVisible(True)
        first, groups = rows
        add_rows(menu, first, self._window.actions_by_id)
        for title, names in groups:
            add_rows(_sub_menu(menu, QCoreApplication.translate("ViewMenus", title)), names, self._window.actions_by_id)
        if view is self._window.review_page.spectrogram:
            tools = self._window.review_page.spectrogram_tools.menu
            tools.setTitle(self.tr("Axes, colours"))
            menu.addAction(tools.menuAction())  # after addMenu, PySide takes it away with this menu
        menu.addMenu(self._panels.menu(menu))
        menu.popup(view.mapToGlobal(place))


def _sub_menu(menu: QMenu, title: str) -> QMenu:
    below = QMenu(title, menu)
    below.setStyleSheet(MENU_STYLE)
    menu.addMenu(below)
    return below


def add_rows(menu: QMenu, rows: tuple[str, ...], actions: Mapping[str, QAction]) -> None:
    """Put actions of the table into a menu, with a line for each empty name."""
    for name in rows:
        if name == LINE:
            menu.addSeparator()
        else:
            menu.addAction(actions[name])
