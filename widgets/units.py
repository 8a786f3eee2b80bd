"""How the window writes quantities: one choice for the whole program, kept by the application as the locale is."""

from PySide6.QtCore import QCoreApplication, QLocale

from processing.quantities import Quantities

_PROPERTY = "leakline_quantities"


def use(quantities: Quantities) -> None:
    """Write quantities this way from now on; widgets made before keep what they show until they are filled again."""
    application = QCoreApplication.instance()
    assert application is not None  # widgets exist only within one
    application.setProperty(_PROPERTY, quantities)


def quantities() -> Quantities:
    """Return how to write quantities now: as chosen, else metric in the language of the locale."""
    application = QCoreApplication.instance()
    chosen = None if application is None else application.property(_PROPERTY)
    if isinstance(chosen, Quantities):
        return chosen
    return Quantities("tr" if QLocale().language() is QLocale.Language.Turkish else "en")
