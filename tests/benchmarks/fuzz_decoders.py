"""Damage streams of every protocol at random for so many seconds: no decoder may raise, warn, or depend on the cuts.

    python tests/benchmarks/fuzz_decoders.py [SECONDS] [SEED]

Streams change their protocol, lose bytes, gain bytes, flip bits, and meet words that parsers trip over. What each
decoder finds, and what it counts as garbage, must be the same for the stream as a whole and in pieces.
"""

import sys
import time
import warnings
from dataclasses import fields
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "helpers"), str(HERE.parent.parent)]

from imu_streams import HEADER, PROTOCOLS, messages  # noqa: E402

WORDS = (
    b"1e300", b"-1e39", b"nan", b"inf", b"", b"1e38", b"99999999999999999999", b"\n", b",", b"\0", b"-", b".",
    b"1e-400", b"\xdb\xdc", b"\xc9", b"12:30:00.5 ", b"\xc5\x4c\x01", HEADER, HEADER.replace(b"time_s", b"counter"),
)  # fmt: skip


def damaged(chance, message):
    """Return a message with one thing wrong."""
    data, at = bytearray(message), int(chance.integers(len(message)))
    kind = chance.integers(6)
    if kind == 0:
        data[at:at] = WORDS[chance.integers(len(WORDS))]
    elif kind == 1:
        data[at : at + chance.integers(1, 20)] = WORDS[chance.integers(len(WORDS))]
    elif kind == 2:
        del data[at : at + chance.integers(1, 20)]
    elif kind == 3:
        data[at:at] = chance.bytes(chance.integers(1, 40))
    elif kind == 4:
        data[at] ^= 1 << int(chance.integers(8))
    else:
        data += bytes(data)
    return bytes(data)


def stream_of(chance, written):
    """Return pieces of one to three protocols, each with up to eleven damages."""
    parts = []
    for _ in range(chance.integers(1, 4)):
        some = list(written[PROTOCOLS[chance.integers(len(PROTOCOLS))]][: chance.integers(1, 60)])
        for _ in range(chance.integers(12)):
            number = chance.integers(len(some))
            some[number] = damaged(chance, some[number]) or b"\n"
        parts += some
    return b"".join(parts)


def check(chance, stream):
    """Hold what is found in the whole against what is found in pieces."""
    from processing.importing.frames import Frames, encode
    from processing.live.decoders import decoder_named
    from processing.live.frame_rows import joined

    for protocol in ("auto", "frames", "csv", "printed", "ximu3"):
        whole, pieces = decoder_named(protocol), decoder_named(protocol)
        expected, found, at = whole.feed(stream), [], 0
        encode(expected)
        while at < len(stream):
            size = int(chance.integers(1, 400))
            found.append(pieces.feed(stream[at : at + size]))
            at += size
        rows = joined(found)
        if protocol == "auto":  # it changes protocols between pieces
            continue
        for field in fields(Frames):
            one, other = getattr(expected, field.name), getattr(rows, field.name)
            assert np.array_equal(one, other, equal_nan=True), (protocol, field.name)
        assert whole.counts() == pieces.counts(), protocol


def main():
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0
    seed = first = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    written = {protocol: messages(protocol, 60) for protocol in PROTOCOLS}
    warnings.simplefilter("error")
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        chance = np.random.default_rng(seed)
        try:
            check(chance, stream_of(chance, written))
        except Exception:
            print(f"seed {seed}")
            raise
        seed += 1
    print(f"{seed - first} streams, nothing wrong")


if __name__ == "__main__":
    main()
