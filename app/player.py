"""Listening: plays the sound from the cursor, lets the cursor follow, loops a candidate, cleaned, in a band, slowed."""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from PySide6.QtCore import QObject, QTimer, Signal

from app.devices.audio_output import Playback, Sink, SoundUnavailableError, Stretch, open_sink
from app.devices.slow_sound import SlowSound
from app.listening import Band, Hearing, Listening, Loudness
from app.settings import PreferencesStore
from app.survey_session import SurveySession
from processing.survey import AudioSource, Candidate
from widgets.playback_bar import PlaybackBar

if TYPE_CHECKING:
    from processing.results import Results
    from processing.sound.cleaning import CleaningContext

log = logging.getLogger(__name__)

FOLLOW_MS = 33
LEAD_IN_S = 2.0
TAIL_S = 1.0
LONGEST_LOOP_S = 20.0
BANDS = ("whole", "leaks", "candidate")
SLOWNESSES = (1, 2, 4)
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


class Player(QObject):
    """The buttons' brain. ``make_sink`` opens the sound card; tests give it one that only counts."""

    failed = Signal(object)  # Exception
    played_on = Signal()  # the playback has moved the cursor
    stopped = Signal()

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
        self._listening: Listening | None = None
        self._slow: SlowSound | None = None
        self._loudness: Loudness | None = None
        self._context: CleaningContext | None = None
        self._looping: LoopSpan | None = None
        self._following = False
        self._hint, self._reason = "", ""
        self._timer = QTimer(self)
        self._timer.setInterval(FOLLOW_MS)
        self._timer.timeout.connect(self._follow)
        bar.set_volume(preferences.values.volume)
        bar.set_band(self._band_name)
        bar.set_slow(self._slowness)
        bar.play_asked.connect(self.toggle)
        bar.loop_asked.connect(self.toggle_loop)
        bar.volume_changed.connect(lambda volume: preferences.change(volume=volume))
        bar.band_chosen.connect(self.choose_band)
        bar.slow_chosen.connect(self.choose_slow)
        session.cursor.moved.connect(self._on_cursor)
        session.results_changed.connect(self._on_results)
        session.selection_changed.connect(self._apply)
        session.opened.connect(self.stop)
        self._show()

    @property
    def playing(self) -> bool:
        """Whether sound is coming out."""
        return self._playback is not None

    @property
    def looping(self) -> bool:
        """Whether a candidate or a span is being played again and again."""
        return self._looping is not None

    @property
    def hearing(self) -> Hearing:
        """How it is listened to."""
        return Hearing(self._context is not None, self._band_hz(), self._slowness)

    def set_cleaning(self, context: "CleaningContext | None") -> None:
        """Listen to the cleaned sound, or with None to the raw one; what plays goes on from where it is."""
        self._context = context
        self._apply()

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
        if self.looping:
            self.stop()
        else:
            self.loop_selected()

    def toggle_selection_loop(self) -> None:
        """Play what is selected in time in a loop, the candidate where nothing is; or stop that."""
        selection_s = self._session.cursor.selection_s
        if self.looping or selection_s is None:
            self.toggle_loop()
        else:
            self.loop_between(LoopSpan(*selection_s))

    def loop_selected(self) -> None:
        """Play the selected candidate in a loop."""
        row = self._session.row(self._session.selected)
        results = self._session.results
        if row is not None and results is not None:
            self.loop_between(loop_span(row.candidate, speed_at(results, row.candidate.time_s)))

    def loop_between(self, span: LoopSpan) -> None:
        """Play a span of survey time in a loop."""
        results = self._session.results
        audio = results.recording.audio if results is not None else None
        if results is None or audio is None:
            return
        first = self._frame(results, audio, span.start_s)
        last = min(max(self._frame(results, audio, span.end_s), first + 1), audio.frames)
        self._start(audio, Stretch(first, last, loop=True, loop_start=first))
        if self.playing:
            self._looping = span
            self._reveal(span)
            self._show()

    def _reveal(self, span: LoopSpan) -> None:
        """Show all that is heard: move the view there, and widen it where it is too narrow."""
        cursor = self._session.cursor
        first, last = (float(cursor.x_of_time(t)) for t in (span.start_s, span.end_s))
        low, high = cursor.x_range
        if low <= first and last <= high:
            return
        if last - first >= high - low:
            cursor.set_x_range(first, last)
        else:
            cursor.pan(first - low if first < low else last - high)

    def choose_band(self, name: str) -> None:
        """Hear the ``whole`` sound, the band of ``leaks``, or that of the selected ``candidate``."""
        self._preferences.change(play_band=name)
        self._bar.set_band(self._band_name)
        self._apply()

    def next_band(self) -> None:
        """Go to the next choice of band."""
        self.choose_band(BANDS[(BANDS.index(self._band_name) + 1) % len(BANDS)])

    def choose_slow(self, times: int) -> None:
        """Let the sound last so many times as long, at the same pitch."""
        self._preferences.change(play_slow=times)
        self._bar.set_slow(self._slowness)
        self._apply()

    def next_slow(self) -> None:
        """Go to the next slowness."""
        self.choose_slow(SLOWNESSES[(SLOWNESSES.index(self._slowness) + 1) % len(SLOWNESSES)])

    def stop(self) -> None:
        """Be silent."""
        self._timer.stop()
        playback, self._playback = self._playback, None
        self._looping = None
        listening, self._listening, self._slow = self._listening, None, None
        if playback is not None:
            playback.stop()
        if listening is not None:
            listening.close()
        self._show()
        if playback is not None:
            self.stopped.emit()

    def _play_from_cursor(self) -> None:
        results = self._session.results
        audio = results.recording.audio if results is not None else None
        if results is None or audio is None:
            return
        first = self._frame(results, audio, self._session.cursor.time_s)
        if first >= audio.frames - 1:
            first = 0
        self._start(audio, Stretch(first, audio.frames))

    def _frame(self, results: "Results", audio: AudioSource, survey_s: float) -> int:
        frame = round(float(results.clock.to_audio(survey_s)) * audio.sample_rate_hz)
        return min(max(frame, 0), audio.frames)

    def _start(self, audio: AudioSource, stretch: Stretch) -> None:
        self.stop()
        if self._hint:
            return
        try:
            sink = self._make_sink(audio.sample_rate_hz)
        except SoundUnavailableError as error:
            self.set_unavailable(str(error))
            return
        rate_hz = audio.sample_rate_hz
        if self._loudness is None:
            self._loudness = Loudness(rate_hz, audio.frames)
        self._listening = Listening(audio, self.hearing, self._context, self._loudness)
        self._slow = SlowSound(self._listening, rate_hz)
        self._slow.factor = self._slowness
        values = self._preferences
        self._playback = Playback(sink, self._slow, rate_hz, stretch, lambda: gain_of(values.values.volume))
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
        now_s = float(results.clock.to_survey(playback.position / audio.sample_rate_hz))
        self._session.cursor.set_time(now_s, reveal=False)  # whether the views follow is not for the player to say
        self.played_on.emit()
        self._following = False
        if not playback.active:
            error = playback.error
            self.stop()
            if isinstance(error, OSError):
                self.set_unavailable(str(error))  # the card is gone
            elif error is not None:
                self.failed.emit(error)  # the recording cannot be read here

    def _on_cursor(self, time_s: float) -> None:
        playback, results = self._playback, self._session.results
        audio = results.recording.audio if results is not None else None
        if playback is None or results is None or audio is None or self._following:
            return
        if self.looping:
            self.stop()
        else:
            playback.seek(self._frame(results, audio, time_s))  # opening the card anew would take its time

    @property
    def moves_cursor(self) -> bool:
        """Whether the cursor is being moved by the playback at this moment, not by the operator."""
        return self._following

    def heard_s(self, reaction_s: float) -> float:
        """Return the moment, survey seconds, that somebody who presses a key now has heard ``reaction_s`` ago.

        What is played now is what the sound card lets out now: the playback takes its latency off. Slowed sound goes
        by in so much less of the recording. In a loop, who presses just after it began anew has heard its end. While
        nothing plays, it is the cursor: somebody has put it there with care.
        """
        playback, results = self._playback, self._session.results
        audio = results.recording.audio if results is not None else None
        if playback is None or results is None or audio is None:
            return self._session.cursor.time_s
        now_s = float(results.clock.to_survey(playback.position / audio.sample_rate_hz))
        heard_s = now_s - reaction_s / self._slowness
        span = self._looping
        if span is not None and heard_s < span.start_s <= now_s:
            return max(span.end_s - (span.start_s - heard_s), span.start_s)
        return max(heard_s, self._session.cursor.extent_s[0])

    @property
    def _band_name(self) -> str:
        name = self._preferences.values.play_band
        return name if name in BANDS else BANDS[0]

    @property
    def _slowness(self) -> int:
        times = self._preferences.values.play_slow
        return times if times in SLOWNESSES else SLOWNESSES[0]

    def _band_hz(self) -> Band | None:
        """Return the band that is heard; the candidate's is that of leaks where none is selected."""
        results = self._session.results
        if self._band_name == "whole" or results is None:
            return None
        row = self._session.row(self._session.selected)
        if self._band_name == "candidate" and row is not None:
            return row.candidate.band_hz
        return results.settings.sound.band_low_hz, results.settings.sound.band_high_hz

    def _apply(self) -> None:
        """Let what plays go on as it is now to be heard."""
        if self._listening is not None and self._slow is not None:
            # the context first: the playback's thread may look between the two
            self._listening.context = self._context or self._listening.context
            self._listening.hearing = self.hearing
            self._slow.factor = self._slowness

    def _on_results(self) -> None:
        self._loudness = self._context = None
        self.stop()

    def _show(self) -> None:
        results = self._session.results
        hint = self._hint
        if not hint and (results is None or results.recording.audio is None):
            hint = self.tr("This survey has no sound.") if results is not None else " "
        self._bar.set_available(hint, self._reason)
        self._bar.set_playing(playing=self.playing and not self.looping, looping=self.looping)


def speed_at(results: "Results", time_s: float) -> float:
    """Return how fast the device was at a moment, m/s; 0 without a path."""
    track = results.track
    return 0.0 if track is None else float(np.interp(time_s, track.time_s, track.speed_mps))
