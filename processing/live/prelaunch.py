"""The guided half-minute before the launch: listen, keep still, knock; what it finds is a sheet of lights.

At the end of a run the knocks alone are asked for again (``kind="end"``): they settle the drift of the clocks.
"""

from dataclasses import dataclass, field, replace
from itertools import zip_longest

import numpy as np

from processing.live import check_items
from processing.live.check_items import CheckSettings
from processing.live.check_knocks import KnockEar, KnockFeel, Knocks, pair_knocks
from processing.live.check_sheet import CheckItem, CheckSheet, CheckView, Phase
from processing.live.stream import DiscStatus, MotionBlock, MotionStatus, SoundBlock, SoundStatus
from processing.survey import FloatArray, Motion

LISTEN_S = 4.0
REST_S = 8.0
_REST_AT_MOST_S = 30.0
_REST_AT_LEAST_S = 2.0  # as the calibration: a shorter one tells too little
_KNOCK_AT_MOST_S = 25.0
_AFTER_KNOCKS_S = 1.0
_PIECE_S = 0.5


_Rows = tuple[FloatArray, FloatArray, FloatArray | None]  # force, rate, field


@dataclass(frozen=True)
class CheckPlan:
    """What the run will be, as far as the operator has told it."""

    kind: str = "launch"  # or end
    motion: Motion = Motion.ROLLING
    radius_m: float | None = None
    speed_mps: float | None = None  # expected
    gyro_range_dps: float = 2000.0
    planned_s: float = 3600.0
    has_sound: bool = True
    has_motion: bool = True


@dataclass(frozen=True)
class Surroundings:
    """What is known besides the blocks, at one moment."""

    sound: SoundStatus = field(default_factory=SoundStatus)
    motion: MotionStatus = field(default_factory=MotionStatus)
    disc: DiscStatus = field(default_factory=DiscStatus)
    battery_pct: float | None = None
    is_plugged: bool = False


