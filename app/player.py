"""Listening: plays the survey's sound from the cursor, lets the cursor follow, loops a candidate with its lead-in."""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.devices.audio_output import FloatBlock, Playback, ReadFrames, Sink, SoundUnavailableError, Stretch, open_sink
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.survey import AudioSource, Candidate
from widgets.playback_bar import PlaybackBar

if TYPE_CHECKING:
    from processing.results import Results

log = logging.getLogger(__name__)

FOLLOW_MS = 33
LEAD_IN_S = 2.0
TAIL_S = 1.0
LONGEST_LOOP_S = 20.0
MUTE_DB, SPAN_DB = -40.0, 60.0  # the volume's range: a hydrophone is often quiet, so it reaches +20 dB


def gain_of(volume: float) -> float:
    """Return the factor for a volume of 0..1: silence at 0, else −40 … +20 dB."""
    return 0.0 if volume <= 0.0 else float(10.0 ** ((MUTE_DB + SPAN_DB * volume) / 20.0))


@dataclass(frozen=True)
class LoopSpan:
    """What is played again and again, in survey seconds."""

    start_s: float
    end_s: float


def loop_span(candidate: Candidate, speed_mps: float) -> LoopSpan:
    """Return the time in which the candidate was heard, with two seconds of lead-in; at most twenty seconds long."""
    half_s = candidate.width_m / (2.0 * speed_mps) if speed_mps > 1e-3 else 1.0
    half_s = min(max(half_s, 0.5), (LONGEST_LOOP_S - LEAD_IN_S - TAIL_S) / 2.0)
    return LoopSpan(candidate.time_s - half_s - LEAD_IN_S, candidate.time_s + half_s + TAIL_S)


class BandFilter:
    """Wraps a reader so that only one band is heard; causal, and continuous from block to block."""

    def __init__(self, read: ReadFrames, sample_rate_hz: float, band_hz: tuple[float, float]) -> None:
        from scipy import signal  # slow to import: only who listens to a band pays for it

        nyquist = sample_rate_hz / 2.0
        high = min(band_hz[1], 0.98 * nyquist)
        low = min(max(band_hz[0], 1.0), 0.5 * high)  # a recording too slow for the band: the top of what there is
        self._sections = signal.butter(4, [low, high], "bandpass", fs=sample_rate_hz, output="sos")
        self._filter = signal.sosfilt
        self._state = np.zeros((self._sections.shape[0], 2))
        self._read = read
        self._next = -1

    def __call__(self, start: int, count: int) -> FloatBlock:
        """Return the filtered samples; a jump starts the filter anew."""
        block = self._read(start, count)
        if start != self._next:
            self._state = np.zeros_like(self._state)
        self._next = start + block.size
        filtered, self._state = self._filter(self._sections, block, zi=self._state)
        return np.asarray(filtered, dtype=np.float32)


