"""Which panels of the review page are shown: those of the page in front that the operator has not put away."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

from PySide6.QtCore import QT_TRANSLATE_NOOP, QCoreApplication, QObject, QPoint, Signal
from PySide6.QtGui import QAction
from PySide6.QtWidgets import QMenu, QWidget

from app.settings import PreferencesStore
from widgets.spectrogram_tools import MENU_STYLE

if TYPE_CHECKING:
    from app.review_page import ReviewPage

PREFIX = "views.hidden."
N = QT_TRANSLATE_NOOP
TITLES: Mapping[str, str] = {
    "plan": str(N("PagePanels", "Plan")),
    "profile": str(N("PagePanels", "Elevation profile")),
    "overview": str(N("PagePanels", "Overview of the run")),
    "sound": str(N("PagePanels", "Spectrogram")),
    "level": str(N("PagePanels", "Level")),
    "motion": str(N("PagePanels", "Motion")),
    "side": str(N("PagePanels", "List and verdict")),
}
OF_PAGE: Mapping[str, tuple[str, ...]] = {
    "path": ("plan", "profile", "overview", "level", "motion"),
    "sound": ("overview", "sound", "level", "motion", "side"),
    "leaks": ("plan", "profile", "overview", "sound", "level", "side"),
}
# what gives way on a small page, until the operator says otherwise: plan and profile have a page of their own
NARROW_HIDES: Mapping[str, tuple[str, ...]] = {"leaks": ("plan", "profile")}
LOW_HIDES: Mapping[str, tuple[str, ...]] = {
    "leaks": ("overview",),
    "sound": ("overview", "motion"),
    "path": ("overview",),
}
STRIPS = ("overview", "sound", "level", "motion")  # above one another: the lowest one has the common axis


class PagePanels(QObject):
    """Hides and shows; each page of the review keeps its own choice, which outlives the session."""

    changed = Signal()

    def __init__(self, page: "ReviewPage", preferences: PreferencesStore, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._page, self._preferences = page, preferences
        self._alone = ""  # the one panel that is shown, whatever else is chosen
        self._menu: QMenu | None = None
        page.layout_changed.connect(self.apply)
        self.apply()

    def shown(self, arrangement: str) -> tuple[str, ...]:
        """Return the panels that a page shows."""
        if self._alone in OF_PAGE[arrangement]:
            return (self._alone,)
        chosen = self._preferences.values.layout.get(PREFIX + arrangement)
        hidden = self._too_much(arrangement) if chosen is None else tuple(chosen.split())
        found = tuple(name for name in OF_PAGE[arrangement] if name not in hidden)
        return found if any(name in STRIPS for name in found) else OF_PAGE[arrangement]

    def _too_much(self, arrangement: str) -> tuple[str, ...]:
        narrow = NARROW_HIDES.get(arrangement, ()) if self._page.is_narrow else ()
        return (*narrow, *(LOW_HIDES.get(arrangement, ()) if self._page.is_low else ()))

    def set_shown(self, name: str, *, shown: bool) -> None:
        """Show or hide a panel of the page in front; one of the strips always stays."""
        arrangement = self._page.arrangement
        left = [n for n in OF_PAGE[arrangement] if (shown if n == name else n in self.shown(arrangement))]
        if any(n in STRIPS for n in left):
            hidden = " ".join(n for n in OF_PAGE[arrangement] if n not in left)
            self._preferences.change(layout={**self._preferences.values.layout, PREFIX + arrangement: hidden})
        self.apply()

    def set_alone(self, name: str) -> None:
        """Show this panel alone wherever it belongs to the page; empty ends that."""
        if name != self._alone:
            self._alone = name
            self.apply()

    def apply(self) -> None:
        """Show what belongs to the page in front."""
        panels, shown = self._page.panels, self.shown(self._page.arrangement)
        for name, panel in panels.items():
            panel.setVisible(name in shown)
        self._page.maps.setVisible("plan" in shown or "profile" in shown)
        lowest = [name for name in STRIPS if name in shown][-1]
        for name, view in zip(STRIPS, self._page.strips, strict=False):
            view.set_x_axis_visible(name == lowest)
        if self._page.arrangement == "sound":
            self._page.spectrogram_tools.setVisible(not self._alone)
        self.changed.emit()

    def open_menu(self) -> None:
        """Offer the panels of the page in front; in its middle, as it was asked for by a key."""
        menu = self.menu(self._page)
        size = menu.sizeHint()
        middle = self._page.rect().center() - QPoint(size.width() // 2, size.height() // 2)
        self._close_menu()
        self._menu = menu
        menu.popup(self._page.mapToGlobal(middle))

    def menu(self, parent: QWidget) -> QMenu:
        """Return a menu with a check for each panel of the page in front; it deletes itself when it has been closed."""
        menu = QMenu(QCoreApplication.translate("PagePanels", "Panels"), parent)
        menu.setStyleSheet(MENU_STYLE)
        shown = self.shown(self._page.arrangement)
        for number, name in enumerate(OF_PAGE[self._page.arrangement], start=1):
            text = QCoreApplication.translate("PagePanels", TITLES[name])
            action = QAction(f"&{number} {text}", menu)
            action.setCheckable(True)
            action.setChecked(name in shown)
            action.triggered.connect(lambda on, name=name: self.set_shown(name, shown=on))
            menu.addAction(action)
        return menu

    def stop(self) -> None:
        """Leave no menu open."""
        self._close_menu()

    def _close_menu(self) -> None:
        menu, self._menu = self._menu, None
        if menu is not None:
            menu.close()
            menu.deleteLater()
