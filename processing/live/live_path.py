"""Where the device is while it is recorded: the offline fit, made again every two seconds over the way so far.

Attitude and reckoning are causal recursions; what comes out is an odometry like the one after the run, only thinned,
and the same fit lays it onto launch, route and tie points, with the same interval. Between two fits the last one's
scale and turn carry the path on.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from processing.errors import LeaklineError
from processing.live.attitude_stream import AttitudeStream
from processing.live.path_history import PathHistory
from processing.live.picture import LivePolyline, LivePose
from processing.live.setting_out import setting_out_direction
from processing.live.trails import LONG_GAP_S, trail_of
from processing.orientation import quaternions as qt
from processing.orientation.calibration import Calibration
from processing.orientation.start import yaw_towards
from processing.position.evidence import Evidence
from processing.position.fitting import fit, prepare
from processing.position.odometry import GAP_S, Odometry
from processing.progress import silent
from processing.settings import Settings
from processing.survey import Channel, FloatArray, ImuSamples, Launch, Stretch, Survey, TiePoint, Track

_CHUNK_S = 0.045  # rows are worked on in pieces so long at least
_FIT_S = 2.0
_KEYFRAMES = 80.0
_LEAST_WAY_M = 0.05
_DRAWN = 2000
_GUESS_SHARE = 0.5  # 1 sigma of what is guessed of the last moment


@dataclass(frozen=True)
class _Laid:
    """The last fit: its track, and how the free path goes on from its last row."""

    track: Track
    odometry: Odometry
    gain: float
    turn_rad: float
    basis: str


@dataclass(frozen=True)
class _Placed:
    position_w_m: FloatArray  # (3,)
    chainage_m: float
    along_m: float
    cross_m: float
    speed_mps: float


class LivePath:
    """Samples and tie points go in, the present pose and the way so far come out."""

    def __init__(self, survey: Survey, settings: Settings | None = None, known: Calibration | None = None) -> None:
        """Begin; of the survey counts what is known before the run: device, launch, route, tie points.

        The length of the pipe does not: it was not travelled yet. ``known`` is what a path before has found out of the
        same device.
        """
        settings = settings or Settings()
        self._settings = settings
        self._survey = replace(survey, pipe=replace(survey.pipe, length_m=None))
        self._fitting = replace(settings.position, keyframes=_KEYFRAMES)
        self._stream = AttitudeStream(settings.orientation, _first_yaw(survey), known)
        self._history = PathHistory()
        self._trail = trail_of(survey, settings, self._stream, self._history)
        self._pending: list[ImuSamples] = []
        self._pending_s = 0.0
        self._fit_s = -np.inf
        self._laid: _Laid | None = None
        self._version = 0
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

    def calibration(self) -> Calibration | None:
        """Return what rests and the way have told of the device; None where no rest has."""
        return self._stream.calibration() if self._stream.is_calibrated else None

    def pose(self) -> LivePose | None:
        """Return where the device is; None until its attitude is known."""
        if self._quat is None or not len(self._history):
            return None
        row, laid = self._history.last, self._laid
        turn = laid.turn_rad if laid is not None else 0.0
        quat = qt.multiply(qt.turn_about_up(turn), self._quat)
        placed = self._placed(row)
        east, north, up = placed.position_w_m.tolist()
        return LivePose(
            survey_s=self._now_s,
            q_ws=(float(quat[0]), float(quat[1]), float(quat[2]), float(quat[3])),
            heading_deg=self._heading_deg,
            position_w_m=(east, north, up),
            chainage_m=placed.chainage_m,
            sigma_along_m=placed.along_m,
            sigma_cross_m=placed.cross_m,
            speed_mps=placed.speed_mps,
            is_still=self._trail.is_still,
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
        time_s = rows.time_s if np.isnan(self._now_s) else np.concatenate([[self._now_s], rows.time_s])
        step = np.diff(time_s, prepend=time_s[:1])[len(time_s) - len(rows.time_s) :]
        for k in np.flatnonzero(step > GAP_S):
            self._gap_end_s = float(rows.time_s[k])
            self._history.stretches.append(
                Stretch(self._gap_end_s - float(step[k]), self._gap_end_s, Channel.PATH, "imu_gap")
            )
        cuts = [0, *np.flatnonzero(step[1:] > LONG_GAP_S) + 1, len(step)]
        for first, last in pairwise(cuts):
            if self._trail.add(rows.part(slice(first, last)), float(step[first])):
                self._fit_s = -np.inf
        self._quat, self._now_s = rows.quat_ws[-1], float(rows.time_s[-1])

    def _placed(self, row: FloatArray) -> _Placed:
        """Return where a row (16,) of the free path lies, carried on from the last fit, and from the row until now."""
        laid, base = self._laid, self._trail.base
        if laid is None:
            start = 0.02 if base is None else base.start_sigma_m
            return _Placed(row[1:4], float(row[4]), start, start, float(row[5]))
        track, odometry = laid.track, laid.odometry
        late_s = max(self._now_s - float(row[0]), 0.0)  # a window is reckoned only every second or two
        onward = late_s * self._trail.pace_w_mps
        step = row[1:4] - odometry.position_w_m[-1] + onward
        c, s = np.cos(laid.turn_rad), np.sin(laid.turn_rad)
        moved = laid.gain * np.array([c * step[0] - s * step[1], s * step[0] + c * step[1], step[2]])
        guessed = laid.gain * float(np.hypot(onward[0], onward[1]))
        way = float(row[4] - odometry.chainage_m[-1])
        since = row[[10, 11, 14]] - [odometry.along_var_m2[-1], odometry.cross_var_m2[-1], _last(odometry.lost_var_m2)]
        unsure = (_GUESS_SHARE * guessed) ** 2 + self._trail.open_sigma_m**2
        along, cross, lost = np.maximum(since, 0.0)  # a window reckoned anew may have become surer
        speed = laid.gain * float(row[5])
        if speed > 0.05 and float(np.hypot(moved[0], moved[1])) > 0.02:
            self._heading_deg = float(np.degrees(np.arctan2(moved[0], moved[1])) % 360.0)
        return _Placed(
            track.position_w_m[-1] + moved,
            float(track.chainage_m[-1]) + laid.gain * way + guessed,
            float(np.sqrt(track.sigma_along_m[-1] ** 2 + along + lost + unsure)),
            float(np.sqrt(track.sigma_cross_m[-1] ** 2 + cross + unsure)),
            speed,
        )

    def _fit(self) -> None:
        """Lay the way so far onto all that is known."""
        self._fit_s = float(self._history.last[0])
        if self._trail.base is None or len(self._history) < 3 or self._history.last[4] < _LEAST_WAY_M:
            return
        odometry = self._history.odometry(self._trail.base)
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
        problem = replace(problem, first_rad=setting_out_direction(odometry))
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
