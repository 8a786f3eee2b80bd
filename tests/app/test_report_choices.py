"""What was typed on the settings page is what the report is told."""

import pytest

from app.report_choices import extra_lines, report_options, window_quantities
from app.settings import Preferences
from processing.quantities import Places, Units


def test_defaults_are_metric_chainage_and_the_language_of_the_window():
    options = report_options(Preferences(), "tr")
    assert (options.language, options.units, options.places) == ("tr", Units.METRIC, Places.CHAINAGE)
    assert options.company.name == ""
    assert options.company.extra == ()


def test_the_report_may_speak_another_language_than_the_window():
    assert report_options(Preferences(report_language="en"), "tr").language == "en"


def test_what_was_typed_arrives_trimmed():
    typed = {"name": " Su A.Ş. ", "logo": "/x/logo.png", "footer": "gizli", "extra": "Proje: 12: b\n\nyalnız değer\n :"}
    company = report_options(Preferences(company=typed), "en").company
    assert (company.name, company.logo, company.footer) == ("Su A.Ş.", "/x/logo.png", "gizli")
    assert company.extra == (("Proje", "12: b"), ("", "yalnız değer"))


def test_words_that_are_not_known_mean_the_defaults():
    strange = Preferences(units="cubits", places="moon", report_language="xx")
    assert report_options(strange, "en").units is Units.METRIC
    assert window_quantities(strange, "en").places is Places.CHAINAGE
    assert report_options(strange, "en").language == "en"


@pytest.mark.parametrize(("units", "text"), [("metric", "100.0 m"), ("us", "328.1 ft")])
def test_the_window_writes_lengths_as_chosen(units, text):
    assert window_quantities(Preferences(units=units), "en").length(100.0) == text


def test_no_line_gives_no_extra_fields():
    assert extra_lines("\n  \n") == ()
