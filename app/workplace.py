"""The review workplace: what helps to judge, compare and hand over, composed around the window's pages.

Each part is an attribute, so that the action table can name its handlers (``work.gallery.show``).
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtGui import QAction

from app.appearance import theme_named
from app.dig_control import DigControl
from app.gallery_control import GalleryControl
from app.guide_control import GuideControl
from app.list_control import ListControl
from app.mark_control import MarkControl
from app.page_host import PageHost
from app.photo_control import PhotoControl
from app.repeat_control import RepeatControl
from app.second_review import SecondReview
from app.services import Services
from app.settings_control import SettingsControl
from app.start_control import StartControl
from app.tour_control import TourControl
from app.views_control import ViewsControl
from widgets.plot_theme import Theme

if TYPE_CHECKING:
    from app.main_window import MainWindow


class Workplace(QObject):
    """Composes; made last, when all pages and controls of the window are there."""

    told = Signal(str)  # a line for the operator

    def __init__(self, window: "MainWindow", services: Services, language: str, host: PageHost) -> None:
        super().__init__(window)
        self._window, self._services, self._language, self._host = window, services, language, host
        self.views = ViewsControl(window, services)
        self.digs = DigControl(services, host, language, window)
        self.digs.told.connect(self.told)
        self.digs.marked.connect(window.review_page.path.set_dug)
        self.digs.marked.connect(window.review_page.table.set_dug)
        self.digs.show_marks()
        self.repeat = RepeatControl(services, host, language, window)
        self.repeat.told.connect(self.told)
        self.repeat.open_asked.connect(window.files.open_path)
        self.settings = SettingsControl(
            host, services.preferences, language, window, lambda: window.boxes, lambda: window.is_busy
        )
        self.settings.told.connect(self.told)
        self.settings.language_asked.connect(window.language_asked)
        self.settings.theme_asked.connect(window.use_theme)
        self.settings.restart_asked.connect(window.restart_asked)
        theme = theme_named(services.preferences.values.theme)
        table, toast = window.review_page.table, window.review_page.toast
        self.list = ListControl(services.session, table, services.preferences, window)
        self.marks = MarkControl(services.session, window.player, self)
        self.list.autoplay_changed.connect(window.review.set_autoplay)
        self.list.report_asked.connect(self.next_step)
        window.review.set_autoplay(on=self.list.autoplay)
        for told in (window.review.told, self.list.told, self.marks.told):
            told.connect(toast.tell)
        self.guide = GuideControl(window, services.session, language, theme)
        self.start = StartControl(window, services.session, services.jobs, services.preferences)
        self.tour = TourControl(window, services.preferences)
        host.stack.currentChanged.connect(lambda _row: self.tour.moved())
        self.settings.hints_asked.connect(self.tour.offer)

        self.photos = PhotoControl(window, services, language)
        self.photos.told.connect(self.told)
        self.digs.photo_asked.connect(self.photos.attach)
        self.second = SecondReview(window, services, host, theme_named(services.preferences.values.theme))
        self.second.told.connect(self.told)
        self.gallery = GalleryControl(window, services, host, theme)

    def show_enabled(self, actions_by_id: Mapping[str, QAction]) -> None:
        """Switch off what makes no sense on the page in front."""
        self.gallery.show_enabled(actions_by_id)
        self.second.show_enabled(actions_by_id)

    def next_step(self) -> None:
        """Everything is judged: go to the report, or end a second review and compare."""
        if self._services.session.reviewer:
            self.second.end()
        else:
            self._window.show_report()

    def open_page(self, page: str) -> bool:
        """Show a page that is built when it is asked for; returns whether it is one of these."""
        opener = self._host.openers.get(page)
        if opener is not None:
            opener()
        return opener is not None

    def apply_theme(self, theme: Theme) -> None:
        """Draw everything in this theme."""
        self.guide.apply_theme(theme)
        self.gallery.apply_theme(theme)
        self.repeat.apply_theme(theme)
        self.second.apply_theme(theme)
        self.settings.refresh()

    def stop(self) -> None:
        """Leave no work behind: the window closes."""
        self.views.stop()
        self.list.stop()
        self._window.review_page.toast.stop()
        self.guide.stop()
        self.start.stop()
        self.tour.stop()
        self.digs.stop()
        self.repeat.stop()
        self.gallery.stop()
        self.photos.stop()