class PrelaunchCheck:
    """Takes the blocks as they come and goes through the phases; ``utc`` dates the sheet."""

    def __init__(self, plan: CheckPlan, host_s: float, utc: str, settings: CheckSettings | None = None) -> None:
        self._plan, self._utc = plan, utc
        self._settings = settings or CheckSettings()
        self._phase = Phase.LISTEN if plan.kind == "launch" else Phase.KNOCK
        self._phase_s = host_s
        self._ear: KnockEar | None = None
        self._feel = KnockFeel()
        self._rest = _Stillness(self._settings)
        self._before: Surroundings | None = None
        self._after: Surroundings | None = None
        self._frames = self._lost_frames = 0
        self._listened_s = 0.0
        self._quiet_power, self._quiet_peak, self._quiet_frames = 0.0, 0.0, 0
        self._clipped_quietly = False
        self._live_channels = np.zeros(0, np.bool_)
        self._seen: list[tuple[FloatArray, FloatArray]] = []  # least and greatest of each block's six axes
        self._knocks = pair_knocks(np.zeros(0), np.zeros(0), 0.0)
        self._enough_s: float | None = None
        self._counted_s = host_s
        self._next_frame, self._last_s = 0, -np.inf  # of the streams; a recording that begins counts both anew

    def add(self, block: SoundBlock | MotionBlock, rate_hz: float) -> None:
        """Take a block of sound (of ``rate_hz``) or of motion."""
        if isinstance(block, SoundBlock):
            self._hear(block, rate_hz)
        elif len(block.imu.time_s):
            self._feel_block(block)

    def _hear(self, block: SoundBlock, rate_hz: float) -> None:
        if not len(block.frames):
            return
        if block.first_frame < self._next_frame:  # only knocks that are in the recording are of use
            self._ear, self._enough_s = None, None
        self._next_frame = block.first_frame + len(block.frames)
        if self._phase is Phase.LISTEN:
            self._frames += len(block.frames)
            self._lost_frames += block.lost_before
        if self._phase in (Phase.LISTEN, Phase.REST):
            wave = np.abs(block.frames[:, 0] / 2.0**31)
            self._quiet_power += float(np.sum(wave**2))
            self._quiet_peak = max(self._quiet_peak, float(wave.max()))
            self._quiet_frames += len(wave)
            swing = np.ptp(block.frames, axis=0) > 0
            self._live_channels = swing | self._live_channels if len(swing) == len(self._live_channels) else swing
        if self._phase is Phase.KNOCK:
            if self._ear is None:
                self._ear = KnockEar(rate_hz)
            self._ear.add(block)

    def _feel_block(self, block: MotionBlock) -> None:
        if float(block.imu.time_s[0]) <= self._last_s:
            self._feel, self._enough_s = KnockFeel(), None
            self._rest.interrupt()
        self._last_s = float(block.imu.time_s[-1])
        good = np.asarray(block.imu.valid)
        acc, gyr = block.imu.acc_s_mps2[good], block.imu.gyr_s_radps[good]
        if len(acc) and self._phase is not Phase.DONE:
            both = np.hstack([acc, gyr])
            self._seen.append((both.min(axis=0), both.max(axis=0)))
        if self._phase is Phase.REST and len(acc):
            mag = None if block.imu.mag_s_ut is None else block.imu.mag_s_ut[good]
            self._rest.add(block.imu.time_s[good], acc, gyr, mag)
        if self._phase is Phase.KNOCK:
            self._feel.add(block)

    def tick(self, host_s: float, around: Surroundings) -> CheckView:
        """Go on to the next phase where this one has what it needs, or has waited long enough."""
        before = self._before or around
        if self._after is not None and around.motion.samples < self._after.motion.samples:
            before = replace(before, motion=MotionStatus())  # a recording began, and its counts with it
        self._before, self._after = before, around
        clips_since = any(now and not then for now, then in zip_longest(around.sound.clipped, before.sound.clipped))
        passed = host_s - self._phase_s
        if self._phase is Phase.LISTEN:
            self._listened_s = passed
            if passed >= LISTEN_S:
                self._clipped_quietly = clips_since
                self._go_on(Phase.REST if self._plan.has_motion else Phase.DONE, host_s)
            return CheckView(self._phase, min(passed / LISTEN_S, 1.0))
        if self._phase is Phase.REST:
            self._clipped_quietly |= clips_since
            if self._rest.still_s >= REST_S or passed >= _REST_AT_MOST_S:
                both = self._plan.has_sound and self._plan.has_motion
                self._go_on(Phase.KNOCK if both else Phase.DONE, host_s)
            return CheckView(self._phase, min(self._rest.still_s / REST_S, 1.0), moved=self._rest.moved)
        if self._phase is Phase.KNOCK:
            return self._await_knocks(host_s, passed)
        return CheckView(Phase.DONE, 1.0, *self._counts())

    def _await_knocks(self, host_s: float, passed: float) -> CheckView:
        if host_s - self._counted_s >= _PIECE_S:
            self._counted_s = host_s
            heard = self._ear.knocks_s() if self._ear is not None else np.zeros(0)
            self._knocks = pair_knocks(heard, self._feel.knocks_s(), 1e-3 * self._settings.knock_jitter_ms)
            if len(self._knocks.paired_s) >= self._settings.knocks and self._enough_s is None:
                self._enough_s = host_s
        enough = self._enough_s is not None and host_s - self._enough_s >= _AFTER_KNOCKS_S
        if enough or passed >= _KNOCK_AT_MOST_S:
            self._go_on(Phase.DONE, host_s)
        heard_count, felt, both = self._counts()
        return CheckView(self._phase, min(both / self._settings.knocks, 1.0), heard_count, felt, both)

    def _counts(self) -> tuple[int, int, int]:
        return len(self._knocks.heard_s), len(self._knocks.felt_s), len(self._knocks.paired_s)

    def _go_on(self, phase: Phase, host_s: float) -> None:
        self._phase, self._phase_s = phase, host_s

    @property
    def knocks(self) -> Knocks:
        """What was heard and felt in the last phase."""
        return self._knocks

    def skip(self, host_s: float) -> None:
        """Leave the present phase: what it would have told stays open."""
        order = (Phase.LISTEN, Phase.REST, Phase.KNOCK, Phase.DONE)
        self._go_on(order[min(order.index(self._phase) + 1, 3)], host_s)

    def sheet(self) -> CheckSheet:
        """Return the lights of what was found so far."""
        items = self._launch_items() if self._plan.kind == "launch" else []
        items.append(
            check_items.knocks_item(
                self._knocks, self._settings, has_sound=self._plan.has_sound, has_motion=self._plan.has_motion
            )
        )
        return CheckSheet(self._plan.kind, self._utc, tuple(items))

    def _launch_items(self) -> list[CheckItem]:
        plan, settings, after = self._plan, self._settings, self._after or Surroundings()
        before = self._before or after
        items: list[CheckItem] = []
        if plan.has_sound:
            items += self._sound_items(after)
        if plan.has_motion:
            motion = after.motion
            lost = motion.lost - before.motion.lost
            rate_hz = motion.rate_hz or 0.0
            items.append(check_items.motion_item(rate_hz, motion.samples - before.motion.samples, lost, settings))
            extremes = np.array([row for pair in self._seen for row in pair]).reshape(-1, 6)
            items.append(check_items.axes_item(extremes[:, :3], extremes[:, 3:]))
            acc, gyr, mag = self._rest.rows()
            items += check_items.rest_items(acc, gyr, settings)
            items.append(
                check_items.range_item(plan.motion, plan.radius_m, plan.speed_mps, plan.gyro_range_dps, settings)
            )
            if rate_hz:
                items.append(check_items.rate_item(plan.motion, plan.radius_m, plan.speed_mps, rate_hz, settings))
            items.append(check_items.field_item(mag, settings))
        items.append(check_items.space_item(after.disc, plan.planned_s, settings))
        items.append(check_items.battery_item(after.battery_pct, plugged=after.is_plugged, settings=settings))
        return items

    def _sound_items(self, after: Surroundings) -> list[CheckItem]:
        here = replace(after.sound, frames=self._frames, lost_frames=self._lost_frames)
        items = [check_items.sound_item(here, self._listened_s, self._live_channels, self._settings)]
        if self._quiet_frames and not after.sound.is_digital_silence:
            rms_db = 10 * np.log10(max(self._quiet_power / self._quiet_frames, 1e-15))
            peak_db = 20 * np.log10(max(self._quiet_peak, 1e-8))
            clipped = self._clipped_quietly or self._quiet_peak >= 1.0 - 2.0**-15
            items.append(
                check_items.level_item(float(rms_db), float(peak_db), clipped=clipped, settings=self._settings)
            )
        return items


