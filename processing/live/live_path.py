"""Where the device is while it is recorded: the offline fit, made again every two seconds over the way so far.

Attitude and reckoning are causal recursions; what comes out is an odometry like the one after the run, only thinned,
and the same fit lays it onto launch, route and tie points, with the same interval. Between two fits the last one's
scale and turn carry the path on.
"""

from dataclasses import dataclass, replace

import numpy as np

from processing.errors import LeaklineError
from processing.live.attitude_stream import AttitudeStream, OrientedRows
from processing.live.look_back import LookBack
from processing.live.path_history import PathHistory, shifted
from processing.live.picture import LivePolyline, LivePose
from processing.live.rolling_steps import RollingSteps
from processing.live.windowed_steps import WindowedSteps
from processing.orientation import quaternions as qt
from processing.orientation.start import yaw_towards
from processing.position.evidence import Evidence
from processing.position.fitting import fit, prepare
from processing.position.odometry import GAP_S, Odometry
from processing.progress import silent
from processing.settings import Settings
from processing.survey import Channel, FloatArray, ImuSamples, Launch, Motion, Stretch, Survey, TiePoint, Track

_CHUNK_S = 0.045  # rows are worked on in pieces so long at least
_FIT_S = 2.0
_KEYFRAMES = 80.0
_LEAST_WAY_M = 0.05
_DRAWN = 2000


@dataclass(frozen=True)
class _Laid:
    """The last fit: its track, and how the free path goes on from its last row."""

    track: Track
    odometry: Odometry
    gain: float
    turn_rad: float
    basis: str


