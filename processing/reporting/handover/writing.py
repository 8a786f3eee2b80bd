"""Writes all files of a hand-over beside the contract's own; a format that fails is told and costs no other."""

import errno
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from processing.errors import Cancelled
from processing.progress import Progress
from processing.reporting.content import ReportContent
from processing.reporting.handover import bundle, drawing, geopackage, gpx, kml, raven, readme, shapefiles, spreadsheets
from processing.reporting.handover.layers import Layers, has_elevation, make_layers
from processing.reporting.handover.outcome import Written
from processing.reporting.handover.photos import FOLDER as PHOTOS
from processing.reporting.handover.photos import copy_photos
from processing.reporting.handover.system import TargetSystem, for_drawing, proposed, target_system
from processing.reporting.handover.words import HandoverWords
from processing.reporting.options import FileKind, HandoverOptions
from processing.reporting.references import is_heading_known
from processing.survey import Finding, Severity

log = logging.getLogger(__name__)

FILE_NAMES = {
    FileKind.DECISIONS_CSV: spreadsheets.DECISIONS_NAME,
    FileKind.EXCEL_CSV: spreadsheets.LEAKS_NAME,
    FileKind.KML: kml.FILE_NAME,
    FileKind.GPX: gpx.FILE_NAME,
    FileKind.GEOPACKAGE: geopackage.FILE_NAME,
    FileKind.SHAPEFILE: f"{shapefiles.FOLDER}/",
    FileKind.DXF: drawing.FILE_NAME,
    FileKind.RAVEN: f"{raven.FOLDER}/",
}
MAP_KINDS = frozenset({FileKind.KML, FileKind.GPX, FileKind.GEOPACKAGE, FileKind.SHAPEFILE, FileKind.DXF})
DISC_FULL = {errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)}  # Windows knows no quota
_IN_THE_WORLD = frozenset({FileKind.KML, FileKind.GPX})  # they know nothing but longitude and latitude
_CONTRACT = {
    "report.pdf": "report", "leaks.csv": "leaks", "track.csv": "track", "leaks.geojson": "geojson",
    "summary.json": "summary",
}  # fmt: skip


def write_handover(
    content: ReportContent,
    options: HandoverOptions,
    folder: Path,
    contract: Sequence[Path],
    progress: Progress,
) -> Written:
    """Write the chosen files into ``folder``, then README.txt, then all with the ``contract``'s files as one zip.

    Returns the new files with what was left out, cut or failed, as findings.

    Raises:
        LeaklineError: CRS_UNKNOWN for a code that does not exist.
        OSError: for a full disc, on which no further file would fit either.
    """
    system, findings = _usable_system(content, options)
    done = Written((), findings)
    job = _Job(content, options, folder, make_layers(content, options, system))
    kinds = [kind for kind in FileKind if kind in options.files]
    for i, kind in enumerate(kinds):
        progress.update(0.8 * i / max(len(kinds), 1), "handing_over")
        why = _left_out(kind, content, system)
        if why is None:
            done += _guarded(FILE_NAMES[kind], partial(job.write, kind))
        elif why not in done.findings:  # one reason for many files is told once
            done += Written((), (why,))
    done += _photos(content, folder)
    done += _guarded(readme.FILE_NAME, lambda: job.write_readme(contract, done))
    if options.as_zip:
        path = folder / bundle.bundle_name(content)
        files = (*contract, *done.files)
        done += _guarded(path.name, lambda: _zipped(path, folder, files, progress.part(0.8, 1.0)))
    return done


