"""The whole screen for the views: menus and steps go, Escape or a large button brings them back."""

from typing import TYPE_CHECKING

from PySide6.QtCore import QEvent, QObject, Qt
from PySide6.QtGui import QKeyEvent

from app.page_panels import PagePanels

if TYPE_CHECKING:
    from app.main_window import MainWindow


class FullScreen(QObject):
    """Watches the window, so that it is right whoever changes its state."""

    def __init__(self, window: "MainWindow", panels: PagePanels) -> None:
        super().__init__(window)
        self._window, self._panels = window, panels
        self._page_before = ""
        self._was_full = False
        window.installEventFilter(self)

    @property
    def on(self) -> bool:
        """Whether the window fills the screen."""
        return bool(self._window.windowState() & Qt.WindowState.WindowFullScreen)

    @property
    def alone(self) -> bool:
        """Whether the spectrogram is shown alone."""
        return bool(self._page_before)

    def toggle(self) -> None:
        """Use the whole screen, or go back."""
        if self.on:
            self.leave()
        else:
            self._set(full=True)

    def toggle_spectrogram(self) -> None:
        """Give the whole screen to the spectrogram alone, or go back."""
        if self.alone:
            self.leave()
            return
        self._was_full, self._page_before = self.on, self._window.page
        if self._window.page not in ("sound", "leaks"):
            self._window.show_sound()
        self._panels.set_alone("sound")
        self._set(full=True)

    def leave(self) -> bool:
        """Bring back what was there before; returns whether something was away."""
        if self.alone:
            page, self._page_before = self._page_before, ""
            self._panels.set_alone("")
            if self._window.page != page:
                self._window.show_page(page)
            self._set(full=self._was_full)
            return True
        was = self.on
        if was:
            self._set(full=False)
        return was

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        """Qt: what the window is told; Escape arrives here when nothing in front has had a use for it."""
        if watched is self._window:
            if event.type() is QEvent.Type.WindowStateChange:
                self._show_frame()
            elif event.type() is QEvent.Type.KeyPress and isinstance(event, QKeyEvent):
                return event.key() == Qt.Key.Key_Escape and self._window.work.views.escape()
        return super().eventFilter(watched, event)

    def _set(self, *, full: bool) -> None:
        state = self._window.windowState() & ~Qt.WindowState.WindowFullScreen
        self._window.setWindowState(state | Qt.WindowState.WindowFullScreen if full else state)
        self._show_frame()

    def _show_frame(self) -> None:
        # the keys of a menu rest while its bar is hidden; those of the window do not
        self._window.addActions([a for a in self._window.actions_by_id.values() if a not in self._window.actions()])
        self._window.menuBar().setVisible(not self.on)
        self._window.step_bar.setVisible(not self.on)
