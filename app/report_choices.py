"""What the preferences say about quantities and the report: one place that turns habits into options."""

from app.settings import Preferences
from processing.quantities import Places, Quantities, Units
from processing.reporting.options import Company, ReportOptions

FIELDS = ("name", "address", "contact", "licence", "logo", "footer")
EXTRA = "extra"  # one line each: label, colon, value
REPORT_LANGUAGES = ("en", "tr")


def window_quantities(preferences: Preferences, language: str) -> Quantities:
    """Return how the window writes quantities; a word that is not known means metric, or chainage."""
    return Quantities(language, _units(preferences), _places(preferences))


def report_options(preferences: Preferences, language: str) -> ReportOptions:
    """Return how the report reads; ``language`` is the window's, for whoever chose none for the report."""
    chosen = preferences.report_language
    return ReportOptions(
        language=chosen if chosen in REPORT_LANGUAGES else language,
        units=_units(preferences),
        places=_places(preferences),
        company=company(preferences),
        crs=preferences.handover.get("crs", ""),
    )


def company(preferences: Preferences) -> Company:
    """Return who hands the report over, as typed on the settings page."""
    kept = preferences.company
    known = {name: kept.get(name, "").strip() for name in FIELDS}
    return Company(extra=extra_lines(kept.get(EXTRA, "")), **known)


def extra_lines(text: str) -> tuple[tuple[str, str], ...]:
    """Return the label and value of each line ``label: value``; a line without a colon is a value without a label."""
    found = []
    for line in text.splitlines():
        label, colon, value = line.partition(":")
        pair = (label.strip(), value.strip()) if colon else ("", label.strip())
        if any(pair):
            found.append(pair)
    return tuple(found)


def _units(preferences: Preferences) -> Units:
    return Units(preferences.units) if preferences.units in tuple(Units) else Units.METRIC


def _places(preferences: Preferences) -> Places:
    return Places(preferences.places) if preferences.places in tuple(Places) else Places.CHAINAGE