class Player(QObject):
    """The buttons' brain. ``make_sink`` opens the sound card; tests give it one that only counts."""

    failed = Signal(object)  # Exception

    def __init__(
        self,
        session: SurveySession,
        bar: PlaybackBar,
        preferences: PreferencesStore,
        make_sink: Callable[[float], Sink] = open_sink,
        parent: QObject | None = None,
    ) -> None:
        super().__init__(parent)
        self._session, self._bar, self._preferences, self._make_sink = session, bar, preferences, make_sink
        self._playback: Playback | None = None
        self._close_reader: Callable[[], None] = lambda: None
        self._looping = False
        self._following = False
        self._hint, self._reason = "", ""
        self._timer = QTimer(self)
        self._timer.setInterval(FOLLOW_MS)
        self._timer.timeout.connect(self._follow)
        bar.set_volume(preferences.values.volume)
        bar.set_band_only(on=preferences.values.play_band_only)
        bar.play_asked.connect(self.toggle)
        bar.loop_asked.connect(self.toggle_loop)
        bar.volume_changed.connect(lambda volume: preferences.change(volume=volume))
        bar.band_changed.connect(self._on_band)
        session.cursor.moved.connect(self._on_cursor)
        session.results_changed.connect(self._on_results)
        session.opened.connect(self.stop)
        self._show()

    @property
    def playing(self) -> bool:
        """Whether sound is coming out."""
        return self._playback is not None

    @property
    def looping(self) -> bool:
        """Whether a candidate is being played again and again."""
        return self._looping

    def set_unavailable(self, reason: str) -> None:
        """Switch listening off with a hint; an empty reason switches it on."""
        self._hint = self.tr("No sound card") if reason else ""
        self._reason = reason
        self._show()

    def toggle(self) -> None:
        """Play from the cursor, or pause."""
        if self.playing:
            self.stop()
        else:
            self._play_from_cursor()

    def toggle_loop(self) -> None:
        """Play the selected candidate in a loop, or stop that."""
        if self._looping:
            self.stop()
        else:
            self.loop_selected()

    def loop_selected(self) -> None:
        """Play the selected candidate in a loop."""
        row = self._session.row(self._session.selected)
        results = self._session.results
        if row is None or results is None:
            return
        span = loop_span(row.candidate, speed_at(results, row.candidate.time_s))
        audio = results.recording.audio
        if audio is not None:
            first = self._frame(results, audio, span.start_s)
            last = min(max(self._frame(results, audio, span.end_s), first + 1), audio.frames)
            self._start(results, audio, Stretch(first, last, loop=True, loop_start=first))

    def stop(self) -> None:
        """Be silent."""
        self._timer.stop()
        playback, self._playback = self._playback, None
        self._looping = False
        if playback is not None:
            playback.stop()
            self._close_reader()
        self._show()

    def _play_from_cursor(self) -> None:
        results = self._session.results
        audio = results.recording.audio if results is not None else None
        if results is None or audio is None:
            return
        first = self._frame(results, audio, self._session.cursor.time_s)
        if first >= audio.frames - 1:
            first = 0
        self._start(results, audio, Stretch(first, audio.frames))

    def _frame(self, results: "Results", audio: AudioSource, survey_s: float) -> int:
        frame = round(float(results.clock.to_audio(survey_s)) * audio.sample_rate_hz)
        return min(max(frame, 0), audio.frames)

    def _start(self, results: "Results", audio: AudioSource, stretch: Stretch) -> None:
        self.stop()
        if self._hint:
            return
        from processing.sound.source import AudioReader

        try:
            sink = self._make_sink(audio.sample_rate_hz)
        except SoundUnavailableError as error:
            self.set_unavailable(str(error))
            return
        reader = AudioReader(audio)
        self._close_reader = reader.close
        read: ReadFrames = reader.read
        if self._preferences.values.play_band_only:
            sound = results.settings.sound
            read = BandFilter(read, audio.sample_rate_hz, (sound.band_low_hz, sound.band_high_hz))
        values = self._preferences
        self._playback = Playback(sink, read, audio.sample_rate_hz, stretch, lambda: gain_of(values.values.volume))
        self._looping = stretch.loop
        self._playback.start()
        self._timer.start()
        self._show()

    def _follow(self) -> None:
        playback, results = self._playback, self._session.results
        audio = results.recording.audio if results is not None else None
        if playback is None or results is None or audio is None:
            self.stop()
            return
        self._following = True
        self._session.cursor.set_time(float(results.clock.to_survey(playback.position / audio.sample_rate_hz)))
        self._following = False
        if not playback.active:
            error = playback.error
            self.stop()
            if isinstance(error, OSError):
                self.set_unavailable(str(error))  # the card is gone
            elif error is not None:
                self.failed.emit(error)  # the recording cannot be read here

    def _on_cursor(self, _time_s: float) -> None:
        if self.playing and not self._following:
            if self._looping:
                self.stop()
            else:
                self._play_from_cursor()

    @property
    def moves_cursor(self) -> bool:
        """Whether the cursor is being moved by the playback at this moment, not by the operator."""
        return self._following

    def _on_band(self, on: bool) -> None:
        self._preferences.change(play_band_only=on)
        if self.playing and not self._looping:
            self._play_from_cursor()
        elif self.playing:
            self.loop_selected()

    def _on_results(self) -> None:
        self.stop()

    def _show(self) -> None:
        results = self._session.results
        hint = self._hint
        if not hint and (results is None or results.recording.audio is None):
            hint = self.tr("This survey has no sound.") if results is not None else " "
        self._bar.set_available(hint, self._reason)
        self._bar.set_playing(playing=self.playing and not self._looping, looping=self._looping)


def speed_at(results: "Results", time_s: float) -> float:
    """Return how fast the device was at a moment, m/s; 0 without a path."""
    track = results.track
    return 0.0 if track is None else float(np.interp(time_s, track.time_s, track.speed_mps))
