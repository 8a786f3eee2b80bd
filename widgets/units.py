"""How the window writes quantities: one choice for the whole program, kept by the application as the locale is."""

from dataclasses import dataclass

from PySide6.QtCore import QCoreApplication, QLocale

from processing.quantities import GALLONS_PER_LITRE, METRES_PER_US_FOOT, PSI_PER_BAR, Quantities, Units

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


@dataclass(frozen=True)
class FieldUnit:
    """A unit of fields and columns: its sign, and how much one of it is in the survey's unit."""

    sign: str
    factor: float

    def shown(self, value: float) -> float:
        """Return a value of the survey in this unit."""
        return value / self.factor


def length_unit() -> FieldUnit:
    """Return the unit of lengths: metres or US survey feet."""
    return FieldUnit("ft", METRES_PER_US_FOOT) if _is_us() else FieldUnit("m", 1.0)


def small_unit() -> FieldUnit:
    """Return the unit of diameters, radii and walls: millimetres or inches, of metres."""
    return FieldUnit("in", 0.0254) if _is_us() else FieldUnit("mm", 0.001)


def pressure_unit() -> FieldUnit:
    """Return the unit of pressures: bar or psi, of bars."""
    return FieldUnit("psi", 1.0 / PSI_PER_BAR) if _is_us() else FieldUnit("bar", 1.0)


def flow_unit() -> FieldUnit:
    """Return the unit of flows: litres or gallons a minute, of litres a minute."""
    a_minute = "dak" if quantities().language == "tr" else "min"
    return FieldUnit(f"gal/{a_minute}", 1.0 / GALLONS_PER_LITRE) if _is_us() else FieldUnit(f"L/{a_minute}", 1.0)


def speed_unit() -> FieldUnit:
    """Return the unit of speeds: metres or feet a second."""
    return FieldUnit("ft/s", METRES_PER_US_FOOT) if _is_us() else FieldUnit("m/s", 1.0)


def speed_text(mps: float | None, digits: int = 2) -> str:
    """Return a speed with its unit; a dash where it is not known."""
    unit = speed_unit()
    text = quantities().number(None if mps is None else unit.shown(mps), digits)
    return text if text == "–" else f"{text} {unit.sign}"


def _is_us() -> bool:
    return quantities().units is Units.US
