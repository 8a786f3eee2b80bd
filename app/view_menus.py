"""The menu of a view: what its keys do, as rows of the action table, for a hand that has no key at hand."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QPoint, Qt
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from app.page_panels import PagePanels
from widgets.spectrogram_tools import MENU_STYLE

if TYPE_CHECKING:
    from app.main_window import MainWindow

LINE = ""
PLACE = ("goto", "mark", "tie", LINE)
LISTEN = ("play", "loop", "loop_selection", LINE)
MEASURE = ("measure", "measure_end", "measure_tool", LINE)
SHOW = ("zoom_in", "zoom_out", "fit", "axis", LINE)
COLOURS = ("contrast", "contrast_fixed", "plane", "colours", LINE)
SELECT = ("select_here", "select", "spectrum", "spectrum_b", LINE)
SCREEN = ("follow", "full", "full_sound", LINE)
PLAN = (*PLACE, *MEASURE, "zoom_in", "zoom_out", "fit", LINE, *SCREEN)
STRIP = (*PLACE, *LISTEN, *MEASURE, *SHOW, *SCREEN)
SOUND = (*PLACE, *LISTEN, *MEASURE, *SELECT, *COLOURS, *SHOW, *SCREEN)


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

    def _open(self, view: QWidget, rows: tuple[str, ...], place: QPoint) -> None:
        self.stop()
        menu = self.shown = QMenu(view)
        menu.setStyleSheet(MENU_STYLE)
        menu.setToolTipsVisible(True)
        add_rows(menu, rows, self._window.actions_by_id)
        if view is self._window.review_page.spectrogram:
            tools = self._window.review_page.spectrogram_tools.menu
            tools.setTitle(self.tr("Axes, colours"))
            menu.addMenu(tools)
        menu.addMenu(self._panels.menu(menu))
        menu.popup(view.mapToGlobal(place))


def add_rows(menu: QMenu, rows: tuple[str, ...], actions: Mapping[str, QAction]) -> None:
    """Put actions of the table into a menu, with a line for each empty name."""
    for name in rows:
        if name == LINE:
            menu.addSeparator()
        else:
            menu.addAction(actions[name])
