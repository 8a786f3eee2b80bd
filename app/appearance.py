"""How the program looks: the palette and style sheet of a theme, large enough for gloves, dark enough for the sun."""

from importlib import resources

from PySide6.QtCore import QLibraryInfo, QLocale, QTranslator
from PySide6.QtGui import QColor, QFont, QPalette
from PySide6.QtWidgets import QApplication, QStyleFactory

from widgets.plot_theme import LIGHT, THEMES, Theme

THEME_ORDER = ("light", "sun", "dark")
FONT_PT = 10.5
LANGUAGES = ("en", "tr")


def theme_named(name: str) -> Theme:
    """Return a theme; the light one for a name that is not known."""
    return THEMES.get(name, LIGHT)


def next_theme(name: str) -> str:
    """Return the theme that F9 leads to."""
    at = THEME_ORDER.index(name) if name in THEME_ORDER else 0
    return THEME_ORDER[(at + 1) % len(THEME_ORDER)]


def system_language() -> str:
    """Return the language of the system if Leakline speaks it, else English."""
    language = QLocale.system().name().partition("_")[0]
    return language if language in LANGUAGES else "en"


def apply_theme(application: QApplication, theme: Theme) -> None:
    """Give the whole program the looks of a theme."""
    if application.style().name().lower() != "fusion":
        application.setStyle(QStyleFactory.create("Fusion"))  # the one style that honours a palette everywhere
    font = QFont(application.font())
    font.setPointSizeF(FONT_PT * (1.1 if theme.name == "sun" else 1.0))
    font.setBold(theme.name == "sun")
    application.setFont(font)
    application.setPalette(palette(theme))
    application.setStyleSheet(style_sheet(theme))


def palette(theme: Theme) -> QPalette:
    """Return the colours of all standard widgets."""
    role, group = QPalette.ColorRole, QPalette.ColorGroup
    colours = QPalette()
    text, faint = QColor(theme.text), mixed(theme.text, theme.background, 0.55)
    for key, colour in (
        (role.Window, QColor(theme.background)),
        (role.WindowText, text),
        (role.Base, QColor(theme.canvas)),
        (role.AlternateBase, mixed(theme.background, theme.canvas, 0.6)),
        (role.Text, text),
        (role.Button, mixed(theme.background, theme.canvas, 0.5)),
        (role.ButtonText, text),
        (role.BrightText, QColor(theme.cursor)),
        (role.ToolTipBase, QColor(theme.canvas)),
        (role.ToolTipText, text),
        (role.PlaceholderText, mixed(theme.text, theme.background, 0.75 if theme.name == "sun" else 0.7)),
        (role.Highlight, QColor(theme.accent)),
        (role.HighlightedText, QColor(theme.canvas)),
        (role.Link, QColor(theme.accent)),
    ):
        colours.setColor(key, colour)
    for key in (role.WindowText, role.Text, role.ButtonText):
        colours.setColor(group.Disabled, key, faint)
    return colours


def mixed(first: str, second: str, part: float) -> QColor:
    """Return ``part`` of the first colour and the rest of the second."""
    a, b = QColor(first), QColor(second)
    mix = [
        round(part * x + (1 - part) * y) for x, y in ((a.red(), b.red()), (a.green(), b.green()), (a.blue(), b.blue()))
    ]
    return QColor(mix[0], mix[1], mix[2])


