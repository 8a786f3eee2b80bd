"""The report says of each tie point how far off the path would have been without it, in both languages."""

import json
from dataclasses import replace

import pypdf
import pytest

from processing.position.tie_checks import TieCheck
from processing.reporting.exports import write_exports

CHECKS = (
    TieCheck("valve 12", 60.0, "chainage", 0.21, -1.34, 0.5, held_down=False),
    TieCheck("hydrant <b>", 160.0, "place", 18.4, 19.9, 0.7, held_down=True),
    TieCheck("", 200.0, "chainage", 0.02, 0.45, 0.6, held_down=False),
)
WORDS = {
    "en": ("If one of them had not been known", "Pipe length", "little: all else contradicts it", "coordinates"),
    "tr": ("Biri bilinmeseydi", "Boru uzunluğu", "az: geri kalan her şeyle çelişiyor", "koordinat"),
}


@pytest.mark.parametrize("language", ["en", "tr"])
def test_each_tie_point_has_a_line_with_its_residual_and_what_leaving_it_out_costs(results, tmp_path, language):
    write_exports(replace(results, tie_checks=CHECKS), {}, tmp_path, language=language)
    pages = pypdf.PdfReader(tmp_path / "report.pdf").pages
    text = " ".join(" ".join(page.extract_text().split()) for page in pages)
    figures = ("+0.21 m", "\N{MINUS SIGN}1.34 m ± 0.98 m", "19.90 m ± 1.37 m")
    if language == "tr":
        figures = tuple(figure.replace(".", ",") for figure in figures)
    for words in (*WORDS[language], "valve 12", "hydrant <b>", *figures):
        assert words in text, words
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    assert [row["left_out_m"] for row in summary["quality"]["tie_checks"]] == [-1.34, 19.9, 0.45]
    assert [row["held_down"] for row in summary["quality"]["tie_checks"]] == [False, True, False]


def test_a_run_without_tie_points_has_no_such_table(results, tmp_path):
    write_exports(results, {}, tmp_path)
    text = "\n".join(page.extract_text() for page in pypdf.PdfReader(tmp_path / "report.pdf").pages)
    assert "If one of them had not been known" not in text
