"""The linked views as one thing: measuring, following, menus, layout and full screen, each in a part of its own."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.follow_control import FollowControl
from app.full_screen import FullScreen
from app.measure_control import MeasureControl
from app.page_panels import PagePanels
from app.services import Services
from app.view_memory import ViewMemory
from app.view_menus import ViewMenus
from app.view_zoom import ViewZoom

if TYPE_CHECKING:
    from app.main_window import MainWindow

LAYOUT = "views."  # what of the remembered layout is the views'


class ViewsControl(QObject):
    """Composes; its parts are attributes, so that the action table can name their handlers."""

    def __init__(self, window: "MainWindow", services: Services) -> None:
        super().__init__(window)
        page, session, preferences = window.review_page, services.session, services.preferences
        self._page, self._preferences = page, preferences
        self.measure = MeasureControl(session, page, self)
        self.follow = FollowControl(session.cursor, window.player, page, preferences, self)
        self.zoom = ViewZoom(session.cursor, page, self)
        self.panels = PagePanels(page, preferences, self)
        self.screen = FullScreen(window, self.panels)
        self.menus = ViewMenus(window, self.panels)
        self.memory = ViewMemory(session, page, preferences, self)
        page.view_tools.full_asked.connect(self.screen.toggle)
        for view in page.views:
            view.candidate_opened.connect(window.review.go_to_candidate)

    def escape(self) -> bool:
        """Remove the ruler; else leave full screen; returns whether there was one of these."""
        return self.measure.escape() or self.screen.leave()

    def reset_layout(self) -> None:
        """Arrange everything as it was the first time: panels, tabs, and the places of what divides them."""
        layout = {k: v for k, v in self._preferences.values.layout.items() if not k.startswith(LAYOUT)}
        self._preferences.change(layout=layout, splitters={})
        self._page.tools.restore({})
        self._page.arrange(self._page.arrangement)
        self.follow.forget()

    def stop(self) -> None:
        """Write down where one is, and leave no menu open: the window closes."""
        self.memory.save()
        self.menus.stop()
        self.panels.stop()
