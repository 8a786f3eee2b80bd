"""What turns a device's bytes into samples, whichever of our protocols it speaks; see :data:`PROTOCOLS`.

========== ======================================================================================= ====== =======
name       what                                                                                    time   counter
========== ======================================================================================= ====== =======
frames     Leakline's binary frames, :mod:`processing.importing.frames`                            yes    sent
csv        lines of the columns of imu.csv, :mod:`processing.live.table_lines`                     mostly if named
printed    the printed lines of P0 and P3, :mod:`processing.live.printed_lines`                    if any counted
ximu3      ASCII and binary messages of xio's x-IMU3, :mod:`processing.live.ximu3_rows`            yes    counted
auto       whichever of these comes
========== ======================================================================================= ====== =======

All take bytes however they are cut, pass over what is damaged, and need bounded memory whatever comes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from processing.errors import ErrorCode, LeaklineError
from processing.importing.frames import FrameDecoder, Frames
from processing.live.frame_rows import joined, no_frames
from processing.live.printed_lines import PrintedLinesDecoder
from processing.live.table_lines import TableLinesDecoder
from processing.live.ximu3_rows import Ximu3RowsDecoder

_FEWEST_ROWS = 3  # before a protocol is believed
DOUBT_BYTES = 4096  # without a row, before other protocols are tried beside the one that was believed


@dataclass(frozen=True)
class DecoderCounts:
    """What was passed over since the beginning."""

    garbage_bytes: int = 0
    bad_sums: int = 0


class ImuDecoder(Protocol):
    """Finds samples in a stream of bytes.

    ``has_time`` and ``has_counter`` are about the samples that :meth:`feed` returned last: whether ``time_us`` is the
    device's (else 0), and whether ``counter`` is (else it was counted here, and tells nothing of what was lost).
    """

    @property
    def name(self) -> str:
        """The protocol, one of :data:`PROTOCOLS`; ``auto`` while it is not known yet."""
        ...

    @property
    def has_time(self) -> bool:
        """Whether the samples hold the device's time."""
        ...

    @property
    def has_counter(self) -> bool:
        """Whether the samples hold the device's counter."""
        ...

    def feed(self, data: bytes) -> Frames:
        """Return the samples that are complete now: SI units, ``host_s`` NaN."""
        ...

    def restart(self) -> None:
        """Forget what is incomplete: the device was away, and what comes now does not continue it."""
        ...

    def counts(self) -> DecoderCounts:
        """Return what was passed over."""
        ...


class _Inner(Protocol):
    @property
    def name(self) -> str: ...
    @property
    def has_time(self) -> bool: ...
    @property
    def has_counter(self) -> bool: ...
    @property
    def garbage_bytes(self) -> int: ...
    @property
    def bad_sums(self) -> int: ...
    def feed(self, data: bytes) -> Frames: ...
    def restart(self) -> None: ...


class _BinaryFramesDecoder(FrameDecoder):
    name = "frames"
    has_time = True
    has_counter = True

    def restart(self) -> None:
        self.finish()


_KINDS: Mapping[str, Callable[[], _Inner]] = {
    "frames": _BinaryFramesDecoder,
    "csv": TableLinesDecoder,
    "printed": PrintedLinesDecoder,
    "ximu3": Ximu3RowsDecoder,
}
PROTOCOLS = ("auto", *_KINDS)


class NamedDecoder:
    """One protocol, whatever comes."""

    def __init__(self, protocol: str) -> None:
        self._inner = _KINDS[protocol]()
        self.name = protocol

    @property
    def has_time(self) -> bool:
        """Whether the samples hold the device's time."""
        return self._inner.has_time

    @property
    def has_counter(self) -> bool:
        """Whether the samples hold the device's counter."""
        return self._inner.has_counter

    def feed(self, data: bytes) -> Frames:
        """Return the samples that are complete now."""
        return self._inner.feed(data)

    def restart(self) -> None:
        """Forget what is incomplete."""
        self._inner.restart()

    def counts(self) -> DecoderCounts:
        """Return what was passed over."""
        return DecoderCounts(self._inner.garbage_bytes, self._inner.bad_sums)


@dataclass
class _Candidate:
    decoder: NamedDecoder
    found: list[Frames]


class AutoDecoder:
    """Finds out which protocol it is, stays with it, and looks again when nothing of it comes for a while.

    It is the first of which three samples were found: none of the protocols can be read as another. The samples that
    came meanwhile are not lost, unless the device has changed its protocol: then :data:`DOUBT_BYTES` are.
    """

    def __init__(self) -> None:
        self._known: NamedDecoder | None = None
        self._candidates = _all_candidates()
        self._since_row = 0
        self._base = DecoderCounts()  # of decoders that were given up
        self._at_doubt = DecoderCounts()  # of all, when others were begun to be tried

    @property
    def name(self) -> str:
        """The protocol, ``auto`` while it is not known."""
        return self._known.name if self._known else "auto"

    @property
    def has_time(self) -> bool:
        """Whether the samples hold the device's time; False while nothing is known."""
        return self._known is not None and self._known.has_time

    @property
    def has_counter(self) -> bool:
        """Whether the samples hold the device's counter; False while nothing is known."""
        return self._known is not None and self._known.has_counter

    def feed(self, data: bytes) -> Frames:
        """Return the samples that are complete now."""
        found = self._known.feed(data) if self._known else no_frames()
        if len(found):
            self._since_row = 0
            self._candidates = []
            return found
        if self._candidates:
            return self._tried(data)
        self._since_row += len(data)
        if self._since_row >= DOUBT_BYTES:
            self._at_doubt, self._candidates = self.counts(), _all_candidates()
        return found

    def restart(self) -> None:
        """Forget what is incomplete."""
        for decoder in [self._known, *(c.decoder for c in self._candidates)]:
            if decoder is not None:
                decoder.restart()

    def counts(self) -> DecoderCounts:
        """Return what was passed over; while nothing is known, what the decoder that fits best passed over."""
        if self._known is not None:
            now = self._known.counts()
            return DecoderCounts(self._base.garbage_bytes + now.garbage_bytes, self._base.bad_sums + now.bad_sums)
        return DecoderCounts(min(c.decoder.counts().garbage_bytes for c in self._candidates))

    def _tried(self, data: bytes) -> Frames:
        for candidate in self._candidates:
            part = candidate.decoder.feed(data)
            if not len(part):
                continue
            candidate.found.append(part)
            if sum(len(part) for part in candidate.found) >= _FEWEST_ROWS:
                self._known, self._base = candidate.decoder, self._at_doubt
                self._candidates, self._since_row = [], 0
                return joined(candidate.found)
        return no_frames()


def _all_candidates() -> list[_Candidate]:
    return [_Candidate(NamedDecoder(name), []) for name in _KINDS]


def decoder_named(protocol: str) -> ImuDecoder:
    """Return a new decoder of one of :data:`PROTOCOLS`; raises SETTING_INVALID for another name."""
    if protocol == "auto":
        return AutoDecoder()
    if protocol not in _KINDS:
        raise LeaklineError(ErrorCode.SETTING_INVALID, name="protocol", value=protocol, allowed=", ".join(PROTOCOLS))
    return NamedDecoder(protocol)
