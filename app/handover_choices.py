"""What the preferences, or the words of the command line, say about the files to hand over."""

from app.settings import Preferences, PreferencesStore
from processing.importing.route_files.crs import known_crs
from processing.quantities import Units
from processing.reporting.options import ColumnScheme, FileKind, HandoverOptions

NO_FILES = "none"  # an empty entry means that nobody chose yet
MAX_RECENT_CRS = 6
_WORDS = {kind.value.removesuffix("_csv"): kind for kind in FileKind}


def handover_options(preferences: Preferences) -> HandoverOptions:
    """Return which files are handed over, as chosen last; what nobody chose yet is as by default: all files."""
    kept = preferences.handover
    default = HandoverOptions()
    files = default.files
    if kept.get("files"):
        files = frozenset(kind for kind in FileKind if kind.value in kept["files"].split(","))
    return HandoverOptions(
        files=files,
        crs=kept.get("crs", default.crs),
        units=Units(kept["units"]) if kept.get("units") in tuple(Units) else _units(preferences),
        columns=ColumnScheme(kept["columns"]) if kept.get("columns") in tuple(ColumnScheme) else default.columns,
        pipe_id=kept.get("pipe_id", default.pipe_id),
        as_zip=kept.get("zip", "yes") != "no",
    )


def remember_handover(store: PreferencesStore, options: HandoverOptions) -> None:
    """Keep what was chosen for the next time; a system that was chosen joins the recent ones."""
    kept = {
        "files": ",".join(kind.value for kind in FileKind if kind in options.files) or NO_FILES,
        "crs": options.crs,
        "units": options.units.value,
        "columns": options.columns.value,
        "pipe_id": options.pipe_id,
        "zip": "yes" if options.as_zip else "no",
    }
    recent = store.values.recent_crs
    if options.crs:
        recent = [options.crs, *(code for code in recent if code != options.crs)][:MAX_RECENT_CRS]
    if kept != store.values.handover or recent != store.values.recent_crs:
        store.change(handover=kept, recent_crs=recent)


def options_of_words(files: frozenset[str] | None, crs: str | None) -> HandoverOptions | None:
    """Return the hand-over that ``--files`` and ``--crs`` ask for; None for none, all files for a system alone.

    Raises:
        LeaklineError: CRS_UNKNOWN.
    """
    if files is None and crs is None:
        return None
    told = "" if crs is None else known_crs(crs)
    if files is None:
        return HandoverOptions(crs=told)
    return HandoverOptions(
        files=frozenset(kind for word, kind in _WORDS.items() if word in files), crs=told, as_zip="zip" in files
    )


def _units(preferences: Preferences) -> Units:
    return Units(preferences.units) if preferences.units in tuple(Units) else Units.METRIC
