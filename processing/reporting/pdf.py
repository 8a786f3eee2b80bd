"""``report.pdf``: the template of ``resources/report`` filled with the content, figures as vectors, fonts embedded."""

import json
import tempfile
from importlib import resources
from pathlib import Path

import typst

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress
from processing.reporting.content import ReportContent
from processing.reporting.figures import MapLabels, level_excerpt, plan_map, profile
from processing.reporting.files import aside_of
from processing.reporting.sheets import Words, page_data, rows_with_sheet
from processing.reporting.spectrogram import spectrogram_excerpt

WIDE, MAP, LEAK_MAP = (494.0, 150.0), (494.0, 205.0), (494.0, 200.0)  # points; the page's text is 174 mm wide


def write_pdf(path: Path, content: ReportContent, progress: Progress) -> None:
    """Write the report as ``content.options`` have it; figures are made in a folder of their own that is then removed.

    Raises:
        LeaklineError: REPORT_FAILED with the template's own words, CANNOT_WRITE.
    """
    language = content.options.language
    data = page_data(content, language)
    words = Words(language)
    with tempfile.TemporaryDirectory(prefix="leakline-report-") as name:
        folder = Path(name)
        _add_figures(data, content, words, folder, progress)
        (folder / "data.json").write_text(json.dumps(data, ensure_ascii=False), encoding="utf-8", errors="replace")
        template = (resources.files("resources") / "report" / "report.typ").read_text(encoding="utf-8")
        (folder / "report.typ").write_text(template, encoding="utf-8")
        with resources.as_file(resources.files("resources") / "fonts") as fonts:
            try:
                pdf = typst.compile(
                    str(folder / "report.typ"), font_paths=[str(fonts)], ignore_system_fonts=True, root=str(folder)
                )
            except RuntimeError as error:  # typst has no narrower class
                raise LeaklineError(ErrorCode.REPORT_FAILED, Place(path), reason=str(error)) from error
    aside = aside_of(path)
    try:
        aside.write_bytes(pdf)
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def _add_figures(data: dict, content: ReportContent, words: Words, folder: Path, progress: Progress) -> None:  # type: ignore[type-arg]
    labels = MapLabels(words("launch"), words("north"))

    def keep(name: str, svg: str | None) -> str | None:
        if svg is None:
            return None
        (folder / name).write_text(svg, encoding="utf-8", errors="replace")
        return name

    data["map"] = keep("map.svg", plan_map(content, labels, MAP))
    data["profile"] = keep("profile.svg", profile(content, words("axis_chainage"), words("axis_up"), WIDE))
    rows = rows_with_sheet(content)
    for index, (row, page) in enumerate(zip(rows, data["sheets"], strict=True)):
        progress.update(0.9 * index / len(rows), "exporting")
        number = row.candidate.label
        page["map"] = keep(f"map{number}.svg", plan_map(content, labels, LEAK_MAP, around=row))
        level = level_excerpt(content, row, words("axis_chainage"), words("axis_level"), WIDE)
        page["level_figure"] = keep(f"level{number}.svg", level)
        excerpt = spectrogram_excerpt(content, row, words("axis_time"), words("axis_frequency"), WIDE)
        page["spectrogram"] = keep(f"spectrogram{number}.svg", excerpt)
