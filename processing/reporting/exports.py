"""All files that a processed survey leaves behind, in one folder."""

import errno
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from processing.errors import ErrorCode, LeaklineError, Place
from processing.progress import Progress, silent
from processing.reporting.content import ReportContent, make_content
from processing.reporting.gis import write_geojson
from processing.reporting.handover.outcome import Written
from processing.reporting.handover.system import target_system
from processing.reporting.options import HandoverOptions, ReportOptions
from processing.reporting.summary import write_summary
from processing.reporting.tables import write_leaks, write_track
from processing.review_facts import ReviewRecord
from processing.survey import Decision

if TYPE_CHECKING:
    from processing.results import Results


def write_exports(
    results: "Results",
    decisions: Mapping[int, Decision],
    out_dir: Path,
    progress: Progress | None = None,
    language: str | None = None,
    record: ReviewRecord | None = None,
    options: ReportOptions | None = None,
    handover: HandoverOptions | None = None,
) -> Written:
    """Write ``leaks.csv``, ``track.csv``, ``leaks.geojson``, ``summary.json`` and ``report.pdf``; return their paths.

    With ``handover`` its files follow, a README.txt and the zip of all; what was left out, cut or failed of them is
    told as findings, and costs no other file. ``language`` is the report's, where it is not that of ``options``.

    Raises:
        LeaklineError: CANNOT_WRITE or DISC_FULL; a file that was there before is then still whole. CRS_UNKNOWN.
    """
    from processing.reporting.pdf import write_pdf  # typst is large: loaded when a report is asked for

    progress = progress or silent()
    options = options or ReportOptions()
    if language is not None:
        options = replace(options, language=language)
    if handover is not None and not options.crs:
        options = replace(options, crs=handover.crs)
    content = make_content(results, decisions, record, options)
    if handover is not None:
        target_system(content.frame, handover)  # a wrong code is told before an hour's work, not after it
    names = ("leaks.csv", "track.csv", "leaks.geojson", "summary.json", "report.pdf")
    leaks, track, geojson, summary, report = (out_dir / name for name in names)
    try:
        out_dir.mkdir(parents=True, exist_ok=True)
        progress.update(0.0, "exporting")
        write_leaks(leaks, content)
        write_track(track, content)
        progress.update(0.3, "exporting")
        write_geojson(geojson, content)
        write_summary(summary, content)
        write_pdf(report, content, progress.part(0.4, 0.8 if handover is not None else 1.0))
        done = Written((leaks, track, geojson, summary, report))
        if handover is not None:
            done += _handed_over(content, handover, out_dir, done.files, progress.part(0.8, 1.0))
    except OSError as error:
        code = ErrorCode.DISC_FULL if error.errno == errno.ENOSPC else ErrorCode.CANNOT_WRITE
        # the full disc may be that of the temporary folder, where the report is set
        where = out_dir
        if code is ErrorCode.DISC_FULL and isinstance(error.filename, str):
            where = Path(error.filename).parent
        raise LeaklineError(code, Place(where), reason=error.strerror or str(error)) from error
    progress.update(1.0, "exporting")
    return done


def _handed_over(
    content: ReportContent, options: HandoverOptions, out_dir: Path, contract: tuple[Path, ...], progress: Progress
) -> Written:
    from processing.reporting.handover.writing import write_handover  # drawings and map files: loaded when wanted

    return write_handover(content, options, out_dir, contract, progress)
