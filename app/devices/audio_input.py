"""Sound from a device to whoever wants it, for hours: nothing is lost unsaid, and a lost device is found again.

Three threads: PortAudio's, which only copies; one that opens the device, watches it and opens it again; and the worker,
which places the sound on its time axis, feeds the level meter and calls ``on_block``. A system that hangs while it
opens or closes a device therefore holds up neither the sound that came nor whoever stops it.
"""

import logging
import queue
import threading
import time
from collections.abc import Callable

from app.devices import portaudio
from app.devices.audio_devices import AudioDevice, list_inputs, named
from app.devices.audio_placing import Placing
from app.devices.audio_source import Source, is_same, source_behind
from app.devices.audio_spec import AudioChoice
from app.devices.audio_stream import Callback, Chunk, Handover, Opener, OpenInput, open_input, suitable_rate
from processing.errors import ErrorCode, LeaklineError
from processing.live.levels import LevelMeter
from processing.live.stream import LinkState, SoundBlock, SoundStatus

log = logging.getLogger(__name__)

QUEUE_S = 30.0  # of sound; a disc that stalls for longer costs sound, not the computer's memory
SILENT_S = 0.8  # without a callback
LOST_S = 2.0
RETRY_S = 1.0
SOURCE_S = 5.0  # how often to look whether the sound server feeds us from another device; costs 5 ms
_LOOK_S = 0.1
_STALLED_S = 0.5  # a look is this late only where the whole program, or the computer, stood still