@dataclass(frozen=True)
class _Job:
    content: ReportContent
    options: HandoverOptions
    folder: Path
    layers: Layers

    @property
    def words(self) -> HandoverWords:
        simulated = self.content.results.survey.info.simulated
        return HandoverWords(self.content.options.language, simulated=simulated)

    @property
    def title(self) -> str:
        info = self.content.results.survey.info
        told = " ".join(part for part in (info.name or "Leakline", info.date) if part)
        return f"{self.words('simulated_short')} {told}" if info.simulated else told

    def write(self, kind: FileKind) -> Written:
        path = self.folder / FILE_NAMES[kind]
        content, layers, words, title = self.content, self.layers, self.words, self.title
        elevations = has_elevation(content)
        if kind is FileKind.DECISIONS_CSV:
            spreadsheets.write_decisions(path, content)
        elif kind is FileKind.EXCEL_CSV:
            return Written(spreadsheets.write_excel(self.folder, layers, words))
        elif kind is FileKind.KML:
            kml.write_kml(path, layers, title, content.results.survey.info.date, words, elevations=elevations)
        elif kind is FileKind.GPX:
            gpx.write_gpx(path, layers, title, words, elevations=elevations)
        elif kind is FileKind.GEOPACKAGE:
            geopackage.write_geopackage(path, layers, title, words)
        elif kind is FileKind.SHAPEFILE:
            return shapefiles.write_shapefiles(path, layers)
        elif kind is FileKind.DXF:
            return drawing.write_drawing(path, layers, title, words)
        else:
            return raven.write_raven(path, content)
        return Written((path,))

    def write_readme(self, contract: Sequence[Path], done: Written) -> Written:
        told = _CONTRACT if self.content.frame.is_geographic else _CONTRACT | {"leaks.geojson": "geojson_local"}
        names = [(path.name, told[path.name]) for path in contract if path.name in told]
        written = {path.relative_to(self.folder).as_posix() for path in done.files}
        for kind, name in FILE_NAMES.items():
            if any(entry == name or entry.startswith(name) for entry in written):
                names.append((name, kind.value))
        if any(entry.startswith(f"{PHOTOS}/") for entry in written):
            names.append((f"{PHOTOS}/", "photos"))
        path = self.folder / readme.FILE_NAME
        layers = self.layers if self.content.results.track is not None else None
        language = self.content.options.language
        readme.write_readme(path, self.content, layers, names, done.findings, language)
        return Written((path,))


def _usable_system(content: ReportContent, options: HandoverOptions) -> tuple[TargetSystem, tuple[Finding, ...]]:
    """The chosen system with what is to be said of it; another where it has no coordinates for this place."""
    system = target_system(content.frame, options)
    track = content.results.track
    if track is None:
        return system, ()
    findings: list[Finding] = []
    maps = options.files & MAP_KINDS
    if system.is_local:
        if not is_heading_known(content.results):
            if maps:
                findings.append(Finding("handover_no_direction", Severity.WARNING))
        elif maps - _IN_THE_WORLD:
            unit = HandoverWords(content.options.language)(f"unit_{system.unit}")
            findings.append(Finding("handover_local", Severity.WARNING, {"unit": unit}))
        return system, tuple(findings)
    some = track.position_w_m[:: max(1, len(track.time_s) // 200)]
    if not np.all(np.isfinite(system.coordinates(some))):
        other = target_system(content.frame, replace(options, crs=proposed(content.frame)))
        told = {"crs": system.label, "other": other.label}
        findings.append(Finding("handover_crs_unreachable", Severity.WARNING, told))
        system = other
    elif not system.holds(some):
        findings.append(Finding("handover_elsewhere", Severity.WARNING, {"crs": system.label}))
    if system.is_degrees and FileKind.DXF in maps:
        findings.append(Finding("handover_drawing_crs", Severity.INFO, {"crs": for_drawing(system, options).label}))
    return system, tuple(findings)


def _left_out(kind: FileKind, content: ReportContent, system: TargetSystem) -> Finding | None:
    if kind in MAP_KINDS and content.results.track is None:
        return Finding("handover_no_path", Severity.WARNING)
    if kind in _IN_THE_WORLD and system.is_local:
        code = "handover_no_place" if is_heading_known(content.results) else "handover_turned"
        return Finding(code, Severity.WARNING, {"file": FILE_NAMES[kind]})
    return None


def _guarded(name: str, write: Callable[[], Written]) -> Written:
    """Write a format; whatever goes wrong with it is logged and told, and the others are written all the same."""
    try:
        return write()
    except Cancelled:
        raise
    except OSError as error:
        if error.errno in DISC_FULL:
            raise
        reason = error.strerror or str(error)
        log.warning("%s was not written: %s", name, error)
    except Exception as error:
        reason = f"{type(error).__name__}: {error}"
        log.exception("%s was not written", name)
    return Written((), (Finding("handover_format_failed", Severity.WARNING, {"file": name, "reason": reason}),))


def _photos(content: ReportContent, folder: Path) -> Written:
    """Copy the photos; one that is gone is told."""
    there, findings = [], list[Finding]()
    for photo, source in content.record.photos:
        try:
            with Path(source).open("rb"):
                there.append((photo, source))
        except OSError as error:
            params = {"file": photo.file, "reason": error.strerror or str(error)}
            findings.append(Finding("handover_photo_missing", Severity.WARNING, params))
    copied = _guarded(f"{PHOTOS}/", lambda: Written(copy_photos(tuple(there), folder)))
    return copied + Written((), tuple(findings))


def _zipped(path: Path, folder: Path, files: Sequence[Path], progress: Progress) -> Written:
    bundle.write_bundle(path, folder, files, progress)
    return Written((path,))