def style_sheet(theme: Theme) -> str:
    """Return the few rules that the palette cannot give: sizes for gloves, and borders that stay visible in the sun."""
    width = 2 if theme.name == "sun" else 1
    line = theme.text if theme.name == "sun" else mixed(theme.text, theme.background, 0.3).name()
    hover = mixed(theme.accent, theme.canvas, 0.15).name()
    plain = "bold" if theme.name == "sun" else "normal"  # thin strokes drown in the sun
    off = mixed(theme.text, theme.background, 0.15).name()
    return f"""
        QPushButton, QToolButton {{ border: {width}px solid {line}; border-radius: 6px; padding: 4px 10px;
            background: {theme.canvas}; }}
        QPushButton:hover, QToolButton:hover {{ background: {hover}; }}
        QPushButton:checked, QToolButton:checked {{ border: {width + 1}px solid {theme.accent}; background: {hover};
            font-weight: bold; }}
        QPushButton:disabled, QToolButton:disabled {{ color: {mixed(theme.text, theme.background, 0.5).name()};
            border-color: {mixed(theme.text, theme.background, 0.15).name()}; background: {theme.background}; }}
        QPushButton:focus, QToolButton:focus {{ border: {width + 1}px solid {theme.accent}; }}
        QComboBox {{ border: {width}px solid {line}; border-radius: 4px; padding: 2px 2px 2px 6px;
            background: {theme.canvas}; }}
        QComboBox:focus {{ border: {width + 1}px solid {theme.accent}; }}
        QComboBox:disabled {{ border-color: {off}; background: {theme.background}; }}
        QComboBox::drop-down {{ border: 0px; width: 22px; }}
        QComboBox::down-arrow {{ image: url("{arrow(theme)}"); width: 12px; height: 8px; }}
        QComboBox QAbstractItemView {{ border: {width}px solid {line}; }}
        QComboBox QAbstractItemView::item {{ min-height: 40px; }}
        QCheckBox:focus, QRadioButton:focus {{ border: {width + 1}px solid {theme.accent}; border-radius: 4px; }}
        QListView:focus, QTableView:focus, QTextBrowser:focus {{ border: {width + 1}px solid {theme.accent}; }}
        QLineEdit, QPlainTextEdit {{ border: {width}px solid {line}; border-radius: 4px; padding: 2px 6px;
            background: {theme.canvas}; }}
        QLineEdit:focus, QPlainTextEdit:focus {{ border: {width + 1}px solid {theme.accent}; }}
        QGroupBox {{ font-weight: bold; border: 1px solid {line}; border-radius: 6px; margin-top: 1.2em; }}
        QGroupBox::title {{ subcontrol-origin: margin; left: 10px; padding: 0 4px; }}
        QGroupBox QLabel, QGroupBox QComboBox, QGroupBox QLineEdit {{ font-weight: {plain}; }}
        QTableView, QListView {{ selection-background-color: {mixed(theme.accent, theme.canvas, 0.25).name()};
            selection-color: {theme.text}; }}
        QHeaderView::section {{ padding: 3px 4px; border: 0px; border-right: 1px solid {line};
            border-bottom: {width}px solid {line}; background: {theme.background}; font-weight: bold; }}
        QTabBar::tab {{ min-height: 36px; padding: 1px 12px; border: {width}px solid {off}; border-bottom: 0px;
            border-top-left-radius: 5px; border-top-right-radius: 5px; background: {theme.background}; }}
        QTabBar::tab:selected {{ border-color: {line}; background: {hover}; }}
        QTabBar:focus::tab:selected {{ border-color: {theme.accent}; }}
        QMenu::item {{ padding: 8px 28px 8px 20px; }}
        QMenu::item:selected {{ background: {theme.accent}; color: {theme.canvas}; }}
        QCheckBox::indicator, QTableView::indicator {{ width: 22px; height: 22px; }}
        QScrollBar:vertical {{ width: 18px; }}
        QScrollBar:horizontal {{ height: 18px; }}
        QSplitter::handle {{ background: {mixed(theme.text, theme.background, 0.15).name()}; }}
        QLabel#candidate_title {{ font-size: {round(FONT_PT * 1.35)}pt; font-weight: bold; }}
        QLabel#page_title {{ font-size: {round(FONT_PT * 1.5)}pt; font-weight: bold; }}
        QLabel#readout {{ font-weight: bold; }}
        QPushButton#recording_strip {{ background: {theme.cursor}; color: {theme.canvas}; font-weight: bold; }}
        QLabel#warning {{ background: {theme.cursor}; color: {theme.canvas}; padding: 6px 12px; font-weight: bold; }}
        QLabel#banner {{ background: {theme.accent}; color: {theme.canvas}; padding: 6px 12px; font-weight: bold; }}
    """


def arrow(theme: Theme) -> str:
    """Return the file of the arrow of choices: a style sheet that gives them a border takes the style's own away."""
    name = theme.name if theme.name in THEME_ORDER else LIGHT.name
    return str(resources.files("resources") / "icons" / f"arrow-{name}.svg").replace("\\", "/")


class Translation:
    """Installs the translators of one language; keeps them alive."""

    def __init__(self, application: QApplication) -> None:
        self._application = application
        self._installed: list[QTranslator] = []

    def use(self, language: str) -> None:
        """Speak this language from now on; windows made before keep theirs."""
        for translator in self._installed:
            self._application.removeTranslator(translator)
        self._installed.clear()
        QLocale.setDefault(QLocale(QLocale.Language.Turkish if language == "tr" else QLocale.Language.English))
        own = resources.files("resources") / "translations" / f"leakline_{language}.qm"
        qt = QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)
        for file in (f"{qt}/qtbase_{language}.qm", str(own)):
            translator = QTranslator()
            if translator.load(file):
                self._application.installTranslator(translator)
                self._installed.append(translator)
