"""The route that survey.toml names by a file: ``[route] file = "main.gpkg"``, and ``crs`` and ``sigma_m`` if needed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from processing.errors import ErrorCode, LeaklineError, Place
from processing.importing.route_files.building import FROM_LAUNCH, RouteChoice, map_scale, route_from
from processing.importing.route_files.crs import known_crs
from processing.importing.route_files.joining import one_line, sections_of
from processing.importing.route_files.lines import RouteFile
from processing.importing.route_files.registry import read_route_file
from processing.survey import Route, Survey


def told_route(survey_file: Path, place: Place, name: str, values: Mapping[str, Any], survey: Survey) -> Route:
    """Return the route in the file ``name`` of the survey's folder; a ``crs`` in ``values`` wins over the file's own.

    Raises:
        LeaklineError: SETTING_INVALID for a name that leads out of the folder, ROUTE_NEEDS_CRS, ROUTE_NOT_ONE_LINE;
            the errors of reading and of :func:`~processing.importing.route_files.building.route_from`.
    """
    folder = survey_file.parent.resolve()
    path = (folder / name).resolve()
    if not path.is_relative_to(folder):
        allowed = f"{folder}/…"
        raise LeaklineError(ErrorCode.SETTING_INVALID, place, name="route.file", value=name[:80], allowed=allowed)
    try:
        return _route_of(read_route_file(path), values, survey)
    except LeaklineError as error:
        raise LeaklineError(error.code, error.place or Place(path), **error.params) from None


def _route_of(file: RouteFile, values: Mapping[str, Any], survey: Survey) -> Route:
    told = values.get("crs")
    crs = FROM_LAUNCH if told == FROM_LAUNCH else known_crs(told) if told is not None else file.crs
    if crs is None:
        raise LeaklineError(ErrorCode.ROUTE_NEEDS_CRS)
    scale = map_scale(crs, file.unit_m, file.lines[0].points)
    line = one_line(sections_of(file.lines, scale), scale)
    choice = RouteChoice(crs, file.unit_m, sigma_m=values.get("sigma_m", Route.sigma_m))
    return route_from(line, choice, survey).route
