"""All that the window draws of a running recording, in one place: fed by one thread, looked at as a picture.

A picture holds only what is newer than the one that was drawn before it; every part of it is a copy of its own, so it
may go to another thread.
"""

from processing.live.live_path import LivePath
from processing.live.picture import LivePicture, SpectrumColumns
from processing.live.spectrum_stream import SpectrumStream
from processing.live.stream import MotionBlock, SoundBlock
from processing.live.strips import Strips
from processing.settings import Settings
from processing.survey import Survey, TiePoint


class LiveView:
    """Blocks go in as they come, pictures come out; all from one thread."""

    def __init__(
        self,
        survey: Survey,
        settings: Settings | None = None,
        *,
        sample_rate_hz: float | None = None,
        channel: int = 0,
        sound_span_s: float = 90.0,
        strip_span_s: float = 60.0,
    ) -> None:
        """Begin with what is known of the run; without ``sample_rate_hz`` sound is not drawn until it is told."""
        self._settings = settings or Settings()
        self._survey, self._channel = survey, channel
        self._sound_span_s, self._strip_span_s = sound_span_s, strip_span_s
        self._sound: SpectrumStream | None = None
        self._strips = Strips(span_s=strip_span_s)
        self._path = LivePath(survey, self._settings)
        self._epoch = 0
        self._motion_host_s: float | None = None
        self._motion_survey_s: float | None = None
        if sample_rate_hz:
            self.set_sample_rate(sample_rate_hz)

    def set_sample_rate(self, sample_rate_hz: float) -> None:
        """Begin the spectrogram anew where the rate is another; it is known once the device is open."""
        if self._sound is None or self._sound.sample_rate_hz != sample_rate_hz:
            self._epoch += 1
            self._sound = SpectrumStream(
                sample_rate_hz, self._settings.sound, channel=self._channel, span_s=self._sound_span_s
            )

    def set_tie_points(self, ties: tuple[TiePoint, ...]) -> None:
        """Lay the path through these from now on."""
        self._path.set_tie_points(ties)

    def restart_path(self) -> None:
        """Forget path and strips, not the gyro's offset: the recording begins here, and its survey time with it."""
        self._path = LivePath(self._survey, self._settings, self._path.calibration())
        self._strips = Strips(span_s=self._strip_span_s)
        self._epoch += 1

    def add(self, block: SoundBlock | MotionBlock) -> None:
        """Take a block of either stream, in the order of its stream."""
        if isinstance(block, SoundBlock):
            if self._sound is not None:
                self._sound.add(block)
            return
        if len(block.imu.time_s):
            self._strips.add(block.imu)
            self._path.add(block.imu)
            self._motion_host_s = block.arrived_host_s
            self._motion_survey_s = float(block.imu.time_s[-1])

    def picture(self, after: LivePicture | None = None) -> LivePicture:
        """Return all that is newer than ``after``, the last picture that was drawn; everything without one."""
        if after is not None and after.epoch != self._epoch:
            after = None
        sound = self._columns(after)
        path = self._path.polyline()
        is_new = after is None or path.version != after.path_version
        return LivePicture(
            sound=sound,
            strips=self._strips.bins(_next_bin(after)),
            pose=self._path.pose(),
            path=path if is_new else None,
            sound_host_s=_newest(sound, after),
            motion_host_s=self._motion_host_s,
            motion_survey_s=self._motion_survey_s,
            path_version=path.version,
            epoch=self._epoch,
        )

    def _columns(self, after: LivePicture | None) -> SpectrumColumns | None:
        if self._sound is None:
            return None
        before = after.sound if after is not None else None
        return self._sound.columns(before.first + len(before.tiles) if before is not None else 0)


def _next_bin(after: LivePicture | None) -> int:
    if after is None or after.strips is None or not len(after.strips.low):
        return 0
    return after.strips.first + len(after.strips.low) - 1  # the last one was still growing


def _newest(sound: SpectrumColumns | None, after: LivePicture | None) -> float | None:
    if sound is not None and len(sound.host_s):
        return float(sound.host_s[-1])
    return after.sound_host_s if after is not None else None
