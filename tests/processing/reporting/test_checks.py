"""The sheets of the checks before the launch stand in the report, in its language."""

from dataclasses import replace

import pypdf
import pytest

from processing import messages
from processing.live.check_sheet import CheckItem, CheckSheet, Light
from processing.reporting.exports import write_exports

ITEMS = (
    CheckItem("gravity", Light.GREEN, "gravity_good", {"size_mps2": 9.81, "off_pct": 0.1}),
    CheckItem("space", Light.RED, "space_short", {"left_h": 0.5, "planned_h": 2.0}),
    CheckItem("field", Light.OPEN, "field_none", {}),
    CheckItem("knocks", Light.YELLOW, "knocks_few", {"both": 3.0, "heard": 4.0, "felt": 3.0, "jitter_ms": 2.0}),
)
SHEETS = (
    CheckSheet("launch", "2026-05-04T09:00:00+00:00", ITEMS),
    CheckSheet("end", "2026-05-04T11:30:00+00:00", ITEMS[3:]),
)


@pytest.mark.parametrize("language", messages.LANGUAGES)
def test_the_lights_are_printed_with_their_words(results, tmp_path, language):
    checked = replace(results, recording=replace(results.recording, sheets=SHEETS))
    write_exports(checked, {}, tmp_path, language=language)
    pages = pypdf.PdfReader(tmp_path / "report.pdf").pages
    text = " ".join(" ".join(page.extract_text() for page in pages).split())
    assert messages.text("report", "check_title", language) in text
    assert messages.text("report", "check_end_title", language) in text
    assert "2026-05-04 11:30:00 UTC" in text
    for item in ITEMS:
        assert messages.text("check_lights", item.light.value, language) in text
        assert messages.text("check_items", item.key, language) in text
    assert messages.text("check_verdicts", "knocks_few", language, **ITEMS[3].params)[:20] in text


def test_without_a_check_nothing_is_said_of_one(results, tmp_path):
    write_exports(results, {}, tmp_path)
    text = " ".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "report.pdf").pages)
    assert messages.text("report", "check_title") not in text
