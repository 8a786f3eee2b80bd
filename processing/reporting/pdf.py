"""``report.pdf``: the template of ``resources/report`` filled with the content, figures as vectors, fonts embedded.

The file is tagged and accessible: PDF/UA-1 and PDF/A-2a, which the page setter itself holds it to.
"""

import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path
from typing import Any, Literal

import typst

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.figures import level_excerpt, profile
from processing.reporting.files import aside_of
from processing.reporting.marks import mark_svg
from processing.reporting.pictures import logo_into, photo_into
from processing.reporting.plan_figure import Surroundings, leak_map, overview
from processing.reporting.qr import qr_svg
from processing.reporting.references import nearest_tapes, references
from processing.reporting.sheets import page_data, rows_with_sheet
from processing.reporting.spectrogram import spectrogram_excerpt
from processing.reporting.words import Words
from processing.survey import Verdict

Standards = tuple[Literal["ua-1", "a-2a"], ...]
STANDARDS: Standards = ("ua-1", "a-2a")
# points; the page's text is 180 mm wide
PLAN, PROFILE, EXCERPT = (510.0, 340.0), (510.0, 170.0), (250.0, 96.0)
# a sheet shows the highest that has room, so that long notes make a map low and not its words small
LEAK_MAP_WIDTH, LEAK_MAP_HEIGHTS = 336.0, (220, 190, 160, 135, 110, 90)


def write_pdf(path: Path, content: ReportContent, progress: Progress) -> None:
    """Write the report as ``content.options`` have it; figures are made in a folder of their own that is then removed.

    Raises:
        LeaklineError: REPORT_FAILED with the template's own words, CANNOT_WRITE.
    """
    with _laid_out(content, progress) as folder:
        pdf = _compiled(folder, path)
    aside = aside_of(path)
    try:
        aside.write_bytes(pdf)
        aside.replace(path)
    finally:
        aside.unlink(missing_ok=True)


def page_pictures(content: ReportContent, pixels_per_inch: float, progress: Progress) -> tuple[bytes, ...]:
    """Return the report's pages as PNG pictures, to be looked at before anything is written.

    Raises:
        LeaklineError: REPORT_FAILED with the template's own words.
    """
    with _laid_out(content, progress) as folder, resources.as_file(resources.files("resources") / "fonts") as fonts:
        progress.update(0.9, "exporting")
        try:
            pages: bytes | list[bytes] = typst.compile(
                str(folder / "report.typ"),
                font_paths=[str(fonts)],
                ignore_system_fonts=True,
                root=str(folder),
                format="png",
                ppi=pixels_per_inch,
            )
        except RuntimeError as error:  # typst has no narrower class
            raise LeaklineError(ErrorCode.REPORT_FAILED, reason=str(error)) from error
    return (pages,) if isinstance(pages, bytes) else tuple(pages)


@contextmanager
def _laid_out(content: ReportContent, progress: Progress) -> Iterator[Path]:
    """Yield a folder with the template, its figures and its words, gone afterwards."""
    data = page_data(content)
    with tempfile.TemporaryDirectory(prefix="leakline-report-") as name:
        folder = Path(name)
        _add_figures(data, content, folder, progress)
        (folder / "data.json").write_text(json.dumps(data, ensure_ascii=False), encoding="utf-8", errors="replace")
        for part in ("report.typ", "dig_sheet.typ"):
            template = (resources.files("resources") / "report" / part).read_text(encoding="utf-8")
            (folder / part).write_text(template, encoding="utf-8")
        yield folder


def _compiled(folder: Path, path: Path) -> bytes:
    """Return the report to the standards; where a note has letters that no font here has, without them rather than not.

    Both standards refuse a page with a letter that cannot be shown; a reader sees a box in its place.
    """
    try:
        return _set(folder, STANDARDS)
    except RuntimeError:  # typst has no narrower class
        try:
            return _set(folder, ())
        except RuntimeError as error:
            raise LeaklineError(ErrorCode.REPORT_FAILED, Place(path), reason=str(error)) from error


def _set(folder: Path, standards: Standards) -> bytes:
    with resources.as_file(resources.files("resources") / "fonts") as fonts:
        pdf: bytes = typst.compile(
            str(folder / "report.typ"),
            font_paths=[str(fonts)],
            ignore_system_fonts=True,
            root=str(folder),
            pdf_standards=list(standards),
        )
    return pdf


class _Desk:
    """The folder in which the template and its figures lie."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def keep(self, name: str, svg: str | None) -> str | None:
        """Write a figure and return its name; None where there is none."""
        if svg is None:
            return None
        (self._folder / name).write_text(svg, encoding="utf-8", errors="replace")
        return name

    def photo(self, row: LeakRow, content: ReportContent) -> str | None:
        """Put the first readable photo of a leak there and return its name."""
        name = f"photo{row.candidate.label}.jpg"
        own = (path for photo, path in content.record.photos if photo.number == row.candidate.label)
        return name if any(photo_into(Path(path), self._folder / name) for path in own) else None


def _add_figures(data: dict[str, Any], content: ReportContent, folder: Path, progress: Progress) -> None:
    """Put all figures beside the template and their names into ``data``."""
    words, desk = Words(content.options), _Desk(folder)
    known = references(content.results)
    logo = content.options.company.logo
    data["logo"] = logo_into(Path(logo), folder) if logo else None
    if logo and data["logo"] is None:
        data["appendix"]["findings"].append(words("logo_unusable", file=Path(logo).name))
    data["marks"] = {verdict.value: desk.keep(f"mark-{verdict.value}.svg", mark_svg(verdict)) for verdict in Verdict}
    data["map"] = desk.keep("map.svg", overview(content, known, words, PLAN))
    data["profile"] = desk.keep("profile.svg", profile(content, known, words, PROFILE))
    rows = rows_with_sheet(content)
    for index, (row, page) in enumerate(zip(rows, data["sheets"], strict=True)):
        progress.update(0.8 * index / len(rows), "exporting")
        number = row.candidate.label
        around = Surroundings(row, nearest_tapes(row.candidate, content.results, known), known)
        page["maps"] = [
            [desk.keep(f"map{number}-{high}.svg", svg), high]
            for high in LEAK_MAP_HEIGHTS
            if (svg := leak_map(content, around, words, (LEAK_MAP_WIDTH, float(high)))) is not None
        ]
        page["level_figure"] = desk.keep(f"level{number}.svg", level_excerpt(content, row, words, EXCERPT))
        excerpt = spectrogram_excerpt(content, row, words, EXCERPT)
        page["spectrogram"] = desk.keep(f"spectrogram{number}.svg", excerpt)
        page["qr"] = desk.keep(f"qr{number}.svg", qr_svg(page["geo"])) if page["geo"] else None
        page["photo"] = desk.photo(row, content)
    progress.update(0.85, "exporting")
