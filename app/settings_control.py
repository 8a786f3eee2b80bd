"""The door to the settings page, and what each choice on it does: remembered and effective at once."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QFileDialog, QWidget

from app import company_logo, text_scale
from app.company_logo import Logo, LogoFault
from app.page_host import PageHost
from app.settings import Preferences, PreferencesStore
from widgets.message_boxes import Choice

if TYPE_CHECKING:
    from widgets.message_boxes import MessageBoxes
    from widgets.settings_panel import SettingsPanel

PAGE = "settings"
REMADE = ("units", "places")  # every widget writes lengths: the window is made again
KEPT_AT_RESET = (
    "language", "recent", "pinned", "recent_crs", "company", "operator", "reviewer", "report_language", "recording",
    "handover", "correlator_folder",
)  # fmt: skip


class SettingsControl(QObject):
    """Puts the page into the window's stack when it is first asked for; ``busy`` tells that work is in progress."""

    told = Signal(str)
    language_asked = Signal(str)  # the window is made again in this language, with what else has changed
    theme_asked = Signal(str)
    restart_asked = Signal()
    hints_asked = Signal()

    def __init__(
        self,
        host: PageHost,
        preferences: PreferencesStore,
        language: str,
        window: QWidget,
        boxes: "Callable[[], MessageBoxes]",
        busy: Callable[[], bool],
    ) -> None:
        super().__init__(window)
        self._host, self._preferences, self._language, self._window = host, preferences, language, window
        self._boxes, self._busy = boxes, busy
        self.came_from = "start"
        self.panel: SettingsPanel | None = None
        host.openers[PAGE] = self.show

    def show(self) -> None:
        """Show the page; where it is in front already, go back to what was there before."""
        if self.panel is None:
            self.panel = self._built()
        if self._host.current() == PAGE:
            self._leave()
            return
        self.came_from = self._host.current()
        self.refresh()
        self._host.show(PAGE)

    def refresh(self) -> None:
        """Show what is remembered."""
        if self.panel is None:
            return
        from widgets.settings_panel import ShownSettings

        values = self._preferences.values
        self.panel.show_settings(
            ShownSettings(
                language=self._language,
                theme=values.theme,
                text_scale=values.text_scale,
                units=values.units,
                places=values.places,
                report_language=values.report_language,
                operator=values.operator,
                reviewer=values.reviewer,
                company=values.company,
            )
        )
        self.panel.set_restart(needed=values.text_scale != text_scale.in_force())
        logo = values.company.get("logo", "")
        self._show_logo(logo, company_logo.look_at(Path(logo)) if logo else Logo(LogoFault.NONE))

    # --- what the page says ---

    def _built(self) -> "SettingsPanel":
        from widgets.settings_panel import SettingsPanel

        panel = SettingsPanel()
        panel.changed.connect(self._change)
        panel.company_changed.connect(self._change_company)
        panel.logo_asked.connect(self._ask_logo)
        panel.logo_removed.connect(self._remove_logo)
        panel.restart_asked.connect(self._restart)
        panel.hints_asked.connect(self._show_hints)
        panel.reset_asked.connect(self._reset)
        panel.done.connect(self._leave)
        self._host.add(PAGE, panel)
        return panel

    def _leave(self) -> None:
        self._host.show(self.came_from)

    def _change(self, name: str, value: object) -> None:
        if value == (self._language if name == "language" else getattr(self._preferences.values, name)):
            return
        if name in ("language", *REMADE) and self._refused():
            return
        if name == "theme":
            self.theme_asked.emit(str(value))
        elif name == "language":
            self.language_asked.emit(str(value))
        else:
            self._preferences.change(**{name: value})
            if name in REMADE:
                self.language_asked.emit(self._language)
        self.refresh()

    def _change_company(self, values: dict[str, str]) -> None:
        self._preferences.change(company=self._preferences.values.company | values)

    def _refused(self) -> bool:
        """Whether work in progress keeps the window from being made again; the page shows what is true then."""
        if not self._busy():
            return False
        self._boxes().tell(self.tr("Please wait until the work in progress has ended."))
        self.refresh()
        return True

    # --- the logo ---

    def _ask_logo(self) -> None:
        title = self.tr("A logo for the report")
        chosen, _ = QFileDialog.getOpenFileName(self._window, title, "", "PNG, JPEG, SVG (*.png *.jpg *.jpeg *.svg)")
        if chosen:
            self.take_logo(Path(chosen))

    def take_logo(self, path: Path) -> None:
        """Keep a copy of this picture for the report, if it is one."""
        found = company_logo.look_at(path)
        if not found.usable:
            self._boxes().tell(self._words(found))
            return
        try:
            kept = company_logo.keep(path, self._preferences.file.parent, found.kind)
        except OSError as error:
            self._boxes().tell(self.tr("The logo could not be copied: {reason}").format(reason=error.strerror))
            return
        self._change_company({"logo": str(kept)})
        self._show_logo(str(kept), found)

    def _remove_logo(self) -> None:
        self._change_company({"logo": ""})
        self._show_logo("", Logo(LogoFault.NONE))

    def _show_logo(self, path: str, found: Logo) -> None:
        if self.panel is not None:
            self.panel.company.set_logo(path if found.usable else "", self._words(found) if path else "")

    def _words(self, logo: Logo) -> str:
        size = self.tr("{width} × {height} pixels").format(width=logo.size[0], height=logo.size[1])
        return {
            LogoFault.NONE: size,
            LogoFault.MISSING: self.tr("The logo's file is not there any more. Please choose it again."),
            LogoFault.NO_PICTURE: self.tr("This is no PNG, JPEG or SVG picture. Please choose another file."),
            LogoFault.TOO_LARGE: self.tr("This picture is too large: at most 5 MB and 6000 pixels a side."),
            LogoFault.COARSE: self.tr("{size}: it will look coarse in print; 350 pixels wide or more is better."),
        }[logo.fault].format(size=size)

    # --- starting afresh ---

    def _restart(self) -> None:
        if not self._refused():
            self.restart_asked.emit()

    def _show_hints(self) -> None:
        self._preferences.change(tour_seen=False)
        self.hints_asked.emit()

    def _reset(self) -> None:
        if self._refused():
            return
        answer = self._boxes().ask(
            self.tr("Set looks, units and layouts back to what they were at first?"),
            (Choice("reset", self.tr("Reset")), Choice("cancel", self.tr("Cancel"))),
        )
        if answer != "reset":
            return
        kept = {name: getattr(self._preferences.values, name) for name in KEPT_AT_RESET}
        self._preferences.values = replace(Preferences(), **kept)
        self._preferences.change()
        self.theme_asked.emit(self._preferences.values.theme)
        self.language_asked.emit(self._language)