class AudioInput:
    """One input for one recording; started once, stopped once. ``on_block`` is called from its worker thread.

    Rate and channels stay what they were at the first opening, because the recording's files are made for them.
    """

    def __init__(
        self,
        choice: AudioChoice,
        on_block: Callable[[SoundBlock], None],
        *,
        open_device: Opener = open_input,
        devices: Callable[[], tuple[AudioDevice, ...]] = list_inputs,
        source_of: Callable[[AudioDevice], Source | None] = source_behind,
        queue_s: float = QUEUE_S,
    ) -> None:
        self._choice, self._on_block, self._open_device, self._devices = choice, on_block, open_device, devices
        self._source_of = source_of
        self._handover = Handover(queue_s)
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._state = LinkState.WAITING
        self._fault: LeaklineError | None = None
        self._device = ""
        self._source: Source | None = None  # of the first opening; no other may take its place
        self._rate_hz = 0
        self._has_failed = False
        self._meter: LevelMeter | None = None
        self._place: Placing | None = None
        self._watcher = threading.Thread(target=self._watch, name="sound-device", daemon=True)
        self._worker = threading.Thread(target=self._work, name="sound", daemon=True)

    def start(self) -> None:
        """Begin; returns at once. Raises LeaklineError (SOUND_LIBRARY_MISSING), all else is told by the status."""
        if self._open_device is open_input:
            portaudio.library()
        self._worker.start()
        self._watcher.start()

    def stop(self, timeout_s: float = 3.0) -> bool:
        """Let the device go and hand over what came until then; returns False if that took longer than the time given.

        Then the system hangs; the threads are left behind and end with the program.
        """
        until = time.monotonic() + timeout_s
        self._stop.set()
        if self._watcher.ident is not None:
            self._watcher.join(max(0.0, until - time.monotonic() - 0.2 * timeout_s))
        self._handover.end()
        if self._worker.ident is not None:
            self._worker.join(max(0.0, until - time.monotonic()))
        ended = not (self._watcher.is_alive() or self._worker.is_alive())
        if not ended:
            log.warning("the sound input %s did not end in %.1f s; it is left behind", self._device, timeout_s)
        with self._lock:
            self._state = LinkState.ENDED
        return ended

    def _is(self, state: LinkState, fault: LeaklineError | None = None) -> None:
        with self._lock:
            if self._state is not LinkState.ENDED:
                self._state, self._fault = state, fault

    @property
    def fault(self) -> LeaklineError | None:
        """Why there is no sound at this moment, None while there is."""
        with self._lock:
            return self._fault

    def status(self) -> SoundStatus:
        """Return one look at the stream; cheap, from any thread."""
        with self._lock:
            state, device, rate_hz, meter, place = self._state, self._device, self._rate_hz, self._meter, self._place
            source = self._source
        if meter is None or place is None:
            return SoundStatus(state=state, device=device)
        levels = meter.levels()
        return SoundStatus(
            state=state,
            device=device,
            sample_rate_hz=float(rate_hz),
            channels=self._choice.channels,
            frames=place.came,
            lost_frames=place.lost,
            gaps=place.gaps,
            rms_db=levels.rms_db,
            peak_db=levels.peak_db,
            held_peak_db=levels.held_peak_db,
            clipped=levels.clipped,
            is_digital_silence=levels.is_digital_silence,
            clock_ppm=place.timeline.clock_ppm,
            clock_sigma_ppm=place.timeline.clock_sigma_ppm,
            offset=levels.offset,
            overflows=self._handover.overflows,
            waiting_s=self._handover.waiting_frames / rate_hz,
            source="" if source is None else source.name,
            source_rate_hz=None if source is None else source.rate_hz,
        )

    def clear_clip(self) -> None:
        """Forget that the sound was clipped."""
        with self._lock:
            meter = self._meter
        if meter is not None:
            meter.clear_clip()

    # --- the thread that opens and watches the device ---------------------------------------------------------------

    def _watch(self) -> None:
        while not self._stop.is_set():
            try:
                pause_s = self._hear()
            except LeaklineError as error:
                with self._lock:
                    self._fault = error
                log.debug("sound input not open: %s", error)
                pause_s = RETRY_S
            except Exception as error:  # the sound system fails as nobody thought: as good as gone, and tried again
                log.log(logging.DEBUG if self._has_failed else logging.ERROR, "the sound input failed", exc_info=True)
                self._has_failed = True
                fault = LeaklineError(ErrorCode.SOUND_SYSTEM_HANGS, reason=repr(error))
                self._is(LinkState.WAITING if self._state is LinkState.WAITING else LinkState.LOST, fault)
                pause_s = RETRY_S
            self._stop.wait(pause_s)

    def _hear(self) -> float:
        """Open the device and let it run as long as it does; return the pause before it is opened again."""
        device, stream, callback = self._open()
        try:
            return self._look_after(device, callback)
        finally:
            self._close(stream)

    def _open(self) -> tuple[AudioDevice, OpenInput, Callback]:
        device = named(self._choice, self._devices())
        rate_hz = self._rate_hz or self._choice.rate_hz or suitable_rate(device, self._choice.channels)
        callback = self._handover.opened(rate_hz)
        callback.is_heard = self._source is None  # else only when it is known to be the same again
        with self._lock:
            if self._meter is None:
                self._rate_hz = rate_hz
                self._meter = LevelMeter(rate_hz, self._choice.channels)
                self._place = Placing(rate_hz, self._choice.channels)
            self._device = device.name
        stream = self._open_device(device, rate_hz, self._choice.channels, callback)
        if stream.is_converted:
            with self._lock:
                self._source = Source(device.name, device.default_rate_hz)
        if self._choice.is_default:
            # when the microphone is unplugged the default becomes another one, which must not go on in its place
            self._choice = AudioChoice(device.name, self._choice.rate_hz, self._choice.channels)
        return device, stream, callback

    def _look_after(self, device: AudioDevice, callback: Callback) -> float:
        """Watch until the device is lost, or replaced, or we are to stop; return the pause before a retry."""
        since_s = looked_s = time.monotonic()
        look_s = since_s  # when to look at the source next
        while not self._stop.is_set():
            now = time.monotonic()
            if now - looked_s > _STALLED_S:  # we stood still, not the device: what it brought is about to come
                since_s = now
            looked_s = now
            quiet_s = now - max(callback.last_s or since_s, since_s)
            if callback.finished.is_set() or quiet_s > LOST_S:
                self._is(LinkState.LOST, LeaklineError(ErrorCode.SOUND_DEVICE_GONE, name=self._device))
                return 0.0
            if now >= look_s and callback.last_s is not None:
                look_s = now + SOURCE_S
                other = self._other_source(device)
                if other is not None:
                    fault = LeaklineError(ErrorCode.SOUND_DEVICE_SWAPPED, name=self._source_name(), other=other.name)
                    self._is(LinkState.LOST, fault)
                    return RETRY_S
                callback.is_heard = True
            if quiet_s > SILENT_S:
                self._is(LinkState.SILENT)
            elif callback.last_s is not None:
                self._is(LinkState.LIVE)
            callback.finished.wait(_LOOK_S)
        return 0.0

    def _other_source(self, device: AudioDevice) -> Source | None:
        """Return what the sound server gives in place of what it gave at first; None where all is well or unknown."""
        source = self._source_of(device)
        with self._lock:
            if self._source is None or source is None:
                self._source = self._source or source
                return None
            if is_same(source, self._source):
                self._source = source
                return None
        return source

    def _source_name(self) -> str:
        return self._device if self._source is None else self._source.name

    def _close(self, stream: OpenInput) -> None:
        """Close a stream; on a thread of its own, because some systems hang when the device has gone."""
        closing = threading.Thread(target=stream.close, name="sound-close", daemon=True)
        closing.start()
        closing.join(LOST_S)
        if closing.is_alive():
            log.warning("the system hangs while it closes the sound input %s", self._device)

    # --- the worker --------------------------------------------------------------------------------------------------

    def _work(self) -> None:
        while True:
            try:
                chunk = self._handover.take(timeout_s=1.0)
            except queue.Empty:
                continue
            try:
                for block in self._placed(chunk):
                    self._deliver(block)
            except Exception:  # a fault of ours costs one block, not the recording
                log.exception("a block of sound could not be placed or measured")
            if chunk is None:
                return

    def _placed(self, chunk: Chunk | None) -> list[SoundBlock]:
        with self._lock:
            place = self._place
        if place is None:
            return []
        return place.rest() if chunk is None else place.blocks(chunk)

    def _deliver(self, block: SoundBlock) -> None:
        with self._lock:
            meter = self._meter
        try:
            self._on_block(block)
        except Exception:  # a fault of whoever takes the sound must not end the stream
            log.exception("a block of sound was not taken")
        assert meter is not None  # made with the placing
        meter.add(block.frames)
