"""The way so far as an odometry of bounded size: what the offline fit reads, kept for a run of any length."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from processing.position.keyframes import even_rows
from processing.position.odometry import Odometry
from processing.survey import FloatArray, Stretch

_MOST_ROWS = 3000
_THINNED_ROWS = 1200
_RECENT_ROWS = 200
_SETTING_OUT_M = 30.0  # the first metres tell the direction, so they keep their detail
_SETTING_OUT_ROWS = 400
_COLUMNS = {
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
_WIDTH = 16


@dataclass(frozen=True)
class PathRow:
    """One moment of the free path, fields as in :class:`processing.position.odometry.Odometry`; variances cumulated."""

    time_s: float
    position_w_m: tuple[float, float, float]
    chainage_m: float
    speed_mps: float
    quat_ws: FloatArray  # (4,)
    along_var_m2: float
    cross_var_m2: float
    up_var_m2: float
    heading_var_rad2: float
    lost_var_m2: float
    lost_heading_rad2: float

    def as_array(self) -> FloatArray:
        """The same numbers in the order of the history's columns (16,)."""
        return np.array(
            [self.time_s, *self.position_w_m, self.chainage_m, self.speed_mps, *self.quat_ws, self.along_var_m2,
             self.cross_var_m2, self.up_var_m2, self.heading_var_rad2, self.lost_var_m2, self.lost_heading_rad2]
        )  # fmt: skip


class PathHistory:
    """Rows go in at track rate; what is kept thins out evenly by way and time as the run grows."""

    def __init__(self) -> None:
        """Begin without rows."""
        self._rows = np.zeros((_MOST_ROWS, _WIDTH))
        self._count = 0
        self.stretches: list[Stretch] = []  # gaps

    @property
    def last(self) -> FloatArray:
        """The latest row (16,); see :meth:`PathRow.as_array`."""
        return np.asarray(self._rows[self._count - 1])

    def __len__(self) -> int:
        return self._count

    def append(self, row: PathRow) -> None:
        """Add a row, later than all before; during a rest it takes the place of the last one."""
        values = row.as_array()
        if self._count > 1 and _rests(values, self._rows[self._count - 2 : self._count]):
            self._rows[self._count - 1] = values  # a rest is its beginning and its end
            return
        if self._count == _MOST_ROWS:
            self._thin()
        self._rows[self._count] = values
        self._count += 1

    def odometry(self, base: Odometry) -> Odometry:
        """Return all rows as an odometry with the sigmas of ``base``; at least two rows are needed."""

        def of(name: str) -> FloatArray:
            values = self._rows[: self._count, _COLUMNS[name]].copy()
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

    def _thin(self) -> None:
        table = self._rows[: self._count]
        way, time_s = table[:, 4], table[:, 0]
        recent = np.arange(self._count - _RECENT_ROWS, self._count)
        whole = _even(way, time_s, _THINNED_ROWS)
        early = np.searchsorted(way, way[0] + _SETTING_OUT_M)
        early_rows = _even(way[:early], time_s[:early], _SETTING_OUT_ROWS) if early > 2 else np.arange(early)
        keep = np.unique(np.concatenate([early_rows, whole, recent]))
        self._rows[: len(keep)] = table[keep]
        self._count = len(keep)


def _rests(row: FloatArray, before: FloatArray) -> bool:
    """Whether ``row`` (16,) and the two ``before`` (2, 16) are one place, without a gap among them."""
    return bool(np.all(before[:, 1:5] == row[1:5]) and np.all(before[:, 14:] == row[14:]))


def _even(way: FloatArray, time_s: FloatArray, count: int) -> npt.NDArray[np.intp]:
    zero = np.zeros(len(way))
    plain = Odometry(
        time_s, np.zeros((len(way), 3)), way - way[0], zero, np.zeros((len(way), 4)), zero, zero, zero, zero, 0.0, 0.0
    )
    return even_rows(plain, count)
