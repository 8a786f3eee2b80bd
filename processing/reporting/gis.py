"""``leaks.geojson``: leaks, path, tie points and what was not assessed, in WGS 84 where the launch is known.

Without launch coordinates GeoJSON has no honest form for local metres; the same features are then written in local
east-north metres and the collection says so in its member ``frame``.
"""

import json
from pathlib import Path
from typing import Any

import numpy as np

from processing.position import distance
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.files import whole_file
from processing.reporting.references import is_heading_known
from processing.survey import FloatArray, Track

LINE_STEP_M = 0.5  # a vertex each half metre is finer than any interval we state


def write_geojson(path: Path, content: ReportContent) -> None:
    """Write one FeatureCollection; features carry ``kind``: leak, path, not_assessed, tie_point or launch."""
    features = [leak_feature(row, content) for row in content.rows if np.all(np.isfinite(row.candidate.position_w_m))]
    track = content.results.track
    if track is not None:
        features += path_features(track, content)
        features += tie_features(track, content)
    geographic = content.frame.is_geographic
    collection = {
        "type": "FeatureCollection",
        "name": content.results.survey.info.name or "Leakline",
        "frame": "WGS 84" if geographic else _local_name(content),
        "features": features,
    }
    with whole_file(path) as file:
        json.dump(collection, file, ensure_ascii=False, allow_nan=False, indent=1)


def _local_name(content: ReportContent) -> str:
    told = "local east-north metres from the launch point (not WGS 84)"
    return told if is_heading_known(content.results) else f"{told}, may be turned as a whole: direction not known"


def leak_feature(row: LeakRow, content: ReportContent) -> dict[str, Any]:
    """Return a candidate as a point."""
    c = row.candidate
    properties = {
        "kind": "leak",
        "id": c.label,
        "status": row.status,
        "verdict": row.decision.verdict.value,
        "class": row.leak_class.value,
        "time_s": number(c.time_s, 3),
        "chainage_m": number(c.chainage_m, 3),
        "chainage_low95_m": number(c.chainage_low95_m, 3),
        "chainage_high95_m": number(c.chainage_high95_m, 3),
        "score": number(c.score, 4),
        "level_dB": number(c.level_db, 2),
        "note": row.decision.note,
        "size": row.size.name if row.size is not None else None,
        "size_basis": row.size.basis_text if row.size is not None else None,
    }
    return feature("Point", vertices(np.array([c.position_w_m]), content)[0], properties)


def path_features(track: Track, content: ReportContent) -> list[dict[str, Any]]:
    """Return the whole path, and each stretch that was not assessed, as lines."""
    whole = {"kind": "path", "start_m": number(track.chainage_m[0], 2), "end_m": number(track.chainage_m[-1], 2)}
    features = [line(track, track.chainage_m[0], track.chainage_m[-1], whole, content)]
    for part in content.unassessed:
        if part.start_m is None or part.end_m is None:
            continue
        properties = {
            "kind": "not_assessed",
            "channel": part.stretch.channel.value,
            "reason": part.stretch.reason,
            "start_m": number(part.start_m, 2),
            "end_m": number(part.end_m, 2),
        }
        features.append(line(track, part.start_m, part.end_m, properties, content))
    return features


def line(
    track: Track, start_m: float, end_m: float, properties: dict[str, Any], content: ReportContent
) -> dict[str, Any]:
    """Return the path between two chainages with a vertex each half metre (at least two)."""
    count = max(2, int((end_m - start_m) / LINE_STEP_M) + 1)
    times, _ = distance.times_at(track, np.linspace(start_m, end_m, count))
    return feature("LineString", vertices(distance.places_at(track, times).position_w_m, content), properties)


def tie_features(track: Track, content: ReportContent) -> list[dict[str, Any]]:
    """Return launch and tie points where the fitted path puts them."""
    features = [feature("Point", vertices(track.position_w_m[:1], content)[0], {"kind": "launch", "name": "launch"})]
    for tie in content.results.survey.tie_points:
        if not track.time_s[0] <= tie.time_s <= track.time_s[-1]:
            continue
        position = distance.places_at(track, tie.time_s).position_w_m
        properties = {
            "kind": "tie_point",
            "name": tie.name,
            "time_s": number(tie.time_s, 3),
            "chainage_m": number(tie.chainage_m, 3),
            "sigma_m": tie.sigma_m,
            "enabled": tie.enabled,
        }
        features.append(feature("Point", vertices(position, content)[0], properties))
    return features


def vertices(position_w_m: FloatArray, content: ReportContent) -> list[list[float]]:
    """Return positions (n, 3) as GeoJSON coordinates: longitude, latitude, height; or east, north, up."""
    if not content.frame.is_geographic:
        return [[round(float(v), 3) for v in row] for row in position_w_m]
    degrees = content.frame.to_geographic(np.asarray(position_w_m))
    return [[round(float(lon), 8), round(float(lat), 8), round(float(up), 3)] for lat, lon, up in degrees]


def feature(kind: str, coordinates: list[Any], properties: dict[str, Any]) -> dict[str, Any]:
    """Return one GeoJSON feature."""
    return {"type": "Feature", "geometry": {"type": kind, "coordinates": coordinates}, "properties": properties}


def number(value: float | None, digits: int) -> float | None:
    """Return a rounded number, None where it is unknown."""
    return None if value is None or not np.isfinite(value) else round(float(value), digits)
