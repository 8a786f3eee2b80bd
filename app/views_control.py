"""The linked views as one thing: measuring, following, menus, layout and full screen, each in a part of its own."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QObject

from app.follow_control import FollowControl
from app.measure_control import MeasureControl
from app.services import Services

if TYPE_CHECKING:
    from app.main_window import MainWindow


class ViewsControl(QObject):
    """Composes; its parts are attributes, so that the action table can name their handlers."""

    def __init__(self, window: "MainWindow", services: Services) -> None:
        super().__init__(window)
        page, session, preferences = window.review_page, services.session, services.preferences
        self.measure = MeasureControl(session, page, self)
        self.follow = FollowControl(session.cursor, window.player, page, preferences, self)
        for view in page.views:
            view.candidate_opened.connect(window.review.go_to_candidate)
