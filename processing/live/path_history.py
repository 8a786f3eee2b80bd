"""The way so far as an odometry of bounded size: what the offline fit reads, kept for a run of any length."""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from processing.orientation import quaternions as qt
from processing.orientation.start import yaw_towards
from processing.position.keyframes import even_rows
from processing.position.odometry import Odometry
from processing.survey import FloatArray, Stretch

_MOST_ROWS = 3000
_THINNED_ROWS = 1200
_RECENT_ROWS = 200
_SETTING_OUT_M = 30.0  # the first metres tell the direction, so they keep their detail
_SETTING_OUT_ROWS = 400
COLUMNS = {
    "time_s": slice(0, 1),
    "position_w_m": slice(1, 4),
    "chainage_m": slice(4, 5),
    "speed_mps": slice(5, 6),
    "quat_ws": slice(6, 10),
    "along_var_m2": slice(10, 11),
    "cross_var_m2": slice(11, 12),
    "up_var_m2": slice(12, 13),
    "heading_var_rad2": slice(13, 14),
    "lost_var_m2": slice(14, 15),
    "lost_heading_rad2": slice(15, 16),
}
WIDTH = 16
QUAT = COLUMNS["quat_ws"]
SUMMED = np.r_[1:5, 10:WIDTH]  # columns that count on from row to row


class RowStore:
    """Rows (16,) go in at track rate; what is kept thins out evenly by way and time as they grow many."""

    def __init__(self) -> None:
        """Begin without rows."""
        self._rows = np.zeros((_MOST_ROWS, WIDTH))
        self._count = 0

    @property
    def rows(self) -> FloatArray:
        """The rows (k, 16) that are kept: no copy, so not beyond the next one that is added."""
        return np.asarray(self._rows[: self._count])

    def append(self, rows: FloatArray) -> None:
        """Add rows (k, 16), later than all before; during a rest a row takes the place of the last one."""
        for row in rows:
            if self._count > 1 and _rests(row, self._rows[self._count - 2 : self._count]):
                self._rows[self._count - 1] = row  # a rest is its beginning and its end
                continue
            if self._count == _MOST_ROWS:
                self._thin()
            self._rows[self._count] = row
            self._count += 1

    def clear(self) -> None:
        """Forget all rows."""
        self._count = 0

    def _thin(self) -> None:
        kept = thinned(self.rows)
        self._rows[: len(kept)] = kept
        self._count = len(kept)


class PathHistory:
    """The settled way, and its tail that may still be replaced. The columns are those of :data:`COLUMNS`, as in
    :class:`processing.position.odometry.Odometry`: variances cumulated.
    """

    def __init__(self) -> None:
        """Begin without rows."""
        self._settled, self._tail = RowStore(), RowStore()
        self.stretches: list[Stretch] = []  # gaps

    @property
    def last(self) -> FloatArray:
        """The latest row (16,)."""
        return np.array((self._tail.rows if len(self._tail.rows) else self._settled.rows)[-1])

    def __len__(self) -> int:
        return len(self._settled.rows) + len(self._tail.rows)

    def settle(self, rows: FloatArray) -> None:
        """Add rows (k, 16) that will not change, later than all before; the tail is to be set anew."""
        self._settled.append(rows)

    def settle_tail(self) -> None:
        """Let the tail as it is now not change any more."""
        self._settled.append(self._tail.rows)
        self._tail.clear()

    def extend_tail(self, rows: FloatArray) -> None:
        """Let rows (k, 16), later than all before, follow."""
        self._tail.append(rows)

    def set_tail(self, rows: FloatArray) -> None:
        """Let rows (k, 16), later than those settled, be the end of the way."""
        self._tail.clear()
        self._tail.append(rows)

    def odometry(self, base: Odometry) -> Odometry:
        """Return all rows as an odometry with the sigmas of ``base``; at least two rows are needed."""

        table = np.vstack([self._settled.rows, self._tail.rows])

        def of(name: str) -> FloatArray:
            values = table[:, COLUMNS[name]]
            return values[:, 0] if values.shape[1] == 1 else values

        return replace(
            base,
            time_s=of("time_s"),
            position_w_m=of("position_w_m"),
            chainage_m=of("chainage_m"),
            speed_mps=of("speed_mps"),
            quat_ws=of("quat_ws"),
            along_var_m2=of("along_var_m2"),
            cross_var_m2=of("cross_var_m2"),
            up_var_m2=of("up_var_m2"),
            heading_var_rad2=of("heading_var_rad2"),
            lost_var_m2=of("lost_var_m2"),
            lost_heading_rad2=of("lost_heading_rad2"),
            not_assessed=tuple(self.stretches),
        )


def laid(odometry: Odometry, joint: FloatArray | None) -> FloatArray:
    """Return a window's rows (m, 16), turned and shifted to pass through ``joint`` (16,), the settled path's end."""
    table = np.zeros((len(odometry.time_s), WIDTH))
    for name, columns in COLUMNS.items():
        values = getattr(odometry, name)
        if values is not None:
            table[:, columns] = values.reshape(len(table), -1)
    if joint is None:
        return table
    here = row_at(table, float(joint[0]))
    turn = float(yaw_towards(here[QUAT], joint[QUAT]))
    c, s = np.cos(turn), np.sin(turn)
    east, north = table[:, 1].copy(), table[:, 2].copy()
    table[:, 1], table[:, 2] = c * east - s * north, s * east + c * north
    table[:, QUAT] = qt.multiply(qt.turn_about_up(turn), table[:, QUAT])
    here = row_at(table, float(joint[0]))
    table[:, SUMMED] += joint[SUMMED] - here[SUMMED]
    return table


def shifted(rows: FloatArray, by: FloatArray) -> FloatArray:
    """Return rows (k, 16) whose columns that count on are moved by those of ``by`` (16,)."""
    out = rows.copy()
    out[:, SUMMED] += by[SUMMED]
    return out


def row_at(table: FloatArray, time_s: float) -> FloatArray:
    """Return the row (16,) at a moment between two."""
    row = np.array([np.interp(time_s, table[:, 0], column) for column in table.T])
    row[0] = time_s
    row[QUAT] = table[int(np.argmin(np.abs(table[:, 0] - time_s))), QUAT]
    return row


def thinned(table: FloatArray) -> FloatArray:
    """Return some 1800 of many rows (k, 16): spread over way and time, closer in the first metres and at the end."""
    if len(table) <= _THINNED_ROWS:
        return table
    way, time_s = table[:, 4], table[:, 0]
    recent = np.arange(len(table) - _RECENT_ROWS, len(table))
    whole = _even(way, time_s, _THINNED_ROWS)
    early = int(np.searchsorted(way, way[0] + _SETTING_OUT_M))
    early_rows = _even(way[:early], time_s[:early], _SETTING_OUT_ROWS) if early > 2 else np.arange(early)
    return np.asarray(table[np.unique(np.concatenate([early_rows, whole, recent]))])


def _rests(row: FloatArray, before: FloatArray) -> bool:
    """Whether ``row`` (16,) and the two ``before`` (2, 16) are one place, without a gap among them."""
    return bool(np.all(before[:, 1:5] == row[1:5]) and np.all(before[:, 14:] == row[14:]))


def _even(way: FloatArray, time_s: FloatArray, count: int) -> npt.NDArray[np.intp]:
    zero = np.zeros(len(way))
    plain = Odometry(
        time_s, np.zeros((len(way), 3)), way - way[0], zero, np.zeros((len(way), 4)), zero, zero, zero, zero, 0.0, 0.0
    )
    return even_rows(plain, count)
