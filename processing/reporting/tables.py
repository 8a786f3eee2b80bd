"""``leaks.csv`` and ``track.csv`` as the README's contract has them."""

import csv
import math
from pathlib import Path

import numpy as np

from processing.orientation.quaternions import to_roll_pitch_yaw
from processing.reporting.content import LeakRow, ReportContent
from processing.reporting.files import whole_file

LEAK_COLUMNS = (
    "id,status,class,time_s,chainage_m,chainage_low95_m,chainage_high95_m,east_m,north_m,up_m,latitude,longitude,"
    "score,level_dB,note,verdict,size,size_basis"
)
TRACK_COLUMNS = (
    "time_s,chainage_m,east_m,north_m,up_m,sigma_along_m,sigma_cross_m,sigma_up_m,roll_deg,pitch_deg,yaw_deg"
)
ROWS_AT_ONCE = 20_000


def write_leaks(path: Path, content: ReportContent) -> None:
    """Write one row a candidate, best score first; empty cells where a value is unknown."""
    with whole_file(path) as file:
        table = csv.writer(file, lineterminator="\n")
        file.write(LEAK_COLUMNS + "\n")
        for row in content.rows:
            table.writerow(leak_cells(row, content))


def leak_cells(row: LeakRow, content: ReportContent) -> list[str]:
    """Return the cells of one candidate in the order of ``LEAK_COLUMNS``."""
    c = row.candidate
    east, north, up = content.grid_place(c.position_w_m) if np.all(np.isfinite(c.position_w_m)) else c.position_w_m
    return [
        str(c.label),
        row.status,
        row.leak_class.value,
        cell(c.time_s, 3),
        cell(c.chainage_m, 3),
        cell(c.chainage_low95_m, 3),
        cell(c.chainage_high95_m, 3),
        cell(east, 3),
        cell(north, 3),
        cell(up, 3),
        cell(row.latitude, 8),
        cell(row.longitude, 8),
        cell(c.score, 4),
        cell(c.level_db, 2),
        row.decision.note,
        row.decision.verdict.value,
        row.size.name if row.size is not None else "",
        row.size.basis_text if row.size is not None else "",
    ]


def cell(value: float | None, digits: int) -> str:
    """Return a number with a point, or nothing where it is unknown."""
    return "" if value is None or not math.isfinite(value) else f"{value:.{digits}f}"


def write_track(path: Path, content: ReportContent) -> None:
    """Write the path at its own rate; only the header where there is none."""
    with whole_file(path) as file:
        file.write(TRACK_COLUMNS + "\n")
        track = content.results.track
        if track is None:
            return
        for start in range(0, track.time_s.size, ROWS_AT_ONCE):
            rows = slice(start, start + ROWS_AT_ONCE)
            block = np.column_stack(
                [
                    track.time_s[rows],
                    track.chainage_m[rows],
                    content.frame.to_grid(track.position_w_m[rows], content.frame.grid),
                    track.sigma_along_m[rows],
                    track.sigma_cross_m[rows],
                    track.sigma_up_m[rows],
                    np.degrees(to_roll_pitch_yaw(np.asarray(track.quat_ws[rows]))),
                ]
            )
            file.write("".join(",".join([f"{value:.4f}" for value in row]) + "\n" for row in block.tolist()))
