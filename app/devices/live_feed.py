"""A bounded queue from the recorder to whoever draws: the oldest blocks go first when it is full, and are counted.

The recording never waits for a picture, so what the feed drops is on the disc all the same.
"""

import threading
from collections import deque

from processing.live.stream import MotionBlock, SoundBlock

Block = SoundBlock | MotionBlock

MOST_BYTES = 32 << 20  # 20 s of two channels at 192 kHz: a window that was hidden for longer begins anew
MOST_BLOCKS = 20_000
_MOTION_BYTES = 120  # a sample, about


class LiveFeed:
    """Blocks in the order in which they came; any thread may add, any thread may take.

    One that is not ``is_open`` holds nothing: nobody will look.
    """

    def __init__(self, most_bytes: int = MOST_BYTES, most_blocks: int = MOST_BLOCKS, *, is_open: bool = True) -> None:
        self.is_open = is_open
        self._most_bytes, self._most_blocks = most_bytes, most_blocks
        self._lock = threading.Lock()
        self._blocks: deque[tuple[Block, int]] = deque()
        self._bytes = 0
        self._dropped = 0

    def add(self, block: Block) -> None:
        """Put a block at the end, at the cost of the oldest ones; a block larger than all room stays alone."""
        if not self.is_open:
            return
        size = _size(block)
        with self._lock:
            self._blocks.append((block, size))
            self._bytes += size
            while len(self._blocks) > 1 and (self._bytes > self._most_bytes or len(self._blocks) > self._most_blocks):
                self._bytes -= self._blocks.popleft()[1]
                self._dropped += 1

    def take(self) -> tuple[Block, ...]:
        """Return all blocks that wait, oldest first, and forget them."""
        with self._lock:
            blocks = tuple(block for block, _ in self._blocks)
            self._blocks.clear()
            self._bytes = 0
        return blocks

    def clear(self) -> None:
        """Forget what waits without counting it as dropped: another recording begins, with its own time."""
        with self._lock:
            self._blocks.clear()
            self._bytes = 0

    def close(self) -> None:
        """Hold nothing any more: nobody will look."""
        self.is_open = False
        self.clear()

    @property
    def dropped(self) -> int:
        """How many blocks went unseen."""
        return self._dropped


def _size(block: Block) -> int:
    return int(block.frames.nbytes) if isinstance(block, SoundBlock) else len(block.imu.time_s) * _MOTION_BYTES
