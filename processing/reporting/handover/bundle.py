"""Packs all files of a hand-over into one zip, whole or not at all, names relative and in a fixed order."""

import zipfile
from collections.abc import Iterable
from pathlib import Path

from processing.progress import Progress
from processing.reporting.content import ReportContent
from processing.reporting.files import whole_path
from processing.storage.files import safe_name

LONGEST_SURVEY = 60
_PACKED = {".zip", ".pdf", ".jpg", ".jpeg", ".png", ".webp", ".heic"}  # packing them again saves nothing


def bundle_name(content: ReportContent) -> str:
    """Return ``Survey-2026-05-04-run-0123abcd.zip``: the run as the report prints it."""
    info = content.results.survey.info
    survey = safe_name(info.name)[:LONGEST_SURVEY].rstrip("-. ")
    run = safe_name(content.results.run_hash, "run")[:8]
    parts = [survey, safe_name(info.date, "undated"), "run", run]
    return "-".join(parts) + ".zip"


def write_bundle(path: Path, folder: Path, files: Iterable[Path], progress: Progress) -> None:
    """Pack ``files`` of ``folder`` under their names in it. Raises OSError, and Cancelled with nothing left behind."""
    members = sorted({file.relative_to(folder).as_posix(): file for file in files}.items())
    total = sum(file.stat().st_size for _, file in members) or 1
    done = 0
    with whole_path(path) as aside, zipfile.ZipFile(aside, "w", zipfile.ZIP_DEFLATED, compresslevel=6) as archive:
        for name, file in members:
            progress.update(done / total, "handing_over")
            kind = zipfile.ZIP_STORED if file.suffix.lower() in _PACKED else zipfile.ZIP_DEFLATED
            archive.write(file, name, compress_type=kind)
            done += file.stat().st_size
    progress.update(1.0)