class _Stillness:
    """Keeps the rows since it last moved."""

    def __init__(self, settings: CheckSettings) -> None:
        self._settings = settings
        self._moving: list[_Rows] = []
        self.moved = False
        self._forget()

    def _forget(self) -> None:
        self._rows: list[_Rows] = []
        self._waiting: list[tuple[FloatArray, FloatArray, FloatArray, FloatArray | None]] = []
        self.still_s = 0.0

    def interrupt(self) -> None:
        """Let the next rows have times that do not continue those before."""
        self._waiting = []

    def add(self, time_s: FloatArray, acc: FloatArray, gyr: FloatArray, mag: FloatArray | None) -> None:
        """Take rows (n, 3); each half second is still, or the rest begins anew."""
        self._waiting.append((time_s, acc, gyr, mag))
        span_s = float(time_s[-1] - self._waiting[0][0][0])
        if span_s < _PIECE_S:
            return
        pieces, self._waiting = self._waiting, []
        gyr_sway = np.degrees(np.concatenate([piece[2] for piece in pieces]).std(axis=0).max())
        acc_sway = np.concatenate([piece[1] for piece in pieces]).std(axis=0).max()
        if gyr_sway > self._settings.quiet_gyr_dps or acc_sway > self._settings.quiet_acc_mps2:
            self._moving = [(piece[1], piece[2], piece[3]) for piece in pieces]
            self._forget()
            self.moved = True
            return
        self.moved = False
        self.still_s += span_s
        self._rows += [(piece[1], piece[2], piece[3]) for piece in pieces]

    def rows(self) -> tuple[FloatArray, FloatArray, FloatArray | None]:
        """Return the still rows (n, 3) of force, rate and field; of too short a rest, the last that moved."""
        rows = self._rows if self.still_s >= _REST_AT_LEAST_S else self._moving
        if not rows:
            return np.zeros((0, 3)), np.zeros((0, 3)), None
        mags = [row[2] for row in rows if row[2] is not None]
        return (
            np.concatenate([row[0] for row in rows]),
            np.concatenate([row[1] for row in rows]),
            np.concatenate(mags) if len(mags) == len(rows) else None,
        )
