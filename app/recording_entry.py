"""The door to the recording page: built when it is first asked for; and what the rest of the window asks of it."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, QTimer, Signal
from PySide6.QtWidgets import QFileDialog, QPushButton, QStackedWidget, QWidget

from app.appearance import theme_named
from app.recording_parts import RecordingKit
from app.settings import PreferencesStore
from widgets.plot_theme import Theme
from widgets.press_twice import PressTwice
from widgets.recording_words import clock_text

if TYPE_CHECKING:
    from app.recording_control import RecordingControl
    from app.recording_page import RecordingPage
    from widgets.prelaunch_panel import PrelaunchPanel

PAGE = "recording"
CLOSE_WITHIN_S = 6.0


class RecordingEntry(QObject):
    """Puts the page into the window's ``pages`` and ``stack``; ``strip`` says on every other page that it runs."""

    page_asked = Signal(str)
    told = Signal(str)
    process_asked = Signal(object)  # Path
    changed = Signal()  # what can be done has changed
    recorded = Signal()  # a recording has ended
    close_asked = Signal()  # the recording that kept the window open has ended

    def __init__(
        self,
        preferences: PreferencesStore,
        language: str,
        pages: dict[str, QWidget],
        stack: QStackedWidget,
        window: QWidget,
        kit: RecordingKit | None,
        monotonic: Callable[[], float],
    ) -> None:
        super().__init__(window)
        self._preferences, self._language = preferences, language
        self._pages, self._stack, self._window = pages, stack, window
        self._kit, self._monotonic = kit or RecordingKit(), monotonic
        self._closing = PressTwice(monotonic, CLOSE_WITHIN_S)
        self._close_when_stopped = False
        self.control: RecordingControl | None = None
        self.page: RecordingPage | None = None
        self._check_panel: PrelaunchPanel | None = None
        self.strip = QPushButton()
        self.strip.setObjectName("recording_strip")
        self.strip.setMinimumHeight(44)
        self.strip.clicked.connect(self.show)
        self.strip.hide()
        self._timer = QTimer(self)
        self._timer.setInterval(500)
        self._timer.timeout.connect(self._show_strip)
        stack.currentChanged.connect(self._on_page)

    # --- actions ---

    def show(self) -> None:
        """Show the recording page."""
        if self.control is None:
            self._build()
        self.page_asked.emit(PAGE)

    def press(self) -> None:
        """Record, or stop (the second time); from another page, come back first."""
        if not self.in_front:
            self.show()
        elif self.control is not None:
            self.control.press()

    def mark_here(self) -> None:
        """Mark this moment."""
        if self.control is not None:
            self.control.markers.mark()

    def undo(self) -> None:
        """Take the last marker back."""
        if self.control is not None:
            self.control.markers.undo()

    def clear_clip(self) -> None:
        """Put out the clip light."""
        if self.control is not None:
            self.control.clear_clip()

    # --- what the window asks ---

    @property
    def in_front(self) -> bool:
        """Whether the page is shown."""
        return self.page is not None and self._stack.currentWidget() is self.page

    @property
    def recording(self) -> bool:
        """Whether something is being recorded."""
        return self.control is not None and self.control.recording

    @property
    def can_mark(self) -> bool:
        """Whether a moment can be marked now."""
        return self.in_front and self.control is not None and self.control.markers.running

    @property
    def can_undo(self) -> bool:
        """Whether there is a marker to take back."""
        return self.control is not None and self.control.markers.running and bool(self.control.markers.points)

    def apply_theme(self, theme: Theme) -> None:
        """Draw in these colours and letters."""
        if self.page is not None:
            self.page.apply_theme(theme)
        if self._check_panel is not None:
            self._check_panel.apply_theme(theme)

    def may_close(self) -> bool:
        """Tell whether the window may close now; while it is recorded the second asking ends the recording first."""
        control = self.control
        if control is None or not control.recording:
            self._close_when_stopped = False
            return True
        if self._close_when_stopped:
            return False
        if self._closing.press():
            self._close_when_stopped = True
            control.stop()
        else:
            self.told.emit(self.tr("A recording is running. Close again within six seconds to stop it and leave."))
        return False

    def stop(self) -> None:
        """The window closes."""
        self._timer.stop()
        if self.control is not None:
            self.control.shut()

    # --- inside ---

    def _build(self) -> None:
        from app.prelaunch_control import PrelaunchControl, recall_check, remember_check
        from app.recording_control import RecordingControl
        from app.recording_page import PRELAUNCH, RecordingPage
        from widgets.prelaunch_panel import PrelaunchPanel

        self.page = RecordingPage(theme_named(self._preferences.values.theme), self._language)
        self._pages[PAGE] = self.page
        self._stack.addWidget(self.page)
        control = RecordingControl(self.page, self._preferences, self._kit, self, self._monotonic)
        control.told.connect(self.told)
        control.process_asked.connect(self.process_asked)
        control.folder_asked.connect(self._ask_folder)
        control.changed.connect(self._on_changed)
        control.stopped.connect(self._on_stopped)
        self.control = control
        panel = PrelaunchPanel(self._language, theme_named(self._preferences.values.theme))
        self.page.add_panel(PRELAUNCH, self.tr("Check"), panel)
        self._check_panel = panel
        self.prelaunch = PrelaunchControl(panel, control, self._kit.battery, control)
        recall_check(panel, self._preferences)
        panel.changed.connect(lambda: remember_check(panel, self._preferences))

    def _ask_folder(self) -> None:
        assert self.control is not None
        start = str(self.control.wish.folder)
        chosen = QFileDialog.getExistingDirectory(self._window, self.tr("Where recordings are stored"), start)
        if chosen:
            self.control.set_folder(Path(chosen))

    def _on_page(self) -> None:
        if self.control is None:
            return
        if self.in_front:
            self.control.enter()
        else:
            self.control.leave()
        self._on_changed()

    def _on_changed(self) -> None:
        if self._close_when_stopped and self.control is not None and self.control.recording:
            self.control.stop()  # it was only about to begin when it was asked to end
        if self.recording and not self.in_front:
            self._timer.start()
        else:
            self._timer.stop()
        self._show_strip()
        self.changed.emit()

    def _show_strip(self) -> None:
        shown = self.recording and not self.in_front
        if shown and self.control is not None:
            text = self.tr("●  Recording {time}: back to it")
            self.strip.setText(text.format(time=clock_text(self.control.elapsed_s)))
        self.strip.setVisible(shown)

    def _on_stopped(self) -> None:
        self.recorded.emit()
        if self._close_when_stopped:
            self._close_when_stopped = False
            self.close_asked.emit()
        elif not self.in_front and self.control is not None:
            self.control.leave()
        self._on_changed()