class LivePath:
    """Samples and tie points go in, the present pose and the way so far come out."""

    def __init__(self, survey: Survey, settings: Settings | None = None) -> None:
        """Begin; of the survey counts what is known before the run: device, launch, route, tie points.

        The length of the pipe does not: it was not travelled yet.
        """
        settings = settings or Settings()
        self._settings = settings
        self._survey = replace(survey, pipe=replace(survey.pipe, length_m=None))
        self._fitting = replace(settings.position, keyframes=_KEYFRAMES)
        self._stream = AttitudeStream(settings.orientation, _first_yaw(survey))
        rolling = survey.device.motion is Motion.ROLLING and survey.processing.position in ("auto", "rolling")
        self._rolling = RollingSteps(survey.device, settings.position) if rolling else None
        self._back = LookBack(survey, settings)
        self._shift: FloatArray | None = None  # (16,) from the rolling rows to those of the last look back
        self._windowed = None if rolling else WindowedSteps(survey, settings.position)
        self._history = PathHistory()
        self._pending: list[ImuSamples] = []
        self._pending_s = 0.0
        self._fit_s = -np.inf
        self._laid: _Laid | None = None
        self._version = 0
        self._base: Odometry | None = None
        self._is_still = True
        self._quat: FloatArray | None = None
        self._now_s = np.nan
        self._gap_end_s = -np.inf
        self._heading_deg: float | None = None
        self.problem: LeaklineError | None = None  # why launch or route of the survey are not used

    def add(self, imu: ImuSamples) -> None:
        """Take rows (m,), later than all before."""
        if not len(imu.time_s):
            return
        self._pending.append(imu)
        span = float(imu.time_s[-1] - self._pending[0].time_s[0])
        if span < _CHUNK_S:
            return
        self._take(_trusted(self._pending))  # numpy's calls cost the same for one row and for fifty
        self._pending = []
        if len(self._history) and self._history.last[0] - self._fit_s >= _FIT_S:
            self._fit()

    def set_tie_points(self, ties: tuple[TiePoint, ...]) -> None:
        """Lay the path through all these from now on; those said before are forgotten."""
        self._survey = replace(self._survey, tie_points=ties)
        self._fit_s = -np.inf

    def mark(self, tie: TiePoint) -> None:
        """Add one tie point."""
        self.set_tie_points((*self._survey.tie_points, tie))

    def pose(self) -> LivePose | None:
        """Return where the device is; None until its attitude is known."""
        if self._quat is None or not len(self._history):
            return None
        row, laid = self._history.last, self._laid
        turn = laid.turn_rad if laid is not None else 0.0
        quat = qt.multiply(qt.turn_about_up(turn), self._quat)
        place, chainage, along, cross, speed = self._placed(row)
        return LivePose(
            survey_s=self._now_s,
            q_ws=(float(quat[0]), float(quat[1]), float(quat[2]), float(quat[3])),
            heading_deg=self._heading_deg,
            position_w_m=(float(place[0]), float(place[1]), float(place[2])),
            chainage_m=chainage,
            sigma_along_m=along,
            sigma_cross_m=cross,
            speed_mps=speed,
            is_still=self._is_still,
            is_calibrated=self._stream.is_calibrated,
            heading_basis=laid.basis if laid is not None else "unknown",
            in_gap=self._now_s - self._gap_end_s < 0.5,
        )

    def polyline(self) -> LivePolyline:
        """Return the way up to the last fit; the pose is where it leads."""
        gaps = tuple((s.start_s, s.end_s) for s in self._history.stretches)
        if self._laid is None:
            none = np.zeros(0)
            return LivePolyline(0, none, np.zeros((0, 3)), none, none, gaps)
        track = self._laid.track
        every = slice(None, None, -(-len(track.time_s) // _DRAWN))
        return LivePolyline(
            self._version,
            track.time_s[every],
            track.position_w_m[every],
            track.chainage_m[every],
            track.sigma_along_m[every],
            gaps,
        )

    def _take(self, imu: ImuSamples) -> None:
        rows = self._stream.add(imu)
        if not len(rows.time_s):
            return
        if self._rolling is not None:
            found, gaps = self._rolling.add(rows)
            self._history.extend_tail(found if self._shift is None else shifted(found, self._shift))
            self._base, self._is_still = self._rolling.base, self._rolling.is_still
            self._look_back(imu, rows)
        elif self._windowed is not None:
            gaps = self._gaps_in(rows.time_s)
            self._is_still = self._stream.rest.is_resting
            settled = self._windowed.add(rows, is_resting=self._is_still)
            if settled is not None:
                self._history.settle(settled.rows)
                self._history.set_tail(settled.tail)
                self._base = self._windowed.base
        for start, end in gaps:
            self._history.stretches.append(Stretch(start, end, Channel.PATH, "imu_gap"))
            self._gap_end_s = end
        self._quat, self._now_s = rows.quat_ws[-1], float(rows.time_s[-1])

    def _look_back(self, imu: ImuSamples, rows: OrientedRows) -> None:
        """Take rows for the next look back over the last minutes; where it is due, go on from what it tells."""
        self._back.add(imu, is_still=self._is_still)
        if self._rolling is None or not self._back.is_due or self._stream.is_waiting:
            return
        seen = self._back.look()
        self._history.settle(seen.settled)
        self._history.set_tail(seen.tail)
        self._shift = seen.tail[-1] - self._rolling.row()
        turn = float(yaw_towards(rows.quat_ws[-1], seen.quat_ws))
        self._stream.learn(seen.calibration, turn)
        self._rolling.turn(turn)
        self._fit_s = -np.inf  # the path goes on in another frame

    def _gaps_in(self, time_s: FloatArray) -> list[tuple[float, float]]:
        whole = time_s if np.isnan(self._now_s) else np.concatenate([[self._now_s], time_s])
        return [(float(whole[k]), float(whole[k + 1])) for k in np.flatnonzero(np.diff(whole) > GAP_S)]

    def _placed(self, row: FloatArray) -> tuple[FloatArray, float, float, float, float]:
        """Return place, chainage, both sigmas and speed at a row of the free path, carried on from the last fit."""
        laid = self._laid
        if laid is None:
            start = 0.02 if self._base is None else self._base.start_sigma_m
            return row[1:4], float(row[4]), start, start, float(row[5])
        track, odometry = laid.track, laid.odometry
        step = row[1:4] - odometry.position_w_m[-1]
        c, s = np.cos(laid.turn_rad), np.sin(laid.turn_rad)
        moved = laid.gain * np.array([c * step[0] - s * step[1], s * step[0] + c * step[1], step[2]])
        way = float(row[4] - odometry.chainage_m[-1])
        since = row[[10, 11, 14]] - [odometry.along_var_m2[-1], odometry.cross_var_m2[-1], _last(odometry.lost_var_m2)]
        along = float(np.sqrt(track.sigma_along_m[-1] ** 2 + since[0] + since[2]))
        cross = float(np.sqrt(track.sigma_cross_m[-1] ** 2 + since[1]))
        speed = laid.gain * float(row[5])
        if speed > 0.05 and float(np.hypot(moved[0], moved[1])) > 0.02:
            self._heading_deg = float(np.degrees(np.arctan2(moved[0], moved[1])) % 360.0)
        return track.position_w_m[-1] + moved, float(track.chainage_m[-1]) + laid.gain * way, along, cross, speed

    def _fit(self) -> None:
        """Lay the way so far onto all that is known."""
        self._fit_s = float(self._history.last[0])
        if self._base is None or len(self._history) < 3 or self._history.last[4] < _LEAST_WAY_M:
            return
        odometry = self._history.odometry(self._base)
        try:
            laid = self._fitted(odometry)
        except LeaklineError as error:
            if self.problem is not None:
                raise
            self.problem = error  # the path itself does not need what is wrong there
            self._survey = replace(self._survey, launch=Launch(heading_deg=self._survey.launch.heading_deg), route=None)
            laid = self._fitted(odometry)
        self._laid = laid
        self._version += 1

    def _fitted(self, odometry: Odometry) -> _Laid:
        problem = prepare(odometry, self._survey, Evidence(), self._fitting)
        fitted = fit(problem, self._survey, self._fitting, silent())
        track = fitted.track
        gain = fitted.series.scale * (1.0 + float(fitted.series.slip_share[-1]))
        turn = float(yaw_towards(odometry.quat_ws[-1], track.quat_ws[-1]))
        return _Laid(track, odometry, gain, turn, str(track.quality.get("heading_basis", "unknown")))


def _first_yaw(survey: Survey) -> float:
    """Return the same arbitrary first yaw as after the run."""
    heading = survey.launch.heading_deg
    return float(qt.yaw_from_heading(np.radians(90.0 if heading is None else heading)))


def _trusted(parts: list[ImuSamples]) -> ImuSamples:
    """Return the rows that can be trusted, with what a path is made of."""
    keep = np.concatenate([p.valid for p in parts])
    time_s, acc, gyr = (
        np.ascontiguousarray(np.concatenate([getattr(p, name) for p in parts])[keep], dtype=np.float64)
        for name in ("time_s", "acc_s_mps2", "gyr_s_radps")
    )
    return ImuSamples(time_s, acc, gyr, np.ones(len(time_s), dtype=np.bool_))


def _last(values: FloatArray | None) -> float:
    return float(values[-1]) if values is not None and len(values) else 0.0
