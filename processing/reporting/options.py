"""What the operator chose about the report and the files that are handed over; looks and habits, no facts."""

from dataclasses import dataclass, field
from enum import StrEnum

from processing.quantities import Places, Units


@dataclass(frozen=True)
class Company:
    """Who hands the report over: the report's template fields. ``logo`` is the path of a PNG, JPEG or SVG, or empty."""

    name: str = ""
    address: str = ""
    contact: str = ""
    licence: str = ""  # of the surveyor, or a project number
    logo: str = ""
    footer: str = ""
    extra: tuple[tuple[str, str], ...] = ()  # further lines of the cover: label and value


@dataclass(frozen=True)
class ReportOptions:
    """How the report reads."""

    language: str = "en"
    units: Units = Units.METRIC
    places: Places = Places.CHAINAGE
    company: Company = field(default_factory=Company)
    crs: str = ""  # coordinates are told in, besides WGS 84; empty: the survey's own, else its UTM zone


class ColumnScheme(StrEnum):
    """How columns are named: our own, or those that a utility's asset system loads."""

    LEAKLINE = "leakline"
    ASSET = "asset"  # pipe_id, leak_distance, x, y …


class FileKind(StrEnum):
    """What can be handed over besides the report and the contract's own files."""

    DECISIONS_CSV = "decisions_csv"
    EXCEL_CSV = "excel_csv"
    KML = "kml"
    GPX = "gpx"
    GEOPACKAGE = "geopackage"
    SHAPEFILE = "shapefile"
    DXF = "dxf"
    RAVEN = "raven"


@dataclass(frozen=True)
class HandoverOptions:
    """Which files, in which system and under which names; empty ``crs`` is the survey's own, else its UTM zone."""

    files: frozenset[FileKind] = frozenset(FileKind)
    crs: str = ""
    units: Units = Units.METRIC  # of lengths in tables and drawings: metres or US survey feet
    columns: ColumnScheme = ColumnScheme.LEAKLINE
    pipe_id: str = ""
    as_zip: bool = True
